//! Our own integrator, held to the truths.

use std::time::Instant;

use etalon_oracle::statistics::{Budget, Welford};
use etalon_oracle::subjects::{Reading, Renders};
use etalon_oracle::truths::{Claim, Truth, judge};
use etalon_scene::{Precision, Scene};
use etalon_transport::{Control, Extent, Study, prepare_study};

use super::report::{Report, Row};
use super::{Args, PrecisionArg};
use crate::failure::Outcome;

/// Independent renders of each truth: their scatter is the standard error, whatever the samples within one have to do
/// with each other. With 64 of them Student's t at the suite's significance is close to the normal distribution.
const REPLICATES: u32 = 64;
/// At the first try, all replicates together take this part of the samples that the truth's scene suggests: those are meant
/// for independent numbers.
const FIRST: u32 = 4;
/// A reading too noisy to count is taken again with this many times the paths, so many times.
const MORE: u64 = 4;
const TRIES: u32 = 5;
/// What a thorough run wants to see of each truth, relative, and after how many tries it gives up: 64 times the paths.
const THOROUGH_SEES: f64 = 1e-4;
const THOROUGH_TRIES: u32 = 4;

/// Our renderer, as the oracle sees one.
struct Etalon {
    seed: u64,
    /// In parts of the samples that the scene suggests, [`FIRST`] of them.
    effort: u64,
    precision: Precision,
    /// Whether light is followed with its polarisation.
    polarised: bool,
    threads: Option<usize>,
}

impl Etalon {
    /// The scene as one replicate renders it.
    fn replicate(&self, json: &str, replicate: u32) -> Result<Scene, String> {
        let (mut scene, _) = etalon_scene::parse(json, "truth").map_err(|errors| errors.summary())?;
        let suggested = self.effort * u64::from(scene.integrator.spp);
        let spp = suggested.div_ceil(u64::from(FIRST * REPLICATES)).next_power_of_two();
        scene.integrator.precision = self.precision;
        // Distinct for each pair: fewer replicates than 2¹⁶.
        scene.integrator.seed = self.seed << 16 | u64::from(replicate);
        // Each render is one replicate here.
        scene.integrator.replicates = 1;
        scene.integrator.spp = u32::try_from(spp).map_err(|error| error.to_string())?;
        Ok(scene)
    }

    /// Mean Y of the whole film, and its non-finite samples.
    fn mean_y(&self, scene: &Scene) -> Result<(f64, u64), String> {
        let study = Study { polarised: self.polarised, ..Study::default() };
        let prepared = prepare_study(scene, &study).map_err(|error| error.to_string())?;
        let extent = Extent { threads: self.threads, ..prepared.whole(None) };
        let film = prepared.render(&extent, &|_| Control::Continue).map_err(|error| error.to_string())?;
        if film.counters.cut_paths > 0 {
            return Err(format!("{} paths were cut at the internal limit", film.counters.cut_paths));
        }
        Ok((film.mean_y(extent.rect), film.counters.nonfinite))
    }
}

impl Renders for Etalon {
    fn render(&mut self, truth: &Truth) -> Result<Reading, String> {
        let (mut moments, mut nonfinite) = (Welford::new(), 0);
        for replicate in 0..REPLICATES {
            let (mean, bad) = self.mean_y(&self.replicate(&truth.scene, replicate)?)?;
            // A film of CIE Y reads a narrow band relative to a white sky in the same band.
            let white = match truth.band_nm {
                Some(_) => self.mean_y(&self.replicate(&truth.white_scene(), replicate)?)?.0,
                None => 1.0,
            };
            moments.push(mean / white);
            nonfinite += bad;
        }
        Ok(Reading { estimate: moments.estimate(), nonfinite })
    }
}

pub(super) fn run(args: &Args, chosen: Vec<Truth>) -> Outcome {
    // Plain radiance with polarisations averaged at every interface, or with polarisation, each where a truth wants it.
    let claims = [&Claim::UNPOLARISED[..], &[Claim::CarriesPolarisation]].concat();
    let chosen: Vec<Truth> = chosen.into_iter().filter(|truth| truth.applies_to(&claims)).collect();
    let budget = Budget::for_tests(chosen.len());
    let mut report = Report::new(!args.json).with_seed(args.seed);
    for truth in &chosen {
        report.push(judged(args, truth, budget.each()));
    }
    report.finish()
}

/// Renders and judges one truth; takes more samples, never more seeds to choose from, where the reading was too noisy to
/// exclude a known mistake, or for a thorough run to see what it wants to. Whether it was depends on the noise alone, so that
/// stopping does not favour a verdict.
fn judged(args: &Args, truth: &Truth, significance: f64) -> Row {
    let start = Instant::now();
    let mut renderer = Etalon {
        seed: args.seed,
        effort: 1,
        precision: match args.precision {
            PrecisionArg::F32 => Precision::F32,
            PrecisionArg::F64 => Precision::F64,
        },
        polarised: truth.claims.contains(&Claim::CarriesPolarisation),
        threads: args.threads.map(|threads| threads as usize),
    };
    let mut tries = 1;
    let reading = loop {
        let reading = renderer.render(truth);
        let Ok(read) = &reading else { break reading };
        let seen = judge(truth, read, significance).resolvable_bias;
        let enough = seen <= truth.must_resolve() || tries >= TRIES;
        let thorough = seen <= THOROUGH_SEES * truth.value || tries >= THOROUGH_TRIES;
        if enough && (thorough || !args.thorough) {
            break reading;
        }
        tries += 1;
        renderer.effort *= MORE;
    };
    Row::new(truth, reading, significance).took(start.elapsed().as_secs_f64())
}
