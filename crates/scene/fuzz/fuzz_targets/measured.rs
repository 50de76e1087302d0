//! Arbitrary bytes as a measured BRDF.
#![no_main]

use etalon_scene::NamedFile;
use libfuzzer_sys::fuzz_target;

const SCENE: &str = r#"{
    "etalon": 1,
    "camera": { "type": "perspective", "position_m": [0, 0, 5], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40 },
    "film": { "width": 8, "height": 8 },
    "objects": [{ "shape": { "type": "sphere", "radius_m": 1 }, "material": { "type": "measured", "file": "a.bsdf" } }],
    "lights": [{ "type": "environment", "radiance": 1 }]
}"#;

fuzz_target!(|bytes: &[u8]| {
    let file = NamedFile { name: "a.bsdf".to_owned(), bytes: bytes.to_vec() };
    let _ = etalon_scene::parse_with_files(SCENE, "scene.json", &[file], None);
});
