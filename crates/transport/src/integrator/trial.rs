//! Trials before a picture: the variance that each share of guided directions would leave, and the rays that it takes.

use crate::film::Counters;
use crate::guiding::{GuidedBy, Mixture};
use crate::integrator::observer::{Found, Observer};
use crate::integrator::tracer::Tracer;
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::polarisation::Polarisation;
use crate::scene::prepare::Prepared;
use etalon_optics::Lanes;
use rayon::prelude::*;

/// The share of all guided targets together that is tried, and those that the trial decides between.
pub(crate) const TRIED: f64 = 0.35;
pub(crate) const SHARES: [f64; 5] = [0.1, 0.2, 0.35, 0.5, 0.6];
/// Pixels that are tried, and samples of each.
pub(crate) const PIXELS: u64 = 1024;
pub(crate) const SAMPLES: u32 = 16;
/// Paths that the trial draws more than five times as often as the cosine would do not count. Without guided targets they bear much of the
/// variance, but are so rare that hardly any picture has them: with them, the trial promises much where nothing is won (two balls in
/// a room: 0.1 to 0.5 of the variance, in truth 0.9 of the error).
const RARE: f64 = 0.2;
/// How far around a pixel its level is averaged, in tried pixels.
const NEAR: usize = 2;

/// The pixels of a picture that are tried, evenly spread, row by row.
pub(crate) struct Tried {
    columns: Vec<u32>,
    rows: Vec<u32>,
    /// Pixels between two of them.
    step: u32,
}

impl Tried {
    pub(crate) fn of(prepared: &Prepared) -> Self {
        Self::at_most(PIXELS, prepared)
    }

    /// At most this many of them, about.
    pub(crate) fn at_most(most: u64, prepared: &Prepared) -> Self {
        let film = &prepared.scene.film;
        let pixels = u64::from(film.width) * u64::from(film.height);
        // Of a small picture a quarter, lest the trial cost more than it.
        let tried = most.min(pixels.div_ceil(4));
        let step = (pixels as f64 / tried as f64).sqrt().ceil() as u32;
        let along = |end: u32| ((step / 2).min(end - 1)..end).step_by(step as usize).collect();
        Self { columns: along(film.width), rows: along(film.height), step }
    }

    /// How many pixels are tried.
    pub(crate) fn count(&self) -> u32 {
        (self.columns.len() * self.rows.len()) as u32
    }

    /// The number of the tried pixel that stands for a pixel.
    pub(crate) fn cell(&self, x: u32, y: u32) -> usize {
        let along = |at: u32, tried: usize| ((at / self.step) as usize).min(tried - 1);
        along(y, self.rows.len()) * self.columns.len() + along(x, self.columns.len())
    }

    /// What each pixel comes to: in the order of the pixels, whichever thread they are tried by.
    pub(crate) fn map<T: Send>(&self, of_pixel: impl Fn(u32, u32) -> T + Sync) -> Vec<T> {
        let (columns, of_pixel) = (&self.columns, &of_pixel);
        self.rows.par_iter().flat_map_iter(|&y| columns.iter().map(move |&x| of_pixel(x, y))).collect()
    }

    /// The level about each pixel, in the mean over the pixels around it: of its own few samples one bright one would make it bright, and its
    /// variance small. And what its variance counts against: the square of the level, with a hundredth of the picture's lest black pixels count
    /// alone.
    pub(crate) fn levels(&self, means: &[f64]) -> Vec<(f64, f64)> {
        let (columns, rows) = (self.columns.len(), self.rows.len());
        let near = |at: usize, end: usize| at.saturating_sub(NEAR)..(at + NEAR + 1).min(end);
        let around = |row: usize, column: usize| {
            let pixels = near(row, rows).flat_map(|y| near(column, columns).map(move |x| y * columns + x));
            let (sum, count) = pixels.fold((0.0, 0.0), |(sum, count), at| (sum + means[at], count + 1.0));
            sum / count
        };
        let levels: Vec<f64> = (0..means.len()).map(|at| around(at / columns, at % columns)).collect();
        let mean = levels.iter().sum::<f64>() / levels.len() as f64;
        levels.into_iter().map(|level| (level, level * level + 0.01 * mean * mean)).collect()
    }
}

/// What the variance of each pixel counts against: the square of the level about it, as it is seen, and that of the whole picture, as its error is
/// stated.
pub(crate) struct Scales {
    /// [`Tried::levels`]
    levels: Vec<(f64, f64)>,
    of_all: f64,
}

