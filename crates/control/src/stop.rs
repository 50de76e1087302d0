//! When a render ends: by samples, by error or by time, whichever is reached first.
//!
//! The number of samples for an error is chosen by a [`Pilot`] before the picture begins, so the picture's own values have
//! no say in it. A deadline decides by how long passes take, which depends on the length of paths, not on what they bring.

use crate::adaptive::{Adaptivity, Exploration, Goal, WORTHWHILE, explore};
use crate::canvas::{Canvas, Shard};
use crate::cost_estimate::{CostEstimate, between, next_step};
use crate::pilot::Pilot;
use crate::sample_allocation::SampleAllocation;
use etalon_transport::{Control, Counters, Film, PixelRect, Prepared, ThreadError, TileSums};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// What a render may cost, or must reach. Without any limit it would not end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Most samples a pixel, in the mean; [`Limits::ANY_SAMPLES`] is no limit.
    pub samples: u32,
    /// The relative error at which it is good enough: see [`etalon_transport::accuracy`].
    pub relative_rmse: Option<f64>,
    /// Seconds from the start of the render, the pilot included.
    pub seconds: Option<f64>,
    /// Whether regions take different numbers of samples.
    pub adaptivity: Adaptivity,
}

impl Limits {
    /// More samples a pixel than any render takes.
    pub const ANY_SAMPLES: u32 = i32::MAX as u32;

    /// Whether the render ends although its error is never reached.
    fn end_without_error(&self) -> bool {
        self.samples < Self::ANY_SAMPLES || self.seconds.is_some()
    }
}

/// Why it cannot be settled how many samples a picture takes.
#[derive(Debug, thiserror::Error)]
pub enum SettleError {
    /// See [`ThreadError`].
    #[error(transparent)]
    Threads(#[from] ThreadError),
    /// The render is to end by its error alone, which is unknown as long as no light is found.
    #[error("the pilot found no light in {paths} paths, so the error of the picture is unknown and cannot be reached")]
    NoLight {
        /// Camera paths that the pilot traced.
        paths: u64,
    },
}

/// Which limit ended a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reached {
    /// The number of samples.
    Samples,
    /// The relative error.
    Error,
    /// The time.
    Time,
    /// Whoever watched wanted no more.
    Interrupted,
}

/// What was predicted before a render for the sake of its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// What the error was to cost: the samples chosen, and seconds of rendering.
    pub cost_estimate: CostEstimate,
    /// Seconds that the pilot took.
    pub pilot_seconds: f64,
}

/// How it was decided where the samples go.
#[derive(Clone, Debug, PartialEq)]
pub struct Explored {
    /// What the exploration found.
    pub exploration: Exploration,
    /// Whether the picture's samples are spread accordingly.
    pub used: bool,
    /// Seconds that the exploration took.
    pub seconds: f64,
}

/// A render that has ended.
#[derive(Clone, Debug)]
pub struct Finished {
    /// The film.
    pub film: Film,
    /// Samples that every pixel has, at least; with shares, in the mean.
    pub samples: u32,
    /// How they are spread over regions; `None` gives every pixel the same number.
    pub allocation: Option<Arc<SampleAllocation>>,
    /// Why no more.
    pub reached: Reached,
    /// Seconds from the start to the end, the pilot included.
    pub seconds: f64,
    /// What was predicted, if a relative error was asked for.
    pub predicted: Option<Prediction>,
    /// The exploration, if there was one.
    pub explored: Option<Explored>,
}

/// How a render on a canvas ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ended {
    /// Samples that every pixel has, at least; with shares, in the mean.
    pub samples: u32,
    /// Why no more.
    pub reached: Reached,
    /// Seconds from the start to the end, the pilot included.
    pub seconds: f64,
    /// What was predicted, if a relative error was asked for.
    pub predicted: Option<Prediction>,
}

/// How many samples a picture takes, settled before it begins.
#[derive(Clone, Debug, PartialEq)]
pub struct Settled {
    /// Samples a pixel; with shares, in the mean.
    pub samples: u32,
    /// How they are spread over regions; `None` gives every pixel the same number.
    pub allocation: Option<Arc<SampleAllocation>>,
    /// What it is that these samples reach.
    pub reached: Reached,
    /// What was predicted, if a relative error was asked for.
    pub predicted: Option<Prediction>,
    /// The exploration that the shares are from, or that found none worth while.
    pub explored: Option<Explored>,
}

impl Settled {
    /// Samples of the pixels of one of a canvas's tiles where all pixels have `mean` in the mean.
    fn samples_of(&self, tile: PixelRect, mean: u32, replicates: u32) -> u32 {
        self.allocation.as_ref().map_or(mean, |allocation| allocation.samples(tile.x0, tile.y0, mean, replicates))
    }
}

