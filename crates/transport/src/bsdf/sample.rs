//! Directions drawn from BSDFs.

use crate::mis::Density;
use etalon_optics::{Lanes, Vec3};

/// A direction drawn from a BSDF.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample<const N: usize> {
    /// Toward the light; a unit vector.
    pub wi: Vec3<f64>,
    /// f·|cos θ|/p in each lane, where p is the **hero's** density (or probability) of this direction.
    pub weight: Lanes<f64, N>,
    /// Density of `wi` for the hero wavelength.
    pub density: Density,
    /// Each lane's own density of this direction relative to the hero's: 0 for a lane that cannot take it.
    pub lane_density: Lanes<f64, N>,
    /// n_transmitted / n_incident if the path crossed an interface, else 1.
    pub eta: f64,
}

/// A direction as a BSDF draws it, before what it is worth is known.
#[derive(Clone, Copy, Debug)]
pub(super) enum Drawn<const N: usize> {
    /// With what it is worth, since no other lobe leads there.
    Sample(BsdfSample<N>),
    /// `wi`, with the sample's `eta`: [`Bsdf::eval`](super::Bsdf::eval) says what it is worth.
    Direction(Vec3<f64>, f64),
}

impl<const N: usize> Drawn<N> {
    /// A direction that facets or a ground reflect, of this cosine to the normal on the viewer's side. What comes out below the surface is lost: no other
    /// lobe may take it for its own.
    pub(super) fn reflected(wi: Vec3<f64>, cos: f64) -> Option<Self> {
        (cos > 0.0).then_some(Self::Direction(wi, 1.0))
    }

    /// The direction.
    pub(super) fn wi(&self) -> Vec3<f64> {
        match self {
            Self::Sample(sample) => sample.wi,
            Self::Direction(wi, _) => *wi,
        }
    }
}

impl<const N: usize> BsdfSample<N> {
    /// The sample of a direction drawn with each lane's own `density` as if it were the hero, from what [`Bsdf::eval`](super::Bsdf::eval) says
    /// of it; `None` where the hero's density is 0, which rounding may have made of the edge of a lobe.
    pub(super) fn scattered(wi: Vec3<f64>, f_cos: Lanes<f64, N>, density: Lanes<f64, N>, eta: f64) -> Option<Self> {
        let hero = density[0];
        (hero > 0.0).then(|| Self {
            wi,
            weight: f_cos / hero,
            density: Density::SolidAngle(hero),
            lane_density: density / hero,
            eta,
        })
    }
}
