//! The rough boundary of two media at each wavelength: indices on either side, and what its facets lose and give back as diffuse light. See
//! [`RoughDielectric`](super::RoughDielectric) for the formulas.

use super::albedo::{self, LossTable};
use super::glass_losses::{glass_table, mean_transmittance, polarised_loss};
use super::microfacet::Distribution;
use super::mueller::PolarisedLoss;
use super::table_store::Tabulated;
use crate::spectral::PathSpectrum;
use etalon_optics::{RefractiveIndex, Vec3};
use std::sync::Arc;

/// The interface between two media.
#[derive(Clone, Debug)]
pub(super) struct Boundary {
    pub(super) interior: RefractiveIndex,
    pub(super) exterior: RefractiveIndex,
    pub(super) dispersive: bool,
    pub(super) compensation: Option<Box<Compensation>>,
}

/// Losses from outside and from inside, over η = n_interior/n_exterior.
#[derive(Clone, Debug)]
pub(super) struct Compensation {
    outside: Arc<LossTable>,
    inside: Arc<LossTable>,
    /// Mean of Fresnel's T over diffuse light from outside, at each wavelength.
    transmittance: PathSpectrum,
    /// The least and the largest η.
    eta: [f64; 2],
    /// What losses do to polarised light, from outside and from inside, where that is carried.
    pub(super) polarised: Option<[Arc<PolarisedLoss>; 2]>,
}

/// The interface at one wavelength, seen from the side of `wo`: index 0 is that side, 1 the other.
#[derive(Clone, Copy)]
pub(super) struct Sides<'a> {
    pub(super) n: [f64; 2],
    /// n_interior/n_exterior and the losses.
    pub(super) tables: Option<(f64, [&'a LossTable; 2])>,
    /// Loss in the direction `wo`.
    pub(super) loss_o: f64,
    /// Mean loss on either side.
    pub(super) mean_loss: [f64; 2],
    /// Share of the loss that crosses.
    pub(super) crossing: f64,
}

impl Sides<'_> {
    /// Loss in a direction on `side`.
    pub(super) fn loss_i(&self, side: usize, wi: Vec3<f64>) -> f64 {
        self.tables.map_or(0.0, |(eta, tables)| tables[side].eval(wi, eta))
    }

    /// Density with which a direction on `side` is drawn for light that meets several facets.
    pub(super) fn diffuse(&self, side: usize, mu: f64) -> f64 {
        self.tables.map_or(0.0, |(_, tables)| tables[side].density(mu))
    }
}

impl Boundary {
    pub(super) fn new(
        interior: RefractiveIndex,
        exterior: RefractiveIndex,
        distribution: Distribution,
        compensated: bool,
        range_nm: [f64; 2],
    ) -> Self {
        let dispersive = interior.is_dispersive() || exterior.is_dispersive();
        let compensation = compensated.then(|| {
            let ratio = |nm: f64| interior.eval(nm) / exterior.eval(nm);
            let eta = albedo::extremes(range_nm, ratio);
            let table = |of, eta_of: fn(f64) -> f64| {
                albedo::shared(of, &distribution, eta, || glass_table(&distribution, eta, eta_of))
            };
            Box::new(Compensation {
                outside: table(Tabulated::Outside, |eta| eta),
                inside: table(Tabulated::Inside, f64::recip),
                transmittance: PathSpectrum::tabulate(range_nm, |nm| mean_transmittance(ratio(nm))),
                eta,
                polarised: None,
            })
        });
        Self { interior, exterior, dispersive, compensation }
    }

    pub(super) fn sides(&self, wavelength_nm: f64, from_outside: bool, wo: Vec3<f64>) -> Sides<'_> {
        let (inside, outside) = (self.interior.eval(wavelength_nm), self.exterior.eval(wavelength_nm));
        let n = if from_outside { [outside, inside] } else { [inside, outside] };
        let Some(tables) = &self.compensation else {
            return Sides { n, tables: None, loss_o: 0.0, mean_loss: [0.0; 2], crossing: 0.0 };
        };
        let eta = inside / outside;
        let (outside, inside): (&LossTable, &LossTable) = (&tables.outside, &tables.inside);
        let (near, far) = if from_outside { (outside, inside) } else { (inside, outside) };
        let mean_loss = [near.average(eta), far.average(eta)];
        let larger = mean_loss[0].max(mean_loss[1]);
        let from_above = tables.transmittance.eval(wavelength_nm);
        let transmittance = if from_outside { from_above } else { from_above / (eta * eta) };
        let crossing = if larger > 0.0 { transmittance * mean_loss[1] / larger } else { 0.0 };
        Sides { n, tables: Some((eta, [near, far])), loss_o: near.eval(wo, eta), mean_loss, crossing }
    }

    pub(super) fn prepare_polarisation(&mut self, distribution: &Distribution) {
        if let Some(compensation) = &mut self.compensation {
            let eta = compensation.eta;
            let table = |of, eta_of: fn(f64) -> f64| {
                let loss = |facet: &_, eta| polarised_loss(distribution, facet, eta_of(eta));
                PolarisedLoss::shared(of, eta, distribution, loss)
            };
            compensation.polarised = Some([table(Tabulated::Outside, |eta| eta), table(Tabulated::Inside, f64::recip)]);
        }
    }
}
