//! The test cases of CIE 171:2006, *Test cases to assess the accuracy of lighting computer programs*, sections 5.2 to 5.14.
//!
//! The situations are the report's; every expected value is computed here, from closed forms or by quadrature. No number of its tables is used.
//! Geometry and reflectances that the report leaves open, or that a path tracer does not need, are stated with each case.

mod daylight;
mod glazing;
mod lamps;
mod reflection;

use serde_json::{Value, json};

use super::{
    SuiteCase, Truth,
    meters::measured,
    scene::{Scene, black, parallelogram},
};
use crate::vector::{Vec3, scale};

/// 683.002 lm/W · ∫ȳ dλ, lx per W·m⁻²·nm⁻¹ of a constant spectrum.
pub const LUX: f64 = 683.002 * 106.856_917;

/// What a section tests.
fn section_title(section: &str) -> &'static str {
    match section {
        "5.2" => "Point sources",
        "5.3" => "Area sources",
        "5.4" => "Flux conservation",
        "5.5" => "Transmittance of clear glass",
        "5.6" => "Reflection by a diffuse surface",
        "5.7" => "Reflection with an obstruction",
        "5.8" => "Interreflection in a closed room",
        "5.9" => "Sky component, roof opening without glass",
        "5.10" => "Sky component, roof opening with glass",
        "5.11" => "Sky and ground, facade opening without glass",
        "5.12" => "Sky and ground, facade opening with glass",
        "5.13" => "Facade opening below a horizontal mask",
        "5.14" => "Facade opening behind a vertical mask",
        _ => "",
    }
}

/// All points of all sections.
#[must_use]
pub fn cie171() -> Vec<SuiteCase> {
    [lamps::cases(), glazing::cases(), reflection::cases(), daylight::cases()].into_iter().flatten().collect()
}

const UP: Vec3 = [0.0, 0.0, 1.0];
const DOWN: Vec3 = [0.0, 0.0, -1.0];

/// A meter at a point.
fn at(position: Vec3, normal: Vec3) -> Value {
    json!({ "type": "irradiance", "position_m": position, "normal": normal })
}

/// A black screen.
fn screen(scene: Scene, origin: Vec3, u: Vec3, v: Vec3) -> Scene {
    scene.object(parallelogram(origin, u, v), black())
}

fn case(section: &'static str, point: String, unit: &'static str, factor: f64, truth: Truth) -> SuiteCase {
    SuiteCase { section, title: section_title(section), point, unit, factor, truth: truth.sees(0.005) }
}

/// Corners of a parallelogram, relative to a point.
fn corners(origin: Vec3, u: Vec3, v: Vec3, point: Vec3) -> [Vec3; 4] {
    let sum = |a: Vec3, b: Vec3| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
    let corner = sum(origin, scale(-1.0, point));
    [corner, sum(corner, u), sum(sum(corner, u), v), sum(corner, v)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_section_has_points_of_its_own_names() {
        let cases = cie171();
        let names: BTreeSet<&str> = cases.iter().map(|case| case.truth.name.as_str()).collect();
        assert_eq!(names.len(), cases.len());
        for section in 2..=14 {
            let section = format!("5.{section}");
            assert!(cases.iter().any(|case| case.section == section), "{section}");
            assert!(!section_title(&section).is_empty(), "{section}");
        }
    }

    #[test]
    fn second_opinions_agree() {
        // Every seventh of them takes seconds, all of them minutes.
        for case in cie171().iter().step_by(7) {
            let Some(second) = &case.truth.second_opinion else { panic!("{} has no second opinion", case.truth.name) };
            let value = second.value();
            let difference = (value - case.truth.value()).abs();
            assert!(
                difference <= second.tolerance * case.truth.value().abs(),
                "{}: {} {value}",
                case.truth.name,
                case.truth.value()
            );
        }
    }

    #[test]
    fn closed_rooms_have_the_known_illuminance() {
        // ρΦ/(96(1 − ρ)) of 10,000 lm: the part that is reflected.
        let cases = cie171();
        let rooms: Vec<f64> =
            cases.iter().filter(|case| case.section == "5.8").map(|case| case.truth.value() * case.factor).collect();
        let direct = 1e4 / 96.0;
        let reflected: Vec<f64> = rooms.iter().map(|total| (total - direct).round()).collect();
        assert_eq!(reflected, [104.0, 417.0, 938.0, 1979.0]);
    }
}
