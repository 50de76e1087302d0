//! OBJ files and their material libraries (MTL).

use std::cell::{Cell, RefCell};
use std::io::{self, BufRead, Read};
use std::path::Path;

use tobj::LoadOptions;

use super::polygon::Cut;
use super::{MeshError, Part, check_vertex};
use crate::model::Mesh;

/// A material of a material library, as far as it says something.
pub type ObjMaterial = tobj::Material;

/// What an OBJ file holds.
#[derive(Debug, Default)]
pub struct ObjFile {
    /// A part for each run of faces of the same object or group and material.
    pub parts: Vec<Part>,
    /// The materials that the parts name.
    pub materials: Vec<ObjMaterial>,
    /// Material libraries that could not be read, each with why.
    pub missing_libraries: Vec<String>,
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
    check_faces(bytes)?;
    let line = Cell::new(0);
    let missing = RefCell::new(Vec::new());
    let mut reader = Lines { bytes, line: &line };
    // Polygons are cut here, and points and lines have no surface.
    let options = LoadOptions { single_index: true, triangulate: false, ignore_points: true, ignore_lines: true };
    let loaded = tobj::load_obj_buf(&mut reader, &options, |path| {
        let give_up = |why: String| {
            missing.borrow_mut().push(why);
            Ok(Default::default())
        };
        match library(path) {
            Err(why) => give_up(why),
            Ok(bytes) => {
                if let Some(line) = short_colour(&bytes) {
                    return give_up(format!("{}: line {line}: a colour has three numbers", path.display()));
                }
                let library_line = Cell::new(0);
                match tobj::load_mtl_buf(&mut Lines { bytes: &bytes, line: &library_line }) {
                    Ok(materials) => Ok(materials),
                    Err(error) => give_up(format!("{}: line {}: {error}", path.display(), library_line.get())),
                }
            }
        }
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
    let mut parts = Vec::with_capacity(models.len());
    for model in models {
        let material = model.mesh.material_id.and_then(|id| materials.get(id)).map(|m| m.name.clone());
        if let Some(part) = part(model, material, cut)? {
            parts.push(part);
        }
    }
    Ok(ObjFile { parts, materials, missing_libraries: missing.into_inner() })
}

fn part(model: tobj::Model, material: Option<String>, cut: Cut) -> Result<Option<Part>, MeshError> {
    let name = Some(model.name).filter(|name| !name.is_empty() && name != "unnamed_object");
    let tobj::Mesh { positions, normals, texcoords, indices, face_arities, .. } = model.mesh;
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
        // The reader leaves them out where only some of the faces have them.
        normals: match whole(&normals, 3) == count {
            true => normals.chunks_exact(3).map(|n| [n[0], n[1], n[2]]).collect(),
            false => Vec::new(),
        },
        uvs: match whole(&texcoords, 2) == count {
            true => texcoords.chunks_exact(2).map(|t| [t[0], t[1]]).collect(),
            false => Vec::new(),
        },
        colours: Vec::new(),
    };
    for i in 0..mesh.vertices.len() {
        check_vertex(i, mesh.vertices[i], mesh.normals.get_mut(i)).map_err(&fail)?;
    }
    if let Some(i) = mesh.uvs.iter().position(|uv| !uv.iter().all(|v| v.is_finite())) {
        return Err(fail(format!("the texture coordinates of vertex {i} are {:?}", mesh.uvs[i])));
    }
    let mut start = 0;
    let arities: Vec<usize> = match face_arities.is_empty() {
        true => vec![3; indices.len() / 3],
        false => face_arities.iter().map(|&n| n as usize).collect(),
    };
    for arity in arities {
        let corners = &indices[start..start + arity];
        cut.triangulate(corners, |v| mesh.vertices[v as usize], &mut mesh.triangles);
        start += arity;
    }
    Ok((!mesh.triangles.is_empty()).then(|| Part { name, material, mesh, ..Part::default() }))
}

/// The number of the first line of a material library that states a colour by fewer than three numbers, which the library that
/// reads them does not expect.
fn short_colour(bytes: &[u8]) -> Option<usize> {
    let is_short = |line: &[u8]| {
        let text = String::from_utf8_lossy(line);
        let mut words = text.split_whitespace();
        matches!(words.next(), Some("Ka" | "Kd" | "Ks" | "Ke")) && words.count() < 3
    };
    bytes.split(|&b| b == b'\n').position(is_short).map(|i| i + 1)
}

/// Refuses faces whose numbers count from nothing, or reach back before the first: the library that reads them computes with
/// such numbers modulo 2⁶⁴ and may find others in their place.
fn check_faces(bytes: &[u8]) -> Result<(), MeshError> {
    const NAMES: [&str; 3] = ["vertex", "texture coordinate", "normal"];
    let mut counts = [0_i64; 3];
    for (i, line) in bytes.split(|&b| b == b'\n').enumerate() {
        // What is no text or no number is left to the reader, which refuses it.
        let mut words = std::str::from_utf8(line).unwrap_or_default().split_whitespace();
        match words.next() {
            Some("v") => counts[0] += 1,
            Some("vt") => counts[1] += 1,
            Some("vn") => counts[2] += 1,
            Some("f" | "l") => {
                for corner in words {
                    for (k, number) in corner.split('/').enumerate().take(3) {
                        let fail =
                            |why: &str| MeshError::at_line(i + 1, format!("a face names {} {number}, {why}", NAMES[k]));
                        match number.parse::<i64>() {
                            Ok(0) => return Err(fail("but the first has the number 1")),
                            Ok(n) if n < -counts[k] => {
                                return Err(fail(&format!("where there are only {} so far", counts[k])));
                            }
                            Ok(n) if n > i64::from(u32::MAX) => return Err(fail("more than a mesh can have")),
                            _ => {}
                        }
                    }
                }
            }
            _ => {}
        }
    }
    Ok(())
}

/// Bytes that count the lines which have been taken of them.
struct Lines<'a> {
    bytes: &'a [u8],
    line: &'a Cell<usize>,
}

impl Read for Lines<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = self.bytes.read(buffer)?;
        let newlines = buffer[..n].iter().filter(|&&b| b == b'\n').count();
        self.line.set(self.line.get() + newlines);
        Ok(n)
    }
}

impl BufRead for Lines<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        // A line at a time, so that the count is that of the line in hand.
        let end = self.bytes.iter().position(|&b| b == b'\n').map_or(self.bytes.len(), |at| at + 1);
        Ok(&self.bytes[..end])
    }

    fn consume(&mut self, amount: usize) {
        self.line.set(self.line.get() + usize::from(amount > 0));
        self.bytes = &self.bytes[amount..];
    }
}
