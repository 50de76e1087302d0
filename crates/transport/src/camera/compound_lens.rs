//! Rays through lenses of many surfaces, from the film to the scene.
//!
//! Each surface is met where it is and refracts by Snell's law at the wavelength of the path (Kolb, Mitchell & Hanrahan 1995, *A Realistic
//! Camera Model for Computer Graphics*). Steinert et al. 2011, *General Spectral Camera Lens Simulation*, trace each wavelength by itself; so
//! do we: the hero alone goes on where the glass disperses.
//!
//! A pixel records E/(π sin²θ₀). E is the irradiance on the film. π sin²θ₀ is what a field of radiance 1 would cause on the axis, through
//! the same lens without losses. θ₀ is the half angle of the cone that reaches the middle of the film at the reference wavelength, traced, not paraxial. So
//! vignetting and cos⁴ are in the picture, the exposure is not: E = π sin²θ₀ · pixel.
//!
//! Coordinates: the middle of the film is the origin, z points toward the scene, lengths are metres.

#[cfg(test)]
mod tests;

use super::exit_pupil::{ExitPupil, RearEnd};
use etalon_optics::{RefractiveIndex, Vec3, fresnel, snell};
use etalon_scene::{CompoundLens, LensCoating, LensSurface};

/// Most steps of Newton's method toward an aspheric surface: each doubles the digits, and conics are met without.
const MOST_STEPS: usize = 24;
/// How near it must come, in units of the lengths involved.
const CLOSE: f64 = 4.0 * f64::EPSILON;

/// A lens ready to be traced.
#[derive(Debug)]
pub(crate) struct PreparedLens {
    /// From the film to the scene.
    surfaces: Vec<Interface>,
    /// Number of the stop among them.
    stop: usize,
    bare: bool,
    dispersive: bool,
    /// Height of the film, m, and z of the vertex of the first surface toward the scene.
    film_height_m: f64,
    front_m: f64,
    /// What a field of radiance 1 causes on the axis, without losses: π sin²θ₀.
    axial_irradiance: f64,
    pupil: ExitPupil,
}

/// A surface, and what light is in before and behind it on its way from the film.
#[derive(Debug)]
struct Interface {
    shape: LensSurface,
    /// z of its vertex.
    vertex_m: f64,
    /// The largest square of the distance from the axis.
    most_m2: f64,
    /// On the side of the film, and of the scene; `None` where both are the same.
    media: Option<[RefractiveIndex; 2]>,
}

/// A ray within a lens.
#[derive(Clone, Copy, Debug)]
struct LensRay {
    pub origin: Vec3<f64>,
    /// A unit vector.
    pub direction: Vec3<f64>,
}

/// What leaves a lens toward the scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passed {
    /// Where, from the vertex of the first surface.
    pub origin_m: Vec3<f64>,
    pub direction: Vec3<f64>,
    /// How much of the pixel's value radiance 1 along the ray is, over the density with which the ray was drawn.
    pub weight: f64,
}

impl PreparedLens {
    /// Prepares a lens for a film of `aspect` (width over height), on which points lie within `reach` times its half width and height, and
    /// for wavelengths of a range. `None` if the middle of the film sees nothing.
    pub(crate) fn new(lens: &CompoundLens, aspect: f64, reach: [f64; 2], range_nm: [f64; 2]) -> Option<Self> {
        let count = lens.surfaces.len();
        let mut vertex_m = lens.film_distance_m;
        let mut surfaces = Vec::with_capacity(count);
        for (i, shape) in lens.surfaces.iter().enumerate().rev() {
            vertex_m += shape.thickness_m;
            let (before, behind) = (lens.medium_before(i), &shape.medium);
            surfaces.push(Interface {
                shape: shape.clone(),
                vertex_m,
                most_m2: shape.semi_aperture_m * shape.semi_aperture_m,
                media: (before != behind).then(|| [behind.clone(), before.clone()]),
            });
        }
        let mut prepared = Self {
            stop: count - 1 - lens.stop(),
            bare: lens.coating == LensCoating::Bare,
            dispersive: lens.dispersive_medium().is_some(),
            film_height_m: lens.film_height_m,
            front_m: vertex_m,
            axial_irradiance: 0.0,
            pupil: ExitPupil::NOWHERE,
            surfaces,
        };
        let half_m = [0.5 * aspect * lens.film_height_m * reach[0], 0.5 * lens.film_height_m * reach[1]];
        let most_m = (half_m[0] * half_m[0] + half_m[1] * half_m[1]).sqrt();
        let middle_nm = 0.5 * (range_nm[0] + range_nm[1]);
        let wavelengths_nm = [range_nm[0], middle_nm, range_nm[1]];
        let checked = if prepared.dispersive { &wavelengths_nm[..] } else { &wavelengths_nm[1..2] };
        let (planes_m, radius_m) = prepared.rear_m();
        let at_stop = |origin, direction, nm| prepared.at_stop(LensRay { origin, direction }, nm);
        let rear = RearEnd { planes_m, radius_m, stop_m: prepared.stop_radius_m(), at_stop };
        prepared.pupil = ExitPupil::new(&rear, most_m, checked);
        let sine_squared = prepared.axial_sine_squared(lens.reference_nm)?;
        prepared.axial_irradiance = std::f64::consts::PI * sine_squared;
        Some(prepared)
    }

