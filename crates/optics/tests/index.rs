//! Named media against published values, and what lies outside their data.

use etalon_optics::fresnel::conductor;
use etalon_optics::index::{ComplexIndex, OutsideFit, RefractiveIndex, SellmeierTerm};
use etalon_optics::{INDEX_RANGE, OpticsError, Real};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

#[test]
fn named_glasses_have_their_published_index_and_abbe_number() {
    // n_d and V_d as the data sheets and papers print them; the tolerance is half a unit of the last digit.
    for (name, n_d, n_tolerance, abbe, abbe_tolerance) in [
        ("N-BK7", 1.516_80, 5e-6, 64.17, 5e-3),
        ("N-SF11", 1.784_72, 5e-6, 25.68, 5e-3),
        ("fused-silica", 1.458_46, 5e-6, 67.82, 5e-3),
        ("diamond", 2.417_49, 5e-6, 55.3, 5e-2),
        ("water", 1.333_4, 5e-5, 55.76, 5e-3),
    ] {
        let glass = RefractiveIndex::named(name).unwrap();
        assert!((glass.eval(587.5618) - n_d).abs() < n_tolerance, "{name}: {}", glass.eval(587.5618));
        assert!((glass.abbe_number() - abbe).abs() < abbe_tolerance, "{name}: {}", glass.abbe_number());
        assert!(glass.is_dispersive());
    }
    let bk7 = RefractiveIndex::named("N-BK7").unwrap();
    assert!((bk7.eval(587.5618) - 1.516_800_03).abs() < 5e-9);
    assert!((bk7.abbe_number() - 64.167).abs() < 5e-4);
}

#[test]
fn every_listed_name_is_found_and_no_other() {
    assert_eq!(RefractiveIndex::names().count(), 5);
    assert!(RefractiveIndex::names().all(|name| RefractiveIndex::named(name).is_some()));
    assert_eq!(RefractiveIndex::named("Fused silica"), RefractiveIndex::named("fused-silica"));
    assert_eq!(RefractiveIndex::named("BK7"), None);
    assert_eq!(ComplexIndex::names().collect::<Vec<_>>(), ["Ag", "Au", "Cu", "Al"]);
    assert!(ComplexIndex::names().all(|name| ComplexIndex::named(name).is_some()));
    assert_eq!(ComplexIndex::named("gold"), ComplexIndex::named("au"));
    assert_eq!(ComplexIndex::named("aluminum"), ComplexIndex::named("Al"));
    assert_eq!(ComplexIndex::named("unobtainium"), None);
}

#[test]
fn a_wavelength_outside_the_fit_is_an_error_unless_a_clamp_is_asked_for() {
    let visible = [360.0, 830.0];
    for (name, covers) in
        [("N-BK7", true), ("N-SF11", false), ("fused-silica", true), ("diamond", false), ("water", true)]
    {
        let glass = RefractiveIndex::named(name).unwrap();
        assert_eq!(glass.check_range(visible).is_ok(), covers, "{name}");
        assert!(glass.clone().with_outside(OutsideFit::Clamp).check_range(visible).is_ok());
        assert!(glass.check_range([380.0, 760.0]).is_ok());
    }
    let sf11 = RefractiveIndex::named("N-SF11").unwrap();
    let error = sf11.check_range(visible).unwrap_err();
    assert_eq!(
        error,
        OpticsError::OutsideFit { what: "N-SF11".into(), fit_nm: [370.0, 2500.0], range_nm: [360.0, 830.0] }
    );
    assert_eq!(error.to_string(), "N-SF11 is known from 370 to 2500 nm only, which does not cover [360, 830] nm");
    assert!(sf11.eval(369.9).is_nan() && sf11.eval(370.0).is_finite());
    let clamped = sf11.with_outside(OutsideFit::Clamp);
    assert_eq!(clamped.eval(360.0), clamped.eval(370.0));
    assert_eq!(clamped.eval(500.0), RefractiveIndex::named("N-SF11").unwrap().eval(500.0));

    let al = ComplexIndex::named("Al").unwrap();
    assert!(al.check_range(visible).is_ok() && al.check_range([360.0, 1200.0]).is_err());
    assert!(al.eval(1200.0).0.is_nan() && al.eval(1200.0).1.is_nan());
    let clamped = al.with_outside(OutsideFit::Clamp);
    assert_eq!(clamped.eval(1200.0), clamped.eval(clamped.range_nm()[1]));
    assert!(clamped.check_range([360.0, 1200.0]).is_ok());
}

