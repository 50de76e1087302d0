//! Diffuse reflection, and light that is given back at another wavelength.
//!
//! What stays at its wavelength is reflected as by [`Lambert`], which is all that this BSDF says. What comes back at others is a step of the path:
//! `integrator/fluorescence.rs`, which draws wavelengths of excitation here and asks for the reradiation between them and those of the path.

use super::{Bsdf, BsdfSample, Lambert, Properties, Shading};
use crate::spectral::PathSpectrum;
use crate::texture::PathTexture;
use etalon_optics::spectrum::{simpson, whole_nm};
use etalon_optics::{Fluorescence, Lanes, ReradiationMatrix, Vec3};
use etalon_scene::SpectrumTexture;

/// A surface that reflects and fluoresces, both diffusely.
#[derive(Clone, Debug)]
pub struct Fluorescent {
    reflection: Lambert,
    /// `None` where nothing that is rendered excites it.
    reradiation: Option<Reradiation>,
}

/// Reradiation prepared for paths.
#[derive(Clone, Debug)]
pub struct Reradiation {
    parts: Parts,
    excitation: ExcitationDistribution,
}

/// A part of a surface that fluoresces at a point.
pub(crate) struct FluorescentPart<'a> {
    /// The share of the surface that all such parts have.
    pub share: f64,
    /// What this one gives back.
    pub reradiation: &'a Reradiation,
    /// What it does to light that keeps its wavelength.
    pub reflection: &'a Lambert,
}

#[derive(Clone, Debug)]
enum Parts {
    /// Of each dye the absorption, the emission, and their factor.
    Fluorophores(Vec<(PathSpectrum, PathSpectrum, f64)>),
    Matrix(ReradiationMatrix),
}

/// A density over wavelengths of excitation, constant between whole nanometres and kinks. Half of it is in proportion to the power that comes back of
/// white light. The other half is in proportion to that of the light of the scene's lamps. Before these are known, all of it is the former.
#[derive(Clone, Debug)]
struct ExcitationDistribution {
    borders_nm: Vec<f64>,
    /// The probability up to each border.
    cumulative: Vec<f64>,
}

impl Fluorescent {
    /// A surface of this albedo at the wavelength of the light, and this reradiation; of wavelengths within `range_nm`.
    pub fn new(reflectance: PathTexture, fluorescence: &Fluorescence, range_nm: [f64; 2]) -> Self {
        Self { reflection: Lambert::new(reflectance), reradiation: Reradiation::new(fluorescence, range_nm) }
    }

    /// See [`Properties`].
    pub(super) fn properties(reflectance: &SpectrumTexture) -> Properties {
        Properties { dark: false, fluoresces: true, ..Lambert::properties(reflectance) }
    }

    /// What it does to light that keeps its wavelength.
    pub(crate) fn reflection(&self) -> &Lambert {
        &self.reflection
    }

    pub(super) fn eval<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> (Lanes<f64, N>, Lanes<f64, N>) {
        self.reflection.eval(lambda_nm, n, at.texture_point(), wo, wi)
    }

    pub(super) fn sample<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        u: [f64; 2],
    ) -> Option<BsdfSample<N>> {
        self.reflection.sample(lambda_nm, n, at.texture_point(), wo, u)
    }
}

impl Bsdf {
    /// Says what light there is in the scene, in any unit: what excites a surface is looked for where light is.
    pub(crate) fn expect_light(&mut self, light: &PathSpectrum) {
        match self {
            Self::Fluorescent(Fluorescent { reradiation: Some(reradiation), .. }) => {
                reradiation.excitation.draw_half_toward(light);
            }
            Self::Blend(blend) => blend.parts_mut().for_each(|part| part.expect_light(light)),
            Self::TwoSided(both) => both.sides_mut().into_iter().for_each(|side| side.expect_light(light)),
            _ => {}
        }
    }

