//! Lights of pbrt.

use std::f64::consts::PI;

use etalon_optics::colour::rec709_luminance;
use etalon_scene::Encoding;
use etalon_scene::linear::is_similarity;
use glam::{DAffine3, DVec3};
use serde_json::{Value, json};

use super::Reading;
use super::parameters::Parameters;
use super::power::{Lamp, cone, of_illuminance, of_power};

impl Reading<'_, '_> {
    pub(super) fn light(&mut self, kind: &str, list: &Parameters, place: &str) -> Result<(), String> {
        let scale = list.number_or("scale", 1.0)?.max(0.0);
        let map = self.to_world();
        let from = DVec3::from(list.triple("from")?.unwrap_or([0.0; 3]));
        let to = DVec3::from(list.triple("to")?.unwrap_or([0.0, 0.0, 1.0]));
        let (position, along) = (map.transform_point3(from).to_array(), map.transform_vector3(to - from).to_array());
        let mut value = match kind {
            "distant" => {
                let irradiance = self.emitted(list, "L", scale * of_illuminance(list, 1.0)?)?;
                json!({ "type": "directional", "direction": along, "irradiance": irradiance })
            }
            "point" => {
                let intensity = self.emitted(list, "I", scale * of_power(list, 4.0 * PI)?)?;
                json!({ "type": "point", "position_m": position, "intensity": intensity })
            }
            "spot" => {
                let outer = list.number_or("coneangle", 30.0)?;
                let inner = outer - list.number_or("conedeltaangle", 5.0)?;
                let factor = of_power(list, cone(outer, inner))?;
                let intensity = self.emitted(list, "I", scale * factor)?;
                json!({
                    "type": "spot", "position_m": position, "direction": along, "intensity": intensity,
                    "half_angle_deg": outer, "inner_half_angle_deg": inner.clamp(0.0, outer),
                })
            }
            "infinite" => match list.string("filename").map(str::to_owned) {
                Some(file) => match self.sky(&file, list, scale, &map, place)? {
                    Some(sky) => sky,
                    None => return Ok(()),
                },
                None => {
                    let radiance = self.emitted(list, "L", scale * of_illuminance(list, PI)?)?;
                    json!({ "type": "environment", "radiance": radiance })
                }
            },
            other => {
                self.builder.leave_out(place, format!("the light \"{other}\" is not known, and is left out"));
                return Ok(());
            }
        };
        value["name"] = json!(format!("light, {place}"));
        self.builder.lights.push(value);
        list.list_unused(self.builder);
        Ok(())
    }

    /// A square image of all directions; `None`, and a note, if it cannot be read.
    fn sky(
        &mut self,
        file: &str,
        list: &Parameters,
        scale: f64,
        map: &DAffine3,
        place: &str,
    ) -> Result<Option<Value>, String> {
        let found = self.builder.image_file(file, Encoding::Auto, place);
        let name = match found {
            Ok((name, _)) => name,
            Err(why) => {
                self.builder.leave_out(place, format!("the sky is left out with its image: {why}"));
                list.mark_all();
                return Ok(None);
            }
        };
        if !is_similarity(&map.matrix3) {
            self.builder.leave_out(place, "its transform stretches the sky; this is ignored");
        }
        let scale = scale * self.illuminance_of_sky(list, &name, place)?;
        // The middle of the square is along +z, its right edge along +x and its lower edge along +y.
        Ok(Some(json!({
            "type": "environment",
            "image": {
                "file": name, "projection": "equal-area", "scale": scale, "up": map.matrix3.z_axis.to_array(),
                "forward": map.matrix3.y_axis.to_array(),
                "mirrored": map.matrix3.determinant() < 0.0,
            },
        })))
    }

    /// What the shapes from here on emit.
    pub(super) fn area_light(&mut self, kind: &str, list: &Parameters, place: &str) -> Result<Option<Lamp>, String> {
        if kind != "diffuse" {
            self.builder.leave_out(place, format!("the light \"{kind}\" is not known, and is left out"));
            return Ok(None);
        }
        let scale = list.number_or("scale", 1.0)?.max(0.0);
        let mut luminance = 1.0;
        let radiance = match list.string("filename").map(str::to_owned) {
            None => self.emitted(list, "L", scale)?,
            Some(file) => {
                let found = self.builder.image_file(&file, Encoding::Auto, place);
                match found {
                    Ok((name, mean)) => {
                        luminance = rec709_luminance(mean);
                        json!({ "type": "image", "file": name, "wrap": "clamp", "factor": [scale, scale, scale] })
                    }
                    Err(why) => {
                        self.builder.leave_out(place, format!("the light is left out with its image: {why}"));
                        list.mark_all();
                        return Ok(None);
                    }
                }
            }
        };
        let sides = if list.flag("twosided").unwrap_or(false) { "both" } else { "front" };
        let lamp = Self::lamp(json!({ "radiance": radiance, "sides": sides }), list, luminance)?;
        list.list_unused(self.builder);
        Ok(Some(lamp))
    }
}
