//! Mesh files: PLY and OBJ in, PLY out.
//!
//! A reader takes the bytes of a file and gives [`Part`]s: a PLY file is one, an OBJ file one for each group and material.
//! Whatever a file holds, a reader neither panics nor takes more memory than a small multiple of the file's size: counts
//! in a header are held against the bytes that are there before anything is made of them.

mod area;
mod obj;
mod ply;
mod polygon;
mod smooth;
mod write;

pub use area::{area_vectors, has_area};
pub use obj::{ObjMaterial, read_obj};
pub use ply::read_ply;
pub use polygon::Cut;
pub use smooth::smooth_normals;
pub use write::write_ply;

use crate::model::Mesh;

/// Most vertices, and most triangles, of one mesh: what 29 bits can count.
pub const MAX_ELEMENTS: usize = 1 << 29;

/// A mesh of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// The group or object of the file, if it has a name.
    pub name: Option<String>,
    /// The name of its material, if it has one.
    pub material: Option<String>,
    /// Its triangles. Some may have no area.
    pub mesh: Mesh,
    /// Linear Rec. 709 colours of the faces: none, or one for each triangle.
    pub face_colours: Vec<[f32; 3]>,
    /// How many faces a PLY file has, each polygon once; 0 of other files.
    pub faces: usize,
    /// What the file says beyond that and is not used, each in a sentence without a full stop. The first part has what is said of the whole
    /// file.
    pub left_out: Vec<String>,
}

/// Which normals a mesh is shaded by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Shading {
    /// Those of the vertices, if there are any.
    Auto,
    /// The triangles' own.
    Flat,
    /// Vertex normals, made from the triangles if there are none.
    Smooth,
}

/// Why a mesh file is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{message}", line.map_or_else(String::new, |line| format!("line {line}: ")))]
pub struct MeshError {
    /// Line of the file, from 1, in a file made of lines.
    pub line: Option<usize>,
    /// What is wrong, and with which element, in a sentence without a full stop.
    pub message: String,
}

impl MeshError {
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Self { line: None, message: message.into() }
    }

    pub(crate) fn at_line(line: usize, message: impl Into<String>) -> Self {
        Self { line: Some(line), message: message.into() }
    }
}

/// Checks a vertex, number `index`, and its normal; scales the normal to unit length.
fn check_vertex(index: usize, position: [f64; 3], normal: Option<&mut [f32; 3]>) -> Result<(), String> {
    if !position.iter().all(|v| v.is_finite()) {
        return Err(format!("vertex {index} lies at {position:?}"));
    }
    if let Some(normal) = normal {
        let n = normal.map(f64::from);
        if !n.iter().all(|v| v.is_finite()) {
            return Err(format!("the normal of vertex {index} is {normal:?}"));
        }
        // Zero stays zero: such a vertex has no normal of its own.
        *normal = crate::linear::unit_normal(n);
    }
    Ok(())
}

/// A text of a parser's, which may quote the file, as one short line.
fn one_line(text: &str) -> String {
    let mut line: String =
        text.chars().map(|c| if c.is_control() { ' ' } else { c }).take(200).collect::<String>().trim().to_owned();
    while line.contains("  ") {
        line = line.replace("  ", " ");
    }
    line
}
