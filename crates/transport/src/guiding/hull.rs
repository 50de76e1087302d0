//! Boxes as targets of directions.

use super::DirectionTarget;
use etalon_geometry::Aabb;
use etalon_optics::Vec3;

/// The box around a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hull {
    min: [f64; 3],
    max: [f64; 3],
    pub(super) extent: [f64; 3],
    centre: [f64; 3],
    /// Of the faces across each axis.
    area: [f64; 3],
}

/// What is seen of a box: along each axis one face or none.
struct Faces {
    /// Where the face's plane is.
    plane: [f64; 3],
    /// About what part of the whole it takes in: 0 where neither is seen.
    weight: [f64; 3],
    total: f64,
}

impl From<Aabb> for Hull {
    fn from(body: Aabb) -> Self {
        let extent = body.extent().to_array();
        let area = [0, 1, 2].map(|a| extent[(a + 1) % 3] * extent[(a + 2) % 3]);
        Self { min: body.min.to_array(), max: body.max.to_array(), extent, centre: body.centre().to_array(), area }
    }
}

impl Hull {
    #[inline(always)]
    fn faces(&self, from: [f64; 3]) -> Faces {
        let (mut plane, mut weight) = ([0.0; 3], [0.0; 3]);
        let toward = [self.centre[0] - from[0], self.centre[1] - from[1], self.centre[2] - from[2]];
        let squares = [toward[0] * toward[0], toward[1] * toward[1], toward[2] * toward[2]];
        for a in 0..3 {
            let below = from[a] < self.min[a];
            plane[a] = if below { self.min[a] } else { self.max[a] };
            let height = plane[a] - from[a];
            let squared = height * height + squares[(a + 1) % 3] + squares[(a + 2) % 3];
            let seen = below | (from[a] > self.max[a]);
            // The solid angle of a small face.
            let weighs = self.area[a] * height.abs() / (squared * squared.sqrt());
            weight[a] = if seen { weighs } else { 0.0 };
        }
        Faces { plane, weight, total: weight[0] + weight[1] + weight[2] }
    }
}

impl Hull {
    /// A place within, for `u` in [0, 1)³; of a large body, one that is not much farther from a point than the body is.
    pub(super) fn place_near(&self, from: Vec3<f64>, u: [f64; 3]) -> Vec3<f64> {
        /// How much farther.
        const FARTHER: f64 = 3.0;
        let from = from.to_array();
        let nearest = [0, 1, 2].map(|axis: usize| from[axis].clamp(self.min[axis], self.max[axis]));
        let squared: f64 = (0..3).map(|axis| (from[axis] - nearest[axis]).powi(2)).sum();
        // Nothing is known of how far the surface is from a point within.
        let reach = if squared > 0.0 { FARTHER * squared.sqrt() } else { f64::INFINITY };
        Vec3::from_array([0, 1, 2].map(|axis: usize| {
            let low = self.min[axis].max(nearest[axis] - reach);
            let high = self.max[axis].min(nearest[axis] + reach);
            low + (high - low) * u[axis]
        }))
    }

    /// Whether some face is seen from a point.
    pub(super) fn is_outside(&self, from: Vec3<f64>) -> bool {
        self.faces([from.x, from.y, from.z]).total > 0.0
    }
}

impl DirectionTarget for Hull {
    #[inline(always)]
    fn is_seen(&self, from: Vec3<f64>, n: Vec3<f64>) -> bool {
        let [x, y, z] = self.extent;
        let reach = 0.5 * (x * n.x.abs() + y * n.y.abs() + z * n.z.abs());
        let toward = Vec3::new(self.centre[0], self.centre[1], self.centre[2]) - from;
        (self.faces([from.x, from.y, from.z]).total > 0.0) & (toward.dot(n) > -reach)
    }

    #[inline(always)]
    fn aim(&self, from: Vec3<f64>, u: [f64; 2]) -> Vec3<f64> {
        let Faces { plane, weight: [x, y, z], total } = self.faces([from.x, from.y, from.z]);
        let at = u[0] * total;
        // The face, and where in its part of the numbers.
        let (first, third) = (at < x, at >= x + y);
        let second = !first & !third;
        let s = if first { at / x } else { (at - x) / y };
        let s = if third { (at - (x + y)) / z } else { s };
        let t = u[1];
        let [along_x, along_y, along_z] = [
            self.min[0] + self.extent[0] * if second { t } else { s },
            self.min[1] + self.extent[1] * if third { t } else { s },
            self.min[2] + self.extent[2] * if first { t } else { s },
        ];
        let point = Vec3::new(
            if first { plane[0] } else { along_x },
            if second { plane[1] } else { along_y },
            if third { plane[2] } else { along_z },
        );
        let toward = point - from;
        toward / toward.length()
    }

    #[inline(always)]
    fn density(&self, from: Vec3<f64>, wi: Vec3<f64>) -> f64 {
        let (origin, direction) = ([from.x, from.y, from.z], [wi.x, wi.y, wi.z]);
        let Faces { plane, weight, total } = self.faces(origin);
        // A ray enters a box by the last plane of those seen that it goes through, if it does so within the face.
        let (mut entry, mut over, mut is_face) = (f64::NEG_INFINITY, 0.0, [false; 3]);
        for a in 0..3 {
            let t = (plane[a] - origin[a]) / direction[a];
            let later = (weight[a] > 0.0) & (t > entry);
            entry = if later { t } else { entry };
            let density = weight[a] / (self.area[a] * direction[a].abs());
            over = if later { density } else { over };
            is_face = [is_face[0] & !later, is_face[1] & !later, is_face[2] & !later];
            is_face[a] = later;
        }
        let mut enters = entry > 0.0;
        for a in 0..3 {
            let at = origin[a] + direction[a] * entry;
            enters &= is_face[a] | ((self.min[a] <= at) & (at <= self.max[a]));
        }
        let density = over / total * (entry * entry);
        if enters { density } else { 0.0 }
    }
}
