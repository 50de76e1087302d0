//! Trials before a picture: how often each light is worth a shadow ray.
//!
//! A light that is chosen with a probability p brings v/p, where v is what it brings if it is always chosen. So the mean square of what all lights
//! bring is Σ E[v²]/p. It is least where p is in proportion to √E[v²]. That is measured with shadow rays alone: what MIS leaves to the walk is the
//! light's, too. Whether these probabilities are better than those by power is then tried with MIS.

use crate::film::Counters;
use crate::integrator::observer::{Found, Observer};
use crate::integrator::tracer::Tracer;
use crate::integrator::trial::{SAMPLES, Scales, Tried};
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::light::LightTable;
use crate::polarisation::Polarisation;
use crate::scene::prepare::Prepared;
use etalon_optics::Lanes;
use etalon_scene::LightSampling;

/// Fewest paths of a trial: of a picture of few pixels each has more samples.
const FEWEST_PATHS: u32 = 1024;
/// What must be left of either variance.
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

/// A trial by one kernel, in some pixels of the picture, evenly spread, with random numbers of a seed; and with this instead of MIS, if any.
pub(crate) fn try_light_choice<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
    prepared: &Prepared,
    seed: u64,
    sampling: Option<LightSampling>,
) -> LightChoiceTrial {
    let tried = Tried::of(prepared);
    let mut tracer = Tracer::new(prepared);
    tracer.seed = seed;
    tracer.world.light_sampling = sampling.unwrap_or(tracer.world.light_sampling);
    let lights = &prepared.lights;
    let groups = lights.shares(None).len();
    let samples = SAMPLES.max(FEWEST_PATHS / tried.count());
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
    let levels = tried.levels(&means);
    let variances = of_pixels.iter().zip(&levels).map(|((_, square, _), (level, _))| (square - level * level).max(0.0));
    let squares = |group: usize| scales.sums(of_pixels.iter().map(|(.., squares)| squares[group]));
    LightChoiceTrial { variances: scales.sums(variances), squares: (0..groups).map(squares).collect() }
}

impl LightChoiceTrial {
    /// The shares of the groups that leave the least of both variances that were found by power. `None` if shadow rays bring nothing.
    pub(crate) fn shares(&self, lights: &LightTable, by_power: &Self) -> Option<Vec<f64>> {
        let worth = |(square, share): (&[f64; 2], f64)| {
            let [about, of_all] = [0, 1].map(|kind| square[kind] / by_power.variances[kind]);
            ((about + of_all) * share).sqrt()
        };
        let worth: Vec<f64> = self.squares.iter().zip(lights.shares(None)).map(worth).collect();
        let total: f64 = worth.iter().sum();
        total.is_normal().then(|| worth.iter().map(|worth| worth / total).collect())
    }

    /// Whether less noise is left than by power.
    pub(crate) fn is_better_than(&self, by_power: &Self) -> bool {
        self.variances.iter().zip(by_power.variances).all(|(left, by_power)| *left < WORTH_IT * by_power)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_that_is_less_by_one_measure_alone_is_not_worth_it() {
        let trial = |variances| LightChoiceTrial { variances, squares: Vec::new() };
        let by_power = trial([2.0, 4.0]);
        assert!(trial([1.8, 3.7]).is_better_than(&by_power));
        assert!(!trial([1.0, 3.9]).is_better_than(&by_power) && !trial([1.95, 1.0]).is_better_than(&by_power));
        assert!(!trial([f64::NAN, 1.0]).is_better_than(&by_power));
    }
}
