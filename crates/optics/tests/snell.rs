//! Snell's law as a property of the directions, and mutants that must fail it.

use etalon_optics::snell::{refract, refract_with_cosines};
use etalon_optics::{Real, Vec3, fresnel};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

type Refract<R> = fn(Vec3<R>, Vec3<R>, R) -> Option<Vec3<R>>;

/// Rounding errors of the directions: the arguments are unit vectors to an ε each, the transmitted tangent is the incident
/// one over eta, and the result is rounded once more.
fn tolerance<R: Real>(eta: f64) -> f64 {
    2.0 * R::UNIT_ROUNDOFF.to_f64() * 4.0 * (1.0 + 1.0 / (eta * eta))
}

/// What is wrong with `f` as a law of refraction at these arguments, if anything.
fn fault<R: Real>(f: Refract<R>, wi: Vec3<R>, n: Vec3<R>, eta: R) -> Option<String> {
    let tolerance = tolerance::<R>(eta.to_f64());
    let (w, m, e) = (wi.to_f64(), n.to_f64(), eta.to_f64());
    let cos = w.dot(m);
    let tangent = w - m * cos;
    let sin_t = tangent.length() / e;
    let Some(t) = f(wi, n, eta) else {
        // sin² = 1 − cos² is known to the error of a unit vector's length.
        return (sin_t * sin_t < 1.0 - tolerance).then(|| format!("no ray although sin = {sin_t}"));
    };
    let t = t.to_f64();
    if sin_t * sin_t > 1.0 + tolerance {
        return Some(format!("a ray although sin = {sin_t}"));
    }
    if t.dot(m) * cos > 0.0 {
        return Some(format!("same side: {t:?}"));
    }
    if (t.length() - 1.0).abs() > tolerance {
        return Some(format!("length {}", t.length()));
    }
    // n_i·sin_i = n_t·sin_t in the plane of incidence, on the other side of the normal, all in one vector equation.
    let error = ((t - m * t.dot(m)) + tangent / e).length();
    (error > tolerance).then(|| format!("tangent off by {error:e}, {tolerance:e} allowed"))
}

fn unit(z: f64, azimuth: f64) -> Vec3<f64> {
    let r = ((1.0 - z) * (1.0 + z)).sqrt();
    Vec3::new(r * azimuth.cos(), r * azimuth.sin(), z).normalized()
}

/// A unit vector at this cosine to `n`.
fn at_cosine(n: Vec3<f64>, cos: f64, azimuth: f64) -> Vec3<f64> {
    etalon_optics::Frame::from_normal(n).to_world(unit(cos, azimuth)).normalized()
}

