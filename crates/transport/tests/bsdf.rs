//! Materials, held to the oracle's laws.

use etalon_optics::{ComplexIndex, Frame, Lanes, Real, RefractiveIndex, Spectrum, Vec3};
use etalon_oracle::laws;
use etalon_scene::{MaterialKind, Metal};
use etalon_transport::bsdf::{Bsdf, BsdfSample, Shading};
use etalon_transport::mis::Density;
use etalon_transport::warp::uniform_sphere;
use proptest::prelude::*;
use std::f64::consts::PI;

const RANGE_NM: [f64; 2] = [380.0, 780.0];
const LAMBDA_NM: Lanes<f64, 4> = Lanes([440.0, 520.0, 600.0, 680.0]);

fn lambert(albedo: f64) -> Bsdf {
    Bsdf::new(&MaterialKind::Lambert { reflectance: Spectrum::Constant(albedo).into() }, RANGE_NM)
}

fn mirror() -> Bsdf {
    Bsdf::new(&MaterialKind::Mirror { reflectance: Spectrum::ONE.into() }, RANGE_NM)
}

fn glass(interior: RefractiveIndex) -> Bsdf {
    let exterior = RefractiveIndex::constant(1.0).unwrap();
    Bsdf::new(&MaterialKind::Dielectric { interior, exterior, priority: None, film: None }, RANGE_NM)
}

fn sample(bsdf: &Bsdf, n: Vec3<f64>, wo: Vec3<f64>, u: [f64; 3]) -> Option<BsdfSample<4>> {
    bsdf.sample(&LAMBDA_NM, &Shading::flat(n), wo, u)
}

/// The refracted direction that the material takes when the number that chooses is as large as can be.
fn refracted(direction: [f64; 3], normal: [f64; 3], eta: f64) -> Option<[f64; 3]> {
    // The normal is on the incident side: enter if η > 1, else leave a medium of index 1/η.
    let n = Vec3::from_array(normal);
    let (interior, n) = if eta >= 1.0 { (eta, n) } else { (1.0 / eta, -n) };
    let bsdf = glass(RefractiveIndex::constant(interior).unwrap());
    let wo = -Vec3::from_array(direction);
    let next = sample(&bsdf, n, wo, [f64::ONE_MINUS_EPSILON, 0.5, 0.5])?;
    let crosses = n.dot(next.wi) * n.dot(wo) < 0.0;
    crosses.then(|| next.wi.to_array())
}

#[test]
fn glass_obeys_snell_and_reflects_totally_where_it_must() {
    // 1/η is off by another rounding, hence twice epsilon.
    for seed in 1..=3 {
        laws::snell_sweep(refracted, 2.0 * f64::EPSILON, seed).assert();
        laws::total_internal_reflection(refracted, 2.0 * f64::EPSILON, seed).assert();
    }
}

#[test]
fn a_refraction_that_bends_the_wrong_way_is_rejected() {
    let mutant = |direction: [f64; 3], normal: [f64; 3], eta: f64| refracted(direction, normal, 1.0 / eta);
    assert!(!laws::snell_sweep(mutant, 2.0 * f64::EPSILON, 1).pass);
}

#[test]
fn mirrors_metals_and_glass_obey_the_law_of_reflection() {
    let metal = Bsdf::new(
        &MaterialKind::Conductor { metal: Metal::Index(ComplexIndex::named("Au").unwrap()), film: None },
        RANGE_NM,
    );
    for bsdf in [mirror(), metal, glass(RefractiveIndex::constant(1.5).unwrap())] {
        let reflect = |direction: [f64; 3], normal: [f64; 3]| {
            let wo = -Vec3::<f64>::from_f64(direction);
            sample(&bsdf, Vec3::from_f64(normal), wo, [0.0, 0.5, 0.5]).unwrap().wi.to_array()
        };
        laws::mirror_reflection(reflect, f64::EPSILON, 1).assert();
    }
}

