//! A trial before a picture: from which share of the vertices specular connections are worth their rays.
//!
//! A connection takes tens of rays, and mostly brings less light than what else a path finds. If it is made with a probability s, and weighed by
//! 1/s, the square of what it brings counts 1/s as much, and its rays s times. So one trial tells variance and time for every share, and the best
//! is that which leaves the least product of the two.

use crate::film::Counters;
use crate::guiding::USUAL_SHARES as USUAL;
use crate::integrator::observer::{Found, Observer};
use crate::integrator::tracer::Tracer;
use crate::integrator::trial::{SAMPLES, Tried};
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::polarisation::Polarisation;
use crate::scene::prepare::Prepared;
use etalon_optics::Lanes;

/// The shares that are tried: see [`SpecularConnections::shares`](crate::guiding::SpecularConnections). What the camera sees directly is seen
/// best, and a trial may miss what is rare. Hence the least of them.
const DIRECT: [f64; 3] = [1.0, 0.5, 0.25];
const INDIRECT: [f64; 6] = [1.0, 0.5, 0.25, 0.125, 0.0625, 0.03125];
/// Least share of the variance that is believed to be left.
const LEAST_LEFT: f64 = 0.01;
/// What other shares must leave of variance times rays.
const WORTH_IT: f64 = 0.9;

/// What the paths of some pixels came to.
pub(crate) struct ConnectionTrial {
    /// The variance, and the mean squares of what direct and indirect connections bring: relative to the level of each place.
    variance: f64,
    squares: [f64; 2],
    /// Rays of all kinds, and those of direct and indirect connections.
    rays: f64,
    of_connections: [f64; 2],
}

/// What one path finds.
#[derive(Default)]
struct Connections {
    found: f64,
    /// By the connection that is being made.
    brought: f64,
    squares: [f64; 2],
    rays: [u64; 2],
}

impl<const N: usize> Observer<N> for Connections {
    fn light(&mut self, _: u32, how: Found, radiance: Lanes<f64, N>) {
        let light = radiance.sum() / N as f64;
        self.found += light;
        if let Found::SpecularConnection { .. } = how {
            self.brought += light;
        }
    }

    fn connection(&mut self, indirect: bool, rays: u64) {
        let brought = std::mem::take(&mut self.brought);
        self.squares[usize::from(indirect)] += brought * brought;
        self.rays[usize::from(indirect)] += rays;
    }
}

/// A trial by one kernel, in some pixels of the picture, evenly spread, with random numbers of a seed.
pub(crate) fn try_connections<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
    prepared: &Prepared,
    seed: u64,
) -> ConnectionTrial {
    let tried = Tried::of(prepared);
    let mut tracer = Tracer::new(prepared);
    tracer.seed = seed;
    let of_pixels = tried.map(|x, y| {
        let (mut mean, mut square, mut squares, mut of_connections) = (0.0, 0.0, [0.0; 2], [0; 2]);
        let mut counters = Counters::default();
        for sample in 0..SAMPLES {
            let mut path = Connections::default();
            let mut observer: &mut dyn Observer<N> = &mut path;
            tracer.sample::<M, P, N>(x, y, sample, &mut counters, &mut observer);
            (0..2).for_each(|kind| of_connections[kind] += path.rays[kind]);
            // What is not finite the picture reports.
            if !path.found.is_finite() {
                continue;
            }
            mean += path.found / f64::from(SAMPLES);
            square += path.found * path.found / f64::from(SAMPLES);
            (0..2).for_each(|kind| squares[kind] += path.squares[kind] / f64::from(SAMPLES));
        }
        (mean, square, squares, counters.rays + counters.shadow_rays, of_connections)
    });
    let means: Vec<f64> = of_pixels.iter().map(|&(mean, ..)| mean).collect();
    let mut trial = ConnectionTrial { variance: 0.0, squares: [0.0; 2], rays: 0.0, of_connections: [0.0; 2] };
    for (&(_, square, squares, rays, of_connections), (level, scale)) in of_pixels.iter().zip(tried.levels(&means)) {
        trial.rays += rays as f64;
        if scale > 0.0 {
            trial.variance += (square - level * level).max(0.0) / scale;
        }
        for kind in 0..2 {
            trial.of_connections[kind] += of_connections[kind] as f64;
            if scale > 0.0 {
                trial.squares[kind] += squares[kind] / scale;
            }
        }
    }
    trial
}

impl ConnectionTrial {
    /// The shares that leave the least variance times rays, if they are worth it, else the usual.
    pub(crate) fn shares(&self) -> [f64; 2] {
        let product = |shares: [f64; 2]| {
            let (mut variance, mut rays) = (self.variance, self.rays);
            for kind in 0..2 {
                let ratio = shares[kind] / USUAL[kind];
                variance += self.squares[kind] * (1.0 / ratio - 1.0);
                rays += self.of_connections[kind] * (ratio - 1.0);
            }
            // The variance that was measured is not exactly the sum of its parts, and must not become negative.
            variance.max(LEAST_LEFT * self.variance) * rays
        };
        let usual = product(USUAL);
        let all = DIRECT.into_iter().flat_map(|direct| INDIRECT.map(|indirect| [direct, indirect]));
        let best = all.min_by(|a, b| product(*a).total_cmp(&product(*b)));
        best.filter(|&best| product(best) < WORTH_IT * usual).unwrap_or(USUAL)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn connections_that_bring_little_are_made_seldom_and_those_that_bring_all_everywhere() {
        let trial =
            |squares, of_connections| ConnectionTrial { variance: 1.0, squares, rays: 1000.0, of_connections }.shares();
        assert_eq!(trial([0.0, 1e-6], [10.0, 900.0]), [DIRECT[2], INDIRECT[5]]);
        assert_eq!(trial([0.01, 0.9], [10.0, 500.0]), [1.0, 1.0]);
        // Neither time nor variance is theirs.
        assert_eq!(trial([0.0, 0.0], [0.0, 10.0]), USUAL);
    }
}
