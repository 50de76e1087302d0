//! The truths as files for a renderer in any language.
//!
//! [`exchange_files`] gives the folder that such a renderer reads; [`Reading::from_pixels`] and
//! [`Reading::from_means`](crate::subjects::Reading::from_means) read what it drew.

mod set;

use serde_json::{Value, json};

pub use set::{REMOVED, SET_VERSION};

use super::{Claim, Quantity, SceneFile, Truth};
use crate::{
    statistics::{Estimate, Welford},
    subjects::Reading,
};

/// A file of the exchange folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExchangeFile {
    /// Its path in the folder, with `/` between names.
    pub path: String,
    /// Its contents: text in UTF-8, or an image that a scene names.
    pub bytes: Vec<u8>,
}

/// The folder that a renderer in any language starts from. It has a README, the licences, the JSON Schema of the neutral form, the list of
/// truths, and a judge that needs nothing but Python. Each truth has its scene there, with the files that the scene names.
///
/// # Panics
/// If two scenes name different files alike.
#[must_use]
pub fn exchange_files(truths: &[Truth]) -> Vec<ExchangeFile> {
    let file = |path: &str, text: &str| ExchangeFile { path: path.to_owned(), bytes: text.as_bytes().to_vec() };
    let scenes = scene_files(truths);
    let digest = set::digest(
        truths.iter().map(|truth| (truth.name.as_str(), truth.value())),
        scenes.iter().map(|file| (file.path.as_str(), file.bytes.as_slice())),
    );
    let list = json!({
        "format": 1,
        "version": SET_VERSION,
        "digest": digest,
        "written_by": concat!("etalon ", env!("CARGO_PKG_VERSION")),
        "license": env!("CARGO_PKG_LICENSE"),
        "removed": REMOVED,
        "truths": truths.iter().map(entry).collect::<Vec<_>>(),
    });
    let list = serde_json::to_string_pretty(&list).expect("a JSON value always prints") + "\n";
    let mut files = vec![
        file("README.md", &readme(truths, &digest)),
        file("LICENSE-APACHE", include_str!("../../../../LICENSE-APACHE")),
        file("LICENSE-MIT", include_str!("../../../../LICENSE-MIT")),
        file("judge.py", include_str!("exchange/judge.py")),
        file("neutral.schema.json", include_str!("exchange/neutral.schema.json")),
        file("truths.json", &list),
    ];
    files.extend(scenes);
    files
}

/// The scenes, and the files that they name.
fn scene_files(truths: &[Truth]) -> Vec<ExchangeFile> {
    let scene = |path: String, text: String| ExchangeFile { path, bytes: (text + "\n").into_bytes() };
    let mut files: Vec<ExchangeFile> = Vec::new();
    for truth in truths {
        for SceneFile { name, bytes } in &truth.files {
            let path = format!("scenes/{name}");
            match files.iter().find(|file| file.path == path) {
                Some(other) => assert_eq!(&other.bytes, bytes, "{}: another file is named {name}", truth.name),
                None => files.push(ExchangeFile { path, bytes: bytes.clone() }),
            }
        }
        files.push(scene(format!("scenes/{}.json", truth.name), truth.scene.clone()));
        if truth.band_nm.is_some() {
            files.push(scene(format!("scenes/{}.white.json", truth.name), truth.white_scene()));
        }
    }
    files
}

/// The README, with what it says of these truths.
fn readme(truths: &[Truth], digest: &str) -> String {
    let whole = truths.iter().filter(|truth| truth.claims.contains(&Claim::WholeFormat)).count();
    [
        ("{version}", SET_VERSION.to_owned()),
        ("{digest}", digest.to_owned()),
        ("{truths}", truths.len().to_string()),
        ("{neutral}", (truths.len() - whole).to_string()),
        ("{whole}", whole.to_string()),
    ]
    .iter()
    .fold(include_str!("exchange/README.md").to_owned(), |text, (mark, said)| text.replace(mark, said))
}

