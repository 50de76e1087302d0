//! `etalon import`: a model of another program in, a scene to edit out.

use std::path::{Path, PathBuf};

use etalon_picture::write_atomically;
use miette::{Report, miette};
use serde::Serialize;

use crate::failure::{Failure, Outcome};
use crate::load::{import_model, refused_scene};
use crate::print;

/// Turns a model (glTF 2.0, OBJ with MTL, PLY) or a scene of Mitsuba 3 or pbrt-v4 into a scene to edit.
///
/// Meshes are written as PLY files and images copied into a folder beside the scene, named after it. What the model says
/// and the scene cannot is listed, each thing with its place.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The model: .glb, .gltf, .obj, .ply, .xml (Mitsuba) or .pbrt.
    model: PathBuf,
    /// The scene to write.
    #[arg(short, long, value_name = "SCENE.json")]
    output: PathBuf,
    /// Print one JSON object on standard output about what was written and what was left out.
    #[arg(long)]
    json: bool,
}

/// What `--json` prints.
#[derive(Serialize)]
struct ReportJson {
    scene: String,
    files: Vec<String>,
    added: Vec<String>,
    left_out: Vec<LeftOutJson>,
}

#[derive(Serialize)]
struct LeftOutJson {
    place: String,
    what: String,
}

pub(crate) fn run(args: Args) -> Outcome {
    let stem = args.output.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    if args.output.extension().is_none_or(|e| !e.eq_ignore_ascii_case("json")) || stem.is_empty() {
        return Err(Failure::input(miette!(code = "output-format", "`{}` is not named .json", args.output.display())));
    }
    let prefix = format!("{stem}-files/");
    let imported = import_model(&args.model, &prefix)?;
    // What would not load is not written.
    let name = args.output.display().to_string();
    etalon_scene::parse_imported(&imported, &name, None).map_err(refused_scene)?;

    let folder = args.output.parent().unwrap_or(Path::new(""));
    let failed = |path: &Path, error: std::io::Error| {
        Failure::run(Report::from_err(error).wrap_err(format!("cannot write `{}`", path.display())))
    };
    if !imported.files.is_empty() {
        let files = folder.join(format!("{stem}-files"));
        std::fs::create_dir_all(&files).map_err(|error| failed(&files, error))?;
    }
    for file in &imported.files {
        let path = folder.join(&file.name);
        write_atomically(&path, |out| out.write_all(&file.bytes)).map_err(|e| Failure::run(Report::from_err(e)))?;
    }
    // The scene last: it never names files that are not there.
    write_atomically(&args.output, |out| out.write_all(imported.text.as_bytes()))
        .map_err(|e| Failure::run(Report::from_err(e)))?;

    if args.json {
        print::json(&ReportJson {
            scene: name,
            files: imported.files.iter().map(|file| file.name.clone()).collect(),
            added: imported.added.clone(),
            left_out: imported
                .left_out
                .iter()
                .map(|l| LeftOutJson { place: l.place.clone(), what: l.what.clone() })
                .collect(),
        });
        return Ok(());
    }
    print::line(&format!("{name}: {} files beside it in {prefix}", imported.files.len()));
    imported.added.iter().for_each(|added| print::line(&format!("  added: {added}")));
    for left_out in &imported.left_out {
        print::line(&format!("  not honoured: {}: {}", left_out.place, left_out.what));
    }
    Ok(())
}
