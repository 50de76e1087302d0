//! Spectral bands of a file.

use etalon_optics::colour::{CIE_RANGE_NM, xyz_of};

use crate::{Picture, PictureError};

/// A spectral band of a picture: the radiance `S0` about a wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectralBand<'a> {
    /// Its channel, such as `S0.550,000000nm`.
    pub channel: &'a str,
    /// The wavelength at its centre, nm.
    pub centre_nm: f64,
    /// Its samples.
    pub samples: &'a [f32],
}

/// The spectral bands of a picture, by increasing wavelength. They are the channels `S0.…` in the layout of Fichet, Pacanowski &
/// Wilkie 2021 (*An OpenEXR Layout for Spectral Images*, JCGT 10(3)): a number with a decimal comma, and `nm`, `um`, `mm` or `m`.
///
/// ```
/// use etalon_picture::Picture;
/// use etalon_picture::develop::bands_of;
///
/// let mut picture = Picture::new(1, 1)?;
/// for name in ["S0.0,6um", "R", "S0.550,000000nm", "Error.S0.550,000000nm"] {
///     picture.insert(name, vec![1.0])?;
/// }
/// let centres: Vec<f64> = bands_of(&picture).iter().map(|band| band.centre_nm).collect();
/// assert_eq!(centres, [550.0, 600.0]);
/// # Ok::<(), etalon_picture::PictureError>(())
/// ```
#[must_use]
pub fn bands_of(picture: &Picture<f32>) -> Vec<SpectralBand<'_>> {
    let mut bands: Vec<SpectralBand<'_>> = picture
        .channels()
        .iter()
        .filter_map(|channel| {
            let centre_nm = wavelength_nm(&channel.name)?;
            Some(SpectralBand { channel: &channel.name, centre_nm, samples: &channel.samples })
        })
        .collect();
    bands.sort_by(|a, b| a.centre_nm.total_cmp(&b.centre_nm));
    bands
}

fn wavelength_nm(channel: &str) -> Option<f64> {
    let text = channel.strip_prefix("S0.")?;
    let digits = text.find(|c: char| !(c.is_ascii_digit() || c == ',')).unwrap_or(text.len());
    let (number, unit) = text.split_at(digits);
    let per_nm = match unit {
        "nm" => 1.0,
        "um" => 1e3,
        "mm" => 1e6,
        "m" => 1e9,
        _ => return None,
    };
    let centre: f64 = number.replace(',', ".").parse().ok()?;
    (centre > 0.0 && centre.is_finite()).then_some(centre * per_nm)
}

/// The band that holds a wavelength: that with the nearest centre. Each band reaches half-way to its neighbours, and the outer ones as far
/// outward as inward. A single band reaches 0.5 nm to each side, because its width is not known.
///
/// # Errors
/// A picture without bands, or whose bands do not reach this wavelength.
///
/// ```
/// use etalon_picture::Picture;
/// use etalon_picture::develop::band_at;
///
/// let mut picture = Picture::new(1, 1)?;
/// for name in ["S0.500,000000nm", "S0.520,000000nm"] {
///     picture.insert(name, vec![1.0])?;
/// }
/// assert_eq!(band_at(&picture, 508.0)?.centre_nm, 500.0);
/// assert!(band_at(&picture, 531.0).is_err());
/// # Ok::<(), etalon_picture::PictureError>(())
/// ```
pub fn band_at(picture: &Picture<f32>, wavelength: f64) -> Result<SpectralBand<'_>, PictureError> {
    let bands = bands_of(picture);
    let [Some(first), Some(last)] = [bands.first(), bands.last()] else {
        return Err(no_bands());
    };
    let edges = band_edges_nm(&bands);
    if !(edges[0] <= wavelength && wavelength <= edges[bands.len()]) {
        return Err(PictureError::develop(format!(
            "no band holds {wavelength} nm: the {} bands have centres from {} to {} nm",
            bands.len(),
            first.centre_nm,
            last.centre_nm
        )));
    }
    let distance = |band: &SpectralBand<'_>| (band.centre_nm - wavelength).abs();
    let nearest = bands.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
    Ok(nearest.expect("there is a first one"))
}

pub(crate) fn no_bands() -> PictureError {
    PictureError::develop(
        "the file has no spectral bands (channels such as `S0.550,000000nm`): render with `--bands 400:700:10`",
    )
}

