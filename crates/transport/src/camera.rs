//! Cameras: from film and lens coordinates to a ray.
//!
//! A camera records the radiance along its rays, averaged over the pixel's filter and the lens; there is no cos⁴ fall-off
//! and no exposure. The ray that belongs to the centre of the lens is the pinhole's ray. Compound lenses are the exception: they record
//! the irradiance on their film (see `camera::compound_lens`).

mod compound_lens;
mod exit_pupil;
mod projection;

pub(crate) use compound_lens::PreparedLens;

use crate::frame::SceneFrame;
use crate::warp::concentric_disk;
use etalon_geometry::{Motion, Ray};
use etalon_optics::Vec3;
use etalon_scene as scene;
use etalon_scene::Projection;
use std::sync::Arc;

/// A camera ready to make rays.
#[derive(Clone, Debug)]
pub struct Camera {
    position: Vec3<f64>,
    forward: Vec3<f64>,
    /// Half the width of the picture, at unit distance (perspective) or in the world (orthographic).
    half_right: Vec3<f64>,
    /// Half its height.
    half_up: Vec3<f64>,
    kind: Kind,
    /// Distance along `forward` of the plane from which rays start.
    near: f64,
    moving: Option<Moving>,
}

/// How a camera moves. It is then prepared with its eye at the origin, turned as it stands before any motion.
#[derive(Clone, Debug)]
pub(crate) struct Moving {
    /// In the world, m.
    pub motion: Motion,
    /// The eye before any motion, in the world, m.
    pub eye_m: Vec3<f64>,
    pub frame: SceneFrame,
}

#[derive(Clone, Debug)]
enum Kind {
    Pinhole,
    ThinLens {
        right: Vec3<f64>,
        up: Vec3<f64>,
        focus_distance: f64,
    },
    Orthographic,
    /// `per_m` are the units of the frame in a metre.
    Compound {
        lens: Arc<PreparedLens>,
        right: Vec3<f64>,
        up: Vec3<f64>,
        aspect: f64,
        per_m: f64,
    },
}

/// A ray that a camera draws for a wavelength.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CameraRay {
    pub ray: Ray<f64>,
    /// What radiance along the ray counts for.
    pub weight: f64,
    /// Whether other wavelengths would have gone elsewhere.
    pub hero_only: bool,
}

impl CameraRay {
    fn plain(ray: Ray<f64>) -> Self {
        Self { ray, weight: 1.0, hero_only: false }
    }
}

impl Camera {
    /// Prepares a scene's camera for a film of `width` × `height` square pixels.
    ///
    /// `lens` gives a pinhole a lens of radius 0, which draws points on it and changes no ray.
    pub fn new(camera: &scene::Camera, width: u32, height: u32, lens: bool) -> Self {
        let forward = Vec3::from_array(camera.forward);
        let up = Vec3::from_array(camera.up);
        let right = Vec3::from_array(camera.right());
        let aspect = f64::from(width) / f64::from(height);
        let (half_height, kind) = match &camera.projection {
            Projection::Perspective { vertical_fov_rad, lens: thin } => {
                let of = |radius_m: f64, focus_distance_m: f64| Kind::ThinLens {
                    right: right * radius_m,
                    up: up * radius_m,
                    focus_distance: focus_distance_m,
                };
                let kind = match thin {
                    // A lens of radius 0 is a pinhole, bit for bit (hard case 35).
                    Some(thin) if thin.radius_m > 0.0 => of(thin.radius_m, thin.focus_distance_m),
                    _ if lens => of(0.0, 1.0),
                    _ => Kind::Pinhole,
                };
                ((0.5 * vertical_fov_rad).tan(), kind)
            }
            Projection::Orthographic { height_m } => (0.5 * height_m, Kind::Orthographic),
            // See `through`; without its lens it is a pinhole of the same view.
            Projection::CompoundLens(lens) => (lens.half_view(), Kind::Pinhole),
        };
        Self {
            position: Vec3::from_array(camera.position_m),
            forward,
            half_right: right * (half_height * aspect),
            half_up: up * half_height,
            kind,
            near: camera.near_m,
            moving: None,
        }
    }

