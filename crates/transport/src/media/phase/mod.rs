//! Phase functions: into which directions media scatter light. One a file, one door, [`Phase`].
//!
//! All depend on the cosine of the angle of scattering alone, between the direction in which light comes and that in which it leaves, and
//! integrate to 1 over the sphere. None depends on the wavelength: all lanes draw a direction with the same density, which is the phase
//! function itself.

mod henyey_greenstein;
mod rayleigh;
mod tabulated;

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

    /// What it does to polarisation, in frames whose x is across the plane of both directions; `None` if it depolarises.
    #[inline]
    pub(crate) fn mueller<const N: usize>(&self, wo: Vec3<f64>, wi: Vec3<f64>) -> Option<Mueller<N>> {
        let matrix: Matrix = match &self.0 {
            Kind::Rayleigh => rayleigh::mueller(-wo.dot(wi)),
            Kind::Tabulated(table) => table.mueller(-wo.dot(wi))?,
            Kind::Isotropic | Kind::HenyeyGreenstein(_) | Kind::Double(..) => return None,
        };
        let across = wo.cross(wi);
        // Straight on or back: any x will do.
        let x = if across.length_squared() > 0.0 { across } else { Frame::from_normal(wo).s };
        Some(Mueller::of([matrix; N], x))
    }
}

#[cfg(test)]
mod tests;
