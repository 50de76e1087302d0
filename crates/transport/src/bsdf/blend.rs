//! Two materials side by side, finer than can be seen: f = (1 − w)·f₁ + w·f₂.

use super::{Bsdf, BsdfSample, Lobe, Shading};
use crate::mis::Density;
use crate::polarisation::mueller::{self, Matrix};
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

    /// The part that a number in [0, 1) chooses, and what is left of the number for the choices within it.
    fn choose(&self, u: f64) -> (usize, f64) {
        let (part, rest) = match u < self.weight {
            true => (1, u / self.weight),
            false => (0, (u - self.weight) / (1.0 - self.weight)),
        };
        (part, rest.min(f64::ONE_MINUS_EPSILON))
    }

    /// What it does to polarised light, in the frames of `x`: a delta is one part's own, else both parts count, each by what it
    /// scatters.
    pub(super) fn mueller<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        (wo, wi, x): (Vec3<f64>, Vec3<f64>, Vec3<f64>),
        lobe: Lobe,
    ) -> Option<[Matrix; N]> {
        if let Lobe::Delta(u) = lobe {
            let (part, rest) = self.choose(u);
            return self.parts[part].mueller_around(lambda_nm, n, at, (wo, wi, x), Lobe::Delta(rest));
        }
        let [first, second] = [0, 1].map(|i| {
            let (f_cos, _) = self.parts[i].eval_around::<f64, N>(lambda_nm, n, at, wo, wi);
            let matrices = self.parts[i].mueller_around(lambda_nm, n, at, (wo, wi, x), lobe);
            (f_cos * self.shares()[i], matrices.unwrap_or([mueller::DEPOLARISER; N]))
        });
        Some(std::array::from_fn(|lane| {
            mueller::mixed([&first, &second].map(|(f_cos, matrices)| (f_cos[lane], matrices[lane])))
        }))
    }

    /// See [`Bsdf::prepare_polarisation`].
    pub(super) fn prepare_polarisation(&mut self) {
        self.parts.iter_mut().for_each(Bsdf::prepare_polarisation);
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
        let (part, rest) = self.choose(u_part);
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
