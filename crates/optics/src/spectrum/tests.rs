use super::*;
use crate::colour::{CIE_RANGE_NM, inverse, luminance_of, multiply, rec709_from_xyz, rgb_to_xyz_matrix, xyz_of};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(3), failure_persistence: None, ..ProptestConfig::default() }
}

/// One of every kind.
fn examples() -> Vec<Spectrum> {
    let table = |outside| {
        let (w, v) = (vec![380.0, 450.0, 451.0, 600.5, 700.0], vec![0.2, 0.9, 0.1, 0.7, 0.3]);
        Spectrum::tabulated(w, v, outside).unwrap()
    };
    vec![
        Spectrum::Constant(0.7),
        table(Outside::Zero),
        table(Outside::Hold),
        Spectrum::blackbody(5000.0, 0.5).unwrap(),
        Spectrum::blackbody(1500.0, 1.0).unwrap(),
        Spectrum::illuminant(Illuminant::D65, 2.0).unwrap(),
        Spectrum::illuminant(Illuminant::A, 2.0).unwrap(),
        Spectrum::illuminant(Illuminant::E, 2.0).unwrap(),
        Spectrum::rgb_reflectance([0.9, 0.2, 0.05]).unwrap(),
        Spectrum::rgb_reflectance([0.1, 0.8, 0.1]).unwrap(),
        Spectrum::rgb_reflectance([0.9, 0.1, 0.9]).unwrap(),
        Spectrum::rgb_emission([3.0, 2.0, 1.0], Illuminant::D65).unwrap(),
        Spectrum::rgb_emission([0.1, 0.2, 1.0], Illuminant::A).unwrap(),
        Spectrum::rgb_emission([0.3, 1.0, 0.2], Illuminant::E).unwrap(),
        Spectrum::blackbody(6500.0, 1.0).unwrap().scaled(1e-4).unwrap(),
    ]
}

#[test]
fn planck_gives_the_published_radiance() {
    let v = Spectrum::blackbody(5000.0, 1.0).unwrap().eval(560.0);
    // Nine digits are given.
    assert!((v - 12_762.191_5).abs() < 5e-5, "{v}");
}

#[test]
fn planck_integrates_to_stefan_and_boltzmann() {
    // π∫L dλ = σT⁴, with σ from the exact constants: 5.670374419e-8 (CODATA 2018). Trapezoid in ln λ from 100 nm to 1 mm,
    // which misses 1e-9 of it at 5000 K.
    let body = Blackbody::new(5000.0, 1.0).unwrap();
    let (nodes, first, last) = (4000, 100.0_f64.ln(), 1e6_f64.ln());
    let h = (last - first) / f64::from(nodes);
    let sum: f64 = (0..=nodes).map(|i| (first + h * f64::from(i)).exp()).map(|nm| nm * body.eval(nm)).sum();
    let exitance = std::f64::consts::PI * sum * h;
    assert!((exitance / (5.670_374_419e-8 * 5000.0_f64.powi(4)) - 1.0).abs() < 1e-8, "{exitance}");
}

#[test]
fn planck_peaks_where_wien_says() {
    let body = Blackbody::new(5000.0, 1.0).unwrap();
    // b = 2.897771955e-3 m·K.
    assert!((body.peak_nm() - 2.897_771_955e6 / 5000.0).abs() < 1e-6);
    assert!(body.eval(body.peak_nm()) > body.eval(body.peak_nm() - 0.1));
    assert!(body.eval(body.peak_nm()) > body.eval(body.peak_nm() + 0.1));
    // Far below the peak the exponential overflows, and the radiance is the zero it rounds to.
    assert_eq!(Blackbody::new(1.0, 1.0).unwrap().eval(360.0), 0.0);
}

