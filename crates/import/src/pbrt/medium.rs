//! Media of pbrt.

use std::rc::Rc;

use serde_json::{Value, json};

use super::Reading;
use super::parameters::Parameters;
use crate::matrix::steps;
use crate::medium::vol;

impl Reading<'_, '_> {
    pub(super) fn named_medium(&mut self, name: String, list: &Parameters, place: &str) -> Result<(), String> {
        let kind = list.string("type").unwrap_or("homogeneous").to_owned();
        let scale = list.number("scale")?.unwrap_or(1.0);
        if list.string("preset").is_some() {
            self.builder.leave_out(place, "the preset is left out: the default coefficients stand for it");
        }
        let g = list.number("g")?.unwrap_or(0.0);
        let mut medium = json!({
            "absorption_per_m": self.coefficient(list, "sigma_a", [0.0011, 0.0024, 0.014], scale)?,
            "scattering_per_m": self.coefficient(list, "sigma_s", [2.55, 3.21, 3.77], scale)?,
        });
        if g != 0.0 {
            medium["phase"] = json!({ "type": "henyey-greenstein", "g": g });
        }
        match kind.as_str() {
            "homogeneous" => {
                if list.get("Le").is_some() {
                    let factor = list.number("Lescale")?.unwrap_or(1.0);
                    // There the coefficient of absorption is no factor of what a medium emits, but for a grid's.
                    self.builder
                        .approximate(place, "Le becomes a source radiance: the medium emits it times its absorption");
                    medium["source_radiance"] = self.emitted(list, "Le", factor)?;
                }
            }
            "uniformgrid" => {
                let count = |key: &str| -> Result<u32, String> {
                    let count = list.number(key)?.unwrap_or(1.0);
                    match count {
                        1.0..=4096.0 => Ok(count as u32),
                        _ => Err(format!("{place}: \"{key}\" is {count}: 1 to 4096 cells are read")),
                    }
                };
                let cells = [count("nx")?, count("ny")?, count("nz")?];
                let densities = list.numbers("density").unwrap_or(&[]);
                let wanted = cells.iter().map(|count| u64::from(*count)).product::<u64>();
                if densities.len() as u64 != wanted {
                    let found = densities.len();
                    return Err(format!("{place}: {wanted} cells have {found} densities"));
                }
                let box_m = [list.triple("p0")?.unwrap_or([0.0; 3]), list.triple("p1")?.unwrap_or([1.0; 3])];
                let file = vol(cells, box_m, densities);
                let file = self.builder.add_file("density", "vol", file);
                let mut density = json!({ "type": "grid", "file": file });
                let transform = steps(&self.to_world());
                if !transform.is_null() {
                    density["transform"] = transform;
                }
                medium["density"] = density;
            }
            other => {
                self.builder.leave_out(place, format!("the medium \"{other}\" is not known: it is left out"));
                list.mark_all();
                return Ok(());
            }
        }
        list.list_unused(self.builder);
        self.media.insert(name, Rc::new(medium));
        Ok(())
    }

    /// Which media shapes from here on stand between.
    pub(super) fn medium_interface(&mut self, inside: &str, outside: &str, place: &str) {
        let known = |name: &str, media: &std::collections::HashMap<String, Rc<Value>>| media.get(name).cloned();
        for name in [inside, outside] {
            if !name.is_empty() && !self.media.contains_key(name) {
                self.builder.leave_out(place, format!("there is no medium \"{name}\""));
            }
        }
        self.state.inside = known(inside, &self.media);
        self.state.outside = known(outside, &self.media);
    }

    /// Fills the space outside of all bodies with what stands outside of the camera or of a shape.
    pub(super) fn surround(&mut self, place: &str) {
        if let Some(medium) = self.state.outside.clone() {
            self.builder.surround((*medium).clone(), place);
        }
    }

    fn coefficient(&mut self, list: &Parameters, name: &str, default: [f64; 3], scale: f64) -> Result<Value, String> {
        let colour = |rgb: [f64; 3]| json!({ "type": "rgb", "rgb": rgb, "scale": scale });
        let Some(parameter) = list.get(name) else { return Ok(colour(default)) };
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
