//! Where the picture shows a point: the way back of [`Camera::ray`](super::Camera::ray), for light that is followed from lamps.

use super::{Camera, Kind};
use crate::warp::concentric_disk;
use etalon_optics::Vec3;

/// A point as the camera sees it through a point of its lens.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projection {
    /// On the film, in [−1, 1]² within the picture.
    pub film: [f64; 2],
    /// Where the camera's ray begins.
    pub origin: Vec3<f64>,
    /// The unit vector from the point toward that.
    pub toward: Vec3<f64>,
    /// Area of the film, in the units of `film`, for each unit of area at the point that faces the camera.
    pub magnification: f64,
}

impl Camera {
    /// A point seen through the lens at `lens_u` in [0, 1)². `None` if it is before the near plane, or where no single ray leads to it: this
    /// camera must stand still, and have no compound lens.
    pub(crate) fn project(&self, point: Vec3<f64>, lens_u: [f64; 2]) -> Option<Projection> {
        let (lens, focus_distance) = match &self.kind {
            Kind::Pinhole => (Vec3::ZERO, 1.0),
            Kind::ThinLens { right, up, focus_distance } => {
                let [x, y] = concentric_disk(lens_u);
                (*right * x + *up * y, *focus_distance)
            }
            Kind::Orthographic => return self.project_along(point),
            Kind::Compound { .. } => return None,
        };
        let from_lens = point - self.position - lens;
        let depth = from_lens.dot(self.forward);
        if depth <= self.near.max(0.0) || self.moving.is_some() {
            return None;
        }
        // From the lens to the plane of focus: (forward + across) · focus − lens.
        let way = from_lens * (focus_distance / depth);
        let across = (way + lens) / focus_distance - self.forward;
        let (distance, length) = (from_lens.length(), way.length());
        // A solid angle dω has the area dω·|way|³/focus in the plane of focus, of which the film shows focus²·|half right|·|half up| for each
        // unit of its own.
        let of_solid_angle =
            length * length * length / (focus_distance * focus_distance * focus_distance * self.half_area());
        Some(Projection {
            film: self.film_of(across),
            origin: self.position + lens + way * (self.near / focus_distance),
            toward: -(from_lens / distance),
            magnification: of_solid_angle / (distance * distance),
        })
    }

    fn project_along(&self, point: Vec3<f64>) -> Option<Projection> {
        let from_film = point - self.position;
        let depth = from_film.dot(self.forward);
        let across = from_film - self.forward * depth;
        (depth > 0.0 && self.moving.is_none()).then(|| Projection {
            film: self.film_of(across),
            origin: self.position + across,
            toward: -self.forward,
            magnification: 1.0 / self.half_area(),
        })
    }

    /// The film's coordinates of a vector along the picture.
    fn film_of(&self, across: Vec3<f64>) -> [f64; 2] {
        [self.half_right, self.half_up].map(|half| across.dot(half) / half.length_squared())
    }

    fn half_area(&self) -> f64 {
        self.half_right.length() * self.half_up.length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_scene as scene;
    use proptest::prelude::*;
    use scene::{Projection as Kind, ThinLens};

    fn cameras(mirrored: bool) -> [Camera; 3] {
        let lens = ThinLens { radius_m: 0.05, focus_distance_m: 2.5 };
        let perspective = |lens| Kind::Perspective { vertical_fov_rad: 0.8, lens };
        [perspective(None), perspective(Some(lens)), Kind::Orthographic { height_m: 1.5 }].map(|projection| {
            let camera = scene::Camera {
                position_m: [1.0, 2.0, 3.0],
                forward: [0.0, 0.6, -0.8],
                up: [0.0, 0.8, 0.6],
                world_up: [0.0, 1.0, 0.0],
                mirrored,
                projection,
                near_m: 0.1,
                shutter_s: [0.0; 2],
                motion: None,
            };
            Camera::new(&camera, 300, 200, false)
        })
    }

    proptest! {
        /// Area by finite differences: rays through neighbouring points of the film meet a plane that faces the ray.
        #[test]
        fn a_ray_is_found_again_from_the_points_that_it_meets(
            x in -0.95..0.95_f64, y in -0.95..0.95_f64, u in 0.0..1.0_f64, v in 0.0..1.0_f64, distance in 0.5..30.0_f64,
        ) {
            for camera in [false, true].into_iter().flat_map(cameras) {
                let ray = camera.ray([x, y], [u, v]);
                let point = ray.origin + ray.direction * distance;
                let seen = camera.project(point, [u, v]).unwrap();
                prop_assert!((seen.film[0] - x).abs() < 1e-12 && (seen.film[1] - y).abs() < 1e-12, "{seen:?}");
                prop_assert!((seen.toward + ray.direction).length() < 1e-12);
                prop_assert!((seen.origin - ray.origin).length() < 1e-12 * distance);
                let step = 1e-4;
                let on_plane = |x: f64, y: f64| {
                    let ray = camera.ray([x, y], [u, v]);
                    let t = (point - ray.origin).dot(seen.toward) / ray.direction.dot(seen.toward);
                    ray.origin + ray.direction * t
                };
                let along_x = on_plane(x + step, y) - on_plane(x - step, y);
                let along_y = on_plane(x, y + step) - on_plane(x, y - step);
                let area = along_x.cross(along_y).length() / (4.0 * step * step);
                // Differences err by the square of the step, and by rounding over it.
                prop_assert!((seen.magnification * area - 1.0).abs() < 1e-6, "{} of {area}", seen.magnification);
            }
        }
    }

    #[test]
    fn what_is_behind_or_nearer_than_the_near_plane_is_not_seen() {
        let [pinhole, ..] = cameras(false);
        let forward = Vec3::new(0.0, 0.6, -0.8);
        let at = |distance: f64| pinhole.project(Vec3::new(1.0, 2.0, 3.0) + forward * distance, [0.5; 2]);
        assert!(at(-1.0).is_none() && at(0.05).is_none() && at(0.2).is_some());
    }
}