#[test]
fn ranges_that_make_no_sense_are_refused() {
    let glass = RefractiveIndex::named("N-BK7").unwrap();
    assert!(matches!(glass.check_range([600.0, 500.0]), Err(OpticsError::EmptyRange { .. })));
    assert!(matches!(glass.check_range([f64::NAN, 500.0]), Err(OpticsError::NotFinite { .. })));
    assert!(matches!(RefractiveIndex::VACUUM.check_range([0.0, 500.0]), Err(OpticsError::NotPositive { .. })));
    assert!(RefractiveIndex::VACUUM.check_range([1.0, 1e6]).is_ok());
}

#[test]
fn formulas_without_a_real_index_are_refused() {
    let term = |b, c_um2| SellmeierTerm { b, c_um2 };
    // A resonance at 500 nm inside the range, and none outside it.
    let pole = |range| RefractiveIndex::sellmeier(vec![term(1.0, 0.25)], range);
    assert!(
        matches!(pole(Some([400.0, 700.0])), Err(OpticsError::NoRealIndex { wavelength_nm }) if wavelength_nm == 500.0)
    );
    assert!(pole(Some([600.0, 700.0])).is_ok());
    let unbounded = pole(None).unwrap();
    assert_eq!(unbounded.range_nm(), None);
    assert!(unbounded.check_range([400.0, 700.0]).is_err() && unbounded.check_range([600.0, 700.0]).is_ok());
    // n² = 1 − 2 < 0.
    assert!(RefractiveIndex::sellmeier(vec![term(-2.0, 0.0)], Some([400.0, 700.0])).is_err());
    assert!(RefractiveIndex::cauchy(-1.5, 0.0, 0.0, Some([400.0, 700.0])).is_err());
    assert!(matches!(RefractiveIndex::sellmeier(vec![], None), Err(OpticsError::TooShort { .. })));
    assert!(matches!(RefractiveIndex::sellmeier(vec![term(1.0, -0.1)], None), Err(OpticsError::Negative { .. })));
    assert!(matches!(RefractiveIndex::sellmeier(vec![term(f64::NAN, 0.1)], None), Err(OpticsError::NotFinite { .. })));
    assert!(matches!(RefractiveIndex::constant(0.0), Err(OpticsError::NotPositive { .. })));
    assert!(matches!(RefractiveIndex::constant(f64::INFINITY), Err(OpticsError::NotFinite { .. })));
    for extreme in [1e308, 1e51, 1e-51] {
        assert!(matches!(RefractiveIndex::constant(extreme), Err(OpticsError::Extreme { .. })));
    }
    let [least, most] = INDEX_RANGE;
    assert!(RefractiveIndex::constant(least).is_ok() && RefractiveIndex::constant(most).is_ok());
    assert!(matches!(RefractiveIndex::cauchy(1.5, 1e60, 0.0, Some([400.0, 700.0])), Err(OpticsError::Extreme { .. })));
}

#[test]
fn cauchys_formula_is_evaluated_in_micrometres() {
    let glass = RefractiveIndex::cauchy(1.5046, 0.0042, 0.0001, Some([400.0, 700.0])).unwrap();
    assert!((glass.eval(500.0) - (1.5046 + 0.0042 / 0.25 + 0.0001 / 0.0625)).abs() < 1e-15);
    assert!(glass.is_dispersive() && glass.eval(700.1).is_nan());
    assert!(!RefractiveIndex::cauchy(1.5, 0.0, 0.0, None).unwrap().is_dispersive());
    assert!(!RefractiveIndex::Constant(1.5).is_dispersive());
    assert_eq!(RefractiveIndex::Constant(1.5).eval(1.0), 1.5);
}

#[test]
fn an_index_disperses_if_any_part_of_it_varies() {
    let cauchy = |a, b, c| RefractiveIndex::cauchy(a, b, c, None).unwrap().is_dispersive();
    assert!(!cauchy(1.5, 0.0, 0.0) && cauchy(1.5, 0.01, 0.0) && cauchy(1.5, 0.0, 1e-4));
    let term = |b, c_um2| RefractiveIndex::sellmeier(vec![SellmeierTerm { b, c_um2 }], None).unwrap().is_dispersive();
    assert!(!term(1.25, 0.0) && !term(0.0, 0.01) && term(1.25, 0.01));
    let metal = |n: [f64; 2], k: [f64; 2]| {
        ComplexIndex::tabulated(vec![400.0, 700.0], n.to_vec(), k.to_vec()).unwrap().is_dispersive()
    };
    assert!(!metal([0.2; 2], [3.0; 2]) && metal([0.2, 0.3], [3.0; 2]) && metal([0.2; 2], [3.0, 3.1]));
}

