//! Shapes of pbrt.

use std::f64::consts::PI;

use etalon_scene::Mesh;
use etalon_scene::linear::unit_normal;
use etalon_scene::mesh::{MAX_ELEMENTS, read_ply};
use glam::{DAffine3, DVec3};
use serde_json::{Value, json};

use super::Reading;
use super::parameters::Parameters;
use crate::Placed;
use crate::medium::fill;
use crate::missing;
use crate::number::{Number, WITHOUT_DIRECTIONS, has_directions, has_image, has_measured_grain, without_directions};
use crate::relief::{has_map, without_map};
use crate::round::{DISK_OF_TRIANGLES, disk, sphere_turn};
use crate::winding::turn_to_normals;

/// Two corners of a box.
type Reach = [[f64; 3]; 2];

/// A shape of the format, the box around it, and whether it has texture coordinates.
pub(super) type Placeable = (Value, Reach, bool);

impl Reading<'_, '_> {
    pub(super) fn shape(&mut self, shape: &str, list: &Parameters, place: &str) -> Result<(), String> {
        self.shapes += 1;
        let name = format!("{shape} {}", self.shapes);
        let mut listed = None;
        let (mut value, mut reach, mut has_uvs) = match shape {
            "sphere" => {
                let radius = list.number_or("radius", 1.0)?;
                (json!({ "type": "sphere", "radius_m": radius }), [[-radius; 3], [radius; 3]], false)
            }
            "disk" => {
                let (height, radius) = (list.number_or("height", 0.0)?, list.number_or("radius", 1.0)?);
                let value =
                    json!({ "type": "disk", "center_m": [0, 0, height], "normal": [0, 0, 1], "radius_m": radius });
                (value, [[-radius, -radius, height], [radius, radius, height]], false)
            }
            "cylinder" => {
                let (radius, low, high) =
                    (list.number_or("radius", 1.0)?, list.number_or("zmin", -1.0)?, list.number_or("zmax", 1.0)?);
                let value = json!({
                    "type": "cylinder", "start_m": [0, 0, low], "end_m": [0, 0, high], "radius_m": radius,
                    "capped": false,
                });
                (value, [[-radius, -radius, low], [radius, radius, high]], false)
            }
            "trianglemesh" | "bilinearmesh" => {
                let mesh = if shape == "trianglemesh" { triangles(list, place)? } else { self.patches(list, place)? };
                self.file_of(listed.insert(mesh))
            }
            "plymesh" => {
                let file =
                    list.string("filename").ok_or_else(|| format!("{place}: it has no \"filename\""))?.to_owned();
                self.mesh(&file, place)?
            }
            other => {
                self.builder.leave_out(place, missing::shape(other));
                return Ok(());
            }
        };
        self.list_parts_of_round(shape, list, place)?;
        let mut map = self.to_world();
        if matches!(shape, "sphere" | "disk" | "cylinder") && self.follows_coordinates(list)? {
            (value, reach) = self.with_coordinates(&value, reach, &mut map, place);
            has_uvs = true;
        }
        let mut opacity = self.state.material.opacity;
        let mut detail = self.state.material.detail.clone();
        if !has_uvs && without_map(&mut detail) {
            self.builder
                .leave_out(place, "it has no texture coordinates for its normal or bump map: the map is left out");
        }
        match self.share(list, "alpha")? {
            None => {}
            Some(Number::Value(alpha)) => opacity *= alpha,
            Some(Number::Image(..)) if !has_uvs => {
                self.builder
                    .approximate(place, "it has no texture coordinates for the image of its alpha: it becomes opaque");
            }
            Some(Number::Image(mut image, _)) => {
                // The format has the factor beside the image.
                opacity *= image["factor"].as_f64().unwrap_or(1.0);
                if let Some(keys) = image.as_object_mut() {
                    keys.remove("factor");
                }
                detail.insert("opacity_image".to_owned(), image);
            }
        }
        let mut emission = self.emission(shape, list, listed.as_ref(), place)?;
        list.list_unused(self.builder);
        let mut material = self.untextured(has_uvs, place);
        self.surround(place);
        if let Some(medium) = self.state.inside.clone() {
            let own = material.as_str().and_then(|name| self.builder.materials.get(name)).unwrap_or(&material);
            let mut filled = own.clone();
            if fill(&mut filled, &mut opacity, detail.contains_key("opacity_image"), &medium) {
                self.builder.spend(&filled, place)?;
                if filled["type"] == "boundary" && self.state.outside.as_ref() != Some(&medium) {
                    self.builder.bound(&medium, place);
                }
                material = filled;
            }
        }
        if !has_uvs && emission.as_ref().is_some_and(has_image) {
            let what = "it has no texture coordinates for the image of its emission: it does not emit";
            self.builder.leave_out(place, what);
            emission = None;
        }
        let placed = Placed {
            name,
            shape: value,
            reach,
            material,
            emission,
            opacity,
            detail,
            map,
            flipped: self.state.reversed,
        };
        self.builder.place(&placed, place)
    }

