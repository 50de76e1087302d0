//! Fresnel's equations against values computed to 60 digits (`reference/fresnel.py`), and mutants that must fail.

use etalon_optics::Real;
use etalon_optics::fresnel::{DielectricFresnel, conductor, dielectric, dielectric_reflectance, refracted_cosine};
use proptest::prelude::*;

struct Row {
    case: &'static str,
    single: bool,
    cos_i: f64,
    eta: f64,
    expected: DielectricFresnel<f64>,
}

fn reference() -> Vec<Row> {
    include_str!("reference/dielectric.csv")
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let number = |i: usize| cells[i].parse::<f64>().unwrap();
            let (r_s, r_p, reflectance, transmittance, cos_t) = (number(4), number(5), number(6), number(7), number(8));
            let expected = DielectricFresnel { r_s, r_p, reflectance, transmittance, cos_t };
            Row { case: cells[0], single: cells[1] == "f32", cos_i: number(2), eta: number(3), expected }
        })
        .collect()
}

/// Worst relative errors, in ε = 2 unit roundoffs, over a case of the reference.
#[derive(Debug, Default)]
struct Worst {
    reflectance: f64,
    transmittance: f64,
    cos_t_squared: f64,
    r_s: f64,
    /// Relative to 1 (r_p passes through zero at Brewster's angle).
    r_p: f64,
    sum: f64,
}

fn worst<R: Real>(case: &str, f: impl Fn(R, R) -> Option<DielectricFresnel<R>>) -> Worst {
    let epsilon = 2.0 * R::UNIT_ROUNDOFF.to_f64();
    let mut worst = Worst::default();
    // Rows for f32 are exact in both types.
    for row in reference().iter().filter(|row| row.case == case && (row.single || size_of::<R>() == 8)) {
        let (c, n) = (R::from_f64(row.cos_i), R::from_f64(row.eta));
        assert!(c.to_f64() == row.cos_i && n.to_f64() == row.eta, "a row's arguments must be exact");
        let got = f(c, n).unwrap_or_else(|| panic!("total reflection at {c} into {n}"));
        let relative = |got: R, expected: f64| ((got.to_f64() - expected) / expected).abs() / epsilon;
        worst.reflectance = worst.reflectance.max(relative(got.reflectance, row.expected.reflectance));
        worst.transmittance = worst.transmittance.max(relative(got.transmittance, row.expected.transmittance));
        worst.cos_t_squared = worst.cos_t_squared.max(2.0 * relative(got.cos_t, row.expected.cos_t));
        worst.r_s = worst.r_s.max(relative(got.r_s, row.expected.r_s));
        worst.r_p = worst.r_p.max((got.r_p.to_f64() - row.expected.r_p).abs() / epsilon);
        let sum = got.reflectance.to_f64() + got.transmittance.to_f64();
        worst.sum = worst.sum.max((sum - 1.0).abs() / epsilon);
    }
    worst
}

fn check_grazing<R: Real>() {
    let w = worst::<R>("grazing", dielectric);
    assert!(w.reflectance <= 8.0 && w.transmittance <= 8.0 && w.sum <= 8.0 && w.r_s <= 8.0 && w.r_p <= 8.0, "{w:?}");
}

fn check_near_one<R: Real>() {
    let w = worst::<R>("near-one", dielectric);
    assert!(w.reflectance <= 16.0 && w.transmittance <= 8.0 && w.r_s <= 8.0 && w.r_p <= 8.0, "{w:?}");
}

fn check_near_critical<R: Real>() {
    let w = worst::<R>("critical", dielectric);
    assert!(w.cos_t_squared <= 4.0 && w.reflectance <= 8.0 && w.transmittance <= 8.0 && w.sum <= 8.0, "{w:?}");
}

#[test]
fn reflectance_and_transmittance_are_accurate_to_8_epsilon_down_to_grazing() {
    check_grazing::<f32>();
    check_grazing::<f64>();
}

#[test]
fn reflectance_is_accurate_to_16_epsilon_for_nearly_equal_indices() {
    check_near_one::<f32>();
    check_near_one::<f64>();
}

#[test]
fn the_refracted_cosine_is_accurate_to_4_epsilon_up_to_the_critical_angle() {
    check_near_critical::<f32>();
    check_near_critical::<f64>();
}

#[test]
fn transmittance_as_one_minus_reflectance_is_rejected() {
    let mutant = |c, n| dielectric(c, n).map(|f| DielectricFresnel { transmittance: 1.0 - f.reflectance, ..f });
    assert!(worst::<f32>("grazing", mutant).transmittance > 1000.0);
}

#[test]
fn textbook_differences_are_rejected_for_nearly_equal_indices() {
    let mutant = |c: f32, n: f32| {
        let cos_t = refracted_cosine(c, n)?;
        let (r_s, r_p) = ((c - n * cos_t) / (c + n * cos_t), (n * c - cos_t) / (n * c + cos_t));
        let reflectance = 0.5 * (r_s * r_s + r_p * r_p);
        let f = dielectric(c, n)?;
        Some(DielectricFresnel { reflectance, ..f })
    };
    assert!(worst::<f32>("near-one", mutant).reflectance > 1000.0);
}

