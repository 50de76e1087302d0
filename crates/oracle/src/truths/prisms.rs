//! The deviation of light by a prism, line by line.

use std::sync::LazyLock;

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    scene::{Scene, black, block, disk, parallelogram, sellmeier_glass, triangular_prism},
};
use crate::{
    laws::fresnel_exact,
    vector::{Vec3, add, dot, normalize, scale, sub},
};

/// Sellmeier's coefficients of N-BK7, λ in µm (Schott's data sheet).
pub(super) const BK7_B: [f64; 3] = [1.039_612_12, 0.231_792_344, 1.010_469_45];
pub(super) const BK7_C: [f64; 3] = [0.006_000_698_67, 0.020_017_914_4, 103.560_653];

pub(super) fn bk7(wavelength_nm: f64) -> f64 {
    let square = (wavelength_nm * 1e-3).powi(2);
    (1.0 + (0..3).map(|i| BK7_B[i] * square / (square - BK7_C[i])).sum::<f64>()).sqrt()
}

/// A glass by Cauchy's formula without its second term, λ in µm.
const CAUCHY_A: f64 = 1.5;
const CAUCHY_C: f64 = 0.002;

fn fourth_power(wavelength_nm: f64) -> f64 {
    CAUCHY_A + CAUCHY_C / (wavelength_nm * 1e-3).powi(4)
}

/// Half the least deviation of a prism of 60°: asin(n·sin 30°) − 30°.
pub(super) fn half_deviation(n: f64) -> f64 {
    (0.5 * n).asin() - 30.0_f64.to_radians()
}

const BEAM_M: f64 = 1e-3;
const DISTANCE_M: f64 = 1.0;

/// A beam through a prism of side 2 at least deviation for an index, and a strip 1 m beyond whose edge halves the beam; it
/// reaches this far to the side of longer waves.
fn scene(glass: Value, index: f64, beam_m: f64, strip_m: f64) -> Scene {
    let half = half_deviation(index);
    let (sine, cosine) = half.sin_cos();
    // Inside, the beam runs along +x at height .6 of an equilateral prism that stands on y = 0.
    let height = 0.6;
    let entry = [-1.0 + height / 3.0_f64.sqrt(), height, 0.0];
    let exit = [-entry[0], height, 0.0];
    let (inward, outward) = ([cosine, sine, 0.0], [cosine, -sine, 0.0]);
    let across = [sine, cosine, 0.0];
    let middle = add(exit, scale(DISTANCE_M, outward));
    let corner = sub(middle, [0.0, 0.0, 0.5]);
    Scene::orthographic(sub(entry, scale(0.5, inward)), entry, beam_m)
        .up([0.0, 0.0, 1.0])
        .object(triangular_prism([[-1.0, 0.0], [1.0, 0.0], [0.0, 3.0_f64.sqrt()]], [-1.0, 1.0]), glass)
        .lamp(parallelogram(corner, scale(strip_m, across), [0.0, 0.0, 1.0]), black(), 1.0, "both")
}

/// The same in one wavelength, the beam 1 mm wide.
fn one_line(wavelength_nm: f64) -> Scene {
    let glass = sellmeier_glass(BK7_B, BK7_C);
    scene(glass, bk7(wavelength_nm), BEAM_M, 2.0 * BEAM_M).band([wavelength_nm - 5e-4, wavelength_nm + 5e-4])
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

/// The direction after a face whose normal points against `d`, where `eta` = n_transmitted / n_incident: Snell's law in vector form.
pub(super) fn refracted(d: Vec3, normal: Vec3, eta: f64) -> Vec3 {
    let c = -dot(d, normal);
    let along = c / eta - (1.0 - (1.0 - c * c) / (eta * eta)).sqrt();
    normalize(add(scale(1.0 / eta, d), scale(along, normal)))
}

/// The deviation by Snell's law in vector form at both faces.
fn traced_deviation(n: f64) -> f64 {
    let half = half_deviation(n);
    let d = [half.cos(), half.sin(), 0.0];
    let (s, c) = 30.0_f64.to_radians().sin_cos();
    let inside = refracted(d, [-c, s, 0.0], n);
    let out = refracted(inside, [-c, -s, 0.0], 1.0 / n);
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
                &one_line(wavelength_nm),
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
            &one_line(587.5618),
            0.25 * (powers.t_s.powi(2) + powers.t_p.powi(2)),
            "½·mean of T_s² and T_p²",
        )
        .because(because)
        .or_else("index too large by 1e-4", share(587.5618, n + 1e-4) * powers.transmittance().powi(2))
        .claims(Claim::CarriesPolarisation)
        .claims(Claim::Dispersion),
    );
    list.push(rainbow("rainbow-cut-in-two", sellmeier_glass(BK7_B, BK7_C), bk7));
    let of_fourth_power =
        json!({ "type": "cauchy", "a": CAUCHY_A, "b_um2": 0, "c_um4": CAUCHY_C, "range_nm": [300, 900] });
    let glass = json!({ "type": "dielectric", "interior": of_fourth_power });
    list.push(
        rainbow("rainbow-of-a-glass-by-the-fourth-power-of-the-wavelength", glass, fourth_power)
            .claims(Claim::WholeFormat),
    );
    list.push(beyond_the_critical_angle_of_blue());
    list
}

