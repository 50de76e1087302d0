//! Media of pbrt.

use std::rc::Rc;

use serde_json::{Value, json};

use super::Reading;
use super::measured::measured;
use super::parameters::Parameters;
use crate::coefficient;

impl Reading<'_, '_> {
    pub(super) fn named_medium(&mut self, name: String, list: &Parameters, place: &str) -> Result<(), String> {
        let kind = list.string("type").unwrap_or("homogeneous").to_owned();
        let scale = list.number_or("scale", 1.0)?;
        let g = list.number_or("g", 0.0)?;
        let mut medium = match kind.as_str() {
            "homogeneous" => {
                let mut medium = match self.preset(list, scale, place) {
                    Some(medium) => medium,
                    None => self.coefficients(list, scale)?,
                };
                if list.get("Le").is_some() {
                    // There, too, a medium emits this times its absorption.
                    let factor = list.number_or("Lescale", 1.0)?;
                    medium["source_radiance"] = self.emitted(list, "Le", factor)?;
                }
                medium
            }
            "uniformgrid" => {
                let mut medium = self.coefficients(list, scale)?;
                medium["density"] = self.uniform_grid(list, place)?;
                self.light_of_grid(list, &mut medium, place)?;
                medium
            }
            "rgbgrid" => self.rgb_grid(list, scale, place)?,
            other => {
                self.builder.leave_out(
                    place,
                    format!(
                        "a medium of the kind \"{other}\" cannot be read: what \"{name}\" should fill stays clear, and neither scatters, \
                         absorbs nor emits light"
                    ),
                );
                list.mark_all();
                self.media.insert(name, None);
                return Ok(());
            }
        };
        if g != 0.0 {
            medium["phase"] = json!({ "type": "henyey-greenstein", "g": g });
        }
        list.list_unused(self.builder);
        self.media.insert(name, Some(Rc::new(medium)));
        Ok(())
    }

    /// What a grid emits, if that is the same in all of its cells.
    fn light_of_grid(&mut self, list: &Parameters, medium: &mut Value, place: &str) -> Result<(), String> {
        if list.get("temperature").is_some() {
            self.builder.leave_out(place, "\"temperature\" is left out: the medium does not glow");
        }
        for of_temperature in ["temperatureoffset", "temperaturescale"] {
            list.get(of_temperature);
        }
        if list.get("Le").is_none() {
            list.get("Lescale");
            return Ok(());
        }
        let scales = list.numbers("Lescale").unwrap_or(&[1.0]);
        let Some(factor) = scales.first().filter(|first| scales.iter().all(|scale| scale == *first)) else {
            self.builder.leave_out(place, "\"Le\" is left out: its \"Lescale\" varies from cell to cell");
            return Ok(());
        };
        let what = match scales.len() {
            1 => "\"Le\" is constant in its box; in pbrt it falls from the middle to half at each face",
            _ => "\"Le\" is constant in its box; in pbrt it falls to half over the outer half of the outermost cells",
        };
        self.builder.approximate(place, what);
        medium["source_radiance"] = self.emitted(list, "Le", *factor)?;
        Ok(())
    }

    /// Coefficients as they are stated; 1 where they are not.
    fn coefficients(&mut self, list: &Parameters, scale: f64) -> Result<Value, String> {
        Ok(json!({
            "absorption_per_m": self.coefficient(list, "sigma_a", scale)?,
            "scattering_per_m": self.coefficient(list, "sigma_s", scale)?,
        }))
    }

    /// A measured medium, by its name. What else is stated of its coefficients counts for nothing there.
    fn preset(&mut self, list: &Parameters, scale: f64, place: &str) -> Option<Value> {
        let name = list.string("preset")?;
        let Some([scattering, absorption]) = measured(name) else {
            let what = format!(
                "the medium \"{name}\" is not known: \"sigma_a\" and \"sigma_s\" hold, or 1 where they are not stated"
            );
            self.builder.leave_out(place, what);
            return None;
        };
        list.get("sigma_a");
        list.get("sigma_s");
        Some(json!({
            "absorption_per_m": coefficient(absorption.map(|v| v * scale)),
            "scattering_per_m": coefficient(scattering.map(|v| v * scale)),
        }))
    }

    /// Which media shapes from here on stand between.
    pub(super) fn medium_interface(&mut self, inside: &str, outside: &str, place: &str) {
        for name in [inside, outside] {
            if !name.is_empty() && !self.media.contains_key(name) {
                self.builder.leave_out(place, format!("there is no medium \"{name}\""));
            }
        }
        let known = |name: &str| self.media.get(name).cloned().flatten();
        (self.state.inside, self.state.outside) = (known(inside), known(outside));
    }

    /// Fills the space outside of all bodies with what stands outside of the camera or of a shape.
    pub(super) fn surround(&mut self, place: &str) {
        if let Some(medium) = self.state.outside.clone() {
            self.builder.surround((*medium).clone(), place);
        }
    }

    fn coefficient(&mut self, list: &Parameters, name: &str, scale: f64) -> Result<Value, String> {
        let colour = |rgb: [f64; 3]| json!({ "type": "rgb", "rgb": rgb, "scale": scale });
        let Some(parameter) = list.get(name) else { return Ok(json!(scale)) };
        match (parameter.kind.as_str(), parameter.numbers()) {
            ("rgb" | "color", [r, g, b]) => Ok(colour([*r, *g, *b])),
            ("float", [value]) => Ok(json!(value * scale)),
            ("spectrum", _) => {
                let table = self.table(parameter)?;
                let known = table.ok_or_else(|| format!("{}: \"{name}\" is no coefficient", parameter.place))?;
                let mut spectrum = known.spectrum("clamp");
                spectrum["scale"] = json!(scale);
                Ok(spectrum)
            }
            _ => Err(format!("{}: \"{name}\" is no coefficient", parameter.place)),
        }
    }
}
