//! Files that a scene refers to: each read once, and remembered by its hash.

use std::collections::{HashMap, HashSet};
use std::fmt::Write as _;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use sha2::{Digest, Sha256};

use crate::grid::{self, Grid};
use crate::json::{Code, Reader, Spanned};
use crate::mesh::Shading;
use crate::model::Mesh;
use crate::texture::{Channel, Encoding, Image};

/// The largest file that a scene may refer to, bytes: 4 GiB.
pub const MAX_FILE_BYTES: u64 = 4 << 30;

/// A file that a scene refers to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileUse {
    /// Its name, as the scene writes it.
    pub name: String,
    /// SHA-256 of its bytes, in hex.
    pub sha256: String,
}

/// A file in memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedFile {
    /// Its name, as the scene writes it.
    pub name: String,
    /// Its contents.
    pub bytes: Vec<u8>,
}

/// What makes a mesh of a file.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct MeshKey {
    pub(crate) file: String,
    pub(crate) group: Option<String>,
    pub(crate) shading: Shading,
}

/// The files of one scene.
#[derive(Debug)]
pub(crate) struct Files {
    folder: Option<PathBuf>,
    /// Files in memory, by name.
    given: HashMap<String, Vec<u8>>,
    meshes: HashMap<MeshKey, Option<Arc<Mesh>>>,
    images: HashMap<(String, Encoding), Option<Arc<Image>>>,
    data: HashMap<(String, Channel, Encoding), Option<Arc<Image>>>,
    grids: HashMap<String, Option<Grid>>,
    /// What of images is not used as colours.
    left_out: Vec<(Spanned<String>, String)>,
    used: Vec<FileUse>,
    /// Their names.
    noted: HashSet<String>,
}

impl Files {
    pub(crate) fn new(folder: Option<&Path>) -> Self {
        Self {
            folder: folder.map(Path::to_owned),
            given: HashMap::new(),
            meshes: HashMap::new(),
            images: HashMap::new(),
            data: HashMap::new(),
            grids: HashMap::new(),
            left_out: Vec::new(),
            used: Vec::new(),
            noted: HashSet::new(),
        }
    }

    /// Files that are in memory.
    pub(crate) fn given(files: &[NamedFile]) -> Self {
        let given = files.iter().map(|file| (file.name.clone(), file.bytes.clone())).collect();
        Self { given, ..Self::new(None) }
    }

    /// The files that have been read.
    pub(crate) fn used(self) -> Vec<FileUse> {
        self.used
    }

    /// The bytes of a file; why there are none is reported at the name.
    pub(crate) fn bytes(&mut self, name: &Spanned<String>, reader: &mut Reader<'_>) -> Option<Vec<u8>> {
        if let Some(bytes) = self.given.get_mut(&name.value).map(std::mem::take) {
            self.note(name, &bytes);
            return Some(bytes);
        }
        let Some(folder) = &self.folder else {
            let message = format!("\"{}\" cannot be found: this scene has no folder", name.value);
            reader.error(Code::File, name.at, message);
            return None;
        };
        let path = folder.join(&name.value);
        match read_file(&path) {
            Ok(bytes) => {
                self.note(name, &bytes);
                Some(bytes)
            }
            Err(why) => {
                let hint = "names of files are relative to the folder of the scene";
                reader.error_hint(Code::File, name.at, format!("cannot read {}: {why}", path.display()), hint);
                None
            }
        }
    }

    /// Whether a name, which is not the address of a page, leads to no file from the scene's folder. A scene without a folder lacks none.
    pub(crate) fn lacks_beside_the_scene(&self, name: &str) -> bool {
        let is_address = name.contains("://");
        self.folder.as_ref().is_some_and(|folder| !is_address && !folder.join(name).exists())
    }

    fn note(&mut self, name: &Spanned<String>, bytes: &[u8]) {
        if self.noted.insert(name.value.clone()) {
            self.used.push(FileUse { name: name.value.clone(), sha256: sha256(bytes) });
        }
    }

    /// Keeps the bytes of a file in memory that may be asked for once more: an image can be colours and data.
    fn put_back(&mut self, name: &str, bytes: Vec<u8>) {
        if let Some(given) = self.given.get_mut(name) {
            *given = bytes;
        }
    }

