//! Colours of vertices and faces, as reflectances of the format.

use etalon_scene::Mesh;
use serde_json::{Value, json};

use crate::checker::channels;

/// What materials of other programs show of a mesh, until the mesh is known: its name there, and a factor.
pub(crate) fn attribute(name: &str, factor: f64) -> Value {
    json!({ "type": "vertex-colours", "attribute": name, "factor": factor })
}

/// The first attribute that a material shows, and the factor on it.
pub(crate) fn attribute_of(material: &Value) -> Option<(String, f64)> {
    match material {
        Value::Object(map) => match map.get("attribute").and_then(Value::as_str) {
            Some(name) => Some((name.to_owned(), map.get("factor").and_then(Value::as_f64).unwrap_or(1.0))),
            None => map.values().find_map(attribute_of),
        },
        _ => None,
    }
}

/// Puts in the place of attributes the colours of the vertices, if they are `known`; whether there were others, which become grey.
pub(crate) fn resolve(material: &mut Value, known: Option<&(String, f64)>) -> bool {
    let Value::Object(map) = material else { return false };
    if map.contains_key("attribute") {
        let found = attribute_of(material);
        let is_known = found.is_some() && found.as_ref() == known;
        *material = if is_known { json!({ "type": "vertex-colours" }) } else { json!(0.5) };
        return !is_known;
    }
    // Each of them, not the first alone.
    map.values_mut().map(|value| resolve(value, known)).filter(|other| *other).count() > 0
}

/// Multiplies what a material reflects, and what glass passes, by the colours of the vertices; whether there is anything of this.
pub(crate) fn tint(material: &mut Value) -> bool {
    let Value::Object(map) = material else { return false };
    let mut found = false;
    if map.get("type").is_some_and(|kind| kind == "dielectric" || kind == "thin-dielectric") {
        map.entry("transmitted_tint").or_insert(json!(1.0));
    }
    for (key, value) in map.iter_mut() {
        if !matches!(key.as_str(), "reflectance" | "transmitted_tint") {
            found |= tint(value);
            continue;
        }
        found = true;
        *value = match channels(value) {
            Some(rgb) => json!({ "type": "vertex-colours", "factor": rgb }),
            None => json!({ "type": "vertex-colours", "image": value.take() }),
        };
    }
    found
}

/// Brings colours into [0, 1]; whether any were outside.
pub(crate) fn clamp(colours: &mut [[f32; 3]]) -> bool {
    let outside = |channel: &f32| !(0.0..=1.0).contains(channel);
    let any = colours.iter().flatten().any(outside);
    let within = |channel: f32| if channel.is_nan() { 0.0 } else { channel.clamp(0.0, 1.0) };
    colours.iter_mut().flatten().for_each(|channel| *channel = within(*channel));
    any
}

/// A mesh whose triangles share no vertices, each with the colour of its face.
pub(crate) fn of_faces(mesh: &Mesh, colours: &[[f32; 3]]) -> Mesh {
    Mesh { colours: colours.iter().flat_map(|colour| [*colour; 3]).collect(), ..apart(mesh) }
}

/// A mesh whose triangles share no vertices.
pub(crate) fn apart(mesh: &Mesh) -> Mesh {
    fn corners<T: Copy>(mesh: &Mesh, list: &[T]) -> Vec<T> {
        if list.is_empty() {
            return Vec::new();
        }
        mesh.triangles.iter().flatten().map(|corner| list[*corner as usize]).collect()
    }
    Mesh {
        vertices: corners(mesh, &mesh.vertices),
        normals: corners(mesh, &mesh.normals),
        uvs: corners(mesh, &mesh.uvs),
        colours: corners(mesh, &mesh.colours),
        triangles: (0..mesh.triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_are_found_and_replaced() {
        let mut material = json!({ "type": "blend", "first": { "type": "lambert", "reflectance": attribute("vertex_color", 2.0) },
            "second": { "type": "lambert", "reflectance": attribute("vertex_other", 1.0) }, "weight": 0.5 });
        let found = attribute_of(&material);
        assert_eq!(found, Some(("vertex_color".to_owned(), 2.0)));
        assert!(resolve(&mut material, found.as_ref()));
        assert_eq!(material["first"]["reflectance"], json!({ "type": "vertex-colours" }));
        assert_eq!(material["second"]["reflectance"], json!(0.5));
        assert_eq!(attribute_of(&material), None);
    }

    #[test]
    fn faces_of_one_colour_share_no_vertices() {
        let mesh = Mesh {
            vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
            uvs: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let made = of_faces(&mesh, &[[0.25; 3], [0.5; 3]]);
        assert_eq!((made.vertices.len(), made.uvs.len(), made.normals.len()), (6, 6, 0));
        assert_eq!(made.triangles, [[0, 1, 2], [3, 4, 5]]);
        assert_eq!((made.vertices[5], made.colours[2], made.colours[3]), ([0.0, 1.0, 0.0], [0.25; 3], [0.5; 3]));
    }

    #[test]
    fn colours_are_brought_into_their_range() {
        let mut colours = [[-0.5, 0.5, 2.0], [f32::NAN, 0.0, 1.0]];
        assert!(clamp(&mut colours));
        assert_eq!(colours, [[0.0, 0.5, 1.0], [0.0, 0.0, 1.0]]);
        assert!(!clamp(&mut colours));
    }
}