/// Where the bands begin and end, nm: one more than there are bands.
pub(crate) fn band_edges_nm(bands: &[SpectralBand<'_>]) -> Vec<f64> {
    let centre = |i: usize| bands[i].centre_nm;
    let last = bands.len() - 1;
    if last == 0 {
        return vec![centre(0) - 0.5, centre(0) + 0.5];
    }
    let mut edges = vec![1.5 * centre(0) - 0.5 * centre(1)];
    edges.extend((0..last).map(|i| 0.5 * (centre(i) + centre(i + 1))));
    edges.push(1.5 * centre(last) - 0.5 * centre(last - 1));
    edges
}

/// What a radiance of 1 in each band adds to X, Y and Z.
pub(crate) fn colour_weights(bands: &[SpectralBand<'_>]) -> Vec<[f64; 3]> {
    let edges = band_edges_nm(bands);
    (0..bands.len())
        .map(|i| {
            // The observer is summed in cells of 1 nm; a cell counts by the part of it that the band covers.
            let part = |nm: f64| ((nm + 0.5).min(edges[i + 1]) - (nm - 0.5).max(edges[i])).clamp(0.0, 1.0);
            let visible = edges[i] < CIE_RANGE_NM[1] + 0.5 && edges[i + 1] > CIE_RANGE_NM[0] - 0.5;
            if visible { xyz_of(part) } else { [0.0; 3] }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_bands_are_read_and_others_are_not() {
        for (name, nm) in
            [("S0.550,000000nm", 550.0), ("S0.400,25nm", 400.25), ("S0.700nm", 700.0), ("S0.0,000001m", 1000.0)]
        {
            assert!((wavelength_nm(name).unwrap() - nm).abs() < 1e-9, "{name}");
        }
        for name in [
            "S1.550,000000nm",
            "S0.R",
            "S0.nm",
            "S0.1,2,3nm",
            "S0.-5nm",
            "S0.0nm",
            "T.550nm",
            "S0.550,0THz",
            "S0.550nmx",
            "",
        ] {
            assert_eq!(wavelength_nm(name), None, "{name}");
        }
    }

    #[test]
    fn weights_of_bands_share_out_the_observer() {
        let names: Vec<String> = [350, 380, 400, 555, 556, 900].iter().map(|nm| format!("S0.{nm}nm")).collect();
        let mut picture = Picture::new(1, 1).unwrap();
        names.iter().for_each(|name| picture.insert(name, vec![1.0]).unwrap());
        let bands = bands_of(&picture);
        let weights = colour_weights(&bands);
        let sum: [f64; 3] = std::array::from_fn(|c| weights.iter().map(|w| w[c]).sum());
        let whole = xyz_of(|_| 1.0);
        assert!((0..3).all(|c| (sum[c] - whole[c]).abs() < 1e-6 * whole[c]), "{sum:?} {whole:?}");
    }

    #[test]
    fn a_band_reaches_half_way_to_its_neighbours() {
        let mut picture = Picture::new(1, 1).unwrap();
        for nm in [500, 511, 550] {
            picture.insert(&format!("S0.{nm}nm"), vec![1.0]).unwrap();
        }
        // From 494.5 nm to 505.5 nm: eleven whole cells of the observer.
        let first = colour_weights(&bands_of(&picture))[0];
        let expected = xyz_of(|nm| f64::from(u8::from((495.0..=505.0).contains(&nm))));
        assert!((0..3).all(|c| (first[c] - expected[c]).abs() < 1e-15), "{first:?} {expected:?}");
        assert_eq!(band_at(&picture, 530.0).unwrap().centre_nm, 511.0);
        assert_eq!(band_at(&picture, 569.0).unwrap().centre_nm, 550.0);
        assert!(band_at(&picture, 570.0).is_err() && band_at(&picture, 494.0).is_err());
    }

    #[test]
    fn a_single_band_is_found_by_its_own_wavelength_only() {
        let mut picture = Picture::new(1, 1).unwrap();
        assert!(band_at(&picture, 550.0).unwrap_err().to_string().contains("--bands"));
        picture.insert("S0.550,000000nm", vec![1.0]).unwrap();
        assert_eq!(band_at(&picture, 550.4).unwrap().centre_nm, 550.0);
        let error = band_at(&picture, 560.0).unwrap_err().to_string();
        assert!(error.contains("560 nm") && error.contains("550 to 550 nm"), "{error}");
        assert!(band_at(&picture, f64::NAN).is_err());
    }
}
