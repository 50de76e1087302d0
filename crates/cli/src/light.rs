//! What is said where no sample found light.

use etalon_transport::{Film, PixelRect};
use miette::{Report, Severity, miette};

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
                                        the lamps and surfaces by which light is looked for";
