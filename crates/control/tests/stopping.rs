//! Renders that end by error or by time: the right number of samples, the same bytes, no bias.

use etalon_control::adaptive::{Goal, explore};
use etalon_control::{
    Adaptivity, Canvas, Limits, Pilot, Reached, SampleAllocation, Shard, Watch, render_canvas, render_within, settle,
};
use etalon_oracle::statistics::{Welford, resolvable_bias};
use etalon_scene::Scene;
use etalon_transport::{Control, Counters, Extent, Film, PixelRect, Prepared, prepare};
use serde_json::json;
use std::sync::atomic::{AtomicU64, Ordering};

/// Height of the lamp over its radius: the share of a diffuse floor's sky that it fills right below it is 1/25.
const SHARE: f64 = 0.04;

/// A floor right below a ball that shines. Paths find the ball by chance, so a sample of a pixel is 0 or 1. The mean is [`SHARE`]: below a
/// ball of half angle α that is above the horizon E = πL·sin²α, and the floor gives back E/π.
fn lottery(seed: u64) -> Prepared {
    lottery_of(seed, 8)
}

/// The same, of this many columns; each eight of them are a region of their own.
fn lottery_of(seed: u64, width: u32) -> Prepared {
    let (scene, _) = etalon_scene::parse(
        &json!({
            "etalon": 1,
            "camera": {"type": "perspective", "position_m": [3, 3, 0], "look_at_m": [0, 0, 0], "vertical_fov_deg": 0.01},
            "film": {"width": width, "height": 8},
            "materials": {"white": {"type": "lambert", "reflectance": 1}, "black": {"type": "black"}},
            "objects": [
                {"material": "white", "shape": {"type": "disk", "center_m": [0, 0, 0], "normal": [0, 1, 0], "radius_m": 1}},
                {
                    "material": "black", "emission": {"radiance": 1},
                    "shape": {"type": "sphere", "center_m": [0, 5, 0], "radius_m": 1}
                }
            ],
            "integrator": {"light_sampling": "bsdf", "max_depth": 2, "sampler": "independent"}
        })
        .to_string(),
        "lottery",
    )
    .unwrap_or_else(|e| panic!("{e:?}"));
    let scene = Scene { integrator: etalon_scene::Integrator { seed, ..scene.integrator }, ..scene };
    prepare(&scene).unwrap()
}

fn mean_y(prepared: &Prepared, film: &Film) -> f64 {
    film.mean_y(prepared.whole(None).rect)
}

/// 5000 pictures of about 60 hits each, as a rule may end them: |z| < 5 is exceeded by chance once in 2·10⁶; a bias of 1.5 %
/// would be seen with power 0.999.
fn bias(name: &str, mut prepared: Prepared, picture: impl Fn(&Prepared) -> f64) -> f64 {
    let of_seed = |seed| {
        prepared.reseed(seed);
        picture(&prepared)
    };
    let moments: Welford = (0..5000).map(of_seed).collect();
    let error = moments.standard_error();
    assert!(resolvable_bias(error, 6e-7) < 0.016 * SHARE, "{name}: the test sees too little, {}", error / SHARE);
    (moments.mean() - SHARE) / error
}

#[test]
fn a_picture_whose_samples_a_pilot_chose_is_not_biased() {
    let z = bias("pilot", lottery(0), |prepared| {
        let limits = Limits { samples: 4096, relative_rmse: Some(1.0), seconds: None, adaptivity: Adaptivity::Never };
        let done = render_within(prepared, prepared.whole(None).rect, &limits, Some(1), &|| 0.0, &()).unwrap();
        assert_eq!(done.reached, Reached::Error);
        mean_y(prepared, &done.film)
    });
    assert!(z.abs() < 5.0, "z {z}");
}

