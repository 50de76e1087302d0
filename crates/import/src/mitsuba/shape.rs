//! Shapes of Mitsuba.

use std::rc::Rc;

use etalon_scene::Mesh as SceneMesh;
use etalon_scene::mesh::{Cut, Part, read_obj, read_ply, smooth_normals};
use glam::DAffine3;
use serde_json::{Value, json};

use super::Walk;
use super::colour::kind;
use super::element::Element;
use super::material::{Look, grey};
use super::serialized;
use crate::Placed;
use crate::missing;
use crate::number::{WITHOUT_DIRECTIONS, has_image, has_measured_grain, without_directions};
use crate::relief::without_map;
use crate::vertex_colours::{self, apart, attribute_of};
use crate::winding::turn_to_normals;

/// Coordinates of the corners of each triangle of a mesh that has none, as in Mitsuba.
const CORNERS: [[f32; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];

/// A mesh file, as files of the scene.
#[derive(Debug)]
pub(super) struct Mesh {
    parts: Vec<MeshPart>,
    /// Whether the file or its shape asks for the normals of its faces.
    flat: bool,
}

/// How a mesh is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MeshFormat {
    Obj,
    Ply,
    /// The mesh of this number.
    Serialized(usize),
}

#[derive(Debug)]
struct MeshPart {
    file: String,
    name: Option<String>,
    bounds: Option<Reach>,
    has_uvs: bool,
    has_normals: bool,
    /// Whether it has the colours that were asked for.
    has_colours: bool,
}

impl<'a> Walk<'a, '_, '_> {
    /// A group, which instances place.
    pub(super) fn group(&mut self, element: &'a Element) -> Result<(), String> {
        let Some(id) = element.attribute("id") else {
            self.builder.leave_out(&element.place, "a group without an id is never placed: it is left out");
            return Ok(());
        };
        let outside = self.builder.begin_group();
        for shape in element.nested("shape", self.ids)? {
            self.shape(shape)?;
        }
        self.builder.end_group(id, outside);
        element.list_unused(self.builder);
        Ok(())
    }

    pub(super) fn shape(&mut self, element: &'a Element) -> Result<(), String> {
        self.within(element, |walk| walk.read_shape(element))
    }