    /// The camera with its compound lens, in a frame with `per_m` units in a metre.
    pub(crate) fn through(self, lens: Arc<PreparedLens>, aspect: f64, per_m: f64) -> Self {
        let (right, up) = (self.half_right.normalized(), self.half_up.normalized());
        Self { kind: Kind::Compound { lens, right, up, aspect, per_m }, ..self }
    }

    /// The camera, its eye at the origin, as it moves.
    pub(crate) fn moving(self, moving: Moving) -> Self {
        Self { moving: Some(moving), ..self }
    }

    /// Along the picture's right at a time; not of unit length.
    pub(crate) fn right(&self, time: f64) -> Vec3<f64> {
        match &self.moving {
            None => self.half_right,
            Some(moving) => moving.motion.at(time).vector(self.half_right),
        }
    }

    /// [`Camera::ray`] at a time of the shutter's, from 0 as it opens to 1 as it closes.
    pub(crate) fn ray_at(&self, film: [f64; 2], lens_u: [f64; 2], time: f64) -> Ray<f64> {
        self.moved(self.ray(film, lens_u), time)
    }

    /// As [`Camera::ray_at`], for light of one wavelength; `None` where the lens blocks it.
    pub(crate) fn ray_of(&self, film: [f64; 2], lens_u: [f64; 2], time: f64, wavelength_nm: f64) -> Option<CameraRay> {
        let Kind::Compound { lens, right, up, aspect, per_m } = &self.kind else {
            return Some(CameraRay::plain(self.ray_at(film, lens_u, time)));
        };
        let passed = lens.ray(film, *aspect, lens_u, wavelength_nm)?;
        let world = |v: Vec3<f64>| *right * v.x + *up * v.y + self.forward * v.z;
        let ray = Ray::free(self.position + world(passed.origin_m) * *per_m, world(passed.direction).normalized());
        let (weight, hero_only) = (passed.weight, lens.is_dispersive());
        Some(CameraRay { ray: self.moved(ray, time), weight, hero_only })
    }

    /// Whether rays depend on their wavelength, and may be blocked: [`Camera::ray_of`].
    pub(crate) fn is_compound(&self) -> bool {
        matches!(self.kind, Kind::Compound { .. })
    }

    /// The camera's own ray where it is at a time.
    fn moved(&self, ray: Ray<f64>, time: f64) -> Ray<f64> {
        match &self.moving {
            None => Ray { time, ..ray },
            Some(Moving { motion, eye_m, frame }) => {
                let placement = motion.at(time);
                let eye = frame.point(placement.point(*eye_m));
                // Its rotation is one to rounding.
                let direction = placement.vector(ray.direction).normalized();
                Ray { origin: eye + placement.vector(ray.origin), direction, time, ..ray }
            }
        }
    }

    /// Whether [`Camera::ray`] draws a point on a lens.
    pub fn has_lens(&self) -> bool {
        matches!(self.kind, Kind::ThinLens { .. } | Kind::Compound { .. })
    }

    /// The ray through `film`, in [−1, 1]² with x to the right and y up, and through the lens at `lens_u` in [0, 1)².
    /// Its direction is a unit vector.
    pub fn ray(&self, film: [f64; 2], lens_u: [f64; 2]) -> Ray<f64> {
        match &self.kind {
            Kind::ThinLens { right, up, focus_distance } => {
                self.through_lens(film, lens_u, (*right, *up, *focus_distance))
            }
            // A compound lens has its rays by wavelength: `ray_of`.
            Kind::Pinhole | Kind::Compound { .. } => self.through_pinhole(film),
            Kind::Orthographic => self.parallel(film),
        }
    }

