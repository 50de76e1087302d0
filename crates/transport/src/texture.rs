//! Spectra that vary over a surface, as paths meet them.

use crate::spectral::PathSpectrum;
use etalon_optics::colour::rec709_luminance;
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
    /// The colours of the vertices around, as reflectances.
    VertexColours {
        /// Factor on each channel.
        factor: [f64; 3],
        /// Whether a grey of the same luminance is shown instead.
        grey: bool,
        /// An image by which they are multiplied.
        image: Option<Box<ImageTexture>>,
        /// What the channels are at each wavelength.
        basis: RgbBasis,
    },
}

/// A place of a surface, as textures see it.
#[derive(Clone, Copy, Debug)]
pub struct TexturePoint {
    /// Texture coordinates; 0 on a surface without.
    pub uv: [f64; 2],
    /// The colour between the vertices around; white on a surface without.
    pub colour: [f64; 3],
}

impl TexturePoint {
    /// Of a surface whose vertices have no colours.
    pub const fn of_uv(uv: [f64; 2]) -> Self {
        Self { uv, colour: [1.0; 3] }
    }
}

impl PathTexture {
    /// Prepares a texture for wavelengths within `range_nm`.
    pub fn new(texture: &SpectrumTexture, range_nm: [f64; 2]) -> Self {
        match texture {
            SpectrumTexture::Uniform(spectrum) => Self::Uniform(PathSpectrum::new(spectrum, range_nm)),
            SpectrumTexture::Image(texture) => {
                Self::Image { texture: texture.clone(), basis: RgbBasis::get(), mean: texture.mean() }
            }
            SpectrumTexture::VertexColours { factor, grey, image } => {
                Self::VertexColours { factor: *factor, grey: *grey, image: image.clone(), basis: RgbBasis::get() }
            }
        }
    }

    /// The value at a wavelength, nm: of an image that of its mean colour, of the colours of vertices that of grey ones.
    pub(crate) fn mean(&self, wavelength_nm: f64) -> f64 {
        match self {
            Self::Uniform(spectrum) => spectrum.eval(wavelength_nm),
            Self::Image { basis, mean, .. } => basis.reflectance(*mean, wavelength_nm),
            Self::VertexColours { factor, basis, .. } => {
                basis.reflectance(factor.map(|f| (0.5 * f).min(1.0)), wavelength_nm)
            }
        }
    }

    /// Values in every lane at a place.
    #[inline]
    pub fn lanes<const N: usize>(&self, lambda_nm: &Lanes<f64, N>, at: TexturePoint) -> Lanes<f64, N> {
        match self {
            Self::Uniform(spectrum) => spectrum.lanes(lambda_nm),
            Self::Image { basis, .. } | Self::VertexColours { basis, .. } => {
                let rgb = self.colour(at).unwrap_or([0.0; 3]);
                Lanes::from_fn(|lane| basis.reflectance(rgb, lambda_nm[lane]))
            }
        }
    }

    /// The colour at a place, of an image or of the vertices around.
    #[inline]
    pub(crate) fn colour(&self, at: TexturePoint) -> Option<[f64; 3]> {
        let (factor, grey, image) = match self {
            Self::Uniform(_) => return None,
            Self::Image { texture, .. } => return Some(texture.eval(at.uv)),
            Self::VertexColours { factor, grey, image, .. } => (factor, grey, image),
        };
        let mut rgb = [0, 1, 2].map(|c| at.colour[c] * factor[c]);
        if let Some(image) = image {
            let shown = image.eval(at.uv);
            rgb = [0, 1, 2].map(|c| rgb[c] * shown[c]);
        }
        Some(if *grey { [rec709_luminance(rgb); 3] } else { rgb })
    }

    /// The spectrum, if it is the same everywhere.
    pub(crate) fn uniform(&self) -> Option<&PathSpectrum> {
        match self {
            Self::Uniform(spectrum) => Some(spectrum),
            Self::Image { .. } | Self::VertexColours { .. } => None,
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

/// The reflectance of vertices of one colour, with a factor on its channels.
pub(crate) fn vertex_colour(factor: [f64; 3], colour: [f64; 3]) -> Spectrum {
    let rgb = [0, 1, 2].map(|c| (factor[c] * colour[c]).clamp(0.0, 1.0));
    Spectrum::rgb_reflectance(rgb).expect("it lies from 0 to 1")
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
        SpectrumTexture::VertexColours { factor, .. } => Cow::Owned(vertex_colour(*factor, [0.5; 3])),
    }
}
