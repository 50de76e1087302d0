//! Our own integrator, held to the truths.

use std::time::Instant;

use etalon_oracle::statistics::{Budget, Welford};
use etalon_oracle::subjects::Reading;
use etalon_oracle::truths::{CUT_SHARE, Claim, Quantity, SceneFile, Truth, judge, judge_to};
use etalon_scene::{Filter, NamedFile, PathReuse, Scene};
use etalon_transport::{Counters, Study};
use miette::Report as Problem;

use super::VerifyArgs;
use super::report::{Report, Row};
use super::series::{Series, Stop};
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;

/// Independent renders of each truth: their scatter is the standard error, whatever the samples within one have to do
/// with each other. With 64 of them Student's t at the suite's significance is close to the normal distribution.
const REPLICATES: u32 = 64;
/// At first, all replicates together take this part of the samples that the truth's scene suggests: those are meant for independent
/// numbers, and for one render.
const FIRST: u32 = 32;
/// Films of a run that is not thorough keep at least this many pixels a side.
const LEAST_SIDE_PX: u32 = 8;
/// A reading that is too noisy to count takes at most this many times the paths. It does so again, as long as it has fewer paths than the first step
/// times [`MOST_TO_COUNT`].
const MORE_TO_COUNT: u32 = 2;
const MOST_TO_COUNT: u32 = 1 << 11;
/// Paths that are taken beyond those that would just do at 1/√n: what a reading has seen is known from its noise, to about a tenth.
const SPARE: f64 = 1.15;
/// A reading that counts takes this many times the paths to see more, or fewer where these will do.
const MORE: u32 = 4;
/// What a thorough run wants to see of each truth, relative, and of those whose whole name was given. How many rays it spends on that for
/// every truth, and how many where as many will do. In rays, not in seconds, so that what is read is the same on every machine.
const THOROUGH_SEES: f64 = 2e-3;
const THOROUGH_SEES_BY_NAME: f64 = 2e-4;
const THOROUGH_RAYS: u64 = 32_000_000;
const THOROUGH_REACH_RAYS: u64 = 4_096_000_000;
/// In a run of all truths, the rays after which a truth no longer goes on to see more than its known mistakes and this relative bias. With them
/// all take three minutes of two cores.
const RAYS_TO_SEE: u64 = 400_000;
const LEAST_SEEN: f64 = 0.05;

/// A truth's picture by our integrator, taken with many seeds.
pub(super) struct Measurement<'a> {
    truth: &'a Truth,
    of_truth: Series,
    /// A film of CIE Y reads a narrow band relative to a white sky in the same band.
    of_white: Option<Series>,
    /// Samples that a pixel of each replicate has after the first step.
    first_spp: u32,
    /// How many times these it has now.
    effort: u32,
}

impl<'a> Measurement<'a> {
    fn new(truth: &'a Truth, args: &VerifyArgs) -> Result<Self, String> {
        let scene = |json: &str| Self::scene(json, truth, args);
        let threads = args.threads.map(|threads| threads as usize);
        // Distinct for each pair: fewer replicates than 2¹⁶.
        let seeds: Vec<u64> = (0..REPLICATES).map(|replicate| args.seed << 16 | u64::from(replicate)).collect();
        let polarised = truth.claims.contains(&Claim::CarriesPolarisation);
        let study = Study { polarised, ..Study::default() };
        let series = |json: &str| Series::new(&scene(json)?, &study, seeds.clone(), threads);
        let first_spp = scene(&truth.scene)?.integrator.spp.div_ceil(FIRST * REPLICATES).next_power_of_two();
        let of_white = truth.band_nm.map(|_| series(&truth.white_scene())).transpose()?;
        Ok(Self { truth, of_truth: series(&truth.scene)?, of_white, first_spp, effort: 0 })
    }

    /// The same films, read for another truth; `None` if its scene is another.
    fn read_for(self, truth: &'a Truth) -> Option<Self> {
        let polarised = |truth: &Truth| truth.claims.contains(&Claim::CarriesPolarisation);
        let asks = |truth: &Truth| {
            (truth.quantity == Quantity::Meters, truth.crop_px.is_some(), polarised(truth), truth.band_nm)
        };
        let same =
            self.truth.scene == truth.scene && self.truth.files == truth.files && asks(self.truth) == asks(truth);
        same.then_some(Self { truth, ..self })
    }

