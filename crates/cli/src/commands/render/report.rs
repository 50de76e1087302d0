//! What is said about a render that is done.

use etalon::{ErrorReport, PredictionReport, reached_name};
use etalon_control::{Explored, Prediction, Reached};
use etalon_transport::accuracy::{FEWEST_LIT, Region};
use etalon_transport::{Counters, ImageError, Plan};
use serde::Serialize;

use super::{Done, Job, RenderArgs};
use crate::failure::Failure;
use crate::output::Written;
use crate::problem_json::{ProblemJson, problem_json, problems_json};
use crate::progress::{duration, percent, si, two_digits};

/// What `--json` prints about a render.
#[derive(Serialize)]
pub(super) struct RenderJson<'a> {
    scene: String,
    scene_sha256: &'a str,
    /// The number of the frame, in a sequence.
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<u32>,
    /// The first output; `outputs` has all.
    output: Option<&'a str>,
    outputs: &'a [Written],
    width: u32,
    height: u32,
    /// Columns x0 to x1, rows y0 to y1.
    crop: [u32; 4],
    /// Samples a pixel; their mean, where regions take different numbers.
    spp: u32,
    seed: u64,
    threads: usize,
    /// From the start of the exploration, the pilot, or the render without them.
    seconds: f64,
    /// What ended the render: "samples", "error", "time" or "interrupted".
    reached: &'static str,
    /// What the pilot predicted for the error asked for.
    predicted: Option<PredictionReport>,
    /// How it was decided where the samples go; `null` where that was not asked.
    adaptive: Option<AdaptiveJson>,
    prepare_seconds: f64,
    paths: u64,
    paths_per_second: f64,
    rays: u64,
    shadow_rays: u64,
    lens_draws: u64,
    time_draws: u64,
    environment_lookups: u64,
    lane_weights: u64,
    lost_media: u64,
    /// Paths cut at the renderer's own limit on vertices.
    cut_paths: u64,
    nonfinite: u64,
    /// The first of them: column, row, number of the sample.
    nonfinite_at: Vec<[u32; 3]>,
    /// `null` with a single replicate, of whose error nothing is known. Where no sample found light, the numbers in it that are
    /// unknown are `null`.
    error: Option<ErrorReport>,
    warnings: Vec<ProblemJson>,
    errors: Vec<ProblemJson>,
    plan: &'a Plan,
}

/// What an exploration found, and whether it was followed.
#[derive(Serialize)]
pub(super) struct AdaptiveJson {
    /// Factor of time that uneven shares were predicted to win.
    predicted_gain: f64,
    used: bool,
    /// Fewest and most samples of a pixel.
    samples: [u32; 2],
    exploration_paths: u64,
    exploration_seconds: f64,
}

fn adaptive_json(done: &Done, explored: &Explored) -> AdaptiveJson {
    AdaptiveJson {
        predicted_gain: explored.exploration.gain,
        used: explored.used,
        samples: least_and_most(done, explored),
        exploration_paths: explored.exploration.paths,
        exploration_seconds: explored.seconds,
    }
}

fn least_and_most(done: &Done, explored: &Explored) -> [u32; 2] {
    if explored.used {
        let replicates = done.canvas.with_film(|film| film.replicates());
        explored.exploration.allocation.least_and_most(done.ended.samples, replicates)
    } else {
        [done.ended.samples; 2]
    }
}

/// What was explored, in words.
fn describe_explored(done: &Done, explored: &Explored) -> String {
    let gain = explored.exploration.gain;
    if explored.used {
        let [least, most] = least_and_most(done, explored);
        format!(
            "{least} to {most} samples per pixel, more where the error is larger: an exploration ({}) predicted {gain:.1} times less time",
            duration(explored.seconds),
        )
    } else {
        format!(
            "the same number of samples in every pixel: an exploration ({}) predicted too little gain from others ({gain:.2} times less time)",
            duration(explored.seconds)
        )
    }
}

/// Seconds that went into an exploration and a pilot.
fn pilot_seconds(done: &Done) -> f64 {
    let predicted = done.ended.predicted.map_or(0.0, |predicted| predicted.pilot_seconds);
    predicted + done.explored.as_ref().map_or(0.0, |explored| explored.seconds)
}

/// What was predicted beside what came.
fn describe_prediction(done: &Done, predicted: &Prediction) -> String {
    let took = done.ended.seconds - pilot_seconds(done);
    if predicted.cost_estimate.samples.is_nan() {
        let [pilot, asked] = [duration(predicted.pilot_seconds), percent(predicted.cost_estimate.relative_rmse)];
        return format!("the pilot ({pilot}) found no light, so the cost of {asked} is unknown");
    }
    let mut text = format!(
        "the pilot ({}) predicted {} for {}, with {} samples",
        duration(predicted.pilot_seconds),
        duration(predicted.cost_estimate.seconds),
        percent(predicted.cost_estimate.relative_rmse),
        two_digits(predicted.cost_estimate.samples),
    );
    text += &match done.ended.reached {
        Reached::Error => {
            format!("; it took {}, {:.2} times the prediction", duration(took), took / predicted.cost_estimate.seconds)
        }
        Reached::Time => "; --time ended the render earlier".to_owned(),
        Reached::Samples => "; --spp ended the render earlier".to_owned(),
        Reached::Interrupted => "; the render was interrupted earlier".to_owned(),
    };
    text
}

