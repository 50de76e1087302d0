//! A replayed path, for people.

use std::fmt::Write;

use etalon_transport::replay::{Event, Replay};

/// The path, a line an event.
pub(crate) fn describe(path: &Replay) -> String {
    let mut text = format!("wavelengths {} nm\n", list(&path.wavelengths_nm));
    for event in &path.events {
        // Writing to a String cannot fail.
        let _ = match event {
            Event::Vertex { vertex, object, position_m, beta } => {
                writeln!(text, "vertex {vertex}: \"{object}\" at {} m, throughput {}", list(position_m), list(beta))
            }
            Event::Scattering { vertex, position_m, beta } => {
                writeln!(text, "vertex {vertex}: medium at {} m, throughput {}", list(position_m), list(beta))
            }
            Event::Fluorescence { vertex, excitation_nm } => {
                writeln!(text, "  fluorescence at vertex {vertex}, excited at {} nm", list(excitation_nm))
            }
            Event::Light { vertex, found, radiance, .. } => {
                writeln!(text, "  light at vertex {vertex} by {found}: {}", list(radiance))
            }
            Event::End { because } => writeln!(text, "end: {because}"),
        };
    }
    if let Some(xyz) = &path.light_paths_xyz {
        let _ = writeln!(text, "light paths of this sample bring XYZ {}", list(xyz));
    }
    let _ = write!(text, "radiance {} W·m⁻²·sr⁻¹·nm⁻¹, XYZ {}", list(&path.radiance), list(&path.xyz));
    text
}

fn list(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|value| format!("{value:.9e}")).collect();
    format!("({})", values.join(", "))
}
