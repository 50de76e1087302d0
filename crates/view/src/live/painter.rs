//! The thread that prepares the scene and renders it, and begins again where a page wants something else.

use std::sync::Arc;
use std::time::{Duration, Instant};

use etalon::Subject;
use etalon_control::cost_estimate::{PilotPoint, cost_estimate};
use etalon_control::{Adaptivity, Canvas, Limits, SettleError, Settled, Shard, Watch, settle};
use etalon_transport::{Control, PrepareError, Prepared, Study, ThreadError, prepare_frame};

use super::coarse::{levels, trace};
use super::publish::{Publisher, Shown, may_look, put};
use super::status::{Phase, Predicted};
use super::{Live, Stage, Wish, costs};
use crate::camera::CameraView;
use crate::picture::{About, film_of, of_coarse, whole};
use crate::source::{LoadedScene, SceneSource};

/// How long the camera must rest before more than a coarse picture is rendered.
const AT_REST: Duration = Duration::from_millis(250);
/// Seconds that a pass over the picture takes, at least and at most.
const PASS_S: [f64; 2] = [0.25, 2.0];
/// Stated error from which on the finest coarse picture takes a small part of the time.
const PAYS_BELOW: f64 = 0.02;
/// Errors whose cost the page shows.
const PREDICTED: [f64; 12] = [0.5, 0.2, 0.1, 0.07, 0.05, 0.03, 0.02, 0.014, 0.01, 0.005, 0.002, 0.001];

/// What the painter works with.
pub(crate) struct Painter {
    pub live: Arc<Live>,
    pub source: SceneSource,
    pub scene: LoadedScene,
    pub publisher: Publisher,
    pub pool: rayon::ThreadPool,
}

/// A picture under way.
struct Picture<'a> {
    painter: &'a Painter,
    prepared: &'a Prepared,
    stage: u64,
    camera: CameraView,
    title: String,
    clock: Clock,
}

/// Seconds without pauses.
struct Clock {
    start: Instant,
    paused: Duration,
}

impl Clock {
    fn seconds(&self) -> f64 {
        (self.start.elapsed() - self.paused).as_secs_f64()
    }
}

impl Painter {
    /// Renders as long as the program runs.
    pub(crate) fn run(mut self) {
        loop {
            let wish = self.live.wish();
            if wish.reload {
                self.live.change(|wish| wish.reload = false);
                self.reload();
                continue;
            }
            if let Err(problem) = self.prepare(&wish) {
                let problem = serde_json::json!({ "message": problem });
                self.live.show(|seen| (seen.status.phase, seen.status.problems) = (Phase::Refused, vec![problem]));
            } else {
                self.paint(&wish);
            }
            // Until somebody wants another picture.
            self.live.wait(|now| now.stage == wish.stage && !now.reload, Duration::from_secs(3600));
        }
    }

    /// Reads the edited scene. One with errors is not taken: the one before stays.
    fn reload(&mut self) {
        match (self.source.load)() {
            Ok(scene) if scene.sha256 == self.scene.sha256 => {
                self.live.show(|seen| seen.status.problems.clear());
            }
            Ok(scene) => {
                self.scene = scene;
                self.live.show(|seen| seen.status.problems.clear());
                self.live.change(|wish| wish.stage += 1);
            }
            Err(problems) => self.live.show(|seen| seen.status.problems = problems),
        }
    }

    /// The scene as it is wished, and how it is to be studied.
    fn wished(&self, wish: &Wish) -> (etalon_scene::Scene, Study) {
        let mut scene = self.scene.scene.clone();
        if let Some(camera) = &wish.camera {
            camera.put_into(&mut scene.camera);
        }
        scene.integrator.seed = scene.integrator.seed.wrapping_add(wish.seed_offset);
        let mut study = self.source.study.clone();
        study.without.extend(wish.without.iter().filter(|name| !self.source.study.without.contains(name)));
        (scene, study)
    }

