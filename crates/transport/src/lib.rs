//! The Monte Carlo integrator: a scene is [`prepare()`]d once, then [`Prepared::render`]ed.
//!
//! ```text
//! Scene ──prepare──▶ Prepared (with its Plan) ──render──▶ Film
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | [`prepare`](mod@prepare), [`tune`](mod@tune) | shapes in world space, lights, the accelerator; a trial before the picture |
//! | [`plan`] | which effects the scene calls for, and why |
//! | [`frame`] | centring and scaling |
//! | `integrator` | the path loop and its steps |
//! | `batch` | the same steps for many paths at once: the same film, bit for bit |
//! | `world`, `interaction`, `media`, [`polarisation`] | the scene as paths see it; what they meet; which medium they are in; the Stokes vector that they carry |
//! | `shading_geometry` | shading normals and texture coordinates |
//! | [`bsdf`], [`light`], [`camera`] | one material, one light, one camera model a piece |
//! | [`wavelength`], [`sampler`], [`warp`], [`mis`], [`filter`], [`spectral`], [`texture`] | what the estimates are made of |
//! | `kernel`, `tracer`, `wavelength_lanes`, [`mod@render`], [`film`] | the table of kernels, where samples begin, what their lanes stand for, tiles over all cores, sums |
//! | [`features`] | what camera rays meet first |
//! | [`canvas`] | a picture under way: divided, put down, taken up |
//! | [`accuracy`], [`pilot`], [`cost_estimate`], [`mod@stop`] | how wrong a film is, what accuracy will cost, when to end |
//! | [`adaptive`], [`sample_allocation`] | where samples are worth most, and how they are spread |
//! | [`replay`] | one path, vertex by vertex |
//!
//! Each (pixel, sample) is a pure function of the scene and its seed: no order of tiles, number of threads or division
//! into stages can change a film.

/// SHA-256, in hex, of all that decides a film beside the scene: the sources of this crate and of those of ours that it uses, and the
/// locked versions of the other packages. It is the same on every platform.
pub const SOURCES_SHA256: &str = env!("ETALON_SOURCES_SHA256");

mod absorption;
pub mod accuracy;
pub mod adaptive;
mod batch;
pub mod bsdf;
mod bump_mapping;
pub mod camera;
pub mod canvas;
mod caustics;
mod cells;
mod coincidence;
pub mod cost_estimate;
pub mod features;
pub mod film;
mod film_entry;
pub mod filter;
pub mod frame;
mod integrator;
mod interaction;
mod kernel;
pub mod light;
mod media;
pub mod mis;
mod motion;
pub mod observer;
pub mod pilot;
pub mod plan;
pub mod polarisation;
pub mod prepare;
mod prepare_error;
mod probe;
mod quadric_uv;
pub mod render;
pub mod replay;
mod reuse;
pub mod sample_allocation;
pub mod sampler;
mod shading_geometry;
mod shading_tables;
mod shapes;
pub mod spectral;
mod starting_media;
pub mod stop;
mod surface;
pub mod texture;
mod tracer;
mod trial;
pub mod tune;
pub mod warp;
pub mod wavelength;
mod wavelength_lanes;
mod world;

pub use accuracy::ImageError;
pub use adaptive::{Adaptivity, Exploration};
pub use canvas::{Canvas, Shard, Tile};
pub use cost_estimate::CostEstimate;
pub use features::Features;
pub use film::{Band, Counters, Film, NonFinite, Pixel, PixelRect, TileSums};
pub use media::DEPTH as MOST_SOLIDS_AT_ONCE;
pub use pilot::Pilot;
pub use plan::{Carried, Effect, EffectName, PathLoop, Plan, Study, StudyError};
pub use prepare::Prepared;
pub use prepare_error::PrepareError;
pub use render::{Control, Extent, ThreadError};
pub use sample_allocation::SampleAllocation;
pub use stop::{Ended, Explored, Finished, Limits, Prediction, Reached, SettleError, Settled, Watch};
pub use tune::{prepare, prepare_study};
