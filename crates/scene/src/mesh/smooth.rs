//! Normals for a mesh that has none.

use glam::DVec3;

use crate::linear::{unit, unit_normal};
use crate::model::Mesh;

/// A normal for each vertex: the mean of the normals of the triangles around it, each weighted by its angle there
/// (Thürmer & Wüthrich 1998), so that how a surface is cut into triangles does not matter.
///
/// Vertices of no triangle with an area get (0, 0, 0): no normal.
pub fn smooth_normals(mesh: &Mesh) -> Vec<[f32; 3]> {
    let mut sums = vec![DVec3::ZERO; mesh.vertices.len()];
    for triangle in &mesh.triangles {
        let p = triangle.map(|i| DVec3::from(mesh.vertices[i as usize]));
        let Some(normal) = unit((p[1] - p[0]).cross(p[2] - p[0])) else { continue };
        for k in 0..3 {
            let (a, b) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
            let angle = a.cross(b).length().atan2(a.dot(b));
            sums[triangle[k] as usize] += angle * normal;
        }
    }
    sums.into_iter().map(|sum| unit_normal(sum.to_array())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_corner_of_a_cube_has_the_diagonal_for_normal_however_its_faces_are_cut() {
        // Three faces around the origin, one of them cut in two triangles: by area or by count it would weigh more.
        let mesh = Mesh {
            vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 4], [0, 4, 2], [0, 2, 3], [0, 3, 1]],
            ..Mesh::default()
        };
        let normal = smooth_normals(&mesh)[0];
        for component in normal {
            assert!((component - 1.0 / 3.0_f32.sqrt()).abs() < 1e-6, "{normal:?}");
        }
    }
}
