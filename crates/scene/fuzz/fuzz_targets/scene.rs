//! Arbitrary bytes as a scene.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(text) = std::str::from_utf8(bytes) {
        let _ = etalon_scene::parse(text, "scene.json");
    }
});