    /// Warns of what images hold and nothing uses, once everything has been read.
    pub(crate) fn warn_of_what_is_left_out(&mut self, reader: &mut Reader<'_>) {
        for (name, what) in self.left_out.drain(..) {
            let uses_alpha = |channel| matches!(channel, Channel::Alpha | Channel::Auto);
            if !self.data.keys().any(|(file, channel, _)| *file == name.value && uses_alpha(*channel)) {
                reader.warning(Code::LeftOut, name.at, format!("{}: {what}", name.value), None);
            }
        }
    }

    /// The data in an image file; why there are none is reported at the name.
    pub(crate) fn data(
        &mut self,
        name: &Spanned<String>,
        channel: Channel,
        encoding: Encoding,
        reader: &mut Reader<'_>,
    ) -> Option<Arc<Image>> {
        let key = (name.value.clone(), channel, encoding);
        if let Some(known) = self.data.get(&key) {
            return known.clone();
        }
        let made = self.bytes(name, reader).and_then(|bytes| {
            let decoded = Image::decode_data(&bytes, channel, encoding);
            self.put_back(&name.value, bytes);
            decoded
                .map_err(|why| reader.error(Code::ImageFile, name.at, format!("{}: {why}", name.value)))
                .ok()
                .map(Arc::new)
        });
        self.data.insert(key, made.clone());
        made
    }

    /// The grid of a .vol file; why there is none is reported at the name.
    pub(crate) fn grid(&mut self, name: &Spanned<String>, reader: &mut Reader<'_>) -> Option<Grid> {
        if let Some(known) = self.grids.get(&name.value) {
            return known.clone();
        }
        let made = self.bytes(name, reader).and_then(|bytes| {
            grid::read_vol(&bytes)
                .map_err(|why| reader.error(Code::File, name.at, format!("{}: {why}", name.value)))
                .ok()
        });
        self.grids.insert(name.value.clone(), made.clone());
        made
    }

    /// The mesh of a key, made by `make` if it has not been asked for before.
    pub(crate) fn mesh(&mut self, key: MeshKey, make: impl FnOnce(&mut Self) -> Option<Mesh>) -> Option<Arc<Mesh>> {
        if let Some(known) = self.meshes.get(&key) {
            return known.clone();
        }
        let made = make(self).map(Arc::new);
        self.meshes.insert(key, made.clone());
        made
    }

    /// The image of a file; why there is none is reported at the name.
    pub(crate) fn image(
        &mut self,
        name: &Spanned<String>,
        encoding: Encoding,
        reader: &mut Reader<'_>,
    ) -> Option<Arc<Image>> {
        let key = (name.value.clone(), encoding);
        if let Some(known) = self.images.get(&key) {
            return known.clone();
        }
        let made = self.bytes(name, reader).and_then(|bytes| {
            let decoded = Image::decode(&bytes, encoding);
            self.put_back(&name.value, bytes);
            match decoded {
                Ok((image, left_out)) => {
                    if let Some(what) = left_out {
                        self.left_out.push((name.clone(), what));
                    }
                    Some(Arc::new(image))
                }
                Err(why) => {
                    reader.error(Code::ImageFile, name.at, format!("{}: {why}", name.value));
                    None
                }
            }
        });
        self.images.insert(key, made.clone());
        made
    }
}

/// The bytes of a plain file of at most [`MAX_FILE_BYTES`]. Pipes, devices and folders are refused.
///
/// # Errors
/// A sentence that says why the file cannot be read.
pub fn read_file(path: &Path) -> Result<Vec<u8>, String> {
    let file = etalon_picture::open_plain(path).map_err(|error| error.to_string())?;
    let kind = file.metadata().map_err(|error| error.to_string())?;
    if kind.len() > MAX_FILE_BYTES {
        return Err(format!("it has {} bytes; at most {MAX_FILE_BYTES} are read", kind.len()));
    }
    let mut bytes = Vec::with_capacity(kind.len() as usize);
    file.take(MAX_FILE_BYTES).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    Ok(bytes)
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().fold(String::new(), |mut hex, byte| {
        // Writing to a String cannot fail.
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}
