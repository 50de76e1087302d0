//! The Monte Carlo integrator: a scene is [`prepare()`]d once, then [`Prepared::render`]ed.
//!
//! ```text
//! Scene ──prepare──▶ Prepared (with its Plan) ──render──▶ Film
//! ```
//!
//! A grey ball under an even sky of radiance 1 shows its reflectance, here 0.5, in every pixel:
//!
//! ```
//! use etalon_transport::{Control, prepare};
//!
//! let (scene, _) = etalon_scene::parse(r#"{
//!     "etalon": 1,
//!     "camera": { "type": "perspective", "position_m": [0, 0, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 20 },
//!     "film": { "width": 16, "height": 16 },
//!     "integrator": { "spp": 64 },
//!     "objects": [{ "shape": { "type": "sphere", "radius_m": 1 }, "material": { "type": "lambert", "reflectance": 0.5 } }],
//!     "lights": [{ "type": "environment", "radiance": 1 }]
//! }"#, "ball.json")?;
//! let prepared = prepare(&scene)?;
//! let film = prepared.render(&prepared.whole(None), &|_| Control::Continue)?;
//! let pixel = film.pixel(8, 8);
//! let ([variance], _) = pixel.variance(|xyz| [xyz[1]]).expect("more than one replicate");
//! // Five standard errors, and the rounding of the sums.
//! assert!((pixel.xyz()[1] - 0.5).abs() <= 5.0 * variance.sqrt() + 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The example `radiance` prints a grid of pixels with their errors. Programs that render use the crate `etalon`, which reads files, ends at
//! an error that is asked for, and writes pictures.
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
//! | [`accuracy`] | how wrong a film is |
//! | [`replay`] | one path, vertex by vertex |
//!
//! Each (pixel, sample) is a pure function of the scene and its seed: no order of tiles, number of threads or division
//! into stages can change a film.

pub mod accuracy;
mod batch;
pub mod bsdf;
mod bump_mapping;
pub mod camera;
mod caustics;
mod cells;
mod coincidence;
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
pub mod plan;
pub mod polarisation;
pub mod prepare;
mod prepare_error;
mod quadric_uv;
pub mod render;
pub mod replay;
mod reuse;
pub mod sampler;
mod shading_geometry;
mod shading_tables;
mod shapes;
pub mod spectral;
mod starting_media;
mod surface;
pub mod texture;
mod tracer;
mod trial;
pub mod tune;
pub mod wavelength;
mod wavelength_lanes;
mod world;

pub use accuracy::ImageError;
pub use etalon_geometry::warp;
pub use features::Features;
pub use film::{Band, Counters, Film, NonFinite, Pixel, PixelRect, TileSums};
pub use media::DEPTH as MOST_SOLIDS_AT_ONCE;
pub use plan::{Carried, Effect, EffectName, PathLoop, Plan, Study, StudyError};
pub use prepare::Prepared;
pub use prepare_error::PrepareError;
pub use render::{Control, Extent, ThreadError};
pub use tracer::PixelSamples;
pub use tune::{prepare, prepare_frame, prepare_study};
