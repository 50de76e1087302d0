//! Two materials side by side, finer than can be seen: f = (1 − w)·f₁ + w·f₂.

use super::{Bsdf, BsdfSample, Shading};
use crate::mis::Density;
use etalon_optics::{Lanes, Real, Vec3};

/// A mixture of two materials.
#[derive(Clone, Debug)]
pub struct Blend {
    parts: Box<[Bsdf; 2]>,
    weight: f64,
}

impl Blend {
    /// `first` and, with the share `weight` in [0, 1] of the surface, `second`.
    pub fn new(first: Bsdf, second: Bsdf, weight: f64) -> Self {
        Self { parts: Box::new([first, second]), weight }
    }

    /// Whether either part scatters what arrives from a given direction.
    pub(super) fn has_solid_angle_part(&self) -> bool {
        self.parts.iter().any(Bsdf::has_solid_angle_part)
    }

    /// Whether what either part does depends on the medium that it stands in.
    pub(super) fn takes_medium(&self) -> bool {
        self.parts.iter().any(Bsdf::takes_medium)
    }

    fn shares(&self) -> [f64; 2] {
        [1.0 - self.weight, self.weight]
    }

    pub(super) fn eval<R: Real, const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> (Lanes<R, N>, Lanes<R, N>) {
        let mut sums = (Lanes::ZERO, Lanes::ZERO);
        for (part, share) in self.parts.iter().zip(self.shares()) {
            let (f_cos, density) = part.eval_around(lambda_nm, n, at, wo, wi);
            let share = R::from_f64(share);
            sums = (sums.0 + f_cos * share, sums.1 + density * share);
        }
        sums
    }

    pub(super) fn sample<R: Real, const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        u: [f64; 3],
    ) -> Option<BsdfSample<R, N>> {
        let [u_part, u1, u2] = u;
        let (part, rest) = match u_part < self.weight {
            true => (1, u_part / self.weight),
            false => (0, (u_part - self.weight) / (1.0 - self.weight)),
        };
        let rest = rest.min(f64::ONE_MINUS_EPSILON);
        let next = self.parts[part].sample_around(lambda_nm, n, at, wo, [rest, u1, u2])?;
        match next.density {
            // The part's share is in its value and in its probability.
            Density::Delta => Some(next),
            Density::SolidAngle(_) => {
                let (f_cos, density) = self.eval(lambda_nm, n, at, wo, next.wi);
                BsdfSample::scattered(next.wi, f_cos, density, next.eta)
            }
        }
    }
}