/// The error in words.
fn describe_error(error: &ImageError) -> String {
    let Some(Region { rect, relative_rmse, share }) = &error.noisiest else {
        let why = if error.found_light() {
            "the picture's values are too small or too large to be squared"
        } else {
            "no sample found light"
        };
        return format!("relative error unknown: {why}");
    };
    let interval = if error.has_interval() {
        format!("95 % sure: {} to {}", percent(error.interval[0]), percent(error.interval[1]))
    } else {
        format!("no interval: fewer than {FEWEST_LIT} replicates of pixels found light")
    };
    let mut text = format!(
        "relative error {} ({interval}); noisiest in columns {} to {}, rows {} to {}: {}, {:.0} % of the squared error",
        percent(error.relative_rmse),
        rect.x0,
        rect.x1 - 1,
        rect.y0,
        rect.y1 - 1,
        percent(*relative_rmse),
        100.0 * share,
    );
    if error.is_heavy_tailed() {
        text.push_str("\n  rare bright paths cause most of this error: the true error is probably larger");
    } else if error.has_heavy_tailed_pixels() {
        text.push_str(
            "\n  rare bright paths: the error bars of single pixels are too short, but those of larger regions are right",
        );
    }
    text
}

/// The report for machines.
pub(super) fn json<'a>(
    args: &RenderArgs,
    job: &'a Job,
    done: &Done,
    written: &'a [Written],
    failure: &Failure,
) -> RenderJson<'a> {
    let (samples, seconds) = (done.ended.samples, done.ended.seconds);
    let counters: &Counters = &done.canvas.with_film(|film| film.counters.clone());
    let subject = &job.subject;
    RenderJson {
        scene: args.scene.display().to_string(),
        scene_sha256: &job.loaded.sha256,
        frame: subject.frame.map(|frame| frame.number),
        output: written.first().map(|written| written.path.as_str()),
        outputs: written,
        width: subject.size[0],
        height: subject.size[1],
        crop: [job.rect.x0, job.rect.x1, job.rect.y0, job.rect.y1],
        spp: samples,
        seed: job.loaded.scene.integrator.seed,
        threads: job.threads,
        seconds,
        reached: reached_name(done.ended.reached),
        predicted: done.ended.predicted.as_ref().map(PredictionReport::new),
        adaptive: done.explored.as_ref().map(|explored| adaptive_json(done, explored)),
        prepare_seconds: job.prepare_seconds,
        paths: counters.paths,
        paths_per_second: counters.paths as f64 / (seconds - pilot_seconds(done)),
        rays: counters.rays,
        shadow_rays: counters.shadow_rays,
        lens_draws: counters.lens_draws,
        time_draws: counters.time_draws,
        environment_lookups: counters.environment_lookups,
        lane_weights: counters.lane_weights,
        lost_media: counters.lost_media,
        cut_paths: counters.cut_paths,
        nonfinite: counters.nonfinite,
        nonfinite_at: counters.nonfinite_at.iter().map(|at| [at.x, at.y, at.sample]).collect(),
        error: done.error.as_ref().map(|error| ErrorReport::new(subject.replicates, error)),
        warnings: job.warnings.iter().map(problem_json).collect(),
        errors: problems_json(failure),
        plan: job.prepared.plan(),
    }
}

/// The report for people.
pub(super) fn summary(job: &Job, done: &Done, written: &[Written]) -> String {
    let (samples, seconds) = (done.ended.samples, done.ended.seconds);
    let counters = done.canvas.with_film(|film| film.counters.clone());
    let uneven = done.explored.as_ref().is_some_and(|explored| explored.used);
    let each = match (uneven, samples) {
        (true, _) => "samples on average",
        (false, 1) => "sample each",
        (false, _) => "samples each",
    };
    let mut text = format!(
        "{} × {} pixels, {} {each}, in {seconds:.1} s ({} paths/s on {} threads), {} samples not finite",
        job.rect.x1 - job.rect.x0,
        job.rect.y1 - job.rect.y0,
        samples,
        si(counters.paths as f64 / (seconds - pilot_seconds(done))),
        job.threads,
        counters.nonfinite,
    );
    if let Some(error) = &done.error {
        text.push_str("\n  ");
        text.push_str(&describe_error(error));
    }
    if let Some(explored) = &done.explored {
        text.push_str("\n  ");
        text.push_str(&describe_explored(done, explored));
    }
    if let Some(predicted) = &done.ended.predicted {
        text.push_str("\n  ");
        text.push_str(&describe_prediction(done, predicted));
    }
    for written in written {
        text.push_str("\n  ");
        text.push_str(&written.path);
        if let Some(description) = &written.description {
            text.push_str(": ");
            text.push_str(description);
        }
    }
    text
}
