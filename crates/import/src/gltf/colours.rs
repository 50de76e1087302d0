//! Colours of the vertices of glTF, by which the base colour is multiplied.

use gltf::accessor::Dimensions;
use gltf::material::AlphaMode;
use gltf::mesh::Semantic;
use serde_json::Value;

use super::Walk;
use super::accessor::numbers;
use super::layers::tint_base;
use crate::vertex_colours::clamp;

impl Walk<'_, '_> {
    /// The colours of the vertices; none where all are white.
    pub(super) fn colours(
        &mut self,
        primitive: &gltf::Primitive<'_>,
        alpha: AlphaMode,
        count: usize,
        place: &str,
    ) -> Result<Vec<[f32; 3]>, String> {
        let Some(accessor) = primitive.get(&Semantic::Colors(0)) else { return Ok(Vec::new()) };
        let at = format!("{place}.attributes.COLOR_0");
        let mut translucent = false;
        let mut colours: Vec<[f32; 3]> = match accessor.dimensions() {
            Dimensions::Vec4 => {
                let with_alpha = numbers::<4>(&accessor, self.buffers)?;
                translucent = with_alpha.iter().any(|[.., alpha]| *alpha < 1.0);
                with_alpha.into_iter().map(|[r, g, b, _]| [r, g, b].map(|c| c as f32)).collect()
            }
            _ => numbers::<3>(&accessor, self.buffers)?.into_iter().map(|rgb| rgb.map(|c| c as f32)).collect(),
        };
        if colours.len() != count {
            return Err(format!("{place}: {} colours for {count} vertices", colours.len()));
        }
        if translucent && alpha != AlphaMode::Opaque {
            self.builder.leave_out(&at, "its alpha is ignored");
        }
        if clamp(&mut colours) {
            self.builder.approximate(at, "some are no reflectances: they are clamped to 0 to 1");
        }
        let white = colours.iter().flatten().all(|channel| *channel == 1.0);
        Ok(if white { Vec::new() } else { colours })
    }

    /// A material whose base colour is multiplied by the colours of the vertices.
    pub(super) fn tinted(&mut self, material: Value, place: &str) -> Result<Value, String> {
        let own = material.as_str().and_then(|name| self.builder.materials.get(name));
        let mut tinted = own.unwrap_or(&material).clone();
        if !tint_base(&mut tinted) {
            self.builder.leave_out(format!("{place}.attributes.COLOR_0"), "its material has no base colour");
        }
        self.builder.spend(&tinted, place)?;
        Ok(tinted)
    }
}