/// How a render goes on, for whoever watches it.
pub trait Watch: Sync {
    /// Work was done: camera paths and rays, of an exploration, the pilot or the picture.
    fn work(&self, counters: &Counters) {
        let _ = counters;
    }
    /// The picture begins; it will take this many camera paths, or fewer if time is up.
    fn planned(&self, paths: u64, predicted: Option<&Prediction>) {
        let _ = (paths, predicted);
    }
    /// A piece of a tile is done, and these are its sums.
    fn tile(&self, rect: PixelRect, sums: &TileSums) {
        let _ = (rect, sums);
    }
    /// A pass has ended: samples a pixel so far, in the mean.
    fn pass(&self, film: &Film, samples: u32) {
        let _ = (film, samples);
    }
    /// Whether to go on; asked after each piece of work.
    fn control(&self) -> Control {
        Control::Continue
    }
}

impl Watch for () {}

/// Part of the time that an exploration may take.
const EXPLORING: f64 = 1.0 / 16.0;

/// Passes that a picture takes at least, so that whoever watches sees the error fall.
const PASSES: u32 = 16;
/// Samples a pixel that are one pass all the same: to begin a piece of a tile costs something.
const WORTH_A_PASS: u32 = 16;

/// Part of the remaining time that passes are planned for: what is left pays for passes that take longer than the last.
const USE_OF_TIME: f64 = 0.98;

/// Renders `rect` until the first of the limits. `clock` tells seconds since the start. The film is the one that
/// [`Prepared::render`] gives for the same number of samples; at least one sample for each replicate is taken.
pub fn render_within(
    prepared: &Prepared,
    rect: PixelRect,
    limits: &Limits,
    threads: Option<usize>,
    clock: &(dyn Fn() -> f64 + Sync),
    watch: &dyn Watch,
) -> Result<Finished, SettleError> {
    let settled = settle(prepared, rect, limits, threads, clock, watch)?;
    let canvas = Canvas::new(prepared, rect, Shard::WHOLE, settled.allocation.as_deref());
    let Ended { samples, reached, seconds, predicted } =
        render_canvas(prepared, &canvas, &settled, limits, threads, clock, watch)?;
    let Settled { allocation, explored, .. } = settled;
    Ok(Finished { film: canvas.into_film(), samples, allocation, reached, seconds, predicted, explored })
}

/// Settles how many samples a picture takes, and where: the most that are allowed, or those that a pilot says its error
/// takes, spread as an exploration says.
///
/// # Errors
/// If there are no threads, and if the pilot finds no light where nothing but the error is to end the render.
pub fn settle(
    prepared: &Prepared,
    rect: PixelRect,
    limits: &Limits,
    threads: Option<usize>,
    clock: &(dyn Fn() -> f64 + Sync),
    watch: &dyn Watch,
) -> Result<Settled, SettleError> {
    let explored = explored(prepared, rect, limits, threads, clock, watch)?;
    let allocation = explored.as_ref().filter(|explored| explored.used).map(|e| Arc::clone(&e.exploration.allocation));
    let most = match &allocation {
        None => limits.samples,
        Some(allocation) => {
            limits.samples.min(allocation.largest_mean(i32::MAX as u32, prepared.scene().integrator.replicates))
        }
    };
    let settled = Settled { samples: most, allocation, reached: Reached::Samples, predicted: None, explored };
    let Some(target) = limits.relative_rmse else { return Ok(settled) };
    let mut pilot = Pilot::new(prepared, rect, settled.allocation.clone(), threads)?;
    let needed = pilot.samples_for(target, most, limits, clock, watch);
    if pilot.found_no_light() && !limits.end_without_error() && watch.control() == Control::Continue {
        return Err(SettleError::NoLight { paths: pilot.paths() });
    }
    let cost_estimate = pilot.cost_estimate(target);
    let point = pilot.points().last().expect("a pilot takes a step at least");
    let predicted = Some(Prediction {
        cost_estimate: match needed {
            // What was chosen, not what a law through the pilot's points says.
            Some(needed) => CostEstimate {
                samples: f64::from(needed),
                seconds: point.seconds / f64::from(point.samples) * f64::from(needed),
                ..cost_estimate
            },
            None => cost_estimate,
        },
        pilot_seconds: pilot.seconds(),
    });
    Ok(match needed {
        Some(samples) if samples <= most => Settled { samples, reached: Reached::Error, predicted, ..settled },
        _ => Settled { predicted, ..settled },
    })
}

/// Explores where samples are worth most, where that is wanted.
fn explored(
    prepared: &Prepared,
    rect: PixelRect,
    limits: &Limits,
    threads: Option<usize>,
    clock: &(dyn Fn() -> f64 + Sync),
    watch: &dyn Watch,
) -> Result<Option<Explored>, ThreadError> {
    let has_goal = limits.relative_rmse.is_some() || limits.adaptivity == Adaptivity::Always;
    if !has_goal || !limits.adaptivity.explores(prepared) {
        return Ok(None);
    }
    let start = clock();
    let goal = Goal { samples: limits.samples, relative_rmse: limits.relative_rmse };
    let late = || limits.seconds.is_some_and(|seconds| clock() - start > EXPLORING * seconds);
    let enough = || watch.control() == Control::Stop || late();
    let exploration = explore(prepared, rect, &goal, threads, &enough, &|counters| watch.work(counters))?;
    let used = limits.adaptivity == Adaptivity::Always || exploration.gain >= WORTHWHILE;
    Ok(Some(Explored { exploration, used, seconds: clock() - start }))
}

