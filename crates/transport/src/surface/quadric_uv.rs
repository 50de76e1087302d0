//! Texture coordinates of spheres, disks and cylinders.
//!
//! Each is a unit shape under an affine map: the unit ball, the unit disk and the unit tube of height 1 about z, the disk
//! and the tube in a frame about their axis. Transforms carry the image along.

use crate::frame::{Affine, SceneFrame, mapped};
use etalon_optics::{Frame, Vec3, atan2_turns};
use etalon_scene::DiskCoordinates;
use glam::{DAffine3, DMat3, DVec3};
use std::f64::consts::{PI, TAU};

/// A round shape's map to its unit shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoundCoordinates {
    kind: Round,
    to_unit: DAffine3,
    /// From vectors of the unit shape.
    from_unit: DMat3,
}

#[derive(Clone, Copy, Debug)]
enum Round {
    /// u runs with the longitude, counter-clockwise seen from +y, ½ at +z; v from the south pole −y to the north pole.
    Sphere,
    /// The square around it, u along the first and v along the second axis.
    Disk,
    /// u grows from the middle to the rim; v runs around it from the first axis toward the second.
    PolarDisk,
    /// u runs around the axis, counter-clockwise seen from the end; v from the start to the end.
    Cylinder,
}

impl RoundCoordinates {
    /// Of a sphere under an object's transform.
    pub(crate) fn sphere(centre: [f64; 3], radius: f64, to_world: &Affine) -> Self {
        let axes = [Vec3::new(radius, 0.0, 0.0), Vec3::new(0.0, radius, 0.0), Vec3::new(0.0, 0.0, radius)];
        Self::new(Round::Sphere, axes, centre, to_world)
    }

    /// Of a disk by its centre, its normal and its radius.
    pub(crate) fn disk(
        (centre, normal, radius): ([f64; 3], [f64; 3], f64),
        coordinates: DiskCoordinates,
        to_world: &Affine,
    ) -> Self {
        let frame = Frame::from_normal(Vec3::from_array(normal));
        let kind = match coordinates {
            DiskCoordinates::Square => Round::Disk,
            DiskCoordinates::Polar => Round::PolarDisk,
        };
        Self::new(kind, [frame.s * radius, frame.t * radius, frame.n * radius], centre, to_world)
    }

    /// Of a cylinder.
    pub(crate) fn cylinder(start: [f64; 3], end: [f64; 3], radius: f64, to_world: &Affine) -> Self {
        let along = Vec3::from_array(end) - Vec3::from_array(start);
        let frame = Frame::from_normal(along.normalized());
        Self::new(Round::Cylinder, [frame.s * radius, frame.t * radius, along], start, to_world)
    }

    fn new(kind: Round, axes: [Vec3<f64>; 3], origin: [f64; 3], to_world: &Affine) -> Self {
        let columns = axes.map(|axis| to_world.vector(axis.to_array()));
        let origin = to_world.point(origin);
        let [x, y, z] = columns;
        // The rows of the inverse of the matrix with these columns.
        let determinant = x.dot(y.cross(z));
        let rows = [y.cross(z), z.cross(x), x.cross(y)].map(|row| (row / determinant).to_array());
        let linear = DMat3::from_cols_array_2d(&rows).transpose();
        let offset = -mapped(&linear, origin);
        let from_unit = DMat3::from_cols_array_2d(&columns.map(Vec3::to_array));
        Self { kind, to_unit: DAffine3::from_mat3_translation(linear, offset.to_array().into()), from_unit }
    }

    pub(crate) fn framed(self, frame: &SceneFrame) -> Self {
        let DAffine3 { matrix3, translation } = self.to_unit;
        let offset = translation + matrix3 * DVec3::from_array(frame.to_world_m(Vec3::ZERO).to_array());
        Self {
            to_unit: DAffine3::from_mat3_translation(matrix3 * frame.per_m().recip(), offset),
            from_unit: self.from_unit * frame.per_m(),
            ..self
        }
    }

    fn unit(&self, p: Vec3<f64>) -> Vec3<f64> {
        Vec3::from_array(self.to_unit.transform_point3(p.to_array().into()).to_array())
    }