impl Scales {
    pub(crate) fn new(tried: &Tried, means: &[f64]) -> Self {
        let mean = means.iter().sum::<f64>() / means.len() as f64;
        Self { levels: tried.levels(means), of_all: mean * mean }
    }

    /// The sums of the variances of all pixels, of which these are the mean squares.
    pub(crate) fn sums_of_variances(&self, squares: impl Iterator<Item = f64>) -> [f64; 2] {
        self.sums(squares.zip(&self.levels).map(|(square, (level, _))| (square - level * level).max(0.0)))
    }

    /// The sums of the variances of all pixels.
    pub(crate) fn sums(&self, variances: impl Iterator<Item = f64>) -> [f64; 2] {
        let against = |variance: f64, scale: f64| if scale > 0.0 { variance / scale } else { 0.0 };
        variances.zip(&self.levels).fold([0.0; 2], |sums, (variance, (_, about))| {
            [sums[0] + against(variance, *about), sums[1] + against(variance, self.of_all)]
        })
    }
}

/// What the paths of some pixels came to under the share that was tried.
pub(crate) struct Trial {
    tried: Tried,
    /// Pixel by pixel: the mean radiance, and its mean square without guided targets and with each of [`SHARES`].
    moments: Vec<(f64, [f64; 1 + SHARES.len()])>,
    /// Rays that were cast.
    pub rays: u64,
}

/// What a path comes to under no share and under each of [`SHARES`], if it is the same path.
struct Weighed {
    /// The products of its factors so far, and that under the share that is tried.
    factors: [f64; 1 + SHARES.len()],
    tried: f64,
    /// The light that it has found, in the mean over its lanes.
    found: [f64; 1 + SHARES.len()],
}

impl<const N: usize> Observer<N> for Weighed {
    fn light(&mut self, _: u32, _: Found, radiance: Lanes<f64, N>) {
        let light = radiance.sum() / N as f64;
        for (found, factor) in self.found.iter_mut().zip(self.factors) {
            *found += light * (factor / self.tried);
        }
    }

    fn direction(&mut self, mixture: &Mixture) {
        for (factor, share) in self.factors[1..].iter_mut().zip(SHARES) {
            *factor *= mixture.factor(share / TRIED);
        }
        self.tried *= mixture.factor(1.0);
    }
}

/// A trial by one kernel, in some pixels of the picture, evenly spread, with random numbers of a seed.
pub(crate) fn try_guided_targets<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
    prepared: &Prepared,
    seed: u64,
) -> Trial {
    let tried = Tried::of(prepared);
    let mut tracer = Tracer::new(prepared);
    tracer.seed = seed;
    let of_pixel = |x: u32, y: u32| {
        let (mut mean, mut squares, mut counters) = (0.0, [0.0; 1 + SHARES.len()], Counters::default());
        for sample in 0..SAMPLES {
            let mut path = Weighed { factors: [1.0; _], tried: 1.0, found: [0.0; _] };
            let mut observer: &mut dyn Observer<N> = &mut path;
            tracer.sample::<M, P, N>(x, y, sample, &mut counters, &mut observer);
            // What is not finite the picture reports.
            if !path.found.iter().all(|found| found.is_finite()) {
                continue;
            }
            mean += path.found[0] * path.tried / f64::from(SAMPLES);
            if path.tried < RARE && tracer.prepared.guided_targets.guided_by == GuidedBy::Bodies {
                continue;
            }
            for ((square, found), factor) in squares.iter_mut().zip(path.found).zip(path.factors) {
                *square += found * found * (path.tried / factor) / f64::from(SAMPLES);
            }
        }
        ((mean, squares), counters.rays + counters.shadow_rays)
    };
    let (moments, rays): (Vec<_>, Vec<u64>) = tried.map(of_pixel).into_iter().unzip();
    Trial { tried, moments, rays: rays.into_iter().sum() }
}

impl Trial {
    /// The light of all pixels.
    pub(crate) fn light(&self) -> f64 {
        self.moments.iter().map(|(mean, _)| mean).sum()
    }

    /// Variances over the square of the level around, in the sum over pixels.
    pub(crate) fn variances(&self) -> [f64; 1 + SHARES.len()] {
        let means: Vec<f64> = self.moments.iter().map(|&(mean, _)| mean).collect();
        let mut sums = [0.0; 1 + SHARES.len()];
        for ((_, squares), (level, scale)) in self.moments.iter().zip(self.tried.levels(&means)) {
            for (sum, square) in sums.iter_mut().zip(squares) {
                *sum += (square - level * level).max(0.0) / scale;
            }
        }
        sums
    }
}