    fn read_shape(&mut self, element: &'a Element) -> Result<(), String> {
        let place = &element.place;
        let name = element.attribute("id").map_or_else(|| format!("{}, {place}", element.plugin()), str::to_owned);
        if element.plugin() == "merge" {
            for shape in element.nested("shape", self.ids)? {
                self.shape(shape)?;
            }
            element.list_unused(self.builder);
            return Ok(());
        }
        if element.plugin() == "instance" {
            let map = self.placement(element)?;
            let groups = element.nested("shape", self.ids)?;
            let Some(group) = groups.first().and_then(|group| group.attribute("id")) else {
                return Err(format!("{place}: it refers to no shapegroup"));
            };
            self.builder.place_group(&name, group, &map, place);
            element.list_unused(self.builder);
            return Ok(());
        }
        let map = self.placement(element)?;
        let emission = self.emission(element)?;
        let look = match element.nested("bsdf", self.ids)?.first() {
            Some(bsdf) => self.known_look(bsdf)?,
            // There, too, what shines reflects nothing unless it says so.
            None if !element.nested("emitter", self.ids)?.is_empty() => Look::of(json!({ "type": "black" })),
            None => {
                let mut material = grey();
                material["sides"] = json!("front");
                Look::of(material)
            }
        };
        for scattering in element.nested("subsurface", self.ids)? {
            self.builder.leave_out(&scattering.place, missing::subsurface(scattering.plugin()));
        }
        let look = self.filled(element, look)?;
        let flipped = element.flag("flip_normals")?.unwrap_or(false);
        let mut dressed = Dressed { name, look, emission, map, flipped };
        self.place_sheet(&mut dressed, element.plugin(), place);
        match element.plugin() {
            "sphere" => {
                let center = element.triple("center")?.unwrap_or([0.0; 3]);
                let radius = element.number("radius")?.unwrap_or(1.0);
                let reach = [-radius, radius].map(|r| center.map(|c| c + r));
                self.analytic(
                    dressed,
                    json!({ "type": "sphere", "center_m": center, "radius_m": radius }),
                    reach,
                    place,
                )?;
            }
            "rectangle" => {
                let shape =
                    json!({ "type": "parallelogram", "origin_m": [-1, -1, 0], "u_m": [2, 0, 0], "v_m": [0, 2, 0] });
                self.analytic(dressed, shape, [[-1.0, -1.0, 0.0], [1.0, 1.0, 0.0]], place)?;
            }
            "disk" => {
                let shape = json!({ "type": "disk", "normal": [0, 0, 1], "radius_m": 1 });
                self.analytic(dressed, shape, [[-1.0, -1.0, 0.0], [1.0, 1.0, 0.0]], place)?;
            }
            "cube" => {
                let shape = json!({ "type": "box", "min_m": [-1, -1, -1], "max_m": [1, 1, 1] });
                self.analytic(dressed, shape, [[-1.0; 3], [1.0; 3]], place)?;
            }
            "cylinder" => {
                let (start, end) =
                    (element.triple("p0")?.unwrap_or([0.0; 3]), element.triple("p1")?.unwrap_or([0.0, 0.0, 1.0]));
                let radius = element.number("radius")?.unwrap_or(1.0);
                let shape =
                    json!({ "type": "cylinder", "start_m": start, "end_m": end, "radius_m": radius, "capped": false });
                let reach = [
                    std::array::from_fn(|k| start[k].min(end[k]) - radius),
                    std::array::from_fn(|k| start[k].max(end[k]) + radius),
                ];
                self.analytic(dressed, shape, reach, place)?;
            }
            "obj" | "ply" | "serialized" => self.mesh(element, &mut dressed)?,
            other => {
                self.builder.leave_out(place, missing::shape(other));
                element.children.iter().for_each(Element::mark);
            }
        }
        element.list_unused(self.builder);
        Ok(())
    }

    /// A material; one with an id is named once.
    fn known_look(&mut self, element: &Element) -> Result<Look, String> {
        let key = std::ptr::from_ref(element);
        if let Some(look) = self.named_looks.get(&key) {
            return Ok(look.clone());
        }
        let mut look = self.look(element)?;
        // What shows colours of a mesh is another material on each.
        if let Some(id) = element.attribute("id").filter(|_| attribute_of(&look.material).is_none()) {
            let name = self.builder.material_name(id);
            self.builder.materials.insert(name.clone(), look.material);
            look.material = json!(name);
        }
        self.named_looks.insert(key, look.clone());
        Ok(look)
    }

    fn analytic(&mut self, mut dressed: Dressed, shape: Value, reach: Reach, place: &str) -> Result<(), String> {
        self.resolve(&mut dressed, None, place);
        let (shape, reach) = self.with_coordinates(&mut dressed, shape, reach);
        self.builder.place(&dressed.placed(shape, Some(reach)), place)
    }

