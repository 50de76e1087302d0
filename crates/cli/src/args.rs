//! Values on the command line.

use std::str::FromStr;

use etalon_control::{Adaptivity, Shard};
use etalon_picture::develop::Rect;
use etalon_transport::PixelRect;
use serde::{Deserialize, Serialize};

/// Largest side of a picture, pixels.
const LARGEST_SIDE: u32 = 65_536;

/// Longest time, s: some thirty years, which every clock and timer can count.
const LONGEST_SECONDS: f64 = 1e9;

/// `WxH`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size {
    pub width: u32,
    pub height: u32,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let bad = || format!("a size is WIDTHxHEIGHT in pixels, each from 1 to {LARGEST_SIDE}, such as 640x480");
        let (width, height) = text.split_once(['x', 'X', '×']).ok_or_else(bad)?;
        let side = |text: &str| match text.trim().parse() {
            Ok(side @ 1..=LARGEST_SIDE) => Ok(side),
            _ => Err(bad()),
        };
        Ok(Self { width: side(width)?, height: side(height)? })
    }
}

/// `X,Y,W,H`, not empty: the part of a picture that is rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Crop(pub(crate) PixelRect);

impl FromStr for Crop {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Rect { x, y, width, height } = rect(text)?;
        let [x0, y0, x1, y1] = [x, y, x.saturating_add(width), y.saturating_add(height)]
            .map(|number| u32::try_from(number).unwrap_or(u32::MAX));
        Ok(Self(PixelRect { x0, y0, x1, y1 }))
    }
}

/// A hint for a rectangle `X,Y,W,H` that leaves a picture of this size: the same numbers may have been meant as `X0,X1,Y0,Y1`.
pub(crate) fn corners_hint([x0, x1, y0, y1]: [usize; 4], [width, height]: [usize; 2]) -> Option<String> {
    let fits = x0 < x1 && x1 <= width && y0 < y1 && y1 <= height;
    fits.then(|| {
        let (columns, rows) = (x1 - x0, y1 - y0);
        format!(
            "the order is X,Y,W,H: for columns {x0} to {} and rows {y0} to {} write {x0},{y0},{columns},{rows}",
            x1 - 1,
            y1 - 1
        )
    })
}

/// `X,Y`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PixelAt {
    pub x: u32,
    pub y: u32,
}

impl FromStr for PixelAt {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let [x, y] = numbers(text).ok_or("a pixel is X,Y, counted from 0 at the top left, such as 12,40")?;
        Ok(Self { x, y })
    }
}

/// `K/N`, K counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ShardArg(pub(crate) Shard);

impl FromStr for ShardArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.trim().parse::<u32>().ok();
        let numbers = text.split_once('/').and_then(|(k, n)| Some((number(k)?, number(n)?)));
        match numbers {
            Some((k, of)) if 1 <= k && k <= of => Ok(Self(Shard { index: k - 1, of })),
            _ => Err("a share is K/N with K from 1 to N, such as 3/16".to_owned()),
        }
    }
}

/// `FIRST:LAST:STEP` in nanometres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BandsArg(pub(crate) [f64; 3]);

impl FromStr for BandsArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Result<Vec<f64>, _> = text.split(':').map(|number| number.trim().parse()).collect();
        let numbers = numbers.ok().and_then(|numbers| numbers.try_into().ok());
        numbers.map(Self).ok_or_else(|| "bands are FIRST:LAST:STEP in nm (the centre of the first band, that of the last, and the step), such as 400:700:10".to_owned())
    }
}

/// `X,Y,W,H`: the first column and row, the columns and rows; not empty.
pub(crate) fn rect(text: &str) -> Result<Rect, String> {
    match numbers(text).map(|numbers: [u32; 4]| numbers.map(|number| number as usize)) {
        Some([x, y, width, height]) if width > 0 && height > 0 => Ok(Rect { x, y, width, height }),
        _ => {
            Err("a rectangle is X,Y,W,H in pixels: first column, first row, width, height, such as 10,20,64,48"
                .to_owned())
        }
    }
}

/// `X,Y`, a single pixel, or `X,Y,W,H`.
pub(crate) fn region(text: &str) -> Result<Rect, String> {
    match numbers(text).map(|numbers: [u32; 2]| numbers.map(|number| number as usize)) {
        Some([x, y]) => Ok(Rect { x, y, width: 1, height: 1 }),
        None => rect(text).map_err(|error| format!("a pixel is X,Y; {error}")),
    }
}

