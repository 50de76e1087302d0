//! Pictures: buffers of named channels, to and from EXR and PNG files, and how far apart two of them are.
//!
//! A [`Picture`] holds samples by channel name, row after row from the top, in `f32` or `f64`. EXR is the file that keeps the radiometric
//! truth: every channel and every attribute. A PNG is the picture that a screen shows, and making it says what was lost:
//!
//! ```
//! use etalon_picture::{Attributes, Picture, encode_srgb8, read_exr, write_exr, write_png};
//!
//! // Two pixels: a grey, and a red too bright for a screen.
//! let picture = Picture::from_rgb(2, 1, &[[0.5_f32; 3], [4.0, 0.1, 0.1]])?;
//! let folder = tempfile::tempdir()?;
//! write_exr(&folder.path().join("two.exr"), &picture, &Attributes::default())?;
//! assert_eq!(read_exr(&folder.path().join("two.exr"))?.picture.channel("R"), picture.channel("R"));
//!
//! let (shown, clipping) = encode_srgb8(&picture, 0.0)?;
//! write_png(&folder.path().join("two.png"), &shown, &[])?;
//! assert_eq!((clipping.above, clipping.of), (1, 2));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | for | see |
//! |---|---|
//! | channels of a picture, and where it lies in a larger frame | [`Picture`], [`Channel`], [`Window`] |
//! | EXR files, and how a render describes itself in them | [`write_exr`], [`read_exr`], [`Attributes`], [`RenderInfo`] |
//! | the picture that a screen shows | [`encode_srgb8`], [`write_png`], [`read_png`] |
//! | exposure, white balance, tone curves, crop and scale, false colour, maps of the error, spectra | [`develop`](mod@develop) |
//! | digital numbers of an image sensor: quantum efficiency, noise, saturation | [`expose`](mod@expose) |
//! | the distance of two pictures | [`compare`] (RMSE and relMSE), [`flip`](fn@flip) (what the eye sees) |
//! | files that appear whole or not at all | [`write_atomically`], [`check_writable`] |
//! | files that claim to be larger than they may be | [`check_exr_size`], [`open_plain`] |
//!
//! The example `distance` compares two pictures.
//!
//! Nothing here prints. Every error names the file and carries the cause as its source.

mod atomic;
mod attribute;
pub mod develop;
mod error;
mod error_info;
pub mod expose;
mod exr_header;
mod exr_read;
mod exr_size;
mod exr_write;
mod flip;
mod metrics;
mod picture;
mod plain_file;
mod png_file;
mod srgb;

pub use atomic::{check_writable, write_atomically};
pub use attribute::{Attribute, Attributes, Chromaticities, RenderInfo};
pub use error::PictureError;
pub use error_info::{ERROR_PREFIX, ErrorInfo};
pub use exr_read::{ExrFile, decode_exr, read_exr};
pub use exr_size::{MAX_PNG_METADATA_BYTES, check_exr_size, most_exr_bytes, most_image_bytes};
pub use exr_write::{encode_exr, write_exr};
pub use flip::{PIXELS_PER_DEGREE, flip};
pub use metrics::{Metrics, RELMSE_FLOOR, compare, rel_mse, rmse};
pub use picture::{Channel, Picture, Sample, Window};
pub use plain_file::{open_plain, read_plain};
pub use png_file::{Samples16, encode_png, read_png, read_png_text, read_png8, write_png, write_png16};
pub use srgb::{Clipping, Rgb8, decode_srgb, encode_srgb, encode_srgb8};
