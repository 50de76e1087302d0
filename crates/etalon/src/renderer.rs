//! A scene that is ready, and the renders of it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use etalon_control::{
    Adaptivity, Canvas, Ended, Limits, Prediction, Reached, Settled, Shard, Watch, render_canvas, settle,
};
use etalon_transport::replay::Replay;
use etalon_transport::{Control, Counters, Film, ImageError, PixelRect, Plan, Prepared, TileSums};

use crate::channels::Channels;
use crate::error::RenderError;
use crate::picture::Render;
use crate::quote::{Quote, QuoteSettings};
use crate::subject::Subject;

/// A scene that is ready to be rendered: see [`Scene::prepare`](crate::Scene::prepare).
pub struct Renderer {
    prepared: Prepared,
    scene_sha256: String,
}

/// How a scene is rendered. The first limit that is reached ends the render.
///
/// ```
/// let settings = etalon::Settings { error: Some(0.01), seconds: Some(60.0), ..Default::default() };
/// assert_eq!(settings.samples, None);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    /// Most samples a pixel. Without it, and without an error and a time, it is the scene's own number.
    pub samples: Option<u32>,
    /// The relative error that is enough, for instance 0.01: the root mean square of the standard errors of luminance, over the
    /// mean luminance of the picture.
    pub error: Option<f64>,
    /// The time that is enough, seconds.
    pub seconds: Option<f64>,
    /// Whether regions with more error take more samples.
    pub adaptivity: Adaptivity,
    /// Threads; all cores if not given. The pixels are the same for any number.
    pub threads: Option<usize>,
    /// The pixels that are rendered; all if not given.
    pub crop: Option<PixelRect>,
    /// Which channels the EXR file has.
    pub channels: Channels,
}

/// How far a render is.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// The film so far.
    pub film: &'a Film,
    /// The pixels that are rendered.
    pub rect: PixelRect,
    /// Samples a pixel so far, in the mean.
    pub samples: u32,
    /// Seconds since the render began.
    pub seconds: f64,
}

impl Progress<'_> {
    /// The error of the picture so far; `None` where nothing is known of it.
    pub fn error(&self) -> Option<ImageError> {
        self.film.error(self.rect)
    }
}

impl std::fmt::Debug for Renderer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Renderer").field("scene_sha256", &self.scene_sha256).finish_non_exhaustive()
    }
}

impl Renderer {
    pub(crate) fn new(prepared: Prepared, scene_sha256: String) -> Self {
        Self { prepared, scene_sha256 }
    }

    /// The scene inside, for all that this type does not offer.
    pub fn prepared(&self) -> &Prepared {
        &self.prepared
    }

    /// Width and height of the picture, pixels.
    pub fn size(&self) -> [u32; 2] {
        let film = &self.prepared.scene().film;
        [film.width, film.height]
    }

    /// Which effects are simulated, and because of which object.
    pub fn plan(&self) -> &Plan {
        self.prepared.plan()
    }

    /// Names of all objects. The channel `ObjectId` counts from 1 for the first.
    pub fn object_names(&self) -> Vec<String> {
        self.prepared.object_names()
    }

    /// One path of a pixel, vertex by vertex; `sample` counts from 0.
    ///
    /// # Errors
    /// If the pixel is not in the picture, and if neighbouring pixels share paths.
    pub fn replay(&self, x: u32, y: u32, sample: u32) -> Result<Replay, RenderError> {
        self.check_inside("the pixel", [x.saturating_add(1), y.saturating_add(1)])?;
        if self.prepared.path_reuse().is_some() {
            return Err(RenderError::PathReuse("a replay"));
        }
        Ok(self.prepared.replay(x, y, sample))
    }

    /// What accuracy will cost in samples and seconds on this machine.
    ///
    /// # Errors
    /// If no light is found, if neighbouring pixels share paths, and if there are no threads.
    pub fn quote(&self, settings: &QuoteSettings) -> Result<Quote, RenderError> {
        self.quote_watched(settings, &|| Control::Continue)
    }

    /// As [`Renderer::quote`]; `control` is asked after each round of the pilot whether to go on.
    ///
    /// # Errors
    /// As [`Renderer::quote`], and [`RenderError::Interrupted`] where `control` ended it.
    pub fn quote_watched(
        &self,
        settings: &QuoteSettings,
        control: &(dyn Fn() -> Control + Sync),
    ) -> Result<Quote, RenderError> {
        let start = Instant::now();
        Quote::of_watched(&self.prepared, settings, &|| start.elapsed().as_secs_f64(), control)
    }

