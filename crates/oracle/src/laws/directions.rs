//! Which directions, wavelengths and random numbers a law is tried on, with counterexamples shrunk by proptest.

use std::f64::consts::TAU;

use proptest::{
    prelude::*,
    test_runner::{Config, RngSeed, TestCaseError, TestError, TestRunner},
};

use crate::{Uniform, Verdict, vector::representable};

/// Unit vectors; shrink towards the normal (0, 0, 1). A third are within .05 of grazing and some are exactly axial.
pub(crate) fn unit_vectors(both_sides: bool, epsilon: f64) -> impl Strategy<Value = [f64; 3]> + Clone {
    let drop_from_pole = prop_oneof![
        4 => 0.0..1.0_f64,
        2 => 0.95..0.999_999_f64,
        1 => Just(0.0),
    ];
    let below = if both_sides { prop::bool::ANY.boxed() } else { Just(false).boxed() };
    (drop_from_pole, 0.0..TAU, below).prop_map(move |(drop, phi, below)| {
        let z = 1.0 - drop;
        let sine = (drop * (2.0 - drop)).sqrt();
        representable([sine * phi.cos(), sine * phi.sin(), if below { -z } else { z }], epsilon)
    })
}

/// Tries a law on `cases` values of a strategy. The verdict is the worst instance; when one fails, proptest shrinks it and
/// the verdict is that of the simplest failing input.
pub(crate) fn for_all<S: Strategy>(
    law: &str,
    strategy: S,
    cases: u32,
    seed: u64,
    judge: impl Fn(S::Value) -> Verdict,
) -> Verdict {
    let config = Config { cases, rng_seed: RngSeed::Fixed(seed), failure_persistence: None, ..Config::default() };
    let worst = std::cell::RefCell::new(None::<Verdict>);
    let count = std::cell::Cell::new(0_u32);
    let mut runner = TestRunner::new(config);
    let outcome = runner.run(&strategy, |value| {
        let verdict = judge(value);
        count.set(count.get() + 1);
        let pass = verdict.pass;
        let mut held = worst.borrow_mut();
        // The last failing verdict is that of the shrunk input.
        if !pass || held.as_ref().is_none_or(|held| held.pass && verdict.severity() > held.severity()) {
            *held = Some(verdict);
        }
        if pass { Ok(()) } else { Err(TestCaseError::fail("the law is broken")) }
    });
    let count = count.get();
    let mut verdict = match (worst.into_inner(), outcome) {
        (Some(mut verdict), Ok(())) => {
            verdict.evidence = format!("{count} instances; nearest to the bound: {}", verdict.evidence);
            verdict
        }
        (Some(mut verdict), Err(TestError::Fail(..))) => {
            verdict.evidence = format!("shrunk counterexample: {}", verdict.evidence);
            verdict
        }
        (_, Err(reason)) => Verdict::broken(law, format!("no instance could be made: {reason}")),
        (None, Ok(())) => Verdict::broken(law, "no instance was tried"),
    };
    verdict.law = law.to_owned();
    verdict
}

/// The directions that expensive laws are tried on: the normal, 45°, near grazing, and random ones, on both sides.
pub(crate) fn few_directions(both_sides: bool, epsilon: f64, seed: u64) -> Vec<[f64; 3]> {
    let mut numbers = Uniform::new(seed);
    let mut cosines = vec![1.0, std::f64::consts::FRAC_1_SQRT_2, 0.05];
    cosines.extend((0..2).map(|_| numbers.between(0.01, 1.0)));
    let mut directions = Vec::new();
    for side in if both_sides { &[1.0, -1.0][..] } else { &[1.0] } {
        for cosine in &cosines {
            let phi = numbers.between(0.0, TAU);
            let sine = (1.0 - cosine * cosine).sqrt();
            directions.push(representable([sine * phi.cos(), sine * phi.sin(), side * cosine], epsilon));
        }
    }
    directions
}
