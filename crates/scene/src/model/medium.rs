//! Media: what fills a space, and what it does to light on its way.

use super::Transform;
use crate::texture::{TextureFilter, Wrap, place};
use etalon_optics::Spectrum;
use std::sync::Arc;

/// What fills a space.
#[derive(Clone, Debug, PartialEq)]
pub struct Medium {
    /// Absorption coefficient σₐ, m⁻¹.
    pub absorption: Spectrum,
    /// Scattering coefficient σₛ, m⁻¹.
    pub scattering: Spectrum,
    /// Where scattered light goes.
    pub phase: PhaseFunction,
    /// Source radiance B, W·m⁻²·sr⁻¹·nm⁻¹, if it emits: it emits σₐB a metre, and a piece too thick to see through that does not scatter
    /// shows B.
    pub source: Option<Spectrum>,
    /// What both coefficients are multiplied by at each place.
    pub density: MediumDensity,
    /// The share of `scattering` that is scattered at each place; the rest is absorbed. All is scattered without it. A medium that has it emits
    /// nothing.
    pub albedo: Option<Arc<AlbedoGrid>>,
}

/// How dense a medium is at each place, relative to what its coefficients say.
#[derive(Clone, Debug, PartialEq)]
pub enum MediumDensity {
    /// 1 everywhere.
    Uniform,
    /// It falls exponentially with the height, as in air that is in equilibrium.
    Exponential(ExponentialDensity),
    /// A grid in a box.
    Grid(DensityGrid),
}

/// The density e^(−h/H), h the height above a point.
#[derive(Clone, Debug, PartialEq)]
pub struct ExponentialDensity {
    /// A point where it is 1, m.
    pub base_m: [f64; 3],
    /// Unit vector along which heights count.
    pub up: [f64; 3],
    /// Scale height H, m.
    pub scale_height_m: f64,
}

/// Densities at the middles of the cells of a box, in trilinear proportion between them and the same from the outermost middles to the faces
/// of the box; 0 outside of it.
#[derive(Clone, Debug, PartialEq)]
pub struct DensityGrid {
    /// Cells along x, y and z; at least one each.
    pub cells: [u32; 3],
    /// Their densities, 0 or above; x runs first, then y.
    pub values: Arc<[f32]>,
    /// Corners of the box in its own coordinates, m.
    pub box_m: [[f64; 3]; 2],
    /// From these to the world, or to the coordinates of the group that holds the body.
    pub transform: Transform,
}

/// Colours at the middles of the cells of a box, in trilinear proportion between them.
#[derive(Clone, Debug, PartialEq)]
pub struct AlbedoGrid {
    /// Cells along x, y and z; at least one each.
    pub cells: [u32; 3],
    /// Numbers in each: 1 of shares, 3 of linear red, green and blue.
    pub channels: usize,
    /// The numbers, each in [0, 1]; channels run first, then x, then y.
    pub values: Arc<[f32]>,
    /// Corners of the box in its own coordinates, m.
    pub box_m: [[f64; 3]; 2],
    /// From these to the world, or to the coordinates of the group that holds the body.
    pub transform: Transform,
    /// What holds beyond the box.
    pub wrap: Wrap,
}

impl AlbedoGrid {
    /// The colour at a place, in coordinates in which the box reaches from 0 to 1.
    pub fn eval(&self, at: [f64; 3]) -> [f64; 3] {
        let along = [0, 1, 2].map(|k| place(at[k], self.cells[k] as usize, self.wrap, TextureFilter::Bilinear));
        let [columns, rows, _] = self.cells.map(|count| count as usize);
        let mut sum = [0.0; 3];
        for corner in 0..8 {
            let mut weight = 1.0;
            let [x, y, z] = [0, 1, 2].map(|k| {
                let (before, after, share) = along[k];
                let is_after = corner >> k & 1 == 1;
                weight *= if is_after { share } else { 1.0 - share };
                if is_after { after } else { before }
            });
            let cell = (z * rows + y) * columns + x;
            (0..3).for_each(|c| sum[c] += weight * self.channel(cell, c));
        }
        sum
    }

    /// Whether all colours are grey.
    pub fn is_grey(&self) -> bool {
        self.channels == 1 || self.values.chunks_exact(3).all(|rgb| rgb[0] == rgb[1] && rgb[1] == rgb[2])
    }

    /// Red, green or blue of a cell.
    fn channel(&self, cell: usize, c: usize) -> f64 {
        f64::from(self.values[if self.channels == 1 { cell } else { 3 * cell + c }])
    }