#[test]
fn illuminants_have_the_luminance_of_the_constant_spectrum() {
    for illuminant in Illuminant::ALL {
        let light = Spectrum::illuminant(illuminant, 3.0).unwrap();
        assert!((luminance_of(|nm| light.eval(nm)) - 3.0).abs() < 1e-12, "{illuminant:?}");
        assert_eq!(Illuminant::named(illuminant.name()), Some(illuminant));
    }
    assert_eq!(Illuminant::named("F11"), None);
}

#[test]
fn d65_shown_in_rec709_is_white_to_the_recommendations_rounding() {
    let rgb = rec709_from_xyz(xyz_of(|nm| Illuminant::D65.eval(nm)));
    assert!(rgb.iter().all(|v| (v - 1.0).abs() < 3e-4), "{rgb:?}");
}

#[test]
fn tables_meet_their_rows_and_hold_or_vanish_outside() {
    let table = |outside| Tabulated::new(vec![400.0, 500.0, 700.0], vec![0.1, 0.4, 0.2], outside).unwrap();
    let (zero, hold) = (table(Outside::Zero), table(Outside::Hold));
    for t in [&zero, &hold] {
        assert_eq!([400.0, 500.0, 700.0].map(|nm| t.eval(nm)), [0.1, 0.4, 0.2]);
        assert_eq!(t.eval(450.0), 0.25);
        assert!((t.eval(650.0) - 0.25).abs() < 1e-16);
    }
    assert_eq!([399.9, 700.1].map(|nm| zero.eval(nm)), [0.0, 0.0]);
    assert_eq!([399.9, 700.1].map(|nm| hold.eval(nm)), [0.1, 0.2]);
    assert_eq!(Spectrum::Tabulated(zero).max_over([300.0, 450.0]), 0.25);
    assert_eq!(Spectrum::Tabulated(hold).max_over([100.0, 200.0]), 0.1);
}

#[test]
fn nonsense_is_refused() {
    use OpticsError as E;
    assert!(matches!(Spectrum::constant(-0.1), Err(E::Negative { .. })));
    assert!(matches!(Spectrum::constant(f64::NAN), Err(E::NotFinite { .. })));
    let table = |w: &[f64], v: &[f64]| Spectrum::tabulated(w.into(), v.into(), Outside::Zero);
    assert!(matches!(table(&[], &[]), Err(E::TooShort { found: 0, .. })));
    assert!(matches!(table(&[500.0], &[1.0]), Err(E::TooShort { .. })));
    assert!(matches!(table(&[500.0, 600.0], &[1.0]), Err(E::LengthMismatch { .. })));
    assert!(matches!(table(&[600.0, 500.0], &[1.0, 1.0]), Err(E::Unsorted { index: 1, .. })));
    assert!(matches!(table(&[500.0, f64::NAN], &[1.0, 1.0]), Err(E::NotFinite { .. })));
    assert!(matches!(table(&[-1.0, 500.0], &[1.0, 1.0]), Err(E::NotPositive { .. })));
    assert!(matches!(table(&[500.0, 600.0], &[1.0, -1.0]), Err(E::Negative { .. })));
    assert!(matches!(table(&[500.0, 600.0], &[1.0, f64::INFINITY]), Err(E::NotFinite { .. })));
    assert!(matches!(Spectrum::blackbody(0.0, 1.0), Err(E::NotPositive { .. })));
    assert!(matches!(Spectrum::blackbody(f64::NAN, 1.0), Err(E::NotFinite { .. })));
    assert!(matches!(Spectrum::blackbody(5000.0, -1.0), Err(E::Negative { .. })));
    assert!(matches!(Spectrum::illuminant(Illuminant::A, -1.0), Err(E::Negative { .. })));
    assert!(matches!(Spectrum::rgb_reflectance([0.0, 1.1, 0.0]), Err(E::AboveOne { .. })));
    assert!(matches!(Spectrum::rgb_reflectance([0.0, -0.1, 0.0]), Err(E::Negative { .. })));
    assert!(matches!(Spectrum::rgb_reflectance([f64::NAN, 0.0, 0.0]), Err(E::NotFinite { .. })));
    assert!(matches!(Spectrum::rgb_emission([0.0, -0.1, 0.0], Illuminant::E), Err(E::Negative { .. })));
    assert!(matches!(Spectrum::ONE.scaled(-1.0), Err(E::Negative { .. })));
}

