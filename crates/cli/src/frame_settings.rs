//! What a file says of the frame in it, so that a sequence can be continued: all that decides the picture.

use std::collections::BTreeMap;
use std::path::Path;

use etalon::{Channels, Frame};
use etalon_control::SOURCES_SHA256;
use etalon_picture::{Attribute, PictureError, read_exr, read_png_text};
use etalon_transport::PixelRect;
use miette::miette;
use serde::Serialize;
use serde_json::Value;

use crate::developing::FRAME_SETTINGS;
use crate::failure::Failure;
use crate::output::{Format, Output};

/// All that decides a frame's picture.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct FrameSettings {
    /// Program and version.
    pub software: &'static str,
    /// SHA-256 of the sources of the program.
    pub sources_sha256: &'static str,
    /// SHA-256 of the scene and of all files that it refers to.
    pub scene_sha256: String,
    /// Which frame.
    pub frame: Frame,
    /// Seed of its random numbers.
    pub seed: u64,
    /// Options that stand for something of the scene, as they were given.
    pub options: String,
    /// The relative error at which it ends.
    pub error: Option<f64>,
    /// The time at which it ends, s.
    pub time_s: Option<f64>,
    /// Whether regions take different numbers of samples.
    pub adaptive: &'static str,
    /// Which pixels are rendered, if not all.
    pub crop: Option<PixelRect>,
    /// Channels of EXR files.
    pub channels: Channels,
    /// How PNG files are developed.
    pub develop: String,
}

impl FrameSettings {
    /// Of the program that runs.
    pub(crate) const SOFTWARE: &str = concat!("etalon ", env!("CARGO_PKG_VERSION"));
    /// Of the program that runs.
    pub(crate) const SOURCES: &str = SOURCES_SHA256;

    /// What a file of this format says: what does not concern it is left out.
    pub(crate) fn text(&self, format: Format) -> String {
        Value::Object(self.values(format).into_iter().collect()).to_string()
    }

    fn values(&self, format: Format) -> BTreeMap<String, Value> {
        let value = serde_json::to_value(self).expect("settings are plain data with text keys");
        let other = if format == Format::Png { "channels" } else { "develop" };
        value.as_object().cloned().unwrap_or_default().into_iter().filter(|(key, _)| key != other).collect()
    }

    /// Whether a file has this frame, finished. A file with anything else in it is a failure, for it would be replaced.
    pub(crate) fn is_finished(&self, output: &Output) -> Result<bool, Failure> {
        let path = output.path.as_path();
        if path.symlink_metadata().is_err() {
            return Ok(false);
        }
        let refuse = |why: String| {
            Failure::input(miette!(
                code = "other-frame",
                help = "give the same scene and options as before, remove the file, or leave --resume out to render all frames again",
                "`{}` is not the frame that would be written there: {why}",
                path.display()
            ))
        };
        let text = match stated(path, output.format) {
            Ok(Some(text)) => text,
            Ok(None) => return Err(refuse("it is not a finished frame of a sequence".to_owned())),
            Err(error) => return Err(refuse(error.with_causes())),
        };
        let there: BTreeMap<String, Value> = serde_json::from_str(&text).unwrap_or_default();
        let differs = |(key, own): &(String, Value)| there.get(key) != Some(own);
        match self.values(output.format).into_iter().find(differs) {
            None => Ok(true),
            Some((key, own)) => {
                Err(refuse(format!("its {} is {}, not {own}", name(&key), there.get(&key).unwrap_or(&Value::Null))))
            }
        }
    }
}

/// What the file says, if it says anything.
fn stated(path: &Path, format: Format) -> Result<Option<String>, PictureError> {
    Ok(match format {
        Format::Exr => match read_exr(path)?.attributes.remove(FRAME_SETTINGS) {
            Some(Attribute::Text(text)) => Some(text),
            _ => None,
        },
        Format::Png => read_png_text(path, FRAME_SETTINGS)?,
        // Sequences write none.
        Format::Part => None,
    })
}

/// The name of a setting in messages.
fn name(key: &str) -> &str {
    match key {
        "software" => "program",
        "sources_sha256" => "SHA-256 of the program's sources",
        "scene_sha256" => "SHA-256 of the scene",
        "options" => "list of options",
        "error" => "--error",
        "time_s" => "--time (seconds)",
        "adaptive" => "--adaptive",
        "channels" => "list of channels (--aov, --only)",
        "develop" => "development",
        other => other,
    }
}