#[test]
fn a_range_may_be_one_wavelength_and_an_index_of_zero_is_none() {
    let glass = RefractiveIndex::named("N-BK7").unwrap();
    assert!(glass.check_range([550.0, 550.0]).is_ok() && glass.check_range([551.0, 550.0]).is_err());
    let nothing = RefractiveIndex::cauchy(0.0, 0.0, 0.0, None);
    assert!(nothing.is_err() || nothing.unwrap().check_range([400.0, 700.0]).is_err());
}

#[test]
fn metal_tables_meet_their_rows_and_are_linear_between() {
    // Rows of Johnson & Christy at 2.26, 2.13 eV and of Rakić.
    for (name, nm, n, k) in [
        ("Ag", 548.6, 0.06, 3.586),
        ("Au", 582.1, 0.29, 2.863),
        ("Cu", 548.6, 1.02, 2.577),
        ("Al", 563.57, 1.0728, 6.7839),
    ] {
        assert_eq!(ComplexIndex::named(name).unwrap().eval(nm), (n, k), "{name}");
    }
    let gold = ComplexIndex::named("Au").unwrap();
    let (n, k) = gold.eval((548.6 + 582.1) / 2.0);
    assert!((n - 0.36).abs() < 1e-14 && (k - 2.659).abs() < 1e-14);
    assert!(gold.is_dispersive());
    let [first, last] = gold.range_nm();
    assert!(gold.eval(first).0 == 1.28 && gold.eval(last).1 == 13.78);
}

#[test]
fn metals_have_the_colours_they_are_known_for() {
    let at = |name: &str, nm: f64| {
        let (n, k) = ComplexIndex::named(name).unwrap().eval(nm);
        let f = conductor(1.0, n, k);
        // At normal incidence: ((n − 1)² + k²)/((n + 1)² + k²).
        let closed = ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k);
        assert!((f.reflectance - closed).abs() < 4.0 * f64::EPSILON && f.reflectance_s == f.reflectance_p);
        f.reflectance
    };
    assert!(at("Ag", 450.0) > 0.95 && at("Ag", 650.0) > 0.95);
    assert!(at("Au", 450.0) < 0.45 && at("Au", 650.0) > 0.95);
    assert!(at("Cu", 450.0) < 0.65 && at("Cu", 650.0) > 0.9);
    assert!((at("Al", 550.0) - 0.915).abs() < 0.01);
}

#[test]
fn bad_tables_of_metals_are_refused() {
    let table = |w: &[f64], n: &[f64], k: &[f64]| ComplexIndex::tabulated(w.into(), n.into(), k.into());
    assert!(table(&[400.0, 700.0], &[0.2, 0.1], &[3.0, 4.0]).is_ok());
    assert!(matches!(table(&[400.0], &[0.2], &[3.0]), Err(OpticsError::TooShort { .. })));
    assert!(matches!(table(&[400.0, 700.0], &[0.2, 0.1], &[3.0]), Err(OpticsError::LengthMismatch { .. })));
    assert!(matches!(table(&[400.0, 400.0], &[0.2, 0.1], &[3.0, 4.0]), Err(OpticsError::Unsorted { index: 1, .. })));
    assert!(matches!(table(&[400.0, 700.0], &[0.0, 0.1], &[3.0, 4.0]), Err(OpticsError::NotPositive { .. })));
    assert!(matches!(table(&[400.0, 700.0], &[0.2, 0.1], &[3.0, -4.0]), Err(OpticsError::Negative { .. })));
    assert!(matches!(table(&[400.0, 700.0], &[0.2, 0.1], &[f64::NAN, 4.0]), Err(OpticsError::NotFinite { .. })));
    assert!(matches!(table(&[400.0, 700.0], &[0.2, 1e60], &[3.0, 4.0]), Err(OpticsError::Extreme { .. })));
    assert!(matches!(table(&[400.0, 700.0], &[0.2, 0.1], &[3.0, 1e60]), Err(OpticsError::Extreme { .. })));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1024, rng_seed: RngSeed::Fixed(5), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn glasses_disperse_normally_all_over_the_visible(nm in 380.0..750.0_f64, step in 0.1..10.0_f64) {
        for name in RefractiveIndex::names() {
            let glass = RefractiveIndex::named(name).unwrap();
            prop_assert!(glass.eval(nm) > glass.eval(nm + step), "{name}");
            prop_assert!(glass.eval(nm).is_finite() && glass.eval(nm) > f64::ONE);
        }
    }
}