/// The mutant: a rule that looks at the picture itself.
#[test]
fn a_picture_that_ends_when_it_looks_good_itself_would_be_seen_to_be_biased() {
    let z = bias("own error", lottery(0), |prepared| {
        let whole = prepared.whole(Some(1));
        let mut film = prepared.film();
        for first in (0..4096).step_by(4) {
            let extent = Extent { samples: first..first + 4, ..whole.clone() };
            prepared.render_onto(&mut film, &extent, &|_| Control::Continue).unwrap();
            if film.error(whole.rect).is_some_and(|error| error.mean_y > 0.0 && error.relative_rmse <= 1.0) {
                break;
            }
        }
        mean_y(prepared, &film)
    });
    assert!(z.abs() > 5.0, "z {z}: it is right by accident, or the test is blind");
}

/// Shares of two regions that an exploration draws differently in every picture, since chance alone decides where it finds
/// light. Pictures of about 60 hits each, as above.
#[test]
fn a_picture_whose_shares_an_exploration_chose_is_not_biased() {
    let uneven = AtomicU64::new(0);
    let z = bias("exploration", lottery_of(0, 16), |prepared| {
        let limits = Limits { samples: 12, relative_rmse: None, seconds: None, adaptivity: Adaptivity::Always };
        let rect = prepared.whole(None).rect;
        let done = render_within(prepared, rect, &limits, Some(1), &|| 0.0, &()).unwrap();
        let [least, most] = done.explored.unwrap().exploration.allocation.least_and_most(done.samples, 4);
        uneven.fetch_add(u64::from(most > least), Ordering::Relaxed);
        mean_y(prepared, &done.film)
    });
    assert!(uneven.into_inner() > 2500, "shares hardly differ: the test is blind");
    assert!(z.abs() < 5.0, "z {z}");
}

/// The mutant: the first samples decide where more are taken, and are kept.
#[test]
fn a_picture_whose_shares_follow_its_own_samples_would_be_seen_to_be_biased() {
    let z = bias("own shares", lottery_of(0, 16), |prepared| {
        let whole = prepared.whole(Some(1));
        let first = Extent { samples: 0..4, ..whole.clone() };
        let mut film = prepared.render(&first, &|_| Control::Continue).unwrap();
        let regions = SampleAllocation::regions(whole.rect);
        let noise = regions
            .iter()
            .map(|&region| film.error(region).filter(|e| e.is_known()).map_or(0.0, |e| e.relative_rmse * e.mean_y));
        let noise: Vec<f64> = noise.collect();
        for (index, rect) in regions.into_iter().enumerate() {
            let samples = 4..if noise[index] > noise[1 - index] { 20 } else { 8 };
            prepared
                .render_onto(&mut film, &Extent { rect, samples, ..whole.clone() }, &|_| Control::Continue)
                .unwrap();
        }
        mean_y(prepared, &film)
    });
    assert!(z.abs() > 5.0, "z {z}: it is right by accident, or the test is blind");
}

/// A clock on which each path takes a second, and each that finds light ten: as bad as it can be.
struct CostlyLight(AtomicU64);

impl Watch for CostlyLight {
    fn pass(&self, film: &Film, _: u32) {
        let seconds = film.pixels().map(|p| f64::from(p.count()) * (1.0 + 9.0 * p.xyz()[1])).sum::<f64>();
        self.0.store(seconds as u64, Ordering::Relaxed);
    }
}

#[test]
fn a_deadline_does_not_bias_even_where_light_is_what_takes_time() {
    let z = bias("deadline", lottery(0), |prepared| {
        let watch = CostlyLight(AtomicU64::new(0));
        let limits = Limits {
            samples: 4096,
            relative_rmse: None,
            seconds: Some(64.0 * 24.0 * 1.36),
            adaptivity: Adaptivity::Never,
        };
        let clock = || watch.0.load(Ordering::Relaxed) as f64;
        let done = render_within(prepared, prepared.whole(None).rect, &limits, Some(1), &clock, &watch).unwrap();
        assert_eq!(done.reached, Reached::Time);
        mean_y(prepared, &done.film)
    });
    assert!(z.abs() < 5.0, "z {z}");
}

