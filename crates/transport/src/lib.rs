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
//! | [`plan`] | which effects the scene calls for, and why |
//! | `scene` | shapes in world space, lights, the accelerator; what a path meets next |
//! | `surface` | what primitives are made of: normals, texture coordinates, emission |
//! | [`bsdf`], [`light`], [`camera`] | one material, one light, one camera model a piece |
//! | `media` | the media that a path is in, and absorption |
//! | [`wavelength`], [`spectral`], [`texture`] | hero wavelengths, spectra, and images as paths look them up |
//! | [`sampler`], [`warp`], [`mis`] | random numbers, directions made of them, weights |
//! | [`polarisation`] | the Stokes vector that a path carries |
//! | `guiding` | directions toward objects that cast caustics |
//! | `integrator` | the path loop and its steps; where samples begin, and how they enter the film; path reuse; one path, vertex by vertex |
//! | `batch` | the same steps for many paths at once: the same film, bit for bit |
//! | [`film`] | sums of samples; how wrong a film is |
//! | [`mod@render`] | the table of kernels; tiles over all cores; features of first hits; the trial before the picture |
//! | [`frame`] | centring and scaling |
//!
//! A module imports only from modules below it in this order: `render`, `batch`, `integrator`, `scene`, `guiding`, `surface`, then all others.
//!
//! Each (pixel, sample) is a pure function of the scene and its seed: no order of tiles, number of threads or division
//! into stages can change a film.

mod batch;
pub mod bsdf;
pub mod camera;
pub mod film;
pub mod frame;
mod guiding;
mod integrator;
pub mod light;
mod media;
pub mod mis;
pub mod plan;
pub mod polarisation;
pub mod render;
pub mod sampler;
mod scene;
pub mod spectral;
mod surface;
pub mod texture;
pub mod wavelength;

pub use etalon_geometry::warp;
pub use film::accuracy::{self, ImageError};
pub use film::{Band, Counters, Film, NonFinite, Pixel, PixelRect, Splats, TileSums};
pub use integrator::light_tracing::{LIGHT_RAY, LightPathsNoise};
pub use integrator::tracer::PixelSamples;
pub use integrator::{observer, replay};
pub use media::DEPTH as MOST_SOLIDS_AT_ONCE;
pub use plan::{Carried, Effect, EffectName, PathLoop, Plan, Study, StudyError};
pub use render::features::Features;
pub use render::tune::{prepare, prepare_frame, prepare_study};
pub use render::{Control, Extent, Piece, ThreadError};
pub use scene::prepare::Prepared;
pub use scene::prepare_error::PrepareError;
