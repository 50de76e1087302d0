//! What several tests need.

pub(crate) mod chance;
pub(crate) mod rendering;

use std::path::Path;

use etalon_scene::Scene;

/// The ready-made scenes by name, at a size, pixels, and a number of samples that a test can afford.
pub(crate) fn ready_made(size: [u32; 2], spp: u32) -> Vec<(String, Scene)> {
    let scenes = scenes_of(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes"), size, spp);
    assert!(scenes.len() >= 11);
    scenes
}

/// The scenes of a folder, as [`ready_made`] gives them.
pub(crate) fn scenes_of(folder: &Path, size: [u32; 2], spp: u32) -> Vec<(String, Scene)> {
    let mut scenes: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "json"))
        .map(|path| {
            let text = etalon_scene::json::load_text(&path).unwrap();
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            let mut scene = etalon_scene::parse_in(&text, &name, path.parent(), Some(size)).unwrap().scene;
            scene.integrator.spp = spp;
            (name, scene)
        })
        .collect();
    scenes.sort_by(|a, b| a.0.cmp(&b.0));
    scenes
}
