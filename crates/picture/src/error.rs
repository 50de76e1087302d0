//! What can go wrong with pictures and their files.

use std::path::{Path, PathBuf};

/// An error of a picture or of its file. The underlying cause, where there is one, is the error's source.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The operating system refused.
    #[error("cannot {action} `{}`", path.display())]
    Io {
        /// What was tried, as in "cannot … the file".
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// Why not.
        source: std::io::Error,
    },
    /// The folder of an output file does not exist.
    #[error("cannot write `{}`: its folder `{}` does not exist", path.display(), folder.display())]
    NoFolder {
        /// The output.
        path: PathBuf,
        /// The folder it would lie in.
        folder: PathBuf,
    },
    /// The output's name is that of a folder, or names no file at all.
    #[error("cannot write `{}`: it names a folder, not a file", path.display())]
    IsFolder {
        /// The output.
        path: PathBuf,
    },
    /// An EXR file that cannot be read or made.
    #[error("cannot {action} the EXR file `{}`", path.display())]
    Exr {
        /// "read" or "write".
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// Why not.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// A PNG file that cannot be read or made.
    #[error("cannot {action} the PNG file `{}`", path.display())]
    Png {
        /// "read" or "write".
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// Why not.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// A PNG file whose samples would not survive as 8-bit RGB.
    #[error("the PNG file `{}` is not opaque 8-bit RGB: {found}", path.display())]
    NotRgb8 {
        /// The file.
        path: PathBuf,
        /// What it is instead.
        found: String,
    },
    /// A picture without pixels, or with more than the file formats can count.
    #[error("a picture cannot have {width} × {height} pixels")]
    BadSize {
        /// Width, pixels.
        width: usize,
        /// Height, pixels.
        height: usize,
    },
    /// A channel with more or fewer samples than the picture has pixels.
    #[error("channel `{name}` has {found} samples where the picture has {expected} pixels")]
    ChannelLength {
        /// The channel.
        name: String,
        /// Pixels of the picture.
        expected: usize,
        /// Samples of the channel.
        found: usize,
    },
    /// A channel name that is taken, empty, or impossible in an EXR file.
    #[error("channel name `{name}` {why}")]
    ChannelName {
        /// The name.
        name: String,
        /// What is wrong with it.
        why: &'static str,
    },
    /// A channel that is needed and not there.
    #[error("there is no channel `{name}`; the channels are {present}")]
    MissingChannel {
        /// The channel.
        name: String,
        /// Those that are there, separated by commas.
        present: String,
    },
    /// An attribute that an EXR file cannot hold under this name.
    #[error("EXR attribute `{name}` {why}")]
    BadAttribute {
        /// The attribute.
        name: String,
        /// What is wrong with it.
        why: &'static str,
    },
    /// A picture that cannot be developed as it was asked for.
    #[error("{why}")]
    Develop {
        /// What it lacks, as a sentence.
        why: String,
    },
    /// A picture that cannot be exposed on a sensor.
    #[error("{why}")]
    Expose {
        /// What it or the sensor lacks, as a sentence.
        why: String,
    },
    /// Two pictures that cannot be compared pixel by pixel.
    #[error("pictures of {} × {} and {} × {} pixels cannot be compared", image.0, image.1, reference.0, reference.1)]
    SizeMismatch {
        /// Width and height of the first.
        image: (usize, usize),
        /// Width and height of the other.
        reference: (usize, usize),
    },
}

impl PictureError {
    pub(crate) fn develop(why: impl Into<String>) -> Self {
        Self::Develop { why: why.into() }
    }

    pub(crate) fn expose(why: impl Into<String>) -> Self {
        Self::Expose { why: why.into() }
    }

    pub(crate) fn io(action: &'static str, path: &Path, source: std::io::Error) -> Self {
        Self::Io { action, path: path.to_owned(), source }
    }

    pub(crate) fn exr(action: &'static str, path: &Path, source: exr::error::Error) -> Self {
        match source {
            exr::error::Error::Io(source) => Self::io(action, path, source),
            source => Self::Exr { action, path: path.to_owned(), source: Box::new(source) },
        }
    }

    /// The whole chain of causes in one line, for machines and logs.
    #[must_use]
    pub fn with_causes(&self) -> String {
        let mut text = self.to_string();
        let mut cause = std::error::Error::source(self);
        while let Some(error) = cause {
            text.push_str(": ");
            text.push_str(&error.to_string());
            cause = error.source();
        }
        text
    }
}
