//! Spots of Mitsuba. Between two angles their intensity falls off in proportion to the angle, as that of luminaires does between the angles of
//! their file.

use etalon_optics::colour::{LUMINOUS_EFFICACY, cie_y_integral_nm, luminance_of, rec709_luminance};
use glam::DAffine3;
use serde_json::{Value, json};

use super::Walk;
use super::colour::Of;
use super::element::Element;
use crate::table::Table;

impl Walk<'_, '_, '_> {
    /// A light of the format: a `spot` with a sharp edge, or a `luminaire`.
    pub(super) fn spot(&mut self, element: &Element) -> Result<Value, String> {
        let d65 = || json!({ "type": "illuminant", "name": "D65", "scale": 1 });
        let intensity = self.colour(element, "intensity", Of::Emission)?.unwrap_or_else(d65);
        let to_world = self.placement(element)?;
        let cutoff = element.number("cutoff_angle")?.unwrap_or(20.0);
        let mut lamp = self.bare_spot(element, &to_world, &intensity, cutoff)?;
        if let Some(image) = self.colour(element, "texture", Of::Texture)? {
            self.put_slide_of_spot(&mut lamp, image, &to_world, cutoff, &element.place)?;
        }
        Ok(lamp)
    }

    fn bare_spot(
        &mut self,
        element: &Element,
        to_world: &DAffine3,
        intensity: &Value,
        cutoff: f64,
    ) -> Result<Value, String> {
        let beam = element.number("beam_width")?.unwrap_or(0.75 * cutoff).min(cutoff);
        if beam < cutoff
            && cutoff <= 90.0
            && beam >= 0.0
            && let Some(luminance) = luminance(intensity).filter(|luminance| *luminance > 0.0)
        {
            return Ok(self.luminaire(to_world, intensity, luminance, [beam, cutoff]));
        }
        if beam < cutoff {
            let what = "between beam_width and cutoff_angle the light falls off by another curve";
            self.builder.approximate(&element.place, what);
        }
        Ok(json!({
            "type": "spot", "position_m": to_world.translation.to_array(), "direction": to_world.matrix3.z_axis.to_array(),
            "intensity": intensity, "half_angle_deg": cutoff, "inner_half_angle_deg": beam,
        }))
    }

    /// A luminaire with a file of its own, in which the intensity along the axis is 1.
    fn luminaire(&mut self, to_world: &DAffine3, intensity: &Value, luminance: f64, [beam, cutoff]: [f64; 2]) -> Value {
        let (angles, values) = match beam {
            0.0 => (format!("0 {cutoff}"), "1 0"),
            _ => (format!("0 {beam} {cutoff}"), "1 1 0"),
        };
        let count = angles.split(' ').count();
        let text = format!("IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 {count} 1 1 2 0 0 0\n1 1 0\n{angles}\n0\n{values}\n");
        let file = self.builder.add_file("spot", "ies", text.into_bytes());
        // The format asks for candelas, whose spectrum is to any scale.
        let scale = LUMINOUS_EFFICACY * cie_y_integral_nm() * luminance;
        json!({
            "type": "luminaire", "file": file, "position_m": to_world.translation.to_array(), "spectrum": intensity, "scale": scale,
            "nadir": to_world.matrix3.z_axis.to_array(), "forward": to_world.matrix3.x_axis.to_array(),
        })
    }
}

/// The luminance of a spectrum of the format in units of the constant spectrum 1, if it is a number, a colour or a table.
fn luminance(spectrum: &Value) -> Option<f64> {
    let scale = spectrum["scale"].as_f64().unwrap_or(1.0);
    match (spectrum["type"].as_str(), &spectrum["rgb"]) {
        (None, _) => spectrum.as_f64(),
        (Some("rgb"), rgb) => {
            let channel = |c: usize| rgb[c].as_f64();
            Some(scale * rec709_luminance([channel(0)?, channel(1)?, channel(2)?]))
        }
        (Some("illuminant"), _) => Some(scale),
        (Some("tabulated"), _) => {
            let table = Table::of_spectrum(spectrum)?;
            Some(scale * luminance_of(|nm| table.at_or_zero(nm)))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn luminances_are_in_units_of_the_constant_spectrum() {
        let flat = json!({ "type": "tabulated", "wavelengths_nm": [300, 900], "values": [2, 2], "outside": "zero" });
        for (spectrum, expected) in [
            (json!(2.5), 2.5),
            (json!({ "type": "rgb", "rgb": [1, 1, 1], "scale": 3 }), 3.0),
            (json!({ "type": "illuminant", "name": "D65", "scale": 4 }), 4.0),
            (flat, 2.0),
        ] {
            assert!((luminance(&spectrum).unwrap() - expected).abs() < 1e-12, "{spectrum}");
        }
        assert_eq!(luminance(&json!({ "type": "blackbody", "temperature_k": 3000 })), None);
    }
}
