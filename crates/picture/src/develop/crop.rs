//! A part of a picture.

use std::fmt;

use crate::{Picture, PictureError, Sample};

/// A rectangle of pixels, counted from 0 at a picture's top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rect {
    /// Its first column.
    pub x: usize,
    /// Its first row.
    pub y: usize,
    /// Columns; at least 1.
    pub width: usize,
    /// Rows; at least 1.
    pub height: usize,
}

impl fmt::Display for Rect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{},{},{}", self.x, self.y, self.width, self.height)
    }
}

impl Rect {
    /// Refuses a rectangle that is not within a picture of this size.
    ///
    /// # Errors
    /// A rectangle without pixels, or that reaches beyond the picture.
    ///
    /// ```
    /// use etalon_picture::develop::Rect;
    ///
    /// let rect = Rect { x: 2, y: 0, width: 3, height: 1 };
    /// assert!(rect.check_within(5, 1).is_ok());
    /// assert!(rect.check_within(4, 1).is_err());
    /// ```
    pub fn check_within(self, width: usize, height: usize) -> Result<(), PictureError> {
        let inside = |start: usize, length: usize, side: usize| {
            length > 0 && start.checked_add(length).is_some_and(|end| end <= side)
        };
        if inside(self.x, self.width, width) && inside(self.y, self.height, height) {
            return Ok(());
        }
        Err(PictureError::develop(format!(
            "the rectangle {self} (X,Y,W,H) is not within the picture of {width} × {height} pixels"
        )))
    }

    /// The indices of its pixels in a picture of this width.
    pub(crate) fn indices(self, picture_width: usize) -> impl Iterator<Item = usize> {
        let Self { x, y, width, height } = self;
        (y..y + height).flat_map(move |row| row * picture_width + x..row * picture_width + x + width)
    }
}

/// The pixels of a rectangle, of all channels. The result is a frame of its own.
///
/// # Errors
/// A rectangle that is not within the picture.
///
/// ```
/// use etalon_picture::Picture;
/// use etalon_picture::develop::{Rect, crop};
///
/// let mut picture = Picture::new(3, 2)?;
/// picture.insert("Y", vec![0.0_f32, 1.0, 2.0, 3.0, 4.0, 5.0])?;
/// let part = crop(&picture, Rect { x: 1, y: 0, width: 2, height: 2 })?;
/// assert_eq!(part.require("Y")?, [1.0, 2.0, 4.0, 5.0]);
/// # Ok::<(), etalon_picture::PictureError>(())
/// ```
pub fn crop<T: Sample>(picture: &Picture<T>, rect: Rect) -> Result<Picture<T>, PictureError> {
    rect.check_within(picture.width(), picture.height())?;
    let mut part = Picture::new(rect.width, rect.height)?;
    for channel in picture.channels() {
        let samples = rect.indices(picture.width()).map(|i| channel.samples[i]).collect();
        part.insert(&channel.name, samples)?;
    }
    Ok(part)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_outside_are_refused_whatever_their_numbers() {
        let whole = Rect { x: 0, y: 0, width: 7, height: 5 };
        assert!(whole.check_within(7, 5).is_ok());
        for rect in [
            Rect { width: 8, ..whole },
            Rect { height: 6, ..whole },
            Rect { x: 1, ..whole },
            Rect { y: 1, ..whole },
            Rect { width: 0, ..whole },
            Rect { height: 0, ..whole },
            Rect { x: usize::MAX, ..whole },
            Rect { x: 1, width: usize::MAX, ..whole },
        ] {
            let error = rect.check_within(7, 5).unwrap_err().to_string();
            assert!(error.contains("7 × 5"), "{error}");
        }
    }

    #[test]
    fn four_quarters_hold_every_pixel_once() {
        let mut picture = Picture::new(7, 5).unwrap();
        picture.insert("Y", (0..35).map(f64::from).collect()).unwrap();
        let mut seen: Vec<f64> = Vec::new();
        for (x, width) in [(0, 3), (3, 4)] {
            for (y, height) in [(0, 2), (2, 3)] {
                seen.extend(crop(&picture, Rect { x, y, width, height }).unwrap().require("Y").unwrap());
            }
        }
        seen.sort_by(f64::total_cmp);
        assert_eq!(seen, (0..35).map(f64::from).collect::<Vec<_>>());
    }
}
