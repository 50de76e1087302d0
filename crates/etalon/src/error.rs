//! Why there is no picture.

use etalon_control::SettleError;
use etalon_picture::PictureError;
use etalon_transport::ThreadError;

/// Why there is no picture, or no answer about it.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// A setting makes no sense.
    #[error("{0}")]
    Setting(String),
    /// The rectangle or the pixel is not in the picture.
    #[error("{what} reaches to column {} and row {} of a picture of {} × {} pixels", reach[0].saturating_sub(1), reach[1].saturating_sub(1), size[0], size[1])]
    Outside {
        /// Which rectangle or pixel.
        what: &'static str,
        /// One past its last column and row.
        reach: [u32; 2],
        /// Width and height of the picture, pixels.
        size: [u32; 2],
    },
    /// Where neighbouring pixels share paths, no path stands alone.
    #[error("{0} needs independent pixels, and path reuse makes neighbouring pixels share paths")]
    PathReuse(&'static str),
    /// The error of the picture is unknown, for no light was found.
    #[error("the pilot found no light in {paths} paths, so the error of the picture is unknown")]
    NoLight {
        /// Camera paths that the pilot traced.
        paths: u64,
    },
    /// Whoever watched wanted no more, and there is no answer yet.
    #[error("interrupted before there was an answer")]
    Interrupted,
    /// The threads cannot be started.
    #[error(transparent)]
    Threads(#[from] ThreadError),
    /// A file cannot be written.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

impl From<SettleError> for RenderError {
    fn from(error: SettleError) -> Self {
        match error {
            SettleError::Threads(error) => Self::Threads(error),
            SettleError::NoLight { paths } => Self::NoLight { paths },
        }
    }
}
