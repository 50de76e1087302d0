//! A scene that is ready, and the renders of it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use etalon_control::{Adaptivity, Canvas, Ended, Limits, Shard, Watch, render_canvas, settle};
use etalon_transport::replay::Replay;
use etalon_transport::{Control, Film, ImageError, PixelRect, Plan, Prepared};

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
        let start = Instant::now();
        Quote::of(&self.prepared, settings, &|| start.elapsed().as_secs_f64())
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
        let rect = self.rect(settings)?;
        let limits = self.limits(settings)?;
        let start = Instant::now();
        let clock = || start.elapsed().as_secs_f64();
        let (prepared, threads) = (&self.prepared, settings.threads);
        let settled = settle(prepared, rect, &limits, threads, &clock, watch)?;
        let canvas = Canvas::new(prepared, rect, Shard::WHOLE, settled.allocation.as_deref());
        let ended @ Ended { samples, .. } =
            render_canvas(prepared, &canvas, &settled, &limits, threads, &clock, watch)?;
        let (mut tiles, mut features) = (Vec::new(), Vec::new());
        if settings.channels.has_features() {
            tiles = (0..canvas.tiles()).map(|number| canvas.tile(number).0.rect).collect();
            features = prepared.features(&tiles, samples, threads)?;
        }
        Ok(Render {
            subject: Subject::new(prepared, &self.scene_sha256, rect),
            film: canvas.into_film(),
            ended,
            settled,
            channels: settings.channels.clone(),
            tiles,
            features,
            object_names: prepared.object_names(),
        })
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
