//! Scenes that are ready, and the renders of them.

use std::sync::mpsc::{SyncSender, sync_channel};
use std::sync::{Arc, Mutex};

use etalon::{
    Adaptivity, Aov, Channels, Control, PixelRect, QuoteSettings, Render, RenderError, RenderReport, Settings,
};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::background::{self, Inbox, Progress};
use crate::errors::{of_render, setting};
use crate::picture::Picture;

/// A scene that is ready to be rendered.
#[pyclass(frozen, module = "etalon._etalon")]
pub(crate) struct Renderer {
    renderer: Arc<etalon::Renderer>,
}

/// How a scene is rendered, from arguments of Python.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Wanted {
    samples: Option<u32>,
    error: Option<f64>,
    seconds: Option<f64>,
    adaptive: String,
    threads: Option<usize>,
    crop: Option<[u32; 4]>,
    channels: Vec<String>,
    only: bool,
}

fn adaptivity(py: Python<'_>, word: &str) -> PyResult<Adaptivity> {
    match word {
        "auto" => Ok(Adaptivity::Auto),
        "always" => Ok(Adaptivity::Always),
        "never" => Ok(Adaptivity::Never),
        other => Err(setting(py, format!("adaptive is {other:?}; it is \"auto\", \"always\" or \"never\""))),
    }
}

impl Wanted {
    fn settings(&self, py: Python<'_>) -> PyResult<Settings> {
        let channels: Vec<Aov> = self
            .channels
            .iter()
            .map(|name| {
                serde_json::from_value(Value::from(name.as_str())).map_err(|_| {
                    setting(py, format!(
                        "there are no channels {name:?}: color, error, variance, samples, bands, stokes, albedo, normal, \
                         position, depth, uv, object"
                    ))
                })
            })
            .collect::<PyResult<_>>()?;
        Ok(Settings {
            samples: self.samples,
            error: self.error,
            seconds: self.seconds,
            adaptivity: adaptivity(py, &self.adaptive)?,
            threads: self.threads,
            crop: self.crop.map(|[x0, x1, y0, y1]| PixelRect { x0, y0, x1, y1 }),
            channels: Channels::new(&channels, self.only),
        })
    }
}

/// A render that has ended, or a picture on the way: its channels and its report as JSON.
type Shown = (Picture, String);

fn shown(renderer: &etalon::Renderer, render: &Render) -> Result<Shown, RenderError> {
    let report = serde_json::to_string(&RenderReport::new(renderer, render)).expect("a report is plain data");
    Ok((Picture { file: render.exr()? }, report))
}

impl Renderer {
    pub(crate) fn new(renderer: etalon::Renderer) -> Self {
        Self { renderer: Arc::new(renderer) }
    }
}

#[pymethods]
impl Renderer {
    /// Renders the scene: the picture, its report as JSON, and whether it was interrupted. `tick` is called with the paths that are done
    /// and planned, the latter 0 during a pilot.
    #[pyo3(signature = (wanted, tick))]
    fn render(
        &self,
        py: Python<'_>,
        wanted: Wanted,
        tick: Option<Bound<'_, PyAny>>,
    ) -> PyResult<(Picture, String, bool)> {
        let (settings, progress) = (wanted.settings(py)?, Arc::new(Progress::default()));
        let (renderer, watch) = (Arc::clone(&self.renderer), Arc::clone(&progress));
        let work = move || {
            let render = renderer.render_watched(&settings, &*watch)?;
            Ok::<_, RenderError>((shown(&renderer, &render)?, render.has_samples()))
        };
        let outcome = background::run(py, &progress, tick.as_ref(), work)?;
        // Only a wish to stop keeps the picture; any other exception is for the caller.
        match outcome.interrupted {
            Some(error) if !error.is_instance_of::<PyKeyboardInterrupt>(py) => Err(error),
            Some(error) => match outcome.value {
                Ok(((picture, report), true)) => Ok((picture, report, true)),
                _ => Err(error),
            },
            None => {
                let ((picture, report), _) = outcome.value.map_err(|error| of_render(py, error))?;
                Ok((picture, report, false))
            }
        }
    }

    /// Renders the scene and gives the picture after each pass.
    fn passes(&self, py: Python<'_>, wanted: Wanted) -> PyResult<Passes> {
        let (settings, progress) = (wanted.settings(py)?, Arc::new(Progress::default()));
        let (renderer, watch) = (Arc::clone(&self.renderer), Arc::clone(&progress));
        // Without a buffer a pass waits until it is taken: who stops after one has paid for no other.
        let (sender, receiver) = sync_channel(0);
        let work = move || render_passes(&renderer, &settings, &watch, &sender);
        let ended = background::start(work)?;
        Ok(Passes { progress, pictures: Mutex::new(Some(receiver)), ended })
    }

