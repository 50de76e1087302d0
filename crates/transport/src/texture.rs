//! Spectra that vary over a surface, as paths meet them.

use crate::spectral::PathSpectrum;
use etalon_optics::spectrum::RgbBasis;
use etalon_optics::{Illuminant, Lanes, Spectrum};
use etalon_scene::{ImageTexture, SpectrumTexture};
use std::borrow::Cow;

/// A reflectance prepared for paths, perhaps another one at each place.
#[derive(Clone, Debug)]
pub enum PathTexture {
    /// The same everywhere.
    Uniform(PathSpectrum),
    /// The colours of an image, as reflectances.
    Image {
        /// The image.
        texture: ImageTexture,
        /// What its channels are at each wavelength.
        basis: RgbBasis,
        /// The mean of its texels.
        mean: [f64; 3],
    },
}

impl PathTexture {
    /// Prepares a texture for wavelengths within `range_nm`.
    pub fn new(texture: &SpectrumTexture, range_nm: [f64; 2]) -> Self {
        match texture {
            SpectrumTexture::Uniform(spectrum) => Self::Uniform(PathSpectrum::new(spectrum, range_nm)),
            SpectrumTexture::Image(texture) => {
                Self::Image { texture: texture.clone(), basis: RgbBasis::get(), mean: texture.mean() }
            }
        }
    }

    /// The value at a wavelength, nm, of an image that of its mean colour.
    pub(crate) fn mean(&self, wavelength_nm: f64) -> f64 {
        match self {
            Self::Uniform(spectrum) => spectrum.eval(wavelength_nm),
            Self::Image { basis, mean, .. } => basis.reflectance(*mean, wavelength_nm),
        }
    }

    /// Values in every lane at texture coordinates.
    #[inline]
    pub fn lanes<const N: usize>(&self, lambda_nm: &Lanes<f64, N>, uv: [f64; 2]) -> Lanes<f64, N> {
        match self {
            Self::Uniform(spectrum) => spectrum.lanes(lambda_nm),
            Self::Image { texture, basis, .. } => {
                let rgb = texture.eval(uv);
                Lanes::from_fn(|lane| basis.reflectance(rgb, lambda_nm[lane]))
            }
        }
    }
}

impl From<PathSpectrum> for PathTexture {
    fn from(spectrum: PathSpectrum) -> Self {
        Self::Uniform(spectrum)
    }
}

/// What stands for an image in a picture without textures: its mean.
pub(crate) fn mean_colour(texture: &ImageTexture) -> Spectrum {
    let rgb = texture.mean().map(|v| v.clamp(0.0, 1.0));
    Spectrum::rgb_reflectance(rgb).expect("a mean of reflectances is one")
}

/// What stands there for an image of what a surface emits.
pub(crate) fn mean_emission(texture: &ImageTexture) -> Spectrum {
    Spectrum::rgb_emission(texture.mean(), Illuminant::D65).expect("a mean of emissions is one")
}

/// A reflectance as a spectrum; of an image that of its mean colour.
pub(crate) fn mean(reflectance: &SpectrumTexture) -> Cow<'_, Spectrum> {
    match reflectance {
        SpectrumTexture::Uniform(spectrum) => Cow::Borrowed(spectrum),
        SpectrumTexture::Image(texture) => Cow::Owned(mean_colour(texture)),
    }
}
