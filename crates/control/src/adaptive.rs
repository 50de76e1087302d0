//! Adaptive sampling: more samples where the error is, decided before the first sample that is kept.
//!
//! An exploration traces pixels all over the picture with random numbers that no picture uses, and learns the variance V and
//! the cost c of a sample in each region. Where the variance of n samples falls as n^−s, the error of the picture is smallest for
//! its cost if every region takes samples in proportion to (V/c)^(1/(1 + s)): √(V/c) for independent numbers (Neyman 1934), less
//! uneven for points that do better. The shares are independent of every value in the picture, so the picture is as unbiased as
//! one with a number given for each pixel.
//!
//! A part [`EVEN`] of the samples is spread evenly all the same: what an exploration has not met, such as a caustic, is still
//! sampled, and still shows in the error.

use crate::probe::{Probe, Purpose};
use crate::sample_allocation::{REGION_SIDE, SampleAllocation};
use etalon_scene::SamplerKind;
use etalon_transport::accuracy::ErrorSum;
use etalon_transport::{Counters, PixelRect, Prepared, ThreadError};
use std::sync::Arc;

/// The part of the samples that is spread evenly.
pub const EVEN: f64 = 0.25;
/// The part of the picture's paths that an exploration takes at most; one round of replicates for every pixel (of a large picture:
/// for some of them), if that is more.
pub const EFFORT: f64 = 1.0 / 16.0;
/// Camera paths, in the whole picture, below which what few samples foretell of its price is not believed: edges and other rare
/// things may not have been met, and the exploration is over in a moment anyway.
const LEAST_PATHS: f64 = (1 << 21) as f64;
/// The predicted gain from which shares are used where they need not be: it pays for the exploration and for what the law
/// behind it leaves out.
pub const WORTHWHILE: f64 = 1.2;
/// Pixels that an exploration holds at most, unless a quarter of the picture is more: its sums take as much as the film's.
const MOST_PIXELS: u64 = 1 << 20;
/// The weight of an even region: weights are whole numbers.
const UNIT: f64 = 64.0;
/// How the variance is taken to fall with the number of samples n: as n^−s. Owen-Sobol points reach 1 where they do no better
/// than independent numbers, 1.5 at edges and 3 where everything is smooth.
fn power(sampler: SamplerKind) -> f64 {
    match sampler {
        SamplerKind::Independent => 1.0,
        SamplerKind::Sobol => 1.4,
    }
}

/// Columns and rows of the pixels of each 2 × 2, in the order in which they are taken.
const LAYERS: [(u32, u32); 4] = [(0, 0), (1, 1), (1, 0), (0, 1)];

/// Whether regions take different numbers of samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Adaptivity {
    /// Where the picture is to reach an error, and an exploration foretells that it is reached sooner.
    #[default]
    Auto,
    /// As an exploration says, whatever it gains.
    Always,
    /// Every pixel takes the same number.
    Never,
}

impl Adaptivity {
    /// Whether to explore a picture that is to reach an error. Explorations see no light paths, and each sample of these is for the whole picture:
    /// where they are traced, only [`Adaptivity::Always`] does.
    pub fn explores(self, prepared: &Prepared) -> bool {
        match self {
            Self::Auto => prepared.light_paths_per_pixel() == 0.0,
            Self::Always => true,
            Self::Never => false,
        }
    }
}

/// How far a picture is to go, for which an exploration is only a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Samples a pixel at most.
    pub samples: u32,
    /// Relative error of the picture: see [`etalon_transport::accuracy`].
    pub relative_rmse: Option<f64>,
}

/// What an exploration found.
#[derive(Clone, Debug, PartialEq)]
pub struct Exploration {
    /// Samples for each region.
    pub allocation: Arc<SampleAllocation>,
    /// Time to an error with the same number of samples for all pixels, over that with these shares. Prediction for shares of
    /// half of the pixels by the other half, so that chance does not flatter it.
    pub gain: f64,
    /// Camera paths traced for it.
    pub paths: u64,
}

