//! Etalon is a physically based spectral path tracer. Its pictures carry their own error bars.
//!
//! ```text
//! Scene ──prepare──▶ Renderer ──quote──▶ Quote     what accuracy will cost
//!                            └──render─▶ Render    pixels, errors, bands, EXR and PNG files
//! ```
//!
//! A [`Scene`] is loaded from a file, imported from a model, or built in code. [`Scene::prepare`] makes a [`Renderer`]. It knows
//! the plan: which effects of light the scene calls for, and why. [`Renderer::render`] gives a [`Render`]: every pixel with its
//! standard error.
//!
//! This example has a known answer. A grey ball under an even sky of radiance 1 sends half of all light on, so it shows half of
//! the radiance of the sky, everywhere:
//!
//! ```
//! use etalon::{SceneBuilder, Settings, json};
//!
//! let mut scene = SceneBuilder::new()
//!     .camera(json!({ "type": "perspective", "position_m": [0, 0, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 20 }))
//!     .film(32, 32)
//!     .object(json!({ "shape": { "type": "sphere", "radius_m": 1 }, "material": { "type": "lambert", "reflectance": 0.5 } }))
//!     .light(json!({ "type": "environment", "radiance": 1 }))
//!     .build()?;
//! scene.keep_bands([450.0, 650.0, 100.0])?;
//! let render = scene.prepare()?.render(&Settings { samples: Some(64), ..Default::default() })?;
//!
//! for index in 0..render.bands_nm().len() {
//!     let band = render.band(16, 16, index).expect("the pixel is in the picture");
//!     // Five standard errors, and the rounding of the sums.
//!     assert!((band.radiance - 0.5).abs() <= 5.0 * band.error + 1e-6, "{band:?}");
//! }
//! let folder = tempfile::tempdir()?;
//! render.write_exr(folder.path().join("ball.exr"))?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | for | see |
//! |---|---|
//! | scenes from files, texts and models | [`Scene`] |
//! | scenes in code, part by part | [`SceneBuilder`]; the words are those of `docs/scene-format.md` |
//! | how long a render lasts: samples, error, time | [`Settings`] |
//! | what accuracy will cost | [`Renderer::quote`] |
//! | a render that calls back, or can be stopped | [`Renderer::render_with`], [`Renderer::render_watched`] |
//! | the picture after each pass | [`Renderer::render_passes`] |
//! | whether two pictures differ beyond their noise | [`compare()`] |
//! | what is said about a render, as JSON | [`RenderReport`] |
//! | colours, errors, bands, Stokes parameters, depth, normals | [`Render`] |
//! | irradiance, illuminance, flux, luminance at stated places | [`MeterReader`] |
//! | channels of EXR files | [`Channels`], [`Aov`] |
//! | one path, vertex by vertex | [`Renderer::replay`] |
//! | frames of a sequence | [`Frame`], `scene.model.set_shutter` |
//! | exposure, white balance, tone curves | [`picture_files::develop`] |
//! | digital numbers of an image sensor | [`SensorFile`], [`picture_files::expose`] |
//!
//! The same scene and seed give the same pixels for any number of threads and on any processor.

mod builder;
mod channels;
mod compare;
mod error;
mod film_file;
mod frame;
mod matrices;
mod measure;
mod picture;
mod quote;
mod renderer;
mod report;
mod scene;
mod sensor_file;
mod stokes;
mod subject;

pub use builder::SceneBuilder;
pub use channels::{Aov, Channels};
pub use compare::{
    COMPARE_POWER, ChannelTest, CompareSettings, Comparison, NoiseTest, NonFinitePixels, ScaleTest, Seen, TileTest,
    Verdict, compare,
};
pub use error::RenderError;
pub use etalon_control::{Adaptivity, CostEstimate, Ended, Prediction, Reached, Settled, Watch};
pub use etalon_import::{ImportError, LeftOut, Loss, Moment, Options as ImportOptions};
pub use etalon_optics as optics;
pub use etalon_picture as picture_files;
pub use etalon_scene as scene_model;
pub use etalon_scene::{LoadError, NamedFile, Problem, SceneErrors};
pub use etalon_transport::{
    Band, Control, Counters, Features, Film, ImageError, Pixel, PixelRect, Plan, PrepareError, Prepared, Study,
    TileSums, replay,
};
pub use film_file::FilmFile;
pub use frame::{Frame, FrameRate};
pub use measure::{
    METER_REPLICATES, MOST_METER_SAMPLES, MeasureSettings, Measured, Measurement, MeterError, MeterReader, Reading,
};
pub use picture::Render;
pub use quote::{Quote, QuoteSettings, QuotedExploration};
pub use renderer::{Progress, Renderer, Settings};
pub use report::{ErrorReport, NoisiestTile, PredictionReport, RenderReport, reached_name};
pub use scene::{Scene, SceneError};
pub use sensor_file::SensorFile;
pub use serde_json::json;
pub use subject::{KeptBands, Subject};
