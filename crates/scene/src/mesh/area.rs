//! Areas of triangles, and which have one.

use glam::{DMat3, DVec3};

use crate::linear::unit;
use crate::model::Mesh;

/// Whether a triangle of a mesh has an area, to rounding. A scene drops those that have none.
pub fn has_area(mesh: &Mesh, triangle: &[u32; 3]) -> bool {
    span_area(triangle.map(|i| mesh.vertices[i as usize]))
}

/// The normal of each triangle of a mesh times its area, after a linear map.
pub fn area_vectors(mesh: &Mesh, map: &DMat3) -> impl Iterator<Item = DVec3> {
    mesh.triangles.iter().map(|corners| {
        let [a, b, c] = corners.map(|i| DVec3::from(mesh.vertices[i as usize]));
        0.5 * (*map * (b - a)).cross(*map * (c - a))
    })
}

/// Whether a triangle's normal can be told at all: three corners whose edges are not parallel to rounding.
fn span_area([a, b, c]: [[f64; 3]; 3]) -> bool {
    // Of most the angle at a corner is no smaller than 1e-8, and their sizes are usual, so that nothing overflows.
    let [a, b, c] = [a, b, c].map(DVec3::from);
    let (u, v) = (b - a, c - a);
    let (squared, products) = (u.cross(v).length_squared(), u.length_squared() * v.length_squared());
    if (1e-200..1e200).contains(&products) && squared > 1e-16 * products {
        return true;
    }
    // Halved, so that the difference of two finite coordinates is finite.
    let [a, b, c] = [a, b, c].map(|p| 0.5 * p);
    // Two edges from the corner with the largest angle would be best; with unit vectors any two will do down to needles
    // of 1e-15.
    let edges = [b - a, c - b, a - c];
    let Some(units) = unit(edges[0]).zip(unit(edges[1])).zip(unit(edges[2])) else { return false };
    let ((u, v), w) = units;
    let sines = [u.cross(v), v.cross(w), w.cross(u)].map(DVec3::length);
    // Each component of a vector product of unit vectors is rounded three times.
    sines.into_iter().fold(0.0, f64::max) > 4.0 * f64::EPSILON
}