    /// The scene as each replicate renders it.
    fn scene(json: &str, truth: &Truth, args: &VerifyArgs) -> Result<Scene, String> {
        let named = |file: &SceneFile| NamedFile { name: file.name.clone(), bytes: file.bytes.clone() };
        let files: Vec<NamedFile> = truth.files.iter().map(named).collect();
        let loaded = etalon_scene::parse_with_files(json, "truth", &files, None).map_err(|errors| errors.summary())?;
        let mut scene = loaded.scene;
        // Each film is one replicate here.
        scene.integrator.replicates = 1;
        if truth.quantity == Quantity::Meters {
            return scene.measured(1).ok_or_else(|| "the scene has no meters".to_owned());
        }
        if truth.crop_px.is_none() {
            // Fewer pixels, with the samples of all: the same mean, of points that are spread more evenly over the film and over whatever
            // follows. For a thorough run as few as there can be.
            let side =
                if args.is_thorough() { gcd(scene.film.width, scene.film.height) } else { merged_side_px(&scene) };
            let film = &mut scene.film;
            (film.width, film.height) = (film.width / side, film.height / side);
            scene.integrator.spp = scene.integrator.spp.saturating_mul(side * side);
        }
        Ok(scene)
    }

    /// Goes on to this many times the samples of the first step.
    fn render_to(&mut self, effort: u32, significance: f64, interrupt: &Interrupt) -> Result<Reading, Stop> {
        self.effort = effort;
        for series in [Some(&mut self.of_truth), self.of_white.as_mut()].into_iter().flatten() {
            series.render_to(self.first_spp.saturating_mul(effort), interrupt)?;
        }
        let white: Vec<f64> = match &self.of_white {
            Some(series) => series.means(Quantity::Radiance, self.truth.crop_px).collect(),
            None => vec![1.0; REPLICATES as usize],
        };
        let mut moments = Welford::new();
        let means = self.of_truth.means(self.truth.quantity, self.truth.crop_px);
        means.zip(white).for_each(|(mean, white)| moments.push(mean / white));
        let counted = |counter: fn(&Counters) -> u64| self.of_truth.counted(counter);
        let cut_bias = match self.cut_paths() {
            // A quotient of two pictures is not bounded here.
            1.. if self.of_white.is_some() => f64::INFINITY,
            cut => {
                let (throughput, paths) = (self.of_truth.cut_throughput(), self.paths());
                self.truth.bias_of_cut_paths(cut, throughput, paths, significance)
            }
        };
        Ok(Reading { estimate: moments.estimate(), nonfinite: counted(|counters| counters.nonfinite), cut_bias })
    }

    /// Paths that were cut at the internal limit on vertices.
    fn cut_paths(&self) -> u64 {
        let of = |series: &Series| series.counted(|counters| counters.cut_paths);
        of(&self.of_truth) + self.of_white.as_ref().map_or(0, of)
    }

    /// Rays of all kinds so far.
    fn rays(&self) -> u64 {
        let of = |series: &Series| series.counted(|counters| counters.rays + counters.shadow_rays);
        of(&self.of_truth) + self.of_white.as_ref().map_or(0, of)
    }

    /// Camera paths so far.
    fn paths(&self) -> u64 {
        self.of_truth.counted(|counters| counters.paths)
    }
}

/// The side of the squares of pixels that become one pixel each, so that a first step with one sample per pixel takes no more samples than its
/// share.
fn merged_side_px(scene: &Scene) -> u32 {
    let (film, integrator) = (&scene.film, &scene.integrator);
    // What a wide filter takes from beyond the film, and what neighbours share, depends on the size of pixels.
    if film.filter != Filter::Box || integrator.path_reuse != PathReuse::None {
        return 1;
    }
    let fits = |side: &u32| {
        let least = film.width.min(film.height) / side >= LEAST_SIDE_PX;
        let divides = film.width.is_multiple_of(*side) && film.height.is_multiple_of(*side);
        least && divides && side * side * integrator.spp <= FIRST * REPLICATES
    };
    (1..=64).rev().find(fits).unwrap_or(1)
}

/// Greatest common divisor.
fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

pub(super) fn run(args: &VerifyArgs, chosen: Vec<Truth>) -> Outcome {
    let interrupt = Interrupt::listen()
        .map_err(|error| Failure::run(Problem::from_err(error).wrap_err("cannot listen to signals")))?;
    // Plain radiance with polarisations averaged at every interface, or with polarisation, each where a truth wants it.
    let claims =
        [&Claim::UNPOLARISED[..], &[Claim::CarriesPolarisation, Claim::StokesParameters, Claim::Meters, Claim::Bands]]
            .concat();
    let chosen: Vec<Truth> = chosen.into_iter().filter(|truth| truth.applies_to(&claims)).collect();
    let significance = Budget::for_tests(chosen.len()).each();
    let mut report = Report::new(!args.json).with_seed(args.seed).of(chosen.len());
    // Readings of one scene follow each other.
    let mut last = None;
    for (index, truth) in chosen.iter().enumerate() {
        let Some(row) = judged(args, truth, significance, &interrupt, &mut last) else {
            let signal = interrupt.signal().expect("nothing else ends a measurement early");
            return report.interrupted(signal, &chosen[index..]);
        };
        report.push(row);
    }
    report.finish()
}