    /// Texture coordinates of a point.
    pub(crate) fn uv(&self, p: Vec3<f64>) -> [f64; 2] {
        let q = self.unit(p);
        match self.kind {
            Round::Sphere => {
                let off_axis = (q.x * q.x + q.z * q.z).sqrt();
                [0.5 + atan2_turns(q.x, q.z), 0.5 + 2.0 * atan2_turns(q.y, off_axis)]
            }
            Round::Disk => [0.5 + 0.5 * q.x, 0.5 + 0.5 * q.y],
            Round::PolarDisk => {
                let turns = atan2_turns(q.y, q.x);
                [(q.x * q.x + q.y * q.y).sqrt(), if turns < 0.0 { turns + 1.0 } else { turns }]
            }
            Round::Cylinder => [0.5 + atan2_turns(q.y, q.x), q.z],
        }
    }

    /// How a point moves with u and with v; `None` at a pole, in the middle of a polar disk, and on the caps of a cylinder.
    pub(crate) fn tangents(&self, p: Vec3<f64>) -> Option<[Vec3<f64>; 2]> {
        let q = self.unit(p);
        let [along_u, along_v] = match self.kind {
            Round::Sphere => {
                let off_axis = (q.x * q.x + q.z * q.z).sqrt();
                if off_axis == 0.0 {
                    return None;
                }
                let up = Vec3::new(-q.y * q.x / off_axis, off_axis, -q.y * q.z / off_axis);
                [Vec3::new(q.z, 0.0, -q.x) * TAU, up * PI]
            }
            Round::Disk => [Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.0)],
            Round::PolarDisk => {
                let r = (q.x * q.x + q.y * q.y).sqrt();
                if r == 0.0 {
                    return None;
                }
                [Vec3::new(q.x / r, q.y / r, 0.0), Vec3::new(-q.y, q.x, 0.0) * TAU]
            }
            Round::Cylinder => {
                // A cap is where the nearest part of the surface is an end.
                let off_axis = (q.x * q.x + q.y * q.y).sqrt();
                if (1.0 - off_axis).abs() > q.z.abs().min((1.0 - q.z).abs()) {
                    return None;
                }
                [Vec3::new(-q.y, q.x, 0.0) * TAU, Vec3::new(0.0, 0.0, 1.0)]
            }
        };
        Some([along_u, along_v].map(|v| mapped(&self.from_unit, v)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_geometry::Aabb;
    use etalon_scene::Transform;

    /// Places that turn, stretch and mirror.
    fn placements() -> [Affine; 3] {
        [
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            [[0.3, -1.1, 0.4], [2.0, 0.5, -0.2], [0.1, 0.7, 1.9]],
            [[-1.5, 0.0, 0.2], [0.3, 0.8, 0.0], [0.0, -0.4, 1.2]],
        ]
        .map(|linear| Affine::new(&Transform { linear, translation_m: [3.0, -2.0, 0.5] }))
    }

    /// A shape, and the point of it that has some texture coordinates, as the scene format says.
    type Case<'a> = (&'a str, RoundCoordinates, Box<dyn Fn(f64, f64) -> Vec3<f64> + 'a>);

    fn cases(place: &Affine) -> Vec<Case<'_>> {
        let (centre, radius) = ([0.4, 0.1, -0.3], 1.7);
        let normal = Vec3::new(0.6, 0.0, 0.8);
        let frame = Frame::from_normal(normal);
        let on = move |p: Vec3<f64>| place.point((Vec3::from_array(centre) + p).to_array());
        let end = (Vec3::from_array(centre) + normal * 2.5).to_array();
        let ball = move |u: f64, v: f64| {
            let (longitude, latitude) = (TAU * (u - 0.5), PI * (v - 0.5));
            let around = Vec3::new(longitude.sin(), 0.0, longitude.cos()) * latitude.cos();
            on((around + Vec3::new(0.0, latitude.sin(), 0.0)) * radius)
        };
        let disk = move |u: f64, v: f64| on((frame.s * (2.0 * u - 1.0) + frame.t * (2.0 * v - 1.0)) * radius);
        let polar = move |u: f64, v: f64| {
            let angle = TAU * v;
            on((frame.s * angle.cos() + frame.t * angle.sin()) * (u * radius))
        };
        let tube = move |u: f64, v: f64| {
            let angle = TAU * (u - 0.5);
            on((frame.s * angle.cos() + frame.t * angle.sin()) * radius + normal * (2.5 * v))
        };
        let round = |kind| RoundCoordinates::disk((centre, normal.to_array(), radius), kind, place);
        vec![
            ("sphere", RoundCoordinates::sphere(centre, radius, place), Box::new(ball)),
            ("disk", round(DiskCoordinates::Square), Box::new(disk)),
            ("polar disk", round(DiskCoordinates::Polar), Box::new(polar)),
            ("cylinder", RoundCoordinates::cylinder(centre, end, radius, place), Box::new(tube)),
        ]
    }

    #[test]
    fn a_point_has_the_coordinates_it_was_made_from_and_moves_with_them_as_its_tangents_say() {
        const STEP: f64 = 1e-5;
        for place in placements() {
            for (name, shape, point) in cases(&place) {
                for i in 1..10 {
                    for j in 1..10 {
                        // On the disk, within it.
                        let (u, v) = (0.15 + 0.07 * f64::from(i), 0.15 + 0.07 * f64::from(j));
                        let got = shape.uv(point(u, v));
                        assert!((got[0] - u).abs().max((got[1] - v).abs()) < 1e-12, "{name}: {got:?} is not {u}, {v}");
                        let tangents = shape.tangents(point(u, v)).unwrap();
                        let moved = [
                            (point(u + STEP, v) - point(u - STEP, v)) * (0.5 / STEP),
                            (point(u, v + STEP) - point(u, v - STEP)) * (0.5 / STEP),
                        ];
                        for (got, want) in tangents.into_iter().zip(moved) {
                            // Third derivatives are below 1e3, so that a central difference is off by 1e3·STEP²/6, and by rounding, 1e-10.
                            assert!((got - want).length() < 1e-7, "{name} at {u}, {v}: {got:?} is not {want:?}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn in_another_frame_places_and_tangents_go_with_the_surface() {
        // Centred at (12, 23, 0), a unit of it some metres.
        let bounds = Aabb { min: Vec3::new(10.0, 20.0, -5.0), max: Vec3::new(14.0, 26.0, -1.0) };
        let frame = SceneFrame::around(bounds);
        assert!(frame.per_m() != 1.0 && frame.to_world_m(Vec3::ZERO) == Vec3::new(12.0, 23.0, 0.0));
        let [_, place, _] = placements();
        for (name, shape, point) in cases(&place) {
            let (p, framed) = (point(0.3, 0.6), shape.framed(&frame));
            let (got, want) = (framed.uv(frame.point(p)), shape.uv(p));
            // Coordinates of some tens are rounded on the way.
            assert!((got[0] - want[0]).abs().max((got[1] - want[1]).abs()) < 1e-13, "{name}: {got:?} is not {want:?}");
            let (got, want) = (framed.tangents(frame.point(p)).unwrap(), shape.tangents(p).unwrap());
            for (got, want) in got.into_iter().zip(want) {
                assert!((got - want * frame.per_m()).length() < 1e-12, "{name}: {got:?} is not {want:?} scaled");
            }
        }
    }

    #[test]
    fn poles_and_caps_have_no_tangents() {
        let [place, ..] = placements();
        let [ball, polar, tube] = [0, 2, 3].map(|i| cases(&place).remove(i).1);
        let at = |p: [f64; 3]| place.point(p);
        assert!(polar.tangents(at([0.4, 0.1, -0.3])).is_none());
        assert!(ball.tangents(at([0.4, 0.1 + 1.7, -0.3])).is_none());
        // Within the tube's ends, at all distances from the axis but the rim's; and close to them on the wall.
        let frame = Frame::from_normal(Vec3::new(0.6, 0.0, 0.8));
        let on = |share: f64, along_m: f64| {
            let p = Vec3::new(0.4, 0.1, -0.3) + (frame.s * 0.8 + frame.t * 0.6) * (1.7 * share) + frame.n * along_m;
            tube.tangents(at(p.to_array())).is_some()
        };
        for share in [0.0, 0.5, 0.99] {
            assert!(!on(share, 0.0) && !on(share, 2.5), "{share}");
        }
        assert!(on(1.0, 0.01) && on(1.0, 2.49) && on(1.0, 1.0));
    }
}