    /// Whether anything that a shape has depends on its texture coordinates.
    fn follows_coordinates(&mut self, list: &Parameters) -> Result<bool, String> {
        let known = &self.state.material;
        let own = known.value.as_str().and_then(|name| self.builder.materials.get(name)).unwrap_or(&known.value);
        let of_surface = has_image(own) || has_directions(own) || has_map(&known.detail);
        let of_lamp = self.state.emission.as_deref().is_some_and(|lamp| has_image(&lamp.emission));
        Ok(of_surface || of_lamp || matches!(self.share(list, "alpha")?, Some(Number::Image(..))))
    }

    /// A round shape with pbrt's texture coordinates. v of a sphere and of a cylinder grows with z, as ours; that of a disk from its edge.
    fn with_coordinates(&mut self, shape: &Value, reach: Reach, map: &mut DAffine3, place: &str) -> (Value, Reach) {
        let radius = shape["radius_m"].as_f64().unwrap_or(1.0);
        match shape["type"].as_str() {
            Some("sphere") => {
                *map *= sphere_turn();
                (shape.clone(), reach)
            }
            Some("cylinder") => {
                let [[.., low], [.., high]] = reach;
                *map = *map * DAffine3::from_translation(DVec3::Z * low) * DAffine3::from_rotation_z(PI);
                let length = high - low;
                let along_z = json!({ "type": "cylinder", "start_m": [0, 0, 0], "end_m": [0, 0, length], "radius_m": radius, "capped": false });
                (along_z, [[-radius, -radius, 0.0], [radius, radius, length]])
            }
            _ => {
                self.builder.approximate(place, DISK_OF_TRIANGLES);
                let mut mesh = disk();
                let height = reach[0][2];
                mesh.vertices.iter_mut().for_each(|p| *p = [radius * p[0], radius * p[1], height]);
                mesh.uvs.iter_mut().for_each(|uv| *uv = [uv[1], 1.0 - uv[0]]);
                let file = self.builder.mesh_file(&mesh);
                (json!({ "type": "mesh", "file": file, "shading": "flat" }), reach)
            }
        }
    }

    /// The material in force, or grey where it would show an image and there are no texture coordinates.
    fn untextured(&mut self, has_uvs: bool, place: &str) -> Value {
        let value = &self.state.material.value;
        let own = value.as_str().and_then(|name| self.builder.materials.get(name)).unwrap_or(value);
        if !has_uvs && has_image(own) {
            self.builder
                .approximate(place, "it has no texture coordinates for the image of its material: it becomes grey");
            return json!({ "type": "lambert", "reflectance": 0.5 });
        }
        if !has_uvs && has_measured_grain(own) {
            let what = "it has no texture coordinates for the grain of its measured material: it becomes grey";
            self.builder.approximate(place, what);
            return json!({ "type": "lambert", "reflectance": 0.5 });
        }
        let mut without = own.clone();
        if !has_uvs && without_directions(&mut without) {
            self.builder.leave_out(place, WITHOUT_DIRECTIONS);
            return without;
        }
        value.clone()
    }

    /// What is placed of a mesh file, which is read once.
    fn mesh(&mut self, file: &str, place: &str) -> Result<Placeable, String> {
        if let Some((known, _)) = self.meshes.get(file) {
            return Ok(known.clone());
        }
        let bytes = self.inflated(file, place)?;
        let mut part = read_ply(&bytes).map_err(|e| format!("{place}: \"{file}\": {e}"))?;
        // The program has no materials that show them.
        part.mesh.colours.clear();
        for what in &part.left_out {
            self.builder.leave_out(place, format!("\"{file}\": {what}"));
        }
        let made = self.file_of(&mut part.mesh);
        self.meshes.insert(file.to_owned(), (made.clone(), part.faces));
        Ok(made)
    }

    /// A mesh as a file, after its normals have said which side is its front, the box around it, and whether it has texture coordinates.
    fn file_of(&mut self, mesh: &mut Mesh) -> Placeable {
        turn_to_normals(mesh);
        let first = mesh.vertices.first().copied().unwrap_or([0.0; 3]);
        let reach = mesh.vertices.iter().fold([first, first], |[low, high], v| {
            [std::array::from_fn(|k| low[k].min(v[k])), std::array::from_fn(|k| high[k].max(v[k]))]
        });
        let file = self.builder.mesh_file(mesh);
        (json!({ "type": "mesh", "file": file }), reach, !mesh.uvs.is_empty())
    }