    /// sin θ₀ of the cone of light that reaches the middle of the film.
    pub(crate) fn axial_sine(&self) -> f64 {
        (self.axial_irradiance / std::f64::consts::PI).sqrt()
    }

    /// Whether rays of different wavelengths go different ways.
    pub(super) fn is_dispersive(&self) -> bool {
        self.dispersive
    }

    /// The ray through a point of the film, in [−1, 1]² with x to the right of the picture and y up, and a point of the exit pupil drawn by
    /// `lens_u`, at a wavelength. `None` if the lens blocks it.
    pub(super) fn ray(&self, film: [f64; 2], aspect: f64, lens_u: [f64; 2], wavelength_nm: f64) -> Option<Passed> {
        // The lens turns the picture by half a turn.
        let half_m = 0.5 * self.film_height_m;
        let (x, y) = (-film[0] * half_m * aspect, -film[1] * half_m);
        let radius_m = (x * x + y * y).sqrt();
        // Turned so that the point lies on the x axis.
        let (cos, sin) = if radius_m > 0.0 { (x / radius_m, y / radius_m) } else { (1.0, 0.0) };
        let aimed = self.pupil.draw(radius_m, lens_u);
        let from = Vec3::new(radius_m, 0.0, 0.0);
        let direction = (aimed.point_m - from).normalized();
        let ray = LensRay { origin: from, direction };
        let (ray, transmittance) = self.trace(ray, wavelength_nm)?;
        let turned = |v: Vec3<f64>| Vec3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z);
        // Irradiance is ∫ L cos θ dω = ∫ L cos⁴θ/z² dA over a plane at the distance z.
        let cos_squared = direction.z * direction.z;
        let distance_m = aimed.point_m.z;
        let cos4_over_z2 = cos_squared * cos_squared / (distance_m * distance_m);
        let origin = turned(ray.origin);
        Some(Passed {
            origin_m: Vec3::new(origin.x, origin.y, origin.z - self.front_m),
            direction: turned(ray.direction).normalized(),
            weight: transmittance * cos4_over_z2 * aimed.area_m2 / self.axial_irradiance,
        })
    }

    /// Follows a ray from the film to the scene: where it leaves the first surface, and the share of light that comes through. `None` if it
    /// is blocked.
    fn trace(&self, mut ray: LensRay, wavelength_nm: f64) -> Option<(LensRay, f64)> {
        let mut transmittance = 1.0;
        for interface in &self.surfaces {
            let (at, normal) = interface.meet(&ray)?;
            if at.x * at.x + at.y * at.y > interface.most_m2 {
                return None;
            }
            ray = interface.refract(&ray, at, normal, wavelength_nm, self.bare.then_some(&mut transmittance))?;
        }
        Some((ray, transmittance))
    }

    /// Where a ray from the film meets the stop, whatever other apertures it has passed: x and y, m.
    fn at_stop(&self, mut ray: LensRay, wavelength_nm: f64) -> Option<[f64; 2]> {
        for interface in &self.surfaces[..self.stop] {
            let (at, normal) = interface.meet(&ray)?;
            ray = interface.refract(&ray, at, normal, wavelength_nm, None)?;
        }
        let (at, _) = self.surfaces[self.stop].meet(&ray)?;
        Some([at.x, at.y])
    }

    /// Radius of the stop, m.
    fn stop_radius_m(&self) -> f64 {
        self.surfaces[self.stop].shape.semi_aperture_m
    }

    /// The z of the two planes between which the surface next to the film lies, m, and the radius of its aperture.
    fn rear_m(&self) -> ([f64; 2], f64) {
        let rear = &self.surfaces[0];
        let rim_m = rear.vertex_m - rear.shape.sag_m(rear.most_m2);
        ([rear.vertex_m.min(rim_m), rear.vertex_m.max(rim_m)], rear.shape.semi_aperture_m)
    }

    /// sin² of the half angle of the cone of light on the middle of the film.
    fn axial_sine_squared(&self, wavelength_nm: f64) -> Option<f64> {
        const STEPS: u32 = 4096;
        let ([plane_m, _], radius_m) = self.rear_m();
        let passes = |height_m: f64| {
            let direction = Vec3::new(height_m, 0.0, plane_m).normalized();
            self.trace(LensRay { origin: Vec3::ZERO, direction }, wavelength_nm).is_some()
        };
        let height_m = |step: u32| radius_m * f64::from(step) / f64::from(STEPS);
        // One step beyond the rim, where everything is blocked.
        let first_blocked = (0..=STEPS + 1).find(|&step| !passes(height_m(step)))?;
        let (mut low, mut high) = (height_m(first_blocked.checked_sub(1)?), height_m(first_blocked));
        // As often as there are bits.
        for _ in 0..64 {
            let middle = 0.5 * (low + high);
            if passes(middle) { low = middle } else { high = middle }
        }
        // At the very least the smallest step is open.
        let squared = low * low;
        (low > 0.0).then(|| squared / (squared + plane_m * plane_m))
    }
}

