//! Files that a scene refers to: each read once, and remembered by its hash.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::fmt::Write as _;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use sha2::{Digest, Sha256};

use crate::grid::{self, Grid};
use crate::json::{Code, Reader, Spanned, did_you_mean, listed};
use crate::luminaire::{Photometry, read_photometry};
use crate::measured::{MeasuredBrdf, read_measured};
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

/// Where the files of a scene are.
#[derive(Debug)]
enum Source<'f> {
    /// Nowhere: the scene is a text alone.
    Nowhere,
    /// In a folder, to which names are relative.
    Folder(PathBuf),
    /// In memory, with the place of each by its name.
    Memory(&'f [NamedFile], HashMap<&'f str, usize>),
}

/// The files of one scene.
#[derive(Debug)]
pub(crate) struct Files<'f> {
    source: Source<'f>,
    meshes: HashMap<MeshKey, Option<Arc<Mesh>>>,
    images: HashMap<(String, Encoding), Option<Arc<Image>>>,
    data: HashMap<(String, Channel, Encoding), Option<Arc<Image>>>,
    grids: HashMap<String, Option<Grid>>,
    photometries: HashMap<String, Option<Arc<Photometry>>>,
    measured: HashMap<String, Option<Arc<MeasuredBrdf>>>,
    /// What of images is not used as colours.
    left_out: Vec<(Spanned<String>, String)>,
    used: Vec<FileUse>,
    /// Their names.
    noted: HashSet<String>,
}

impl<'f> Files<'f> {
    /// Files of a folder; of none without one.
    pub(crate) fn new(folder: Option<&Path>) -> Self {
        Self::of(folder.map_or(Source::Nowhere, |folder| Source::Folder(folder.to_owned())))
    }

    /// Files that are in memory. Of two with the same name the last counts.
    pub(crate) fn given(files: &'f [NamedFile]) -> Self {
        let places = files.iter().enumerate().map(|(place, file)| (file.name.as_str(), place));
        Self::of(Source::Memory(files, places.collect()))
    }

    fn of(source: Source<'f>) -> Self {
        Self {
            source,
            meshes: HashMap::new(),
            images: HashMap::new(),
            data: HashMap::new(),
            grids: HashMap::new(),
            photometries: HashMap::new(),
            measured: HashMap::new(),
            left_out: Vec::new(),
            used: Vec::new(),
            noted: HashSet::new(),
        }
    }

    /// The files that have been read.
    pub(crate) fn used(self) -> Vec<FileUse> {
        self.used
    }

    /// The bytes of a file; why there are none is reported at the name.
    pub(crate) fn bytes(&mut self, name: &Spanned<String>, reader: &mut Reader<'_>) -> Option<Cow<'f, [u8]>> {
        match self.find(&name.value) {
            Ok(bytes) => {
                if self.noted.insert(name.value.clone()) {
                    self.used.push(FileUse { name: name.value.clone(), sha256: sha256(&bytes) });
                }
                Some(bytes)
            }
            Err((message, hint)) => {
                reader.error_hint(Code::File, name.at, message, hint);
                None
            }
        }
    }

    /// The bytes of a file.
    ///
    /// # Errors
    /// Why there are none, and a hint, which may be empty.
    fn find(&self, name: &str) -> Result<Cow<'f, [u8]>, (String, String)> {
        let (files, places) = match &self.source {
            Source::Nowhere => {
                return Err((format!("\"{name}\" cannot be found: this scene has no folder"), String::new()));
            }
            Source::Folder(folder) => {
                let path = folder.join(name);
                let hint = "names of files are relative to the folder of the scene";
                let refuse = |why| (format!("cannot read {}: {why}", path.display()), hint.to_owned());
                return read_file(&path).map(Cow::Owned).map_err(refuse);
            }
            Source::Memory(files, places) => (*files, places),
        };
        let Some(file) = places.get(name).map(|place| &files[*place]) else {
            let names = || files.iter().map(|file| file.name.as_str());
            let hint = match did_you_mean(name, names()) {
                Some(meant) => format!("did you mean \"{meant}\"?"),
                None if files.is_empty() => "there are none".to_owned(),
                None => format!("there are {}", listed(names())),
            };
            return Err((format!("\"{name}\" is not among the files in memory"), hint));
        };
        check_size(file.bytes.len() as u64).map_err(|why| (format!("{name}: {why}"), String::new()))?;
        Ok(Cow::Borrowed(&file.bytes))
    }

    /// Whether a name, which is not the address of a page, leads to no file from the scene's folder. A scene without a folder lacks none.
    pub(crate) fn lacks_beside_the_scene(&self, name: &str) -> bool {
        let is_address = name.contains("://");
        matches!(&self.source, Source::Folder(folder) if !is_address && !folder.join(name).exists())
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
            Image::decode_data(&bytes, channel, encoding)
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

    /// The intensities of an IES or EULUMDAT file; why there are none is reported at the name.
    pub(crate) fn photometry(&mut self, name: &Spanned<String>, reader: &mut Reader<'_>) -> Option<Arc<Photometry>> {
        if let Some(known) = self.photometries.get(&name.value) {
            return known.clone();
        }
        let made = self.bytes(name, reader).and_then(|bytes| {
            read_photometry(&name.value, &bytes)
                .map_err(|why| reader.error(Code::File, name.at, format!("{}: {why}", name.value)))
                .ok()
                .map(Arc::new)
        });
        self.photometries.insert(name.value.clone(), made.clone());
        made
    }

    /// The measured BRDF of a file; why there is none is reported at the name.
    pub(crate) fn measured(&mut self, name: &Spanned<String>, reader: &mut Reader<'_>) -> Option<Arc<MeasuredBrdf>> {
        if let Some(known) = self.measured.get(&name.value) {
            return known.clone();
        }
        let made = self.bytes(name, reader).and_then(|bytes| match read_measured(&bytes) {
            Ok((brdf, changed)) => {
                if let Some(what) = changed {
                    reader.warning(Code::LeftOut, name.at, format!("{}: {what}", name.value), None);
                }
                Some(Arc::new(brdf))
            }
            Err(why) => {
                reader.error(Code::File, name.at, format!("{}: {why}", name.value));
                None
            }
        });
        self.measured.insert(name.value.clone(), made.clone());
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
        let made = self.bytes(name, reader).and_then(|bytes| match Image::decode(&bytes, encoding) {
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
    check_size(kind.len())?;
    let mut bytes = Vec::with_capacity(kind.len() as usize);
    file.take(MAX_FILE_BYTES).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// Whether a file of this many bytes may be read.
fn check_size(bytes: u64) -> Result<(), String> {
    if bytes <= MAX_FILE_BYTES {
        Ok(())
    } else {
        Err(format!("it has {bytes} bytes; at most {MAX_FILE_BYTES} are read"))
    }
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().fold(String::new(), |mut hex, byte| {
        // Writing to a String cannot fail.
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_may_have_4_gib() {
        assert_eq!(check_size(4 << 30), Ok(()));
        assert!(check_size((4 << 30) + 1).is_err_and(|why| why.contains("at most 4294967296 are read")));
    }
}