    /// Makes the scene ready. Where only the camera moved, nearly everything is taken over from before.
    fn prepare(&self, wish: &Wish) -> Result<(), String> {
        let live = &self.live;
        live.show(|seen| seen.status.phase = Phase::Preparing);
        let (scene, study) = self.wished(wish);
        let start = Instant::now();
        let mut place = live.stage.write().unwrap_or_else(std::sync::PoisonError::into_inner);
        let earlier = place.take().map(|stage| stage.prepared);
        let prepared = prepare_frame(&scene, &study, earlier).map_err(|error: PrepareError| error.to_string())?;
        let prepare_seconds = start.elapsed().as_secs_f64();
        live.show(|seen| {
            let status = &mut seen.status;
            let film = &prepared.scene().film;
            status.size = [film.width, film.height];
            status.stage = wish.stage;
            status.camera = Some(CameraView::of(&prepared.scene().camera));
            status.is_moved = wish.camera.is_some();
            status.without.clone_from(&wish.without);
            status.plan = serde_json::to_value(prepared.plan()).expect("a plan is plain data");
            status.replicates = prepared.scene().integrator.replicates;
            let bands = film.bands.as_ref().filter(|_| prepared.band_sums() > 0);
            status.bands_nm = bands.map_or_else(Vec::new, |bands| {
                (0..bands.count).map(|band| bands.first_nm + f64::from(band) * bands.step_nm).collect()
            });
            status.notes = prepared.warnings().iter().cloned().chain(self.scene.warnings.iter().cloned()).collect();
            status.threads = self.pool.current_num_threads();
            status.prepare_seconds = prepare_seconds;
            status.curve.clear();
            status.predicted.clear();
            (status.goal_samples, status.adaptive_gain) = (None, None);
            (status.samples, status.seconds, status.paths) = (0, 0.0, 0);
        });
        let scene_sha256 = self.scene.sha256.clone();
        *place = Some(Stage { number: wish.stage, prepared, scene, study, scene_sha256 });
        Ok(())
    }

    /// Renders the picture of a stage, from coarse to fine, until its error is reached and as long as nobody wants another one.
    fn paint(&self, wish: &Wish) {
        let stage = self.live.stage.read().unwrap_or_else(std::sync::PoisonError::into_inner);
        let Some(stage) = stage.as_ref() else { return };
        let mut picture = Picture {
            painter: self,
            prepared: &stage.prepared,
            stage: wish.stage,
            camera: CameraView::of(&stage.prepared.scene().camera),
            title: title(wish, &self.live.seen().status.name),
            clock: Clock { start: Instant::now(), paused: Duration::ZERO },
        };
        let sha256 = &stage.scene_sha256;
        let outcome = picture.coarse().and_then(|()| picture.refine(sha256));
        if let Err(Ended::Failed(message)) = outcome {
            let problem = serde_json::json!({ "message": message });
            self.live.show(|seen| (seen.status.phase, seen.status.problems) = (Phase::Refused, vec![problem]));
        }
    }
}

/// The number of samples for an error between those that are predicted, as a power of the error; `None` outside of them.
fn samples_for(predicted: &[Predicted], target: f64) -> Option<f64> {
    let pair = predicted.windows(2).find(|pair| pair[0].relative_rmse >= target && target >= pair[1].relative_rmse)?;
    let share = (pair[0].relative_rmse / target).ln() / (pair[0].relative_rmse / pair[1].relative_rmse).ln();
    Some(pair[0].samples * (pair[1].samples / pair[0].samples).powf(share))
}

/// What a picture shows, in words.
fn title(wish: &Wish, name: &str) -> String {
    let without: Vec<&str> = wish.without.iter().map(|effect| effect.as_str()).collect();
    match without.is_empty() {
        true => name.to_owned(),
        false => format!("{name} without {}", without.join(", ")),
    }
}

