//! Phase functions: into which directions media scatter light. One a file, one door, [`Phase`].
//!
//! All depend on the cosine of the angle of scattering alone, between the direction in which light comes and that in which it leaves, and
//! integrate to 1 over the sphere. None depends on the wavelength: all lanes draw a direction with the same density, which is the phase
//! function itself.

mod henyey_greenstein;
mod rayleigh;
mod tabulated;

use crate::polarisation::LinearWorth;
use crate::polarisation::mueller::{Matrix, Mueller};
use etalon_optics::{Frame, Real, Vec3};
use etalon_scene::PhaseFunction;
use henyey_greenstein::HenyeyGreenstein;
use std::f64::consts::PI;
use tabulated::Tabulated;

/// Where a medium scatters light.
#[derive(Clone, Debug)]
pub(crate) struct Phase(Kind);

#[derive(Clone, Debug)]
enum Kind {
    Isotropic,
    HenyeyGreenstein(HenyeyGreenstein),
    /// Two, the first with this share.
    Double([HenyeyGreenstein; 2], f64),
    Rayleigh,
    Tabulated(Tabulated),
}

impl Phase {
    /// The phase function of a scene.
    pub(crate) fn new(phase: &PhaseFunction) -> Self {
        Self(match phase {
            PhaseFunction::Isotropic => Kind::Isotropic,
            PhaseFunction::HenyeyGreenstein { g } => Kind::HenyeyGreenstein(HenyeyGreenstein { g: *g }),
            PhaseFunction::DoubleHenyeyGreenstein { g, weight } => {
                Kind::Double(g.map(|g| HenyeyGreenstein { g }), *weight)
            }
            PhaseFunction::Rayleigh => Kind::Rayleigh,
            PhaseFunction::Tabulated(table) => Kind::Tabulated(Tabulated::new(table)),
        })
    }

    /// Its value at a cosine of the angle of scattering, sr⁻¹: the density with which [`Phase::sample`] draws.
    #[inline]
    pub(crate) fn density(&self, cos: f64) -> f64 {
        match &self.0 {
            Kind::Isotropic => 0.25 / PI,
            Kind::HenyeyGreenstein(one) => one.density(cos),
            Kind::Double([first, second], weight) => weight * first.density(cos) + (1.0 - weight) * second.density(cos),
            Kind::Rayleigh => rayleigh::density(cos),
            Kind::Tabulated(table) => table.density(cos),
        }
    }

    /// Draws a cosine of the angle of scattering by a number in [0, 1).
    #[inline]
    fn cosine(&self, u: f64) -> f64 {
        match &self.0 {
            Kind::Isotropic => 2.0 * u - 1.0,
            Kind::HenyeyGreenstein(one) => one.cosine(u),
            Kind::Double([first, second], weight) => match u < *weight {
                // What is left of the number is uniform again.
                true => first.cosine(u / weight),
                false => second.cosine((u - weight) / (1.0 - weight)),
            },
            Kind::Rayleigh => rayleigh::cosine(u),
            Kind::Tabulated(table) => table.cosine(u),
        }
    }

    /// Draws the direction from which light comes that is scattered toward `wo`; both unit vectors leave the point. Returns it and the
    /// value of the phase function there, sr⁻¹.
    #[inline]
    pub(crate) fn sample(&self, wo: Vec3<f64>, u: [f64; 2]) -> (Vec3<f64>, f64) {
        let cos = self.cosine(u[0]).clamp(-1.0, 1.0);
        let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
        let (sin_around, cos_around) = f64::sin_cos_turns(u[1]);
        let local = Vec3::new(sin * cos_around, sin * sin_around, cos);
        // The path goes on by −wo where light is not turned.
        let wi = Frame::from_normal(-wo).to_world(local).renormalized();
        // Of the direction as it came out, rounding included.
        (wi, self.density(-wo.dot(wi)))
    }