/// ȳ of the CIE 1931 2° observer at 360, 361, …, 830 nm.
pub(super) static CIE_Y: LazyLock<Vec<f64>> = LazyLock::new(|| {
    let rows = include_str!("cie-y-1nm.csv").lines().filter(|line| !line.starts_with('#'));
    rows.map(|row| row.parse().expect("a number a line")).collect()
});

/// What a sensor of CIE Y makes of light of one wavelength, nm⁻¹: ȳ/Σȳ, linear between whole nanometres.
#[must_use]
pub fn photometric_weight(wavelength_nm: f64) -> f64 {
    let x = wavelength_nm - 360.0;
    if !(0.0..=470.0).contains(&x) {
        return 0.0;
    }
    let i = (x as usize).min(469);
    let t = x - i as f64;
    ((1.0 - t) * CIE_Y[i] + t * CIE_Y[i + 1]) / CIE_Y.iter().sum::<f64>()
}

/// The edge of a shining strip cuts the spectrum of white light in two.
fn rainbow(name: &str, glass: Value, index: fn(f64) -> f64) -> Truth {
    const EDGE_NM: f64 = 600.0;
    let incidence = (0.5 * index(EDGE_NM)).asin();
    let through = move |wavelength_nm: f64| {
        let n = index(wavelength_nm);
        let inside = (incidence.sin() / n).asin();
        let second = 60.0_f64.to_radians() - inside;
        fresnel_exact(incidence.cos(), n).transmittance() * fresnel_exact(second.cos(), 1.0 / n).transmittance()
    };
    // By the midpoint rule in steps of 0.02 nm: ȳ has a corner at each nanometre, on a border between steps.
    let over = |from_nm: f64, integrand: &dyn Fn(f64) -> f64| -> f64 {
        let steps = ((830.0 - from_nm) * 50.0).round();
        (0..steps as u32).map(|i| 0.02 * integrand(from_nm + 0.02 * (f64::from(i) + 0.5))).sum()
    };
    let value = over(EDGE_NM, &|nm| photometric_weight(nm) * through(nm));
    // Four wavelengths a quarter of an even distribution apart, all of them along the path of the first.
    let turned = |nm: f64, lane: u32| 360.0 + (nm - 360.0 + 117.5 * f64::from(lane)) % 470.0;
    let kept =
        over(EDGE_NM, &|nm| through(nm) * 0.25 * (0..4).map(|lane| photometric_weight(turned(nm, lane))).sum::<f64>());
    Truth::new(
        name,
        &scene(glass, index(EDGE_NM), 1e-6, 0.1),
        value,
        "∫ȳT₁T₂dλ/∫ȳdλ from 600 nm on, ȳ of the CIE 1931 observer",
    )
    .because(
        "White light that falls on a prism at one angle leaves it at an angle for each wavelength; a shining strip whose edge stands \
         where 600 nm land is met by the longer waves alone. The beam is a micrometre wide, in which the edge is sharp to \
         0.02 nm. A wavelength that is carried along the path of another lands on the wrong side.",
    )
    .confirmed("Simpson's rule over each nanometre of the table", 1e-6, move || {
        let f = |nm: f64| photometric_weight(nm) * through(nm);
        (600..830).map(f64::from).map(|nm| (f(nm) + 4.0 * f(nm + 0.5) + f(nm + 1.0)) / 6.0).sum()
    })
    .or_else("the other wavelengths of a path kept after dispersion (four, drawn evenly from 360 to 830 nm)", kept)
    .or_else("one of four wavelengths kept, and not weighed up", 0.25 * value)
    .or_else("one index for all wavelengths, that of the d line: all of it on the other side", 0.0)
    .allows(1e-5, "2e-5 for single precision, 1e-5 for the width of the beam where ȳ is not even over 0.02 nm")
    .claims(Claim::AveragesPolarisation)
    .claims(Claim::Dispersion)
    .claims(Claim::PhotometricSensor)
}

