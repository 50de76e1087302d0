//! Spectra that show a given linear Rec. 709 colour.

use super::sigmoid::{Sigmoid, fit};
use super::{Illuminant, Spectrum};
use crate::Lanes;
use crate::colour::{
    CIE_RANGE_NM, REC709_FROM_XYZ, cie_y_integral_nm, colour_matching_rows, inverse, multiply, rgb_to_xyz_matrix,
    xyz_of,
};
use crate::error::{OpticsError, non_negative};
use std::sync::LazyLock;

/// A shape in [0, 1]: flat, or a sigmoid of a quadratic.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    /// The same at every wavelength.
    Flat(f64),
    /// A smooth curve.
    Smooth(Sigmoid),
}

impl Shape {
    #[inline]
    fn eval(&self, wavelength_nm: f64) -> f64 {
        match self {
            Self::Flat(v) => *v,
            Self::Smooth(s) => s.eval(wavelength_nm),
        }
    }

    fn max_over(&self, range_nm: [f64; 2]) -> f64 {
        match self {
            Self::Flat(v) => *v,
            Self::Smooth(s) => s.max_over(range_nm),
        }
    }
}

/// What one unit of reflectance in each 1 nm step adds to the RGB that `from_xyz` makes of the reflected light.
fn observer(white: Illuminant, from_xyz: &[[f64; 3]; 3]) -> Vec<[f64; 3]> {
    let rows = colour_matching_rows().iter().enumerate();
    rows.map(|(i, row)| {
        let weight = white.eval(CIE_RANGE_NM[0] + i as f64) / cie_y_integral_nm();
        multiply(from_xyz, row.map(|v| v * weight))
    })
    .collect()
}

static REFLECTANCE_OBSERVER: LazyLock<Vec<[f64; 3]>> = LazyLock::new(|| {
    let white = xyz_of(|nm| Illuminant::D65.eval(nm));
    observer(Illuminant::D65, &inverse(&rgb_to_xyz_matrix(white)))
});

/// A reflectance that shows a linear Rec. 709 colour under D65, upsampled after Jakob & Hanika 2019.
///
/// The colour is relative to the perfect reflector: its white is D65 as the CIE tabulates it, not the four-digit
/// chromaticity of Rec. 709 (see [`crate::colour`]). Hence a grey (v, v, v) is exactly the constant v, white exactly 1 and
/// black exactly 0; a picture of a surface under D65 shows its RGB to 3·10⁻⁴.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RgbReflectance {
    rgb: [f64; 3],
    shape: Shape,
    round_trip_error: f64,
}

impl RgbReflectance {
    /// A reflectance that shows this linear Rec. 709 colour under D65.
    ///
    /// Fails if a channel is not finite or outside [0, 1].
    pub fn new(rgb: [f64; 3]) -> Result<Self, OpticsError> {
        for value in rgb {
            let what = "a channel of an RGB reflectance";
            if non_negative(what, value)? > 1.0 {
                return Err(OpticsError::AboveOne { what, value });
            }
        }
        if rgb[0] == rgb[1] && rgb[1] == rgb[2] {
            return Ok(Self { rgb, shape: Shape::Flat(rgb[0]), round_trip_error: 0.0 });
        }
        let (sigmoid, round_trip_error) = fit(&REFLECTANCE_OBSERVER, rgb);
        Ok(Self { rgb, shape: Shape::Smooth(sigmoid), round_trip_error })
    }

    /// The colour asked for, linear Rec. 709.
    pub fn rgb(&self) -> [f64; 3] {
        self.rgb
    }

    /// Largest difference in a channel between the colour asked for and the colour shown under D65.
    pub fn round_trip_error(&self) -> f64 {
        self.round_trip_error
    }

    /// Reflectance at a wavelength in nm, in [0, 1].
    #[inline]
    pub fn eval(&self, wavelength_nm: f64) -> f64 {
        self.shape.eval(wavelength_nm)
    }

