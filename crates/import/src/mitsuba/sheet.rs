//! Polarisers and retarders of Mitsuba, whose axes are stated in the frame of the surface.

use glam::DVec3;
use serde_json::{Value, json};

use super::Walk;
use super::colour::Of;
use super::element::Element;
use super::material::Look;
use super::shape::Dressed;

impl Walk<'_, '_, '_> {
    /// A linear polariser or retarder; its axis is that in the frame of a surface that grows with x and y. What has no like here becomes a
    /// sheet that lets as much light through and changes nothing of its polarisation.
    pub(super) fn sheet(&mut self, element: &Element) -> Result<Look, String> {
        let place = &element.place;
        let transmittance = self.colour(element, "transmittance", Of::Reflectance)?.unwrap_or(json!(1.0));
        // Mitsuba 3.9 turns a retarder from growing u toward growing v, and a polariser the other way.
        let theta = self.degrees(element, "theta", 0.0)?;
        let axis = axis(if element.plugin() == "retarder" { theta } else { -theta });
        let polariser = json!({ "type": "polariser", "axis": axis, "transmittance": transmittance });
        match element.plugin() {
            "retarder" => {
                if transmittance != json!(1.0) {
                    self.builder.leave_out(place, "the transmittance of a retarder is ignored");
                }
                let delay = self.degrees(element, "delta", 90.0)?;
                let what = "a retarder delays as much at every angle, where Mitsuba takes the cosine as a factor: it delays 3.5 % more at 15° \
                            from the normal, 15 % more at 30°, twice as much at 60°";
                self.builder.approximate(place, what);
                Ok(Look::of(json!({ "type": "retarder", "axis": axis, "retardance_deg": delay })))
            }
            "circular" => {
                element.flag("left_handed")?;
                let what = "a \"circular\" polariser cannot be converted: it lets half of the light through, and changes no polarisation";
                self.builder.approximate(place, what);
                Ok(Look::plain(json!({ "type": "black" }), 1.0 - unpolarised(&polariser)))
            }
            _ if element.flag("polarizing")? == Some(false) => {
                Ok(Look::plain(json!({ "type": "black" }), 1.0 - unpolarised(&polariser)))
            }
            _ => Ok(Look::of(polariser)),
        }
    }

    fn degrees(&mut self, element: &Element, name: &str, default: f64) -> Result<f64, String> {
        let Some(stated) = element.property(name) else { return Ok(default) };
        let target = if stated.tag == "ref" { self.ids.of(stated)? } else { stated };
        target.mark();
        match target.attribute("value").and_then(|text| text.trim().parse::<f64>().ok()).filter(|v| v.is_finite()) {
            Some(degrees) => Ok(degrees),
            None => {
                target.children.iter().for_each(Element::mark);
                self.builder.approximate(&element.place, format!("\"{name}\" is not a number: it becomes {default}"));
                Ok(default)
            }
        }
    }

    /// The sheet that an object is, if it is one.
    pub(super) fn sheet_of(&self, dressed: &Dressed) -> Option<Value> {
        let own = dressed.look.material.as_str().and_then(|name| self.builder.materials.get(name));
        Some(own.unwrap_or(&dressed.look.material)).filter(|material| is_sheet(material)).cloned()
    }

    /// Makes of a sheet, which has another frame at each place, one that changes nothing of polarisation.
    pub(super) fn without_axis(&mut self, dressed: &mut Dressed, sheet: &Value, shape: &str, place: &str) {
        let what = format!(
            "the axis of a \"{}\" on a {shape} cannot be converted, only that on rectangles and flat meshes: it lets as much light through, and \
             changes no polarisation",
            sheet["type"].as_str().unwrap_or_default()
        );
        self.builder.approximate(place, what);
        dressed.look.opacity *= 1.0 - unpolarised(sheet);
        dressed.look.material = json!({ "type": "black" });
    }

    /// Turns the axis of a sheet to where the frame of its shape has it. Meshes have frames of their own.
    pub(super) fn place_sheet(&mut self, dressed: &mut Dressed, shape: &str, place: &str) {
        let Some(mut sheet) = self.sheet_of(dressed).filter(|_| !matches!(shape, "obj" | "ply" | "serialized")) else {
            return;
        };
        if shape != "rectangle" {
            return self.without_axis(dressed, &sheet, shape, place);
        }
        let [x, y] = frame_axis(&sheet);
        let matrix = dressed.map.matrix3;
        let outward = (matrix.inverse().transpose() * DVec3::Z).normalize_or_zero();
        let normal = if dressed.flipped { -outward } else { outward };
        let along = matrix.x_axis.normalize_or_zero();
        let across = normal.cross(along);
        // A transform takes the axis to its place as it does a normal.
        let placed = matrix.transpose() * (x * along + y * across);
        let placed = placed.normalize_or_zero();
        let moved = (placed.cross(DVec3::new(x, y, 0.0))).length() > 1e-12;
        if moved {
            sheet["axis"] = json!(placed.to_array().map(|v| v + 0.0));
            dressed.look.material = sheet;
        }
    }
}

/// The axis of a sheet in the frame of its surface.
pub(super) fn frame_axis(sheet: &Value) -> [f64; 2] {
    [0, 1].map(|k| sheet["axis"][k].as_f64().unwrap_or(0.0))
}

/// Along the surface, at an angle from growing u.
fn axis(degrees: f64) -> [f64; 3] {
    // Quarter turns are exact.
    let quarters = degrees / 90.0;
    if quarters.fract() == 0.0 {
        return if quarters.rem_euclid(2.0) == 0.0 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    }
    let (sin, cos) = degrees.to_radians().sin_cos();
    [cos, sin, 0.0]
}

/// Whether a material is a polarising sheet.
pub(super) fn is_sheet(material: &Value) -> bool {
    matches!(material["type"].as_str(), Some("polariser" | "retarder"))
}

/// What a sheet lets through of light without polarisation, as a number.
pub(super) fn unpolarised(sheet: &Value) -> f64 {
    if sheet["type"] == "retarder" {
        return 1.0;
    }
    let numbers =
        |value: &Value| -> Vec<f64> { value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect() };
    let stated = &sheet["transmittance"];
    let all = match stated.as_f64() {
        Some(number) => vec![number],
        None => [numbers(&stated["rgb"]), numbers(&stated["values"])].concat(),
    };
    0.5 * all.iter().sum::<f64>() / (all.len().max(1) as f64)
}
