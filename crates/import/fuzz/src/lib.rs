//! What the targets share: a model is imported and, if that succeeds, read as the scene that it became.

use etalon_import::{Moment, Options, import_bytes_with};

/// Two by two texels.
const PNG: &[u8] = include_bytes!("../../../scene/fuzz/seeds/image/chequers.png");

/// What parts a model from the file that it names. It is no part of any text in UTF-8.
const END_OF_MODEL: u8 = 0xff;

/// A model and the bytes of the files that it names. Of the kinds that are text they follow the first 0xff, as in the seeds; without one, and of
/// the other kinds, they are the bytes of the model itself.
fn parts<'a>(kind: &str, bytes: &'a [u8]) -> (&'a [u8], &'a [u8]) {
    let end = bytes.iter().position(|byte| *byte == END_OF_MODEL).filter(|_| !matches!(kind, "glb" | "ply"));
    end.map_or((bytes, bytes), |end| (&bytes[..end], &bytes[end + 1..]))
}

/// Imports a model of a kind from arbitrary bytes. Files that it names are arbitrary bytes too, but for those named .png, so that what is made of
/// images is met.
pub fn import(kind: &str, bytes: &[u8]) {
    let (bytes, named) = parts(kind, bytes);
    let near = |name: &str| Ok(if name.ends_with(".png") { PNG } else { named }.to_vec());
    // As it stands, and, of what can move, as it moves.
    let moment = Moment { animation: None, opens_s: 0.25, shutter_s: 0.5 };
    let moves = matches!(kind, "gltf" | "glb");
    for moment in [None].into_iter().chain(moves.then_some(Some(moment))) {
        let options = Options { moment, ..Options::default() };
        if let Ok(imported) = import_bytes_with(kind, bytes, &near, "files/", "model", &options) {
            // It may be no right scene, but saying so must not fail.
            let _ = imported.parse("scene.json", None);
        }
    }
}