    /// Renders the scene.
    ///
    /// # Errors
    /// If a setting makes no sense, and if the error alone is to end the render and no light is found.
    pub fn render(&self, settings: &Settings) -> Result<Render, RenderError> {
        self.render_watched(settings, &())
    }

    /// Renders the scene, and calls `callback` after each pass over the picture. [`Control::Stop`] ends the render; the picture then
    /// has what was rendered so far.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    ///
    /// ```
    /// use etalon::{Control, Settings};
    /// use std::sync::atomic::{AtomicU32, Ordering};
    ///
    /// let renderer = etalon::Scene::load_sized("../../scenes/thin-lens.json", Some([32, 24]))?.prepare()?;
    /// let passes = AtomicU32::new(0);
    /// let render = renderer.render_with(&Settings { samples: Some(4096), ..Default::default() }, |progress| {
    ///     passes.fetch_add(1, Ordering::Relaxed);
    ///     if progress.samples >= 512 { Control::Stop } else { Control::Continue }
    /// })?;
    /// assert_eq!(render.reached(), etalon::Reached::Interrupted);
    /// assert!(render.samples() >= 512 && render.samples() < 4096 && passes.into_inner() > 0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn render_with(
        &self,
        settings: &Settings,
        callback: impl Fn(&Progress<'_>) -> Control + Sync,
    ) -> Result<Render, RenderError> {
        let rect = self.rect(settings)?;
        let watch = Callback { callback, rect, start: Instant::now(), stopped: AtomicBool::new(false) };
        self.render_watched(settings, &watch)
    }

    /// As [`Renderer::render`], with a watcher that is told of every piece of work and may end the render after it.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn render_watched(&self, settings: &Settings, watch: &dyn Watch) -> Result<Render, RenderError> {
        let job = self.job(settings)?;
        let settled = job.settle(watch)?;
        job.render(&settled, watch)
    }

    /// Renders the scene, and calls `callback` with the picture after each pass but the last; the last is what is returned.
    /// [`Control::Stop`] ends the render. The pictures on the way lack what the camera rays meet first ([`Render::features`]).
    ///
    /// # Errors
    /// As [`Renderer::render`].
    ///
    /// ```
    /// use etalon::{Control, Settings};
    /// use std::sync::Mutex;
    ///
    /// let renderer = etalon::Scene::load_sized("../../scenes/cornell.json", Some([16, 16]))?.prepare()?;
    /// let passes = Mutex::new(Vec::new());
    /// let settings = Settings { samples: Some(64), ..Default::default() };
    /// let last = renderer.render_passes(&settings, &(), |picture| {
    ///     passes.lock().unwrap().push((picture.samples(), picture.error().unwrap().relative_rmse));
    ///     Control::Continue
    /// })?;
    /// let passes = passes.into_inner().unwrap();
    /// assert!(passes.windows(2).all(|pair| pair[0].0 < pair[1].0), "{passes:?}");
    /// assert!(passes[0].0 < 64 && last.samples() == 64);
    /// assert_eq!(last.rgb_pixels(), renderer.render(&settings)?.rgb_pixels());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn render_passes(
        &self,
        settings: &Settings,
        watch: &dyn Watch,
        callback: impl Fn(Render) -> Control + Sync,
    ) -> Result<Render, RenderError> {
        let job = self.job(settings)?;
        let settled = job.settle(watch)?;
        let passes = Passes { job: &job, settled: &settled, watch, callback, stopped: AtomicBool::new(false) };
        job.render(&settled, &passes)
    }

    fn job<'a>(&'a self, settings: &'a Settings) -> Result<Job<'a>, RenderError> {
        let (rect, limits) = (self.rect(settings)?, self.limits(settings)?);
        Ok(Job { renderer: self, settings, rect, limits, start: Instant::now() })
    }

    /// The pixels that are rendered.
    fn rect(&self, settings: &Settings) -> Result<PixelRect, RenderError> {
        let [width, height] = self.size();
        let rect = settings.crop.unwrap_or(PixelRect { x0: 0, y0: 0, x1: width, y1: height });
        self.check_inside("the crop", [rect.x1, rect.y1])?;
        if rect.x0 >= rect.x1 || rect.y0 >= rect.y1 {
            return Err(RenderError::Setting("the crop has no pixels".to_owned()));
        }
        Ok(rect)
    }

    fn check_inside(&self, what: &'static str, reach: [u32; 2]) -> Result<(), RenderError> {
        let size = self.size();
        if reach[0] <= size[0] && reach[1] <= size[1] {
            return Ok(());
        }
        Err(RenderError::Outside { what, reach, size })
    }

    fn limits(&self, settings: &Settings) -> Result<Limits, RenderError> {
        let &Settings { samples, error, seconds, adaptivity, .. } = settings;
        for (name, value) in [("error", error), ("time", seconds)] {
            if let Some(value) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
                return Err(RenderError::Setting(format!("the {name} is {value}; it must be above 0 and finite")));
            }
        }
        if settings.threads == Some(0) {
            return Err(RenderError::Setting("a render needs one thread at least".to_owned()));
        }
        if self.prepared.path_reuse().is_some() && (error.is_some() || adaptivity == Adaptivity::Always) {
            return Err(RenderError::PathReuse("a render to an error"));
        }
        let otherwise = if error.is_some() || seconds.is_some() {
            Limits::ANY_SAMPLES
        } else {
            self.prepared.scene().integrator.spp
        };
        Ok(Limits { samples: samples.unwrap_or(otherwise), relative_rmse: error, seconds, adaptivity })
    }
}

