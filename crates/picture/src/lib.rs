//! Pictures: buffers of named channels, to and from EXR and PNG, and how far apart two of them are.
//!
//! - [`Picture`] holds samples by channel name, row after row from the top, in `f32` or `f64`.
//! - [`write_exr`] and [`read_exr`] keep every channel and every attribute; [`RenderInfo`] is how a render describes
//!   itself. EXR is the file that keeps the radiometric truth.
//! - [`encode_srgb8`] and [`write_png`] make the picture that a screen shows, and say what was lost on the way.
//! - [`develop`](mod@develop) holds what stands between the two: exposure, white balance, tone curves, crop and scale, false colour, maps
//!   of the error, spectra.
//! - Files appear under their name whole or not at all ([`write_atomically`]), and [`check_writable`] finds out before
//!   an hour of rendering whether they can.
//! - [`compare`] measures RMSE and relMSE, [`flip`](fn@flip) what the eye sees.
//!
//! Nothing here prints. Every error names the file and carries the cause as its source.

mod atomic;
mod attribute;
pub mod develop;
mod error;
mod error_info;
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
pub use png_file::{encode_png, read_png, read_png_text, read_png8, write_png};
pub use srgb::{Clipping, Rgb8, decode_srgb, encode_srgb, encode_srgb8};
