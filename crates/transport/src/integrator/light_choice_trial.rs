//! Trials before a picture: how often each light is worth a shadow ray.
//!
//! A light that is chosen with a probability p brings v/p, where v is what it brings if it is always chosen. So the mean square of what all lights
//! bring is Σ E[v²]/p. It is least where p is in proportion to √E[v²]. That is measured with shadow rays alone: what MIS leaves to the walk is the
//! light's, too. Whether these probabilities are better than those by power is then tried with MIS.
//!
//! Of a sky only what is brighter than its mean counts, since shadow rays are drawn by that. Paths find the rest by themselves, whatever is learned.

use crate::film::Counters;
use crate::integrator::observer::{Found, Observer};
use crate::integrator::tracer::Tracer;
use crate::integrator::trial::{Scales, Tried};
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::light::LightTable;
use crate::polarisation::Polarisation;
use crate::scene::prepare::Prepared;
use etalon_optics::Lanes;
use etalon_scene::LightSampling;

/// Fewest paths of a trial: of a picture of few pixels each has more samples.
const FEWEST_PATHS: u32 = 256;
/// What must seem to be left of the variances, in their mean, for a further trial; and of either in the end.
const PROMISING: f64 = 0.9;
const WORTH_IT: f64 = 0.95;

/// What the paths of some pixels came to, against two [scales](Scales).
pub(crate) struct LightChoiceTrial {
    variances: [f64; 2],
    /// Mean squares of what shadow rays toward each group of lights bring.
    squares: Vec<[f64; 2]>,
}

/// What one path finds.
struct ByGroup<'a> {
    lights: &'a LightTable,
    found: f64,
    squares: Vec<f64>,
}

impl<const N: usize> Observer<N> for ByGroup<'_> {
    fn light(&mut self, _: u32, how: Found, radiance: Lanes<f64, N>) {
        let light = radiance.sum() / N as f64;
        self.found += light;
        if let Found::ShadowRay { light: number } = how {
            self.squares[self.lights.group(number as usize)] += light * light;
        }
    }
}

/// A trial by one kernel, in some pixels of the picture, evenly spread, with random numbers of a seed; with this instead of MIS, if any. Takes
/// how many pixels there are at most, and the samples of each.
pub(crate) fn try_light_choice<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
    prepared: &Prepared,
    seed: u64,
    sampling: Option<LightSampling>,
    (pixels, samples): (u64, u32),
) -> LightChoiceTrial {
    let tried = Tried::at_most(pixels, prepared);
    let mut tracer = Tracer::new(prepared);
    tracer.seed = seed;
    tracer.world.light_sampling = sampling.unwrap_or(tracer.world.light_sampling);
    let lights = &prepared.lights;
    let groups = lights.group_count();
    let samples = samples.max(FEWEST_PATHS / tried.count());
    let of_pixels = tried.map(|x, y| {
        let (mut mean, mut square, mut squares) = (0.0, 0.0, vec![0.0; groups]);
        let mut counters = Counters::default();
        for sample in 0..samples {
            let mut path = ByGroup { lights, found: 0.0, squares: vec![0.0; groups] };
            let mut observer: &mut dyn Observer<N> = &mut path;
            tracer.sample::<M, P, N>(x, y, sample, &mut counters, &mut observer);
            // What is not finite the picture reports.
            if !path.found.is_finite() {
                continue;
            }
            mean += path.found / f64::from(samples);
            square += path.found * path.found / f64::from(samples);
            squares.iter_mut().zip(path.squares).for_each(|(sum, square)| *sum += square / f64::from(samples));
        }
        (mean, square, squares)
    });
    let means: Vec<f64> = of_pixels.iter().map(|&(mean, ..)| mean).collect();
    let scales = Scales::new(&tried, &means);
    let variances = scales.sums_of_variances(of_pixels.iter().map(|&(_, square, _)| square));
    let squares = |group: usize| scales.sums(of_pixels.iter().map(|(.., squares)| squares[group]));
    LightChoiceTrial { variances, squares: (0..groups).map(squares).collect() }
}

impl LightChoiceTrial {
    /// The shares of the groups that leave the least of both variances, if that promises something.
    pub(crate) fn shares(&self, lights: &LightTable) -> Option<Vec<f64>> {
        let tried = lights.shares();
        let part = |square: &[f64; 2]| (0..2).map(|kind| 0.5 * square[kind] / self.variances[kind]).sum::<f64>();
        let parts: Vec<f64> = self.squares.iter().map(part).collect();
        let worth: Vec<f64> = parts.iter().zip(&tried).map(|(part, share)| (part * share).sqrt()).collect();
        let total: f64 = worth.iter().sum();
        let learned: Vec<f64> = worth.iter().map(|worth| worth / total).collect();
        let then = lights.shares_if(&learned);
        let change = |((part, tried), then): ((&f64, &f64), &f64)| part * (tried / then - 1.0);
        let left = 1.0 + parts.iter().zip(&tried).zip(&then).map(change).sum::<f64>();
        (left < PROMISING).then_some(learned)
    }

    /// Whether less noise is left than by power.
    pub(crate) fn is_better_than(&self, by_power: &Self) -> bool {
        self.variances.iter().zip(by_power.variances).all(|(left, by_power)| *left < WORTH_IT * by_power)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::{DirectionalLight, Light};
    use crate::spectral::PathSpectrum;
    use etalon_optics::Vec3;
    use etalon_scene::LightSelection;

    #[test]
    fn a_hidden_light_gets_little_if_the_others_bring_the_noise() {
        let sun = |irradiance: f64| {
            let irradiance = PathSpectrum::Constant(irradiance);
            Light::Directional(DirectionalLight { toward: Vec3::new(0.0, 0.0, 1.0), irradiance })
        };
        let lights = LightTable::new(vec![sun(1.0), sun(3.0)], 1.0, [360.0, 830.0], LightSelection::Auto);
        let trial = |squares| LightChoiceTrial { variances: [2.0, 4.0], squares };
        assert_eq!(trial(vec![[2.0, 4.0], [0.0, 0.0]]).shares(&lights), Some(vec![1.0, 0.0]));
        // In the mean over both measures each brings 0.05 of the variance: so little cannot be won.
        assert_eq!(trial(vec![[0.2, 0.0], [0.0, 0.4]]).shares(&lights), None);
        // Light that no shadow ray brings.
        assert_eq!(trial(vec![[0.0; 2]; 2]).shares(&lights), None);
    }

    #[test]
    fn noise_that_is_less_by_one_measure_alone_is_not_worth_it() {
        let trial = |variances| LightChoiceTrial { variances, squares: Vec::new() };
        let by_power = trial([2.0, 4.0]);
        assert!(trial([1.8, 3.7]).is_better_than(&by_power));
        assert!(!trial([1.0, 3.9]).is_better_than(&by_power) && !trial([1.95, 1.0]).is_better_than(&by_power));
        assert!(!trial([f64::NAN, 1.0]).is_better_than(&by_power));
    }
}
