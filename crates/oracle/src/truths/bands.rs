//! Bands of wavelengths that a film keeps: each the mean radiance over it.

use serde_json::json;

use super::lamps::planck_radiance;
use super::scene::{Scene, disk, level_square, shown};
use super::{Quantity, Truth, disk_irradiance};
use crate::quadrature::interval;

/// Of the lamp: far from its peak the spectrum is steep and curved.
const KELVIN: f64 = 2000.0;
/// Middle of the first band and of the last, and the width of each, nm.
const BANDS_NM: [f64; 3] = [450.0, 750.0, 100.0];
const RADIUS_M: f64 = 0.8;
const HEIGHT_M: f64 = 1.2;

/// A grey plate below a thermal lamp, and below the plate, where nobody sees it, a thing that is grey or coloured.
fn scene(coloured: bool) -> Scene {
    let below =
        json!({ "type": "tabulated", "wavelengths_nm": [360, 830], "values": [0.2, if coloured { 0.7 } else { 0.2 }] });
    Scene::light_meter()
        .thermal_lamp(disk([0.0, 0.0, HEIGHT_M], [0.0, 0.0, -1.0], RADIUS_M), KELVIN, 1.0)
        .thing(json!({
            "shape": level_square([0.0, 0.0, -1.0], 0.5, false), "material": { "type": "lambert", "reflectance": below },
        }))
        .set("film", "bands_nm", json!(BANDS_NM))
        .film(16, 16)
        .spp(256)
}

/// The mean of Planck's law over a band.
fn mean(middle_nm: f64) -> f64 {
    let half = 0.5 * BANDS_NM[2];
    interval(|nm| planck_radiance(nm, KELVIN), middle_nm - half, middle_nm + half, 1e-12).value / (2.0 * half)
}

/// The same from the radiance up to a wavelength, which for photon numbers e^(−kx), x = hc/λkT, is a sum of terms
/// (x³/k + 3x²/k² + 6x/k³ + 6/k⁴) e^(−kx), in units of Stefan and Boltzmann's law.
fn mean_by_series(middle_nm: f64) -> f64 {
    const SECOND_M_K: f64 = 1.438_776_877_503_933e-2;
    const STEFAN_BOLTZMANN: f64 = 5.670_374_419_184_43e-8;
    let up_to = |nm: f64| {
        let x = SECOND_M_K / (nm * 1e-9 * KELVIN);
        let term =
            |k: f64| (-k * x).exp() * (x.powi(3) / k + 3.0 * (x / k).powi(2) + 6.0 * x / k.powi(3) + 6.0 / k.powi(4));
        let share: f64 = (1..40).map(f64::from).map(term).sum::<f64>() * 15.0 / std::f64::consts::PI.powi(4);
        share * STEFAN_BOLTZMANN * KELVIN.powi(4) / std::f64::consts::PI
    };
    let half = 0.5 * BANDS_NM[2];
    (up_to(middle_nm + half) - up_to(middle_nm - half)) / (2.0 * half)
}

pub(super) fn truths() -> Vec<Truth> {
    let lit = shown(disk_irradiance(RADIUS_M, HEIGHT_M, 0.0));
    let mut list = Vec::new();
    for (name, coloured, number) in [("grey", false, 0_u32), ("grey", false, 3), ("coloured", true, 0)] {
        let middle_nm = BANDS_NM[0] + f64::from(number) * BANDS_NM[2];
        let next_nm = if number == 3 { middle_nm - BANDS_NM[2] } else { middle_nm + BANDS_NM[2] };
        list.push(
            Truth::new(
                format!("band-of-a-{name}-scene-about-{middle_nm}-nanometres"),
                &scene(coloured),
                lit * mean(middle_nm),
                "(ρ/π) E ∫ 2hc²/λ⁵/(e^(hc/λkT) − 1) dλ/Δλ, T = 2000 K, Δλ = 100 nm",
            )
            .because("A band holds the mean radiance over its wavelengths: that of Planck's law, times what a disk of radiance 1 makes a plate show.")
            .confirmed("the series of the radiance up to a wavelength", 1e-9, move || lit * mean_by_series(middle_nm))
            .or_else("the radiance in the middle of the band", lit * planck_radiance(middle_nm, KELVIN))
            .or_else("the band beside it", lit * mean(next_nm))
            .reads(Quantity::Band(number))
            .sees(5e-3),
        );
    }
    list
}
