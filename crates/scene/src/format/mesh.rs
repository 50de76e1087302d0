//! Meshes, listed in the scene or in a file of their own.

use rayon::prelude::*;
use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher};
use std::path::Path;
use std::sync::Arc;

use super::geometry::MeshShape;
use crate::files::{Files, MeshKey};
use crate::json::{Code, Optional, Reader, Span, Spanned};
use crate::mesh::{self, Part, Shading};
use crate::model::Mesh;

/// Triangles that a thread is given at once, at least.
const CHUNK: usize = 1 << 13;

/// The mesh of a form.
pub(super) fn mesh(form: &MeshShape, object: &str, files: &mut Files, reader: &mut Reader<'_>) -> Option<Arc<Mesh>> {
    let shading = form.shading?;
    let group = form.group.clone().checked()?;
    if let Some(file) = form.file.clone().checked()? {
        let key = MeshKey { file: file.value.clone(), group: group.as_ref().map(|g| g.value.clone()), shading };
        return files.mesh(key, |files| from_file(&file, group.as_ref(), shading, object, files, reader));
    }
    if form.vertices_m.is_present() || form.triangles.is_present() {
        listed(form, shading, object, reader)
    } else {
        None
    }
}

/// The mesh of a file.
fn from_file(
    file: &Spanned<String>,
    group: Option<&Spanned<String>>,
    shading: Shading,
    object: &str,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<Mesh> {
    let extension = Path::new(&file.value).extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
    if !matches!(extension.as_str(), "ply" | "obj") {
        let hint = "a mesh file is .ply or .obj; other models become scenes by `etalon import`";
        reader.error_hint(Code::FileFormat, file.at, format!("\"{}\" is not a mesh file", file.value), hint);
        return None;
    }
    let bytes = files.bytes(file, reader)?;
    let read = match extension.as_str() {
        "ply" => mesh::read_ply(&bytes).map(|part| vec![part]),
        // Materials are the scene's own business here.
        _ => mesh::read_obj(&bytes, mesh::Cut::Outline, |_| Ok(Vec::new())).map(|obj| obj.parts),
    };
    drop(bytes);
    let refuse = |message: String, reader: &mut Reader<'_>| {
        reader.error(Code::MeshFile, file.at, format!("{}: {message}", file.value));
        None
    };
    let mut parts = match read {
        Ok(parts) => parts,
        Err(error) => return refuse(error.to_string(), reader),
    };
    if let Some(group) = group {
        let names: Vec<String> = parts.iter().filter_map(|part| part.name.clone()).collect();
        parts.retain(|part| part.name.as_ref() == Some(&group.value));
        if parts.is_empty() {
            let message = format!("{} has no group named \"{}\"", file.value, group.value);
            let hint = match names.is_empty() {
                true => "it has no named groups".to_owned(),
                false => format!("it has {}", crate::json::listed(names.iter().map(String::as_str))),
            };
            reader.error_hint(Code::UnknownName, group.at, message, hint);
            return None;
        }
    }
    for left_out in parts.iter().flat_map(|part| &part.left_out) {
        reader.warning(Code::LeftOut, file.at, format!("{}: {left_out}", file.value), None);
    }
    if parts.iter().any(|part| !part.face_colours.is_empty()) {
        let message = format!("{}: the colours of its faces are not used", file.value);
        reader.warning(Code::LeftOut, file.at, message, None);
    }
    let mut mesh = match merged(parts) {
        Some(mesh) => mesh,
        None => return refuse("it has no triangles".to_owned(), reader),
    };
    keep_those_with_area(&mut mesh, object, file.at, reader)?;
    keep_one_of_each(&mut mesh, object, file.at, reader);
    shade(&mut mesh, shading);
    Some(mesh)
}

/// All parts as one. Normals, texture coordinates and colours are kept where any part has them; vertices of others have normal
/// (0, 0, 0), which is none, texture coordinates (0, 0), and are white.
fn merged(parts: Vec<Part>) -> Option<Mesh> {
    let mut parts = parts.into_iter().map(|part| part.mesh).filter(|mesh| !mesh.triangles.is_empty());
    let mut all = parts.next()?;
    for part in parts {
        let first = all.vertices.len() as u32;
        if !part.normals.is_empty() || !all.normals.is_empty() {
            all.normals.resize(all.vertices.len(), [0.0; 3]);
            all.normals.extend(part.normals);
            all.normals.resize(all.vertices.len() + part.vertices.len(), [0.0; 3]);
        }
        if !part.uvs.is_empty() || !all.uvs.is_empty() {
            all.uvs.resize(all.vertices.len(), [0.0; 2]);
            all.uvs.extend(part.uvs);
            all.uvs.resize(all.vertices.len() + part.vertices.len(), [0.0; 2]);
        }
        if !part.colours.is_empty() || !all.colours.is_empty() {
            all.colours.resize(all.vertices.len(), [1.0; 3]);
            all.colours.extend(part.colours);
            all.colours.resize(all.vertices.len() + part.vertices.len(), [1.0; 3]);
        }
        all.vertices.extend(part.vertices);
        all.triangles.extend(part.triangles.into_iter().map(|t| t.map(|i| first + i)));
    }
    Some(all)
}