/// A truth's entry in `truths.json`.
fn entry(truth: &Truth) -> Value {
    let [width, height] = truth.film_px();
    let name = &truth.name;
    let known: Vec<_> = truth.mistakes().iter().map(|m| json!({ "what": m.what, "value": m.value })).collect();
    json!({
        "name": name,
        "scene": format!("scenes/{name}.json"),
        "picture": format!("{name}.exr"),
        "white_scene": truth.band_nm.map(|_| format!("scenes/{name}.white.json")),
        "white_picture": truth.band_nm.map(|_| format!("{name}.white.exr")),
        "width": width,
        "height": height,
        "band_nm": truth.band_nm,
        "quantity": truth.quantity.name(),
        "band_channel": truth.band_channel(),
        "crop_px": truth.crop_px,
        "value": truth.value(),
        "formula": truth.formula,
        "derivation": truth.derivation,
        "mistakes": known,
        "tolerance": truth.tolerance(),
        "tolerance_reason": truth.tolerance_reason(),
        // A dark picture without known mistakes need not be measured finely: nothing may come through at all.
        "must_resolve": Some(truth.must_resolve()).filter(|bias| bias.is_finite()),
        "claims": truth.claims.iter().map(|claim| claim.name()).collect::<Vec<_>>(),
    })
}

impl Claim {
    /// Its name in files: words joined by hyphens.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::AveragesPolarisation => "averages-polarisation",
            Self::CarriesPolarisation => "carries-polarisation",
            Self::NarrowBand => "narrow-band",
            Self::Dispersion => "dispersion",
            Self::ThinLens => "thin-lens",
            Self::DepthLimit => "depth-limit",
            Self::NestedMedia => "nested-media",
            Self::PhotometricSensor => "photometric-sensor",
            Self::Priorities => "priorities",
            Self::Absorption => "absorption",
            Self::Scattering => "scattering",
            Self::ThinFilms => "thin-films",
            Self::Gratings => "gratings",
            Self::Fluorescence => "fluorescence",
            Self::SpecularConnections => "specular-connections",
            Self::Motion => "motion",
            Self::Masks => "masks",
            Self::LosslessRoughGlass => "lossless-rough-glass",
            Self::LosslessRoughMetal => "lossless-rough-metal",
            Self::AnisotropicFacets => "anisotropic-facets",
            Self::CorrelatedMasking => "correlated-masking",
            Self::WholeFormat => "whole-format",
            Self::StatedPixels => "stated-pixels",
            Self::StokesParameters => "stokes-parameters",
            Self::Meters => "meters",
            Self::Bands => "bands",
        }
    }
}

impl Truth {
    /// Width and height of its film, pixels.
    #[must_use]
    pub fn film_px(&self) -> [usize; 2] {
        let scene: Value = serde_json::from_str(&self.scene).expect("a truth's scene is JSON");
        ["width", "height"].map(|side| scene["film"][side].as_u64().expect("a film has two sides") as usize)
    }

    /// The channel of the band that is read, if it is one: `S0.` and its middle with a decimal comma, such as `S0.450,000000nm`.
    #[must_use]
    pub fn band_channel(&self) -> Option<String> {
        let Quantity::Band(number) = self.quantity else { return None };
        let scene: Value = serde_json::from_str(&self.scene).expect("a truth's scene is JSON");
        let [first, step] = [0, 2].map(|k| scene["film"]["bands_nm"][k].as_f64().expect("the film keeps bands"));
        let middle = format!("{:.6}", first + f64::from(number) * step);
        Some(format!("S0.{}nm", middle.replace('.', ",")))
    }
}