    /// The share of the surface that fluoresces, seen along `wo`.
    pub(super) fn fluorescent_share(&self, at: &Shading<'_>, wo: Vec3<f64>) -> f64 {
        match self {
            Self::Fluorescent(surface) => f64::from(u8::from(surface.reradiation.is_some())),
            Self::Blend(blend) => blend.fluorescent_parts(at, wo).iter().map(|(_, share)| share).sum(),
            Self::TwoSided(both) => both.seen(at.normal, wo).fluorescent_share(at, wo),
            _ => 0.0,
        }
    }

    /// What of the surface fluoresces, seen along `wo`: of several parts one, drawn by its share with a number in [0, 1).
    pub(crate) fn fluorescent_part(&self, at: &Shading<'_>, wo: Vec3<f64>, u: f64) -> Option<FluorescentPart<'_>> {
        match self {
            Self::Fluorescent(Fluorescent { reflection, reradiation }) => {
                Some(FluorescentPart { share: 1.0, reradiation: reradiation.as_ref()?, reflection })
            }
            Self::Blend(blend) => {
                let parts = blend.fluorescent_parts(at, wo);
                let share = parts[0].1 + parts[1].1;
                let u = u * share;
                let (part, of_part, u) = match parts {
                    [(first, of_first), _] if u < of_first => (first, of_first, u),
                    [(_, of_first), (second, of_second)] => (second, of_second, u - of_first),
                };
                let part = part.fluorescent_part(at, wo, (u / of_part).min(1.0_f64.next_down()))?;
                Some(FluorescentPart { share, ..part })
            }
            Self::TwoSided(both) => both.seen(at.normal, wo).fluorescent_part(at, wo, u),
            _ => None,
        }
    }
}

impl Reradiation {
    /// `None` if no light within the range comes back within it.
    fn new(fluorescence: &Fluorescence, range_nm: [f64; 2]) -> Option<Self> {
        let excitation = ExcitationDistribution::new(fluorescence, range_nm)?;
        let parts = match fluorescence {
            Fluorescence::Matrix(matrix) => Parts::Matrix(matrix.clone()),
            Fluorescence::Fluorophores(dyes) => {
                let prepared = dyes.iter().map(|dye| {
                    let [a, e] = [dye.absorption(), dye.emission()].map(|s| PathSpectrum::new(s, range_nm));
                    (a, e, dye.scale())
                });
                Parts::Fluorophores(prepared.collect())
            }
        };
        Some(Self { parts, excitation })
    }

    /// Wavelengths of excitation, nm, and one over the density of each, nm: the hero's drawn by `u` in [0, 1), the others equal shares of all
    /// excitation apart.
    pub(crate) fn draw<const N: usize>(&self, u: f64) -> (Lanes<f64, N>, Lanes<f64, N>) {
        let (mut nm, mut width) = (Lanes::ZERO, Lanes::ZERO);
        for lane in 0..N {
            let turned = u + lane as f64 / N as f64;
            (nm[lane], width[lane]) = self.excitation.draw(if turned < 1.0 { turned } else { turned - 1.0 });
        }
        (nm, width)
    }

