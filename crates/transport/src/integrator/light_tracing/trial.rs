//! A trial before a picture: whether light paths leave less noise for the time than camera paths alone, and how many of them.
//!
//! Some pixels are traced twice, with all that camera paths find and without what light paths find. Some light paths are followed beside that.
//! One trial tells the noise for every number of light paths: with n times as many, their variance is 1/n.

use super::{LIGHT_RAY, splats};
use crate::film::Counters;
use crate::guiding::SpecularObjects;
use crate::integrator::tracer::Tracer;
use crate::integrator::trial::{SAMPLES, Scales, Tried};
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::polarisation::Polarisation;
use crate::scene::prepare::Prepared;

/// Light paths of each sample that are tried, and samples.
const PATHS: u64 = 1 << 14;
const LIGHT_SAMPLES: u32 = 8;
/// Light paths for each pixel that the trial decides between.
const PER_PIXEL: [f64; 7] = [0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0];
/// What light paths must leave of variance times time.
const WORTH_IT: f64 = 0.8;
/// Where camera paths find less of the light than this, what bears the rest was too rare for the trial.
const FOUND: f64 = 0.5;
/// Connections of about equal weight from which something is known of the light that they bring.
const FEWEST_CONNECTIONS: f64 = 64.0;

/// What the camera paths of some pixels came to: the mean and the mean square of each pixel's samples, and the rays of all.
pub(crate) struct CameraTrial {
    moments: Vec<(f64, f64)>,
    rays: u64,
}

/// A trial by one kernel, in some pixels of the picture, evenly spread, with random numbers of a seed.
pub(crate) fn try_camera_paths<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
    prepared: &Prepared,
    seed: u64,
) -> CameraTrial {
    let mut tracer = Tracer::new(prepared);
    tracer.seed = seed;
    let of_pixels = Tried::of(prepared).map(|x, y| {
        let (mut mean, mut square, mut counters) = (0.0, 0.0, Counters::default());
        for sample in 0..SAMPLES {
            let path = tracer.sample::<M, P, N>(x, y, sample, &mut counters, &mut ());
            let received = path.received();
            let level = level(M::to_xyz(prepared, &received.wavelengths, received.radiance));
            // What is not finite the picture reports.
            if level.is_finite() {
                mean += level / f64::from(SAMPLES);
                square += level * level / f64::from(SAMPLES);
            }
        }
        ((mean, square), counters.rays + counters.shadow_rays)
    });
    let (moments, rays): (Vec<_>, Vec<u64>) = of_pixels.into_iter().unzip();
    CameraTrial { moments, rays: rays.into_iter().sum() }
}

/// Of a colour in CIE XYZ: all of it, since spectra are seen in colours.
fn level(xyz: [f64; 3]) -> f64 {
    xyz.iter().sum::<f64>() / 3.0
}

/// What a sample of the picture comes to, for each pixel that was tried: mean, variances against two [scales](Scales), and rays.
#[derive(Clone, Copy, Debug, Default)]
struct Cost {
    light: f64,
    variances: [f64; 2],
    rays: f64,
}

/// What a trial found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LightTrial {
    /// The number of light paths for each pixel that leaves the least variance for the time.
    pub per_pixel: f64,
    /// Whether that is less than camera paths leave alone.
    pub is_worth_it: bool,
}

