//! Frames of a sequence on the command line: which ones, how many a second, and how their files are named.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use etalon::{Frame, FrameRate};
use miette::miette;

use crate::failure::Failure;

/// Most frames of a sequence: at 24 a second more than eleven hours.
const MOST_FRAMES: usize = 1_000_000;

/// Most digits that a number in a name is padded to.
const MOST_DIGITS: usize = 20;

/// Which frames to render.
#[derive(Clone, clap::Args)]
pub(crate) struct FrameArgs {
    /// Render a sequence: frames FIRST to LAST, each STEP-th of them, or a list such as 1,5,9 or 0:9,20:40:5. The names of
    /// the outputs have {frame} where the number stands, {frame:04} for four digits.
    #[arg(long, value_name = "FIRST:LAST[:STEP]")]
    pub frames: Option<FrameList>,
    /// Frames a second, such as 24, 23.976 or 24000/1001. In frame K the shutter opens K/RATE seconds later than the scene says.
    #[arg(long, value_name = "RATE", requires = "frames", default_value = "24")]
    pub fps: FrameRate,
    /// Give all frames of a sequence the random numbers of the scene's seed, so that the noise stands still. Without it frame K
    /// has the seed of the scene plus K.
    #[arg(long, requires = "frames")]
    pub fixed_seed: bool,
}

impl FrameArgs {
    /// A frame at the rate of the sequence.
    pub(crate) fn frame(&self, number: u32) -> Frame {
        Frame { number, rate: self.fps }
    }

    /// Moves a scene to a frame: its shutter, everything that has keyframes, and its seed.
    pub(crate) fn set(&self, scene: &mut etalon_scene::Scene, first: FirstFrame, number: u32) {
        let frame = self.frame(number);
        scene.set_shutter(frame.shutter_s(first.shutter_s));
        scene.integrator.seed = self.seed(first, number);
    }

    /// The seed of a frame.
    pub(crate) fn seed(&self, first: FirstFrame, number: u32) -> u64 {
        if self.fixed_seed { first.seed } else { self.frame(number).seed(first.seed) }
    }

    /// The options for some of the frames, as words of a command line.
    pub(crate) fn words(&self, frames: &str) -> Vec<String> {
        let mut words = vec!["--frames".to_owned(), frames.to_owned(), "--fps".to_owned(), self.fps.to_string()];
        words.extend(self.fixed_seed.then(|| "--fixed-seed".to_owned()));
        words
    }
}

/// What a scene says of frame 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FirstFrame {
    shutter_s: [f64; 2],
    seed: u64,
}

impl FirstFrame {
    /// Of a scene as it was read.
    pub(crate) fn of(scene: &etalon_scene::Scene) -> Self {
        Self { shutter_s: scene.camera.shutter_s, seed: scene.integrator.seed }
    }
}

/// Numbers of frames in the order in which they are to be rendered, none twice.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct FrameList {
    numbers: Vec<u32>,
    text: String,
}

impl FrameList {
    /// The numbers.
    pub(crate) fn numbers(&self) -> &[u32] {
        &self.numbers
    }

    /// The list as it was given.
    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    /// Every `of`-th frame, from number `index` on: the share of one machine among several, whose frames take about as long as those of
    /// any other.
    pub(crate) fn share(&self, index: u32, of: u32) -> Vec<u32> {
        self.numbers.iter().copied().skip(index as usize).step_by(of as usize).collect()
    }
}

impl From<u32> for FrameList {
    fn from(number: u32) -> Self {
        Self { numbers: vec![number], text: number.to_string() }
    }
}

impl FromStr for FrameList {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut numbers = Vec::new();
        for part in text.split(',') {
            numbers.extend(range(part)?);
            if numbers.len() > MOST_FRAMES {
                return Err(format!("more than {MOST_FRAMES} frames"));
            }
        }
        let mut sorted = numbers.clone();
        sorted.sort_unstable();
        if let Some(twice) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(format!("frame {} is in the list twice", twice[0]));
        }
        Ok(Self { numbers, text: text.split_whitespace().collect() })
    }
}

