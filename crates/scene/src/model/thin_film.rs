//! Thin films on surfaces, in which light interferes with itself.

use super::NumberTexture;
use crate::texture::ImageTexture;
use etalon_optics::{Complex, ComplexIndex, RefractiveIndex};

/// Layers on a surface so thin that the waves which their faces reflect interfere.
#[derive(Clone, Debug, PartialEq)]
pub struct ThinFilm {
    /// The layers, at least one, from the outermost to the innermost: the first is met first by light that comes from the side that the
    /// surface normal points into, and of a metal or a pane by all light from without.
    pub layers: Vec<FilmLayer>,
    /// Given, every wavelength is treated as this one is, nm: for pictures without colours.
    pub at_nm: Option<f64>,
}

/// A layer of a thin film.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmLayer {
    /// Its thickness, nm, at least 0.
    pub thickness_nm: NumberTexture,
    /// What it is made of.
    pub index: FilmIndex,
}

/// What a layer is made of.
#[derive(Clone, Debug, PartialEq)]
pub enum FilmIndex {
    /// A medium that absorbs nothing.
    Transparent(RefractiveIndex),
    /// One that may absorb.
    Absorbing(ComplexIndex),
}

impl FilmIndex {
    /// n + ik at a wavelength in vacuum, nm.
    #[inline]
    pub fn eval(&self, wavelength_nm: f64) -> Complex {
        match self {
            Self::Transparent(index) => Complex::real(index.eval(wavelength_nm)),
            Self::Absorbing(index) => {
                let (n, k) = index.eval(wavelength_nm);
                Complex::new(n, k)
            }
        }
    }
}

impl ThinFilm {
    /// The images of its thickness.
    pub fn images(&self) -> impl Iterator<Item = &ImageTexture> {
        self.layers.iter().filter_map(|layer| layer.thickness_nm.image())
    }

    /// The thickness of all layers, nm: the mean of an image.
    pub fn mean_thickness_nm(&self) -> f64 {
        self.layers.iter().map(|layer| layer.thickness_nm.mean()).sum()
    }

    /// Replaces each image by the mean of its texels.
    pub fn flatten(&mut self) {
        for layer in &mut self.layers {
            layer.thickness_nm = layer.thickness_nm.mean().into();
        }
    }
}