    fn mesh(&mut self, element: &Element, dressed: &mut Dressed) -> Result<(), String> {
        let place = &element.place;
        let file = element.string("filename").ok_or_else(|| format!("{place}: it has no \"filename\""))?.to_owned();
        let format = match element.plugin() {
            "serialized" => {
                let index = element.number("shape_index")?.unwrap_or(0.0);
                MeshFormat::Serialized(index.clamp(0.0, 1e9) as usize)
            }
            plugin if plugin == "obj" || kind(&file) == "obj" => MeshFormat::Obj,
            _ => MeshFormat::Ply,
        };
        let flip_v = element.flag("flip_tex_coords")?.unwrap_or(format == MeshFormat::Obj);
        let attribute = attribute_of(&dressed.look.material);
        let flat = element.flag("face_normals")?.unwrap_or(false);
        if let Some(sheet) = self.sheet_of(dressed)
            && self.mesh_of_sheet(&file, (format, flat), dressed, &sheet, place)?
        {
            return Ok(());
        }
        let own = dressed.look.material.as_str().and_then(|name| self.builder.materials.get(name));
        let shows_image = has_image(own.unwrap_or(&dressed.look.material))
            || dressed.look.detail.contains_key("opacity_image")
            || dressed.emission.as_ref().is_some_and(has_image);
        let mesh = self.read_mesh(&file, (format, flip_v, flat, attribute.as_ref(), shows_image), place)?;
        let flat = mesh.flat;
        for part in &mesh.parts {
            let mut dressed = dressed.clone();
            if let Some(name) = part.name.as_ref().filter(|_| mesh.parts.len() > 1) {
                dressed.name = format!("{}, {name}", dressed.name);
            }
            // What is mirrored is turned inside out there unless normals of its vertices say otherwise; here it never is.
            if (flat || !part.has_normals) && dressed.map.matrix3.determinant() < 0.0 {
                dressed.flipped = !dressed.flipped;
            }
            self.resolve(&mut dressed, attribute.as_ref().filter(|_| part.has_colours), place);
            if !part.has_uvs {
                self.without_directions(&mut dressed, place);
            }
            let mut shape = json!({ "type": "mesh", "file": part.file });
            if flat {
                shape["shading"] = json!("flat");
            } else if !part.has_normals {
                shape["shading"] = json!("smooth");
            }
            self.builder.place(&dressed.placed(shape, part.bounds), place)?;
        }
        Ok(())
    }

    /// Shows the colours of the mesh where they are known; other attributes become grey.
    fn resolve(&mut self, dressed: &mut Dressed, known: Option<&(String, f64)>, place: &str) {
        if vertex_colours::resolve(&mut dressed.look.material, known) {
            let what = "it has no such colours as the mesh_attribute of its material shows: only \"vertex_color\" and \"face_color\" of \
                        ply and serialized meshes are known, one a shape; the others become 0.5";
            self.builder.approximate(place, what);
        }
    }

    fn read_mesh(
        &mut self,
        file: &str,
        (format, flip_v, mut flat, attribute, shows_image): (MeshFormat, bool, bool, Option<&(String, f64)>, bool),
        place: &str,
    ) -> Result<Rc<Mesh>, String> {
        let key = format!("{flip_v} {flat} {format:?} {attribute:?} {shows_image} {file}");
        if let Some(mesh) = self.meshes.get(&key) {
            return Ok(mesh.clone());
        }
        let (parts, of_faces) = self.parts(file, format, place)?;
        flat |= of_faces;
        self.list_unread(&parts, file, place);
        let mut made = Vec::new();
        for mut part in parts {
            let (has_uvs, has_normals) = (!part.mesh.uvs.is_empty(), !part.mesh.normals.is_empty());
            if flip_v {
                part.mesh.uvs.iter_mut().for_each(|uv| uv[1] = 1.0 - uv[1]);
            }
            if !has_uvs && shows_image {
                if !has_normals && !flat {
                    part.mesh.normals = smooth_normals(&part.mesh);
                }
                part.mesh = apart(&part.mesh);
                part.mesh.uvs = CORNERS.repeat(part.mesh.triangles.len());
            }
            if !flat {
                turn_to_normals(&mut part.mesh);
            }
            let bounds = reach(&part.mesh);
            let has_colours = self.paint(&mut part, attribute, place);
            made.push(MeshPart {
                file: self.builder.mesh_file(&part.mesh),
                name: part.name,
                bounds,
                has_uvs,
                has_normals,
                has_colours,
            });
        }
        let mesh = Rc::new(Mesh { parts: made, flat });
        self.meshes.insert(key, mesh.clone());
        Ok(mesh)
    }

