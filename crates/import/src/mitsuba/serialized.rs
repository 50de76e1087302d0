//! Mitsuba's `serialized` meshes: several in a file, each compressed by zlib, with a list of their places at the end.

use std::io::Read;

use etalon_scene::Mesh;
use etalon_scene::mesh::{MAX_ELEMENTS, Part};
use flate2::bufread::ZlibDecoder;

/// The first number of every mesh.
const MAGIC: u16 = 0x041c;
/// Most bytes that one mesh may have when it is not compressed.
const MOST_BYTES: usize = 1 << 31;

const NORMALS: u32 = 0x1;
const UVS: u32 = 0x2;
const COLOURS: u32 = 0x8;
const FACE_NORMALS: u32 = 0x10;
const DOUBLE: u32 = 0x2000;

/// The mesh number `index` of a file, and whether its normals are to be those of its faces.
///
/// # Errors
/// A sentence, without its place, if there is none or it is damaged.
pub(super) fn read(file: &[u8], index: usize) -> Result<(Part, bool), String> {
    let head: [u8; 4] = file.get(..4).and_then(|head| head.try_into().ok()).ok_or("it is too short")?;
    let [magic, version] = [[head[0], head[1]], [head[2], head[3]]].map(u16::from_le_bytes);
    if magic != MAGIC || !(3..=4).contains(&version) {
        return Err(format!("it begins with {magic:#06x} and {version}, not with {MAGIC:#06x} and the version 3 or 4"));
    }
    // The last four bytes count the meshes, what is before them says where each begins.
    let (places, count) = file.split_last_chunk::<4>().ok_or("it is too short")?;
    let count = u32::from_le_bytes(*count) as usize;
    if index >= count {
        return Err(format!("it has {count} meshes, none of which is number {index}"));
    }
    let size = if version == 4 { 8 } else { 4 };
    let at = places.len().checked_sub(size * (count - index)).ok_or("its list of meshes is cut off")?;
    let mut word = [0; 8];
    word[..size].copy_from_slice(places.get(at..at + size).ok_or("its list of meshes is cut off")?);
    let begin = usize::try_from(u64::from_le_bytes(word)).map_err(|_| "a mesh lies beyond its end")?;
    let compressed = begin.checked_add(4).and_then(|begin| file.get(begin..)).ok_or("a mesh lies beyond its end")?;
    let mut bytes = Vec::new();
    let inflated = ZlibDecoder::new(compressed).take(MOST_BYTES as u64 + 1).read_to_end(&mut bytes);
    inflated.map_err(|error| format!("its mesh {index} cannot be decompressed: {error}"))?;
    if bytes.len() > MOST_BYTES {
        return Err(format!("its mesh {index} has more than {MOST_BYTES} bytes"));
    }
    mesh(&bytes, version).map_err(|why| format!("mesh {index}: {why}"))
}

fn mesh(bytes: &[u8], version: u16) -> Result<(Part, bool), String> {
    let mut rest = Rest(bytes);
    let flags = u32::from_le_bytes(rest.take()?);
    let name = if version == 4 { rest.name()? } else { String::new() };
    let [vertices, triangles] = [rest.count()?, rest.count()?];
    let double = flags & DOUBLE != 0;
    // Counts are held against the bytes that are there before room is made for them.
    let per_vertex = 3 + 3 * usize::from(flags & NORMALS != 0) + 2 * usize::from(flags & UVS != 0);
    let per_vertex = per_vertex + 3 * usize::from(flags & COLOURS != 0);
    if vertices * per_vertex * if double { 8 } else { 4 } + 12 * triangles > rest.0.len() {
        return Err(format!("{vertices} vertices and {triangles} triangles are more than its bytes"));
    }
    let mut mesh = Mesh { vertices: rest.tuples(vertices, double)?, ..Mesh::default() };
    if let Some(i) = mesh.vertices.iter().position(|v| !v.iter().all(|c| c.is_finite())) {
        return Err(format!("vertex {i} lies at {:?}", mesh.vertices[i]));
    }
    if flags & NORMALS != 0 {
        mesh.normals = rest.tuples(vertices, double)?.into_iter().map(|n: [f64; 3]| n.map(|c| c as f32)).collect();
    }
    if flags & UVS != 0 {
        mesh.uvs = rest.tuples(vertices, double)?.into_iter().map(|uv: [f64; 2]| uv.map(|c| c as f32)).collect();
    }
    if flags & COLOURS != 0 {
        mesh.colours = rest.tuples(vertices, double)?.into_iter().map(|rgb: [f64; 3]| rgb.map(|c| c as f32)).collect();
    }
    for i in 0..triangles {
        let corners: [[u8; 4]; 3] = [rest.take()?, rest.take()?, rest.take()?];
        let corners = corners.map(u32::from_le_bytes);
        if let Some(corner) = corners.iter().find(|corner| **corner as usize >= vertices) {
            return Err(format!("triangle {i} has the vertex {corner} of {vertices}"));
        }
        mesh.triangles.push(corners);
    }
    let name = (!name.is_empty()).then_some(name);
    Ok((Part { name, mesh, ..Part::default() }, flags & FACE_NORMALS != 0))
}