/// An eye in a block of glass, and a lamp in it that its upper face mirrors. Total reflection begins in the blue.
fn beyond_the_critical_angle_of_blue() -> Truth {
    const TOTAL_FROM_NM: f64 = 480.0;
    let index = |nm: f64| 1.4 + 0.05 / (1e-3 * nm).powi(2);
    let sine = 1.0 / index(TOTAL_FROM_NM);
    let cosine = (1.0 - sine * sine).sqrt();
    let reflects = move |nm: f64| match nm > TOTAL_FROM_NM {
        true => fresnel_exact(cosine, 1.0 / index(nm)).reflectance(),
        false => 1.0,
    };
    let glass = json!({ "type": "dielectric", "interior": { "type": "cauchy", "a": 1.4, "b_um2": 0.05, "range_nm": [300, 900] } });
    let scene = Scene::orthographic([-0.5 * sine, 0.0, -0.5 * cosine], [0.0; 3], 1e-3)
        .object(block([-1.0, -1.0, -1.0], [1.0, 1.0, 0.0]), glass)
        .lamp(disk([0.5 * sine, 0.0, -0.5 * cosine], [-sine, 0.0, cosine], 0.1), black(), 1.0, "front")
        .film(16, 16)
        .spp(256);
    let over = |of: &dyn Fn(f64) -> f64| -> f64 {
        let middles = (0..4700).map(|i| 360.0 + 0.1 * (f64::from(i) + 0.5));
        middles.map(|nm| 0.1 * photometric_weight(nm) * of(nm)).sum()
    };
    // Four wavelengths a quarter of an even distribution apart. Each is the first as often.
    let of_four = |nm: f64, relative: &dyn Fn(f64, f64) -> f64| {
        let four = [0.0, 117.5, 235.0, 352.5].map(|step| reflects(360.0 + (nm - 360.0 + step) % 470.0));
        let of_first =
            |first: f64| first * relative(four[0], first) / four.map(|r| relative(r, first)).iter().sum::<f64>();
        four.map(of_first).iter().sum::<f64>()
    };
    let (value, capped) = (over(&reflects), over(&|nm| of_four(nm, &|own, first| (own / first).min(1.0))));
    Truth::new(
        "eye-in-glass-beyond-the-critical-angle-of-blue",
        &scene,
        value,
        "∫ȳR dλ/∫ȳ dλ, R = (R_s + R_p)/2, and 1 up to 480 nm; n = 1.4 + 0.05 µm²/λ²",
    )
    .because(
        "Each wavelength is reflected by its own index. All go the same way, so that a path may hold several: blue as a whole, of green a fourth, of \
         red less.",
    )
    .confirmed("angles of refraction, and Simpson's rule over each nanometre", 1e-4, move || {
        let incidence = cosine.acos();
        let of = |nm: f64| {
            let refracted = index(nm) * sine;
            if refracted >= 1.0 {
                return 1.0;
            }
            let (less, more) = (incidence - refracted.asin(), incidence + refracted.asin());
            0.5 * ((less.sin() / more.sin()).powi(2) + (less.tan() / more.tan()).powi(2))
        };
        let f = |nm: f64| photometric_weight(nm) * of(nm);
        (360..830).map(f64::from).map(|nm| (f(nm) + 4.0 * f(nm + 0.5) + f(nm + 1.0)) / 6.0).sum()
    })
    .or_else("no wavelength weighed above the one that chooses (four, drawn evenly)", capped)
    .or_else("all wavelengths reflected as the one that chooses", over(&|nm| of_four(nm, &|_, _| 1.0)))
    .or_else("one index for all wavelengths, that of the d line", reflects(587.5618))
    .claims(Claim::AveragesPolarisation)
    .claims(Claim::Dispersion)
    .claims(Claim::PhotometricSensor)
    .claims(Claim::WholeFormat)
    .sees(0.01)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sensor_has_its_published_sum_and_peak() {
        assert!((CIE_Y.iter().sum::<f64>() - 106.856_917).abs() < 1e-6 && CIE_Y.len() == 471);
        assert_eq!((CIE_Y[555 - 360], photometric_weight(300.0)), (1.0, 0.0));
        let total: f64 = (0..47_000).map(|i| 0.01 * photometric_weight(360.0 + 0.01 * (f64::from(i) + 0.5))).sum();
        assert!((total - 1.0).abs() < 1e-7, "{total}");
    }

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