/// A render that can begin.
struct Job<'a> {
    renderer: &'a Renderer,
    settings: &'a Settings,
    rect: PixelRect,
    limits: Limits,
    start: Instant,
}

impl Job<'_> {
    fn seconds(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// Settles how many samples the picture takes, and where.
    fn settle(&self, watch: &dyn Watch) -> Result<Settled, RenderError> {
        let clock = || self.seconds();
        Ok(settle(&self.renderer.prepared, self.rect, &self.limits, self.settings.threads, &clock, watch)?)
    }

    fn render(&self, settled: &Settled, watch: &dyn Watch) -> Result<Render, RenderError> {
        let (prepared, threads) = (&self.renderer.prepared, self.settings.threads);
        let canvas = Canvas::new(prepared, self.rect, Shard::WHOLE, settled.allocation.as_deref());
        let ended = render_canvas(prepared, &canvas, settled, &self.limits, threads, &|| self.seconds(), watch)?;
        let (mut tiles, mut features) = (Vec::new(), Vec::new());
        if self.settings.channels.has_features() {
            tiles = (0..canvas.tiles()).map(|number| canvas.tile(number).0.rect).collect();
            features = prepared.features(&tiles, ended.samples, threads)?;
        }
        Ok(Render { tiles, features, ..self.picture(canvas.into_film(), ended, settled) })
    }

    /// The picture of a film, without what the camera rays meet first.
    fn picture(&self, film: Film, ended: Ended, settled: &Settled) -> Render {
        let Renderer { prepared, scene_sha256 } = self.renderer;
        Render {
            film,
            subject: Subject::new(prepared, scene_sha256, self.rect),
            ended,
            settled: settled.clone(),
            channels: self.settings.channels.clone(),
            tiles: Vec::new(),
            features: Vec::new(),
            object_names: prepared.object_names(),
        }
    }
}

/// A watcher that calls a function with the picture after each pass but the last, and tells another of all else.
struct Passes<'a, F> {
    job: &'a Job<'a>,
    settled: &'a Settled,
    watch: &'a dyn Watch,
    callback: F,
    stopped: AtomicBool,
}

impl<F: Fn(Render) -> Control + Sync> Watch for Passes<'_, F> {
    fn work(&self, counters: &Counters) {
        self.watch.work(counters);
    }

    fn planned(&self, paths: u64, predicted: Option<&Prediction>) {
        self.watch.planned(paths, predicted);
    }

    fn tile(&self, rect: PixelRect, sums: &TileSums) {
        self.watch.tile(rect, sums);
    }

    fn pass(&self, film: &Film, samples: u32) {
        self.watch.pass(film, samples);
        if samples >= self.settled.samples {
            return;
        }
        let (seconds, predicted) = (self.job.seconds(), self.settled.predicted);
        let ended = Ended { samples, reached: Reached::Interrupted, seconds, predicted };
        if (self.callback)(self.job.picture(film.clone(), ended, self.settled)) == Control::Stop {
            self.stopped.store(true, Ordering::Relaxed);
        }
    }

    fn control(&self) -> Control {
        if self.stopped.load(Ordering::Relaxed) { Control::Stop } else { self.watch.control() }
    }
}

/// A watcher that calls a function after each pass.
struct Callback<F> {
    callback: F,
    rect: PixelRect,
    start: Instant,
    stopped: AtomicBool,
}

impl<F: Fn(&Progress<'_>) -> Control + Sync> Watch for Callback<F> {
    fn pass(&self, film: &Film, samples: u32) {
        let seconds = self.start.elapsed().as_secs_f64();
        if (self.callback)(&Progress { film, rect: self.rect, samples, seconds }) == Control::Stop {
            self.stopped.store(true, Ordering::Relaxed);
        }
    }

    fn control(&self) -> Control {
        if self.stopped.load(Ordering::Relaxed) { Control::Stop } else { Control::Continue }
    }
}