    /// Bilinear patches as two triangles each.
    fn patches(&mut self, list: &Parameters, place: &str) -> Result<Mesh, String> {
        let mut mesh = vertices(list, place)?;
        let corners = indices(list, mesh.vertices.len(), 4, place)?;
        // Corners (0, 0), (1, 0), (0, 1) and (1, 1), in this order.
        mesh.triangles = corners.chunks_exact(4).flat_map(|c| [[c[0], c[1], c[3]], [c[0], c[3], c[2]]]).collect();
        self.builder.approximate(place, "a bilinear patch becomes two triangles");
        if mesh.uvs.is_empty() {
            // Without texture coordinates each patch has those of the unit square.
            let of = |list: &[[f32; 3]]| match list.is_empty() {
                true => Vec::new(),
                false => corners.iter().map(|corner| list[*corner as usize]).collect(),
            };
            let patches = corners.len() as u32 / 4;
            mesh = Mesh {
                vertices: corners.iter().map(|corner| mesh.vertices[*corner as usize]).collect(),
                normals: of(&mesh.normals),
                uvs: [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].repeat(corners.len() / 4),
                triangles: (0..patches).flat_map(|i| [[0, 1, 3], [0, 3, 2]].map(|t| t.map(|c| 4 * i + c))).collect(),
                ..Mesh::default()
            };
        }
        Ok(mesh)
    }

    /// Lists which part of a round shape is whole here.
    fn list_parts_of_round(&mut self, shape: &str, list: &Parameters, place: &str) -> Result<(), String> {
        if !matches!(shape, "sphere" | "disk" | "cylinder") {
            return Ok(());
        }
        let mut stated = Vec::new();
        if list.number_or("phimax", 360.0)? < 360.0 {
            stated.push("phimax");
        }
        if shape == "disk" && list.number_or("innerradius", 0.0)? > 0.0 {
            stated.push("innerradius");
        }
        if shape == "sphere" {
            let radius = list.number_or("radius", 1.0)?;
            let (low, high) = (list.number_or("zmin", -radius)?, list.number_or("zmax", radius)?);
            stated.extend((low > -radius).then_some("zmin"));
            stated.extend((high < radius).then_some("zmax"));
        }
        if !stated.is_empty() {
            let are = if stated.len() == 1 { "is" } else { "are" };
            let what = format!("{} {are} ignored: the whole {shape} is used", stated.join(" and "));
            self.builder.approximate(place, what);
        }
        Ok(())
    }
}

fn triangles(list: &Parameters, place: &str) -> Result<Mesh, String> {
    let mut mesh = vertices(list, place)?;
    let corners = indices(list, mesh.vertices.len(), 3, place)?;
    mesh.triangles = corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
    Ok(mesh)
}

fn vertices(list: &Parameters, place: &str) -> Result<Mesh, String> {
    let triples = |key: &str| -> Result<Vec<[f64; 3]>, String> {
        let numbers = list.numbers(key).unwrap_or(&[]);
        if !numbers.len().is_multiple_of(3) {
            return Err(format!(
                "{place}: \"{key}\" has {} numbers, which is not a whole number of points",
                numbers.len()
            ));
        }
        Ok(numbers.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect())
    };
    let vertices = triples("P")?;
    if vertices.is_empty() || vertices.len() > MAX_ELEMENTS {
        return Err(format!("{place}: it has {} vertices", vertices.len()));
    }
    let normals = triples("N")?;
    let uvs = list.numbers("uv").or_else(|| list.numbers("st")).unwrap_or(&[]);
    let uvs: Vec<[f32; 2]> = uvs.chunks_exact(2).map(|c| [c[0] as f32, c[1] as f32]).collect();
    for (what, length) in [("normals", normals.len()), ("texture coordinates", uvs.len())] {
        if length != 0 && length != vertices.len() {
            return Err(format!("{place}: {length} {what} for {} vertices", vertices.len()));
        }
    }
    let normals = normals.into_iter().map(unit_normal).collect();
    Ok(Mesh { vertices, normals, uvs, ..Mesh::default() })
}

/// The corners of the faces; those of the only face if none are stated.
fn indices(list: &Parameters, count: usize, each: usize, place: &str) -> Result<Vec<u32>, String> {
    let Some(stated) = list.numbers("indices") else {
        return match count == each {
            true => Ok((0..each as u32).collect()),
            false => Err(format!("{place}: it has no \"indices\"")),
        };
    };
    if !stated.len().is_multiple_of(each) || stated.is_empty() {
        return Err(format!("{place}: {} indices are not a whole number of faces with {each} corners", stated.len()));
    }
    stated
        .iter()
        .map(|index| match *index >= 0.0 && *index < count as f64 && index.fract() == 0.0 {
            true => Ok(*index as u32),
            false => Err(format!("{place}: index {index} names no vertex; there are {count}")),
        })
        .collect()
}