/// Explores the pixels of `rect` on this many threads (all cores if `None`). It ends early when `enough` says so.
pub fn explore(
    prepared: &Prepared,
    rect: PixelRect,
    goal: &Goal,
    threads: Option<usize>,
    enough: &dyn Fn() -> bool,
    on_work: &(dyn Fn(&Counters) + Sync),
) -> Result<Exploration, ThreadError> {
    let mut probe = Probe::new(prepared, Purpose::Exploration, threads)?;
    let most_layers = (1..LAYERS.len()).find(|&layers| layers as u64 * rect.area() / 4 >= MOST_PIXELS);
    let most_layers = most_layers.unwrap_or(LAYERS.len());
    let (mut layers, mut samples) = (0, probe.replicates());
    add_layers(&mut probe, rect, &mut layers, 1);
    probe.trace(0, |_, _| 0..samples, on_work);
    loop {
        let found = found(&probe, rect);
        // The next step takes as much again as all of them did. Before every pixel was seen, nothing is predicted: the error may be in
        // a few of them.
        let worth = || EFFORT * predicted_paths(&probe, rect, goal, samples, found.gain) >= 2.0 * probe.paths() as f64;
        if enough() || layers == most_layers && !worth() {
            return Ok(found);
        }
        if layers < most_layers {
            let first = probe.len();
            let as_many = layers.min(most_layers - layers);
            add_layers(&mut probe, rect, &mut layers, as_many);
            probe.trace(first, |_, _| 0..samples, on_work);
        } else {
            probe.trace(0, |_, _| samples..2 * samples, on_work);
            samples *= 2;
        }
    }
}

fn add_layers(probe: &mut Probe<'_>, rect: PixelRect, layers: &mut usize, more: usize) {
    for (column, row) in &LAYERS[*layers..*layers + more] {
        let of_layer = |&(x, y): &(u32, u32)| (x - rect.x0) % 2 == *column && (y - rect.y0) % 2 == *row;
        probe.add(rect.pixels().filter(of_layer));
    }
    *layers += more;
}

/// Camera paths that the picture will take.
fn predicted_paths(probe: &Probe<'_>, rect: PixelRect, goal: &Goal, samples: u32, gain: f64) -> f64 {
    let power = power(probe.sampler());
    let by_error = goal.relative_rmse.and_then(|target| {
        let mut error = ErrorSum::default();
        probe.seen().for_each(|seen| error.push(seen.pixel));
        let predicted = match error.relative_rmse() {
            // Where no light was found yet it is the pilot that goes on to look for some.
            None => 0.0,
            Some(relative_rmse) => {
                let ratio = relative_rmse * f64::from(probe.copies()).sqrt() / target;
                ratio.is_finite().then(|| f64::from(samples) * ratio.powf(2.0 / power) / gain.max(1.0))?
            }
        };
        Some(predicted.max(LEAST_PATHS / rect.area() as f64))
    });
    by_error.unwrap_or(f64::INFINITY).min(f64::from(goal.samples)) * rect.area() as f64
}

/// Variance and cost of the pixels of a region that were seen.
#[derive(Clone, Copy, Debug, Default)]
struct Region {
    pixels: f64,
    variance: f64,
    /// Rays, the camera's counted twice: a path costs something beside them.
    rays: f64,
    paths: f64,
}

impl Region {
    fn add(&mut self, other: &Self) {
        self.pixels += other.pixels;
        self.variance += other.variance;
        self.rays += other.rays;
        self.paths += other.paths;
    }

    /// Mean cost of a path, in rays.
    fn cost(&self) -> f64 {
        if self.paths > 0.0 { (self.rays + self.paths) / self.paths } else { 1.0 }
    }
}

