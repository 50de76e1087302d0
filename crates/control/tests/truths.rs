//! Truths of the oracle, in pictures whose samples an exploration shares out.

use etalon_control::{Adaptivity, Limits, render_within};
use etalon_oracle::statistics::Welford;
use etalon_oracle::truths::truths;
use etalon_transport::prepare;

/// Pictures in which some regions have more noise than others, or none.
const UNEVEN: [&str; 5] = [
    "ball-that-glows",
    "mean-way-through-a-ball-of-fog",
    "view-factor-facing-squares",
    "window-of-a-diver",
    "light-beside-a-mirror",
];
const SEEDS: u64 = 64;
/// A correct renderer fails one of the five with a probability of 10⁻⁶: Student's t of 64 pictures each.
const MOST_ERRORS: f64 = 6.0;
/// The bias that the means of 64 pictures could show, relative.
const SEES: f64 = 0.03;

#[test]
fn adaptive_pictures_have_the_means_of_the_truths() {
    let all = truths();
    for name in UNEVEN {
        let truth = all.iter().find(|truth| truth.name == name).expect("a truth of this name");
        let loaded = etalon_scene::parse(&truth.scene, name).unwrap_or_else(|errors| panic!("{name}: {errors:?}"));
        let mut prepared = prepare(&loaded.0).unwrap();
        let rect = prepared.whole(None).rect;
        let (mut means, mut uneven) = (Welford::new(), 0);
        for seed in 0..SEEDS {
            prepared.reseed(seed);
            let limits = Limits { samples: 8, relative_rmse: None, seconds: None, adaptivity: Adaptivity::Always };
            let done = render_within(&prepared, rect, &limits, None, &|| 0.0, &()).unwrap();
            let [least, most] = done.explored.unwrap().exploration.allocation.least_and_most(done.samples, 4);
            uneven += u64::from(most > least);
            means.push(done.film.mean_y(rect));
        }
        let error = means.standard_error();
        let (off, tolerance) = ((means.mean() - truth.value()).abs(), truth.tolerance());
        assert!(uneven > SEEDS / 2, "{name}: shares hardly differ, the test is blind");
        assert!(error * MOST_ERRORS < SEES * truth.value(), "{name}: the test sees too little, {error}");
        assert!(off <= tolerance + MOST_ERRORS * error, "{name}: {} ± {error} is not {}", means.mean(), truth.value());
    }
}
