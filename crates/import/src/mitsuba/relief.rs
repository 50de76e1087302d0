//! Bump and normal maps of Mitsuba.

use serde_json::{Value, json};

use super::Walk;
use super::element::Element;

impl Walk<'_, '_, '_> {
    /// What a `bumpmap` or a `normalmap` lays over its material, as a key of objects; nothing, and a note, if that is no image.
    pub(super) fn relief(&mut self, element: &Element) -> Result<Option<(&'static str, Value)>, String> {
        let (place, bumps) = (&element.place, element.plugin() == "bumpmap");
        let scale = if bumps { element.number("scale")?.unwrap_or(1.0) } else { 1.0 };
        let is_shadowed = element.flag("use_shadowing_function")?.unwrap_or(true);
        let texture = if bumps {
            element.nested("texture", self.ids)?.first().copied()
        } else {
            let stated = element.property("normalmap");
            stated.map(|stated| if stated.tag == "ref" { self.ids.of(stated) } else { Ok(stated) }).transpose()?
        };
        let Some(texture) = texture.filter(|texture| texture.plugin() == "bitmap") else {
            self.builder.leave_out(place, format!("the \"{}\" is left out: it has no bitmap", element.plugin()));
            return Ok(None);
        };
        texture.mark();
        let image = self.bitmap(texture)?;
        texture.list_unused(self.builder);
        let Some((mut map, _)) = image else { return Ok(None) };
        if bumps && map["filter"] == "nearest" {
            // Its derivative is 0 there, too.
            self.builder
                .leave_out(&texture.place, "heights without interpolation have no slopes: the bump map has no effect");
            return Ok(None);
        }
        if let Some(keys) = map.as_object_mut() {
            keys.remove("type");
        }
        map["terminator"] = json!(if is_shadowed { "shadowed" } else { "lost" });
        Ok(Some(if bumps {
            if let Some(keys) = map.as_object_mut() {
                keys.remove("filter");
            }
            // Three channels count by their luminance there, after the curve of sRGB.
            map["channel"] = json!("luminance");
            map["height_m"] = json!(scale);
            ("bump_map", map)
        } else {
            // Green is across red there, whichever way v grows.
            map["bitangent"] = json!("across-u");
            ("normal_map", map)
        }))
    }
}