/// `NUMBER`, `FIRST:LAST` or `FIRST:LAST:STEP`.
fn range(text: &str) -> Result<Vec<u32>, String> {
    const BAD: &str = "frames are FIRST:LAST, FIRST:LAST:STEP or a list of these and of numbers, such as 0:99, 0:99:5 or 1,5,9, \
                       and numbers go from 0 to 4294967295";
    let numbers: Result<Vec<u32>, _> = text.split(':').map(|number| number.trim().parse::<u32>()).collect();
    let (first, last, step) = match numbers.map_err(|_| BAD.to_owned())?[..] {
        [number] => (number, number, 1),
        [first, last] => (first, last, 1),
        [first, last, step] => (first, last, step),
        _ => return Err(BAD.to_owned()),
    };
    if step == 0 {
        return Err("the step from one frame to the next must be at least 1".to_owned());
    }
    if last < first {
        return Err(format!("the last frame, {last}, comes before the first, {first}"));
    }
    if ((last - first) / step) as usize >= MOST_FRAMES {
        return Err(format!("more than {MOST_FRAMES} frames"));
    }
    Ok((first..=last).step_by(step as usize).collect())
}

/// The name of a file for each frame: text, and places where the frame's number stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct FramePattern {
    /// Before each number: the text, and to how many digits the number is padded with zeros.
    numbered: Vec<(String, usize)>,
    end: String,
}

impl FramePattern {
    /// A name with `{frame}`, `{frame:4}` or `{frame:04}` in it; also one without.
    pub(crate) fn parse(name: &Path) -> Result<Self, Failure> {
        let bad = |why: String| {
            Failure::input(miette!(
                code = "frame-name",
                help = "write {frame} for the number of the frame, {frame:04} for at least four digits",
                "the output `{}` {why}",
                name.display()
            ))
        };
        let Some(text) = name.to_str() else {
            return Err(bad("is not UTF-8, and a number cannot be put into it".to_owned()));
        };
        let (mut numbered, mut rest) = (Vec::new(), text);
        while let Some((before, after)) = rest.split_once("{frame") {
            let end = after.find('}').ok_or_else(|| bad("has a `{frame` without its `}`".to_owned()))?;
            let digits = match &after[..end] {
                "" => 1,
                form => form.strip_prefix(':').and_then(digits).ok_or_else(|| {
                    bad(format!("has `{{frame{form}}}`, and a number of digits from 1 to {MOST_DIGITS} was expected"))
                })?,
            };
            numbered.push((before.to_owned(), digits));
            rest = &after[end + 1..];
        }
        Ok(Self { numbered, end: rest.to_owned() })
    }

    /// Whether the number of the frame stands in it.
    pub(crate) fn has_number(&self) -> bool {
        !self.numbered.is_empty()
    }

    /// The name of a frame.
    pub(crate) fn of(&self, number: u32) -> PathBuf {
        let mut name = String::new();
        for (before, digits) in &self.numbered {
            name += before;
            name += &format!("{number:0digits$}");
        }
        PathBuf::from(name + &self.end)
    }
}

/// A number of digits, with or without a zero before it.
fn digits(text: &str) -> Option<usize> {
    let plain = text.bytes().all(|byte| byte.is_ascii_digit());
    text.parse().ok().filter(|digits| plain && (1..=MOST_DIGITS).contains(digits))
}

/// Whether a name asks for the number of a frame.
pub(crate) fn asks_for_number(name: &Path) -> bool {
    name.to_string_lossy().contains("{frame")
}

/// The outputs of a sequence of this many frames: where there are several, each name must have the number in it.
pub(crate) fn patterns(names: &[PathBuf], frames: usize) -> Result<Vec<FramePattern>, Failure> {
    let (mut patterns, mut failure) = (Vec::new(), Failure::default());
    for name in names {
        match FramePattern::parse(name) {
            Ok(pattern) if frames > 1 && !pattern.has_number() => failure.add(Failure::input(miette!(
                code = "frame-name",
                help = format!("write `{}`", numbered(name).display()),
                "all {frames} frames would be written to `{}`",
                name.display()
            ))),
            Ok(pattern) => patterns.push(pattern),
            Err(bad) => failure.add(bad),
        }
    }
    failure.into_outcome().map(|()| patterns)
}

