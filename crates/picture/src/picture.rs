//! A rectangle of pixels with named channels.

use crate::PictureError;

/// A sample type of a [`Picture`]: `f32` or `f64`.
pub trait Sample: Copy + Send + Sync + PartialEq + std::fmt::Debug + sealed::Sealed + 'static {
    /// The nearest `f32`; a finite `f64` beyond the range of `f32` becomes an infinity.
    fn to_f32(self) -> f32;
    /// The same number as an `f64`.
    fn to_f64(self) -> f64;
    /// The nearest number of this type.
    fn from_f64(value: f64) -> Self;
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

impl Sample for f32 {
    fn to_f32(self) -> f32 {
        self
    }

    fn to_f64(self) -> f64 {
        f64::from(self)
    }

    fn from_f64(value: f64) -> Self {
        value as Self
    }
}

impl Sample for f64 {
    fn to_f32(self) -> f32 {
        self as f32
    }

    fn to_f64(self) -> f64 {
        self
    }

    fn from_f64(value: f64) -> Self {
        value
    }
}

/// One named channel: a sample a pixel, row after row from the top, each row from the left.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel<T> {
    /// Its name, such as `R`, `Variance.R` or `S0.550,000000nm`.
    pub name: String,
    /// Its samples.
    pub samples: Vec<T>,
    /// Whether the file that it was read from has them as 16-bit floats, which round to eleven binary digits.
    pub half: bool,
}

/// Where a picture lies in the whole frame it was cut from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Column and row of the picture's top left pixel in the frame, pixels.
    pub origin_px: [i32; 2],
    /// Width and height of the frame, pixels.
    pub frame_px: [usize; 2],
}

/// A rectangle of pixels with named channels, all of the same size. Channel names are unique.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture<T = f32> {
    width: usize,
    height: usize,
    window: Window,
    channels: Vec<Channel<T>>,
}

impl<T: Sample> Picture<T> {
    /// A picture without channels yet, which is its own frame.
    ///
    /// # Errors
    /// A side that is 0 or beyond what file formats can count (2³¹ − 1).
    pub fn new(width: usize, height: usize) -> Result<Self, PictureError> {
        let countable = |side: usize| side > 0 && i32::try_from(side).is_ok();
        if !countable(width) || !countable(height) || width.checked_mul(height).is_none() {
            return Err(PictureError::BadSize { width, height });
        }
        let window = Window { origin_px: [0, 0], frame_px: [width, height] };
        Ok(Self { width, height, window, channels: Vec::new() })
    }

    /// A picture with channels `R`, `G`, `B` from interleaved pixels, row after row from the top.
    ///
    /// # Errors
    /// A bad size, or a number of pixels that is not `width * height`.
    pub fn from_rgb(width: usize, height: usize, pixels: &[[T; 3]]) -> Result<Self, PictureError> {
        let mut picture = Self::new(width, height)?;
        for (index, name) in ["R", "G", "B"].into_iter().enumerate() {
            picture.insert(name, pixels.iter().map(|pixel| pixel[index]).collect())?;
        }
        Ok(picture)
    }

    /// The same picture as a part of a larger frame: the EXR's data window inside its display window.
    ///
    /// # Errors
    /// A frame without pixels, or beyond what file formats can count.
    pub fn in_frame(mut self, window: Window) -> Result<Self, PictureError> {
        let [width, height] = window.frame_px;
        Self::new(width, height)?;
        self.window = window;
        Ok(self)
    }

    /// Adds a channel.
    ///
    /// # Errors
    /// A name that is taken, empty, longer than 255 bytes or holds a NUL (EXR cannot keep it); a wrong number of
    /// samples.
    pub fn insert(&mut self, name: &str, samples: Vec<T>) -> Result<(), PictureError> {
        let bad_name = |why| Err(PictureError::ChannelName { name: name.to_owned(), why });
        if name.is_empty() {
            return bad_name("is empty");
        }
        if name.len() > 255 {
            return bad_name("is longer than 255 bytes");
        }
        if name.contains('\0') {
            return bad_name("contains a NUL");
        }
        if self.channel(name).is_some() {
            return bad_name("appears twice");
        }
        if samples.len() != self.width * self.height {
            return Err(PictureError::ChannelLength {
                name: name.to_owned(),
                expected: self.width * self.height,
                found: samples.len(),
            });
        }
        self.channels.push(Channel { name: name.to_owned(), samples, half: false });
        Ok(())
    }

    /// States that a channel was read from 16-bit floats.
    pub(crate) fn mark_half(&mut self, name: &str) {
        self.channels.iter_mut().filter(|channel| channel.name == name).for_each(|channel| channel.half = true);
    }

    /// Whether a channel was read from 16-bit floats.
    #[must_use]
    pub fn is_half(&self, name: &str) -> bool {
        self.channels.iter().any(|channel| channel.name == name && channel.half)
    }

    /// Width, pixels.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height, pixels.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Where the picture lies in its frame.
    #[must_use]
    pub fn window(&self) -> Window {
        self.window
    }

    /// All channels, in the order in which they were added (a file that was read: by name).
    #[must_use]
    pub fn channels(&self) -> &[Channel<T>] {
        &self.channels
    }

    /// The samples of a channel, if it is there.
    #[must_use]
    pub fn channel(&self, name: &str) -> Option<&[T]> {
        self.channels.iter().find(|channel| channel.name == name).map(|channel| channel.samples.as_slice())
    }

    /// The samples of a channel that must be there.
    ///
    /// # Errors
    /// [`PictureError::MissingChannel`], which lists those that are there.
    pub fn require(&self, name: &str) -> Result<&[T], PictureError> {
        self.channel(name).ok_or_else(|| PictureError::MissingChannel {
            name: name.to_owned(),
            present: self.channels.iter().map(|channel| channel.name.as_str()).collect::<Vec<_>>().join(", "),
        })
    }
}