#[test]
fn greys_white_and_black_are_exactly_constant() {
    for v in [0.0, 1e-9, 0.18, 0.5, 1.0] {
        let grey = Spectrum::rgb_reflectance([v; 3]).unwrap();
        assert!(grey.is_constant());
        assert!((300..900).all(|nm| grey.eval(f64::from(nm)) == v));
    }
}

/// The colour of a reflectance under a light, relative to the perfect reflector under D65 and that reflector's white.
fn rgb_under(reflectance: &RgbReflectance, light: Illuminant) -> [f64; 3] {
    let white = xyz_of(|nm| Illuminant::D65.eval(nm));
    multiply(&inverse(&rgb_to_xyz_matrix(white)), light.xyz_of_reflectance(|nm| reflectance.eval(nm)))
}

fn largest_difference(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f64::max)
}

const CORNERS: [f64; 8] = [0.0, 1e-6, 1e-3, 0.02, 0.5, 0.98, 0.999, 1.0];

#[test]
fn rgb_reflectances_come_back_under_d65_in_the_whole_cube_and_its_border() {
    for r in CORNERS {
        for g in CORNERS {
            for b in CORNERS {
                let s = RgbReflectance::new([r, g, b]).unwrap();
                let back = rgb_under(&s, Illuminant::D65);
                // Newton's method ends at rounding: 471 terms of at most 2⁻⁵³ each, a hundred times less in practice.
                assert!(largest_difference(back, [r, g, b]) < 5e-14, "{s:?} shows {back:?}");
                assert!(s.round_trip_error() < 5e-14);
            }
        }
    }
}

#[test]
fn rgb_reflectances_seen_under_another_light_are_rejected() {
    let s = RgbReflectance::new([0.9, 0.2, 0.05]).unwrap();
    assert!(largest_difference(rgb_under(&s, Illuminant::E), s.rgb()) > 1e-2);
}

#[test]
fn rgb_emissions_come_back_in_linear_rec709_under_every_white() {
    for white in Illuminant::ALL {
        for rgb in [
            [1.0, 1.0, 1.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 1.0],
            [1.0, 0.0, 1.0],
            [1e-6, 2e-6, 5e-7],
            [500.0, 20.0, 1e-3],
        ] {
            let light = RgbEmission::new(rgb, white).unwrap();
            let back = rec709_from_xyz(xyz_of(|nm| light.eval(nm)));
            let largest = rgb.iter().copied().fold(0.0, f64::max);
            assert!(largest_difference(back, rgb) < 1e-9 * largest, "{light:?} shows {back:?}");
        }
    }
    let dark = Spectrum::rgb_emission([0.0; 3], Illuminant::A).unwrap();
    assert!(dark.is_zero() && dark.is_constant() && dark.max_over(CIE_RANGE_NM) == 0.0);
}

#[test]
fn a_light_of_k_times_a_colour_has_k_times_its_spectrum() {
    // Powers of two, so that nothing is rounded. Blue under A is out of reach of twice its largest channel; under D65 it is not.
    for (rgb, white) in [([0.0, 0.0, 1.0], Illuminant::A), ([0.1, 0.2, 0.7], Illuminant::D65)] {
        let light = RgbEmission::new(rgb, white).unwrap();
        for k in [2.0_f64.powi(-20), 2.0_f64.powi(20)] {
            let scaled = RgbEmission::new(rgb.map(|v| k * v), white).unwrap();
            assert!((360..830).map(f64::from).all(|nm| scaled.eval(nm) == k * light.eval(nm)), "{rgb:?} by {k}");
        }
    }
}