    /// Reflectance in every lane.
    #[inline(always)]
    pub fn lanes<const N: usize>(&self, wavelengths_nm: &Lanes<f64, N>) -> Lanes<f64, N> {
        match &self.shape {
            Shape::Flat(v) => Lanes::splat(*v),
            Shape::Smooth(s) => Lanes::from_fn(|lane| s.eval(wavelengths_nm[lane])),
        }
    }

    pub(super) fn max_over(&self, range_nm: [f64; 2]) -> f64 {
        self.shape.max_over(range_nm)
    }

    pub(super) fn is_constant(&self) -> bool {
        matches!(self.shape, Shape::Flat(_))
    }
}

/// A light that shows a linear Rec. 709 colour: m · s(λ) · W(λ), with s the sigmoid of Jakob & Hanika 2019 and W an
/// illuminant of luminance 1.
///
/// What a picture in linear Rec. 709 shows of it is the colour asked for, whatever the illuminant: that one only gives the
/// spectrum its structure. m is twice the largest channel, or as many times doubled as it takes for s to reach the colour
/// (blue under illuminant A).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RgbEmission {
    rgb: [f64; 3],
    white: Illuminant,
    factor: f64,
    shape: Shape,
}

/// Largest error of a channel, relative to the largest channel, at which a fit counts as found.
const REACHED: f64 = 1e-9;

impl RgbEmission {
    /// A light of this linear Rec. 709 colour; (1, 1, 1) has the luminance of the constant spectrum 1.
    ///
    /// Fails if a channel is negative or not finite, or if no smooth spectrum reaches the colour.
    pub fn new(rgb: [f64; 3], white: Illuminant) -> Result<Self, OpticsError> {
        for value in rgb {
            non_negative("a channel of an RGB emission", value)?;
        }
        let largest = rgb.iter().copied().fold(0.0, f64::max);
        if largest == 0.0 {
            return Ok(Self { rgb, white, factor: 0.0, shape: Shape::Flat(0.0) });
        }
        let observer = observer(white, &REC709_FROM_XYZ);
        let mut factor = 2.0 * largest;
        for _ in 0..10 {
            let (sigmoid, error) = fit(&observer, rgb.map(|v| v / factor));
            if error * factor <= REACHED * largest {
                return Ok(Self { rgb, white, factor, shape: Shape::Smooth(sigmoid) });
            }
            factor *= 2.0;
        }
        Err(OpticsError::UnreachableColour { rgb, white: white.name() })
    }

    /// The colour asked for, linear Rec. 709.
    pub fn rgb(&self) -> [f64; 3] {
        self.rgb
    }

    /// The illuminant that gives the spectrum its structure.
    pub fn white(&self) -> Illuminant {
        self.white
    }

    /// Value at a wavelength in nm.
    #[inline]
    pub fn eval(&self, wavelength_nm: f64) -> f64 {
        self.factor * self.shape.eval(wavelength_nm) * self.white.eval(wavelength_nm)
    }

    pub(super) fn max_over(&self, range_nm: [f64; 2]) -> f64 {
        let [first, last] = range_nm;
        let steps = (last - first).ceil().max(1.0) as usize;
        let node = |i: usize| first + (last - first) * (i as f64 / steps as f64);
        let bound = |i: usize| {
            let step = [node(i), node(i + 1)];
            self.shape.max_over(step) * self.white.max_over(step)
        };
        self.factor * (0..steps).map(bound).fold(0.0, f64::max)
    }

    pub(super) fn is_constant(&self) -> bool {
        // Black alone: every other colour is a smooth shape times its white.
        self.factor == 0.0
    }
}

impl From<RgbReflectance> for Spectrum {
    fn from(reflectance: RgbReflectance) -> Self {
        Self::RgbReflectance(reflectance)
    }
}
impl From<RgbEmission> for Spectrum {
    fn from(emission: RgbEmission) -> Self {
        Self::RgbEmission(emission)
    }
}