/// A number that is not infinite and not NaN.
pub(crate) fn finite(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err("the number must be finite".to_owned()),
        Err(error) => Err(error.to_string()),
    }
}

/// A number of samples: `64`, `1000` or `1e3`.
pub(crate) fn samples(text: &str) -> Result<u32, String> {
    const MOST: u32 = i32::MAX as u32;
    let bad = || format!("expected a whole number from 1 to {MOST}, such as 64 or 1e3");
    let number: f64 = text.trim().parse().map_err(|_| bad())?;
    if number.fract() == 0.0 && (1.0..=f64::from(MOST)).contains(&number) { Ok(number as u32) } else { Err(bad()) }
}

/// A share: `1%`, `1 %` or `0.01`.
pub(crate) fn percentage(text: &str) -> Result<f64, String> {
    let bad = || "expected a percentage or a fraction above 0, such as 1% or 0.01".to_owned();
    // A bare number from 1 on is more likely to have lost its per cent sign than to mean an error of all there is.
    let ambiguous = |number: f64| format!("{number} is {}%: write {number}% or {}", 100.0 * number, number / 100.0);
    let (number, unit) = match text.trim().strip_suffix('%') {
        Some(number) => (number.trim_end(), 0.01),
        None => (text.trim(), 1.0),
    };
    let share = unit * number.parse::<f64>().map_err(|_| bad())?;
    if !(share > 0.0 && share.is_finite()) {
        return Err(bad());
    }
    if unit == 1.0 && share >= 1.0 { Err(ambiguous(share)) } else { Ok(share) }
}

/// A time: `90`, `90s`, `1.5m`, `2h`, or several of these, `1h30m`. Seconds.
pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    let bad = || "expected a time such as 90s, 5m or 1h30m".to_owned();
    let mut total = 0.0;
    let mut rest = text.trim();
    if rest.is_empty() {
        return Err(bad());
    }
    while !rest.is_empty() {
        let end = rest.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(rest.len());
        let number: f64 = rest[..end].parse().map_err(|_| bad())?;
        rest = rest[end..].trim_start();
        let unit = match rest.chars().next() {
            None | Some('s') => 1.0,
            Some('m') => 60.0,
            Some('h') => 3600.0,
            Some(_) => return Err(bad()),
        };
        total += unit * number;
        rest = rest.get(1..).unwrap_or("").trim_start();
    }
    match total {
        _ if total > LONGEST_SECONDS => Err(format!("a time is at most {LONGEST_SECONDS:e} s")),
        _ if total > 0.0 => Ok(total),
        _ => Err(bad()),
    }
}

fn numbers<const N: usize>(text: &str) -> Option<[u32; N]> {
    let numbers: Result<Vec<u32>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    numbers.ok()?.try_into().ok()
}

/// When samples are spread by an exploration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Adaptive {
    /// Only with --error, and only if the exploration predicts a shorter render.
    Auto,
    /// In every render.
    Always,
    /// Every pixel takes the same number of samples.
    Never,
}

impl Adaptive {
    /// What it comes to where a relative error is asked for, or none: "auto" without one is "never".
    pub(crate) fn effective(self, error: Option<f64>) -> Self {
        if self == Self::Auto && error.is_none() { Self::Never } else { self }
    }

    /// The word of the command line.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Always => "always",
            Self::Never => "never",
        }
    }
}

impl From<Adaptive> for Adaptivity {
    fn from(adaptive: Adaptive) -> Self {
        match adaptive {
            Adaptive::Auto => Self::Auto,
            Adaptive::Always => Self::Always,
            Adaptive::Never => Self::Never,
        }
    }
}

