//! Thin films against closed forms, conservation laws, and mutants that must fail.

use etalon_optics::Complex;
use etalon_optics::fresnel::{Layer, StackFresnel, conductor, dielectric, stack};
use proptest::prelude::*;
use std::f64::consts::PI;

fn layer(re: f64, im: f64, thickness_nm: f64) -> Layer {
    Layer { index: Complex::new(re, im), thickness_nm }
}

/// Layers from the outermost to the innermost, as people list them.
fn coated(cos: f64, nm: f64, incident: f64, layers: &[Layer], substrate: Complex) -> StackFresnel {
    stack(cos, nm, incident, layers.iter().rev().copied(), substrate)
}

/// R at normal incidence of one transparent film, R = (r₁² + r₂² + 2r₁r₂cos 2δ)/(1 + r₁²r₂² + 2r₁r₂cos 2δ).
fn airy(nm: f64, [n0, n1, n2]: [f64; 3], thickness_nm: f64) -> f64 {
    let (r1, r2) = ((n0 - n1) / (n0 + n1), (n1 - n2) / (n1 + n2));
    let both = 2.0 * r1 * r2 * (4.0 * PI * n1 * thickness_nm / nm).cos();
    (r1 * r1 + r2 * r2 + both) / (1.0 + r1 * r1 * r2 * r2 + both)
}

/// Published examples: a quarter wave of MgF₂ on glass, and a soap film of 300 nm.
#[test]
fn one_film_at_normal_incidence_is_what_airy_found() {
    let quarter = 550.0 / (4.0 * 1.38);
    for (nm, reflectance) in [(550.0, 0.014_110_5), (450.0, 0.017_210_9), (650.0, 0.015_630_8)] {
        let found = coated(1.0, nm, 1.0, &[layer(1.38, 0.0, quarter)], Complex::real(1.5)).reflection.power();
        assert!((found - reflectance).abs() < 5e-8, "{nm}: {found}");
        assert!((found - airy(nm, [1.0, 1.38, 1.5], quarter)).abs() < 1e-15);
    }
    for (nm, reflectance) in [(400.0, 0.000_021), (500.0, 0.070_790), (600.0, 0.058_296), (700.0, 0.014_922)] {
        let found = coated(1.0, nm, 1.0, &[layer(1.33, 0.0, 300.0)], Complex::ONE).reflection.power();
        assert!((found - reflectance).abs() < 5e-7, "{nm}: {found}");
        assert!((found - airy(nm, [1.0, 1.33, 1.0], 300.0)).abs() < 1e-15);
    }
}

/// Without layers, and with one of no thickness or of the index of a neighbour, the interface is bare.
#[test]
fn a_bare_interface_reflects_by_fresnel() {
    for cos in [1.0, 0.7, 0.2, 1e-3] {
        for (incident, n) in [(1.0, 1.5), (1.5, 1.0), (1.33, 2.4)] {
            for layers in
                [vec![], vec![layer(2.0, 1.0, 0.0)], vec![layer(incident, 0.0, 310.0)], vec![layer(n, 0.0, 77.0)]]
            {
                let found = coated(cos, 500.0, incident, &layers, Complex::real(n));
                match dielectric(cos, n / incident) {
                    Some(f) => {
                        assert!((found.reflection.power() - f.reflectance).abs() < 1e-13, "{cos} {n} {layers:?}");
                        assert!((found.transmission.power() - f.transmittance).abs() < 1e-13);
                        let [s, p] = [found.reflection.s, found.reflection.p];
                        if layers.is_empty() {
                            assert!((s.re - f.r_s).abs() < 1e-14 && (p.re - f.r_p).abs() < 1e-14);
                        }
                    }
                    None => {
                        assert!((found.reflection.power() - 1.0).abs() < 1e-13 && found.transmission.power() == 0.0);
                    }
                }
            }
        }
        let found = coated(cos, 500.0, 1.0, &[], Complex::new(0.2, 3.4)).reflection;
        let f = conductor(cos, 0.2, 3.4);
        assert!(
            (found.s.squared() - f.reflectance_s).abs() < 1e-14 && (found.p.squared() - f.reflectance_p).abs() < 1e-14
        );
    }
}