    /// The meshes of a file, and whether it asks for the normals of its faces.
    pub(super) fn parts(&mut self, file: &str, format: MeshFormat, place: &str) -> Result<(Vec<Part>, bool), String> {
        let bytes = self.builder.bytes_of(file, place)?;
        let refused = |why: &dyn std::fmt::Display| format!("{place}: \"{file}\": {why}");
        let (parts, of_faces) = match format {
            // Materials of MTL are not asked for: the scene has its own.
            MeshFormat::Obj => {
                let file = read_obj(&bytes, Cut::Fans, |_| Ok(Vec::new())).map_err(|error| refused(&error))?;
                let mut parts = file.parts;
                // Mitsuba reads colours of vertices from ply and serialized meshes only.
                parts.iter_mut().for_each(|part| part.mesh.colours.clear());
                (parts, false)
            }
            MeshFormat::Ply => (vec![read_ply(&bytes).map_err(|error| refused(&error))?], false),
            MeshFormat::Serialized(index) => {
                let (part, of_faces) = serialized::read(&bytes, index).map_err(|why| refused(&why))?;
                (vec![part], of_faces)
            }
        };
        Ok((parts, of_faces))
    }

    /// Lists what the parts of a mesh file leave out.
    pub(super) fn list_unread(&mut self, parts: &[Part], file: &str, place: &str) {
        for what in parts.iter().flat_map(|part| &part.left_out) {
            self.builder.leave_out(place, format!("\"{file}\": {what}"));
        }
    }

    /// Gives the vertices of a mesh the colours that its material asks for, and no others; whether it has them.
    fn paint(&mut self, part: &mut Part, attribute: Option<&(String, f64)>, place: &str) -> bool {
        let of_vertices = std::mem::take(&mut part.mesh.colours);
        let of_faces = std::mem::take(&mut part.face_colours);
        let Some((name, factor)) = attribute else { return false };
        match name.as_str() {
            "vertex_color" => part.mesh.colours = of_vertices,
            "face_color" if !of_faces.is_empty() => {
                // Normals that are made of the triangles around a vertex, while it is one.
                if part.mesh.normals.is_empty() {
                    part.mesh.normals = smooth_normals(&part.mesh);
                }
                part.mesh = vertex_colours::of_faces(&part.mesh, &of_faces);
            }
            _ => {}
        }
        part.mesh.colours.iter_mut().flatten().for_each(|channel| *channel *= *factor as f32);
        if vertex_colours::clamp(&mut part.mesh.colours) {
            self.builder.approximate(place, "colours of its mesh are no reflectances: they are clamped to 0 to 1");
        }
        !part.mesh.colours.is_empty()
    }

    /// Takes away what has directions from what has no texture coordinates of its own.
    fn without_directions(&mut self, dressed: &mut Dressed, place: &str) {
        let own = dressed.look.material.as_str().and_then(|name| self.builder.materials.get(name));
        let mut material = own.unwrap_or(&dressed.look.material).clone();
        if has_measured_grain(&material) {
            let what = "it has no texture coordinates for the grain of its measured material: it becomes grey";
            self.builder.approximate(place, what);
            dressed.look.material = grey();
        } else if without_directions(&mut material) {
            self.builder.leave_out(place, WITHOUT_DIRECTIONS);
            dressed.look.material = material;
        }
        if without_map(&mut dressed.look.detail) {
            let what = "it has no texture coordinates for its normal or bump map: the map is left out";
            self.builder.leave_out(place, what);
        }
    }
}

/// The box around a mesh.
pub(super) fn reach(mesh: &SceneMesh) -> Option<Reach> {
    mesh.vertices.iter().fold(None, |bounds: Option<Reach>, v| {
        let [low, high] = bounds.unwrap_or([*v, *v]);
        Some([std::array::from_fn(|k| low[k].min(v[k])), std::array::from_fn(|k| high[k].max(v[k]))])
    })
}

/// All of an object but its shape.
#[derive(Clone, Debug)]
pub(super) struct Dressed {
    pub name: String,
    pub look: Look,
    pub emission: Option<Value>,
    pub map: DAffine3,
    pub flipped: bool,
}

/// Two corners of a box.
pub(super) type Reach = [[f64; 3]; 2];

impl Dressed {
    pub(super) fn placed(&self, shape: Value, reach: Option<Reach>) -> Placed {
        Placed {
            name: self.name.clone(),
            shape,
            reach: reach.unwrap_or([[0.0; 3]; 2]),
            material: self.look.material.clone(),
            emission: self.emission.clone(),
            opacity: self.look.opacity,
            detail: self.look.detail.clone(),
            map: self.map,
            flipped: self.flipped,
        }
    }
}
