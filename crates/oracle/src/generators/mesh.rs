//! Closed meshes, and rays at their vertices, edges and faces.

use super::Shape;
use crate::{
    Uniform,
    vector::{add, cross, dot, length, representable, scale, sub},
};

/// A ray and what it is aimed at, for the evidence.
#[derive(Clone, Debug, PartialEq)]
pub struct Aim {
    /// Origin, m.
    pub origin_m: [f64; 3],
    /// Direction, not necessarily of unit length.
    pub direction: [f64; 3],
    /// What it is aimed at.
    pub target: String,
}

/// A closed triangle mesh: vertices in m and vertex indices.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedMesh {
    /// What it is, for the evidence.
    pub name: String,
    /// Positions, m.
    pub vertices: Vec<[f64; 3]>,
    /// Triangles, outward by the right-hand rule.
    pub triangles: Vec<[u32; 3]>,
}

impl ClosedMesh {
    /// A cube of half side 1.
    #[must_use]
    pub fn cube() -> Self {
        let vertices = (0..8).map(|i| [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { 1.0 } else { -1.0 })).collect();
        let quads: [[u32; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        Self { name: "cube".into(), vertices, triangles }
    }

    /// A unit sphere of `rows` × `columns` facets.
    #[must_use]
    pub fn sphere(rows: u32, columns: u32) -> Self {
        let mut vertices = vec![[0.0, 0.0, 1.0]];
        for i in 1..rows {
            let theta = std::f64::consts::PI * f64::from(i) / f64::from(rows);
            for j in 0..columns {
                let phi = std::f64::consts::TAU * f64::from(j) / f64::from(columns);
                vertices.push([theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]);
            }
        }
        vertices.push([0.0, 0.0, -1.0]);
        let last = vertices.len() as u32 - 1;
        let at = |i: u32, j: u32| 1 + (i - 1) * columns + j % columns;
        let mut triangles = Vec::new();
        for j in 0..columns {
            triangles.push([0, at(1, j), at(1, j + 1)]);
            triangles.push([last, at(rows - 1, j + 1), at(rows - 1, j)]);
            for i in 1..rows - 1 {
                triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        Self { name: format!("sphere of {rows} × {columns}"), vertices, triangles }
    }

    /// Two cones of `sides` needles each, `slenderness` times as long as the ring's radius of 1.
    #[must_use]
    pub fn needles(sides: u32, slenderness: f64) -> Self {
        let mut vertices = vec![[0.0, 0.0, slenderness], [0.0, 0.0, -slenderness]];
        for j in 0..sides {
            let phi = std::f64::consts::TAU * f64::from(j) / f64::from(sides);
            vertices.push([phi.cos(), phi.sin(), 0.0]);
        }
        let at = |j: u32| 2 + j % sides;
        let triangles = (0..sides).flat_map(|j| [[0, at(j), at(j + 1)], [1, at(j + 1), at(j)]]).collect();
        Self { name: format!("{sides} needles of {slenderness}"), vertices, triangles }
    }

    /// The same mesh moved, m, with the vertices rounded to what the subject can represent.
    #[must_use]
    pub fn moved(mut self, by_m: [f64; 3], epsilon: f64) -> Self {
        for vertex in &mut self.vertices {
            *vertex = representable(add(*vertex, by_m), epsilon);
        }
        self.name = format!("{} moved by {by_m:?}", self.name);
        self
    }

    /// A point near the middle: the mean of the vertices.
    #[must_use]
    pub fn middle(&self) -> [f64; 3] {
        let sum = self.vertices.iter().copied().fold([0.0; 3], add);
        scale(1.0 / self.vertices.len() as f64, sum)
    }

    /// Six times the enclosed volume, m³: positive when closed and outward.
    #[must_use]
    pub fn volume_times_six(&self) -> f64 {
        let corner = |i: u32| sub(self.vertices[i as usize], self.middle());
        self.triangles.iter().map(|t| dot(corner(t[0]), cross(corner(t[1]), corner(t[2])))).sum()
    }

    /// Rays from near the middle: a third at vertices, a third at edges, a third at points of faces.
    pub fn aims(&self, count: usize, epsilon: f64, seed: u64) -> impl Iterator<Item = Aim> + '_ {
        let mut numbers = Uniform::new(seed);
        let middle = self.middle();
        let inner = self.vertices.iter().map(|v| length(sub(*v, middle))).fold(f64::INFINITY, f64::min);
        (0..count).map(move |i| {
            let triangle = self.triangles[(numbers.bits() % self.triangles.len() as u64) as usize];
            let corner = |k: usize| self.vertices[triangle[k] as usize];
            let (u, v) = (numbers.number(), numbers.number());
            let (point, what) = match i % 3 {
                0 => (corner(0), "a vertex"),
                1 => (add(scale(1.0 - u, corner(0)), scale(u, corner(1))), "an edge"),
                _ => {
                    let root = u.sqrt();
                    let a = scale(1.0 - root, corner(0));
                    let b = scale(root * (1.0 - v), corner(1));
                    (add(add(a, b), scale(root * v, corner(2))), "a face")
                }
            };
            // Well inside the largest ball about the middle that any of these meshes holds.
            let origin =
                representable(add(middle, scale(0.1 * inner * numbers.number(), numbers.direction())), epsilon);
            let direction = representable(sub(point, origin), epsilon);
            Aim { origin_m: origin, direction, target: format!("{what} of triangle {triangle:?} of the {}", self.name) }
        })
    }

    /// Its triangles, scaled.
    #[must_use]
    pub fn shapes(&self, factor: f64) -> Vec<Shape> {
        let corner = |i: u32| scale(factor, self.vertices[i as usize]);
        self.triangles.iter().map(|t| Shape::Triangle { corners_m: t.map(corner) }).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn generated_meshes_are_closed_and_outward() {
        for mesh in [ClosedMesh::cube(), ClosedMesh::sphere(16, 16), ClosedMesh::needles(3000, 1e3)] {
            assert!(mesh.volume_times_six() > 0.0, "{}", mesh.name);
            let mut edges = std::collections::HashMap::new();
            for t in &mesh.triangles {
                for k in 0..3 {
                    *edges.entry((t[k], t[(k + 1) % 3])).or_insert(0) += 1;
                }
            }
            assert!(edges.iter().all(|((a, b), n)| *n == 1 && edges.get(&(*b, *a)) == Some(&1)), "{}", mesh.name);
        }
        let cube = ClosedMesh::cube();
        assert!((cube.volume_times_six() - 48.0).abs() < 1e-12);
    }
}