/// What has not been read yet.
struct Rest<'a>(&'a [u8]);

impl Rest<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let (first, rest) = self.0.split_first_chunk::<N>().ok_or("it is cut off")?;
        self.0 = rest;
        Ok(*first)
    }

    fn count(&mut self) -> Result<usize, String> {
        let count = u64::from_le_bytes(self.take()?);
        let count = usize::try_from(count).ok().filter(|count| *count <= MAX_ELEMENTS);
        count.ok_or_else(|| format!("more than {MAX_ELEMENTS} vertices or triangles"))
    }

    /// A text that ends with a zero.
    fn name(&mut self) -> Result<String, String> {
        let end = self.0.iter().position(|byte| *byte == 0).ok_or("its name does not end")?;
        let name = String::from_utf8_lossy(&self.0[..end]).into_owned();
        self.0 = &self.0[end + 1..];
        Ok(name)
    }

    fn tuples<const N: usize>(&mut self, count: usize, double: bool) -> Result<Vec<[f64; N]>, String> {
        let mut tuples = Vec::with_capacity(count);
        for _ in 0..count {
            let mut tuple = [0.0; N];
            for value in &mut tuple {
                *value = match double {
                    true => f64::from_le_bytes(self.take()?),
                    false => f64::from(f32::from_le_bytes(self.take()?)),
                };
            }
            tuples.push(tuple);
        }
        Ok(tuples)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::Compression;
    use flate2::bufread::ZlibEncoder;

    /// A triangle with texture coordinates whose third vertex lies at `z`.
    fn triangle(version: u16, z: f64, corners: [u32; 3]) -> Vec<u8> {
        let mut bytes = (UVS | FACE_NORMALS | DOUBLE).to_le_bytes().to_vec();
        if version == 4 {
            bytes.extend(b"a name\0");
        }
        bytes.extend([3_u64, 1].iter().flat_map(|count| count.to_le_bytes()));
        let positions = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, z];
        let uvs = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0_f64];
        bytes.extend(positions.iter().chain(&uvs).flat_map(|v| v.to_le_bytes()));
        bytes.extend(corners.iter().flat_map(|corner| corner.to_le_bytes()));
        let head = [MAGIC, version].into_iter().flat_map(u16::to_le_bytes);
        let mut file: Vec<u8> = head.collect();
        ZlibEncoder::new(bytes.as_slice(), Compression::default()).read_to_end(&mut file).expect("memory can be read");
        file
    }

    fn file(version: u16, meshes: &[Vec<u8>]) -> Vec<u8> {
        let mut file = Vec::new();
        let mut places = Vec::new();
        for mesh in meshes {
            match version {
                4 => places.extend((file.len() as u64).to_le_bytes()),
                _ => places.extend((file.len() as u32).to_le_bytes()),
            }
            file.extend(mesh);
        }
        file.extend(places);
        file.extend((meshes.len() as u32).to_le_bytes());
        file
    }

    #[test]
    fn each_mesh_of_a_file_is_found_by_its_number() {
        for version in [3, 4] {
            let file = file(version, &[triangle(version, 2.0, [0, 1, 2]), triangle(version, 3.0, [2, 1, 0])]);
            for (index, z, corners) in [(0, 2.0, [0, 1, 2]), (1, 3.0, [2, 1, 0])] {
                let (part, flat) = read(&file, index).expect("a mesh");
                assert_eq!((part.mesh.vertices[2], part.mesh.triangles[0], flat), ([0.0, 1.0, z], corners, true));
                assert_eq!((part.mesh.uvs[1], part.mesh.normals.len()), ([1.0, 0.0], 0));
                assert_eq!(part.name.as_deref(), (version == 4).then_some("a name"));
            }
            assert!(read(&file, 2).expect_err("there are two").contains("2 meshes"));
        }
    }

    #[test]
    fn damaged_files_are_refused_wherever_they_are_cut_or_changed() {
        let whole = file(4, &[triangle(4, 2.0, [0, 1, 2])]);
        for length in 0..whole.len() {
            assert!(read(&whole[..length], 0).is_err(), "{length}");
        }
        for at in 0..whole.len() {
            let mut changed = whole.clone();
            changed[at] ^= 0x55;
            // It may be another mesh, but never a fault of the program.
            let _ = read(&changed, 0);
        }
        let outside = file(4, &[triangle(4, 2.0, [0, 1, 3])]);
        assert!(read(&outside, 0).expect_err("3 of 3").contains("vertex 3 of 3"));
        let infinite = file(4, &[triangle(4, f64::INFINITY, [0, 1, 2])]);
        assert!(read(&infinite, 0).expect_err("no place").contains("vertex 2"));
    }
}
