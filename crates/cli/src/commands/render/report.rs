//! What is said about a render that is done.

use etalon_transport::{Film, Plan};
use serde::Serialize;

use super::{Args, Job};
use crate::failure::{Failure, ProblemJson, problem_json};
use crate::output::{self, Written};
use crate::progress::si;

/// What `--json` prints about a render.
#[derive(Serialize)]
pub(super) struct RenderJson<'a> {
    scene: String,
    scene_sha256: &'a str,
    /// The first output; `outputs` has all.
    output: Option<&'a str>,
    outputs: &'a [Written],
    width: u32,
    height: u32,
    /// Columns x0 to x1, rows y0 to y1.
    crop: [u32; 4],
    spp: u32,
    seed: u64,
    threads: usize,
    seconds: f64,
    prepare_seconds: f64,
    paths: u64,
    paths_per_second: f64,
    rays: u64,
    shadow_rays: u64,
    lens_draws: u64,
    environment_lookups: u64,
    lane_weights: u64,
    /// Paths cut at the renderer's own limit on vertices.
    cut_paths: u64,
    nonfinite: u64,
    /// The first of them: column, row, number of the sample.
    nonfinite_at: Vec<[u32; 3]>,
    warnings: Vec<ProblemJson>,
    errors: Vec<ProblemJson>,
    plan: &'a Plan,
}

/// The report for machines.
pub(super) fn json<'a>(
    args: &Args,
    job: &'a Job,
    film: &Film,
    written: &'a [Written],
    failure: &Failure,
    seconds: f64,
) -> RenderJson<'a> {
    let counters = &film.counters;
    RenderJson {
        scene: args.scene.display().to_string(),
        scene_sha256: &job.loaded.sha256,
        output: written.first().map(|written| written.path.as_str()),
        outputs: written,
        width: film.width(),
        height: film.height(),
        crop: [job.rect.x0, job.rect.x1, job.rect.y0, job.rect.y1],
        spp: job.loaded.scene.integrator.spp,
        seed: job.loaded.scene.integrator.seed,
        threads: job.threads,
        seconds,
        prepare_seconds: job.prepare_seconds,
        paths: counters.paths,
        paths_per_second: counters.paths as f64 / seconds,
        rays: counters.rays,
        shadow_rays: counters.shadow_rays,
        lens_draws: counters.lens_draws,
        environment_lookups: counters.environment_lookups,
        lane_weights: counters.lane_weights,
        cut_paths: counters.cut_paths,
        nonfinite: counters.nonfinite,
        nonfinite_at: counters.nonfinite_at.iter().map(|at| [at.x, at.y, at.sample]).collect(),
        warnings: job.warnings.iter().map(problem_json).collect(),
        errors: failure.to_json(),
        plan: job.prepared.plan(),
    }
}

/// The report for people.
pub(super) fn summary(job: &Job, film: &Film, written: &[Written], seconds: f64) -> String {
    let mut text = format!(
        "{} × {} pixels, {} samples each, in {seconds:.1} s ({} paths/s on {} threads), {} not finite",
        job.rect.x1 - job.rect.x0,
        job.rect.y1 - job.rect.y0,
        job.loaded.scene.integrator.spp,
        si(film.counters.paths as f64 / seconds),
        job.threads,
        film.counters.nonfinite,
    );
    for written in written {
        text.push_str("\n  ");
        text.push_str(&written.path);
        if let Some(clipping) = &written.clipping {
            text.push_str(": ");
            text.push_str(&output::describe_clipping(clipping));
        }
    }
    text
}
