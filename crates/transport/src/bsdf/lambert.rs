//! Ideal diffuse reflection on both sides: f = ρ/π (Lambert 1760), drawn in proportion to the cosine.

use super::{BsdfSample, Properties};
use crate::mis::Density;
use crate::spectral::PathSpectrum;
use crate::texture::{PathTexture, TexturePoint};
use crate::warp::cosine_hemisphere;
use etalon_optics::{Frame, Lanes, Vec3};
use etalon_scene::SpectrumTexture;
use std::f64::consts::FRAC_1_PI;

/// Ideal diffuse reflection.
#[derive(Clone, Debug)]
pub struct Lambert {
    reflectance: PathTexture,
}

impl Lambert {
    /// A surface of this albedo, in [0, 1].
    pub fn new(reflectance: PathTexture) -> Self {
        Self { reflectance }
    }

    /// See [`Properties`].
    pub(super) fn properties(reflectance: &SpectrumTexture) -> Properties {
        Properties { dark: reflectance.is_zero(), ..Properties::SOLID_ANGLE }
    }

    /// The reflectance, if it is the same everywhere.
    pub(crate) fn uniform(&self) -> Option<&PathSpectrum> {
        self.reflectance.uniform()
    }

    /// What it reflects of red, green and blue at a place, if an image or the vertices around show that.
    #[inline]
    pub(crate) fn colour(&self, place: TexturePoint) -> Option<[f64; 3]> {
        self.reflectance.colour(place)
    }

    /// At a place.
    #[inline]
    pub(crate) fn reflectance<const N: usize>(&self, lambda_nm: &Lanes<f64, N>, place: TexturePoint) -> Lanes<f64, N> {
        self.reflectance.lanes(lambda_nm, place)
    }

    pub(super) fn eval<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        place: TexturePoint,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> (Lanes<f64, N>, Lanes<f64, N>) {
        let cos = common_cosine(n, wo, wi);
        if cos == 0.0 {
            return (Lanes::ZERO, Lanes::ZERO);
        }
        let pdf = density(cos);
        (self.reflectance.lanes::<N>(lambda_nm, place) * pdf, Lanes::splat(pdf))
    }

    pub(super) fn sample<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        place: TexturePoint,
        wo: Vec3<f64>,
        u: [f64; 2],
    ) -> Option<BsdfSample<N>> {
        let (wi, cos_i) = direction(n, wo, u);
        (cos_i > 0.0).then(|| BsdfSample {
            wi,
            weight: self.reflectance.lanes(lambda_nm, place),
            density: Density::SolidAngle(density(cos_i)),
            lane_density: Lanes::ONE,
            eta: 1.0,
        })
    }
}

/// The normal on the side of `wo`.
#[inline(always)]
pub(crate) fn toward(n: Vec3<f64>, wo: Vec3<f64>) -> Vec3<f64> {
    if n.dot(wo) < 0.0 { -n } else { n }
}

/// A direction on the side of `wo`, and its cosine; drawn in vain where that is not above 0. Without branches, so that a loop over
/// surfaces is vectorised.
#[inline(always)]
pub(crate) fn direction(n: Vec3<f64>, wo: Vec3<f64>, u: [f64; 2]) -> (Vec3<f64>, f64) {
    let n = toward(n, wo);
    let wi = Frame::from_normal(n).to_world(cosine_hemisphere(u)).renormalized();
    // The cosine of the direction as it came out, rounding included, so that its density equals what `eval` says of it.
    (wi, n.dot(wi))
}

/// The cosine between `wi` and the normal on the side of `wo`; 0 if `wi` is on the other.
#[inline(always)]
pub(crate) fn common_cosine(n: Vec3<f64>, wo: Vec3<f64>, wi: Vec3<f64>) -> f64 {
    let cos = n.dot(wi);
    if cos * n.dot(wo) <= 0.0 { 0.0 } else { cos.abs() }
}

/// The density of a direction with this cosine, sr⁻¹.
#[inline(always)]
pub(crate) fn density(cos: f64) -> f64 {
    cos * FRAC_1_PI
}
