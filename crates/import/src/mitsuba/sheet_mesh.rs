//! Polarisers and retarders of Mitsuba on meshes. The frame of a triangle there begins with the direction of growing u, or with its first edge if it has no
//! texture coordinates.

use etalon_scene::Mesh;
use etalon_scene::mesh::smooth_normals;
use glam::{DAffine3, DVec2, DVec3};
use serde_json::{Value, json};

use super::Walk;
use super::shape::{Dressed, MeshFormat, reach};
use super::sheet::frame_axis;
use crate::vertex_colours::apart;

/// Most axes of one mesh. A curved one has another at each place.
const MOST_AXES: usize = 16;
/// Axes whose cosine is less than this below 1 are one: they are 0.08° apart, and crossed polarisers so turned pass two millionths.
const ALIKE: f64 = 1e-6;

/// The part of a mesh that has one axis.
struct Part {
    mesh: Mesh,
    /// In the world.
    axis: DVec3,
}

impl Walk<'_, '_, '_> {
    /// Places a mesh that is a polarising sheet, each part that has an axis of its own as an object. False if none is placed. A mesh with too many axes
    /// is then without any.
    pub(super) fn mesh_of_sheet(
        &mut self,
        file: &str,
        (format, flat): (MeshFormat, bool),
        dressed: &mut Dressed,
        sheet: &Value,
        place: &str,
    ) -> Result<bool, String> {
        let (parts, of_faces) = self.parts(file, format, place)?;
        let mut placed = Vec::new();
        for part in &parts {
            // Whether v is turned over changes no direction in which u grows.
            match by_axis(&part.mesh, frame_axis(sheet), &dressed.map, flat || of_faces, dressed.flipped) {
                Some(of_axes) => placed.extend(of_axes),
                None => {
                    self.without_axis(dressed, sheet, "curved mesh", place);
                    return Ok(false);
                }
            }
        }
        if placed.is_empty() {
            return Ok(false);
        }
        self.list_unread(&parts, file, place);
        let several = placed.len() > 1;
        for (number, part) in placed.into_iter().enumerate() {
            let mut dressed = dressed.clone();
            if several {
                dressed.name = format!("{}, {}", dressed.name, number + 1);
            }
            let mut material = sheet.clone();
            // A transform takes the axis to its place as it does a normal.
            let axis = (dressed.map.matrix3.transpose() * part.axis).normalize_or_zero();
            material["axis"] = json!(axis.to_array().map(|v| v + 0.0));
            dressed.look.material = material;
            let shape = json!({ "type": "mesh", "file": self.builder.mesh_file(&part.mesh), "shading": "flat" });
            self.builder.place(&dressed.placed(shape, reach(&part.mesh)), place)?;
        }
        Ok(true)
    }
}

/// The parts of a mesh by the axes of a sheet on it, which is stated in the frame of its surface; `None` if it has too many, or no frame somewhere.
fn by_axis(mesh: &Mesh, axis: [f64; 2], map: &DAffine3, flat: bool, flipped: bool) -> Option<Vec<Part>> {
    let mut mesh = mesh.clone();
    if flat {
        mesh.normals.clear();
    } else if mesh.normals.is_empty() {
        mesh.normals = smooth_normals(&mesh);
    }
    let mesh = apart(&mesh);
    let mut axes: Vec<(DVec3, Vec<usize>)> = Vec::new();
    for triangle in 0..mesh.triangles.len() {
        let Some([along, across]) = frame(&mesh, triangle, map, flipped)? else { continue };
        let own = axis[0] * along + axis[1] * across;
        match axes.iter().position(|(known, _)| known.dot(own).abs() > 1.0 - ALIKE) {
            Some(known) => axes[known].1.push(triangle),
            None if axes.len() == MOST_AXES => return None,
            None => axes.push((own, vec![triangle])),
        }
    }
    Some(axes.into_iter().map(|(axis, triangles)| Part { mesh: part(&mesh, &triangles), axis }).collect())
}

/// The first two axes of the frame of a triangle, whose corners are its own, in the world. `Some(None)` if it has no area, `None` if its frame is not the
/// same all over it.
fn frame(mesh: &Mesh, triangle: usize, map: &DAffine3, flipped: bool) -> Option<Option<[DVec3; 2]>> {
    let corners = [0, 1, 2].map(|k| 3 * triangle + k);
    let [start, second, third] = corners.map(|i| map.transform_point3(DVec3::from_array(mesh.vertices[i])));
    let (first_edge, last_edge) = (second - start, third - start);
    let Some(of_face) = first_edge.cross(last_edge).try_normalize() else { return Some(None) };
    let mut normal = of_face;
    if !mesh.normals.is_empty() {
        let normals = corners.map(|i| {
            let own = DVec3::from_array(mesh.normals[i].map(f64::from));
            (map.matrix3.inverse().transpose() * own).normalize_or_zero()
        });
        let side = normals[0].dot(of_face).signum();
        if normals.iter().any(|own| own.dot(of_face) * side < 1.0 - ALIKE) {
            return None;
        }
        normal = side * of_face;
    }
    if flipped {
        normal = -normal;
    }
    let along = match mesh.uvs.is_empty() {
        true => first_edge,
        false => {
            let [start, second, third] = corners.map(|i| DVec2::from_array(mesh.uvs[i].map(f64::from)));
            let (first, last) = (second - start, third - start);
            (last.y * first_edge - first.y * last_edge) / first.perp_dot(last)
        }
    };
    let along = along.try_normalize()?;
    Some(Some([along, normal.cross(along)]))
}

/// Some triangles of a mesh whose triangles share no corners.
fn part(mesh: &Mesh, triangles: &[usize]) -> Mesh {
    fn corners<T: Copy>(list: &[T], triangles: &[usize]) -> Vec<T> {
        triangles.iter().flat_map(|i| list.iter().skip(3 * i).take(3).copied()).collect()
    }
    Mesh {
        vertices: corners(&mesh.vertices, triangles),
        triangles: (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        normals: Vec::new(),
        uvs: corners(&mesh.uvs, triangles),
        colours: Vec::new(),
    }
}
