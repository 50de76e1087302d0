//! Arbitrary bytes as glTF, binary where they begin as such files do.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let kind = if bytes.starts_with(b"glTF") { "glb" } else { "gltf" };
    etalon_import_fuzz::import(kind, bytes);
});