/// Renders and judges one truth, by as many samples as it takes. The measurement before is gone on with if it has the same scene. `None` if the
/// program was asked to end before.
pub(super) fn judged<'a>(
    args: &VerifyArgs,
    truth: &'a Truth,
    significance: f64,
    interrupt: &Interrupt,
    last: &mut Option<Measurement<'a>>,
) -> Option<Row> {
    let start = Instant::now();
    let known = last.take().and_then(|measurement| measurement.read_for(truth));
    // What is expected may take as long to evaluate as the scene takes to be prepared.
    let (_, made) = rayon::join(|| truth.value(), || known.map_or_else(|| Measurement::new(truth, args), Ok));
    let measured = made.map_err(Stop::Failed).and_then(|mut measurement| {
        let reading = measured(args, &mut measurement, significance, interrupt)?;
        let (paths, cut) = (measurement.paths(), measurement.cut_paths());
        *last = Some(measurement);
        Ok((reading, paths, cut))
    });
    let seconds = || start.elapsed().as_secs_f64();
    match measured {
        Ok((reading, paths, cut)) => {
            let needed = must_resolve(args, truth, u64::MAX);
            let row = Row::by(truth, Ok(reading), |reading| judge_to(truth, reading, significance, needed));
            let row = row.took(seconds(), Some(paths));
            Some(row.cut(cut, reading.cut_bias))
        }
        Err(Stop::Failed(why)) => Some(Row::new(truth, Err(why), significance).took(seconds(), None)),
        Err(Stop::Interrupted) => None,
    }
}

/// The bias that a reading must be able to see that has taken this many rays.
fn must_resolve(args: &VerifyArgs, truth: &Truth, rays: u64) -> f64 {
    let of_all = args.names.is_empty() && args.suite.is_none() && !args.is_thorough();
    match () {
        () if args.coarse => f64::INFINITY,
        () if of_all && rays >= RAYS_TO_SEE => truth.must_resolve_with(truth.must_see.max(LEAST_SEEN)),
        () => truth.must_resolve(),
    }
}

/// Takes more samples, never more seeds to choose from, as long as the reading [lacks](lacks) some, or a thorough run does not see what it
/// wants to. Both depend on the noise and on the count of cut paths, not on what was read. So stopping does not favour a verdict.
fn measured(
    args: &VerifyArgs,
    measurement: &mut Measurement<'_>,
    significance: f64,
    interrupt: &Interrupt,
) -> Result<Reading, Stop> {
    let truth = measurement.truth;
    let wanted = thorough_sees(args, truth) * truth.value().abs();
    let (mut effort, mut seen_before) = (measurement.effort.max(1), f64::INFINITY);
    loop {
        let reading = measurement.render_to(effort, significance, interrupt)?;
        if reading.cut_bias.is_infinite() {
            // No number of paths bounds it.
            break Ok(reading);
        }
        let seen = judge(truth, &reading, significance).resolvable_bias;
        let needed = must_resolve(args, truth, measurement.rays());
        let times = lacks(seen, needed, reading.cut_bias);
        let enough = times <= 1.0 || effort >= MOST_TO_COUNT;
        let thorough = || is_worth_more(measurement.rays(), seen_before, seen, wanted);
        if enough && !(args.is_thorough() && thorough()) {
            break Ok(reading);
        }
        effort = if enough { effort.saturating_mul(more_to_see(seen, wanted)) } else { to_count(effort, times) };
        seen_before = seen;
    }
}

/// How many times finer a reading must become to count: at most 1 if it does. It sees a bias of `seen` and must see `needed`, and paths that were
/// cut may have carried at most [`CUT_SHARE`] of what it sees. A few cut paths among few may have carried more than that as far as their number
/// can tell; a longer reading tells.
fn lacks(seen: f64, needed: f64, cut_bias: f64) -> f64 {
    let noise = if seen <= needed || needed.is_infinite() { 0.0 } else { seen / needed };
    noise.max(cut_bias / (CUT_SHARE * seen))
}

