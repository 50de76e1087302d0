//! The base colour of a material: a factor, and perhaps an image that it multiplies.

use serde_json::{Value, json};

use super::material::{Materials, decimal};
use crate::builder::Builder;
use crate::reflectance;

impl Materials<'_> {
    /// It as a spectrum of the format, with the set of texture coordinates of its image.
    pub(super) fn base_colour(
        &mut self,
        surface: &gltf::material::PbrMetallicRoughness<'_>,
        place: &str,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> (Value, Option<u32>) {
        let [r, g, b, _] = surface.base_color_factor().map(decimal);
        let base = [r, g, b].map(|v| v.clamp(0.0, 1.0));
        let at = format!("{place}.pbrMetallicRoughness.baseColorTexture");
        let image = surface.base_color_texture().and_then(|info| self.image(&info, &at, buffers, builder));
        match image {
            Some((mut image, set)) => {
                if base != [1.0; 3] {
                    image["factor"] = json!(base);
                }
                (image, Some(set))
            }
            None => (reflectance(base), None),
        }
    }
}
