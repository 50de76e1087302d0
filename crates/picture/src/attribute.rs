//! What a file says about its picture.

use std::collections::BTreeMap;

/// Attributes of an EXR file by name, without those that describe how the pixels are stored.
pub type Attributes = BTreeMap<String, Attribute>;

/// The value of an EXR attribute.
#[derive(Clone, Debug, PartialEq)]
pub enum Attribute {
    /// `string`, as UTF-8.
    Text(String),
    /// `int`.
    Int(i32),
    /// `float`.
    Float(f32),
    /// `double`.
    Double(f64),
    /// `v2f`.
    Vec2([f32; 2]),
    /// `v3f`.
    Vec3([f32; 3]),
    /// `m44f`, row after row.
    Matrix4([f32; 16]),
    /// `chromaticities`.
    Chromaticities(Chromaticities),
    /// Any other type, as its bytes in the file.
    Other {
        /// The name of the type.
        kind: String,
        /// The value in the file's little-endian layout.
        bytes: Vec<u8>,
    },
}

/// CIE 1931 xy coordinates of the primaries and the white of a picture's R, G and B.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chromaticities {
    /// x and y of red.
    pub red: [f32; 2],
    /// x and y of green.
    pub green: [f32; 2],
    /// x and y of blue.
    pub blue: [f32; 2],
    /// x and y of white.
    pub white: [f32; 2],
}

impl Chromaticities {
    /// Rec. 709 and its white D65, as ITU-R BT.709-6 (2015), table 1, items 1.3 and 1.4 give them.
    pub const REC_709: Self =
        Self { red: [0.64, 0.33], green: [0.30, 0.60], blue: [0.15, 0.06], white: [0.3127, 0.3290] };
}

/// How a render describes itself in its file.
///
/// The attributes are `chromaticities` (always Rec. 709), `software` (string), `renderTimeSeconds` (float),
/// `samplesPerPixel` (int), `seed` (string of decimal digits: EXR has no 64-bit integer), `sceneSha256` (string of hex
/// digits) and `plan` (string, JSON).
#[derive(Clone, Debug, PartialEq)]
pub struct RenderInfo {
    /// Program and version.
    pub software: String,
    /// Wall-clock time of the render, s.
    pub render_time_s: f64,
    /// Samples a pixel.
    pub samples_per_pixel: u32,
    /// Seed of every random number.
    pub seed: u64,
    /// SHA-256 of the scene, in hex.
    pub scene_sha256: String,
    /// The plan that the renderer made, as JSON.
    pub plan_json: String,
}

impl RenderInfo {
    /// The attributes that say so. Seconds are rounded to `f32`; more than 2³¹ − 1 samples a pixel are an error.
    ///
    /// # Errors
    /// A number of samples that EXR's `int` cannot hold.
    pub fn attributes(&self) -> Result<Attributes, crate::PictureError> {
        let samples = i32::try_from(self.samples_per_pixel).map_err(|_| crate::PictureError::BadAttribute {
            name: "samplesPerPixel".to_owned(),
            why: "does not fit into EXR's 32-bit integer",
        })?;
        Ok([
            ("chromaticities", Attribute::Chromaticities(Chromaticities::REC_709)),
            ("software", Attribute::Text(self.software.clone())),
            ("renderTimeSeconds", Attribute::Float(self.render_time_s as f32)),
            ("samplesPerPixel", Attribute::Int(samples)),
            ("seed", Attribute::Text(self.seed.to_string())),
            ("sceneSha256", Attribute::Text(self.scene_sha256.clone())),
            ("plan", Attribute::Text(self.plan_json.clone())),
        ]
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect())
    }

    /// What a file's attributes say, if they say all of it.
    #[must_use]
    pub fn from_attributes(attributes: &Attributes) -> Option<Self> {
        let text = |name: &str| match attributes.get(name) {
            Some(Attribute::Text(text)) => Some(text.clone()),
            _ => None,
        };
        Some(Self {
            software: text("software")?,
            render_time_s: match attributes.get("renderTimeSeconds")? {
                Attribute::Float(seconds) => f64::from(*seconds),
                _ => return None,
            },
            samples_per_pixel: match attributes.get("samplesPerPixel")? {
                Attribute::Int(samples) => u32::try_from(*samples).ok()?,
                _ => return None,
            },
            seed: text("seed")?.parse().ok()?,
            scene_sha256: text("sceneSha256")?,
            plan_json: text("plan")?,
        })
    }
}
