//! What decides how many samples a picture takes and where, and when its render ends.
//!
//! `etalon-transport` traces the samples that it is asked for. This crate asks. How wrong a film is stands beside the film, in
//! [`etalon_transport::accuracy`]: it only reads the film's sums and decides nothing. Files of checkpoints are written by the program;
//! what they hold are the tiles of a [`Canvas`].
//!
//! | module | what it holds |
//! |---|---|
//! | [`mod@stop`] | limits of samples, error and time; the render that ends at the first of them |
//! | [`canvas`] | a picture under way: divided into tiles and shards, put down, taken up |
//! | [`pilot`] | a few pixels rendered before the picture, to know its error |
//! | [`cost_estimate`] | what a relative error costs, from what a pilot saw |
//! | [`adaptive`] | an exploration before the picture, to know where samples are worth most |
//! | [`sample_allocation`] | how samples are spread over regions |
//!
//! Nothing here looks at the samples of the picture to decide their number or their place: pilots and explorations have random
//! numbers of their own, and are thrown away. So the picture stays unbiased.
//!
//! ```
//! use etalon_control::{Adaptivity, Limits, Reached, render_within};
//!
//! // A grey ball under an even sky of radiance 1 shows 0.5 everywhere.
//! let (scene, _) = etalon_scene::parse(
//!     r#"{
//!         "etalon": 1,
//!         "camera": {"type": "perspective", "position_m": [0, 0, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 20},
//!         "film": {"width": 8, "height": 8},
//!         "materials": {"grey": {"type": "lambert", "reflectance": 0.5}},
//!         "objects": [{"shape": {"type": "sphere", "radius_m": 1}, "material": "grey"}],
//!         "lights": [{"type": "environment", "radiance": 1}]
//!     }"#,
//!     "ball.json",
//! )?;
//! let prepared = etalon_transport::prepare(&scene)?;
//! let rect = prepared.whole(None).rect;
//! let limits = Limits { samples: 1024, relative_rmse: Some(0.01), seconds: None, adaptivity: Adaptivity::Never };
//! let start = std::time::Instant::now();
//! let done = render_within(&prepared, rect, &limits, None, &|| start.elapsed().as_secs_f64(), &())?;
//! assert_eq!(done.reached, Reached::Error);
//! assert!((done.film.mean_y(rect) - 0.5).abs() < 0.005);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

/// SHA-256, in hex, of all that decides a film beside the scene: the sources of this crate and of those of ours that it uses, and the
/// locked versions of the other packages. It is the same on every platform.
pub const SOURCES_SHA256: &str = env!("ETALON_SOURCES_SHA256");

pub mod adaptive;
pub mod canvas;
pub mod cost_estimate;
pub mod pilot;
mod probe;
pub mod sample_allocation;
pub mod stop;

pub use adaptive::{Adaptivity, Exploration};
pub use canvas::{Canvas, Shard, Tile};
pub use cost_estimate::{CostEstimate, PilotPoint};
pub use pilot::Pilot;
pub use sample_allocation::SampleAllocation;
pub use stop::{
    Ended, Explored, Finished, Limits, Prediction, Reached, SettleError, Settled, Watch, render_canvas, render_within,
    settle,
};
