//! A medium as paths meet it.

use super::albedo::AlbedoGrid;
use super::density::{MediumDensity, Way};
use super::phase::Phase;
use crate::frame::SceneFrame;
use crate::spectral::PathSpectrum;
use etalon_optics::{Lanes, Vec3, exp_neg, one_minus_exp_neg};

/// What fills a space.
#[derive(Clone, Debug)]
pub(crate) struct Medium {
    absorption: PathSpectrum,
    scattering: PathSpectrum,
    /// Whether it scatters at some wavelength.
    scatters: bool,
    /// Source radiance, if it emits.
    source: Option<PathSpectrum>,
    /// Where it scatters light.
    pub phase: Phase,
    density: MediumDensity,
    /// The share of scattering that is not absorbed, if it is not 1.
    albedo: Option<Box<AlbedoGrid>>,
}

/// Coefficients of a medium in each lane where its density is 1, m⁻¹.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coefficients<const N: usize> {
    pub absorption: Lanes<f64, N>,
    pub scattering: Lanes<f64, N>,
    /// Their sum.
    pub extinction: Lanes<f64, N>,
}

impl Medium {
    /// The medium of a scene; `None` if it does nothing to light.
    pub(crate) fn new(medium: &etalon_scene::Medium, range_nm: [f64; 2], frame: &SceneFrame) -> Option<Self> {
        let spectrum = |spectrum| PathSpectrum::new(spectrum, range_nm);
        (!medium.is_clear()).then(|| Self {
            absorption: spectrum(&medium.absorption),
            scattering: spectrum(&medium.scattering),
            scatters: medium.scatters(),
            source: medium.shines().map(spectrum),
            phase: Phase::new(&medium.phase),
            density: MediumDensity::new(&medium.density, frame),
            albedo: medium.albedo.as_ref().map(|grid| Box::new(AlbedoGrid::new(grid, frame))),
        })
    }

    /// Whether it scatters at some wavelength.
    #[inline(always)]
    pub(crate) fn scatters(&self) -> bool {
        self.scatters
    }

    /// Its coefficients at these wavelengths.
    #[inline]
    pub(crate) fn coefficients<const N: usize>(&self, lambda_nm: &Lanes<f64, N>) -> Coefficients<N> {
        let absorption = self.absorption.lanes(lambda_nm);
        let scattering = if self.scatters { self.scattering.lanes(lambda_nm) } else { Lanes::ZERO };
        Coefficients { absorption, scattering, extinction: absorption + scattering }
    }

    /// Whether something of it is not the same everywhere, so that it matters where it is placed.
    #[inline]
    pub(super) fn varies(&self) -> bool {
        self.density.varies() || self.albedo.is_some()
    }

    /// The integral of its density over a way in its coordinates, in units of the frame.
    #[inline]
    pub(crate) fn column(&self, way: &Way) -> f64 {
        self.density.column(way)
    }

    /// Its density at a place in its coordinates.
    #[inline]
    pub(crate) fn density(&self, place: Vec3<f64>) -> f64 {
        self.density.at(place)
    }

    /// The share of its scattering coefficient that is scattered at a place in its coordinates, in each lane; the rest is absorbed.
    #[inline]
    pub(crate) fn albedo<const N: usize>(&self, lambda_nm: &Lanes<f64, N>, place: Vec3<f64>) -> Lanes<f64, N> {
        self.albedo.as_ref().map_or(Lanes::ONE, |grid| grid.lanes(lambda_nm, place))
    }

    /// How far along a way in its coordinates a column is reached that is less than that of the whole way.
    #[inline]
    pub(crate) fn distance(&self, way: &Way, column: f64) -> f64 {
        self.density.distance(way, column)
    }

    /// What arrives, in each lane, of the light that a way of this column c, m, emits toward its beginning:
    /// ∫ σₐB e^(−σs) ds = B σₐ/σ (1 − e^(−σc)).
    #[inline]
    pub(crate) fn emitted<const N: usize>(
        &self,
        coefficients: &Coefficients<N>,
        lambda_nm: &Lanes<f64, N>,
        column_m: f64,
    ) -> Option<Lanes<f64, N>> {
        let source = self.source.as_ref()?.lanes(lambda_nm);
        Some(Lanes::from_fn(|lane| {
            let (absorption, extinction) = (coefficients.absorption[lane], coefficients.extinction[lane]);
            // Nothing that absorbs nothing emits.
            if absorption == 0.0 {
                return 0.0;
            }
            source[lane] * (absorption / extinction) * one_minus_exp_neg(extinction * column_m)
        }))
    }
}

impl<const N: usize> Coefficients<N> {
    /// The share of light that comes through a way of this column, m, in each lane (Bouguer 1729, Lambert 1760, Beer 1852).
    #[inline]
    pub(crate) fn transmittance(&self, column_m: f64) -> Lanes<f64, N> {
        self.extinction.map(|per_m| {
            // Nothing is lost on an endless way through what is clear.
            if per_m > 0.0 { exp_neg(per_m * column_m) } else { 1.0 }
        })
    }
}
