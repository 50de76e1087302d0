//! Equation (1) against Snell's law: the oracle's, and what can be said of it beyond that.

use std::num::NonZero;

use etalon_oracle::laws;
use etalon_whitted::{
    Arithmetic, Figure, Published, RefractionRule, Settings, Vec3, reflect, refract, refract_as_published,
    refract_snell, render, vec3,
};
use proptest::prelude::*;

fn length(v: Vec3) -> f64 {
    Published::dot(v, v).sqrt()
}

fn unit() -> impl Strategy<Value = Vec3> {
    (-1.0..1.0_f64, 0.0..std::f64::consts::TAU).prop_map(|(z, phi)| {
        let r = (1.0 - z * z).sqrt();
        vec3(r * phi.cos(), r * phi.sin(), z)
    })
}

/// A unit direction and a unit normal that opposes it.
fn incidence() -> impl Strategy<Value = (Vec3, Vec3)> {
    (unit(), unit()).prop_map(|(d, n)| if Published::dot(d, n) > 0.0 { (d, -1.0 * n) } else { (d, n) })
}

/// Largest departure from Snell's law: ri sin θ = sin θ' in the plane of incidence, beyond the surface. The length of `k`
/// must not matter, or the check would pass equation (1) as published, whose tangential part is right.
fn snell_error(ri: f64, d: Vec3, n: Vec3, k: Vec3) -> f64 {
    let k = k / length(k);
    let sines = length(ri * d.cross(n) - k.cross(n));
    if Published::dot(k, n) <= 0.0 { sines } else { f64::INFINITY }
}

/// A formula as the oracle wants it: η is the index beyond over the index before, `ri` its reciprocal.
fn subject(formula: fn(f64, Vec3, Vec3) -> Option<Vec3>) -> impl FnMut([f64; 3], [f64; 3], f64) -> Option<[f64; 3]> {
    move |d, n, eta| formula(1.0 / eta, Vec3(d), Vec3(n)).map(|k| k.0)
}

#[test]
fn the_oracles_laws_accept_the_corrected_equation() {
    for seed in 0..10 {
        laws::snell_sweep(subject(refract_snell::<Published>), f64::EPSILON, seed).assert();
        laws::total_internal_reflection(subject(refract_snell::<Published>), f64::EPSILON, seed).assert();
        let mirror = |d, n| reflect::<Published>(Vec3(d), Vec3(n)).0;
        laws::mirror_reflection(mirror, f64::EPSILON, seed).assert();
    }
}

#[test]
fn the_oracles_snell_law_rejects_equation_1_as_published() {
    for seed in 0..10 {
        let verdict = laws::snell_sweep(subject(refract_as_published::<Published>), f64::EPSILON, seed);
        assert!(!verdict.pass, "{verdict}");
    }
    // One ray is enough, also where nothing bends.
    for eta in [1.0, 1.5, 1.0 / 1.2] {
        let crossing = laws::Crossing { direction: [0.6, 0.0, -0.8], normal: [0.0, 0.0, 1.0], eta };
        let mut published = subject(refract_as_published::<Published>);
        let verdict = laws::snell(&crossing, published(crossing.direction, crossing.normal, eta), f64::EPSILON);
        assert!(!verdict.pass, "{verdict}");
        // Nor is it a matter of its length, which is not 1.
        let unit = published(crossing.direction, crossing.normal, eta).map(|k| Published::normalize(Vec3(k)).0);
        let verdict = laws::snell(&crossing, unit, f64::EPSILON);
        assert!(!verdict.pass, "{verdict}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 2000,
        rng_seed: proptest::test_runner::RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn the_corrected_equation_obeys_snells_law((d, n) in incidence(), ri in 0.4..2.5_f64) {
        let sine = ri * length(d.cross(n));
        match refract_snell::<Published>(ri, d, n) {
            // A dozen roundings of numbers below 2.5; at the critical angle the root takes the square root of one of them,
            // but the tangential part does not see it.
            Some(k) => {
                prop_assert!(snell_error(ri, d, n, k) < 1e-14);
                prop_assert!((length(k) - 1.0).abs() < 1e-14);
                prop_assert!(sine < 1.0 + 1e-15);
            }
            None => prop_assert!(sine > 1.0 - 1e-15),
        }
    }

    #[test]
    fn equation_1_as_published_breaks_snells_law((d, n) in incidence(), ri in 0.4..2.5_f64) {
        let (cosine, sine) = (-Published::dot(d, n), length(d.cross(n)));
        // Along the normal and along the surface it points the right way; it is wrong everywhere between.
        prop_assume!(cosine > 0.05 && sine > 0.05);
        if let Some(k) = refract_as_published::<Published>(ri, d, n) {
            prop_assert!(snell_error(ri, d, n, k) > 1e-4);
        }
    }

    #[test]
    fn nothing_bends_at_an_index_of_one((d, n) in incidence()) {
        let k = refract_snell::<Published>(1.0, d, n).unwrap();
        // The root is of c² with an error of ε, from the subtraction from 1: ε / 2c when that is small, √ε at grazing incidence.
        let cosine = Published::dot(d, n).abs();
        let cancelled = (f64::EPSILON / cosine).min(f64::EPSILON.sqrt());
        prop_assert!(length(k - d) < 1e-14 + cancelled);
        let bent = refract_as_published::<Published>(1.0, d, n).unwrap();
        prop_assert!((length(bent - d) - 2.0 * cosine).abs() < 1e-14 + cancelled);
    }

    #[test]
    fn no_index_and_no_direction_gives_a_nan(d in unit(), n in unit(), index in 0.01..100.0_f64, scale in 1e-6..1e6_f64) {
        for rule in [RefractionRule::AsPublished, RefractionRule::Snell] {
            if let Some(k) = refract::<Published>(rule, index, scale * d, n) {
                prop_assert!(k.0.iter().all(|x| x.is_finite()), "{rule:?}: {k:?}");
            }
        }
    }

    #[test]
    fn a_body_gives_back_what_it_cannot_let_out((d, inward) in incidence(), index in 1.0..3.0_f64) {
        let n = -1.0 * inward;
        let k = refract::<Published>(RefractionRule::Snell, index, d, n).unwrap();
        let sine = index * length(d.cross(n));
        prop_assume!((sine - 1.0).abs() > 1e-12);
        prop_assert_eq!(Published::dot(k, n) < 0.0, sine > 1.0);
        if sine > 1.0 {
            prop_assert!(length(k - reflect::<Published>(d, n)) < 1e-14);
        }
    }
}

#[test]
fn glass_spheres_render_without_a_nan_by_either_rule_and_differently() {
    let mut scene = Figure::ALL[1].scene();
    for object in &mut scene.objects {
        object.material.refraction = vec3(0.9, 0.9, 0.9);
        object.material.refraction_index = 1.5;
    }
    let small = |refraction| Settings {
        width: const { NonZero::new(160).unwrap() },
        height: const { NonZero::new(120).unwrap() },
        refraction,
        ..Settings::default()
    };
    let [published, snell] =
        [RefractionRule::AsPublished, RefractionRule::Snell].map(|rule| render(&scene, &small(rule)));
    assert_eq!((published.non_finite(), snell.non_finite()), (0, 0));
    assert_ne!(published, snell);
}
