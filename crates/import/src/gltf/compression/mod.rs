//! Compressed meshes and buffers: `KHR_draco_mesh_compression`, `EXT_meshopt_compression` and `KHR_meshopt_compression`. All is undone before
//! anything is read, so nothing else knows of it: what was compressed becomes buffers, views and accessors without extensions. So do the zeros of
//! accessors without data.

mod draco;
mod meshopt;

use gltf::json::buffer::{Buffer, View};
use gltf::json::validation::Checked::Valid;
use gltf::json::validation::USize64;
use gltf::json::{Index, Root};
use serde_json::{Map, Value};

use super::accessor::{MOST_WITHOUT_DATA, TOO_MANY_WITHOUT_DATA};

/// The extensions that are undone here.
pub(super) const UNDONE: [&str; 3] = [draco::NAME, meshopt::NAMES[0], meshopt::NAMES[1]];

/// The most bytes that all compressed parts of a file may become: few bytes can stand for many.
const MOST_BYTES: usize = 1 << 30;
const TOO_MUCH: &str = "the compressed parts of the file would take more than 1 GiB";

/// Writes out all that is compressed, in `buffers` that follow the file's own.
pub(super) fn undo(root: &mut Root, buffers: &mut Vec<Vec<u8>>) -> Result<(), String> {
    let mut out = Decoded { root, buffers, left: MOST_BYTES };
    meshopt::undo(&mut out)?;
    draco::undo(&mut out)?;
    out.write_zeros()
}

/// Whether a buffer is only a fallback for compressed data and may lack its bytes.
pub(super) fn is_placeholder(buffer: &Buffer) -> bool {
    let stated = buffer.extensions.as_ref().map(|extensions| &extensions.others);
    stated.is_some_and(|stated| {
        meshopt::NAMES.iter().any(|name| stated.get(*name).is_some_and(|extension| extension["fallback"] == true))
    })
}

/// A file whose compressed parts become plain ones.
struct Decoded<'a> {
    root: &'a mut Root,
    buffers: &'a mut Vec<Vec<u8>>,
    /// How many bytes more may be written out.
    left: usize,
}

impl Decoded<'_> {
    /// Gives accessors without data their zeros, all in one view: the library takes them for a mistake.
    fn write_zeros(&mut self) -> Result<(), String> {
        let (mut without, mut longest) = (Vec::new(), 0);
        for (index, accessor) in self.root.accessors.iter().enumerate() {
            let (Valid(component), Valid(kind)) = (&accessor.component_type, &accessor.type_) else { continue };
            if accessor.buffer_view.is_some() || accessor.sparse.is_some() {
                continue;
            }
            if accessor.count.0 > MOST_WITHOUT_DATA as u64 {
                return Err(format!("$.accessors[{index}]: {TOO_MANY_WITHOUT_DATA}"));
            }
            longest = longest.max(accessor.count.0 as usize * component.0.size() * kind.multiplicity());
            without.push(index);
        }
        if without.is_empty() {
            return Ok(());
        }
        self.may_become(Some(longest))?;
        let view = self.add_view(vec![0; longest]);
        for index in without {
            let accessor = &mut self.root.accessors[index];
            (accessor.buffer_view, accessor.byte_offset) = (Some(view), None);
        }
        Ok(())
    }

    /// Fails if this many bytes more are too many.
    fn may_become(&self, bytes: Option<usize>) -> Result<(), String> {
        match bytes {
            Some(bytes) if bytes <= self.left => Ok(()),
            _ => Err(TOO_MUCH.to_owned()),
        }
    }

    /// Adds a buffer of these bytes.
    fn add_buffer(&mut self, bytes: Vec<u8>) -> Index<Buffer> {
        self.left = self.left.saturating_sub(bytes.len());
        let byte_length = USize64(bytes.len() as u64);
        self.buffers.push(bytes);
        self.root.push(Buffer {
            byte_length,
            name: None,
            uri: None,
            extensions: None,
            extras: gltf::json::Extras::default(),
        })
    }

    /// Adds a view of a whole buffer of these bytes.
    fn add_view(&mut self, bytes: Vec<u8>) -> Index<View> {
        let byte_length = USize64(bytes.len() as u64);
        let buffer = self.add_buffer(bytes);
        self.root.push(View {
            buffer,
            byte_length,
            byte_offset: None,
            byte_stride: None,
            name: None,
            target: None,
            extensions: None,
            extras: gltf::json::Extras::default(),
        })
    }
}

/// A whole number of an extension; `None` if it is missing or something else.
fn whole_number(extension: &Map<String, Value>, key: &str) -> Option<usize> {
    usize::try_from(extension.get(key)?.as_u64()?).ok()
}

/// The part of a buffer from `offset` on.
fn part(buffers: &[Vec<u8>], buffer: usize, offset: usize, length: usize) -> Result<&[u8], String> {
    let bytes = buffers.get(buffer).ok_or_else(|| format!("it names buffer {buffer}; there are {}", buffers.len()))?;
    offset.checked_add(length).and_then(|end| bytes.get(offset..end)).ok_or_else(|| "it leaves its buffer".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use base64::Engine as _;
    use serde_json::json;

    /// A pyramid of 5 corners with 32 bytes each and 6 triangles, by the reference encoder.
    const PYRAMID: &str = "RFJBQ08CAgEAAAAGBQEAAQIAAgMABAEBBAICBAMDBAABAwMJAgEAAQkDAAEACQMAAgIDAgABAQANA2kmzQwjzQwDBfWdpPy/AAIAAAAA/w8AAAADAQALI80MNTMD8t+CaS\
        u99NIA1C69dC2VAv8DAAD/AQAAAAEBABEDaSbNDDPNDAMF9Z0Ihf//AMD+fwAAAAD//wAAAAAAAAAAAAAAAIA/DAoAAAAAAAAAAAAAAAAAAABAEA==";

    #[test]
    fn each_primitive_that_names_a_stream_counts_even_if_it_uses_nothing_of_it() {
        let stream = base64::engine::general_purpose::STANDARD.decode(PYRAMID).unwrap();
        let compressed = json!({ (draco::NAME): { "bufferView": 0, "attributes": {} } });
        let primitive = json!({ "attributes": {}, "extensions": compressed });
        let mut model = json!({
            "asset": { "version": "2.0" }, "meshes": [{ "primitives": [primitive] }],
            "buffers": [{ "byteLength": stream.len() }], "bufferViews": [{ "buffer": 0, "byteLength": stream.len() }],
        });
        let decode = |model: &Value, left: usize| {
            let mut root: Root = serde_json::from_value(model.clone()).unwrap();
            let mut buffers = vec![stream.clone()];
            let mut out = Decoded { root: &mut root, buffers: &mut buffers, left };
            draco::undo(&mut out).map(|()| out.left)
        };
        // 160 bytes of corners and 72 of triangles.
        assert_eq!(decode(&model, 300), Ok(68));
        assert_eq!(decode(&model, 220), Err(format!("$.meshes[0].primitives[0]: {TOO_MUCH}")));
        model["meshes"][0]["primitives"] = json!([primitive, primitive]);
        assert_eq!(decode(&model, 300), Err(format!("$.meshes[0].primitives[1]: {TOO_MUCH}")));
    }
}