/// A parameter and its value: `NAME=VALUE`.
pub(crate) fn parameter(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.is_empty() => Ok((name.to_owned(), value.to_owned())),
        _ => Err("expected NAME=VALUE, such as spp=64".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_crops_and_pixels_are_read_as_they_are_written() {
        assert_eq!("640x480".parse(), Ok(Size { width: 640, height: 480 }));
        assert_eq!("1X65536".parse(), Ok(Size { width: 1, height: 65_536 }));
        assert_eq!("1,2,3,4".parse(), Ok(Crop(PixelRect { x0: 1, x1: 4, y0: 2, y1: 6 })));
        let far = "4294967295,0,4294967295,1".parse();
        assert_eq!(far, Ok(Crop(PixelRect { x0: u32::MAX, x1: u32::MAX, y0: 0, y1: 1 })));
        assert_eq!("12, 40".parse(), Ok(PixelAt { x: 12, y: 40 }));
    }

    #[test]
    fn rectangles_and_regions_are_read_as_they_are_written() {
        let whole = Rect { x: 1, y: 2, width: 3, height: 4 };
        assert_eq!(rect("1,2,3, 4"), Ok(whole));
        assert_eq!(region("1,2,3,4"), Ok(whole));
        assert_eq!(region("1,2"), Ok(Rect { width: 1, height: 1, ..whole }));
        for text in ["", "1", "1,2,3", "1,2,0,4", "1,2,3,0", "-1,2,3,4", "1,2,3,4,5", "4294967296,0,1,1"] {
            assert!(rect(text).is_err() && region(text).is_err(), "{text}");
        }
    }

    #[test]
    fn corners_in_place_of_a_size_get_a_hint() {
        let hint = corners_hint([100, 200, 80, 180], [320, 200]).unwrap();
        assert!(hint.contains("columns 100 to 199") && hint.ends_with("100,80,100,100"), "{hint}");
        for numbers in [[100, 100, 0, 1], [0, 321, 0, 1], [0, 1, 2, 2], [0, 1, 0, 201]] {
            assert_eq!(corners_hint(numbers, [320, 200]), None, "{numbers:?}");
        }
    }

    #[test]
    fn shares_and_times_are_read_as_they_are_written() {
        for (text, share) in [("1%", 0.01), ("0.5 %", 0.005), ("0.02", 0.02), ("250%", 2.5)] {
            assert!((percentage(text).unwrap() - share).abs() < 1e-15, "{text}");
        }
        let two = percentage("2").unwrap_err();
        assert!(two.contains("2%") && two.contains("0.02"), "{two}");
        for text in ["", "1", "0%", "-1%", "nan%", "inf%", "x", "%"] {
            assert!(percentage(text).is_err(), "{text}");
        }
        for (text, expected) in [("90", 90.0), ("90s", 90.0), ("1.5m", 90.0), ("1h30m", 5400.0), ("2h 5s", 7205.0)] {
            assert_eq!(seconds(text), Ok(expected), "{text}");
        }
        assert_eq!(seconds("1000000000s"), Ok(1e9));
        for text in ["1000000001s", "20000000000000000000s", &format!("{}h", "9".repeat(400))] {
            assert!(seconds(text).unwrap_err().contains("at most"), "{text}");
        }
        for text in ["", "s", "0s", "1d", "-3s", "1m!", "5é"] {
            assert!(seconds(text).is_err(), "{text}");
        }
    }

    #[test]
    fn numbers_of_samples_may_have_an_exponent() {
        for (text, expected) in
            [("1", 1), ("1000", 1000), ("1e3", 1000), ("2.5e1", 25), ("2147483647", i32::MAX as u32)]
        {
            assert_eq!(samples(text), Ok(expected), "{text}");
        }
        for text in ["", "0", "-1", "1.5", "1e-1", "nan", "inf", "2147483648", "1e10", "x"] {
            assert!(samples(text).unwrap_err().contains("1e3"), "{text}");
        }
    }

    #[test]
    fn shares_count_from_one() {
        assert_eq!("3/16".parse(), Ok(ShardArg(Shard { index: 2, of: 16 })));
        assert_eq!("1/1".parse(), Ok(ShardArg(Shard::WHOLE)));
        for text in ["", "1", "0/4", "5/4", "1/0", "-1/4", "a/b", "1/2/3"] {
            assert!(text.parse::<ShardArg>().is_err(), "{text}");
        }
    }

    #[test]
    fn what_is_no_size_crop_or_pixel_is_refused() {
        for text in ["", "640", "0x480", "640x", "-1x5", "640x65537", "6x4x2", "4294967297x1"] {
            assert!(text.parse::<Size>().is_err(), "{text}");
        }
        for text in ["", "1,2,3", "1,2,3,4,5", "2,2,0,1", "0,1,3,0", "-1,2,1,1", "0.5,1,1,1"] {
            assert!(text.parse::<Crop>().is_err(), "{text}");
        }
        for text in ["", "1", "1,2,3", "a,b"] {
            assert!(text.parse::<PixelAt>().is_err(), "{text}");
        }
        for text in ["nan", "inf", "1e999", "x"] {
            assert!(finite(text).is_err(), "{text}");
        }
    }
}
