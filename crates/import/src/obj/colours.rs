//! Colours of the vertices of an OBJ file (`v x y z r g b`).

use etalon_scene::Mesh;
use serde_json::{Value, json};

use crate::Builder;
use crate::vertex_colours::{clamp, tint};

/// Kinds of materials that colours of vertices multiply.
const TINTED: [&str; 4] = ["lambert", "plastic", "conductor", "blend"];

/// The material of a mesh with colours: they multiply what it reflects. Without one it is the colours themselves.
pub(super) fn painted(
    material: Value,
    is_named: bool,
    mesh: &mut Mesh,
    place: &str,
    builder: &mut Builder<'_>,
) -> Result<Value, String> {
    if clamp(&mut mesh.colours) {
        builder.approximate(place, "some colours of its vertices are no reflectances: they are clamped to 0 to 1");
    }
    let own = material.as_str().and_then(|name| builder.materials.get(name));
    let mut painted = own.unwrap_or(&material).clone();
    if !is_named {
        painted["reflectance"] = json!({ "type": "vertex-colours" });
    } else if !TINTED.iter().any(|kind| painted["type"] == *kind) || !tint(&mut painted) {
        builder.leave_out(place, "the colours of its vertices are left out: its material has no diffuse colour");
        mesh.colours.clear();
        return Ok(material);
    }
    builder.spend(&painted, place)?;
    Ok(painted)
}
