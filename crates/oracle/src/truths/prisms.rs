//! The deviation of light by a prism, line by line.

use super::{
    Claim, Truth,
    scene::{Scene, black, parallelogram, sellmeier_glass, triangular_prism},
};
use crate::{
    laws::fresnel_exact,
    vector::{Vec3, add, dot, normalize, scale, sub},
};

/// Sellmeier's coefficients of N-BK7, λ in µm (Schott's data sheet).
const BK7_B: [f64; 3] = [1.039_612_12, 0.231_792_344, 1.010_469_45];
const BK7_C: [f64; 3] = [0.006_000_698_67, 0.020_017_914_4, 103.560_653];

fn bk7(wavelength_nm: f64) -> f64 {
    let square = (wavelength_nm * 1e-3).powi(2);
    (1.0 + (0..3).map(|i| BK7_B[i] * square / (square - BK7_C[i])).sum::<f64>()).sqrt()
}

/// Half the least deviation of a prism of 60°: asin(n·sin 30°) − 30°.
fn half_deviation(n: f64) -> f64 {
    (0.5 * n).asin() - 30.0_f64.to_radians()
}

const BEAM_M: f64 = 1e-3;
const DISTANCE_M: f64 = 1.0;

/// A beam through a prism of side 2 at least deviation for an index, and a strip 1 m beyond whose edge halves the beam.
fn scene(wavelength_nm: f64) -> Scene {
    let half = half_deviation(bk7(wavelength_nm));
    let (sine, cosine) = half.sin_cos();
    // Inside, the beam runs along +x at height .6 of an equilateral prism that stands on y = 0.
    let height = 0.6;
    let entry = [-1.0 + height / 3.0_f64.sqrt(), height, 0.0];
    let exit = [-entry[0], height, 0.0];
    let (inward, outward) = ([cosine, sine, 0.0], [cosine, -sine, 0.0]);
    let across = [sine, cosine, 0.0];
    let middle = add(exit, scale(DISTANCE_M, outward));
    let corner = sub(middle, [0.0, 0.0, 0.5]);
    Scene::orthographic(sub(entry, scale(0.5, inward)), entry, BEAM_M)
        .up([0.0, 0.0, 1.0])
        .object(
            triangular_prism([[-1.0, 0.0], [1.0, 0.0], [0.0, 3.0_f64.sqrt()]], [-1.0, 1.0]),
            sellmeier_glass(BK7_B, BK7_C),
        )
        .lamp(parallelogram(corner, scale(2.0 * BEAM_M, across), [0.0, 0.0, 1.0]), black(), 1.0, "both")
        .band([wavelength_nm - 5e-4, wavelength_nm + 5e-4])
}

/// Share of the beam that would land on the strip if the index were another, faces unchanged.
fn share(design_nm: f64, index: f64) -> f64 {
    let design = half_deviation(bk7(design_nm));
    let incidence = design + 30.0_f64.to_radians();
    let inside = (incidence.sin() / index).asin();
    let out = (index * (60.0_f64.to_radians() - inside).sin()).asin();
    let error = incidence + out - 60.0_f64.to_radians() - 2.0 * design;
    (0.5 - DISTANCE_M * error.tan() / BEAM_M).clamp(0.0, 1.0)
}

/// The deviation by Snell's law in vector form at both faces.
fn traced_deviation(n: f64) -> f64 {
    let refract = |d: Vec3, normal: Vec3, eta: f64| {
        let c = -dot(d, normal);
        let along = c / eta - (1.0 - (1.0 - c * c) / (eta * eta)).sqrt();
        normalize(add(scale(1.0 / eta, d), scale(along, normal)))
    };
    let half = half_deviation(n);
    let d = [half.cos(), half.sin(), 0.0];
    let (s, c) = 30.0_f64.to_radians().sin_cos();
    let inside = refract(d, [-c, s, 0.0], n);
    let out = refract(inside, [-c, -s, 0.0], 1.0 / n);
    dot(d, out).acos()
}

pub(super) fn truths() -> Vec<Truth> {
    let because = "At least deviation the ray inside runs parallel to the base, so that each face turns it by asin(n·sin 30°) − 30°. The edge of \
         a shining strip stands 1 m behind the prism exactly where the middle of the beam must land; the beam is 1 mm wide, so an \
         error of 1e-5 rad shows as 1 % of the beam. Both faces transmit 1 − R.";
    let mut list: Vec<Truth> = [404.6561, 486.1327, 587.5618, 656.2725]
        .map(|wavelength_nm| {
            let n = bk7(wavelength_nm);
            let incidence = (0.5 * n).asin();
            let powers = fresnel_exact(incidence.cos(), n);
            let transmitted = powers.transmittance().powi(2);
            let wrong = if wavelength_nm == 587.5618 { bk7(589.3) } else { bk7(587.5618) };
            Truth::new(
                format!("prism-bk7-at-{wavelength_nm}-nanometres"),
                &scene(wavelength_nm),
                0.5 * transmitted,
                format!(
                    "½(1 − R)²; deviation 2·asin(n·sin 30°) − 60° = {:.7}°, n = {n:.8}",
                    2.0 * half_deviation(n).to_degrees()
                ),
            )
            .because(because)
            .confirmed("Snell's law in vector form at both faces", 1e-9, move || {
                let error = traced_deviation(n) - 2.0 * half_deviation(n);
                (0.5 - DISTANCE_M * error / BEAM_M) * fresnel_exact((0.5 * n).asin().cos(), n).transmittance().powi(2)
            })
            .or_else("the index of another line (d; for d, that of sodium)", share(wavelength_nm, wrong) * transmitted)
            .or_else("index too large by 1e-4", share(wavelength_nm, n + 1e-4) * transmitted)
            .sees(0.02)
            .claims(Claim::AveragesPolarisation)
            .claims(Claim::Dispersion)
        })
        .into();
    let n = bk7(587.5618);
    let powers = fresnel_exact((0.5 * n).asin().cos(), n);
    list.push(
        Truth::new(
            "prism-bk7-polarised",
            &scene(587.5618),
            0.25 * (powers.t_s.powi(2) + powers.t_p.powi(2)),
            "½·mean of T_s² and T_p²",
        )
        .because(because)
        .or_else("index too large by 1e-4", share(587.5618, n + 1e-4) * powers.transmittance().powi(2))
        .claims(Claim::CarriesPolarisation)
        .claims(Claim::Dispersion),
    );
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviations_have_their_published_values() {
        for (wavelength_nm, degrees) in
            [(404.6561, 39.835_336_6), (486.1327, 39.138_108_7), (587.5618, 38.646_698_5), (656.2725, 38.429_136_7)]
        {
            let n = bk7(wavelength_nm);
            assert!((2.0 * half_deviation(n).to_degrees() - degrees).abs() < 1e-7);
            assert!((traced_deviation(n).to_degrees() - degrees).abs() < 1e-7);
        }
        assert!((bk7(587.5618) - 1.516_800_03).abs() < 1e-8);
        let abbe = (bk7(587.5618) - 1.0) / (bk7(486.1327) - bk7(656.2725));
        assert!((abbe - 64.167).abs() < 1e-3);
    }
}
