//! Files of digital numbers.

use super::exposure::RawFrame;
use crate::{Attribute, Attributes, PictureError, Samples16};

/// How a raw picture describes itself in its file, beside what the file of the exposed picture says.
///
/// The attributes are `sensor` (string: the sensor as JSON), `sensorSha256` (string of hex digits), `sensorSeed` and `sensorFrame` (strings of
/// decimal digits) and `exposedBy` (string: program and version).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RawInfo {
    /// Program and version.
    pub software: String,
    /// The text of the sensor's file.
    pub sensor_json: String,
    /// SHA-256 of this text, in hex.
    pub sensor_sha256: String,
    /// Seed of shot noise and read noise.
    pub seed: u64,
    /// Number of the exposure.
    pub frame: u32,
}

/// Attributes of a spectral picture that do not hold of digital numbers made of it: unit, primaries, error.
const OF_THE_LIGHT: [&str; 14] = [
    "chromaticities",
    "whiteLuminance",
    "spectralLayoutVersion",
    "emissiveUnits",
    "emissiveDensity",
    "EV",
    "polarisationHandedness",
    "objectNames",
    "replicates",
    "relativeRmse",
    "relativeRmseInterval",
    "noisiestTile",
    "tailIndex",
    "correlatedPixels",
];

/// The attribute by which `render --resume` knows a finished frame.
const OF_THE_RENDER: &str = "frameSettings";

impl RawInfo {
    /// Names and texts, in this order.
    #[must_use]
    pub fn texts(&self) -> [(&'static str, String); 5] {
        [
            ("exposedBy", self.software.clone()),
            ("sensor", self.sensor_json.clone()),
            ("sensorSha256", self.sensor_sha256.clone()),
            ("sensorSeed", self.seed.to_string()),
            ("sensorFrame", self.frame.to_string()),
        ]
    }

    /// The attributes of the raw file of a picture with these attributes.
    #[must_use]
    pub fn attributes(&self, of_picture: &Attributes) -> Attributes {
        let kept =
            of_picture.iter().filter(|(name, _)| !OF_THE_LIGHT.contains(&name.as_str()) && *name != OF_THE_RENDER);
        let mut attributes: Attributes = kept.map(|(name, value)| (name.clone(), value.clone())).collect();
        attributes.extend(self.texts().map(|(name, text)| (name.to_owned(), Attribute::Text(text))));
        attributes
    }
}

impl RawFrame {
    /// The digital numbers as they are, as 16-bit samples: grey for one number a pixel, colour for three.
    ///
    /// # Errors
    /// Another number of channels; pixels that cannot be exposed, which no PNG can hold.
    pub fn samples16(&self) -> Result<Samples16, PictureError> {
        if self.unusable.count > 0 {
            return Err(PictureError::expose(
                "a PNG file cannot hold pixels that are not finite or negative: write an EXR file",
            ));
        }
        let is_dn = |name: &str| name == "DN" || name.starts_with("DN.");
        let planes: Vec<&[f32]> = self
            .picture
            .channels()
            .iter()
            .filter(|channel| is_dn(&channel.name))
            .map(|channel| channel.samples.as_slice())
            .collect();
        if planes.len() != 1 && planes.len() != 3 {
            let count = planes.len();
            return Err(PictureError::expose(format!(
                "a PNG file holds one or three numbers a pixel, and the sensor has {count}: write an EXR file"
            )));
        }
        let (width, height) = (self.picture.width(), self.picture.height());
        // Digital numbers are whole and have at most 16 bits.
        let samples = (0..width * height).flat_map(|i| planes.iter().map(move |plane| plane[i] as u16)).collect();
        Ok(Samples16 { width, height, channels: planes.len(), samples })
    }
}
