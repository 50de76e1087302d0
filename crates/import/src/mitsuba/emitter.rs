//! Lights of Mitsuba.

use serde_json::{Value, json};

use super::Walk;
use super::colour::Of;
use super::element::Element;
use crate::missing;

impl Walk<'_, '_, '_> {
    pub(super) fn emitter(&mut self, element: &Element) -> Result<(), String> {
        let place = element.place.clone();
        let name = element.attribute("id").map_or_else(|| format!("light, {place}"), str::to_owned);
        let one = || json!({ "type": "illuminant", "name": "D65", "scale": 1 });
        let value = match element.plugin() {
            "constant" => {
                let radiance = self.colour(element, "radiance", Of::Emission)?.unwrap_or_else(one);
                json!({ "type": "environment", "radiance": radiance })
            }
            "envmap" => {
                let file =
                    element.string("filename").ok_or_else(|| format!("{place}: it has no \"filename\""))?.to_owned();
                let Some((file, _)) = self.image(&file, false, &place) else { return Ok(()) };
                let to_world = self.placement(element)?;
                // The middle of the image is along +z, its upper edge along +y; the centres of its first row lie at the pole.
                json!({
                    "type": "environment",
                    "image": {
                        "file": file, "scale": element.number("scale")?.unwrap_or(1.0).max(0.0),
                        "projection": "latitude-longitude-at-poles", "mirrored": to_world.matrix3.determinant() < 0.0,
                        "up": to_world.matrix3.y_axis.to_array(), "forward": to_world.matrix3.z_axis.to_array(),
                    },
                })
            }
            "point" => {
                let intensity = self.colour(element, "intensity", Of::Emission)?.unwrap_or_else(one);
                let position = match element.triple("position")? {
                    Some(position) => position,
                    None => self.placement(element)?.translation.to_array(),
                };
                json!({ "type": "point", "position_m": position, "intensity": intensity })
            }
            "spot" => self.spot(element)?,
            "projector" => self.projector(element)?,
            "directional" => {
                let irradiance = self.colour(element, "irradiance", Of::Emission)?.unwrap_or_else(one);
                let direction = match element.triple("direction")? {
                    Some(direction) => direction,
                    None => self.placement(element)?.matrix3.z_axis.to_array(),
                };
                json!({ "type": "directional", "direction": direction, "irradiance": irradiance })
            }
            other => {
                self.builder.leave_out(&place, missing::emitter(other));
                return Ok(());
            }
        };
        let mut value = value;
        value["name"] = json!(name);
        self.builder.lights.push(value);
        element.list_unused(self.builder);
        Ok(())
    }

    /// The emission of a shape's own emitter, if that is its surface.
    pub(super) fn emission(&mut self, shape: &Element) -> Result<Option<Value>, String> {
        let emitters = shape.nested("emitter", self.ids)?;
        let Some(emitter) = emitters.first() else { return Ok(None) };
        if emitter.plugin() != "area" {
            // It shines as if it stood beside the shape.
            self.emitter(emitter)?;
            return Ok(None);
        }
        let one = json!({ "type": "illuminant", "name": "D65", "scale": 1 });
        let radiance = self.colour(emitter, "radiance", Of::Shining)?.unwrap_or(one);
        emitter.list_unused(self.builder);
        self.builder.spend(&radiance, &emitter.place)?;
        Ok(Some(json!({ "radiance": radiance, "sides": "front" })))
    }
}