/// What light paths would leave of the noise; `None` if too few of them reach the camera to say.
pub(crate) fn light_paths_per_pixel(
    prepared: &Prepared,
    specular_objects: &SpecularObjects,
    seed: u64,
    [whole, rest]: [&CameraTrial; 2],
) -> Option<LightTrial> {
    let tried = Tried::of(prepared);
    let rect = prepared.whole_rect();
    let splats = splats::of_paths(prepared, specular_objects, seed, (PATHS.min(rect.area()), 0..LIGHT_SAMPLES), rect);
    // With one path for each pixel, as on the picture.
    let of_path = splats.paths as f64 / (f64::from(LIGHT_SAMPLES) * rect.area() as f64);
    let cells = whole.moments.len();
    let pixels_of_cell = rect.area() as f64 / cells as f64;
    let (mut means, mut variances) = (vec![0.0; cells], vec![0.0; cells]);
    for ((x, y), (mean, variance)) in rect.pixels().zip(splats.moments(LIGHT_SAMPLES, level)) {
        let cell = tried.cell(x, y);
        means[cell] += mean / pixels_of_cell;
        variances[cell] += variance * of_path / pixels_of_cell;
    }
    let levels = || splats.by_pixel().flatten().map(|(_, xyz)| level(*xyz));
    let (sum, sum_of_squares) = (levels().sum::<f64>(), levels().map(|level| level * level).sum::<f64>());
    // A connection may reach several pixels, and is one all the same.
    let fewest =
        FEWEST_CONNECTIONS * prepared.pixels_of_light_path().map_or(1.0, |[width, height]| f64::from(width * height));
    // So many of equal weight would have the same scatter (Kish 1965).
    if !(sum * sum >= fewest * sum_of_squares && sum > 0.0) {
        return None;
    }
    let all: Vec<f64> = means.iter().zip(&rest.moments).map(|(of_light, (of_rest, _))| of_light + of_rest).collect();
    let scales = Scales::new(&tried, &all);
    let cost_of = |camera: &CameraTrial| Cost {
        light: camera.moments.iter().map(|(mean, _)| mean).sum(),
        variances: scales.sums(camera.moments.iter().map(|(mean, square)| (square - mean * mean).max(0.0))),
        rays: camera.rays as f64 / f64::from(SAMPLES),
    };
    let of_light = Cost {
        light: means.iter().sum(),
        variances: scales.sums(variances.into_iter()),
        rays: LIGHT_RAY * cells as f64 * splats.rays as f64 / splats.paths as f64,
    };
    let (mut whole, rest) = (cost_of(whole), cost_of(rest));
    let missed = of_light.light - (whole.light - rest.light);
    if missed > (1.0 - FOUND) * of_light.light {
        let share = missed / of_light.light;
        let least = scales.sums(least_variances(means.iter().map(|mean| share * mean)));
        whole.variances = [0, 1].map(|scale| whole.variances[scale] + least[scale]);
    }
    Some(best(whole, rest, of_light))
}

/// The least variances of light, of these means over the pixels that were tried, which no camera path has met: of all that were tried at most one
/// should have. So one in that many brings that many times the mean.
fn least_variances(means: impl Iterator<Item = f64> + Clone) -> impl Iterator<Item = f64> {
    let met = means.clone().sum::<f64>() * f64::from(SAMPLES);
    means.map(move |mean| mean * met)
}

/// Both scales weigh alike: what decides is the geometric mean of both products of variance and time.
fn best(whole: Cost, rest: Cost, of_light: Cost) -> LightTrial {
    let product = |variances: [f64; 2], rays: f64| (variances[0] * variances[1]).sqrt() * rays;
    let with = |per_pixel: f64| {
        let left = [0, 1].map(|scale| rest.variances[scale] + of_light.variances[scale] / per_pixel);
        product(left, rest.rays + of_light.rays * per_pixel)
    };
    let per_pixel = PER_PIXEL.into_iter().min_by(|a, b| with(*a).total_cmp(&with(*b))).unwrap_or(1.0);
    LightTrial { per_pixel, is_worth_it: with(per_pixel) < WORTH_IT * product(whole.variances, whole.rays) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_is_followed_from_lamps_where_that_leaves_less_noise_for_the_time() {
        let cost = |variance, rays| Cost { light: 0.0, variances: [variance, 2.0 * variance], rays };
        let whole = cost(50.0, 1000.0);
        let rest = cost(1.0, 1000.0);
        let chosen = |whole, rest, of_light| {
            let found = best(whole, rest, of_light);
            found.is_worth_it.then_some(found.per_pixel)
        };
        // As many as balance the two kinds.
        assert_eq!(chosen(whole, rest, cost(1.0, 1000.0)), Some(1.0));
        assert_eq!(chosen(whole, rest, cost(4.0, 1000.0)), Some(2.0));
        // More noise than it takes away.
        assert_eq!(chosen(whole, cost(45.0, 1000.0), cost(30.0, 4000.0)), None);
        // What is seen gains as much as what is stated loses.
        let uneven = |variances, rays| Cost { light: 0.0, variances, rays };
        let none = uneven([0.0; 2], 1000.0);
        assert_eq!(chosen(uneven([2.0, 1.0], 1000.0), uneven([0.5, 4.0], 1000.0), none), None);
        // 100 pixels, and light in one of them: one path of 1600 brings 1600 times the mean of 0.01.
        let least = least_variances((0..100).map(|pixel| if pixel == 0 { 1.0 } else { 0.0 }));
        assert_eq!(least.sum::<f64>(), 16.0);
    }
}
