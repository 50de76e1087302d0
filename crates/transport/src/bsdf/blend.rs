//! Materials side by side, finer than can be seen: f = (1 − w)·f₁ + w·f₂ of the two between whose places a number lies.

use super::{Bsdf, BsdfSample, Drawn, Lobe, Properties, Shading};
use crate::mis::Density;
use crate::polarisation::mueller::{self, Matrix};
use etalon_optics::{Lanes, Real, Vec3};
use etalon_scene::NumberTexture;

/// A mixture of materials.
#[derive(Clone, Debug)]
pub struct Blend {
    /// The numbers at which the parts stand alone, increasing.
    places: Vec<f64>,
    parts: Vec<Bsdf>,
    by: NumberTexture,
}

/// Two neighbours among the parts, each with its share of the surface.
#[derive(Clone, Copy)]
struct PartWeights([(usize, f64); 2]);

impl PartWeights {
    /// The part that a number in [0, 1) chooses, and what is left of the number for the choices within it.
    fn choose(self, u: f64) -> (usize, f64) {
        let Self([(first, _), (second, share)]) = self;
        let (part, rest) = match u < share {
            true => (second, u / share),
            false => (first, (u - share) / (1.0 - share)),
        };
        (part, rest.min(f64::ONE_MINUS_EPSILON))
    }
}

impl Blend {
    /// Materials, at least two, each with the number at which it stands alone, increasing, mixed everywhere as `by` says.
    pub fn new(parts: impl IntoIterator<Item = (f64, Bsdf)>, by: NumberTexture) -> Self {
        let (places, parts) = parts.into_iter().unzip();
        Self { places, parts, by }
    }

    /// What stands at texture coordinates.
    fn shares(&self, uv: [f64; 2]) -> PartWeights {
        let number = self.by.eval(uv);
        let second = self.places.partition_point(|place| *place <= number).clamp(1, self.places.len() - 1);
        let [from, to] = [self.places[second - 1], self.places[second]];
        let share = ((number - from) / (to - from)).clamp(0.0, 1.0);
        PartWeights([(second - 1, 1.0 - share), (second, share)])
    }

    /// The parts.
    pub(super) fn parts_mut(&mut self) -> impl Iterator<Item = &mut Bsdf> {
        self.parts.iter_mut()
    }

    /// The parts that stand at a place, each with the share of the surface that fluoresces there because of it.
    pub(super) fn fluorescent_parts(&self, at: &Shading<'_>, wo: Vec3<f64>) -> [(&Bsdf, f64); 2] {
        let PartWeights(shares) = self.shares(at.uv);
        shares.map(|(part, share)| {
            let part = &self.parts[part];
            (part, share * part.fluorescent_share(at, wo))
        })
    }

    /// See [`Properties`]: what any of the parts has.
    pub(super) fn properties(parts: impl IntoIterator<Item = Properties>) -> Properties {
        let both = |one: Properties, other: Properties| Properties {
            solid_angle: one.solid_angle || other.solid_angle,
            delta_reflection: one.delta_reflection || other.delta_reflection,
            delta_transmission: one.delta_transmission || other.delta_transmission,
            passes_straight: one.passes_straight || other.passes_straight,
            dark: one.dark && other.dark,
            polarising_axis: one.polarising_axis || other.polarising_axis,
            takes_tangents: one.takes_tangents || other.takes_tangents,
            takes_medium: one.takes_medium || other.takes_medium,
            fluoresces: one.fluoresces || other.fluoresces,
            smooth_name: if one.smooth_name.is_empty() { other.smooth_name } else { one.smooth_name },
        };
        parts.into_iter().reduce(both).unwrap_or(Properties { dark: true, ..Properties::default() })
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
        let shares = self.shares(at.uv);
        if let Lobe::Delta(u) = lobe {
            let (part, rest) = shares.choose(u);
            return self.parts[part].mueller_around(lambda_nm, n, at, (wo, wi, x), Lobe::Delta(rest));
        }
        let [first, second] = shares.0.map(|(i, share)| {
            let (f_cos, _) = self.parts[i].eval_around::<N>(lambda_nm, n, at, wo, wi);
            let matrices = self.parts[i].mueller_around(lambda_nm, n, at, (wo, wi, x), lobe);
            (f_cos * share, matrices.unwrap_or([mueller::DEPOLARISER; N]))
        });
        Some(std::array::from_fn(|lane| {
            mueller::mixed([&first, &second].map(|(f_cos, matrices)| (f_cos[lane], matrices[lane])))
        }))
    }

    /// See [`Bsdf::prepare_polarisation`].
    pub(super) fn prepare_polarisation(&mut self) {
        self.parts.iter_mut().for_each(Bsdf::prepare_polarisation);
    }

    pub(super) fn eval<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> (Lanes<f64, N>, Lanes<f64, N>) {
        let mut sums = (Lanes::ZERO, Lanes::ZERO);
        for (part, share) in self.shares(at.uv).0 {
            let (f_cos, density) = self.parts[part].eval_around(lambda_nm, n, at, wo, wi);
            sums = (sums.0 + f_cos * share, sums.1 + density * share);
        }
        sums
    }

    pub(super) fn draw<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        u: [f64; 3],
    ) -> Option<Drawn<N>> {
        let [u_part, u1, u2] = u;
        let (part, rest) = self.shares(at.uv).choose(u_part);
        let drawn = self.parts[part].draw_around(lambda_nm, n, at, wo, [rest, u1, u2])?;
        Some(match drawn {
            // The part's share is in its value and in its probability.
            Drawn::Sample(BsdfSample { density: Density::Delta, .. }) => drawn,
            // Both parts may scatter there.
            Drawn::Sample(BsdfSample { wi, eta, .. }) | Drawn::Direction(wi, eta) => Drawn::Direction(wi, eta),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn three(by: f64) -> Blend {
        Blend::new([(0.2, Bsdf::Black), (0.5, Bsdf::Black), (1.0, Bsdf::Black)], NumberTexture::Uniform(by))
    }

    /// Linear between two neighbours, one part alone before the first and after the last.
    #[test]
    fn a_number_between_two_places_shares_the_surface_between_their_parts() {
        for (by, expected) in [
            (0.0, [1.0, 0.0, 0.0]),
            (0.2, [1.0, 0.0, 0.0]),
            (0.275, [0.75, 0.25, 0.0]),
            (0.5, [0.0, 1.0, 0.0]),
            (0.625, [0.0, 0.75, 0.25]),
            (1.0, [0.0, 0.0, 1.0]),
            (3.0, [0.0, 0.0, 1.0]),
        ] {
            let mut shares = [0.0; 3];
            three(by).shares([0.0; 2]).0.iter().for_each(|(part, share)| shares[*part] += share);
            assert!(shares.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{by}: {shares:?}");
        }
    }

    /// Each part is chosen as often as its share says, and what is left of the number is uniform again.
    #[test]
    fn choosing_a_part_leaves_a_whole_number_for_the_choices_within_it() {
        let shares = three(0.625).shares([0.0; 2]);
        for rest in [0.0, 0.3, 0.999] {
            for (part, u) in [(2, 0.25 * rest), (1, 0.25 + 0.75 * rest)] {
                let (chosen, left) = shares.choose(u);
                assert!(chosen == part && (left - rest).abs() < 1e-12, "{u}: {chosen}, {left}");
            }
        }
    }
}
