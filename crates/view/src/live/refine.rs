//! The picture itself: passes over all pixels, and a pilot that takes turns with them until it knows how many samples are enough.
//!
//! The pilot decides the number of samples as that of `etalon render --error` does, by random numbers of its own. It runs beside the first
//! passes instead of before them, so that the page has a picture of all pixels soon. The order changes no sample.

use std::sync::Arc;
use std::time::{Duration, Instant};

use etalon::Subject;
use etalon_control::adaptive::{Goal, WORTHWHILE, explore};
use etalon_control::{Adaptivity, Canvas, Limits, Pilot, SampleAllocation, Shard};
use etalon_transport::{Control, PixelRect, ThreadError};

use super::painter::{Halt, Paint};
use super::publish::{Publisher, Shown, may_look};
use super::status::{Phase, Predicted};
use super::{Wish, costs};

use crate::picture::{film_of, whole};

/// Seconds that a pass over the picture takes, at least and at most.
const PASS_S: [f64; 2] = [0.25, 2.0];
/// How long the first pass waits for a page, so that its browser has the processor to itself while it starts.
const FIRST_PAGE: Duration = Duration::from_secs(1);
/// Stated error below which the first pass takes a small part of the time.
const PAYS_BELOW: f64 = 0.035;
/// Seconds that an exploration may take before it takes no further step: without it there is no picture of all pixels.
const EXPLORING_S: f64 = 2.5;
/// Errors whose cost the page shows.
const PREDICTED: [f64; 12] = [0.5, 0.2, 0.1, 0.07, 0.05, 0.03, 0.02, 0.014, 0.01, 0.005, 0.002, 0.001];
/// Seconds between two predictions: each takes a moment.
const PREDICTION_S: f64 = 0.5;

impl From<ThreadError> for Halt {
    fn from(error: ThreadError) -> Self {
        Self::Failed(error.to_string())
    }
}

/// Looks ahead: how many samples an error takes.
struct Lookahead<'a> {
    pilot: Pilot<'a>,
    /// Samples a pixel for an error, once they are known.
    known: Option<(f64, u32)>,
    /// When the page was told last what is predicted.
    told: Option<Instant>,
}

/// How far the picture is.
struct Progress {
    canvas: Canvas,
    subject: Arc<Subject>,
    allocation: Option<Arc<SampleAllocation>>,
    /// Samples that every pixel has, in the mean.
    done: u32,
    /// Samples that the pass under way goes on to.
    reach: u32,
    /// Samples a pixel in a second.
    rate: f64,
    /// Seconds of passes.
    seconds: f64,
    is_shown: bool,
}

impl Progress {
    /// Nothing yet of a picture whose samples are spread so.
    fn new(
        paint: &Paint<'_>,
        rect: PixelRect,
        subject: &Arc<Subject>,
        allocation: Option<Arc<SampleAllocation>>,
    ) -> Self {
        Self {
            canvas: Canvas::new(paint.prepared, rect, Shard::WHOLE, allocation.as_deref()),
            subject: Arc::clone(subject),
            allocation,
            done: 0,
            reach: 0,
            rate: 0.0,
            seconds: 0.0,
            is_shown: true,
        }
    }
}