/// Why a picture goes no further.
enum Ended {
    /// Somebody wants another one.
    Unwanted,
    /// It cannot be rendered.
    Failed(String),
}

impl From<ThreadError> for Ended {
    fn from(error: ThreadError) -> Self {
        Self::Failed(error.to_string())
    }
}

/// Stops what goes on for a picture that nobody wants any more, and hears what a pilot sees.
struct Interest<'a> {
    picture: &'a Picture<'a>,
    points: std::sync::Mutex<Vec<PilotPoint>>,
}

impl Watch for Interest<'_> {
    fn pilot(&self, points: &[PilotPoint]) {
        *self.points.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = points.to_vec();
    }

    fn control(&self) -> Control {
        if self.picture.is_wanted() { Control::Continue } else { Control::Stop }
    }
}

impl Picture<'_> {
    fn live(&self) -> &Live {
        &self.painter.live
    }

    fn is_wanted(&self) -> bool {
        let wish = self.live().wish();
        wish.stage == self.stage && !wish.reload
    }

    fn check(&self) -> Result<(), Ended> {
        if self.is_wanted() { Ok(()) } else { Err(Ended::Unwanted) }
    }

    fn phase(&self, phase: Phase) {
        if self.live().seen().status.phase != phase {
            self.live().show(|seen| seen.status.phase = phase);
        }
    }

    fn about(&self) -> About {
        About {
            number: self.live().next_snapshot(),
            stage: self.stage,
            seconds: self.clock.seconds(),
            camera: self.camera.clone(),
            title: self.title.clone(),
        }
    }

    /// The first pictures. While the camera moves there are no others.
    fn coarse(&self) -> Result<(), Ended> {
        self.phase(Phase::Coarse);
        let film = &self.prepared.scene().film;
        // Pixels that share paths are not traced one by one.
        let all = if self.prepared.path_reuse().is_some() {
            Vec::new()
        } else {
            levels([film.width, film.height], self.prepared.scene().integrator.replicates)
        };
        for (index, level) in all.into_iter().enumerate() {
            let wish = self.live().wish();
            // The finest of them pays where the picture itself takes long.
            let is_enough = wish.moving || index == 3 && wish.target.is_some_and(|target| target > PAYS_BELOW);
            if index >= 2 && is_enough {
                break;
            }
            let stop = || !self.is_wanted();
            let coarse = trace(self.prepared, &self.painter.pool, level, &stop).ok_or(Ended::Unwanted)?;
            let snapshot = of_coarse(&coarse, self.about()).map_err(|error| Ended::Failed(error.to_string()))?;
            put(self.live(), snapshot);
        }
        if self.live().wish().moving {
            self.live().wait(|wish| wish.stage == self.stage && !wish.reload && wish.moving, AT_REST);
        }
        self.check()
    }

    /// The picture itself.
    fn refine(&mut self, scene_sha256: &str) -> Result<(), Ended> {
        let prepared = self.prepared;
        let film = &prepared.scene().film;
        let rect = whole([film.width, film.height]);
        let settled = self.settle()?;
        let replicates = prepared.scene().integrator.replicates;
        let subject = Arc::new(Subject::new(prepared, scene_sha256, rect));
        let canvas = Canvas::new(prepared, rect, Shard::WHOLE, settled.allocation.as_deref());
        let most = settled.allocation.as_ref().map_or(Limits::ANY_SAMPLES, |allocation| {
            allocation.largest_mean(Limits::ANY_SAMPLES, replicates)
        });
        let samples_of = |tile: etalon_transport::PixelRect, mean: u32| {
            settled.allocation.as_ref().map_or(mean, |a| a.samples(tile.x0, tile.y0, mean, replicates))
        };
        let (mut done, mut rate) = (0_u32, 0.0_f64);
        // A pass may have been put down in its middle, to be taken up later.
        let mut reach = 0_u32;
        let begun = self.clock.seconds();
        let looked = self.live().overhead.seconds();
        let mut is_shown = true;
        loop {
            self.check()?;
            let wish = self.live().wish();
            if wish.costs {
                self.live().change(|wish| wish.costs = false);
                self.measure_costs();
                continue;
            }
            let goal = self.goal(&wish, &settled).min(most);
            if wish.paused || done >= goal {
                if !is_shown {
                    self.publish(&canvas, &subject, done, true);
                    is_shown = true;
                }
                self.phase(if wish.paused { Phase::Paused } else { Phase::Done });
                let start = Instant::now();
                let same = |now: &Wish| {
                    now.stage == self.stage
                        && !now.reload
                        && !now.costs
                        && (now.paused, now.target) == (wish.paused, wish.target)
                };
                self.live().wait(same, Duration::from_secs(3600));
                self.clock.paused += start.elapsed();
                continue;
            }
            self.phase(Phase::Rendering);
            if reach <= done {
                let seconds = (0.1 * (self.clock.seconds() - begun)).clamp(PASS_S[0], PASS_S[1]);
                let affordable = if rate > 0.0 { (seconds * rate) as u32 } else { replicates };
                // Whole rounds of replicates, so that all weigh alike.
                let pass = affordable.min(done.max(replicates)) / replicates * replicates;
                reach = done.saturating_add(pass.max(replicates)).min(goal.next_multiple_of(replicates));
            }
            let start = Instant::now();
            let before = self.paths(&canvas);
            let target = |tile| samples_of(tile, reach);
            canvas.advance(prepared, &target, Some(self.painter.pool.current_num_threads()), &|_, _, _| {
                let wish = self.live().wish();
                let go_on = wish.stage == self.stage && !wish.reload && !wish.paused && !wish.costs;
                if go_on { Control::Continue } else { Control::Stop }
            })?;
            let (seconds, paths) = (start.elapsed().as_secs_f64(), self.paths(&canvas));
            let per_second = (paths - before) as f64 / seconds;
            self.live().seen().status.paths_per_second = per_second;
            self.live().seen().status.paths = paths;
            rate = per_second / rect.area() as f64;
            if !canvas.has_reached(&target) {
                continue;
            }
            let is_first = done == 0;
            done = reach;
            let looking = self.live().overhead.seconds() - looked;
            let threads = self.painter.pool.current_num_threads();
            is_shown = is_first || may_look(self.clock.seconds() - begun, looking, threads);
            if is_shown {
                self.publish(&canvas, &subject, done, false);
            }
        }
    }

    fn paths(&self, canvas: &Canvas) -> u64 {
        canvas.with_film(|film| film.counters.paths)
    }

    fn publish(&self, canvas: &Canvas, subject: &Arc<Subject>, samples: u32, last: bool) {
        let film = self.live().overhead.count(|| film_of(canvas));
        self.painter.publisher.show(Shown { film, subject: Arc::clone(subject), samples, about: self.about() }, last);
    }

    /// Samples a pixel at which the picture is good enough.
    fn goal(&self, wish: &Wish, settled: &Settled) -> u32 {
        let Some(target) = wish.target else { return Limits::ANY_SAMPLES };
        let settled_for = settled.predicted.map(|predicted| predicted.cost_estimate.relative_rmse);
        let goal = if settled_for == Some(target) {
            settled.samples
        } else {
            let samples = samples_for(&self.live().seen().status.predicted, target);
            samples.map_or(Limits::ANY_SAMPLES, |samples| samples.ceil().min(f64::from(Limits::ANY_SAMPLES)) as u32)
        };
        if self.live().seen().status.goal_samples != Some(goal) {
            self.live().show(|seen| (seen.status.goal_samples, seen.status.target) = (Some(goal), Some(target)));
        }
        goal
    }

    /// How the samples are spread, and how many of them the stated error takes: as `etalon render --error` settles it.
    fn settle(&self) -> Result<Settled, Ended> {
        let prepared = self.prepared;
        let film = &prepared.scene().film;
        let rect = whole([film.width, film.height]);
        let even = Settled {
            samples: Limits::ANY_SAMPLES,
            allocation: None,
            reached: etalon_control::Reached::Interrupted,
            predicted: None,
            explored: None,
        };
        if prepared.path_reuse().is_some() {
            return Ok(even);
        }
        self.phase(Phase::Pilot);
        let finest = self.live().wish().target.unwrap_or(self.painter.source.error);
        let limits = Limits {
            samples: Limits::ANY_SAMPLES,
            relative_rmse: Some(finest),
            seconds: None,
            adaptivity: Adaptivity::Auto,
        };
        let interest = Interest { picture: self, points: std::sync::Mutex::default() };
        let threads = Some(self.painter.pool.current_num_threads());
        let settled = settle(prepared, rect, &limits, threads, &|| self.clock.seconds(), &interest);
        self.check()?;
        let settled = match settled {
            Ok(settled) => settled,
            Err(SettleError::Threads(error)) => return Err(error.into()),
            Err(error @ SettleError::NoLight { .. }) => {
                self.live().show(|seen| seen.status.notes.push(error.to_string()));
                return Ok(even);
            }
        };
        let points = interest.points.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        self.predict(&points, &settled);
        Ok(settled)
    }

    /// Tells the pages what the pilot saw.
    fn predict(&self, points: &[PilotPoint], settled: &Settled) {
        let integrator = &self.prepared.scene().integrator;
        let before = self.clock.seconds();
        let own = settled.predicted.map(|predicted| predicted.cost_estimate);
        let mut predicted: Vec<Predicted> = PREDICTED
            .into_iter()
            .chain(own.map(|own| own.relative_rmse))
            .map(|target| {
                let estimate = match own {
                    Some(own) if own.relative_rmse == target => own,
                    _ => cost_estimate(points, target, integrator.sampler, integrator.replicates),
                };
                Predicted {
                    relative_rmse: target,
                    samples: estimate.samples,
                    seconds: before + estimate.seconds,
                    seconds_interval: estimate.seconds_interval.map(|seconds| before + seconds),
                }
            })
            .filter(|predicted| predicted.seconds.is_finite())
            .collect();
        predicted.sort_by(|a, b| b.relative_rmse.total_cmp(&a.relative_rmse));
        predicted.dedup_by(|a, b| a.relative_rmse == b.relative_rmse);
        let gain = settled.explored.as_ref().filter(|e| e.used).map(|e| e.exploration.gain);
        self.live().show(|seen| (seen.status.predicted, seen.status.adaptive_gain) = (predicted, gain));
    }

    /// Finds out what each effect costs.
    fn measure_costs(&self) {
        self.phase(Phase::Costs);
        let (scene, study) = self.painter.wished(&self.live().wish());
        let interest = || self.is_wanted();
        let threads = self.painter.pool.current_num_threads();
        self.live().show(|seen| seen.status.costs.clear());
        costs::of_all(self.prepared, &scene, &study, threads, &interest, &|cost| {
            self.live().show(|seen| seen.status.costs.push(cost));
        });
    }
}


#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_between_predictions_follow_a_power() {
        let predicted = |relative_rmse: f64| Predicted {
            relative_rmse,
            samples: 1.0 / (relative_rmse * relative_rmse),
            seconds: 1.0,
            seconds_interval: [1.0; 2],
        };
        let all = [0.1, 0.02, 0.01].map(predicted);
        for target in [0.1, 0.05, 0.02, 0.011, 0.01] {
            let samples = samples_for(&all, target).unwrap();
            assert!((samples * target * target - 1.0).abs() < 1e-9, "{target}: {samples}");
        }
        assert_eq!((samples_for(&all, 0.2), samples_for(&all, 0.001)), (None, None));
    }
}
