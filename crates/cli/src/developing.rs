//! How PNG files are developed: the options, and what is said about the result.

use etalon_picture::develop::{
    Axis, ColourScale, Developed, ErrorKind, Exposure, MAX_STOPS, Map, Rect, Settings, Tone, ToneCurve, White,
    WhiteBalance, develop, scaled_size, short_number,
};
use etalon_picture::{Attribute, Clipping, ExrFile, PictureError, RenderInfo, write_png};
use miette::{Report, Severity, miette};
use std::path::Path;

use crate::args;

/// The attribute of an EXR file and the keyword of a PNG file under which the settings of a frame of a sequence stand, as JSON.
pub(crate) const FRAME_SETTINGS: &str = "frameSettings";

/// The heading of these options in `--help`.
const HEADING: &str = "How PNG files look (an EXR keeps the linear picture)";

/// The options of every command that writes PNG files.
#[derive(clap::Args, Clone, Debug)]
pub(crate) struct Developing {
    /// Brightness in stops. Each stop doubles the light. `auto` maps the log-average luminance to 18 % grey.
    #[arg(long, value_name = "EV|auto", default_value = "0", allow_negative_numbers = true, value_parser = exposure, help_heading = HEADING)]
    exposure: Exposure,
    /// Light that looks white: none (no change), A, D50, D55, D65, D75, E, a black body such as 3200K, or the mean of a patch of the picture,
    /// patch:X,Y,W,H. The chromatic adaptation is complete, by CAT16.
    #[arg(long, value_name = "LIGHT", default_value = "none", value_parser = white_balance, help_heading = HEADING)]
    white_balance: Balance,
    /// Tone curve: how bright values fit into the range of the screen.
    #[arg(long, value_enum, default_value_t = CurveArg::Linear, help_heading = HEADING)]
    curve: CurveArg,
    /// Factor on width and height. Pixels are averaged in linear light.
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = factor, help_heading = HEADING)]
    scale: f64,
    /// Show one spectral band as grey, such as 550nm.
    #[arg(long, value_name = "WAVELENGTH", value_parser = wavelength, conflicts_with = "white_balance", help_heading = HEADING)]
    band: Option<f64>,
    /// Show luminance in false colour with a colour bar, in cd/m² if the file states its unit. With --band, show radiance.
    #[arg(long, alias = "false-color", group = "map", conflicts_with_all = LIGHT, help_heading = HEADING)]
    false_colour: bool,
    /// Show the standard error of each pixel in false colour. Without a KIND it is relative.
    #[arg(long, value_enum, value_name = "KIND", num_args = 0..=1, require_equals = true, default_missing_value = "relative",
        group = "map", conflicts_with_all = LIGHT, help_heading = HEADING)]
    error_map: Option<ErrorArg>,
    /// Values at the two ends of the colour bar, such as 0.1:100. Default: chosen from the picture.
    #[arg(long, value_name = "LOW:HIGH", value_parser = range, requires = "map", allow_negative_numbers = true, help_heading = HEADING)]
    range: Option<Ends>,
    /// Scale of the colour bar.
    #[arg(long, value_enum, default_value_t = AxisArg::Log, requires = "map", help_heading = HEADING)]
    axis: AxisArg,
}

/// Options that false colour has no use for.
const LIGHT: [&str; 3] = ["exposure", "white_balance", "curve"];

/// All options, for those that cannot go together with any of them.
pub(crate) const ALL: [&str; 9] =
    ["exposure", "white_balance", "curve", "scale", "band", "false_colour", "error_map", "range", "axis"];

/// A white balance, and how it was written.
#[derive(Clone, Debug)]
struct Balance {
    text: String,
    value: WhiteBalance,
}

