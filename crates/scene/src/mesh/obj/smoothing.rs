//! Normals by the smoothing groups (`s`) of an OBJ file, where it states no normals.

use std::collections::HashMap;

use super::ObjFile;
use crate::mesh::smooth_normals;
use crate::model::Mesh;

/// A vertex of the surface that a smoothing group makes of a named group: which of the two, and where it lies.
type Place<'a> = (Option<&'a str>, u32, [u64; 3]);

impl ObjFile {
    /// Gives the triangles of smoothing groups normals, where they have none of their own: the means over the triangles of the same
    /// smoothing group and the same named group. Other triangles keep what they have.
    pub fn smooth_groups(&mut self) {
        let mut surface = Mesh::default();
        let mut places: HashMap<Place<'_>, u32> = HashMap::new();
        // The vertices in the surface of each smoothed triangle.
        let mut smoothed: Vec<Vec<Option<[u32; 3]>>> = Vec::with_capacity(self.parts.len());
        for (part, groups) in self.parts.iter().zip(&self.smoothing) {
            let mesh = &part.mesh;
            let is_bare = |corner: &u32| mesh.normals.get(*corner as usize).is_none_or(|normal| *normal == [0.0; 3]);
            let mut corners_of = |(triangle, group): (&[u32; 3], &u32)| {
                (*group > 0 && triangle.iter().all(is_bare)).then(|| {
                    let corners = triangle.map(|corner| {
                        let vertex = mesh.vertices[corner as usize];
                        // Both zeros are the same place.
                        let place = (part.name.as_deref(), *group, vertex.map(|v| (v + 0.0).to_bits()));
                        *places.entry(place).or_insert_with(|| {
                            surface.vertices.push(vertex);
                            surface.vertices.len() as u32 - 1
                        })
                    });
                    surface.triangles.push(corners);
                    corners
                })
            };
            smoothed.push(mesh.triangles.iter().zip(groups).map(&mut corners_of).collect());
        }
        let normals = smooth_normals(&surface);
        for (part, corners) in self.parts.iter_mut().zip(smoothed) {
            if corners.iter().any(Option::is_some) {
                part.mesh = with_normals(&part.mesh, &corners, &normals);
            }
        }
        self.smoothing.iter_mut().for_each(Vec::clear);
    }
}

/// A mesh whose vertices are parted where triangles have unlike normals there.
fn with_normals(mesh: &Mesh, smoothed: &[Option<[u32; 3]>], normals: &[[f32; 3]]) -> Mesh {
    let mut made = Mesh::default();
    let mut known: HashMap<(u32, Option<u32>), u32> = HashMap::new();
    for (triangle, corners) in mesh.triangles.iter().zip(smoothed) {
        let corner = |k: usize| {
            let (old, place) = (triangle[k], corners.map(|corners| corners[k]));
            *known.entry((old, place)).or_insert_with(|| {
                let at = old as usize;
                made.vertices.push(mesh.vertices[at]);
                let own = mesh.normals.get(at).copied().unwrap_or([0.0; 3]);
                made.normals.push(place.map_or(own, |place| normals[place as usize]));
                made.uvs.extend(mesh.uvs.get(at));
                made.colours.extend(mesh.colours.get(at));
                made.vertices.len() as u32 - 1
            })
        };
        let triangle = [0, 1, 2].map(corner);
        made.triangles.push(triangle);
    }
    made
}

#[cfg(test)]
mod tests {
    use crate::mesh::{Cut, read_obj};

    /// Two squares that meet at a right angle, and a third that belongs to no group.
    const BENT: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 0 -1\nv 1 1 -1\nv 0 0 -1\nvt 0 0\nvt 1 1\n\
        s 1\nusemtl a\nf 1/1 2/1 3/1 4/1\nusemtl b\nf 2/2 5/2 6/2 3/2\ns off\nf 1/1 7/1 5/1 2/1\n";

    #[test]
    fn a_smoothing_group_has_the_mean_normals_of_its_faces() {
        let mut obj = read_obj(BENT.as_bytes(), Cut::Outline, |_| Ok(Vec::new())).unwrap();
        assert!(obj.parts.iter().all(|part| part.mesh.normals.is_empty()));
        obj.smooth_groups();
        let mesh = &obj.parts[0].mesh;
        let normals_at = |x: [f64; 3]| -> Vec<[f32; 3]> {
            let vertices = mesh.vertices.iter().zip(&mesh.normals);
            vertices.filter(|(vertex, _)| **vertex == x).map(|(_, normal)| *normal).collect()
        };
        // At the upper end of the edge both squares have the mean, for each of their texture coordinates.
        let half = 0.5_f32.sqrt();
        let at_edge = normals_at([1.0, 1.0, 0.0]);
        assert_eq!(at_edge.len(), 2);
        assert!(at_edge.iter().all(|n| (n[0] - half).abs() < 1e-6 && (n[2] - half).abs() < 1e-6), "{at_edge:?}");
        // At its lower end the flat square has none of its own.
        assert_eq!(normals_at([1.0, 0.0, 0.0]).iter().filter(|n| **n == [0.0; 3]).count(), 1);
        assert_eq!(mesh.triangles.len(), 6);
    }
}
