//! What is said where light is missing: what no path finds by the plan, and what no sample found.

use etalon_transport::plan::{Lost, MissingLight, MissingPair};
use etalon_transport::{Film, PixelRect};
use miette::{Report, Severity, miette};

/// Pairs of a lamp and a surface that are named; the others are counted.
const MOST_NAMED: usize = 8;

/// A pair in words.
fn name(pair: &MissingPair) -> String {
    let lost = match pair.lost {
        Lost::Reflected => "reflects",
        Lost::Transmitted => "transmits",
        Lost::ReflectedAndTransmitted => "reflects or transmits",
    };
    let MissingPair { light, object, material, surface, .. } = pair;
    format!("light of \"{light}\" that \"{object}\" {lost} (material \"{material}\": {surface})")
}

/// The pairs of a plan in words, and how many more there are.
pub(crate) fn missing_pairs(missing: &MissingLight) -> Vec<String> {
    let mut lines: Vec<String> = missing.listed.iter().take(MOST_NAMED).map(name).collect();
    match missing.pairs - lines.len() as u64 {
        0 => {}
        1 => lines.push("and 1 more pair of a lamp and a surface".to_owned()),
        more => lines.push(format!("and {more} more pairs of a lamp and a surface")),
    }
    lines
}

/// A warning of the light that no path finds, if there is any.
pub(crate) fn missing(missing: &MissingLight) -> Option<Report> {
    (missing.pairs > 0).then(|| {
        miette!(
            severity = Severity::Warning,
            code = "missing-light",
            help = "only shadow rays find a lamp without an area, and they cannot pass a smooth surface: give the lamp an area (an object with \
                    `emission`), or the surface a roughness (`alpha`). `etalon explain --json` lists the pairs",
            "some light is missing from the picture:\n  {}",
            missing_pairs(missing).join("\n  ")
        )
    })
}

/// A warning of a picture in which no sample found light.
pub(crate) fn without_light(film: &Film, rect: PixelRect) -> Option<Report> {
    let found = rect.pixels().any(|(x, y)| film.pixel(x, y).xyz()[1] != 0.0);
    let sampled = || rect.pixels().any(|(x, y)| film.pixel(x, y).count() > 0);
    (!found && sampled()).then(|| {
        miette!(
            severity = Severity::Warning,
            code = "no-light",
            help = NO_LIGHT_HELP,
            "no sample found light: the picture is black and its error is unknown"
        )
    })
}

/// Where to look if no light was found.
pub(crate) const NO_LIGHT_HELP: &str = "check that a lamp shines on what the camera sees, with nothing opaque between. `etalon explain` names \
                                        lamps whose light no path finds, because of a mirror or smooth glass";
