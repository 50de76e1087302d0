//! Normal and bump maps of pbrt.

use etalon_scene::Encoding;
use serde_json::{Map, Value, json};

use super::Reading;
use super::parameters::Parameters;
use super::spectrum::number_image;
use crate::number::Number;

impl Reading<'_, '_> {
    /// What a material bends normals by, as keys of its objects. Beside a normal map a displacement counts for nothing, as there.
    pub(super) fn relief(&mut self, list: &Parameters) -> Result<Map<String, Value>, String> {
        let mut detail = Map::new();
        if let Some(parameter) = list.get("normalmap") {
            let (place, file) = (parameter.place.clone(), parameter.strings().first().cloned().unwrap_or_default());
            match self.builder.image_file(&file, Encoding::Linear, &place) {
                Ok((name, _)) => {
                    // Green is normal × tangent in the axes of pbrt, which points the other way in a mirrored world.
                    let mut map = json!({ "file": name, "bitangent": "across-u" });
                    if self.world.matrix3.determinant() < 0.0 {
                        map["strength"] = json!([1.0, -1.0]);
                    }
                    detail.insert("normal_map".to_owned(), map);
                }
                Err(why) => self.builder.leave_out(&place, format!("the normal map is left out: {why}")),
            }
        } else if let Some(parameter) = list.get("displacement").filter(|parameter| parameter.kind == "texture") {
            let name = parameter.strings().first().cloned().unwrap_or_default();
            let texture = self.textures.get(&name);
            let texture = texture.ok_or_else(|| format!("{}: there is no texture \"{name}\"", parameter.place))?;
            // What is the same everywhere bends nothing.
            if texture["type"] == "image"
                && let Number::Image(mut map, _) = number_image(texture)
            {
                let factor = map.as_object_mut().and_then(|keys| keys.remove("factor"));
                map["height_m"] = factor.unwrap_or(json!(1.0));
                detail.insert("bump_map".to_owned(), map);
            }
        }
        Ok(detail)
    }
}