/// The mesh of the lists in a scene.
fn listed(form: &MeshShape, shading: Shading, object: &str, reader: &mut Reader<'_>) -> Option<Arc<Mesh>> {
    let before = reader.error_count();
    let triangles = form.triangles.given();
    if triangles.is_some_and(|t| t.0.is_empty()) {
        reader.error(Code::EmptyMesh, form.at.head(), "the mesh has no triangles");
    }
    let (vertices, triangles) = (form.vertices_m.given()?, triangles?);
    let count = vertices.0.len();
    for triangle in triangles.0.iter().flatten() {
        if let Some(&index) = triangle.value.iter().find(|&&i| i as usize >= count) {
            let message = format!("vertex {index} does not exist");
            let hint = match count {
                0 => "the mesh has no vertices".to_owned(),
                _ => format!("the mesh has {count}, counted from 0 to {}", count - 1),
            };
            reader.error_hint(Code::IndexOutOfRange, triangle.at, message, hint);
        }
    }
    let normals = for_each_vertex("normals", &form.normals, count, |n| n.0.map(|v| v as f32), reader);
    let uvs = for_each_vertex("uvs", &form.uvs, count, |uv| uv.map(|v| v as f32), reader);
    let colours = for_each_vertex("colours", &form.colours, count, |colour| colour.map(|v| v as f32), reader);
    if reader.error_count() > before {
        return None;
    }
    // Wrong elements have been reported when they were decoded.
    let triangles: Option<Vec<[u32; 3]>> = triangles.0.iter().map(|t| t.as_ref().map(|t| t.value)).collect();
    let mut mesh = Mesh {
        vertices: vertices.clone().complete()?,
        triangles: triangles?,
        normals: normals?,
        uvs: uvs?,
        colours: colours?,
    };
    keep_those_with_area(&mut mesh, object, form.at.head(), reader)?;
    keep_one_of_each(&mut mesh, object, form.at.head(), reader);
    shade(&mut mesh, shading);
    Some(Arc::new(mesh))
}

fn for_each_vertex<T, U>(
    key: &str,
    given: &Optional<Spanned<crate::json::List<T>>>,
    count: usize,
    convert: impl Fn(&T) -> U,
    reader: &mut Reader<'_>,
) -> Option<Vec<U>> {
    match given {
        Optional::Absent => Some(Vec::new()),
        Optional::Invalid => None,
        Optional::Given(list) => {
            let length = list.value.0.len();
            if length != count {
                let message = format!("{length} {key} for {count} vertices");
                reader.error(Code::WrongLength, list.at.head(), message);
                return None;
            }
            list.value.0.iter().map(|element| element.as_ref().map(&convert)).collect()
        }
    }
}

/// Leaves out triangles without area, with a warning; none left is an error.
fn keep_those_with_area(mesh: &mut Mesh, object: &str, at: Span, reader: &mut Reader<'_>) -> Option<()> {
    let all = mesh.triangles.len();
    let is_flat = |triangle: &[u32; 3]| !mesh::has_area(mesh, triangle);
    let triangles = mesh.triangles.par_iter().enumerate().with_min_len(CHUNK);
    let flat: Vec<usize> = triangles.filter(|(_, triangle)| is_flat(triangle)).map(|(number, _)| number).collect();
    leave_out(mesh, &flat);
    let flat = flat.len();
    if mesh.triangles.is_empty() {
        reader.error(Code::EmptyMesh, at, format!("none of the {flat} triangles of {object} has an area"));
        return None;
    }
    if flat > 0 {
        let message = format!("{flat} of the {all} triangles of {object} have no area and were dropped at load");
        reader.warning(Code::DegenerateTriangles, at, message, None);
    }
    Some(())
}

/// Leaves out triangles by their numbers, which rise.
fn leave_out(mesh: &mut Mesh, numbers: &[usize]) {
    if numbers.is_empty() {
        return;
    }
    let mut number = 0;
    mesh.triangles.retain(|_| {
        number += 1;
        numbers.binary_search(&(number - 1)).is_err()
    });
}

/// Leaves out triangles that have the corners of an earlier one in the same turn, with a warning: light would be emitted there
/// twice, and met once. The same corners turned the other way are another side, and stay.
fn keep_one_of_each(mesh: &mut Mesh, object: &str, at: Span, reader: &mut Reader<'_>) {
    let all = mesh.triangles.len();
    let repeated = repeated(mesh);
    if repeated.is_empty() {
        return;
    }
    leave_out(mesh, &repeated);
    let message =
        format!("{} of the {all} triangles of {object} repeat others and were dropped at load", repeated.len());
    reader.warning(Code::RepeatedTriangles, at, message, None);
}

/// The triangles that have the corners of an earlier one in the same turn, vertices at the same place counting as one.
fn repeated(mesh: &Mesh) -> Vec<usize> {
    let corners = |number: usize| {
        let places = mesh.triangles[number].map(|i| mesh.vertices[i as usize].map(|x| (x + 0.0).to_bits()));
        let first = (0..3).min_by_key(|&k| places[k]).unwrap_or(0);
        [0, 1, 2].map(|k| places[(first + k) % 3])
    };
    // Sorted hashes take a quarter of the memory of a set of corners.
    let hash = |number: usize| (BuildHasherDefault::<DefaultHasher>::default().hash_one(corners(number)), number);
    let numbers = (0..mesh.triangles.len()).into_par_iter().with_min_len(CHUNK);
    let mut hashes: Vec<(u64, usize)> = numbers.map(hash).collect();
    hashes.par_sort_unstable();
    let mut repeated = Vec::new();
    for alike in hashes.chunk_by(|a, b| a.0 == b.0).filter(|alike| alike.len() > 1) {
        let mut kept: Vec<[[u64; 3]; 3]> = Vec::new();
        for &(_, number) in alike {
            let corners = corners(number);
            if kept.contains(&corners) {
                repeated.push(number);
            } else {
                kept.push(corners);
            }
        }
    }
    repeated.sort_unstable();
    repeated
}

fn shade(mesh: &mut Mesh, shading: Shading) {
    match shading {
        Shading::Auto => {}
        Shading::Flat => mesh.normals = Vec::new(),
        Shading::Smooth if mesh.normals.is_empty() => mesh.normals = mesh::smooth_normals(mesh),
        Shading::Smooth => {}
    }
}
