//! The numbers of materials that may depend on the wavelength.

use super::{Grating, Metal, PolarisingSheet, SpectrumTexture, ThinFilm};
use crate::measured::MeasuredSurface;
use crate::texture::ImageTexture;
use etalon_optics::{Fluorescence, RefractiveIndex};

/// A number of a material that may depend on the wavelength. What is done to every spectrum of a scene is done to these, and
/// need not know the materials.
#[derive(Debug)]
pub enum Parameter<'a> {
    /// A share of light that is reflected.
    Reflectance(&'a SpectrumTexture),
    /// The index of a metal.
    Metal(&'a Metal),
    /// The media behind and before an interface, whose indices decide which way light goes.
    Interface([&'a RefractiveIndex; 2]),
    /// The index of a coat or a pane, which decides how much light goes each way.
    Coat(&'a RefractiveIndex),
    /// A polarising sheet.
    Sheet(&'a PolarisingSheet),
    /// A thin film, which decides how much light goes each way.
    Film(&'a ThinFilm),
    /// A grating, which sends each wavelength its own way.
    Grating(&'a Grating),
    /// What comes back at another wavelength.
    Fluorescence(&'a Fluorescence),
    /// What was measured at some wavelengths.
    Measured(&'a MeasuredSurface),
    /// The index of a principled surface, which depolarises.
    Principled(&'a RefractiveIndex),
}

/// [`Parameter`], to be changed.
#[derive(Debug)]
pub enum ParameterMut<'a> {
    /// See [`Parameter::Reflectance`].
    Reflectance(&'a mut SpectrumTexture),
    /// See [`Parameter::Metal`].
    Metal(&'a mut Metal),
    /// See [`Parameter::Interface`].
    Interface([&'a mut RefractiveIndex; 2]),
    /// See [`Parameter::Coat`].
    Coat(&'a mut RefractiveIndex),
    /// See [`Parameter::Sheet`].
    Sheet(&'a mut PolarisingSheet),
    /// See [`Parameter::Film`].
    Film(&'a mut ThinFilm),
    /// See [`Parameter::Grating`].
    Grating(&'a mut Grating),
    /// See [`Parameter::Fluorescence`].
    Fluorescence(&'a mut Fluorescence),
    /// See [`Parameter::Measured`].
    Measured(&'a mut MeasuredSurface),
    /// See [`Parameter::Principled`].
    Principled(&'a mut RefractiveIndex),
}

impl<'a> Parameter<'a> {
    /// The image that varies it over a surface; of a film the first.
    pub fn image(self) -> Option<&'a ImageTexture> {
        match self {
            Self::Film(film) => film.images().next(),
            other => other.reflectance()?.image(),
        }
    }

    /// The share of light that it says is reflected, if it says one.
    pub fn reflectance(self) -> Option<&'a SpectrumTexture> {
        match self {
            Self::Reflectance(reflectance) | Self::Metal(Metal::Reflectance(reflectance)) => Some(reflectance),
            _ => None,
        }
    }
}

impl<'a> ParameterMut<'a> {
    /// The share of light that it says is reflected, if it says one.
    pub fn reflectance(self) -> Option<&'a mut SpectrumTexture> {
        match self {
            Self::Reflectance(reflectance) | Self::Metal(Metal::Reflectance(reflectance)) => Some(reflectance),
            _ => None,
        }
    }
}
