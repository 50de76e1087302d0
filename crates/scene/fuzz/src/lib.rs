//! What the targets share: a model is imported and, if that succeeds, read as the scene that it became.

use etalon_scene::import::import_bytes;

/// Imports a model of a kind from arbitrary bytes. Files that it names hold the bytes themselves, so that what reads them meets
/// arbitrary bytes too.
pub fn import(kind: &str, bytes: &[u8]) {
    let near = |_: &str| Ok(bytes.to_vec());
    if let Ok(imported) = import_bytes(kind, bytes, &near, "files/", "model") {
        // It may be no right scene, but saying so must not fail.
        let _ = etalon_scene::parse_imported(&imported, "scene.json", None);
    }
}