fn found(probe: &Probe<'_>, rect: PixelRect) -> Exploration {
    let regions = SampleAllocation::regions(rect);
    let columns = (rect.x1 - rect.x0).div_ceil(REGION_SIDE);
    let mut halves = [vec![Region::default(); regions.len()], vec![Region::default(); regions.len()]];
    for seen in probe.seen() {
        let (x, y) = (seen.at.0 - rect.x0, seen.at.1 - rect.y0);
        let region = (y / REGION_SIDE * columns + x / REGION_SIDE) as usize;
        let variance = seen.pixel.variance(|xyz| [xyz[1]]).map_or(0.0, |([variance], _)| variance);
        // Blocks of 2 × 2 by turns, so that both halves have pixels of every layer.
        halves[(x / 2 + y / 2) as usize % 2][region].add(&Region {
            pixels: 1.0,
            variance,
            rays: seen.rays as f64,
            paths: seen.paths as f64,
        });
    }
    let [even, odd] = &halves;
    let power = power(probe.sampler());
    let predicted = |of: &[Region], by: &[Region]| gain(of, &weights(by, columns, power), power);
    let gain = (predicted(even, odd) * predicted(odd, even)).sqrt();
    let mut all = even.clone();
    all.iter_mut().zip(odd).for_each(|(all, odd)| all.add(odd));
    Exploration {
        allocation: Arc::new(SampleAllocation::new(rect, weights(&all, columns, power))),
        gain,
        paths: probe.paths(),
    }
}

/// The weights of the regions: (V/c)^(1/(1 + power)), and [`EVEN`] for all.
fn weights(regions: &[Region], columns: u32, power: f64) -> Vec<u32> {
    let mean = |region: &Region| if region.pixels > 0.0 { region.variance / region.pixels } else { 0.0 };
    let columns = columns as usize;
    let rows = regions.len() / columns.max(1);
    let smooth = |index: usize| {
        // Half of it is that of the neighbours, itself included: a small region's own is known to a fifth or so, and what is
        // next to noise, such as an edge, is likely to have some.
        let (column, row) = (index % columns, index / columns);
        let mut around = Region::default();
        for y in row.saturating_sub(1)..(row + 2).min(rows) {
            for x in column.saturating_sub(1)..(column + 2).min(columns) {
                around.add(&regions[y * columns + x]);
            }
        }
        0.5 * (mean(&regions[index]) + mean(&around))
    };
    let best: Vec<f64> =
        (0..regions.len()).map(|i| (smooth(i) / regions[i].cost()).powf(1.0 / (1.0 + power))).collect();
    let pixels: f64 = regions.iter().map(|region| region.pixels).sum();
    let level = best.iter().zip(regions).map(|(best, region)| best * region.pixels).sum::<f64>() / pixels;
    let weight = |best: f64| if level > 0.0 { EVEN + (1.0 - EVEN) * best / level } else { 1.0 };
    best.into_iter().map(|best| (UNIT * weight(best)).round() as u32).collect()
}

