//! Writing PLY.

use std::io::{self, Write};

use crate::model::Mesh;

/// Writes a mesh as a binary little-endian PLY file: positions in `f64` unless all of them are `f32` numbers, normals,
/// texture coordinates and colours, if there are any, in `f32`. What [`read_ply`](super::read_ply) reads of it equals the mesh.
///
/// # Errors
/// If the writer fails.
pub fn write_ply(mesh: &Mesh, out: &mut impl Write) -> io::Result<()> {
    let single = mesh.vertices.iter().flatten().all(|&v| f64::from(v as f32) == v);
    let (normals, uvs, colours) = (!mesh.normals.is_empty(), !mesh.uvs.is_empty(), !mesh.colours.is_empty());
    let number = if single { "float" } else { "double" };
    let mut header = format!("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.vertices.len());
    ["x", "y", "z"].iter().for_each(|axis| header += &format!("property {number} {axis}\n"));
    if normals {
        header += "property float nx\nproperty float ny\nproperty float nz\n";
    }
    if uvs {
        header += "property float u\nproperty float v\n";
    }
    if colours {
        header += "property float red\nproperty float green\nproperty float blue\n";
    }
    header += &format!("element face {}\nproperty list uchar uint vertex_indices\nend_header\n", mesh.triangles.len());
    out.write_all(header.as_bytes())?;
    for (i, vertex) in mesh.vertices.iter().enumerate() {
        for v in vertex {
            match single {
                true => out.write_all(&(*v as f32).to_le_bytes())?,
                false => out.write_all(&v.to_le_bytes())?,
            }
        }
        let (normal, uv, colour) = (mesh.normals.get(i), mesh.uvs.get(i), mesh.colours.get(i));
        let extra = normal.into_iter().flatten().chain(uv.into_iter().flatten());
        for v in extra.chain(colour.into_iter().flatten()) {
            out.write_all(&v.to_le_bytes())?;
        }
    }
    for triangle in &mesh.triangles {
        out.write_all(&[3])?;
        for index in triangle {
            out.write_all(&index.to_le_bytes())?;
        }
    }
    Ok(())
}
