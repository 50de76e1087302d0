//! The thread that prepares the scene and renders it, and begins again where a page wants something else.

use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

use etalon_transport::{Prepared, Study, prepare_frame};

use super::coarse::{levels, trace};
use super::publish::{Publisher, put};
use super::status::Phase;
use super::{Live, Stage, Wish};
use crate::camera::{CameraView, world_up};
use crate::picture::{About, of_coarse};

/// How long the camera must rest before more than a coarse picture is rendered.
const AT_REST: Duration = Duration::from_millis(250);

/// What the painter works with.
pub(crate) struct Painter {
    pub live: Arc<Live>,
    /// What to simulate otherwise than the scene calls for.
    pub study: Study,
    /// The error that is looked ahead to where no page states one.
    pub error: f64,
    pub publisher: Publisher,
    pub pool: rayon::ThreadPool,
}

/// A picture under way.
pub(crate) struct Paint<'a> {
    pub painter: &'a Painter,
    pub prepared: &'a Prepared,
    pub stage: u64,
    pub clock: Clock,
    camera: CameraView,
    title: String,
}

/// Seconds without pauses.
pub(crate) struct Clock {
    start: Instant,
    paused: Duration,
}

impl Clock {
    pub(crate) fn seconds(&self) -> f64 {
        (self.start.elapsed() - self.paused).as_secs_f64()
    }

    /// Does something whose time does not count.
    pub(crate) fn pause<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let done = work();
        self.paused += start.elapsed();
        done
    }
}

/// Why a picture goes no further.
pub(crate) enum Halt {
    /// Somebody wants another one.
    Unwanted,
    /// It cannot be rendered.
    Failed(String),
}

impl Painter {
    /// Renders as long as the program runs.
    pub(crate) fn run(self) {
        loop {
            let wish = self.live.wish();
            let painted = match self.prepare(&wish) {
                Ok(()) => self.paint(&wish),
                Err(problem) => Err(Halt::Failed(problem)),
            };
            if let Err(Halt::Failed(message)) = painted {
                self.live.show(|seen| {
                    let status = &mut seen.status;
                    (status.phase, status.refusal) = (Phase::Refused, Some(message));
                    // The page shows what is wished, so that the wish can be taken back.
                    status.without.clone_from(&wish.without);
                });
            }
            // Until somebody wants another picture.
            self.live.wait(|now| now.stage == wish.stage, Duration::from_secs(3600));
        }
    }

    /// The scene as it is wished, and how it is to be studied; and its hash and warnings.
    pub(crate) fn wished(&self, wish: &Wish) -> Option<(etalon_scene::Scene, Study, String, Vec<String>)> {
        let loaded = self.live.scene.lock().unwrap_or_else(PoisonError::into_inner).clone()?;
        let mut scene = loaded.scene;
        if let Some(camera) = &wish.camera {
            camera.put_into(&mut scene.camera);
        }
        scene.integrator.seed = scene.integrator.seed.wrapping_add(wish.seed_offset);
        let mut study = self.study.clone();
        study.without.extend(wish.without.iter().filter(|name| !self.study.without.contains(name)));
        Some((scene, study, loaded.sha256, loaded.warnings))
    }

    /// What is up in the scene, wherever the page moved the camera.
    fn world_up(&self) -> Option<[f64; 3]> {
        let loaded = self.live.scene.lock().unwrap_or_else(PoisonError::into_inner);
        loaded.as_ref().map(|loaded| world_up(&loaded.scene.camera))
    }

