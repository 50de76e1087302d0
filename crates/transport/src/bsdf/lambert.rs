//! Ideal diffuse reflection on both sides: f = ρ/π (Lambert 1760), drawn in proportion to the cosine.

use super::BsdfSample;
use crate::mis::Density;
use crate::texture::PathTexture;
use crate::warp::cosine_hemisphere;
use etalon_optics::{Frame, Lanes, Real, Vec3};
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

    pub(super) fn eval<R: Real, const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        uv: [f64; 2],
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> (Lanes<R, N>, Lanes<R, N>) {
        let cos_i = n.dot(wi);
        if cos_i * n.dot(wo) <= 0.0 {
            return (Lanes::ZERO, Lanes::ZERO);
        }
        let pdf = R::from_f64(cos_i.abs() * FRAC_1_PI);
        (self.reflectance.lanes::<R, N>(lambda_nm, uv) * pdf, Lanes::splat(pdf))
    }

    pub(super) fn sample<R: Real, const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        uv: [f64; 2],
        wo: Vec3<f64>,
        u: [f64; 2],
    ) -> Option<BsdfSample<R, N>> {
        let n = if n.dot(wo) < 0.0 { -n } else { n };
        let wi = Frame::from_normal(n).to_world(cosine_hemisphere(u)).renormalized();
        // The density of the direction as it came out, rounding included, so that it equals what `eval` says of it.
        let cos_i = n.dot(wi);
        (cos_i > 0.0).then(|| BsdfSample {
            wi,
            weight: self.reflectance.lanes(lambda_nm, uv),
            density: Density::SolidAngle(cos_i * FRAC_1_PI),
            lane_density: Lanes::ONE,
            eta: 1.0,
        })
    }
}