#[test]
fn every_kind_says_whether_it_is_constant() {
    let constant = examples().iter().filter(|s| s.is_constant()).count();
    // Constant(0.7) and illuminant E.
    assert_eq!(constant, 2);
    for s in examples() {
        assert!(!s.is_zero() && s.clone().scaled(0.0).unwrap().is_zero());
        if s.is_constant() {
            assert!((300..900).all(|nm| s.eval(f64::from(nm)) == s.eval(560.0)));
        }
    }
    assert!(Spectrum::tabulated(vec![1.0, 2.0], vec![0.5; 2], Outside::Hold).unwrap().is_constant());
    assert!(!Spectrum::tabulated(vec![1.0, 2.0], vec![0.5; 2], Outside::Zero).unwrap().is_constant());
}

#[test]
fn scaling_scales() {
    for s in examples() {
        let twice = s.clone().scaled(4.0).unwrap().scaled(0.5).unwrap();
        assert!((360..830).all(|nm| twice.eval(f64::from(nm)) == 2.0 * s.eval(f64::from(nm))));
        assert_eq!(twice.max_over(CIE_RANGE_NM), 2.0 * s.max_over(CIE_RANGE_NM));
    }
}

proptest! {
    #![proptest_config(config(64))]

    #[test]
    fn max_over_bounds_every_value_and_is_tight(first in 320.0..800.0_f64, width in 0.0..200.0_f64) {
        let range = [first, first + width];
        for s in examples() {
            let sampled = (0..=2000)
                .map(|i| s.eval(first + width * f64::from(i) / 2000.0))
                .fold(0.0, f64::max);
            let bound = s.max_over(range);
            // Near the peak of a Planck curve rounding decides which of two values is larger: each is rounded some twelve times,
            // half an ε each, five of them in λ⁵.
            prop_assert!(sampled <= bound * (1.0 + 16.0 * f64::EPSILON), "{s:?}: {sampled} above {bound}");
            // Samples 0.1 nm apart miss a vertex of the steepest table, which falls by .8 a nanometre, by .04 at most; the
            // bound of an RGB emission overshoots by the change of shape and white over 1 nm.
            prop_assert!(bound <= sampled + 0.05 * (1.0 + sampled), "{s:?}: {sampled} far below {bound}");
        }
    }
}

proptest! {
    #![proptest_config(config(512))]

    #[test]
    fn any_rgb_reflectance_comes_back_and_stays_within_0_and_1(r in 0.0..=1.0_f64, g in 0.0..=1.0_f64, b in 0.0..=1.0_f64) {
        let s = RgbReflectance::new([r, g, b]).unwrap();
        prop_assert!(largest_difference(rgb_under(&s, Illuminant::D65), [r, g, b]) < 5e-14);
        prop_assert!((200..2000).all(|nm| (0.0..=1.0).contains(&s.eval(f64::from(nm)))));
        prop_assert!(Spectrum::from(s).max_over([200.0, 2000.0]) <= 1.0);
    }

    #[test]
    fn tables_stay_within_their_values(values in prop::collection::vec(0.0..10.0_f64, 2..20), nm in 300.0..900.0_f64) {
        let wavelengths: Vec<f64> = (0..values.len()).map(|i| 400.0 + 17.0 * i as f64).collect();
        let (low, high) = values.iter().fold((f64::MAX, 0.0_f64), |(l, h), &v| (l.min(v), h.max(v)));
        let v = Tabulated::new(wavelengths, values, Outside::Hold).unwrap().eval(nm);
        prop_assert!(v >= low * (1.0 - f64::EPSILON) && v <= high * (1.0 + f64::EPSILON));
    }
}

#[test]
fn emitters_say_what_they_were_made_of() {
    let hot = Blackbody::new(5000.0, 0.5).unwrap();
    assert_eq!((hot.temperature_k(), hot.scale()), (5000.0, 0.5));
    let lamp = ScaledIlluminant::new(Illuminant::D65, 2.5).unwrap();
    assert_eq!((lamp.illuminant(), lamp.scale()), (Illuminant::D65, 2.5));
}
