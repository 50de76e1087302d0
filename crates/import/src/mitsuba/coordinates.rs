//! Texture coordinates of Mitsuba's round shapes and cubes.
//!
//! Those of a rectangle are ours. A sphere's run from the pole +z: u around it from +x, v down to −z. A cylinder's u runs around the axis from
//! the first direction across it. Both are ours after a turn, the sphere's with v turned over. A disk's are polar. A cube has a square on each face:
//! it becomes a mesh.

use std::f64::consts::PI;

use etalon_scene::Mesh;
use glam::{DAffine3, DMat3, DVec3};
use serde_json::{Map, Value, json};

use super::Walk;
use super::shape::{Dressed, Reach};
use crate::number::{has_directions, has_image};
use crate::round::sphere_turn;
use crate::uv;

impl Walk<'_, '_, '_> {
    /// A shape of the format and the box around it, with the texture coordinates of Mitsuba's shape if anything of the object follows them.
    pub(super) fn with_coordinates(&mut self, dressed: &mut Dressed, shape: Value, reach: Reach) -> (Value, Reach) {
        let named = dressed.look.material.as_str().and_then(|name| self.builder.materials.get(name));
        let material = named.unwrap_or(&dressed.look.material).clone();
        let follows = has_image(&material)
            || has_directions(&material)
            || !dressed.look.detail.is_empty()
            || dressed.emission.as_ref().is_some_and(has_image);
        let point = |key: &str| DVec3::from_array([0, 1, 2].map(|k| shape[key][k].as_f64().unwrap_or(0.0)));
        let radius = &shape["radius_m"];
        match shape["type"].as_str() {
            Some("sphere") if follows => {
                let centre = point("center_m");
                dressed.map = dressed.map * DAffine3::from_translation(centre) * sphere_turn();
                dressed.look.material = material;
                turn_v_over(&mut dressed.look.material);
                turn_images_over(&mut dressed.look.detail);
                dressed.emission.iter_mut().for_each(turn_v_over);
                let around = reach.map(|corner| (DVec3::from(corner) - centre).to_array());
                (json!({ "type": "sphere", "radius_m": radius }), around)
            }
            Some("cylinder") if follows => {
                let Some((turn, length)) = cylinder_turn(point("start_m"), point("end_m")) else {
                    return (shape, reach);
                };
                dressed.map *= turn;
                let r = radius.as_f64().unwrap_or(1.0);
                let along_z = json!({ "type": "cylinder", "start_m": [0, 0, 0], "end_m": [0, 0, length], "radius_m": radius, "capped": false });
                (along_z, [[-r, -r, 0.0], [r, r, length]])
            }
            Some("disk") if follows => {
                let mut polar = shape;
                polar["coordinates"] = json!("polar");
                (polar, reach)
            }
            Some("box") if follows => (self.own_mesh(&cube()), reach),
            _ => (shape, reach),
        }
    }

    fn own_mesh(&mut self, mesh: &Mesh) -> Value {
        json!({ "type": "mesh", "file": self.builder.mesh_file(mesh), "shading": "flat" })
    }
}

/// From a cylinder along z, whose u begins at −x, to Mitsuba's from `start` to `end`; and the length.
pub(super) fn cylinder_turn(start: DVec3, end: DVec3) -> Option<(DAffine3, f64)> {
    let length = (end - start).length();
    let n = (end - start).try_normalize()?;
    // The directions across an axis, as both programs choose them (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
    let sign = 1.0_f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    let s = DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    let t = DVec3::new(b, sign + n.y * n.y * a, -n.y);
    let frame = DAffine3::from_mat3_translation(DMat3::from_cols(s, t, n), start);
    Some((frame * DAffine3::from_rotation_z(PI), length))
}

/// Lays all images of a material, an emission or an object over (u, 1 − v).
pub(super) fn turn_v_over(value: &mut Value) {
    match value {
        Value::Object(map) => turn_images_over(map),
        Value::Array(list) => list.iter_mut().for_each(turn_v_over),
        _ => {}
    }
}