    /// Φ from each wavelength of excitation to all wavelengths of emission, nm⁻¹.
    pub(crate) fn between<const N: usize>(
        &self,
        excitation_nm: &Lanes<f64, N>,
        emission_nm: &Lanes<f64, N>,
    ) -> [Lanes<f64, N>; N] {
        match &self.parts {
            Parts::Matrix(matrix) => {
                std::array::from_fn(|i| Lanes::from_fn(|o| matrix.eval(excitation_nm[i], emission_nm[o])))
            }
            Parts::Fluorophores(dyes) => {
                let mut sums = [Lanes::ZERO; N];
                for (absorption, emission, scale) in dyes {
                    let absorbed = absorption.lanes(excitation_nm) * *excitation_nm * *scale;
                    let emitted = emission.lanes(emission_nm);
                    (0..N).for_each(|i| sums[i] += emitted * absorbed[i]);
                }
                sums
            }
        }
    }
}

impl ExcitationDistribution {
    fn new(fluorescence: &Fluorescence, range_nm: [f64; 2]) -> Option<Self> {
        let mut borders_nm: Vec<f64> = whole_nm(range_nm).chain(fluorescence.kinks_nm(range_nm)).collect();
        borders_nm.sort_by(f64::total_cmp);
        // What comes back of three wavelengths between any two borders.
        let nodes = simpson(borders_nm.iter().copied());
        let nm: Vec<f64> = nodes.iter().map(|(nm, _)| *nm).collect();
        let returned = fluorescence.returned(&nm, range_nm);
        let mut cumulative = vec![0.0];
        let mut sum = 0.0;
        for (nodes, returned) in nodes.chunks_exact(3).zip(returned.chunks_exact(3)) {
            sum += nodes.iter().zip(returned).map(|((_, weight), returned)| weight * returned).sum::<f64>();
            cumulative.push(sum);
        }
        if sum <= 0.0 {
            return None;
        }
        cumulative.iter_mut().for_each(|part| *part /= sum);
        Some(Self { borders_nm, cumulative })
    }

    /// Makes half of the density that of its product with a light.
    fn draw_half_toward(&mut self, light: &PathSpectrum) {
        let segments = self.borders_nm.windows(2).zip(self.cumulative.windows(2));
        let lit: Vec<f64> =
            segments.map(|(nm, part)| (part[1] - part[0]) * light.eval(0.5 * (nm[0] + nm[1]))).collect();
        let all: f64 = lit.iter().sum();
        if all <= 0.0 {
            // No lamp excites it: only what other surfaces give back.
            return;
        }
        let mut sum = 0.0;
        for (part, lit) in self.cumulative[1..].iter_mut().zip(lit) {
            sum += lit / all;
            *part = 0.5 * (*part + sum);
        }
        // Whatever the sums were rounded to.
        let last = self.cumulative[self.cumulative.len() - 1];
        self.cumulative.iter_mut().for_each(|part| *part /= last);
    }