    /// [`Camera::ray`] for many points; `put` is given each ray with its number. Loops without branches, for vectorisation.
    #[inline(always)]
    pub(crate) fn rays<const W: usize>(
        &self,
        film: [&[f64; W]; 2],
        lens_u: [&[f64; W]; 2],
        mut put: impl FnMut(usize, Ray<f64>),
    ) {
        let at = |rows: [&[f64; W]; 2], i: usize| [rows[0][i], rows[1][i]];
        match &self.kind {
            Kind::ThinLens { right, up, focus_distance } => {
                let lens = (*right, *up, *focus_distance);
                for i in 0..W {
                    put(i, self.through_lens(at(film, i), at(lens_u, i), lens));
                }
            }
            Kind::Pinhole | Kind::Compound { .. } => {
                for i in 0..W {
                    put(i, self.through_pinhole(at(film, i)));
                }
            }
            Kind::Orthographic => {
                for i in 0..W {
                    put(i, self.parallel(at(film, i)));
                }
            }
        }
    }

    #[inline(always)]
    fn across(&self, film: [f64; 2]) -> Vec3<f64> {
        self.half_right * film[0] + self.half_up * film[1]
    }

    #[inline(always)]
    fn through_lens(
        &self,
        film: [f64; 2],
        lens_u: [f64; 2],
        (right, up, focus_distance): (Vec3<f64>, Vec3<f64>, f64),
    ) -> Ray<f64> {
        let [x, y] = concentric_disk(lens_u);
        let lens = right * x + up * y;
        // From the lens point to the point in focus, relative to the lens's centre: the scene's origin and the
        // eye's position do not enter, so a distant focus loses no bits.
        let way = (self.forward + self.across(film)) * focus_distance - lens;
        Ray::free(self.position + lens + way * (self.near / focus_distance), way.normalized())
    }

    #[inline(always)]
    fn through_pinhole(&self, film: [f64; 2]) -> Ray<f64> {
        let way = self.forward + self.across(film);
        Ray::free(self.position + way * self.near, way.normalized())
    }