/// A name with the number of the frame before its extension.
pub(crate) fn numbered(name: &Path) -> PathBuf {
    let mut file: OsString = name.file_stem().unwrap_or_default().to_owned();
    file.push("-{frame:04}");
    if let Some(extension) = name.extension() {
        file.push(".");
        file.push(extension);
    }
    name.with_file_name(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(text: &str) -> Result<Vec<u32>, String> {
        text.parse().map(|list: FrameList| list.numbers().to_vec())
    }

    #[test]
    fn lists_are_ranges_steps_and_numbers_in_the_order_given() {
        assert_eq!(list("3"), Ok(vec![3]));
        assert_eq!(list("0:3"), Ok(vec![0, 1, 2, 3]));
        assert_eq!(list("0:99:25"), Ok(vec![0, 25, 50, 75]));
        assert_eq!(list("0:100:25"), Ok(vec![0, 25, 50, 75, 100]));
        assert_eq!(list("9, 1:2 ,5"), Ok(vec![9, 1, 2, 5]));
        assert_eq!(list("4294967295"), Ok(vec![u32::MAX]));
        assert_eq!("9, 1:2".parse::<FrameList>().unwrap().text(), "9,1:2");
    }

    #[test]
    fn what_is_no_list_is_refused_with_the_reason() {
        for text in ["", ",", "1,", "a", "-1:3", "1:2:3:4", "0.5", "4294967296"] {
            assert!(list(text).unwrap_err().contains("FIRST:LAST"), "{text}");
        }
        for (text, why) in [
            ("5:3", "comes before"),
            ("0:9:0", "at least 1"),
            ("1,0:3", "frame 1 is in the list twice"),
            ("0:4294967295", "more than"),
            ("0:999999,2000000", "more than"),
        ] {
            assert!(list(text).unwrap_err().contains(why), "{text}");
        }
    }

    #[test]
    fn shares_have_every_frame_once() {
        let list: FrameList = "10:19".parse().unwrap();
        assert_eq!(list.share(1, 3), [11, 14, 17]);
        let mut all: Vec<u32> = (0..3).flat_map(|index| list.share(index, 3)).collect();
        all.sort_unstable();
        assert_eq!(all, list.numbers());
        assert!(list.share(10, 11).is_empty());
    }

    #[test]
    fn numbers_are_put_into_names_with_the_digits_asked_for() {
        for (name, of_7) in [
            ("shot-{frame}.exr", "shot-7.exr"),
            ("shot-{frame:04}.exr", "shot-0007.exr"),
            ("{frame:2}/a{frame}.png", "07/a7.png"),
            ("plain.exr", "plain.exr"),
            ("{other}.exr", "{other}.exr"),
        ] {
            let pattern = FramePattern::parse(Path::new(name)).unwrap_or_else(|_| panic!("{name}"));
            assert_eq!(pattern.of(7), Path::new(of_7));
            assert_eq!(pattern.has_number(), name.contains("{frame"));
        }
        let long = FramePattern::parse(Path::new("{frame:02}")).unwrap_or_else(|_| panic!("it is well formed"));
        assert_eq!(long.of(12_345), Path::new("12345"));
        for name in [
            "{frame.exr",
            "{frame:}.exr",
            "{frame:x}.exr",
            "{frame:0}.exr",
            "{frame:99}.exr",
            "{frames}.exr",
            "{frame:+4}",
        ] {
            assert!(FramePattern::parse(Path::new(name)).is_err(), "{name}");
        }
    }

    #[test]
    fn several_frames_need_their_number_in_each_name() {
        let names = ["a-{frame}.exr", "b.png"].map(PathBuf::from);
        assert!(patterns(&names, 1).is_ok());
        let failure = patterns(&names, 2).map(drop).unwrap_err();
        let json = serde_json::to_value(crate::problem_json::problems_json(&failure)).unwrap();
        assert_eq!(json[0]["hint"], "write `b-{frame:04}.png`");
        assert_eq!(json.as_array().unwrap().len(), 1);
    }
}
