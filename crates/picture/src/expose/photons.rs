//! From radiance to mean electrons.

use std::f64::consts::PI;

use etalon_optics::spectrum::{LIGHT_M_S, Outside, PLANCK_J_S, Tabulated};

use super::sensor::{QuantumEfficiency, Sensor, SensorChannel};
use crate::PictureError;

/// Metres in a nanometre.
const NM: f64 = 1e-9;

/// Mean electrons in a pixel of a channel for a radiance of 1 W·m⁻²·sr⁻¹·nm⁻¹ within each band, whose ends are `edges_nm`, and sin θ:
/// π sin²θ · T · A · t · ∫ η(λ) λ/(hc) dλ.
///
/// π sin²θ is the irradiance on the axis for a radiance of 1. T is the transmittance of the lens, A the area of a pixel and t the exposure time.
/// λ/(hc) photons carry a joule, and the share η of them raises an electron.
pub(super) fn electrons_per_radiance(
    sensor: &Sensor,
    sine: f64,
    channel: &SensorChannel,
    edges_nm: &[f64],
) -> Result<Vec<f64>, PictureError> {
    check_range(channel, edges_nm)?;
    let irradiance = PI * sine * sine * sensor.lens_transmittance;
    let joules = irradiance * sensor.pixel_pitch_m * sensor.pixel_pitch_m * sensor.exposure_s;
    let photons_per_joule_nm = NM / (PLANCK_J_S * LIGHT_M_S);
    let of_band = |ends: &[f64]| {
        let efficiency = integral_of_efficiency(&channel.quantum_efficiency, [ends[0], ends[1]]);
        joules * photons_per_joule_nm * efficiency
    };
    Ok(edges_nm.windows(2).map(of_band).collect())
}

/// The share of what a channel would make of an even spectrum (the same power at each wavelength) that lies outside of the bands. It is known
/// for tables alone: 0 for a constant efficiency, which has no ends.
pub(super) fn share_outside(channel: &SensorChannel, edges_nm: &[f64]) -> f64 {
    let QuantumEfficiency::Table(table) = &channel.quantum_efficiency else { return 0.0 };
    let [Some(first), Some(last)] = [edges_nm.first(), edges_nm.last()] else { return 0.0 };
    let whole = of_table(table, table.range_nm());
    if whole > 0.0 { (1.0 - of_table(table, [*first, *last]) / whole).max(0.0) } else { 0.0 }
}

/// Refuses bands that reach beyond what is known of a channel.
fn check_range(channel: &SensorChannel, edges_nm: &[f64]) -> Result<(), PictureError> {
    let QuantumEfficiency::Table(table) = &channel.quantum_efficiency else { return Ok(()) };
    let ([low, high], [first, last]) = (table.range_nm(), [edges_nm[0], edges_nm[edges_nm.len() - 1]]);
    if table.outside() == Outside::Zero || low <= first && last <= high {
        return Ok(());
    }
    Err(PictureError::expose(format!(
        "the quantum efficiency of channel {} is known from {low} to {high} nm, and the bands of the picture reach from {first} to {last} nm: \
         extend the table, or state that it is 0 beyond (\"outside\": \"zero\")",
        channel.name
    )))
}

/// ∫ η(λ) λ dλ over a band, nm².
fn integral_of_efficiency(efficiency: &QuantumEfficiency, ends_nm: [f64; 2]) -> f64 {
    match efficiency {
        QuantumEfficiency::Constant(value) => integral_of_line([*value; 2], ends_nm),
        QuantumEfficiency::Table(table) => of_table(table, ends_nm),
    }
}

/// The sum over the segments of a table; nothing lies beyond its ends.
fn of_table(table: &Tabulated, [low, high]: [f64; 2]) -> f64 {
    let (nodes, values) = (table.wavelengths_nm(), table.values());
    let mut sum = 0.0;
    for (node, value) in nodes.windows(2).zip(values.windows(2)) {
        let ends = [node[0].max(low), node[1].min(high)];
        if ends[0] < ends[1] {
            let slope = (value[1] - value[0]) / (node[1] - node[0]);
            sum += integral_of_line(ends.map(|nm| value[0] + (nm - node[0]) * slope), ends);
        }
    }
    sum
}

/// ∫ η(λ) λ dλ for an η that is linear between the ends: Simpson's rule, which is exact for polynomials up to the third degree.
fn integral_of_line(values: [f64; 2], ends_nm: [f64; 2]) -> f64 {
    let middle = 0.5 * (values[0] + values[1]) * 0.5 * (ends_nm[0] + ends_nm[1]);
    (ends_nm[1] - ends_nm[0]) / 6.0 * (values[0] * ends_nm[0] + 4.0 * middle + values[1] * ends_nm[1])
}
