//! Numbers and spectra that may vary over a surface.

use crate::texture::ImageTexture;
use etalon_optics::Spectrum;

/// A number that may vary over a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum NumberTexture {
    /// The same everywhere.
    Uniform(f64),
    /// An image; its first channel counts.
    Image(ImageTexture),
}

impl NumberTexture {
    /// The number at texture coordinates.
    #[inline]
    pub fn eval(&self, uv: [f64; 2]) -> f64 {
        match self {
            Self::Uniform(number) => *number,
            Self::Image(texture) => texture.eval(uv)[0],
        }
    }

    /// The number, or the mean of the image's texels.
    pub fn mean(&self) -> f64 {
        match self {
            Self::Uniform(number) => *number,
            Self::Image(texture) => texture.image.mean()[0] * texture.factor[0],
        }
    }

    /// Its image, if it has one.
    pub fn image(&self) -> Option<&ImageTexture> {
        match self {
            Self::Uniform(_) => None,
            Self::Image(texture) => Some(texture),
        }
    }
}

impl From<f64> for NumberTexture {
    fn from(number: f64) -> Self {
        Self::Uniform(number)
    }
}

/// A spectrum that may vary over a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum SpectrumTexture {
    /// The same everywhere.
    Uniform(Spectrum),
    /// An image, whose colours are reflectances of a linear Rec. 709 colour under D65 in [0, 1]
    /// ([`RgbBasis`](etalon_optics::spectrum::RgbBasis)).
    Image(ImageTexture),
    /// The colours of the vertices of a mesh, interpolated over each triangle; reflectances like those of an image.
    VertexColours {
        /// Factor on each channel.
        factor: [f64; 3],
        /// Whether a grey of the same luminance is shown instead.
        grey: bool,
        /// An image by which they are multiplied.
        image: Option<Box<ImageTexture>>,
    },
}

impl SpectrumTexture {
    /// Whether it is known to be zero everywhere.
    pub fn is_zero(&self) -> bool {
        match self {
            Self::Uniform(spectrum) => spectrum.is_zero(),
            Self::Image(texture) => texture.factor == [0.0; 3],
            Self::VertexColours { factor, .. } => *factor == [0.0; 3],
        }
    }

    /// Whether it is the same at every wavelength, as far as is known.
    pub fn is_grey(&self) -> bool {
        match self {
            Self::Uniform(spectrum) => spectrum.is_constant(),
            Self::Image(texture) => texture.is_grey(),
            Self::VertexColours { grey, .. } => *grey,
        }
    }

    /// Its image, if it has one.
    pub fn image(&self) -> Option<&ImageTexture> {
        match self {
            Self::Uniform(_) => None,
            Self::Image(texture) => Some(texture),
            Self::VertexColours { image, .. } => image.as_deref(),
        }
    }

    /// The factor on the colours of the vertices, if it shows these.
    pub fn vertex_colours(&self) -> Option<[f64; 3]> {
        match self {
            Self::VertexColours { factor, .. } => Some(*factor),
            Self::Uniform(_) | Self::Image(_) => None,
        }
    }
}

impl From<Spectrum> for SpectrumTexture {
    fn from(spectrum: Spectrum) -> Self {
        Self::Uniform(spectrum)
    }
}