/// The two ends of a range.
#[derive(Clone, Copy, Debug)]
struct Ends([f64; 2]);

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum CurveArg {
    /// No curve. Values above white are clipped and counted.
    Linear,
    /// Hable's filmic curve (2010) on each component. The value 5.6 becomes white.
    Filmic,
    /// Sobotka's AgX. Very bright colours turn white instead of clipping.
    #[value(name = "agx")]
    Agx,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum ErrorArg {
    /// Standard error divided by the value.
    Relative,
    /// Standard error in the unit of the value.
    Absolute,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum AxisArg {
    /// Logarithmic.
    Log,
    /// Linear.
    Linear,
}

impl Developing {
    /// What is to be done; `crop` is the part of the file that is shown.
    pub(crate) fn settings(&self, crop: Option<Rect>) -> Settings {
        let error = self.error_map.map(|kind| match kind {
            ErrorArg::Relative => ErrorKind::Relative,
            ErrorArg::Absolute => ErrorKind::Absolute,
        });
        let map = (self.false_colour || error.is_some()).then(|| Map {
            error,
            axis: match self.axis {
                AxisArg::Log => Axis::Log,
                AxisArg::Linear => Axis::Linear,
            },
            range: self.range.map(|ends| ends.0),
        });
        Settings {
            crop,
            scale: self.scale,
            band_nm: self.band,
            white_balance: self.white_balance.value,
            exposure: self.exposure,
            curve: match self.curve {
                CurveArg::Linear => ToneCurve::Linear,
                CurveArg::Filmic => ToneCurve::Filmic,
                CurveArg::Agx => ToneCurve::Agx,
            },
            map,
        }
    }

    /// Whether pictures are shown as they are.
    pub(crate) fn is_plain(&self) -> bool {
        self.settings(None) == Settings::default()
    }

    /// Whether more is shown than the colour of the file.
    pub(crate) fn needs_all_channels(&self) -> bool {
        self.band.is_some() || self.error_map.is_some()
    }

    /// All that decides how a picture is shown, in words.
    pub(crate) fn as_text(&self) -> String {
        format!("{:?}", self.settings(None))
    }

    /// The wavelength of the band that is shown, nm.
    pub(crate) fn band_nm(&self) -> Option<f64> {
        self.band
    }

    /// Whether errors are shown.
    pub(crate) fn shows_errors(&self) -> bool {
        self.error_map.is_some()
    }

    /// Finds what is wrong with these options for a picture of this size, before there is one.
    pub(crate) fn check(&self, width: usize, height: usize) -> Result<(), PictureError> {
        if let WhiteBalance::Patch(patch) = self.white_balance.value {
            patch.check_within(width, height)?;
        }
        if self.scale != 1.0 {
            scaled_size(width, height, self.scale)?;
        }
        let map = self.settings(None).map;
        if let Some((axis, range)) = map.and_then(|map| Some((map.axis, map.range?))) {
            ColourScale::new(axis, range).map_err(|why| PictureError::Develop { why: format!("--range: {why}") })?;
        }
        Ok(())
    }

    /// Develops a picture and writes it as PNG. The file says how it was made.
    pub(crate) fn write(&self, path: &Path, file: &ExrFile, crop: Option<Rect>) -> Result<Developed, PictureError> {
        let developed = develop(file, &self.settings(crop))?;
        let info = RenderInfo::from_attributes(&file.attributes);
        let own = concat!("etalon ", env!("CARGO_PKG_VERSION"));
        let software = info.as_ref().map(|info| info.software.as_str()).filter(|name| name.starts_with("etalon "));
        let comment = self.comment(file, info.as_ref(), &developed, crop);
        let mut texts = vec![("Software", software.unwrap_or(own)), ("Comment", comment.as_str())];
        if let Some(Attribute::Text(settings)) = file.attributes.get(FRAME_SETTINGS) {
            texts.push((FRAME_SETTINGS, settings));
        }
        write_png(path, &developed.image, &texts)?;
        Ok(developed)
    }

    /// What became of the values, in words.
    pub(crate) fn describe(&self, developed: &Developed) -> String {
        match &developed.tone {
            Tone::Picture { exposure_ev, clipping } if self.exposure == Exposure::Auto => {
                format!("exposure {exposure_ev:+} EV, {}", describe_clipping(clipping))
            }
            Tone::Picture { clipping, .. } => describe_clipping(clipping),
            Tone::Map { title, range: [low, high], below, above } => {
                let ends = format!("{title}, from {} to {}", short_number(*low), short_number(*high));
                format!("{ends}; pixels below: {below}, above: {above}")
            }
        }
    }

    /// What a PNG says about itself: how it was rendered, as far as the file tells, and how it was developed.
    fn comment(&self, file: &ExrFile, info: Option<&RenderInfo>, developed: &Developed, crop: Option<Rect>) -> String {
        let text = |name: &str| match file.attributes.get(name) {
            Some(Attribute::Text(text)) => Some(text),
            _ => None,
        };
        let mut parts: Vec<String> = text("denoised").cloned().into_iter().collect();
        if let Some(info) = info {
            parts.push(format!("{} samples a pixel, seed {}", info.samples_per_pixel, info.seed));
        }
        match &developed.tone {
            Tone::Picture { exposure_ev, .. } => parts.push(format!("exposure {exposure_ev:+} EV")),
            Tone::Map { title, range: [low, high], .. } => parts.push(format!("{title}, from {low:e} to {high:e}")),
        }
        if let Some(info) = info {
            parts.push(format!("scene {}", info.scene_sha256));
        }
        parts.extend(text("approximation").map(|lost| format!("approximation {lost}")));
        parts.extend(text("unfinished").cloned());
        if self.white_balance.value != WhiteBalance::None {
            parts.push(format!("white balance {}", self.white_balance.text));
        }
        if self.curve != CurveArg::Linear {
            let name = if self.curve == CurveArg::Filmic { "filmic" } else { "agx" };
            parts.push(format!("curve {name}"));
        }
        parts.extend(developed.band_nm.map(|nm| format!("band at {nm} nm")));
        parts.extend(crop.map(|rect| format!("crop {rect}")));
        if self.scale != 1.0 {
            parts.push(format!("scale {}", self.scale));
        }
        parts.join(", ")
    }
}

/// What an 8-bit picture could not hold, in words.
fn describe_clipping(clipping: &Clipping) -> String {
    let share = 100.0 * clipping.any as f64 / clipping.of as f64;
    let mut kinds = Vec::new();
    for (count, kind) in [
        (clipping.above, "too bright"),
        (clipping.below, "outside the sRGB gamut"),
        (clipping.non_finite, "not finite"),
    ] {
        if count > 0 {
            kinds.push(format!("{count} {kind}"));
        }
    }
    if kinds.is_empty() {
        "no pixel clipped".to_owned()
    } else {
        let pixels = if clipping.any == 1 { "pixel" } else { "pixels" };
        format!("{} {pixels} clipped ({share:.2} %: {})", clipping.any, kinds.join(", "))
    }
}

/// A warning of values that no picture can show.
pub(crate) fn warn_not_finite(path: &Path, developed: &Developed) -> Option<Report> {
    let [x, y] = developed.not_finite.first?;
    let shown = match developed.tone {
        Tone::Picture { .. } => "NaN is shown as black, and an infinity as white or black",
        Tone::Map { .. } => "they are shown in green",
    };
    Some(miette!(
        severity = Severity::Warning,
        code = "not-finite",
        help = shown,
        "`{}`: {} pixels are not finite, the first in column {x}, row {y}",
        path.display(),
        developed.not_finite.count
    ))
}

fn exposure(text: &str) -> Result<Exposure, String> {
    if text == "auto" {
        return Ok(Exposure::Auto);
    }
    let stops =
        args::finite(text).map_err(|error| format!("{error}; write a number of stops such as -1.5, or `auto`"))?;
    if stops.abs() > MAX_STOPS {
        return Err(format!("the exposure must lie between -{MAX_STOPS} and {MAX_STOPS} stops"));
    }
    Ok(Exposure::Stops(stops))
}

fn white_balance(text: &str) -> Result<Balance, String> {
    let value = match text.strip_prefix("patch:") {
        _ if text == "none" => WhiteBalance::None,
        Some(rect) => WhiteBalance::Patch(args::rect(rect)?),
        None => {
            let light = White::named(text);
            WhiteBalance::Light(
                light.map_err(|error| format!("{error}; or `none`, or a patch such as patch:10,20,8,8"))?,
            )
        }
    };
    Ok(Balance { text: text.to_owned(), value })
}

fn factor(text: &str) -> Result<f64, String> {
    match args::finite(text) {
        Ok(factor) if factor > 0.0 => Ok(factor),
        _ => Err("the factor must be above 0, such as 0.5".to_owned()),
    }
}

fn wavelength(text: &str) -> Result<f64, String> {
    match args::finite(text.strip_suffix("nm").unwrap_or(text).trim_end()) {
        Ok(nm) if nm > 0.0 => Ok(nm),
        _ => Err("expected a wavelength in nm, such as 550nm".to_owned()),
    }
}

fn range(text: &str) -> Result<Ends, String> {
    let number = |text: &str| args::finite(text.trim()).ok();
    match text.split_once(':').and_then(|(low, high)| Some([number(low)?, number(high)?])) {
        Some([low, high]) if low < high => Ok(Ends([low, high])),
        _ => Err("a range is LOW:HIGH with LOW below HIGH, such as 0.1:100".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_as_they_are_written() {
        assert_eq!(exposure("auto"), Ok(Exposure::Auto));
        assert_eq!(exposure("-1.5"), Ok(Exposure::Stops(-1.5)));
        assert_eq!(wavelength("550nm"), Ok(550.0));
        assert_eq!(wavelength("550.5 nm"), Ok(550.5));
        assert_eq!(range("0.1:1e3").unwrap().0, [0.1, 1e3]);
        assert_eq!(range("-1:1").unwrap().0, [-1.0, 1.0]);
        let patch = white_balance("patch:1,2,3,4").unwrap();
        assert_eq!(patch.value, WhiteBalance::Patch(Rect { x: 1, y: 2, width: 3, height: 4 }));
        assert_eq!(white_balance("none").unwrap().value, WhiteBalance::None);
    }

    #[test]
    fn what_is_no_value_is_refused_with_an_example() {
        for text in ["", "Auto", "nan", "inf", "1001", "x"] {
            assert!(exposure(text).is_err(), "{text}");
        }
        for text in ["", "0nm", "-5", "nan", "550m"] {
            assert!(wavelength(text).unwrap_err().contains("550nm"), "{text}");
        }
        for text in ["", "1", "2:1", "1:1", "nan:1", "1:inf", "1:2:3"] {
            assert!(range(text).unwrap_err().contains("0.1:100"), "{text}");
        }
        for text in ["0", "-1", "nan", "inf", "half"] {
            assert!(factor(text).is_err(), "{text}");
        }
        for text in ["", "patch", "patch:1,2,3", "patch:1,2,0,4", "tungsten", "10K"] {
            assert!(white_balance(text).is_err(), "{text}");
        }
    }

    #[test]
    fn clipping_is_told_in_words() {
        let none = Clipping { of: 10, ..Clipping::default() };
        assert_eq!(describe_clipping(&none), "no pixel clipped");
        let some = Clipping { above: 2, below: 0, non_finite: 1, any: 3, of: 200 };
        assert_eq!(describe_clipping(&some), "3 pixels clipped (1.50 %: 2 too bright, 1 not finite)");
        let one = Clipping { above: 1, any: 1, of: 200, ..Clipping::default() };
        assert_eq!(describe_clipping(&one), "1 pixel clipped (0.50 %: 1 too bright)");
    }
}