impl Interface {
    /// Where a ray meets the surface, and a normal there, not of unit length.
    fn meet(&self, ray: &LensRay) -> Option<(Vec3<f64>, Vec3<f64>)> {
        let LensSurface { curvature_per_m: c, conic, aspheric, .. } = &self.shape;
        let (c, d) = (*c, ray.direction);
        // From the plane that touches the vertex, where the sag is 0. It grows against z.
        let to_plane = (self.vertex_m - ray.origin.z) / d.z;
        let o = ray.origin + d * to_plane;
        let (k, ds) = (1.0 + conic, -d.z);
        // c (x² + y² + (1 + κ) s²) = 2 s along the ray: a t² + 2 b t + e = 0. The smaller root is on the side of the vertex.
        let a = c * (d.x * d.x + d.y * d.y + k * ds * ds);
        let b = c * (o.x * d.x + o.y * d.y) - ds;
        let e = c * (o.x * o.x + o.y * o.y);
        let discriminant = b * b - a * e;
        if discriminant < 0.0 {
            return None;
        }
        let root = discriminant.sqrt();
        let mut t = e / if b > 0.0 { -b - root } else { -b + root };
        if !aspheric.is_empty() {
            t = self.approach(o, d, t)?;
        }
        let at = Vec3::new(o.x + d.x * t, o.y + d.y * t, self.vertex_m + d.z * t);
        let slope = self.shape.sag_slope_per_m(at.x * at.x + at.y * at.y);
        // The surface has ended before, or the ray meets its far side.
        let is_beyond = aspheric.is_empty() && 1.0 - k * c * (self.vertex_m - at.z) <= 0.0;
        if is_beyond || !slope.is_finite() {
            return None;
        }
        Some((at, Vec3::new(2.0 * at.x * slope, 2.0 * at.y * slope, 1.0)))
    }

    /// Newton's method for s(t) = sag(ρ²(t)), from the conic.
    fn approach(&self, o: Vec3<f64>, d: Vec3<f64>, mut t: f64) -> Option<f64> {
        for _ in 0..MOST_STEPS {
            let (x, y) = (o.x + d.x * t, o.y + d.y * t);
            let q = x * x + y * y;
            let (sag, slope) = (self.shape.sag_m(q), self.shape.sag_slope_per_m(q));
            let step = (-d.z * t - sag) / (-d.z - slope * 2.0 * (x * d.x + y * d.y));
            t -= step;
            if step.abs() <= CLOSE * (t.abs() + q.sqrt()) {
                return Some(t);
            }
        }
        None
    }

    /// The ray behind the surface; `transmittance` is multiplied by the share of unpolarised light that goes through.
    fn refract(
        &self,
        ray: &LensRay,
        at: Vec3<f64>,
        normal: Vec3<f64>,
        wavelength_nm: f64,
        transmittance: Option<&mut f64>,
    ) -> Option<LensRay> {
        let Some([before, behind]) = &self.media else { return Some(LensRay { origin: at, ..*ray }) };
        let eta = behind.eval(wavelength_nm) / before.eval(wavelength_nm);
        let (normal, back) = (normal.normalized(), -ray.direction);
        let normal = if normal.dot(back) < 0.0 { -normal } else { normal };
        // Rounding may carry the product of two unit vectors past 1.
        let cos = normal.dot(back).min(1.0);
        let cos_t = fresnel::refracted_cosine(cos, eta)?;
        if let Some(transmittance) = transmittance {
            *transmittance *= 1.0 - fresnel::dielectric_reflectance(cos, eta).0;
        }
        Some(LensRay { origin: at, direction: snell::refract_with_cosines(back, normal, eta, cos, cos_t) })
    }
}