    /// What accuracy costs, as JSON.
    #[pyo3(signature = (*, errors, pilot_seconds, adaptive, threads))]
    fn quote(
        &self,
        py: Python<'_>,
        errors: Vec<f64>,
        pilot_seconds: f64,
        adaptive: String,
        threads: Option<usize>,
    ) -> PyResult<String> {
        let settings = QuoteSettings { errors, pilot_seconds, adaptivity: adaptivity(py, &adaptive)?, threads };
        let progress = Arc::new(Progress::default());
        let (renderer, watch) = (Arc::clone(&self.renderer), Arc::clone(&progress));
        let work = move || renderer.quote_watched(&settings, &|| watch.control());
        let outcome = background::run(py, &progress, None, work)?;
        if let Some(error) = outcome.interrupted {
            return Err(error);
        }
        let quote = outcome.value.map_err(|error| of_render(py, error))?;
        let estimates: Vec<Value> = quote
            .estimates
            .iter()
            .map(|estimate| {
                json!({
                    "error": estimate.relative_rmse,
                    "samples": estimate.samples,
                    "samples_interval": estimate.samples_interval,
                    "seconds": estimate.seconds,
                    "seconds_interval": estimate.seconds_interval,
                })
            })
            .collect();
        let exploration = quote.exploration.map(|exploration| {
            json!({
                "predicted_gain": exploration.predicted_gain,
                "used": exploration.used,
                "seconds": exploration.seconds,
            })
        });
        Ok(json!({
            "estimates": estimates,
            "pilot_seconds": quote.pilot_seconds,
            "exploration": exploration,
            "settling_share": quote.settling_share,
        })
        .to_string())
    }

    /// Effects, kernel, sampler, depth, as JSON.
    fn plan(&self) -> String {
        serde_json::to_string(self.renderer.plan()).expect("a plan is plain data")
    }

    /// Names of all objects; the channel `ObjectId` counts from 1 for the first.
    fn object_names(&self) -> Vec<String> {
        self.renderer.object_names()
    }

    /// One path, vertex by vertex, as JSON.
    fn replay(&self, py: Python<'_>, x: u32, y: u32, sample: u32) -> PyResult<String> {
        let replay = py.detach(|| self.renderer.replay(x, y, sample)).map_err(|error| of_render(py, error))?;
        Ok(serde_json::to_string(&replay).expect("a replay is plain data"))
    }
}

/// Renders, and sends each picture. Whoever has dropped the receiver wants no more.
fn render_passes(
    renderer: &etalon::Renderer,
    settings: &Settings,
    watch: &Arc<Progress>,
    sender: &SyncSender<Result<Shown, RenderError>>,
) {
    let send = |picture| if sender.send(picture).is_ok() { Control::Continue } else { Control::Stop };
    let last = renderer.render_passes(settings, &**watch, |render| send(shown(renderer, &render)));
    // An end that nobody waited for is no picture.
    if watch.control() == Control::Continue {
        send(last.and_then(|render| shown(renderer, &render)));
    }
}

/// The pictures of a render, pass by pass.
#[pyclass(frozen, module = "etalon._etalon")]
pub(crate) struct Passes {
    progress: Arc<Progress>,
    pictures: Inbox<Result<Shown, RenderError>>,
    /// How the thread ended.
    ended: Inbox<PyResult<()>>,
}

#[pymethods]
impl Passes {
    fn __iter__(this: Bound<'_, Self>) -> Bound<'_, Self> {
        this
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<Shown>> {
        let next = match background::wait(py, &self.pictures, || Ok(())) {
            Ok(Some(Ok(shown))) => return Ok(Some(shown)),
            Ok(Some(Err(error))) => Err(of_render(py, error)),
            // There are no more. All is well, unless the thread ended by a panic.
            Ok(None) => background::wait(py, &self.ended, || Ok(())).and_then(|ended| ended.unwrap_or(Ok(()))),
            Err(error) => Err(error),
        };
        self.close();
        next.map(|()| None)
    }

    /// Ends the render.
    fn close(&self) {
        self.progress.stop();
        background::close(&self.pictures);
        background::close(&self.ended);
    }
}

impl Drop for Passes {
    fn drop(&mut self) {
        self.close();
    }
}
