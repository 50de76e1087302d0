//! The colour that a file holds, as linear Rec. 709, and its unit.

use etalon_optics::colour::{
    LUMINOUS_EFFICACY, REC709_FROM_XYZ, XYZ_FROM_REC709, cie_y_integral_nm, multiply, product, rec709_from_xyz,
    xyz_from_rgb,
};

use super::band;
use crate::{Attribute, Attributes, Chromaticities, ExrFile, Picture, PictureError, Sample};

/// Luminous efficacy of radiation at 540 THz as CIE 018:2019 states it for the maximum of the photopic V(λ), lm/W.
const LUMINOUS_EFFICACY_LM_W: f64 = LUMINOUS_EFFICACY;

/// The colour of a file as linear Rec. 709, in channels `R`, `G`, `B`. It is, in this order of preference:
///
/// - `R`, `G`, `B`, converted from the primaries that the attribute `chromaticities` states, if they are others;
/// - `X`, `Y`, `Z`: CIE 1931 XYZ;
/// - `Y` alone: grey;
/// - spectral bands `S0.550,000000nm` …: Σ Lᵢ ∫ x̄ȳz̄ dλ / ∫ ȳ dλ over the bands, each of which reaches half-way to its neighbours.
///
/// # Errors
/// A file with none of these; chromaticities that are no triangle.
///
/// ```
/// use etalon_picture::develop::colour_of;
/// use etalon_picture::{Attributes, ExrFile, Picture};
///
/// let mut picture = Picture::new(1, 1)?;
/// for (name, value) in [("X", 0.9505_f32), ("Y", 1.0), ("Z", 1.0891)] {
///     picture.insert(name, vec![value])?;
/// }
/// let white = colour_of(&ExrFile { picture, attributes: Attributes::new() })?;
/// assert!((white.require("R")?[0] - 1.0).abs() < 1e-3);
/// # Ok::<(), etalon_picture::PictureError>(())
/// ```
pub fn colour_of(file: &ExrFile) -> Result<Picture<f32>, PictureError> {
    let picture = &file.picture;
    let find = |names: [&str; 3]| -> Option<[&[f32]; 3]> {
        let [a, b, c] = names.map(|name| picture.channel(name));
        Some([a?, b?, c?])
    };
    let of = |rgb: &dyn Fn(usize) -> [f64; 3]| {
        let pixels: Vec<[f32; 3]> = (0..picture.width() * picture.height()).map(|i| rgb(i).map(|v| v as f32)).collect();
        Picture::from_rgb(picture.width(), picture.height(), &pixels)
    };
    let at = |channels: [&[f32]; 3], i: usize| channels.map(|channel| f64::from(channel[i]));
    if let Some(rgb) = find(["R", "G", "B"]) {
        let Some(matrix) = foreign_primaries(&file.attributes)? else {
            return of(&|i| at(rgb, i));
        };
        let matrix = product(&REC709_FROM_XYZ, &matrix);
        return of(&|i| multiply(&matrix, at(rgb, i)));
    }
    if let Some(xyz) = find(["X", "Y", "Z"]) {
        return of(&|i| rec709_from_xyz(at(xyz, i)));
    }
    if let Some(y) = picture.channel("Y") {
        return of(&|i| [f64::from(y[i]); 3]);
    }
    let bands = band::bands_of(picture);
    if bands.is_empty() {
        // Says which channels there are.
        picture.require("R")?;
        return Err(PictureError::develop("the file has a channel `R`, but not `G` and `B` beside it"));
    }
    let weights = band::colour_weights(&bands);
    of(&|i| {
        let mut xyz = [0.0; 3];
        for (band, weights) in bands.iter().zip(&weights) {
            let value = f64::from(band.samples[i]);
            // A band outside of what the eye sees has no part in the colour, whatever its value.
            if *weights != [0.0; 3] {
                (0..3).for_each(|c| xyz[c] += weights[c] * value);
            }
        }
        rec709_from_xyz(xyz)
    })
}

/// What takes the file's R, G, B to XYZ, if they are not of Rec. 709.
fn foreign_primaries(attributes: &Attributes) -> Result<Option<[[f64; 3]; 3]>, PictureError> {
    let Some(Attribute::Chromaticities(c)) = attributes.get("chromaticities") else { return Ok(None) };
    if *c == Chromaticities::REC_709 {
        return Ok(None);
    }
    let wide = |xy: [f32; 2]| xy.map(f64::from);
    let matrix = xyz_from_rgb([c.red, c.green, c.blue].map(wide), wide(c.white));
    match matrix {
        Some(matrix) => Ok(Some(matrix)),
        None => {
            Err(PictureError::develop("the `chromaticities` of the file are not three primaries with a white inside"))
        }
    }
}

/// The weights of R, G and B of a file in its luminance Y.
pub(crate) fn luminance_weights(attributes: &Attributes) -> Result<[f64; 3], PictureError> {
    Ok(foreign_primaries(attributes)?.unwrap_or(XYZ_FROM_REC709)[1])
}

/// Luminance Y of linear Rec. 709, in the unit of R, G and B.
pub(crate) fn luminance(rgb: [f64; 3]) -> f64 {
    multiply(&XYZ_FROM_REC709, rgb)[1]
}

/// The pixels of channels `R`, `G`, `B`.
pub(crate) fn rgb_pixels<T: Sample>(picture: &Picture<T>) -> Result<impl Iterator<Item = [f64; 3]>, PictureError> {
    let channels = [picture.require("R")?, picture.require("G")?, picture.require("B")?];
    Ok((0..channels[0].len()).map(move |i| channels.map(|channel| channel[i].to_f64())))
}