/// Renders a canvas on until all its tiles have the samples that were settled, time is up or `watch` says stop.
pub fn render_canvas(
    prepared: &Prepared,
    canvas: &Canvas,
    settled: &Settled,
    limits: &Limits,
    threads: Option<usize>,
    clock: &(dyn Fn() -> f64 + Sync),
    watch: &dyn Watch,
) -> Result<Ended, ThreadError> {
    let &Settled { samples, mut reached, predicted, .. } = settled;
    let replicates = prepared.scene().integrator.replicates;
    watch.planned(canvas.paths(&|tile| settled.samples_of(tile, samples, replicates)), predicted.as_ref());

    // What a tile has beyond the stage that all have reached is not rendered again.
    let mut done = if settled.allocation.is_some() { 0 } else { canvas.samples()[0] };
    let (start, traced) = (clock(), AtomicU64::new(0));
    while done < samples && watch.control() == Control::Continue {
        // Samples a pixel that this run has rendered, in the mean: what a picture had before does not tell how fast it goes on.
        let rendered = traced.load(Ordering::Relaxed) as f64 / canvas.area() as f64;
        // As many again as there are, until that is a part of the whole: the error is known after each pass.
        let is_untimed = limits.seconds.is_some() && rendered == 0.0;
        let mut pass = if is_untimed { replicates } else { done.max(replicates) }.min(samples - done);
        let mut end = samples;
        if let (Some(seconds), false) = (limits.seconds, is_untimed) {
            let now = clock();
            let affordable = USE_OF_TIME * (seconds - now) / ((now - start) / rendered);
            // Whole rounds of replicates, so that all weigh alike.
            let affordable = affordable.max(0.0) as u32 / replicates * replicates;
            if affordable == 0 {
                reached = Reached::Time;
                break;
            }
            pass = pass.min(affordable);
            end = end.min(done.saturating_add(affordable));
        }
        pass = pass.min((end / PASSES).max(WORTH_A_PASS).next_multiple_of(replicates));
        let target = |rect| settled.samples_of(rect, done + pass, replicates);
        canvas.advance(prepared, &target, threads, &|piece| {
            traced.fetch_add(piece.counters.paths, Ordering::Relaxed);
            watch.work(piece.counters);
            watch.tile(piece.rect, piece.sums);
            watch.control()
        })?;
        if !canvas.has_reached(&target) {
            break;
        }
        done += pass;
        canvas.with_film(|film| watch.pass(film, done));
    }
    if done < samples && reached != Reached::Time {
        reached = Reached::Interrupted;
    }
    Ok(Ended { samples: done, reached, seconds: clock(), predicted })
}

impl Pilot<'_> {
    /// Goes on until the error is `target` and returns the number of samples a pixel for it; `None` as soon as that is
    /// certain to exceed `most` samples or the other limits, and if no light is found. An unknown error is never reached.
    fn samples_for(
        &mut self,
        target: f64,
        most: u32,
        limits: &Limits,
        clock: &(dyn Fn() -> f64 + Sync),
        watch: &dyn Watch,
    ) -> Option<u32> {
        loop {
            if let Some(samples) = self.step_toward(target, most, clock, &|counters| watch.work(counters)) {
                return Some(samples);
            }
            let &point = self.points().last().expect("it has just advanced");
            if watch.control() == Control::Stop
                || point.samples >= most
                || self.found_no_light()
                || limits.seconds.is_some_and(|s| clock() + point.seconds > s)
            {
                return None;
            }
        }
    }

    /// Takes one step on the way to the error `target`, and returns the number of samples a pixel for it once a step has reached it; steps
    /// that were taken before count. `most` bounds the samples of the step.
    pub fn step_toward(
        &mut self,
        target: f64,
        most: u32,
        clock: &(dyn Fn() -> f64 + Sync),
        on_work: &(dyn Fn(&Counters) + Sync),
    ) -> Option<u32> {
        let replicates = self.first_step();
        if !self.points().iter().any(|point| point.reaches(target)) {
            let next = self.points().last().map_or(replicates, |point| {
                // No further than the law of the error says, and over no step of an octave, for that law is a guess, and a whole power
                // of two may have an error that no number before it has.
                let predicted = self.cost_estimate(target).samples / f64::from(replicates);
                let rounds = point.samples / replicates;
                let predicted = (predicted.ceil().min(f64::from(u32::MAX)) as u32).max(rounds + rounds.div_ceil(16));
                let rounds = predicted.min(next_step(rounds));
                rounds.saturating_mul(replicates).min(most.max(replicates))
            });
            self.advance(next, clock, on_work);
        }
        let &point = self.points().iter().find(|point| point.reaches(target))?;
        // Whole rounds of replicates, so that all weigh alike.
        let samples = between(self.points(), target).unwrap_or(f64::from(point.samples));
        Some((samples / f64::from(replicates)).ceil() as u32 * replicates)
    }
}