#[test]
fn the_refracted_cosine_by_way_of_the_sine_is_rejected_near_the_critical_angle() {
    fn mutant<R: Real>(c: R, n: R) -> Option<DielectricFresnel<R>> {
        let cos_t = (R::ONE - (R::ONE - c * c) / (n * n)).max(R::ZERO).sqrt();
        Some(DielectricFresnel { cos_t, ..dielectric(c, n)? })
    }
    assert!(worst::<f32>("critical", mutant).cos_t_squared > 1000.0);
    assert!(worst::<f64>("critical", mutant).cos_t_squared > 1000.0);
}

#[test]
fn swapped_media_are_rejected() {
    assert!(worst::<f64>("grazing", |c, n| dielectric(c, n).map(|f| DielectricFresnel { r_s: f.r_p, ..f })).r_s > 1e6);
}

#[test]
fn equal_indices_reflect_exactly_nothing_at_any_angle() {
    for c in [0.0, f64::MIN_POSITIVE, 1e-7, 0.5, 1.0] {
        let f = dielectric(c, 1.0).unwrap();
        assert_eq!((f.r_s, f.r_p, f.reflectance, f.transmittance, f.cos_t), (0.0, 0.0, 0.0, 1.0, c));
        let f = dielectric(c as f32, 1.0).unwrap();
        assert_eq!((f.reflectance, f.transmittance, f.cos_t), (0.0, 1.0, c as f32));
    }
}

#[test]
fn grazing_incidence_on_the_denser_medium_reflects_everything() {
    let f = dielectric(0.0, 1.5).unwrap();
    assert!((f.reflectance - 1.0).abs() < 8.0 * f64::EPSILON && f.transmittance == 0.0, "{f:?}");
    assert!(dielectric(0.0, 1.0 / 1.5).is_none());
}

/// Whether c² + n² > 1, exactly, for c and n in [½, 1): as integers in units of 2⁻¹⁰⁶.
fn refracts_exactly(c: f64, n: f64) -> bool {
    assert!((0.5..1.0).contains(&c) && (0.5..1.0).contains(&n));
    let integer = |x: f64| (x * 2.0_f64.powi(53)) as u128;
    integer(c).pow(2) + integer(n).pow(2) > 1 << 106
}

#[test]
fn total_reflection_begins_at_the_right_unit_in_the_last_place() {
    // 0.51 … 0.85 keep both numbers in [½, 1).
    for i in 0..2000 {
        let n = 0.51 + 0.34 * f64::from(i) / 2000.0;
        let mut c = ((1.0 - n) * (1.0 + n)).sqrt();
        for _ in 0..4 {
            c = c.next_down();
        }
        for _ in 0..9 {
            let f = dielectric(c, n);
            assert_eq!(f.is_some(), refracts_exactly(c, n), "{c:e} into {n:e}");
            if let Some(f) = f {
                // Continuous to 1: T = O(cos_t), and here cos_t² < 9 ulp · 2c/n².
                assert!(f.cos_t > 0.0 && f.cos_t < 1.2e-7 && (1.0 - f.reflectance).abs() < 1e-6, "{f:?}");
            }
            c = c.next_up();
        }
        let n = n as f32;
        let mut c = ((1.0 - n) * (1.0 + n)).sqrt().next_down().next_down();
        for _ in 0..5 {
            assert_eq!(dielectric(c, n).is_some(), refracts_exactly(f64::from(c), f64::from(n)), "{c:e} into {n:e}");
            c = c.next_up();
        }
    }
}

#[test]
fn brewster_and_critical_angle_are_where_hard_cases_say() {
    let brewster = 1.5_f64.atan();
    assert!((brewster.to_degrees() - 56.309_932_5).abs() < 5e-8);
    assert!(dielectric(brewster.cos(), 1.5).unwrap().r_p.abs() < 4.0 * f64::EPSILON);
    let critical = 41.810_314_9_f64.to_radians();
    assert!(dielectric((critical - 1e-9).cos(), 1.0 / 1.5).is_some());
    assert!(dielectric((critical + 1e-9).cos(), 1.0 / 1.5).is_none());
}

#[test]
fn plates_transmit_what_the_closed_forms_say() {
    // Hard cases, whole scenes: (1 − R)/(1 + R) with R the unpolarised reflectance of a face; the printed digits bound the
    // tolerance, except at 89.99° where cos 89.99° itself is known to 1e-12 only.
    for (degrees, expected, digits) in [
        (0.0, 0.923_076_923, 5e-10),
        (45.0, 0.904_326_791, 5e-10),
        (75.0, 0.596_092_048, 5e-10),
        (89.9, 0.005_069_633_08, 5e-12),
    ] {
        let r = dielectric(f64::to_radians(degrees).cos(), 1.5).unwrap().reflectance;
        assert!(((1.0 - r) / (1.0 + r) - expected).abs() < digits, "{degrees}");
    }
}

