//! OBJ files and their material libraries (MTL).

mod lines;
mod mtl;
mod smoothing;

use std::cell::{Cell, RefCell};
use std::collections::HashSet;
use std::path::Path;

use etalon_optics::colour::srgb_decode;
use tobj::LoadOptions;

use super::polygon::Cut;
use super::{MeshError, Part, check_vertex};
use crate::model::Mesh;
use lines::{Lines, Survey};

/// A material of a material library, as far as it says something.
pub type ObjMaterial = tobj::Material;

/// What an OBJ file holds.
#[derive(Debug, Default)]
pub struct ObjFile {
    /// A part for each run of faces of the same object or group and material. Where there are no faces but statements that are not used,
    /// a part without triangles lists these.
    pub parts: Vec<Part>,
    /// The materials that the parts name.
    pub materials: Vec<ObjMaterial>,
    /// Material libraries that could not be read, each with why, and their lines that are not honoured.
    pub missing_libraries: Vec<String>,
    /// Materials that faces name and no library has.
    pub unknown_materials: Vec<String>,
    /// The smoothing groups of the triangles of each part, 0 for none; nothing for a part without any.
    smoothing: Vec<Vec<u32>>,
}

/// Reads an OBJ file, its polygons cut in this way. `library` gives the bytes of a material library by the name that the file has for it.
///
/// # Errors
/// If a line cannot be read, a face names something that the file does not have, or a coordinate is not finite.
pub fn read_obj(
    bytes: &[u8],
    cut: Cut,
    library: impl Fn(&Path) -> Result<Vec<u8>, String>,
) -> Result<ObjFile, MeshError> {
    let survey = Survey::of(bytes)?;
    let line = Cell::new(0);
    let missing = RefCell::new(Vec::new());
    // However often a file names a library, it is read once.
    let read = RefCell::new(HashSet::new());
    let library = |path: &Path| if read.borrow_mut().insert(path.to_owned()) { library(path) } else { Ok(Vec::new()) };
    let mut reader = Lines::new(bytes, &survey, &line);
    // Polygons are cut here.
    let options = LoadOptions { single_index: true, triangulate: false, ignore_points: true, ignore_lines: true };
    let loaded = tobj::load_obj_buf(&mut reader, &options, |path| {
        let (materials, left_out) = libraries(path, &library);
        missing.borrow_mut().extend(left_out);
        // Of those with the same name the first counts.
        let places = materials.iter().enumerate().rev().map(|(i, material)| (material.name.clone(), i)).collect();
        Ok((materials, places))
    });
    let (models, materials) = loaded.map_err(|error| {
        use tobj::LoadError as E;
        match error {
            E::FaceVertexOutOfBounds | E::FaceTexCoordOutOfBounds | E::FaceNormalOutOfBounds => {
                MeshError::at_line(line.get(), format!("{error}, in the group of faces that ends on this line"))
            }
            _ => MeshError::at_line(line.get(), error.to_string()),
        }
    })?;
    let materials = materials.unwrap_or_default();
    let mut file = ObjFile { missing_libraries: missing.into_inner(), ..ObjFile::default() };
    let mut groups = survey.smoothing.into_iter();
    for model in models {
        let material = model.mesh.material_id.and_then(|id| materials.get(id)).map(|m| m.name.clone());
        let (part, smoothing) = part(model, material, cut, &mut groups)?;
        if !part.mesh.triangles.is_empty() {
            file.parts.push(part);
            file.smoothing.push(smoothing);
        }
    }
    if !survey.left_out.is_empty() {
        if file.parts.is_empty() {
            file.parts.push(Part::default());
            file.smoothing.push(Vec::new());
        }
        file.parts[0].left_out.splice(0..0, survey.left_out);
    }
    let known: HashSet<&str> = materials.iter().map(|material| material.name.as_str()).collect();
    file.unknown_materials = survey.used.into_iter().filter(|name| !known.contains(name.as_str())).collect();
    file.materials = materials;
    Ok(file)
}

/// The materials of a library, or of several in a row, and what of them is not honoured.
fn libraries(path: &Path, library: &impl Fn(&Path) -> Result<Vec<u8>, String>) -> (Vec<ObjMaterial>, Vec<String>) {
    let of = |path: &Path| library(path).map(|bytes| mtl::read_mtl(&bytes, &path.to_string_lossy()));
    let whole = match of(path) {
        Ok(found) => return found,
        Err(why) => (Vec::new(), vec![why]),
    };
    // The name of a file may have spaces.
    let stated = path.to_string_lossy();
    let mut names: Vec<String> = Vec::new();
    for word in stated.split_whitespace() {
        match names.last_mut() {
            Some(name) if !name.to_ascii_lowercase().ends_with(".mtl") => *name += &format!(" {word}"),
            _ => names.push(word.to_owned()),
        }
    }
    if names.len() < 2 {
        return whole;
    }
    let (mut materials, mut left_out) = (Vec::new(), Vec::new());
    for name in names {
        match of(Path::new(&name)) {
            Ok((more, what)) => {
                materials.extend(more);
                left_out.extend(what);
            }
            Err(why) => left_out.push(why),
        }
    }
    (materials, left_out)
}