    #[inline(always)]
    fn parallel(&self, film: [f64; 2]) -> Ray<f64> {
        Ray::free(self.position + self.across(film), self.forward)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_scene::ThinLens;
    use proptest::prelude::*;

    fn camera(projection: Projection) -> scene::Camera {
        scene::Camera {
            position_m: [1.0, 2.0, 3.0],
            forward: [0.0, 0.0, -1.0],
            up: [0.0, 1.0, 0.0],
            world_up: [0.0, 1.0, 0.0],
            mirrored: false,
            projection,
            near_m: 0.0,
            shutter_s: [0.0; 2],
            motion: None,
        }
    }

    fn thin(radius_m: f64, focus_distance_m: f64) -> Camera {
        let lens = Some(ThinLens { radius_m, focus_distance_m });
        Camera::new(&camera(Projection::Perspective { vertical_fov_rad: 0.8, lens }), 300, 200, false)
    }

    proptest! {
        #[test]
        fn lens_rays_meet_in_the_plane_of_focus(
            x in -1.0..1.0_f64, y in -1.0..1.0_f64, u in 0.0..1.0_f64, v in 0.0..1.0_f64,
            radius in 1e-6..1.0_f64, focus in 0.1..1e6_f64,
        ) {
            let pinhole = thin(0.0, focus).ray([x, y], [u, v]);
            let ray = thin(radius, focus).ray([x, y], [u, v]);
            let at_focus = |r: &Ray<f64>| r.origin + r.direction * ((3.0 - focus - r.origin.z) / r.direction.z);
            let gap = at_focus(&ray) - at_focus(&pinhole);
            // A few roundings of numbers as large as the distance, and of the position.
            prop_assert!(gap.length() <= 8.0 * f64::EPSILON * (focus * 1.5 + radius + 4.0), "{gap:?}");
            prop_assert!((ray.direction.length() - 1.0).abs() <= 4.0 * f64::EPSILON);
            prop_assert!((ray.origin - pinhole.origin).length() <= radius * (1.0 + 4.0 * f64::EPSILON));
        }

        #[test]
        fn a_lens_of_radius_zero_is_the_pinhole_bit_for_bit(x in -1.0..1.0_f64, y in -1.0..1.0_f64, u in 0.0..1.0_f64) {
            let pinhole =
                Camera::new(&camera(Projection::Perspective { vertical_fov_rad: 0.8, lens: None }), 300, 200, false);
            let forced =
                Camera::new(&camera(Projection::Perspective { vertical_fov_rad: 0.8, lens: None }), 300, 200, true);
            prop_assert!(forced.has_lens() && !pinhole.has_lens());
            let a = pinhole.ray([x, y], [u, u]);
            for b in [thin(0.0, 5.0).ray([x, y], [u, u]), forced.ray([x, y], [u, u])] {
                prop_assert_eq!(a.direction, b.direction);
                prop_assert_eq!(a.origin, b.origin);
            }
        }
    }

    proptest! {
        #[test]
        fn rays_start_on_the_near_plane(
            x in -1.0..1.0_f64, y in -1.0..1.0_f64, u in 0.0..1.0_f64, v in 0.0..1.0_f64, radius in 0.0..1.0_f64, near in 0.0..100.0_f64,
        ) {
            let lens = Some(ThinLens { radius_m: radius, focus_distance_m: 3.0 });
            let of = |near_m: f64| {
                let projection = Projection::Perspective { vertical_fov_rad: 0.8, lens: lens.clone() };
                Camera::new(&scene::Camera { near_m, ..camera(projection) }, 300, 200, false).ray([x, y], [u, v])
            };
            let (whole, cut) = (of(0.0), of(near));
            prop_assert_eq!(whole.direction, cut.direction);
            // A few roundings of numbers as large as the distance and the position.
            let rounding = 8.0 * f64::EPSILON * (2.0 * near + 4.0);
            prop_assert!((3.0 - near - cut.origin.z).abs() <= rounding, "{:?}", cut.origin);
            let way = cut.origin - whole.origin;
            prop_assert!((way - whole.direction * way.length()).length() <= 2.0 * rounding, "{way:?}");
        }
    }

    #[test]
    fn field_of_view_is_the_full_vertical_angle() {
        let c = thin(0.0, 1.0);
        let (top, bottom) = (c.ray([0.0, 1.0], [0.0; 2]).direction, c.ray([0.0, -1.0], [0.0; 2]).direction);
        assert!((top.dot(bottom).acos() - 0.8).abs() < 1e-14);
        // Right-handed: looking down −z with y up, x is to the right, and pixels are square.
        let right = c.ray([1.0, 0.0], [0.0; 2]).direction;
        assert!((right.x / -right.z - 1.5 * 0.4_f64.tan()).abs() < 1e-14);
    }

    #[test]
    fn a_mirrored_camera_exchanges_left_and_right_of_film_and_lens() {
        let lens = Some(ThinLens { radius_m: 0.1, focus_distance_m: 2.0 });
        for projection in
            [Projection::Perspective { vertical_fov_rad: 0.8, lens }, Projection::Orthographic { height_m: 2.0 }]
        {
            let straight = camera(projection);
            let of = |mirrored| {
                Camera::new(&scene::Camera { mirrored, ..straight.clone() }, 300, 200, false)
                    .ray([0.7, 0.3], [0.2, 0.6])
            };
            let (straight, mirrored) = (of(false), of(true));
            assert_eq!(
                mirrored.origin - Vec3::new(1.0, 0.0, 0.0),
                reflect_x(straight.origin - Vec3::new(1.0, 0.0, 0.0))
            );
            assert_eq!(mirrored.direction, reflect_x(straight.direction));
        }
    }

    /// Left for right: the cameras of these tests look along −z with y up.
    fn reflect_x(v: Vec3<f64>) -> Vec3<f64> {
        Vec3::new(-v.x, v.y, v.z)
    }

    #[test]
    fn orthographic_rays_are_parallel_and_span_the_height() {
        let c = Camera::new(&camera(Projection::Orthographic { height_m: 4.0 }), 200, 100, false);
        let (a, b) = (c.ray([-1.0, -1.0], [0.0; 2]), c.ray([1.0, 1.0], [0.0; 2]));
        assert_eq!(a.direction, b.direction);
        assert_eq!(b.origin - a.origin, Vec3::new(8.0, 4.0, 0.0));
    }
}