    /// Makes the scene ready. Where only the camera moved, nearly everything is taken over from before.
    fn prepare(&self, wish: &Wish) -> Result<(), String> {
        let live = &self.live;
        live.show(|seen| seen.status.phase = Phase::Preparing);
        let (scene, study, scene_sha256, warnings) = self.wished(wish).ok_or("there is no scene")?;
        let world_up = self.world_up();
        let start = Instant::now();
        let mut place = live.stage.write().unwrap_or_else(PoisonError::into_inner);
        let earlier = place.take().map(|stage| stage.prepared);
        let prepared = prepare_frame(&scene, &study, earlier).map_err(|error| error.to_string())?;
        let prepare_seconds = start.elapsed().as_secs_f64();
        live.show(|seen| {
            let status = &mut seen.status;
            let film = &prepared.scene().film;
            status.size = [film.width, film.height];
            status.stage = wish.stage;
            status.camera = Some(CameraView::of(&prepared.scene().camera));
            status.is_moved = wish.camera.is_some();
            status.world_up = world_up;
            status.without.clone_from(&wish.without);
            status.plan = serde_json::to_value(prepared.plan()).expect("a plan is plain data");
            status.replicates = prepared.scene().integrator.replicates;
            let bands = film.bands.as_ref().filter(|_| prepared.band_sums() > 0);
            status.bands_nm = bands.map_or_else(Vec::new, |bands| {
                (0..bands.count).map(|band| bands.first_nm + f64::from(band) * bands.step_nm).collect()
            });
            status.notes = prepared.warnings().iter().cloned().chain(warnings).collect();
            status.threads = self.pool.current_num_threads();
            status.prepare_seconds = prepare_seconds;
            status.curve.clear();
            status.predicted.clear();
            status.refusal = None;
            // They were measured for another picture.
            status.costs.clear();
            (status.goal_samples, status.adaptive_gain) = (None, None);
            (status.samples, status.seconds, status.paths) = (0, 0.0, 0);
        });
        *place = Some(Stage { number: wish.stage, prepared, scene, study, scene_sha256 });
        Ok(())
    }

    /// Renders the picture of a stage, from coarse to fine, until its error is reached and as long as nobody wants another one.
    fn paint(&self, wish: &Wish) -> Result<(), Halt> {
        let stage = self.live.stage.read().unwrap_or_else(PoisonError::into_inner);
        let Some(stage) = stage.as_ref() else { return Ok(()) };
        let mut paint = Paint {
            painter: self,
            prepared: &stage.prepared,
            stage: wish.stage,
            camera: CameraView::of(&stage.prepared.scene().camera),
            title: title(wish, &self.live.seen().status.name),
            clock: Clock { start: Instant::now(), paused: Duration::ZERO },
        };
        paint.coarse()?;
        paint.refine(&stage.scene_sha256)
    }
}

/// What a picture shows, in words.
fn title(wish: &Wish, name: &str) -> String {
    let without: Vec<&str> = wish.without.iter().map(|effect| effect.as_str()).collect();
    match without.is_empty() {
        true => name.to_owned(),
        false => format!("{name} without {}", without.join(", ")),
    }
}

impl Paint<'_> {
    pub(crate) fn live(&self) -> &Live {
        &self.painter.live
    }

    pub(crate) fn is_wanted(&self) -> bool {
        self.live().wish().stage == self.stage
    }

    pub(crate) fn check(&self) -> Result<(), Halt> {
        if self.is_wanted() { Ok(()) } else { Err(Halt::Unwanted) }
    }

    pub(crate) fn phase(&self, phase: Phase) {
        let is_new = self.live().seen().status.phase != phase;
        if is_new {
            self.live().show(|seen| seen.status.phase = phase);
        }
    }

    /// What a snapshot of now says beside its pixels.
    pub(crate) fn about(&self) -> About {
        About {
            number: self.live().next_snapshot(),
            stage: self.stage,
            seconds: self.clock.seconds(),
            camera: self.camera.clone(),
            title: self.title.clone(),
        }
    }

    /// The first pictures. While the camera moves there are no others.
    fn coarse(&mut self) -> Result<(), Halt> {
        self.phase(Phase::Coarse);
        let film = &self.prepared.scene().film;
        // Pixels that share paths are not traced one by one.
        let all = if self.prepared.path_reuse().is_some() {
            Vec::new()
        } else {
            levels([film.width, film.height], self.prepared.scene().integrator.replicates)
        };
        for (index, level) in all.into_iter().enumerate() {
            if index >= 2 && self.live().wish().moving {
                break;
            }
            let stop = || !self.is_wanted();
            let coarse = trace(self.prepared, &self.painter.pool, level, &stop).ok_or(Halt::Unwanted)?;
            let snapshot = of_coarse(&coarse, self.about()).map_err(|error| Halt::Failed(error.to_string()))?;
            put(self.live(), snapshot);
        }
        if self.live().wish().moving {
            self.live().wait(|wish| wish.stage == self.stage && wish.moving, AT_REST);
        }
        self.check()
    }
}