    /// The mean of the cells.
    pub fn mean(&self) -> [f64; 3] {
        let cells = self.values.len() / self.channels;
        [0, 1, 2].map(|c| (0..cells).map(|cell| self.channel(cell, c)).sum::<f64>() / cells as f64)
    }

    /// Makes each cell grey, of this value of its colour.
    pub fn turn_grey(&mut self, value: impl Fn([f64; 3]) -> f64) {
        if self.channels == 3 {
            let cells = self.values.len() / 3;
            let grey = |cell: usize| value([0, 1, 2].map(|c| self.channel(cell, c))) as f32;
            self.values = (0..cells).map(grey).collect();
            self.channels = 1;
        }
    }
}

/// The distribution of the directions into which a medium scatters light; its integral over the sphere is 1.
#[derive(Clone, Debug, PartialEq)]
pub enum PhaseFunction {
    /// The same in every direction: 1/4π.
    Isotropic,
    /// Henyey & Greenstein (*Diffuse Radiation in the Galaxy*, ApJ 93, 1941).
    HenyeyGreenstein {
        /// Mean cosine of the angle of scattering, in (−1, 1).
        g: f64,
    },
    /// Two of these: the first with the share `weight`, the second with the rest.
    DoubleHenyeyGreenstein {
        /// Mean cosines, each in (−1, 1).
        g: [f64; 2],
        /// Share of the first, in [0, 1].
        weight: f64,
    },
    /// Scattering by what is much smaller than the wavelength: 3(1 + cos²θ)/16π. It polarises light.
    Rayleigh,
    /// A table.
    Tabulated(PhaseTable),
}

/// A phase function given at some angles, in linear proportion to the cosine between them.
#[derive(Clone, Debug, PartialEq)]
pub struct PhaseTable {
    /// Cosines of the angles of scattering, increasing from −1 to 1; at least two.
    pub cosines: Vec<f64>,
    /// Values there, 0 or above and not all 0, in any unit.
    pub values: Vec<f64>,
    /// What it does to polarisation; without it, scattered light is unpolarised.
    pub matrix: Option<PhaseMatrix>,
}

/// The elements of a scattering matrix beside the first, at the cosines and in the unit of a [`PhaseTable`].
///
/// The matrix is ((F₁₁, F₁₂), (F₁₂, F₂₂)) of I and Q, and ((F₃₃, F₃₄), (−F₃₄, F₄₄)) of U and V. Q is the light that swings within the plane of
/// scattering, less the light that swings across it. Particles in every orientation, with as many mirror images, have such a matrix (Bohren
/// & Huffman, *Absorption and Scattering of Light by Small Particles*, 1983, §13.6).
#[derive(Clone, Debug, PartialEq)]
pub struct PhaseMatrix {
    /// F₁₂.
    pub f12: Vec<f64>,
    /// F₂₂; of spheres F₁₁.
    pub f22: Vec<f64>,
    /// F₃₃.
    pub f33: Vec<f64>,
    /// F₃₄.
    pub f34: Vec<f64>,
    /// F₄₄; of spheres F₃₃.
    pub f44: Vec<f64>,
}

impl PhaseTable {
    /// The largest degree of polarisation that it gives unpolarised light, |F₁₂|/F₁₁, in [0, 1]; 0 without a matrix.
    pub fn most_polarised(&self) -> f64 {
        let Some(matrix) = &self.matrix else { return 0.0 };
        let degrees =
            self.values.iter().zip(&matrix.f12).filter(|(f11, _)| **f11 > 0.0).map(|(f11, f12)| f12.abs() / f11);
        degrees.fold(0.0, f64::max)
    }
}

impl Medium {
    /// A medium that only absorbs.
    pub fn absorbing(absorption: Spectrum) -> Self {
        Self {
            absorption,
            scattering: Spectrum::Constant(0.0),
            phase: PhaseFunction::Isotropic,
            source: None,
            density: MediumDensity::Uniform,
            albedo: None,
        }
    }

    /// Whether it does nothing to light.
    pub fn is_clear(&self) -> bool {
        !self.absorbs() && !self.scatters()
    }

    /// Whether it absorbs light.
    pub fn absorbs(&self) -> bool {
        !self.absorption.is_zero() || (self.scatters() && self.albedo.is_some())
    }

    /// Whether it scatters light.
    pub fn scatters(&self) -> bool {
        !self.scattering.is_zero()
    }

    /// What it emits where it is too thick to see through, if it emits.
    pub fn shines(&self) -> Option<&Spectrum> {
        self.source.as_ref().filter(|source| self.absorbs() && !source.is_zero())
    }
}
