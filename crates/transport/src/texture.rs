//! Spectra that vary over a surface, as paths meet them.

use crate::spectral::PathSpectrum;
use etalon_optics::spectrum::RgbBasis;
use etalon_optics::{Lanes, Real, Spectrum};
use etalon_scene::{ImageTexture, SpectrumTexture};

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
    },
}

impl PathTexture {
    /// Prepares a texture for wavelengths within `range_nm`.
    pub fn new(texture: &SpectrumTexture, range_nm: [f64; 2]) -> Self {
        match texture {
            SpectrumTexture::Uniform(spectrum) => Self::Uniform(PathSpectrum::new(spectrum, range_nm)),
            SpectrumTexture::Image(texture) => Self::Image { texture: texture.clone(), basis: RgbBasis::get() },
        }
    }

    /// Values in every lane at texture coordinates.
    #[inline]
    pub fn lanes<R: Real, const N: usize>(&self, lambda_nm: &Lanes<f64, N>, uv: [f64; 2]) -> Lanes<R, N> {
        match self {
            Self::Uniform(spectrum) => spectrum.lanes(lambda_nm),
            Self::Image { texture, basis } => {
                let rgb = texture.eval(uv);
                Lanes::from_fn(|lane| R::from_f64(basis.reflectance(rgb, lambda_nm[lane])))
            }
        }
    }
}

impl From<PathSpectrum> for PathTexture {
    fn from(spectrum: PathSpectrum) -> Self {
        Self::Uniform(spectrum)
    }
}

/// What stands for a texture in a picture without textures: its mean.
pub(crate) fn mean(texture: &ImageTexture) -> Spectrum {
    let mean = texture.image.mean();
    let rgb = [0, 1, 2].map(|c| (mean[c] * texture.factor[c]).clamp(0.0, 1.0));
    Spectrum::rgb_reflectance(rgb).expect("a mean of reflectances is one")
}