    /// As [`Phase::sample`], for a path that carries polarisation. Returns a direction, the value of the phase function there, sr⁻¹, and the
    /// density of the direction over that value.
    ///
    /// Light of one polarisation is worth more to the camera than light of another, and `worth` says how much more. Directions are drawn by
    /// what unpolarised light that comes from them is worth. The angle of scattering is drawn as without polarisation. Around `wo` the worth goes
    /// as 1 − k cos 2ψ, where ψ is the angle from the least worth. So 2ψ is drawn by Kepler's equation.
    pub(crate) fn sample_polarised(&self, wo: Vec3<f64>, worth: &LinearWorth, u: [f64; 2]) -> (Vec3<f64>, f64, f64) {
        let cos = self.cosine(u[0]).clamp(-1.0, 1.0);
        let Some(matrix) = self.matrix(cos) else {
            let (wi, density) = self.sample(wo, u);
            return (wi, density, 1.0);
        };
        let [s1, s2] = worth.s.map(|s| s * matrix[1][0]);
        let degree = s1.hypot(s2);
        // At most 1 but for rounding: no light is more than fully polarised.
        let k = degree.min(1.0);
        // The direction of least worth: it stands at half the angle of (s1, s2).
        let least = match degree > 0.0 {
            true if s1 >= 0.0 => [degree + s1, s2],
            true => [s2.abs(), (degree - s1).copysign(s2)],
            false => [1.0, 0.0],
        };
        let length = least[0].hypot(least[1]);
        let (sin_psi, cos_psi) = f64::sin_cos_turns(0.5 * eccentric_anomaly(2.0 * u[1], k));
        let [x, y] = least.map(|component| component / length);
        let (cos_around, sin_around) = (x * cos_psi - y * sin_psi, y * cos_psi + x * sin_psi);
        let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
        let across = worth.x * cos_around + wo.cross(worth.x) * sin_around;
        let wi = (across * sin - wo * cos).renormalized();
        let around = 1.0 - k * (cos_psi - sin_psi) * (cos_psi + sin_psi);
        (wi, self.density(-wo.dot(wi)), around)
    }

    /// What it does to polarisation at a cosine of the angle of scattering, over its first element, in frames whose x is across the plane of
    /// both directions; `None` if it depolarises.
    #[inline]
    fn matrix(&self, cos: f64) -> Option<Matrix> {
        match &self.0 {
            Kind::Rayleigh => Some(rayleigh::mueller(cos)),
            Kind::Tabulated(table) => table.mueller(cos),
            Kind::Isotropic | Kind::HenyeyGreenstein(_) | Kind::Double(..) => None,
        }
    }

    /// What it does to polarisation, in frames whose x is across the plane of both directions; `None` if it depolarises.
    #[inline]
    pub(crate) fn mueller<const N: usize>(&self, wo: Vec3<f64>, wi: Vec3<f64>) -> Option<Mueller<N>> {
        let matrix = self.matrix(-wo.dot(wi))?;
        let across = wo.cross(wi);
        // Straight on or back: any x will do.
        let x = if across.length_squared() > 0.0 { across } else { Frame::from_normal(wo).s };
        Some(Mueller::of([matrix; N], x))
    }
}

/// The root e of e − k sin(2πe)/2π = m, Kepler's equation in turns, for k in [0, 1] and m not negative: by Newton's method from above, where
/// each step comes nearer.
fn eccentric_anomaly(m: f64, k: f64) -> f64 {
    let whole = m.floor();
    let rest = m - whole;
    let nearest = rest.min(1.0 - rest);
    let mut e = if nearest < 0.5 * (1.0 - k) { nearest / (1.0 - k) } else { 0.5 };
    // As k and m come near 1 and 0, each step takes but a third of the error away.
    for _ in 0..STEPS_OF_KEPLER {
        let (sin, cos) = f64::sin_cos_turns(e);
        let next = e - (e - k / (2.0 * PI) * sin - nearest) / (1.0 - k * cos);
        // Below the root, or beside it by rounding alone.
        if !(next > 0.0 && next < e) {
            break;
        }
        e = next;
    }
    whole + if rest <= 0.5 { e } else { 1.0 - e }
}

/// More than any number of 53 bits takes.
const STEPS_OF_KEPLER: u32 = 64;

#[cfg(test)]
mod tests;
