//! Files of the scene that is being made: meshes and images.

use std::io::Cursor;
use std::path::Path;

use etalon_scene::mesh::{has_area, write_ply};
use etalon_scene::{Encoding, Image, Mesh, NamedFile, Symmetry, read_measured};
use image::{ImageBuffer, ImageFormat, Rgb};
use serde_json::{Value, json};

use super::Builder;
use crate::extension;

/// An image that has been decoded.
#[derive(Clone, Debug)]
pub(super) struct KnownImage {
    /// Its file in the scene.
    file: String,
    /// The mean of its texels.
    mean: [f64; 3],
    /// Columns and rows.
    size: [u32; 2],
    /// What of it is not used.
    left_out: Option<String>,
}

impl Builder<'_> {
    /// Adds a file, and gives the name that the scene has for it.
    pub(crate) fn add_file(&mut self, kind: &str, extension: &str, bytes: Vec<u8>) -> String {
        let name = format!("{}{kind}-{}.{extension}", self.prefix, self.files.len());
        self.files.push(NamedFile { name: name.clone(), bytes });
        name
    }

    /// Adds a mesh as a file, and gives its name; if no triangle has an area, that is kept for the objects made of it.
    pub(crate) fn mesh_file(&mut self, mesh: &Mesh) -> String {
        let mut bytes = Vec::with_capacity(40 * mesh.vertices.len() + 13 * mesh.triangles.len());
        // Writing to memory cannot fail.
        let _ = write_ply(mesh, &mut bytes);
        let file = self.add_file("mesh", "ply", bytes);
        if !mesh.triangles.iter().any(|triangle| has_area(mesh, triangle)) {
            self.flat_meshes.insert(file.clone());
        }
        file
    }

    /// The bytes of a file that the model names.
    pub(crate) fn bytes_of(&self, name: &str, place: &str) -> Result<Vec<u8>, String> {
        self.named_bytes(name).map_err(|why| format!("{place}: {why}"))
    }

    /// The same, for a message that has its place.
    fn named_bytes(&self, name: &str) -> Result<Vec<u8>, String> {
        let name = name.replace('\\', "/");
        (self.near)(&name).map_err(|why| format!("\"{name}\" cannot be read: {why}"))
    }

    /// Adds a copy of a file that the model names, once, and gives the name that the scene has for it.
    pub(crate) fn copy(&mut self, kind: &str, name: &str, bytes: Vec<u8>) -> String {
        if let Some(Some(file)) = self.known.get(name) {
            return file.clone();
        }
        let file = self.add_file(kind, &extension(Path::new(name)), bytes);
        self.known.insert(name.to_owned(), Some(file.clone()));
        file
    }

    /// A measured BRDF as a material, without its sides. Its file is read and copied once.
    pub(crate) fn measured(&mut self, name: &str, place: &str) -> Result<Value, String> {
        if let Some(known) = self.measured.get(name) {
            return Ok(known.clone());
        }
        let bytes = self.bytes_of(name, place)?;
        let (brdf, _) = read_measured(&bytes).map_err(|why| format!("{place}: \"{name}\": {why}"))?;
        let mut material = json!({ "type": "measured", "file": self.copy("measured", name, bytes) });
        if brdf.symmetry() != Symmetry::Isotropic {
            material["tangent_rotation_deg"] = json!(0);
        }
        self.measured.insert(name.to_owned(), material.clone());
        Ok(material)
    }

    /// Adds the file of an image, once, and gives its name in the scene and the mean of its texels.
    pub(crate) fn image_file(
        &mut self,
        name: &str,
        encoding: Encoding,
        place: &str,
    ) -> Result<(String, [f64; 3]), String> {
        let key = (name.to_owned(), encoding);
        let known = match self.images.get(&key) {
            Some(known) => known.clone(),
            None => {
                let read = self.read_image(name, encoding);
                self.images.insert(key, read.clone());
                read
            }
        };
        let KnownImage { file, mean, left_out, .. } = known?;
        if let Some(what) = left_out {
            self.leave_out(place, what);
        }
        Ok((file, mean))
    }

    /// Columns and rows of an image that was read, by the file that the scene names.
    pub(crate) fn image_size(&self, file: &str) -> Option<[u32; 2]> {
        self.images.values().flatten().find(|known| known.file == file).map(|known| known.size)
    }

    /// Adds an image of the square roots of another's linear channels, in steps of 1/65535, once. It is linear.
    pub(crate) fn root_of_image(&mut self, file: &str, encoding: Encoding, place: &str) -> Option<String> {
        let key = format!("the roots of {file}, {encoding:?}");
        if let Some(known) = self.made.get(&key) {
            return Some(known.clone());
        }
        let bytes = &self.files.iter().find(|known| known.name == file)?.bytes;
        let (image, _) = Image::decode(bytes, encoding).ok()?;
        if image.linear_texels().flatten().any(|channel| channel > 1.0) {
            self.approximate(place, "texels of the base colour of glass above 1 become 1");
        }
        let steps = |channel: f64| (channel.clamp(0.0, 1.0).sqrt() * f64::from(u16::MAX)).round() as u16;
        let texels = image.linear_texels().flat_map(|texel| texel.map(steps)).collect();
        let roots = ImageBuffer::<Rgb<u16>, Vec<u16>>::from_raw(image.width, image.height, texels)?;
        let mut png = Cursor::new(Vec::new());
        roots.write_to(&mut png, ImageFormat::Png).ok()?;
        let name = self.add_file("root", "png", png.into_inner());
        self.made.insert(key, name.clone());
        Some(name)
    }

    fn read_image(&mut self, name: &str, encoding: Encoding) -> Result<KnownImage, String> {
        let bytes = self.named_bytes(name)?;
        let (image, left_out) = Image::decode(&bytes, encoding)?;
        let file = match self.known.get(name) {
            Some(Some(file)) => file.clone(),
            _ => {
                let file = self.add_file("image", &extension(Path::new(name)), bytes);
                self.known.insert(name.to_owned(), Some(file.clone()));
                file
            }
        };
        let size = [image.width, image.height];
        Ok(KnownImage { file, mean: image.mean(), size, left_out })
    }
}