/// The luminance in cd/m² that Y = 1 of a file stands for, if the file says it:
///
/// - 683.002 lm/W · ∫ ȳ dλ = 72,983.5 in a render of Etalon, and in a spectral file with its unit (`emissiveUnits`), where
///   a radiance of 1 W·m⁻²·sr⁻¹·nm⁻¹ at every wavelength has Y = 1;
/// - the attribute `whiteLuminance` of OpenEXR, in other files.
///
/// ```
/// use etalon_picture::Attribute;
/// use etalon_picture::develop::luminance_unit;
///
/// let software = Attribute::Text("etalon 0.1.0".to_owned());
/// let unit = luminance_unit(&[("software".to_owned(), software)].into()).unwrap();
/// assert!((unit - 72_983.5).abs() < 0.1);
/// assert_eq!(luminance_unit(&Default::default()), None);
/// ```
#[must_use]
pub fn luminance_unit(attributes: &Attributes) -> Option<f64> {
    if is_radiance(attributes) {
        return Some(LUMINOUS_EFFICACY_LM_W * cie_y_integral_nm());
    }
    match attributes.get("whiteLuminance") {
        Some(Attribute::Float(nits)) if nits.is_finite() && *nits > 0.0 => Some(f64::from(*nits)),
        _ => None,
    }
}

/// Whether the file says that its numbers are radiances in W·m⁻²·sr⁻¹·nm⁻¹: a render of Etalon does (`software`), and a spectral file with the
/// attribute `emissiveUnits`.
///
/// ```
/// use etalon_picture::Attribute;
/// use etalon_picture::develop::is_radiance;
///
/// let unit = Attribute::Text("W.m^-2.sr^-1".to_owned());
/// assert!(is_radiance(&[("emissiveUnits".to_owned(), unit)].into()));
/// assert!(!is_radiance(&Default::default()));
/// ```
#[must_use]
pub fn is_radiance(attributes: &Attributes) -> bool {
    let text = |name: &str| match attributes.get(name) {
        Some(Attribute::Text(text)) => text.as_str(),
        _ => "",
    };
    text("software").starts_with("etalon ") || text("emissiveUnits") == "W.m^-2.sr^-1"
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(channels: &[(&str, f32)], attributes: Attributes) -> ExrFile {
        let mut picture = Picture::new(1, 1).unwrap();
        channels.iter().for_each(|(name, value)| picture.insert(name, vec![*value]).unwrap());
        ExrFile { picture, attributes }
    }

    fn rgb(file: &ExrFile) -> [f64; 3] {
        rgb_pixels(&colour_of(file).unwrap()).unwrap().next().unwrap()
    }

    fn with_chromaticities(c: Chromaticities) -> Attributes {
        Attributes::from([("chromaticities".to_owned(), Attribute::Chromaticities(c))])
    }

    #[test]
    fn rec_709_is_taken_bit_by_bit() {
        let channels = [("R", 0.1), ("G", -0.2), ("B", 3e38), ("Y", 7.0), ("X", 1.0), ("Z", 2.0)];
        for attributes in [Attributes::new(), with_chromaticities(Chromaticities::REC_709)] {
            assert_eq!(rgb(&file(&channels, attributes)), [0.1_f32, -0.2, 3e38].map(f64::from));
        }
    }

    #[test]
    fn other_primaries_are_converted() {
        let wide = Chromaticities {
            red: [0.708, 0.292],
            green: [0.170, 0.797],
            blue: [0.131, 0.046],
            white: [0.3127, 0.3290],
        };
        let attributes = with_chromaticities(wide);
        let white = rgb(&file(&[("R", 0.5), ("G", 0.5), ("B", 0.5)], attributes.clone()));
        assert!(white.iter().all(|v| (v - 0.5).abs() < 1e-6), "{white:?}");
        // The green of Rec. 2020 lies outside of Rec. 709. ITU-R BT.2087-0, the inverse of its matrix.
        let green = rgb(&file(&[("R", 0.0), ("G", 1.0), ("B", 0.0)], attributes.clone()));
        for (found, expected) in green.iter().zip([-0.5876, 1.1329, -0.1006]) {
            assert!((found - expected).abs() < 2e-4, "{green:?}");
        }
        assert!((luminance_weights(&attributes).unwrap()[1] - 0.6780).abs() < 5e-5);
        let line = Chromaticities { red: [0.3, 0.3], green: [0.3, 0.3], ..wide };
        let error = colour_of(&file(&[("R", 0.0), ("G", 1.0), ("B", 0.0)], with_chromaticities(line))).unwrap_err();
        assert!(error.to_string().contains("chromaticities"), "{error}");
    }

    #[test]
    fn grey_and_spectral_files_have_colours() {
        assert_eq!(rgb(&file(&[("Y", 0.25)], Attributes::new())), [0.25; 3]);
        // A flat spectrum over all that the eye sees is the equal-energy white.
        let names: Vec<String> = (0..=48).map(|i| format!("S0.{},000000nm", 360 + 10 * i)).collect();
        let channels: Vec<(&str, f32)> = names.iter().map(|name| (name.as_str(), 2.0)).collect();
        let found = rgb(&file(&channels, Attributes::new()));
        let expected = rec709_from_xyz(etalon_optics::colour::xyz_of(|_| 2.0));
        assert!((0..3).all(|c| (found[c] - expected[c]).abs() < 1e-4), "{found:?} {expected:?}");
    }

    #[test]
    fn what_is_no_colour_is_refused_with_what_there_is() {
        let error = colour_of(&file(&[("depth", 1.0), ("alpha", 1.0)], Attributes::new())).unwrap_err().to_string();
        assert!(error.contains("depth, alpha"), "{error}");
        let error = colour_of(&file(&[("R", 1.0)], Attributes::new())).unwrap_err().to_string();
        assert!(error.contains("not `G`"), "{error}");
    }
}