/// Time to an error with evenly spread samples over that with `weights`.
fn gain(regions: &[Region], weights: &[u32], power: f64) -> f64 {
    let sum = |of: &dyn Fn(&Region, f64) -> f64| {
        regions.iter().zip(weights).map(|(region, &weight)| of(region, f64::from(weight))).sum::<f64>()
    };
    let cost = |region: &Region| region.cost() * region.pixels;
    // The weight of all regions for the same cost.
    let level = sum(&|region, weight| cost(region) * weight) / sum(&|region, _| cost(region));
    let (even, shared) =
        (sum(&|region, _| region.variance), sum(&|region, weight| region.variance * (level / weight).powf(power)));
    if shared > 0.0 { (even / shared).powf(1.0 / power) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn region(variance: f64, cost: f64) -> Region {
        Region { pixels: 64.0, variance: 64.0 * variance, rays: 10.0 * (cost - 1.0), paths: 10.0 }
    }

    #[test]
    fn alike_regions_share_alike_and_gain_nothing() {
        let regions = vec![region(0.3, 4.0); 12];
        let weights = weights(&regions, 4, 1.0);
        assert_eq!(weights, [64; 12]);
        assert!((gain(&regions, &weights, 1.0) - 1.0).abs() < 1e-12);
        // Nothing is known where nothing varies.
        assert_eq!(super::weights(&[region(0.0, 1.0); 4], 2, 1.0), [64; 4]);
    }

    /// Regions of variances 1 and 16 and costs 1 and 4: √(V/c) is 1 and 2.
    #[test]
    fn regions_share_by_the_root_of_variance_over_cost_and_a_part_evenly() {
        let mut regions = vec![region(1.0, 1.0); 64];
        regions[32..].fill(region(16.0, 4.0));
        let weights = weights(&regions, 1, 1.0);
        let level = 1.5;
        for (index, share) in [(5, 1.0), (58, 2.0)] {
            let expected = 64.0 * (EVEN + (1.0 - EVEN) * share / level);
            assert!((f64::from(weights[index]) - expected).abs() < 1.0, "{weights:?}");
        }
        // The best is (ΣV·Σc)/(Σ√(Vc))², 17·5/9² = 1.049; the even part costs some of it.
        let gain = gain(&regions, &weights, 1.0);
        assert!((1.03..=1.05).contains(&gain), "{gain}");
    }

    /// With V = 1 and 32 at 64 samples and s = 1.5, weights of 1 and 32^0.4 = 4: moving samples either way is worse.
    #[test]
    fn shares_are_the_best_for_the_law_of_the_variance() {
        let error = |first: f64| first.powf(-1.5) + 32.0 * (2.0 - first).powf(-1.5);
        let best = 2.0 / 5.0;
        assert!(error(best) < error(1.01 * best) && error(best) < error(0.99 * best));
        let mut regions = vec![region(1.0, 1.0); 64];
        regions[32..].fill(region(32.0, 1.0));
        let weights = weights(&regions, 1, 1.5);
        let expected = |share: f64| 64.0 * (EVEN + (1.0 - EVEN) * share / 2.5);
        assert!((f64::from(weights[5]) - expected(1.0)).abs() <= 1.0, "{weights:?}");
        assert!((f64::from(weights[58]) - expected(4.0)).abs() <= 1.5, "{weights:?}");
        let ideal = (error(1.0) / error(best)).powf(1.0 / 1.5);
        let gain = gain(&regions, &weights, 1.5);
        assert!(gain < ideal && gain > 0.9 * ideal, "{gain} of {ideal}");
    }

    #[test]
    fn what_pixels_took_adds_up_to_the_cost_of_a_path() {
        let mut sum = Region::default();
        assert_eq!(sum.cost(), 1.0);
        for (pixels, variance, rays, paths) in [(1.0, 2.0, 30.0, 4.0), (5.0, 0.5, 10.0, 16.0)] {
            sum.add(&Region { pixels, variance, rays, paths });
        }
        assert_eq!([sum.pixels, sum.variance, sum.rays, sum.paths], [6.0, 2.5, 40.0, 20.0]);
        assert_eq!(sum.cost(), 3.0);
    }

    /// One noisy region among 4 × 3: its own weight counts half, that of the up to nine around a region the other half.
    #[test]
    fn noise_is_likely_in_the_regions_around_noise() {
        let (columns, rows, noisy) = (4, 3, (1, 2));
        let mut regions = vec![region(0.0, 1.0); columns * rows];
        regions[noisy.1 * columns + noisy.0] = region(1.0, 1.0);
        let weights = weights(&regions, columns as u32, 1.0);
        let near = |a: usize, b: usize| a.abs_diff(b) <= 1;
        let share = |x: usize, y: usize| -> f64 {
            let around = (0..columns * rows).filter(|i| near(i % columns, x) && near(i / columns, y)).count() as f64;
            let met = near(x, noisy.0) && near(y, noisy.1);
            (f64::from(u8::from((x, y) == noisy)) * 0.5 + f64::from(u8::from(met)) * 0.5 / around).sqrt()
        };
        let places = || (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
        let level = places().map(|(x, y)| share(x, y)).sum::<f64>() / (columns * rows) as f64;
        for ((x, y), weight) in places().zip(weights) {
            let expected = UNIT * (EVEN + (1.0 - EVEN) * share(x, y) / level);
            assert!((f64::from(weight) - expected).abs() <= 0.5, "{weight}, not {expected}, at {x}, {y}");
        }
    }

    /// A region of 64 pixels and one of 8, of variances 1 and 9 a pixel and costs 2 and 1, with weights of 1 and 3: by hand.
    #[test]
    fn small_regions_count_for_less() {
        let regions = [
            Region { pixels: 64.0, variance: 64.0, rays: 10.0, paths: 10.0 },
            Region { pixels: 8.0, variance: 72.0, rays: 0.0, paths: 10.0 },
        ];
        let level = (128.0 + 3.0 * 8.0) / 136.0;
        let expected = 136.0 / (64.0 * level + 72.0 * level / 3.0);
        assert!((gain(&regions, &[1, 3], 1.0) - expected).abs() < 1e-12);
    }

    /// A ball that shines above the middle of a floor, found by chance by the right of two halves of the picture: there a sample is 0
    /// or 1, with mean 1/25, as in the tests of `stopping`; the left half sees nothing.
    fn half_a_lottery(width: u32, height: u32) -> Prepared {
        let json = format!(
            r#"{{"etalon": 1, "film": {{"width": {width}, "height": {height}}},
                "camera": {{"type": "perspective", "position_m": [3, 3, 0], "look_at_m": [0, 0, 0], "vertical_fov_deg": 0.01}},
                "materials": {{"white": {{"type": "lambert", "reflectance": 1}}, "black": {{"type": "black"}}}},
                "objects": [
                    {{"material": "white", "shape": {{"type": "parallelogram", "origin_m": [-1, 0, 0], "u_m": [2, 0, 0], "v_m": [0, 0, -1]}}}},
                    {{"material": "black", "emission": {{"radiance": 1}},
                      "shape": {{"type": "sphere", "center_m": [0, 5, 0], "radius_m": 1}}}}],
                "integrator": {{"light_sampling": "bsdf", "max_depth": 2, "sampler": "independent"}}}}"#
        );
        etalon_transport::prepare(&etalon_scene::parse(&json, "lottery").unwrap_or_else(|e| panic!("{e:?}")).0).unwrap()
    }

    /// The rule: a layer of the picture, another one, two, then all of it again, as long as the next step and what was before take no
    /// more than a sixteenth of the picture's paths.
    #[test]
    fn an_exploration_takes_its_part_of_the_paths() {
        let prepared = half_a_lottery(32, 16);
        let (rect, replicates) = (prepared.whole(None).rect, u64::from(prepared.scene().integrator.replicates));
        let paths = |samples: u32, enough: &dyn Fn() -> bool| {
            let goal = Goal { samples, relative_rmse: None };
            explore(&prepared, rect, &goal, Some(1), enough, &|_| ()).unwrap().paths
        };
        let all = rect.area() * replicates;
        assert_eq!(paths(1 << 20, &|| true), all / 4);
        // A picture of less than sixteen times as many paths as all pixels take once: its pixels are seen all the same.
        assert_eq!(paths(1, &|| false), all);
        let rounds = |samples: u32| u64::from(samples) / replicates / 16;
        for samples in [512, 511, 1024] {
            let least = (1_u64..).map(|k| 1 << k).find(|took| 2 * took > rounds(samples)).unwrap();
            assert_eq!(paths(samples, &|| false), least * all, "{samples}");
        }
        let seen = std::cell::Cell::new(0);
        assert_eq!(paths(1 << 20, &|| seen.replace(seen.get() + 1) == 1), all / 2);
    }

    /// Of large pictures some layers are enough: three here, as two have less than [`MOST_PIXELS`].
    #[test]
    fn an_exploration_of_a_large_picture_leaves_pixels_out() {
        let prepared = half_a_lottery(1200, 1200);
        let rect = prepared.whole(None).rect;
        let goal = Goal { samples: 1, relative_rmse: None };
        let found = explore(&prepared, rect, &goal, None, &|| false, &|_| ()).unwrap();
        assert!(2 * rect.area() / 4 < MOST_PIXELS && 3 * rect.area() / 4 >= MOST_PIXELS);
        assert_eq!(found.paths, 3 * rect.area() / 4 * u64::from(prepared.scene().integrator.replicates));
    }

    /// In a part of the picture that begins anywhere, each region has the noise that is its own: two of three columns here.
    #[test]
    fn regions_get_the_noise_that_was_found_in_them() {
        let prepared = half_a_lottery(64, 32);
        let rect = PixelRect { x0: 24, y0: 5, x1: 48, y1: 21 };
        let goal = Goal { samples: 1 << 14, relative_rmse: None };
        let found = explore(&prepared, rect, &goal, Some(1), &|| false, &|_| ()).unwrap();
        let weights = found.allocation.weights();
        let (rows, _) = weights.as_chunks::<3>();
        assert_eq!(rows.len(), 2);
        // What is known of noise: that of the region itself, and with the same weight the mean of it and those around it. The left
        // column has none, and no path beyond the camera's ray; the others have one ray more.
        let wanted =
            [(0.5 * 2.0 / 4.0, 2.0), (0.5 + 0.5 * 4.0 / 6.0, 3.0), (1.0, 3.0)].map(|(v, c): (f64, f64)| (v / c).sqrt());
        let level = wanted.iter().sum::<f64>() / 3.0;
        for row in rows {
            for (weight, wanted) in row.iter().zip(wanted) {
                let expected = UNIT * (EVEN + (1.0 - EVEN) * wanted / level);
                // Four replicates tell a pixel's variance to √(2/3) of it, 64 pixels that of a region to a tenth, and its root to a
                // twentieth: two and a half times that.
                assert!((f64::from(*weight) / expected - 1.0).abs() < 0.12, "{rows:?}, but {expected}");
            }
        }
    }

    /// E² is (1 − p)/(pn) where every pixel's sample is 1 with probability p, and 0 else; here p = 1/25 in half of the picture:
    /// of the pixels' variances the mean is halved, and so is the mean.
    #[test]
    fn the_paths_to_an_error_are_foretold_by_the_law_of_the_variance() {
        let prepared = half_a_lottery(128, 32);
        let rect = prepared.whole(None).rect;
        let mut probe = Probe::new(&prepared, Purpose::Exploration, Some(1)).unwrap();
        probe.add(rect.pixels());
        let samples = 64;
        probe.trace(0, |_, _| 0..samples, &|_| ());
        let paths = |samples: u32, relative_rmse: Option<f64>, gain: f64| {
            predicted_paths(&probe, rect, &Goal { samples, relative_rmse }, 64, gain) / rect.area() as f64
        };
        // (½·p·(1 − p)/n)/(½·p)².
        let expected = |target: f64| 2.0 * 24.0 / (target * target);
        // 2048 pixels of 256 samples: 20,000 hits, and E² goes as one over their number: .7 %, five times that.
        for (target, gain) in [(0.1, 1.0), (0.05, 2.0), (0.1, 0.5)] {
            let found = paths(u32::MAX, Some(target), gain) * f64::max(gain, 1.0);
            assert!((found / expected(target) - 1.0).abs() < 0.035, "{found} for {}", expected(target));
        }
        assert_eq!(paths(100, Some(0.1), 1.0), 100.0);
        assert_eq!(paths(100, None, 1.0), 100.0);
        assert_eq!(paths(u32::MAX, Some(1e3), 1.0), LEAST_PATHS / rect.area() as f64);
    }
}