#[test]
fn the_diffuse_external_reflectance_is_walshs() {
    // 2∫R(μ)μ dμ by the midpoint rule, whose error for this smooth but for μ → 0 integrand is below 1e-9 at 2e5 nodes.
    let nodes = 200_000;
    let mu = |i: u32| (f64::from(i) + 0.5) / f64::from(nodes);
    let sum: f64 = (0..nodes).map(|i| 2.0 * mu(i) * dielectric(mu(i), 1.5).unwrap().reflectance).sum();
    assert!((sum / f64::from(nodes) - 0.091_777_959_4).abs() < 1e-9);
}

#[test]
fn nothing_is_reflected_where_a_metal_is_what_is_around_it() {
    for c in [0.0, 1e-300, 0.5, 1.0] {
        let f = conductor(c, 1.0, 0.0);
        assert_eq!((f.reflectance_s, f.reflectance_p, f.reflectance), (0.0, 0.0, 0.0), "{c}");
    }
}

#[test]
fn metals_agree_with_complex_arithmetic() {
    let mut worst = [0.0_f64; 2];
    for line in include_str!("reference/conductor.csv").lines().filter(|line| !line.starts_with('#')) {
        let v: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let double = conductor(v[0], v[1], v[2]);
        let single = conductor(v[0] as f32, v[1] as f32, v[2] as f32);
        for (expected, double, single) in
            [(v[3], double.reflectance_s, single.reflectance_s), (v[4], double.reflectance_p, single.reflectance_p)]
        {
            // Relative to 1: a power, and near an almost transparent medium's Brewster angle it nearly vanishes.
            worst[0] = worst[0].max((double - expected).abs() / f64::EPSILON);
            worst[1] = worst[1].max((f64::from(single) - expected).abs() / f64::from(f32::EPSILON));
        }
    }
    assert!(worst[0] <= 8.0 && worst[1] <= 8.0, "{worst:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4096, rng_seed: proptest::test_runner::RngSeed::Fixed(20), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn shares_sum_to_one_and_both_directions_agree(c in 0.0..=1.0_f64, eta in 0.2..5.0_f64) {
        let Some(f) = dielectric(c, eta) else {
            // Total reflection: sin_i ≥ n, up to what rounding can decide either way.
            prop_assert!(1.0 - c * c >= eta * eta * (1.0 - 4.0 * f64::EPSILON));
            return Ok(());
        };
        prop_assert!((f.reflectance + f.transmittance - 1.0).abs() <= 8.0 * f64::EPSILON);
        prop_assert!((0.0..=1.0 + 8.0 * f64::EPSILON).contains(&f.transmittance));
        // Stokes: the reversed path has the same transmittance. Its arguments are rounded: cos² comes back with an error of
        // up to 8ε(1 + n²), hence the cosine with 4ε(1 + n²)/cos; T changes by at most 4/cos of that.
        if c > 1e-3 && f.cos_t > 1e-3 {
            let back = dielectric(f.cos_t, 1.0 / eta).unwrap();
            let bound = 4.0 * f64::EPSILON * (1.0 + eta * eta) / c;
            prop_assert!((back.cos_t - c).abs() <= bound);
            prop_assert!((back.transmittance - f.transmittance).abs() <= 8.0 * f64::EPSILON + 4.0 * bound / c.min(f.cos_t));
        }
    }

    /// Any angle, and those where the two forms part: at the critical angle and at equal indices.
    #[test]
    fn the_form_without_branches_has_the_same_bits(
        c in 0.0..=1.0_f64, eta in 0.2..5.0_f64, near in -1e-6..1e-6_f64, place in 0..4_u8,
    ) {
        let (c, eta) = match place {
            0 => (c, eta),
            1 => ((1.0 - eta * eta).max(0.0).sqrt() * (1.0 + near), eta),
            2 => (c, 1.0 + near),
            _ => (c, 1.0),
        };
        let c = c.clamp(0.0, 1.0);
        let (reflectance, cos_t) = dielectric_reflectance(c, eta);
        match dielectric(c, eta) {
            None => prop_assert_eq!(reflectance, 1.0),
            Some(f) => prop_assert_eq!((reflectance.to_bits(), cos_t.to_bits()), (f.reflectance.to_bits(), f.cos_t.to_bits())),
        }
    }

    #[test]
    fn a_transparent_conductor_is_a_dielectric(c in 0.0..=1.0_f64, n in 1.0..5.0_f64) {
        let (metal, glass) = (conductor(c, n, 0.0), dielectric(c, n).unwrap());
        prop_assert!((metal.reflectance - glass.reflectance).abs() <= 16.0 * f64::EPSILON);
    }

    #[test]
    fn a_conductor_reflects_between_nothing_and_everything(c in 0.0..=1.0_f64, n in 0.01..10.0_f64, k in 0.0..20.0_f64) {
        let f = conductor(c, n, k);
        prop_assert!(f.reflectance_s >= 0.0 && f.reflectance_s <= 1.0 && f.reflectance_p >= 0.0 && f.reflectance_p <= 1.0);
        // p is never reflected more than s.
        prop_assert!(f.reflectance_p <= f.reflectance_s * (1.0 + 8.0 * f64::EPSILON));
        let single = conductor(c as f32, n as f32, k as f32);
        prop_assert!(single.reflectance.is_finite());
    }
}