/// The effort after this one, by which a reading saw a bias of `times` what it must: about as much as it takes at 1/√n.
fn to_count(effort: u32, times: f64) -> u32 {
    let most = effort.saturating_mul(MORE_TO_COUNT);
    let enough = (f64::from(effort) * times * times * SPARE).ceil();
    // What is not a number goes on, too.
    if enough < f64::from(most) { (enough as u32).max(effort + 1) } else { most }
}

/// How many times the samples of a reading that saw `seen` are taken to see `wanted`: at 1/√n as many as it takes, a power of two up to [`MORE`].
fn more_to_see(seen: f64, wanted: f64) -> u32 {
    if seen <= wanted * f64::from(MORE_TO_COUNT).sqrt() { MORE_TO_COUNT } else { MORE }
}

/// What a thorough run wants to see of a truth, relative. A name that is only a part of the truth's asks for a group.
fn thorough_sees(args: &VerifyArgs, truth: &Truth) -> f64 {
    let by_default = || if args.names.contains(&truth.name) { THOROUGH_SEES_BY_NAME } else { THOROUGH_SEES };
    args.sees.unwrap_or_else(by_default)
}

/// Whether a thorough run goes on that saw `seen` by this many rays, and `before` by the step before. Up to [`THOROUGH_RAYS`] it does, as
/// long as it does not see what it wants to. Beyond, it must be going to see that by [`THOROUGH_REACH_RAYS`], at the rate of the last
/// step or at 1/√n.
fn is_worth_more(mut rays: u64, before: f64, seen: f64, wanted: f64) -> bool {
    if rays * u64::from(MORE) <= THOROUGH_RAYS {
        // What is not a number is judged as it is.
        return seen > wanted;
    }
    let gain = (before / seen).max(f64::from(MORE).sqrt());
    let mut predicted = seen;
    while predicted > wanted && rays * u64::from(MORE) <= THOROUGH_REACH_RAYS {
        (rays, predicted) = (rays * u64::from(MORE), predicted / gain);
    }
    seen > wanted && predicted <= wanted
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_oracle::truths::truths;

    #[test]
    fn a_thorough_run_sees_most_where_a_whole_name_is_given() {
        let truth = truths().into_iter().find(|truth| truth.name == "eye-in-glass").expect("there is such a truth");
        let sees = |names: &[&str], asked| {
            let names = names.iter().map(|name| (*name).to_owned()).collect();
            thorough_sees(&VerifyArgs { names, sees: asked, ..by_default() }, &truth)
        };
        assert_eq!(sees(&["eye-in-glass"], None), 2e-4);
        assert_eq!([sees(&["eye"], None), sees(&[], None)], [2e-3; 2]);
        assert_eq!(sees(&["eye-in-glass"], Some(5e-3)), 5e-3);
    }

    #[test]
    fn a_reading_that_is_almost_fine_enough_takes_little_more() {
        assert_eq!(
            [1.0001, 1.2, 1.4, 9.0, f64::NAN, f64::INFINITY].map(|times| to_count(100, times)),
            [116, 166, 200, 200, 200, 200]
        );
        assert_eq!(to_count(1, 1.01), 2);
    }

    #[test]
    fn a_reading_counts_if_it_is_fine_enough_and_cut_paths_carry_little() {
        assert_eq!(lacks(1e-3, 2e-3, 0.0), 0.0);
        assert_eq!(lacks(4e-3, 2e-3, 1e-4), 2.0);
        // Of what is seen a tenth may be missing, however coarse the reading may be.
        for needed in [2e-3, f64::INFINITY] {
            assert!(lacks(1e-3, needed, 0.9e-4) <= 1.0 && (lacks(1e-3, needed, 3e-4) - 3.0).abs() < 1e-12, "{needed}");
        }
        // No noise, or noise that is no number: more samples of a coarse run would tell no more.
        assert!([0.0, f64::NAN].iter().all(|seen| lacks(*seen, f64::INFINITY, 0.0) <= 1.0));
        assert!(lacks(f64::NAN, 2e-3, 0.0).is_nan() && lacks(0.0, 0.0, 0.0) <= 1.0);
    }

    #[test]
    fn the_last_step_is_as_long_as_it_takes() {
        assert_eq!([1.4, 1.42, 9.0].map(|times| more_to_see(times * 2e-3, 2e-3)), [2, 4, 4]);
    }

    #[test]
    fn a_thorough_run_spends_rays_where_they_will_show_what_it_wants_to_see() {
        let wanted = 1e-4;
        let seen_enough = is_worth_more(1_000, f64::INFINITY, 0.9e-4, wanted);
        let cheap = is_worth_more(8_000_000, 2e-2, 1e-2, wanted);
        let hopeless = is_worth_more(9_000_000, 2e-2, 1e-2, wanted);
        // Four steps at 1/√n end at 3.6 billion rays and 1e-4; at the rate 4 they come from 2.56e-2.
        let (near, too_far) =
            (is_worth_more(14_000_000, 2e-3, 1.6e-3, wanted), is_worth_more(14_000_000, 2e-3, 1.61e-3, wanted));
        let steep = is_worth_more(14_000_000, 0.1, 2.5e-2, wanted);
        let too_dear = is_worth_more(1_100_000_000, 2e-4, 1.1e-4, wanted);
        assert_eq!(
            [seen_enough, cheap, hopeless, near, too_far, steep, too_dear],
            [false, true, false, true, false, true, false]
        );
        // A black picture has no relative error, and a reading that is no number is not improved by more.
        assert!(is_worth_more(1_000, f64::INFINITY, 1e-9, 0.0) && !is_worth_more(9_000_000, 2e-9, 1e-9, 0.0));
        assert!(!is_worth_more(1_000, f64::INFINITY, f64::NAN, wanted));
    }

    /// Arguments of a run of all truths by default.
    fn by_default() -> VerifyArgs {
        VerifyArgs {
            names: Vec::new(),
            images: None,
            export: None,
            suite: None,
            page: None,
            peer: Vec::new(),
            json: false,
            seed: 1,
            thorough: false,
            sees: None,
            coarse: false,
            threads: Some(1),
        }
    }

    #[test]
    fn a_scene_is_rendered_once_for_all_truths_that_are_read_off_it() {
        let all = truths();
        let of = |name: &str| all.iter().find(|truth| truth.name == name).expect("there is such a truth");
        let [first, second, other] =
            ["", "-s1", "-s2"].map(|of_it| format!("slanting-light-scattered-by-spheres{of_it}")).map(|name| of(&name));
        let args = by_default();
        let fresh = |truth| Measurement::new(truth, &args).unwrap_or_else(|why| panic!("{why}"));
        let read = |measurement: &mut Measurement<'_>, effort| {
            let Ok(reading) = measurement.render_to(effort, 1e-6, &Interrupt::default()) else {
                panic!("it was stopped")
            };
            (reading.estimate.mean, reading.estimate.standard_error)
        };
        let mut shared = fresh(first);
        read(&mut shared, 2);
        let rays = shared.rays();
        let mut shared = shared.read_for(second).expect("it is the same scene");
        assert_eq!(read(&mut shared, 2), read(&mut fresh(second), 2));
        // No ray more, and further steps go on from there.
        assert_eq!(shared.rays(), rays);
        let mut shared = shared.read_for(other).expect("it is the same scene");
        assert_eq!(read(&mut shared, 3), read(&mut fresh(other), 3));
        assert!(shared.read_for(of("slanting-light-scattered-by-grains-s2")).is_none(), "another scene");
        assert!(fresh(of("plate-at-45-degrees")).read_for(of("plate-at-45-degrees-polarised")).is_none());
    }

    #[test]
    fn pixels_are_merged_as_long_as_the_first_step_takes_its_share_and_the_mean_stays() {
        let side = |film: &str, integrator: &str| {
            let text = format!(
                r#"{{ "etalon": 1, "camera": {{ "type": "perspective", "position_m": [0, 0, 3], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40 }},
                "film": {{ {film} }}, "integrator": {{ {integrator} }}, "lights": [{{ "type": "environment", "radiance": 1 }}] }}"#
            );
            merged_side_px(&etalon_scene::parse(&text, "scene").unwrap_or_else(|error| panic!("{error:?}")).0)
        };
        let square = r#""width": 32, "height": 32"#;
        // 32 / 4 = 8 pixels a side; 2 · 2 · 512 samples are the share of 32 · 64; a third divides neither side.
        assert_eq!([8, 512, 513, 4096].map(|spp| side(square, &format!(r#""spp": {spp}"#))), [4, 2, 1, 1]);
        assert_eq!(side(r#""width": 36, "height": 27"#, r#""spp": 8"#), 3);
        let gaussian = r#""width": 32, "height": 32, "filter": { "type": "gaussian", "sigma_px": 0.5 }"#;
        assert_eq!(side(gaussian, r#""spp": 8"#), 1);
        assert_eq!(side(square, r#""spp": 8, "path_reuse": "2x2""#), 1);
    }
}