impl Paint<'_> {
    /// Renders the picture until it is good enough, and further where a page wants more.
    pub(crate) fn refine(&mut self, scene_sha256: &str) -> Result<(), Halt> {
        let film = &self.prepared.scene().film;
        let rect = whole([film.width, film.height]);
        let subject = Arc::new(Subject::new(self.prepared, scene_sha256, rect));
        self.live().overhead.reset();
        if self.stage == 1 {
            let live = Arc::clone(&self.painter.live);
            self.clock.pause(|| live.wait_for_page(FIRST_PAGE));
        }
        // Where pixels share paths, no pilot knows the error.
        let has_pilot = self.prepared.path_reuse().is_none();
        let mut progress = Progress::new(self, rect, &subject, None);
        let mut lookahead = None;
        if has_pilot {
            // An exploration takes as long as the first pass at least. So the first pass comes before it, and is thrown away if samples
            // are then spread otherwise.
            if self.live().wish().target.is_none_or(|target| target < PAYS_BELOW) {
                let goal = self.prepared.scene().integrator.replicates;
                while progress.done < goal && !self.live().wish().paused {
                    self.check()?;
                    self.pass(goal, &mut progress)?;
                }
            }
            let allocation = self.explore(rect)?;
            let pilot = Pilot::new(self.prepared, rect, allocation.clone(), Some(self.threads()))?;
            lookahead = Some(Lookahead { pilot, known: None, told: None });
            if allocation.is_some() {
                progress = Progress::new(self, rect, &subject, allocation);
            }
        }
        loop {
            self.check()?;
            let wish = self.live().wish();
            if wish.costs && progress.done > 0 {
                self.live().change(|wish| wish.costs = false);
                self.publish_if_new(&mut progress);
                self.measure_costs();
                continue;
            }
            let target = wish.target.unwrap_or(self.painter.error);
            let is_known = lookahead.as_ref().is_none_or(|l| l.known.is_some_and(|(error, _)| error == target));
            let is_turn = lookahead.as_ref().is_some_and(|l| self.is_turn_of(l, &progress));
            if let Some(lookahead) = lookahead.as_mut().filter(|_| !is_known && is_turn && !wish.paused) {
                self.look_ahead(lookahead, target, progress.done);
                continue;
            }
            let goal = self.goal(&wish, lookahead.as_ref(), &progress);
            if wish.paused || progress.done >= goal {
                self.rest(&wish, &mut progress);
                continue;
            }
            self.pass(goal, &mut progress)?;
        }
    }

    fn threads(&self) -> usize {
        self.painter.pool.current_num_threads()
    }

    /// Whether the pilot is to take a step: it and the passes take as long as each other, and the picture never has more samples than the
    /// pilot, which knows that these are not enough.
    fn is_turn_of(&self, lookahead: &Lookahead<'_>, progress: &Progress) -> bool {
        let seen = lookahead.pilot.points().last().map_or(0, |point| point.samples);
        progress.done > 0 && (lookahead.pilot.seconds() <= progress.seconds || progress.done >= seen)
    }

    /// Learns where samples are worth most; `None` where that gains little.
    fn explore(&self, rect: PixelRect) -> Result<Option<Arc<SampleAllocation>>, Halt> {
        if !Adaptivity::Auto.explores(self.prepared) {
            return Ok(None);
        }
        self.phase(Phase::Pilot);
        let target = self.live().wish().target.unwrap_or(self.painter.error);
        let goal = Goal { samples: Limits::ANY_SAMPLES, relative_rmse: Some(target) };
        let start = Instant::now();
        let enough = || !self.is_wanted() || start.elapsed().as_secs_f64() > EXPLORING_S;
        let exploration = explore(self.prepared, rect, &goal, Some(self.threads()), &enough, &|_| ())?;
        self.check()?;
        if exploration.gain < WORTHWHILE {
            return Ok(None);
        }
        self.live().show(|seen| seen.status.adaptive_gain = Some(exploration.gain));
        Ok(Some(exploration.allocation))
    }

    /// One step of the pilot.
    fn look_ahead(&self, lookahead: &mut Lookahead<'_>, target: f64, done: u32) {
        let clock = || self.clock.seconds();
        let samples = lookahead.pilot.step_toward(target, Limits::ANY_SAMPLES, &clock, &|_| ());
        if lookahead.pilot.found_no_light() {
            // The error is unknown, and so is what it costs.
            lookahead.known = Some((target, Limits::ANY_SAMPLES));
            let paths = lookahead.pilot.paths();
            self.live().show(|seen| {
                seen.status
                    .notes
                    .push(format!("No light was found in {paths} paths of a pilot, so the error is unknown."));
            });
            return;
        }
        lookahead.known = samples.map(|samples| (target, samples));
        let is_time = lookahead.told.is_none_or(|told| told.elapsed().as_secs_f64() > PREDICTION_S);
        if samples.is_some() || is_time {
            self.predict(&lookahead.pilot, lookahead.known, done);
            lookahead.told = Some(Instant::now());
        }
    }

    /// Tells the pages what the pilot foresees: when each error is reached, by samples at the pilot's rate and what was spent on anything
    /// but the `done` samples so far.
    fn predict(&self, pilot: &Pilot<'_>, known: Option<(f64, u32)>, done: u32) {
        let Some(&point) = pilot.points().last() else { return };
        let second_per_sample = point.seconds / f64::from(point.samples);
        let own = known.map(|(error, _)| error).filter(|error| !PREDICTED.contains(error));
        let mut errors: Vec<f64> = PREDICTED.into_iter().chain(own).collect();
        errors.sort_by(|a, b| b.total_cmp(a));
        let before = (self.clock.seconds() - f64::from(done) * second_per_sample).max(0.0);
        let of = |error: f64| {
            let mut estimate = pilot.cost_estimate(error);
            if let Some((_, samples)) = known.filter(|(known, _)| *known == error) {
                // What was chosen, not what a law through the pilot's points says.
                estimate.samples = f64::from(samples);
                estimate.seconds = estimate.samples * second_per_sample;
            }
            Predicted {
                relative_rmse: error,
                samples: estimate.samples,
                seconds: before + estimate.seconds,
                seconds_interval: estimate.seconds_interval.map(|seconds| before + seconds),
            }
        };
        let predicted = errors.into_iter().map(of).filter(|predicted| predicted.seconds.is_finite()).collect();
        self.live().show(|seen| seen.status.predicted = predicted);
    }

    /// Samples a pixel at which the picture is good enough, as far as that is known.
    fn goal(&self, wish: &Wish, lookahead: Option<&Lookahead<'_>>, progress: &Progress) -> u32 {
        let replicates = self.prepared.scene().integrator.replicates;
        let most = progress
            .allocation
            .as_ref()
            .map_or(Limits::ANY_SAMPLES, |allocation| allocation.largest_mean(Limits::ANY_SAMPLES, replicates));
        let known = wish.target.zip(lookahead.and_then(|lookahead| lookahead.known));
        let goal = known.filter(|(target, (error, _))| target == error).map(|(_, (_, samples))| samples.min(most));
        let is_new = self.live().seen().status.goal_samples != goal;
        if is_new {
            self.live().show(|seen| seen.status.goal_samples = goal);
        }
        let Some(lookahead) = lookahead else { return most };
        match (goal, wish.target, lookahead.pilot.points().last()) {
            (Some(goal), ..) => goal,
            (None, None, _) => most,
            // Not beyond what is known not to be enough.
            (None, Some(_), Some(point)) => point.samples.clamp(progress.done + replicates, most),
            (None, Some(_), None) => progress.done + replicates,
        }
    }

    /// Shows what there is and waits for another wish.
    fn rest(&mut self, wish: &Wish, progress: &mut Progress) {
        self.publish_if_new(progress);
        self.phase(if wish.paused { Phase::Paused } else { Phase::Done });
        let (stage, live) = (self.stage, Arc::clone(&self.painter.live));
        let is_same =
            |now: &Wish| now.stage == stage && !now.costs && (now.paused, now.target) == (wish.paused, wish.target);
        self.clock.pause(|| live.wait(is_same, Duration::from_secs(3600)));
    }

    /// One pass over the picture, or what is left of one that was interrupted.
    fn pass(&self, goal: u32, progress: &mut Progress) -> Result<(), Halt> {
        self.phase(Phase::Rendering);
        let replicates = self.prepared.scene().integrator.replicates;
        if progress.reach <= progress.done {
            let seconds = (0.1 * progress.seconds).clamp(PASS_S[0], PASS_S[1]);
            let affordable = (seconds * progress.rate) as u32;
            // Whole rounds of replicates, so that all weigh alike.
            let pass = (affordable.min(progress.done) / replicates * replicates).max(replicates);
            progress.reach = progress.done.saturating_add(pass).min(goal.max(progress.done + replicates));
        }
        let allocation = progress.allocation.clone();
        let reach = progress.reach;
        let target =
            |tile: PixelRect| allocation.as_ref().map_or(reach, |a| a.samples(tile.x0, tile.y0, reach, replicates));
        let start = Instant::now();
        let paths = |progress: &Progress| progress.canvas.with_film(|film| film.counters.paths);
        let before = paths(progress);
        progress.canvas.advance(self.prepared, &target, Some(self.threads()), &|_| {
            let wish = self.live().wish();
            if wish.stage == self.stage && !wish.paused { Control::Continue } else { Control::Stop }
        })?;
        let (seconds, after) = (start.elapsed().as_secs_f64(), paths(progress));
        progress.seconds += seconds;
        self.live().overhead.rendered(seconds, self.threads());
        let per_second = (after - before) as f64 / seconds;
        {
            let mut seen = self.live().seen();
            (seen.status.paths_per_second, seen.status.paths) = (per_second, after);
        }
        let film = &self.prepared.scene().film;
        progress.rate = per_second / (f64::from(film.width) * f64::from(film.height));
        if !progress.canvas.has_reached(&target) {
            return Ok(());
        }
        let is_first = progress.done == 0;
        progress.done = reach;
        progress.is_shown = false;
        // `rest` shows the last picture, before it tells the page that the render has ended.
        let is_last = self.live().seen().status.goal_samples.is_some_and(|goal| reach >= goal);
        if !is_last && (is_first || may_look(progress.seconds, self.live().overhead.seconds(), self.threads())) {
            self.publish(progress, false);
        }
        Ok(())
    }

    /// Shows what there is before it returns, if it is not shown yet.
    fn publish_if_new(&self, progress: &mut Progress) {
        if !progress.is_shown {
            self.publish(progress, true);
        }
    }

    /// Shows what there is, now or, where the render goes on, beside it.
    fn publish(&self, progress: &mut Progress, now: bool) {
        let film = film_of(&progress.canvas);
        let (subject, samples) = (Arc::clone(&progress.subject), progress.done);
        let shown = Shown { film, subject, samples, about: self.about() };
        progress.is_shown = if now {
            Publisher::show_now(self.live(), shown);
            true
        } else {
            self.painter.publisher.show(shown)
        };
    }

    /// Finds out what each effect costs.
    fn measure_costs(&mut self) {
        self.phase(Phase::Costs);
        let Some((scene, study, ..)) = self.painter.wished(&self.live().wish()) else { return };
        let threads = self.threads();
        let live = Arc::clone(&self.painter.live);
        let (stage, prepared) = (self.stage, self.prepared);
        live.show(|seen| seen.status.costs.clear());
        self.clock.pause(|| {
            let is_wanted = || live.wish().stage == stage;
            let tell = |cost| live.show(|seen| seen.status.costs.push(cost));
            costs::of_all(prepared, &scene, &study, threads, &is_wanted, &tell);
        });
    }
}
