//! Frames of a sequence, and when they are.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// A frame of a sequence: its number, and how many there are in a second.
///
/// ```
/// let frame = etalon::Frame { number: 36, rate: "24".parse()? };
/// assert_eq!(frame.opens_s(), 1.5);
/// // The shutter of the scene opens at once and is open for a fiftieth of a second.
/// assert_eq!(frame.shutter_s([0.0, 0.02]), [1.5, 1.52]);
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Frame {
    /// Its number, from 0.
    pub number: u32,
    /// Frames a second.
    pub rate: FrameRate,
}

impl Frame {
    /// When it begins, s: its number over the rate, rounded once.
    pub fn opens_s(&self) -> f64 {
        let FrameRate([frames, seconds]) = self.rate;
        // The product of two 32-bit numbers may round, but not for any number of frames that will ever be rendered.
        f64::from(self.number) * f64::from(seconds) / f64::from(frames)
    }

    /// When the shutter opens and closes in this frame, s, if it does so at `first_s` in frame 0.
    pub fn shutter_s(&self, first_s: [f64; 2]) -> [f64; 2] {
        first_s.map(|time_s| self.opens_s() + time_s)
    }

    /// The seed of this frame: that of the sequence and its number, modulo 2⁶⁴.
    pub fn seed(&self, of_sequence: u64) -> u64 {
        of_sequence.wrapping_add(u64::from(self.number))
    }
}

/// Frames a second, as a fraction: a number of frames in a number of seconds. `24`, `23.976` and `24000/1001` are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FrameRate(
    /// Frames, and seconds; neither is 0.
    pub [u32; 2],
);

/// The rate of cinema.
impl Default for FrameRate {
    fn default() -> Self {
        Self([24, 1])
    }
}

impl fmt::Display for FrameRate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            [frames, 1] => write!(f, "{frames}"),
            [frames, seconds] => write!(f, "{frames}/{seconds}"),
        }
    }
}

impl FromStr for FrameRate {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let bad = || "a rate is a number of frames a second above 0, such as 24, 23.976 or 24000/1001".to_owned();
        let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
        let whole = |text: &str| if digits(text) { text.parse::<u32>().map_err(|_| bad()) } else { Err(bad()) };
        let text = text.trim();
        let [frames, seconds] = if let Some((frames, seconds)) = text.split_once('/') {
            [whole(frames)?, whole(seconds)?]
        } else if let Some((units, decimals)) = text.split_once('.') {
            if !digits(units) || !digits(decimals) {
                return Err(bad());
            }
            let seconds = 10_u32.checked_pow(decimals.len() as u32).ok_or_else(bad)?;
            [whole(&format!("{units}{decimals}"))?, seconds]
        } else {
            [whole(text)?, 1]
        };
        // EXR files hold the frames as a signed number.
        if frames == 0 || seconds == 0 || i32::try_from(frames).is_err() {
            return Err(bad());
        }
        let divisor = common_divisor(frames, seconds);
        Ok(Self([frames / divisor, seconds / divisor]))
    }
}

fn common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { common_divisor(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_fractions_in_lowest_terms() {
        for (text, rate, shown) in [
            ("24", [24, 1], "24"),
            ("23.976", [2997, 125], "2997/125"),
            ("24000/1001", [24_000, 1001], "24000/1001"),
            ("0.5", [1, 2], "1/2"),
            ("25.0", [25, 1], "25"),
            ("50/2", [25, 1], "25"),
        ] {
            let read: FrameRate = text.parse().unwrap();
            assert_eq!((read, read.to_string().as_str()), (FrameRate(rate), shown));
            assert_eq!(shown.parse(), Ok(read));
        }
        for text in [
            "",
            "0",
            "-24",
            "x",
            "24/0",
            "0/1",
            "1e3",
            "24.",
            ".5",
            "1/2/3",
            "+1",
            "4294967296",
            "1.00000000001",
            "nan",
        ] {
            assert!(text.parse::<FrameRate>().is_err(), "{text}");
        }
    }

    #[test]
    fn a_frame_begins_at_its_number_over_the_rate() {
        let frame = |number, rate: &str| Frame { number, rate: rate.parse().unwrap() };
        assert_eq!(frame(0, "24").shutter_s([-0.5, 0.25]), [-0.5, 0.25]);
        assert_eq!(frame(1, "24").opens_s(), 1.0 / 24.0);
        assert_eq!(frame(24_000, "24000/1001").opens_s(), 1001.0);
        assert_eq!(frame(7, "0.5").shutter_s([0.0, 1.0]), [14.0, 15.0]);
        assert_eq!((frame(7, "24").seed(3), frame(1, "24").seed(u64::MAX)), (10, 0));
    }
}
