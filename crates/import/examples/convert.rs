//! Makes a scene of a model and says what was left out:
//! `cargo run --release -p etalon-import --example convert -- model.glb folder`

#![allow(clippy::print_stdout)]

use std::path::Path;

use etalon_import::{Options, import};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(model), Some(folder)) = (arguments.next(), arguments.next()) else {
        return Err("usage: convert MODEL FOLDER".into());
    };
    let imported = import(Path::new(&model), "", &Options::default())?;

    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    std::fs::write(folder.join("scene.json"), &imported.text)?;
    for file in &imported.files {
        std::fs::write(folder.join(&file.name), &file.bytes)?;
    }
    // The same text and files, read in memory.
    let loaded = imported.parse("scene.json", None).map_err(|errors| errors.summary())?;
    println!("{}: {} objects, {} lights", model, loaded.scene.objects.len(), loaded.scene.lights.len());
    println!("{} files beside scene.json", imported.files.len());
    for added in &imported.added {
        println!("added: {added}");
    }
    for left_out in &imported.left_out {
        println!("left out at {}: {}", left_out.place, left_out.what);
    }
    Ok(())
}
