//! The sides of meshes that have normals.

use etalon_scene::Mesh;
use glam::DVec3;

/// Turns the triangles over whose corners go the other way round than the normals at them say. Mitsuba and pbrt take the side that the normals
/// point to for the front, a scene that from which the corners go counter-clockwise.
pub(crate) fn turn_to_normals(mesh: &mut Mesh) {
    let Mesh { vertices, normals, triangles, .. } = mesh;
    if normals.is_empty() {
        return;
    }
    for triangle in triangles {
        let [a, b, c] = triangle.map(|i| DVec3::from(vertices[i as usize]));
        let normal: DVec3 = triangle.map(|i| DVec3::from(normals[i as usize].map(f64::from))).into_iter().sum();
        if (b - a).cross(c - a).dot(normal) < 0.0 {
            triangle.swap(1, 2);
        }
    }
}