impl Reading {
    /// Reads one picture: its pixels and the standard error of each, with noise that is independent from pixel to pixel.
    ///
    /// A pixel that is not finite, in value or error, counts as non-finite and is left out.
    ///
    /// # Panics
    /// When there are not as many errors as pixels, or none of either.
    #[must_use]
    pub fn from_pixels(values: &[f64], standard_errors: &[f64]) -> Self {
        assert_eq!(values.len(), standard_errors.len(), "an error for each pixel");
        assert!(!values.is_empty(), "a picture has pixels");
        let finite = || values.iter().zip(standard_errors).filter(|(v, e)| v.is_finite() && e.is_finite());
        let count = finite().count() as f64;
        let mean = finite().map(|(value, _)| value).sum::<f64>() / count;
        let variance = finite().map(|(_, error)| error * error).sum::<f64>();
        Self {
            estimate: Estimate::new(mean, variance.sqrt() / count),
            nonfinite: values.len() as u64 - count as u64,
            cut_bias: 0.0,
        }
    }

    /// Reads several pictures of the same scene with different seeds and equally many paths: the mean of each. Their
    /// scatter is the error, with one degree of freedom less than there are pictures.
    #[must_use]
    pub fn from_means(means: &[f64], nonfinite: u64) -> Self {
        let moments: Welford = means.iter().copied().collect();
        Self { estimate: moments.estimate(), nonfinite, cut_bias: 0.0 }
    }

    /// The reading in units of another, such as a band's in units of white; their noise is taken to be independent.
    #[must_use]
    pub fn relative_to(self, white: Self) -> Self {
        let (a, b) = (self.estimate, white.estimate);
        let mean = a.mean / b.mean;
        // The error of a quotient to first order.
        let standard_error = (a.standard_error / b.mean).hypot(mean * b.standard_error / b.mean);
        let fewer = match (a.degrees_of_freedom, b.degrees_of_freedom) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (some, None) | (None, some) => some,
        };
        Self {
            estimate: Estimate { mean, standard_error, degrees_of_freedom: fewer },
            nonfinite: self.nonfinite + white.nonfinite,
            // As an error, but biases add up.
            cut_bias: (self.cut_bias + mean.abs() * white.cut_bias) / b.mean.abs(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_average_and_their_errors_add_in_quadrature() {
        let reading = Reading::from_pixels(&[1.0, 3.0, 5.0, 7.0], &[3.0, 0.0, 4.0, 0.0]);
        assert_eq!(reading, Reading { estimate: Estimate::new(4.0, 1.25), nonfinite: 0, cut_bias: 0.0 });
        let broken = Reading::from_pixels(&[1.0, f64::NAN, 3.0, 9.0], &[0.0, 0.0, 0.0, f64::INFINITY]);
        assert_eq!(broken, Reading { estimate: Estimate::new(2.0, 0.0), nonfinite: 2, cut_bias: 0.0 });
    }

    #[test]
    fn several_pictures_have_one_degree_of_freedom_less() {
        let reading = Reading::from_means(&[1.0, 2.0, 3.0], 0);
        assert_eq!(reading.estimate.degrees_of_freedom, Some(2.0));
        assert!((reading.estimate.standard_error - (1.0_f64 / 3.0).sqrt()).abs() < 1e-15);
        assert!(Reading::from_means(&[1.0], 0).estimate.standard_error.is_nan());
    }

    #[test]
    fn a_quotient_carries_both_errors() {
        let part = Reading { estimate: Estimate::new(3.0, 0.3), nonfinite: 1, cut_bias: 0.1 };
        let white = Estimate { degrees_of_freedom: Some(5.0), ..Estimate::new(2.0, 0.2) };
        let white = Reading { estimate: white, nonfinite: 2, cut_bias: 0.2 };
        let ratio = part.relative_to(white);
        assert_eq!(ratio.estimate.mean, 1.5);
        // Each is a tenth of its mean, so the quotient's is √2 tenths of it.
        assert!((ratio.estimate.standard_error - 0.15 * 2.0_f64.sqrt()).abs() < 1e-15);
        assert_eq!((ratio.estimate.degrees_of_freedom, ratio.nonfinite), (Some(5.0), 3));
        // The part is up to .1 more, the white up to .2: 3.1/2 − 3/2 and, to first order, 3/2 of .2/2.
        assert!((ratio.cut_bias - 0.2).abs() < 1e-15);
    }
}