fn config() -> ProptestConfig {
    ProptestConfig { cases: 8192, rng_seed: RngSeed::Fixed(7), failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn refraction_obeys_snell(
        z in -1.0..1.0_f64, phi in 0.0..6.3_f64, cos in 0.0..=1.0_f64, azimuth in 0.0..6.3_f64, eta in 0.3..3.5_f64,
        below in any::<bool>(), graze in 0..8_i32,
    ) {
        let n = unit(z, phi);
        let cos = if graze < 7 { cos } else { cos * 1e-6 };
        let wi = at_cosine(n, if below { -cos } else { cos }, azimuth);
        prop_assert_eq!(fault(refract, wi, n, eta), None);
        let (wi, n) = (wi.cast::<f32>().normalized(), n.cast::<f32>().normalized());
        prop_assert_eq!(fault(refract, wi, n, eta as f32), None);
    }

    #[test]
    fn refraction_can_be_reversed(
        z in -1.0..1.0_f64, phi in 0.0..6.3_f64, cos in 1e-3..=1.0_f64, azimuth in 0.0..6.3_f64, eta in 1.0..3.5_f64,
    ) {
        let n = unit(z, phi);
        let wi = at_cosine(n, cos, azimuth);
        let there = refract(wi, n, eta).expect("no total reflection into the denser medium");
        let back = refract(there, n, 1.0 / eta).expect("the reversed path exists");
        // cos² comes back with an error of a few ε(1 + η²), so the cosine with half of that over cos.
        prop_assert!((back - wi).length() <= 16.0 * f64::EPSILON * (1.0 + eta * eta) / cos, "{}", (back - wi).length());
    }

    #[test]
    fn equal_indices_leave_the_direction_bit_identical(
        z in -1.0..1.0_f64, phi in 0.0..6.3_f64, wz in -1.0..1.0_f64, wphi in 0.0..6.3_f64,
    ) {
        let (n, wi) = (unit(z, phi), unit(wz, wphi));
        let bits = |v: Vec3<f64>| v.to_array().map(f64::to_bits);
        prop_assert_eq!(bits(refract(wi, n, 1.0).unwrap()), bits(-wi));
        let (n, wi) = (n.cast::<f32>(), wi.cast::<f32>());
        prop_assert_eq!(refract(wi, n, 1.0_f32).unwrap().to_array().map(f32::to_bits), (-wi).to_array().map(f32::to_bits));
    }

    #[test]
    fn known_cosines_give_the_same_direction(cos in 1e-3..=1.0_f64, azimuth in 0.0..6.3_f64, eta in 0.3..3.5_f64) {
        let n = Vec3::new(0.0, 0.0, 1.0);
        let wi = unit(cos, azimuth);
        let direct = refract(wi, n, eta);
        let with = fresnel::dielectric(wi.z, eta).map(|f| refract_with_cosines(wi, n, eta, wi.z, f.cos_t));
        prop_assert_eq!(direct, with);
    }
}

#[test]
fn minus_zero_stays_minus_zero_at_equal_indices() {
    let t = refract(Vec3::new(0.0_f64, -0.0, 1.0), Vec3::new(0.0, 0.0, 1.0), 1.0).unwrap();
    assert!(t.x.is_sign_negative() && !t.y.is_sign_negative());
}

#[test]
fn refraction_obeys_snell_one_ulp_below_critical_and_vanishes_one_ulp_above() {
    // c² + n² crosses 1 between neighbouring doubles; the exact side is decided in integers in units of 2⁻¹⁰⁶.
    let integer = |x: f64| (x * 2.0_f64.powi(53)) as u128;
    let n = Vec3::new(0.0, 0.0, 1.0);
    for i in 0..1000 {
        let eta = 0.51 + 0.34 * f64::from(i) / 1000.0;
        let refracts = |c: f64| integer(c).pow(2) + integer(eta).pow(2) > 1 << 106;
        let mut c = ((1.0 - eta) * (1.0 + eta)).sqrt();
        while refracts(c) {
            c = c.next_down();
        }
        while !refracts(c) {
            c = c.next_up();
        }
        // c is now the first cosine above the critical one. The tangent's length need not match it to the last bit: only
        // its direction and c enter the result.
        let incident = |c: f64| Vec3::new(((1.0 - c) * (1.0 + c)).sqrt(), 0.0, c);
        assert!(refract(incident(c.next_down()), n, eta).is_none());
        let t = refract(incident(c), n, eta).expect("one unit in the last place inside");
        assert!(t.z < 0.0 && t.z > -4e-8 && (t.x + 1.0).abs() < 8.0 * f64::EPSILON, "{t:?}");
    }
}

#[test]
fn the_bk7_prism_deviates_as_its_closed_form_says() {
    // Symmetric passage through a 60° prism: 2·asin(n·sin 30°) − 60°, traced as two refractions.
    let glass = etalon_optics::RefractiveIndex::named("N-BK7").unwrap();
    for (nm, degrees) in
        [(404.6561, 39.835_336_6), (486.1327, 39.138_108_7), (587.5618, 38.646_698_5), (656.2725, 38.429_136_7)]
    {
        let index = glass.eval(nm);
        let entry = (index * 0.5).asin();
        let (n1, n2) = (unit(0.0, 150.0_f64.to_radians()), unit(0.0, 30.0_f64.to_radians()));
        let wi = unit(0.0, 150.0_f64.to_radians() + entry);
        let inside = refract(wi, n1, index).unwrap();
        let out = refract(-inside, n2, 1.0 / index).unwrap();
        let deviation = (-wi).dot(out).acos().to_degrees();
        // Seven decimals are printed.
        assert!((deviation - degrees).abs() < 6e-8, "{nm} nm: {deviation}");
    }
}

/// How many of a fixed set of arguments show a fault of `f`.
fn faults(f: Refract<f64>) -> usize {
    let n = unit(0.3, 1.0);
    let cases = (0..400).map(|i| {
        let (cos, eta) = (0.05 + 0.9 * f64::from(i % 20) / 20.0, 0.4 + 0.13 * f64::from(i / 20));
        (at_cosine(n, cos, f64::from(i)), eta)
    });
    cases.filter(|&(wi, eta)| fault(f, wi, n, eta).is_some()).count()
}

#[test]
fn mutants_of_snells_law_are_rejected() {
    assert_eq!(faults(refract), 0);
    // The relative index upside down.
    assert!(faults(|wi, n, eta| refract(wi, n, 1.0 / eta)) > 350);
    // The tangential part with the wrong sign: light bends back to the side it came from.
    assert!(faults(|wi, n, eta| refract(wi.reflected_about(n), n, eta)) > 200);
    // The normal part with the wrong sign.
    assert!(faults(|wi, n, eta| refract(wi, n, eta).map(|t| t - n * (2.0 * t.dot(n)))) > 200);
    // Straight on.
    assert!(faults(|wi, n, eta| refract(wi, n, eta).map(|_| -wi)) > 200);
    // Too seldom total reflection.
    assert!(faults(|wi, n, eta| refract(wi, n, eta).or(Some(-wi))) > 50);
    // A normal part off by one part in a million.
    assert!(faults(|wi, n, eta| refract(wi, n, eta).map(|t| t + n * (1e-6 * t.dot(n)))) > 200);
}
