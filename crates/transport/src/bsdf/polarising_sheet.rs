//! A sheet without thickness that passes light straight on: a polariser, which lets the light pass that swings along its axis, or
//! a retarder, which delays the light that does not.
//!
//! What is across is at right angles to the ray and to the direction **b** in the sheet across the axis (Fainman & Shamir 1984):
//! **b** is where the molecules of a film lie, or the wires of a grid, which absorb what swings along them. So the frame's x is
//! **k** × **b**, at every angle of incidence; of a retarder the delay is the same at every angle. Nothing is mirrored.

use super::{BsdfSample, Properties, Shading};
use crate::mis::Density;
use crate::polarisation::across;
use crate::polarisation::mueller::{self, Matrix};
use crate::spectral::PathSpectrum;
use etalon_optics::{Lanes, Vec3};
use etalon_scene::PolarisingSheet as Sheet;

/// A polariser or a retarder.
#[derive(Clone, Debug)]
pub struct PolarisingSheet {
    effect: Effect,
}

#[derive(Clone, Debug)]
enum Effect {
    Polariser {
        transmittance: PathSpectrum,
        extinction: f64,
    },
    /// Cosine and sine of the retardance.
    Retarder {
        cos: PathSpectrum,
        sin: PathSpectrum,
    },
}

impl PolarisingSheet {
    /// The sheet of a scene, at wavelengths within `range_nm`.
    pub fn new(sheet: &Sheet, range_nm: [f64; 2]) -> Self {
        let effect = match sheet {
            Sheet::Polariser { transmittance, extinction } => {
                Effect::Polariser { transmittance: PathSpectrum::new(transmittance, range_nm), extinction: *extinction }
            }
            Sheet::Retarder { retardance_rad, at_nm } => {
                let retardance = |nm: f64| retardance_rad * at_nm.map_or(1.0, |at_nm| at_nm / nm);
                Effect::Retarder {
                    cos: PathSpectrum::tabulate(range_nm, |nm| retardance(nm).cos()),
                    sin: PathSpectrum::tabulate(range_nm, |nm| retardance(nm).sin()),
                }
            }
        };
        Self { effect }
    }

    /// See [`Properties`].
    pub(super) fn properties(sheet: &Sheet) -> Properties {
        let (name, dark) = match sheet {
            Sheet::Polariser { transmittance, .. } => ("a polariser", transmittance.is_zero()),
            Sheet::Retarder { .. } => ("a retarder", false),
        };
        Properties { dark, passes_straight: true, polarising_axis: true, ..Properties::sheet(name) }
    }

    pub(super) fn sample<const N: usize>(&self, lambda_nm: &Lanes<f64, N>, wo: Vec3<f64>) -> Option<BsdfSample<N>> {
        let weight = match &self.effect {
            // Of unpolarised light.
            Effect::Polariser { transmittance, extinction } => {
                transmittance.lanes(lambda_nm) * (0.5 * (1.0 + extinction))
            }
            Effect::Retarder { .. } => Lanes::ONE,
        };
        Some(BsdfSample { wi: -wo, weight, density: Density::Delta, lane_density: Lanes::ONE, eta: 1.0 })
    }

    /// The x of the frames for light along `k`.
    pub(super) fn x(&self, at: &Shading<'_>, k: Vec3<f64>) -> Vec3<f64> {
        across(k.cross(at.normal.cross(at.axis)), k)
    }

    pub(super) fn mueller(&self, wavelength_nm: f64) -> Matrix {
        match &self.effect {
            // Amplitudes 1 : √e.
            Effect::Polariser { extinction: e, .. } => {
                let sum = 1.0 + e;
                mueller::pair((1.0 - e) / sum, 2.0 * e.sqrt() / sum, 0.0)
            }
            // Amplitudes 1 : exp(iδ).
            Effect::Retarder { cos, sin } => {
                let (cos, sin) = (cos.eval(wavelength_nm), sin.eval(wavelength_nm));
                // Between the nodes of a table the chord lies within the circle.
                let length = (cos * cos + sin * sin).sqrt();
                mueller::pair(0.0, cos / length, -sin / length)
            }
        }
    }
}