/// (n_H n_L)^N quarter waves: R = ((n₀ − n_s(n_H/n_L)^2N)/(n₀ + n_s(n_H/n_L)^2N))², the dielectric mirror of every laser.
#[test]
fn a_mirror_of_quarter_waves_reflects_as_its_closed_form_says() {
    let (high, low, glass) = (2.35, 1.46, 1.52);
    for pairs in 1..=12 {
        let pair = [layer(high, 0.0, 550.0 / (4.0 * high)), layer(low, 0.0, 550.0 / (4.0 * low))];
        let layers: Vec<Layer> = (0..pairs).flat_map(|_| pair).collect();
        let found = coated(1.0, 550.0, 1.0, &layers, Complex::real(glass));
        let admittance = glass * (high / low).powi(2 * pairs);
        let expected = ((1.0 - admittance) / (1.0 + admittance)).powi(2);
        assert!(
            (found.reflection.power() - expected).abs() < 1e-13,
            "{pairs}: {} {expected}",
            found.reflection.power()
        );
        assert!((found.transmission.power() - (1.0 - expected)).abs() < 1e-13);
    }
}

/// Frustrated total reflection across a gap of vacuum between two prisms, for s: T = 1/(1 + [(n²cos² + κ²)/(2n cos κ)]² sinh²(2πκd/λ))
/// with κ = √(n² sin² − 1).
#[test]
fn light_tunnels_through_a_thin_gap_and_through_no_thick_one() {
    let (n, nm) = (1.5, 500.0);
    for sin in [0.7, 0.8, 0.95] {
        let cos = f64::sqrt(1.0 - sin * sin);
        let kappa = f64::sqrt(n * n * sin * sin - 1.0);
        for gap in [20.0, 100.0, 400.0, 5e4] {
            let found = coated(cos, nm, n, &[layer(1.0, 0.0, gap)], Complex::real(n));
            let (a, b) = (n * cos, kappa);
            let sinh = (2.0 * PI * kappa * gap / nm).min(300.0).sinh();
            let expected = 1.0 / (1.0 + ((a * a + b * b) / (2.0 * a * b) * sinh).powi(2));
            let t = found.transmission.s.squared();
            assert!((t - expected).abs() < 1e-12, "{sin} {gap}: {t} {expected}");
            assert!((found.reflection.power() + found.transmission.power() - 1.0).abs() < 1e-14);
        }
    }
}

/// At the critical angle of the layer itself the wave in it does not change at all: T = 1/(1 + (π n cos d/λ)²) for s between equal media.
#[test]
fn a_wave_that_runs_along_its_layer_is_finite() {
    // sin² = 1/n² exactly: n² = 4, sin² = 1/4 is not a cosine that is exact, but near it nothing may blow up.
    let n = 2.0;
    for near in [0.0, 1e-16, 1e-12, -1e-12, 1e-8, -1e-8] {
        let cos = f64::sqrt(0.75) + near;
        let found = coated(cos, 500.0, n, &[layer(1.0, 0.0, 100.0)], Complex::real(n));
        let expected = 1.0 / (1.0 + (PI * n * f64::sqrt(0.75) * 100.0 / 500.0).powi(2));
        assert!((found.transmission.s.squared() - expected).abs() < 1e-6, "{near}: {found:?}");
        assert!((found.reflection.power() + found.transmission.power() - 1.0).abs() < 1e-14);
    }
}

fn transparent() -> impl Strategy<Value = Vec<Layer>> {
    proptest::collection::vec((1.0..2.6_f64, 0.0..2000.0_f64).prop_map(|(n, d)| layer(n, 0.0, d)), 0..6)
}

fn absorbing() -> impl Strategy<Value = Vec<Layer>> {
    let one = (0.05..4.0_f64, 0.0..7.0_f64, 0.0..500.0_f64).prop_map(|(n, k, d)| layer(n, k, d));
    proptest::collection::vec(one, 0..6)
}