/// The paths that were traced: what a clock goes by that is the same on every machine.
struct Paths<'a>(&'a AtomicU64);

impl Watch for Paths<'_> {
    fn work(&self, counters: &Counters) {
        self.0.fetch_add(counters.paths, Ordering::Relaxed);
    }
}

#[test]
fn the_first_limit_wins_and_the_film_is_that_of_as_many_samples() {
    let prepared = lottery(3);
    let rect = prepared.whole(None).rect;
    let paths = AtomicU64::new(0);
    // A millisecond a path.
    let clock = || 1e-3 * paths.load(Ordering::Relaxed) as f64;
    let render = |samples, relative_rmse, seconds| {
        paths.store(0, Ordering::Relaxed);
        let limits = Limits { samples, relative_rmse, seconds, adaptivity: Adaptivity::Never };
        let done = render_within(&prepared, rect, &limits, Some(2), &clock, &Paths(&paths)).unwrap();
        let extent = Extent { rect, samples: 0..done.samples, threads: Some(1) };
        assert_eq!(done.film, prepared.render(&extent, &|_| Control::Continue).unwrap());
        assert!(done.film.pixels().all(|pixel| pixel.count() == done.samples));
        done
    };
    let by_samples = render(18, Some(0.001), None);
    assert_eq!((by_samples.reached, by_samples.samples), (Reached::Samples, 18));
    assert_eq!(render(18, None, Some(1e6)).reached, Reached::Samples);
    // 64 pixels take 0.064 s a sample.
    let by_time = render(1_000_000, None, Some(3.2));
    assert_eq!(by_time.reached, Reached::Time);
    assert!((40..=50).contains(&by_time.samples) && by_time.seconds <= 3.2, "{}", by_time.samples);
    let by_time = render(1_000_000, Some(1e-3), Some(3.2));
    assert_eq!(by_time.reached, Reached::Time);
    assert!(by_time.seconds <= 3.2 && by_time.predicted.is_some());
    // E = √((1 − p)/(pN)) = 1 at N = 24; the pilot of 64 pixels knows it to a tenth.
    let by_error = render(1_000_000, Some(1.0), Some(1e6));
    assert_eq!(by_error.reached, Reached::Error);
    assert!((12..=44).contains(&by_error.samples), "{}", by_error.samples);
    // A picture must have something in it, however little time there is.
    assert_eq!(render(1_000_000, None, Some(1e-9)).samples, 4);
}

/// What a picture had before says nothing about how fast it goes on.
#[test]
fn a_picture_that_is_taken_up_again_ends_by_the_time_that_it_is_given() {
    let prepared = lottery(3);
    let rect = prepared.whole(None).rect;
    let canvas = Canvas::new(&prepared, rect, Shard::WHOLE, None);
    let paths = AtomicU64::new(0);
    // A millisecond a path.
    let clock = || 1e-3 * paths.load(Ordering::Relaxed) as f64;
    let go_on = |samples, seconds| {
        paths.store(0, Ordering::Relaxed);
        let limits = Limits { samples, relative_rmse: None, seconds, adaptivity: Adaptivity::Never };
        let watch = Paths(&paths);
        let settled = settle(&prepared, rect, &limits, Some(2), &clock, &watch).unwrap();
        render_canvas(&prepared, &canvas, &settled, &limits, Some(2), &clock, &watch).unwrap()
    };
    assert_eq!(go_on(20, None).samples, 20);
    // 64 pixels take 0.064 s a sample, so that there is time for 50 more.
    let ended = go_on(1_000_000, Some(3.2));
    assert_eq!(ended.reached, Reached::Time);
    assert!((60..=70).contains(&ended.samples) && ended.seconds <= 3.2, "{ended:?}");
}