    /// The wavelength up to which a share of all probability lies, nm, and one over its density, nm.
    fn draw(&self, u: f64) -> (f64, f64) {
        let last = self.cumulative.len() - 2;
        let segment = (self.cumulative.partition_point(|part| *part <= u) - 1).min(last);
        let (from, to) = (self.borders_nm[segment], self.borders_nm[segment + 1]);
        let probability = self.cumulative[segment + 1] - self.cumulative[segment];
        if probability <= 0.0 {
            // Rounding has led beyond the last wavelength that excites.
            return (from, 0.0);
        }
        let place = ((u - self.cumulative[segment]) / probability).min(1.0);
        let nm = (from + place * (to - from)).clamp(from.next_up(), to.next_down());
        (nm, (to - from) / probability)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_optics::spectrum::Outside;
    use etalon_optics::{Fluorophore, Spectrum};

    fn dye() -> Fluorescence {
        let absorption = Spectrum::tabulated(vec![380.0, 430.5, 470.0], vec![0.1, 0.8, 0.3], Outside::Zero).unwrap();
        let emission = Spectrum::tabulated(vec![450.0, 520.0, 640.0], vec![0.0, 1.0, 0.2], Outside::Zero).unwrap();
        Fluorescence::Fluorophores(vec![Fluorophore::new(absorption, emission, 0.9, [360.0, 830.0]).unwrap()])
    }

    /// Φ over the density of excitation, averaged over all lanes, is ∫ Φ dλᵢ at any wavelength of emission. The density is constant within a
    /// nanometre while Φ is not: a comb of 20 000 numbers sees about 200 of each nanometre, so its error is below 1e-4.
    #[test]
    fn what_is_drawn_sums_up_to_all_that_excites() {
        for range in [[360.0, 830.0], [400.25, 700.0]] {
            let prepared = Reradiation::new(&dye(), range).unwrap();
            for emission in [470.0, 520.0, 633.0] {
                let expected: f64 = simpson(whole_nm(range).chain(dye().kinks_nm(range)))
                    .iter()
                    .map(|(nm, w)| w * dye().eval(*nm, emission))
                    .sum();
                let count = 20_000;
                let mut mean = 0.0;
                for i in 0..count {
                    let (nm, width) = prepared.draw::<8>((f64::from(i) + 0.5) / f64::from(count));
                    let phi = prepared.between(&nm, &Lanes::splat(emission));
                    mean += (0..8).map(|lane| phi[lane][0] * width[lane]).sum::<f64>() / 8.0 / f64::from(count);
                    assert!((0..8).all(|lane| (380.0..=470.0).contains(&nm[lane])), "{nm:?}");
                }
                assert!((mean / expected - 1.0).abs() < 1e-4, "{emission} nm: {mean} is not {expected}");
            }
        }
    }

    /// Light in a twentieth of the band: half of all lanes and a bit look there, and what they find is the same integral.
    #[test]
    fn half_of_what_is_drawn_is_where_the_light_is() {
        let range = [360.0, 830.0];
        let line = |nm: f64| f64::from(u8::from((400.0..405.0).contains(&nm)));
        let mut prepared = Reradiation::new(&dye(), range).unwrap();
        prepared.excitation.draw_half_toward(&PathSpectrum::tabulate(range, line));
        let expected: f64 =
            simpson(whole_nm(range).chain([430.5])).iter().map(|(nm, w)| w * dye().eval(*nm, 520.0)).sum();
        let (count, mut mean, mut there) = (20_000, 0.0, 0);
        for i in 0..count {
            let (nm, width) = prepared.draw::<8>((f64::from(i) + 0.5) / f64::from(count));
            let phi = prepared.between(&nm, &Lanes::splat(520.0));
            mean += (0..8).map(|lane| phi[lane][0] * width[lane]).sum::<f64>() / 8.0 / f64::from(count);
            there += (0..8).filter(|lane| (399.0..406.0).contains(&nm[*lane])).count();
        }
        assert!((mean / expected - 1.0).abs() < 1e-4, "{mean} is not {expected}");
        let share = there as f64 / (8.0 * f64::from(count));
        assert!((0.5..0.6).contains(&share), "{share}");
    }

    #[test]
    fn what_nothing_excites_is_left_out() {
        assert!(Reradiation::new(&dye(), [500.0, 700.0]).is_none());
        // Nor what emits nothing that is rendered.
        assert!(Reradiation::new(&dye(), [390.0, 440.0]).is_none());
    }

    /// A blend draws the parts that fluoresce by their shares, and what it reflects otherwise is none of them.
    #[test]
    fn parts_of_a_blend_are_drawn_by_their_shares() {
        let range = [360.0, 830.0];
        let part = |albedo: f64| {
            let reflectance = PathTexture::new(&Spectrum::Constant(albedo).into(), range);
            Bsdf::Fluorescent(Fluorescent::new(reflectance, &dye(), range))
        };
        let at = Shading::flat(Vec3::new(0.0, 0.0, 1.0));
        let wo = Vec3::new(0.0, 0.6, 0.8);
        let inner = super::super::Blend::new([(0.0, Bsdf::Black), (1.0, part(0.2))], 0.5.into());
        let blend = Bsdf::Blend(super::super::Blend::new([(0.0, Bsdf::Blend(inner)), (1.0, part(0.6))], 0.25.into()));
        // 0.75 · 0.5 of the one, 0.25 of the other.
        let count = 1000;
        let drawn = (0..count).filter(|i| {
            let part = blend.fluorescent_part(&at, wo, (f64::from(*i) + 0.5) / f64::from(count)).unwrap();
            assert!((part.share - 0.625).abs() < 1e-12);
            part.reflection.reflectance::<1>(&Lanes([500.0]), at.texture_point())[0] < 0.4
        });
        assert_eq!(drawn.count(), 600);
        assert!(Bsdf::Black.fluorescent_part(&at, wo, 0.5).is_none());
    }
}