/// The same for all values of a map.
pub(super) fn turn_images_over(map: &mut Map<String, Value>) {
    if let Some(lies) = uv::of(map) {
        uv::put(&uv::over_v_from_above(&lies), map);
    }
    map.values_mut().for_each(turn_v_over);
}

/// The cube from −1 to 1 with a square of coordinates on each face, as Mitsuba has them.
pub(super) fn cube() -> Mesh {
    // The corners of each face at (0, 1), (1, 1), (1, 0) and (0, 0).
    let faces: [[[i8; 3]; 4]; 6] = [
        [[1, -1, -1], [1, -1, 1], [-1, -1, 1], [-1, -1, -1]],
        [[1, 1, -1], [-1, 1, -1], [-1, 1, 1], [1, 1, 1]],
        [[1, -1, -1], [1, 1, -1], [1, 1, 1], [1, -1, 1]],
        [[1, -1, 1], [1, 1, 1], [-1, 1, 1], [-1, -1, 1]],
        [[-1, -1, 1], [-1, 1, 1], [-1, 1, -1], [-1, -1, -1]],
        [[1, 1, -1], [1, -1, -1], [-1, -1, -1], [-1, 1, -1]],
    ];
    let vertices = faces.iter().flatten().map(|corner| corner.map(f64::from)).collect();
    let uvs = (0..6).flat_map(|_| [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]).collect();
    let triangles = (0..6).flat_map(|face| [[0, 1, 2], [3, 0, 2]].map(|t| t.map(|c: u32| 4 * face + c))).collect();
    Mesh { vertices, uvs, triangles, ..Mesh::default() }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::round::disk;

    #[test]
    fn a_disk_and_a_cube_face_outward_and_have_their_areas() {
        for (mesh, area) in [(disk(), PI), (cube(), 24.0)] {
            let mut sum = 0.0;
            for triangle in &mesh.triangles {
                let [a, b, c] = triangle.map(|corner| DVec3::from(mesh.vertices[corner as usize]));
                let across = (b - a).cross(c - a);
                sum += 0.5 * across.length();
                let outward = if area > PI { a + b + c } else { DVec3::Z };
                assert!(across.dot(outward) > 0.0, "{triangle:?}");
            }
            assert!((sum / area - 1.0).abs() < 1.1e-4, "{sum}");
        }
    }

    /// Places and coordinates as Mitsuba 3.9.1 prints them for rays that meet its shapes.
    #[test]
    fn spheres_and_cylinders_have_the_coordinates_of_mitsuba() {
        // Ours: u = ½ + atan2(x, z)/2π, v = ½ + asin(y)/π; and ½ + atan2(y, x)/2π, z.
        let p = sphere_turn().inverse().transform_point3(DVec3::new(0.796_89, 0.339_067, 0.5));
        let (u, v) = (0.5 + p.x.atan2(p.z) / TAU, 0.5 + p.y.asin() / PI);
        assert!((u - 0.064_025_4).abs() < 1e-5 && (1.0 - v - 0.333_333).abs() < 1e-5, "{u} {v}");
        let (turn, length) = cylinder_turn(DVec3::new(1.0, 2.0, 3.0), DVec3::new(2.0, 2.0, 5.0)).unwrap();
        let p = turn.inverse().transform_point3(DVec3::new(2.545_41, 2.354_54, 4.0));
        let (u, v) = (0.5 + p.y.atan2(p.x) / TAU, p.z / length);
        assert!((u - 0.057_681_4).abs() < 1e-5 && (v - 0.709_081).abs() < 1e-5, "{u} {v}");
    }

    #[test]
    fn an_image_turned_over_shows_the_same_at_the_other_v() {
        let mut value = json!({ "reflectance": { "type": "image", "uv_scale": [2.0, -3.0], "uv_offset": [0.1, 1.5] } });
        turn_v_over(&mut value);
        assert_eq!(value["reflectance"]["uv_scale"], json!([2.0, 3.0]));
        assert_eq!(value["reflectance"]["uv_offset"], json!([0.1, -1.5]));
    }
}
