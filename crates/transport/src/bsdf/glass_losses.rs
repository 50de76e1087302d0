//! What light that meets one facet of a rough interface of two transparent media loses, by quadrature over the facets.

use super::albedo::{Azimuths, LossTable};
use super::microfacet::{Distribution, Facet, MEAN_ERROR, gauss_rule, mean_over_facets};
use etalon_optics::{Vec3, fresnel, snell};
use std::sync::LazyLock;

/// The losses from the side from which the relative index is `eta_of` that of the table, for n_interior/n_exterior within `eta`.
pub(super) fn glass_table(distribution: &Distribution, eta: [f64; 2], eta_of: fn(f64) -> f64) -> LossTable {
    LossTable::new(Azimuths::All, eta, MEAN_ERROR, |wo, eta| loss(distribution, wo, eta_of(eta)))
}

/// What one scattering loses of light from above, for η = n_below/n_above.
pub(super) fn loss(distribution: &Distribution, wo: Vec3<f64>, eta: f64) -> f64 {
    if eta == 1.0 {
        return 0.0;
    }
    mean_over_facets(distribution, wo, Some(eta), |facet| {
        let Some(f) = fresnel::dielectric(facet.cos, eta) else { return 1.0 - facet.mirrored };
        f.reflectance * (1.0 - facet.mirrored) + f.transmittance * (1.0 - passed(distribution, facet, eta, f.cos_t))
    })
}

/// Share of the light refracted by a facet that no other one stops.
fn passed(distribution: &Distribution, facet: &Facet, eta: f64, cos_t: f64) -> f64 {
    let wi = snell::refract_with_cosines(facet.wo, facet.h, eta, facet.cos, cos_t);
    if wi.z < 0.0 { -2.0 * wi.z / (-wi.z + distribution.stretch(wi)) } else { 0.0 }
}

/// What a facet loses of unpolarised light, and of S₁ in its own frame: T_s − T_p = R_p − R_s.
pub(super) fn polarised_loss(distribution: &Distribution, facet: &Facet, eta: f64) -> [f64; 2] {
    let Some(f) = fresnel::dielectric(facet.cos, eta).filter(|_| eta != 1.0) else {
        return [1.0 - facet.mirrored, 0.0];
    };
    let passed = passed(distribution, facet, eta, f.cos_t);
    let lost = f.reflectance * (1.0 - facet.mirrored) + f.transmittance * (1.0 - passed);
    [lost, 0.5 * (f.r_s * f.r_s - f.r_p * f.r_p) * (passed - facet.mirrored)]
}

/// What a facet lets by: (T₀, T₁), of unpolarised light what it refracts and no other facet stops, and how much more of s than of p, halved.
pub(super) fn let_by(distribution: &Distribution, facet: &Facet, eta: f64) -> [f64; 2] {
    let Some(f) = fresnel::dielectric(facet.cos, eta) else { return [0.0; 2] };
    let passed = passed(distribution, facet, eta, f.cos_t);
    let difference = 0.5 * (f.r_s * f.r_s - f.r_p * f.r_p);
    [f.transmittance * passed, -difference * passed]
}

/// Mean of Fresnel's T over diffuse light that arrives at an interface of relative index `eta`.
pub(super) fn mean_transmittance(eta: f64) -> f64 {
    // Each nanometre of a spectrum asks: the rule took ten times as long as the integral.
    static RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss_rule(48));
    // In t = √µ the integrand is smooth at grazing angles, and from the denser side it begins at the critical angle.
    let least = if eta < 1.0 { (1.0 - eta * eta).sqrt() } else { 0.0 };
    let integral = |(x, weight): &(f64, f64)| {
        let mu = least + (1.0 - least) * x * x;
        let t = fresnel::dielectric(mu, eta).map_or(0.0, |f| f.transmittance);
        weight * 2.0 * mu * t * (1.0 - least) * 2.0 * x
    };
    RULE.iter().map(integral).sum()
}
