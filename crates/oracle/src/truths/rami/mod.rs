//! Canopies in the manner of RAMI, the intercomparison of models of light in vegetation (Pinty et al. 2001 and 2004, Widlowski et al. 2007).
//! Leaves are disks that reflect and pass light diffusely, with normals of every direction alike.
//!
//! RAMI compares models with each other. Here only what has an answer of its own is asked. Where nothing absorbs, all light comes back. A
//! canopy of very small leaves is a slab of radiative transfer.

mod leaves;
mod turbid;

use super::{SuiteCase, Truth};

/// All points of all sections.
#[must_use]
pub fn rami() -> Vec<SuiteCase> {
    [leaves::cases(), turbid::cases()].concat()
}

/// The leaf area over an area of ground.
const LEAF_AREA_INDEX: f64 = 3.0;
/// The height of the canopy.
const HEIGHT_M: f64 = 2.0;
/// Zenith angles of the sun.
const SUNS_DEG: [f64; 2] = [20.0, 50.0];

fn case(section: &'static str, title: &'static str, point: String, truth: Truth) -> SuiteCase {
    SuiteCase { section, title, point, unit: "", factor: 1.0, truth: truth.sees(0.005) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn names_differ_and_second_opinions_agree() {
        let cases = rami();
        let names: BTreeSet<&str> = cases.iter().map(|case| case.truth.name.as_str()).collect();
        assert_eq!(names.len(), cases.len());
        for case in &cases {
            let Some(second) = &case.truth.second_opinion else { continue };
            let (value, expected) = (second.value(), case.truth.value());
            assert!((value - expected).abs() <= second.tolerance * expected, "{}: {expected} {value}", case.truth.name);
        }
    }
}
