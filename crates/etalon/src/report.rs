//! What is said about a render, as plain data for JSON.

use etalon_control::{Prediction, Reached};
use etalon_transport::accuracy::Region;
use etalon_transport::{Counters, ImageError, Plan};
use serde::Serialize;

use crate::picture::Render;
use crate::renderer::Renderer;

/// A render that has ended. In JSON, numbers that are unknown are `null`.
#[derive(Clone, Debug, Serialize)]
pub struct RenderReport<'a> {
    /// SHA-256 of the scene and of all files that it refers to.
    pub scene_sha256: &'a str,
    /// Width of the frame, pixels.
    pub width: u32,
    /// Height of the frame, pixels.
    pub height: u32,
    /// Columns x0 to x1, rows y0 to y1.
    pub crop: [u32; 4],
    /// Samples a pixel; their mean, where regions take different numbers.
    pub spp: u32,
    /// Seed of every random number.
    pub seed: u64,
    /// From the start of the exploration, the pilot, or the render without them.
    pub seconds: f64,
    /// What ended the render: see [`reached_name`].
    pub reached: &'static str,
    /// What the pilot predicted for the error asked for.
    pub predicted: Option<PredictionReport>,
    /// What was counted.
    #[serde(flatten)]
    pub counters: &'a Counters,
    /// `None` with a single replicate, of whose error nothing is known.
    pub error: Option<ErrorReport>,
    /// What the picture lacks that the scene calls for.
    pub approximations: Vec<String>,
    /// Effects, kernel, sampler, depth.
    pub plan: &'a Plan,
}

/// The error of a picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ErrorReport {
    /// Root mean square over all pixels of the standard error of Y, in units of the mean Y; `None` if no sample found light.
    pub relative_rmse: Option<f64>,
    /// `None` if that is unknown, or if too few samples found light.
    pub interval_95: Option<[f64; 2]>,
    /// Mean luminance of the picture.
    pub mean_y: f64,
    /// 95 % confidence interval of it; `None` where that of the error is unknown.
    pub mean_y_interval_95: Option<[f64; 2]>,
    /// Independent replicates of each pixel, whose scatter is the error.
    pub replicates: u32,
    /// 0: normal replicates, 1: each pixel's error is one outlier.
    pub tail_index: Option<f64>,
    /// Whether rare bright paths carry most of the error: then it is likely to be larger than stated.
    pub heavy_tailed: bool,
    /// The same, every noisy pixel counted alike.
    pub pixel_tail_index: Option<f64>,
    /// Whether the error bars of single pixels are too short.
    pub heavy_tailed_pixels: bool,
    /// `None` if the error is unknown.
    pub noisiest: Option<NoisiestTile>,
    /// Pixels of which nothing is known.
    pub unknown_pixels: u64,
}

/// The tile with the largest error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NoisiestTile {
    /// Columns x0 to x1, rows y0 to y1.
    pub crop: [u32; 4],
    /// Its error, in units of the mean luminance of the picture.
    pub relative_rmse: f64,
    /// Share of the squared error of the picture.
    pub share: f64,
}

/// What a pilot predicted: seconds of rendering, its own left out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PredictionReport {
    /// The error that was asked for.
    pub relative_rmse: f64,
    /// Not a number, as the seconds, if the pilot found no light.
    pub samples: f64,
    /// Of rendering.
    pub seconds: f64,
    /// Of the pilot.
    pub pilot_seconds: f64,
}

/// What ended a render, in a word: "samples", "error", "time" or "interrupted".
pub fn reached_name(reached: Reached) -> &'static str {
    match reached {
        Reached::Samples => "samples",
        Reached::Error => "error",
        Reached::Time => "time",
        Reached::Interrupted => "interrupted",
    }
}

impl ErrorReport {
    /// Of a picture with this many replicates.
    pub fn new(replicates: u32, error: &ImageError) -> Self {
        Self {
            relative_rmse: error.is_known().then_some(error.relative_rmse),
            interval_95: error.has_interval().then_some(error.interval),
            mean_y: error.mean_y,
            mean_y_interval_95: error.mean_y_interval,
            replicates,
            tail_index: error.tail_index,
            heavy_tailed: error.is_heavy_tailed(),
            pixel_tail_index: error.pixel_tail_index,
            heavy_tailed_pixels: error.has_heavy_tailed_pixels(),
            noisiest: error.noisiest.map(|Region { rect, relative_rmse, share }| NoisiestTile {
                crop: [rect.x0, rect.x1, rect.y0, rect.y1],
                relative_rmse,
                share,
            }),
            unknown_pixels: error.unknown_pixels,
        }
    }
}

impl PredictionReport {
    /// Of a prediction.
    pub fn new(predicted: &Prediction) -> Self {
        Self {
            relative_rmse: predicted.cost_estimate.relative_rmse,
            samples: predicted.cost_estimate.samples,
            seconds: predicted.cost_estimate.seconds,
            pilot_seconds: predicted.pilot_seconds,
        }
    }
}

impl<'a> RenderReport<'a> {
    /// Of a render of `renderer`.
    ///
    /// ```
    /// let renderer = etalon::Scene::load_sized("../../scenes/cornell.json", Some([16, 16]))?.prepare()?;
    /// let render = renderer.render(&etalon::Settings { samples: Some(4), ..Default::default() })?;
    /// let report = etalon::RenderReport::new(&renderer, &render);
    /// assert_eq!((report.spp, report.reached, report.counters.paths), (4, "samples", 4 * 16 * 16));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(renderer: &'a Renderer, render: &'a Render) -> Self {
        let (subject, rect) = (render.subject(), render.rect());
        Self {
            scene_sha256: &subject.scene_sha256,
            width: subject.size[0],
            height: subject.size[1],
            crop: [rect.x0, rect.x1, rect.y0, rect.y1],
            spp: render.samples(),
            seed: subject.seed,
            seconds: render.seconds(),
            reached: reached_name(render.reached()),
            predicted: render.predicted().as_ref().map(PredictionReport::new),
            counters: &render.film().counters,
            error: render.error().as_ref().map(|error| ErrorReport::new(subject.replicates, error)),
            approximations: subject.approximations(),
            plan: renderer.plan(),
        }
    }
}