/// A part, perhaps without triangles, and the smoothing group of each triangle, taken from those of the faces.
fn part(
    model: tobj::Model,
    material: Option<String>,
    cut: Cut,
    groups: &mut impl Iterator<Item = u32>,
) -> Result<(Part, Vec<u32>), MeshError> {
    let name = Some(model.name).filter(|name| !name.is_empty() && name != "unnamed_object");
    let tobj::Mesh { positions, normals, texcoords, indices, face_arities, vertex_color, .. } = model.mesh;
    let whole = |list: &[f32], each: usize| list.chunks_exact(each).len();
    let count = whole(&positions, 3);
    let fail = |message: String| {
        MeshError::new(format!(
            "{}: {message}",
            name.as_ref().map_or("its faces".to_owned(), |n| format!("group \"{n}\""))
        ))
    };
    let mut mesh = Mesh {
        vertices: positions.chunks_exact(3).map(|p| [p[0], p[1], p[2]].map(f64::from)).collect(),
        triangles: Vec::new(),
        // The reader has none where a part has none.
        normals: match whole(&normals, 3) == count {
            true => normals.chunks_exact(3).map(|n| [n[0], n[1], n[2]]).collect(),
            false => Vec::new(),
        },
        uvs: match whole(&texcoords, 2) == count {
            true => texcoords.chunks_exact(2).map(|t| [t[0], t[1]]).collect(),
            false => Vec::new(),
        },
        colours: colours(&vertex_color),
    };
    if mesh.colours.len() != count {
        mesh.colours.clear();
    }
    for i in 0..mesh.vertices.len() {
        check_vertex(i, mesh.vertices[i], mesh.normals.get_mut(i)).map_err(&fail)?;
    }
    // What stands for missing normals is (0, 0, 0), for missing texture coordinates NaN.
    if mesh.normals.iter().flatten().all(|v| *v == 0.0) {
        mesh.normals.clear();
    }
    let is_missing = |uv: &[f32; 2]| uv.iter().all(|v| v.is_nan());
    let missing: Vec<bool> = mesh.uvs.iter().map(is_missing).collect();
    let some_missing = missing.contains(&true);
    if missing.iter().all(|missing| *missing) {
        mesh.uvs.clear();
    }
    mesh.uvs.iter_mut().filter(|uv| is_missing(uv)).for_each(|uv| *uv = [0.0; 2]);
    if let Some(i) = mesh.uvs.iter().position(|uv| !uv.iter().all(|v| v.is_finite())) {
        return Err(fail(format!("the texture coordinates of vertex {i} are {:?}", mesh.uvs[i])));
    }
    let mut start = 0;
    let arities: Vec<usize> = match face_arities.is_empty() {
        true => vec![3; indices.len() / 3],
        false => face_arities.iter().map(|&n| n as usize).collect(),
    };
    let (mut smoothing, mut bare, faces) = (Vec::new(), 0_usize, arities.len());
    for arity in arities {
        let corners = &indices[start..start + arity];
        cut.triangulate(corners, |v| mesh.vertices[v as usize], &mut mesh.triangles);
        smoothing.resize(mesh.triangles.len(), groups.next().unwrap_or(0));
        bare += usize::from(some_missing && corners.iter().any(|v| missing[*v as usize]));
        start += arity;
    }
    let mut left_out = Vec::new();
    if bare > 0 && !mesh.uvs.is_empty() {
        left_out
            .push(format!("{bare} of its {faces} faces have no texture coordinates: images lie there as at (0, 0)"));
    }
    if smoothing.iter().all(|group| *group == 0) {
        smoothing.clear();
    }
    Ok((Part { name, material, mesh, left_out, ..Part::default() }, smoothing))
}

/// Colours of vertices, which files state with the curve of sRGB; none if all are white.
fn colours(stated: &[f32]) -> Vec<[f32; 3]> {
    if stated.iter().all(|channel| *channel == 1.0) {
        return Vec::new();
    }
    let linear = |channel: f32| srgb_decode(f64::from(channel)) as f32;
    stated.chunks_exact(3).map(|c| [c[0], c[1], c[2]].map(linear)).collect()
}