/// The probability of reflection as the material acts on it: the number at which it begins to refract, by bisection.
fn reflection_threshold(bsdf: &Bsdf, n: Vec3<f64>, wo: Vec3<f64>) -> f64 {
    let reflects = |u: f64| sample(bsdf, n, wo, [u, 0.5, 0.5]).is_some_and(|s| n.dot(s.wi) * n.dot(wo) > 0.0);
    let (mut low, mut high) = (0.0, 1.0);
    while high - low > 1e-15 {
        let middle = 0.5 * (low + high);
        if reflects(middle) { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Unpolarised reflectance by the oracle's own evaluation.
fn fresnel_reflectance(cos: f64, eta: f64) -> f64 {
    laws::fresnel_exact(cos, eta).reflectance()
}

fn direction_at(cos: f64, turns: f64) -> Vec3<f64> {
    let (sin_phi, cos_phi) = f64::sin_cos_turns(turns);
    let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
    Vec3::new(sin * cos_phi, sin * sin_phi, cos)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn glass_reflects_with_the_probability_of_fresnel(cos in 1e-3..1.0_f64, turns in 0.0..1.0_f64, n in 1.01..3.0_f64) {
        let bsdf = glass(RefractiveIndex::constant(n).unwrap());
        let up = Vec3::new(0.0, 0.0, 1.0);
        let wo = direction_at(cos, turns);
        let exact = fresnel_reflectance(wo.z, n);
        // The bisection's own resolution.
        prop_assert!((reflection_threshold(&bsdf, up, wo) - exact).abs() <= 4e-15);
        // Light that goes the other way along the same path is reflected just as often (Stokes), and the two radiance
        // factors undo each other: reciprocity with n².
        let inward = sample(&bsdf, up, wo, [1.0 - f64::EPSILON, 0.5, 0.5]).unwrap();
        let back = sample(&bsdf, up, inward.wi, [1.0 - f64::EPSILON, 0.5, 0.5]).unwrap();
        prop_assert!((back.wi - wo).length() < 1e-13 / cos);
        prop_assert!((reflection_threshold(&bsdf, up, inward.wi) - exact).abs() <= 1e-13 / cos);
        prop_assert!((inward.weight[0] * inward.eta * inward.eta - 1.0).abs() <= 4.0 * f64::EPSILON);
        prop_assert!((inward.weight[0] * back.weight[0] - 1.0).abs() <= 8.0 * f64::EPSILON);
    }

    /// Under a sky of radiance 1, the balance heuristic over lanes must read 1 at every wavelength, whichever the hero:
    /// the expectation over the four heroes and both outcomes is a finite sum.
    #[test]
    fn dispersive_glass_loses_no_wavelength(cos in 0.05..1.0_f64, turns in 0.0..1.0_f64, leaving in any::<bool>()) {
        let index = RefractiveIndex::named("N-SF11").unwrap();
        let bsdf = glass(index.clone());
        let up = Vec3::new(0.0, 0.0, if leaving { -1.0 } else { 1.0 });
        let wo = direction_at(cos, turns);
        let mut read = [0.0; 4];
        let mut read_by_mutant = [0.0; 4];
        for hero in 0..4 {
            let lambda = Lanes::<f64, 4>::from_fn(|lane| LAMBDA_NM[(hero + lane) % 4]);
            let n = index.eval(lambda[0]);
            let reflectance = fresnel_reflectance(cos, if leaving { 1.0 / n } else { n });
            for (u, probability) in [(0.0, reflectance), (1.0 - f64::EPSILON, 1.0 - reflectance)] {
                if probability == 0.0 {
                    continue;
                }
                let s = bsdf.sample::<4>(&lambda, &Shading::flat(up), wo, [u, 0.5, 0.5]).unwrap();
                let mutant_density = Lanes::<f64, 4>::ONE;
                for lane in 0..4 {
                    // Radiance without its n².
                    let value = s.weight[lane] * s.eta * s.eta;
                    read[(hero + lane) % 4] += probability * value / s.lane_density.sum();
                    read_by_mutant[(hero + lane) % 4] += probability * value / mutant_density.sum();
                }
            }
        }
        for wavelength in 0..4 {
            prop_assert!((read[wavelength] - 1.0).abs() < 1e-13, "{read:?}");
        }
        // A lane kept after dispersion, or a hero that is not weighted up, is seen.
        let reflects_totally = read_by_mutant.iter().all(|r| (r - 1.0).abs() < 1e-13);
        prop_assert!(!reflects_totally || (leaving && cos < 0.85), "{read_by_mutant:?}");
    }

    #[test]
    fn lambert_is_reciprocal_and_reports_the_density_it_draws_with(
        u0 in 0.0..1.0_f64, u1 in 0.0..1.0_f64, v0 in 0.0..1.0_f64, v1 in 0.0..1.0_f64, below in any::<bool>(),
    ) {
        let bsdf = lambert(0.6);
        let n = uniform_sphere([v1, v0]);
        let frame = Frame::from_normal(if below { -n } else { n });
        let wo = frame.to_world(direction_at(0.01 + 0.99 * v0, v1));
        let s = sample(&bsdf, n, wo, [0.3, u0, u1]).unwrap();
        let (f_cos, density) = bsdf.eval::<4>(&LAMBDA_NM, &Shading::flat(n), wo, s.wi);
        let density = density[0];
        prop_assert_eq!(s.density, Density::SolidAngle(density));
        // weight = f·cos/p, up to the rounding of one quotient.
        prop_assert!((s.weight[0] * density - f_cos[0]).abs() <= 4.0 * f64::EPSILON * f_cos[0]);
        let (back, _) = bsdf.eval::<4>(&LAMBDA_NM, &Shading::flat(n), s.wi, wo);
        let (forth, reverse) = (f_cos[0] / n.dot(s.wi).abs(), back[0] / n.dot(wo).abs());
        prop_assert!((forth - reverse).abs() <= 8.0 * f64::EPSILON * forth);
        // Nothing passes through.
        prop_assert!(bsdf.eval::<4>(&LAMBDA_NM, &Shading::flat(n), wo, -s.wi).0.is_zero());
    }
}

#[test]
fn lambert_integrates_to_its_albedo_and_its_density_to_one() {
    let bsdf = lambert(0.6);
    let n = Vec3::new(0.0, 0.0, 1.0);
    let wo = direction_at(0.3, 0.1);
    let m = 512;
    let at = |i: usize| (i as f64 + 0.5) / m as f64;
    let (mut albedo, mut total) = (0.0, 0.0);
    for i in 0..m * m {
        let wi = uniform_sphere([at(i % m), at(i / m)]);
        let (f_cos, density) = bsdf.eval::<4>(&LAMBDA_NM, &Shading::flat(n), wo, wi);
        albedo += f_cos[0] * 4.0 * PI / (m * m) as f64;
        total += density[0] * 4.0 * PI / (m * m) as f64;
    }
    // The integrand is linear in the grid's variable on both halves, whose border is a grid line: exact to rounding.
    assert!((albedo - 0.6).abs() < 1e-12 && (total - 1.0).abs() < 1e-12, "{albedo} {total}");
}

#[test]
fn ten_thousand_reflections_keep_a_direction_of_unit_length() {
    // Hard case 33.
    let bsdf = mirror();
    let mut w = Vec3::new(0.6, 0.0, 0.8);
    for i in 0..10_000_u32 {
        let u = f64::from(i) * 0.618_033_988_749_894_9 % 1.0;
        let n = uniform_sphere([u, f64::from(i) * 0.414_213_562_373_095 % 1.0]);
        w = sample(&bsdf, n.normalized(), w, [0.5; 3]).unwrap().wi;
    }
    let drift = (w.length() - 1.0).abs();
    assert!(drift < 1e-12, "{drift}");
}