proptest! {
    #[test]
    fn what_absorbs_nothing_loses_nothing(
        layers in transparent(), cos in 0.0..=1.0_f64, nm in 360.0..830.0_f64, n in 1.0..2.5_f64, behind in 1.0..2.5_f64,
    ) {
        let found = coated(cos, nm, n, &layers, Complex::real(behind));
        for (r, t) in [(found.reflection.s, found.transmission.s), (found.reflection.p, found.transmission.p)] {
            let sum = r.squared() + t.squared();
            prop_assert!((sum - 1.0).abs() < 4e-15 * (layers.len() + 1) as f64, "{sum}");
        }
    }

    /// Transparent layers have matrices of real numbers, all others complex ones: both are the same wave.
    #[test]
    fn a_layer_that_absorbs_next_to_nothing_is_a_transparent_one(
        layers in transparent(), cos in 0.0..=1.0_f64, nm in 360.0..830.0_f64, n in 1.0..2.5_f64, behind in 1.0..2.5_f64,
    ) {
        let real = coated(cos, nm, n, &layers, Complex::real(behind));
        let tinted: Vec<Layer> = layers.iter().map(|l| layer(l.index.re, 1e-30, l.thickness_nm)).collect();
        let complex = coated(cos, nm, n, &tinted, Complex::real(behind));
        for (a, b) in [
            (real.reflection.s, complex.reflection.s),
            (real.reflection.p, complex.reflection.p),
            (real.transmission.s, complex.transmission.s),
            (real.transmission.p, complex.transmission.p),
        ] {
            prop_assert!((a - b).squared().sqrt() < 1e-13, "{a:?} {b:?}");
        }
    }

    /// Whatever absorbs takes, and passes as much from either side (of each polarisation, with its phase).
    #[test]
    fn what_absorbs_takes_light_and_passes_as_much_from_either_side(
        layers in absorbing(), cos in 0.01..=1.0_f64, nm in 360.0..830.0_f64, n in 1.0..2.5_f64, behind in 1.0..2.5_f64,
    ) {
        let found = coated(cos, nm, n, &layers, Complex::real(behind));
        for (r, t) in [(found.reflection.s, found.transmission.s), (found.reflection.p, found.transmission.p)] {
            prop_assert!(r.squared() + t.squared() <= 1.0 + 1e-13);
        }
        if let Some(f) = dielectric(cos, behind / n) {
            let reversed: Vec<Layer> = layers.iter().rev().copied().collect();
            let back = coated(f.cos_t, nm, behind, &reversed, Complex::real(n));
            for (there, back) in
                [(found.transmission.s, back.transmission.s), (found.transmission.p, back.transmission.p)]
            {
                prop_assert!((there - back).squared().sqrt() < 1e-9, "{there:?} {back:?}");
            }
        }
    }
}

/// Mutants: the order of layers turned, and half the phase.
#[test]
fn the_wrong_order_and_the_wrong_phase_are_seen() {
    let layers = [layer(2.35, 0.0, 60.0), layer(1.46, 0.0, 90.0)];
    let right = coated(1.0, 550.0, 1.0, &layers, Complex::real(1.52)).reflection.power();
    let reversed = stack(1.0, 550.0, 1.0, layers.iter().copied(), Complex::real(1.52)).reflection.power();
    assert!((right - reversed).abs() > 0.01, "{right} {reversed}");
    let soap = |d| coated(1.0, 500.0, 1.0, &[layer(1.33, 0.0, d)], Complex::ONE).reflection.power();
    assert!((soap(300.0) - soap(150.0)).abs() > 0.01);
}

/// A layer of metal too thick for light to come through is the metal.
#[test]
fn a_thick_layer_of_metal_is_the_metal_and_does_not_overflow() {
    for thickness_nm in [2e3, 1e6, 1e9] {
        let found = coated(0.6, 500.0, 1.0, &[layer(0.9, 2.0, thickness_nm)], Complex::real(1.5));
        let f = conductor(0.6, 0.9, 2.0);
        assert!((found.reflection.power() - f.reflectance).abs() < 1e-13 && found.transmission.power() < 1e-30);
    }
}