/// In an even picture shares that differ by chance alone gain nothing: they lose some 1 %. Predicted for the pixels that they were made from, they
/// would seem to gain 3 %. The mean of 60 seeds is known to 0.2 %, and held to no gain with 5 standard errors.
#[test]
fn chance_does_not_flatter_the_gain_of_an_exploration() {
    let mut prepared = lottery_of(0, 128);
    let rect = prepared.whole(None).rect;
    let goal = Goal { samples: 1, relative_rmse: None };
    let mut gains = Welford::new();
    for seed in 0..60 {
        prepared.reseed(seed);
        let found = explore(&prepared, rect, &goal, Some(2), &|| false, &|_| ()).unwrap();
        gains.push(found.gain.ln());
    }
    let (mean, error) = (gains.mean(), gains.standard_error());
    assert!(error < 0.003 && mean < 5.0 * error && mean > -0.1, "{mean} ± {error}");
}

#[test]
fn uneven_shares_leave_the_same_bytes_for_any_threads_stages_and_crops() {
    let mut scene = lottery_of(3, 40).scene().clone();
    scene.integrator.sampler = etalon_scene::SamplerKind::Sobol;
    let prepared = prepare(&scene).unwrap();
    let rect = PixelRect { x0: 3, y0: 1, x1: 37, y1: 8 };
    let allocation: Vec<u32> =
        (0..SampleAllocation::regions(rect).len() as u32).map(|region| 16 + 37 * region).collect();
    let allocation = SampleAllocation::new(rect, allocation);
    let render = |film: &mut Film, rect, means, threads| {
        let tiles = allocation.tiles(rect, means, 4);
        prepared.render_tiles_onto(film, &tiles, Some(threads), &|_| Control::Continue).unwrap();
    };
    let whole = |threads| {
        let mut film = prepared.film();
        render(&mut film, rect, 0..24, threads);
        film
    };
    let film = whole(1);
    for (x, y) in rect.pixels() {
        assert_eq!(film.pixel(x, y).count(), allocation.samples(x, y, 24, 4));
    }
    assert_eq!(film.pixels().map(|pixel| u64::from(pixel.count())).sum::<u64>(), film.counters.paths);
    assert_eq!(whole(3), film);
    let mut staged = prepared.film();
    [0..4, 4..5, 5..24].into_iter().for_each(|means| render(&mut staged, rect, means, 1));
    assert_eq!(staged, film);
    let mut parts = prepared.film();
    for (x0, x1) in [(3, 10), (10, 11), (11, 37)] {
        render(&mut parts, PixelRect { x0, x1, ..rect }, 0..24, 1);
    }
    assert_eq!(parts, film);
    // A pixel's samples are the first of those that it always has.
    let uniform = Extent { rect, samples: 0..24, threads: Some(1) };
    let uniform = prepared.render(&uniform, &|_| Control::Continue).unwrap();
    let same = |(x, y): &(u32, u32)| film.pixel(*x, *y).count() == 24;
    let compared: Vec<_> = rect.pixels().filter(same).collect();
    assert!(compared.iter().all(|&(x, y)| film.pixel(x, y) == uniform.pixel(x, y)));
}

#[test]
fn a_pilot_sees_the_error_that_the_picture_has_whatever_the_number_of_replicates() {
    for replicates in [1, 2, 3, 4, 8] {
        let mut seen = Welford::new();
        let mut scene = lottery(0).scene().clone();
        scene.integrator.replicates = replicates;
        let mut prepared = prepare(&scene).unwrap();
        for seed in 0..20 {
            prepared.reseed(seed);
            let mut pilot = Pilot::new(&prepared, prepared.whole(None).rect, None, Some(2)).unwrap();
            pilot.advance(24, &|| 0.0, &|_| ());
            pilot.advance(96, &|| 0.0, &|_| ());
            seen.push(pilot.points()[1].relative_rmse);
        }
        // √(24/96), by the binomial distribution.
        let z = (seen.mean() - 0.5) / seen.standard_error();
        // The root of a variance with few degrees of freedom is biased by some 1 %, which 5 standard errors include.
        assert!(z.abs() < 5.0 && seen.standard_error() < 0.01, "{replicates}: {} z {z}", seen.mean());
    }
}
