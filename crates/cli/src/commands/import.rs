//! `etalon import`: a model of another program in, a scene to edit out.

use std::path::{Path, PathBuf};

use etalon_import::{LeftOut, Loss, Moment, Options};
use etalon_picture::write_atomically;
use miette::{Report, miette};
use serde::Serialize;

use crate::failure::{Failure, Outcome};
use crate::load::{import_model, refused_scene};
use crate::print;

/// Convert a model, or a scene of Mitsuba 3 or pbrt-v4, into a scene to edit.
///
/// Models are glTF 2.0, OBJ with MTL, and PLY. Meshes and images go into the folder SCENE-files beside the scene. A table says what was
/// taken over, what is approximated and what is left out, with the places in the model.
#[derive(clap::Args)]
#[command(after_help = "Example:
  etalon import model.glb -o model.json")]
pub(crate) struct ImportArgs {
    /// Model: .glb, .gltf, .obj, .ply, .xml (Mitsuba) or .pbrt.
    model: PathBuf,
    /// Scene to write.
    #[arg(short, long, value_name = "SCENE.json")]
    output: PathBuf,
    /// Time at which the shutter opens in an animation of glTF, such as 1.25s or 40ms. Default: no animation.
    #[arg(long, value_name = "TIME", value_parser = instant, allow_hyphen_values = true)]
    time: Option<f64>,
    /// How long the shutter stays open, such as 20ms. 0s shows an instant, without motion blur.
    #[arg(long, value_name = "TIME", value_parser = shutter, requires = "time", default_value = "0s")]
    shutter: f64,
    /// Name of the animation, or its index from 0. Default: the first.
    #[arg(long, value_name = "NAME", requires = "time")]
    animation: Option<String>,
    /// Name of the variant of a glTF model: another look of it (KHR_materials_variants). Default: the materials that its meshes name.
    #[arg(long, value_name = "NAME")]
    variant: Option<String>,
    /// Value of a parameter of a Mitsuba scene, in the place of its <default>. The option may be repeated.
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", value_parser = crate::args::parameter)]
    define: Vec<(String, String)>,
    /// Exit with status 1 if anything is approximated or left out. The scene is written all the same.
    #[arg(long)]
    strict: bool,
    /// Print one JSON object on standard output, with the files and what was taken over, approximated and left out.
    #[arg(long)]
    json: bool,
}

/// A point in time: `1.25s`, `40ms`, `2`. Seconds.
fn instant(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let (number, unit) = match (text.strip_suffix("ms"), text.strip_suffix('s')) {
        (Some(number), _) => (number, 1e-3),
        (None, Some(number)) => (number, 1.0),
        (None, None) => (text, 1.0),
    };
    match number.trim_end().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(unit * value),
        _ => Err("expected a time such as 1.25s or 40ms".to_owned()),
    }
}

/// A stretch of time, 0 or above. Seconds.
fn shutter(text: &str) -> Result<f64, String> {
    match instant(text)? {
        seconds if seconds >= 0.0 => Ok(seconds),
        _ => Err("the time must be 0 or more, such as 20ms".to_owned()),
    }
}

/// What `--json` prints.
#[derive(Serialize)]
struct ReportJson {
    scene: String,
    files: Vec<String>,
    added: Vec<String>,
    taken_over: TakenOverJson,
    approximated: Vec<LeftOutJson>,
    left_out: Vec<LeftOutJson>,
}

#[derive(Serialize)]
struct TakenOverJson {
    objects: usize,
    instances: usize,
    materials: usize,
    lights: usize,
    meshes: usize,
    images: usize,
}

#[derive(Serialize)]
struct LeftOutJson {
    place: String,
    what: String,
}

/// Most places that a line of the table names.
const MOST_PLACES: usize = 4;

/// A line for each thing that became the same of things of the model, with their places.
fn table(left_out: &[LeftOut], loss: Loss) -> Vec<String> {
    let mut things: Vec<(&str, Vec<&str>)> = Vec::new();
    for LeftOut { place, what, .. } in left_out.iter().filter(|l| l.loss == loss) {
        match things.iter_mut().find(|(known, _)| known == what) {
            Some((_, places)) => places.push(place),
            None => things.push((what, vec![place])),
        }
    }
    let words = |(what, places): (&str, Vec<&str>)| {
        let more = places.len().saturating_sub(MOST_PLACES);
        let named = places[..places.len() - more].join(", ");
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        format!("{named}{more}: {what}")
    };
    things.into_iter().map(words).collect()
}

pub(crate) fn run(args: ImportArgs) -> Outcome {
    let stem = args.output.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    if args.output.extension().is_none_or(|e| !e.eq_ignore_ascii_case("json")) || stem.is_empty() {
        return Err(Failure::input(miette!(
            code = "output-format",
            "`{}` does not end in .json",
            args.output.display()
        )));
    }
    let prefix = format!("{stem}-files/");
    let moment =
        args.time.map(|opens_s| Moment { animation: args.animation.clone(), opens_s, shutter_s: args.shutter });
    let options = Options { moment, parameters: args.define, variant: args.variant };
    let imported = import_model(&args.model, &prefix, &options)?;
    // What would not load is not written.
    let name = args.output.display().to_string();
    imported.parse(&name, None).map_err(refused_scene)?;

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

    let taken = &imported.taken_over;
    if args.json {
        let of = |loss: Loss| -> Vec<LeftOutJson> {
            let lost = imported.left_out.iter().filter(|l| l.loss == loss);
            lost.map(|l| LeftOutJson { place: l.place.clone(), what: l.what.clone() }).collect()
        };
        print::json(&ReportJson {
            scene: name,
            files: imported.files.iter().map(|file| file.name.clone()).collect(),
            added: imported.added.clone(),
            taken_over: TakenOverJson {
                objects: taken.objects,
                instances: taken.instances,
                materials: taken.materials,
                lights: taken.lights,
                meshes: taken.meshes,
                images: taken.images,
            },
            approximated: of(Loss::Approximated),
            left_out: of(Loss::LeftOut),
        });
    } else {
        print::line(&format!("{name}: {} files beside it in {prefix}", imported.files.len()));
        imported.added.iter().for_each(|added| print::line(&format!("  added: {added}")));
        print::line(&format!("  taken over: {}", taken.words().join(", ")));
        for (loss, title) in [(Loss::Approximated, "approximated"), (Loss::LeftOut, "left out")] {
            for line in table(&imported.left_out, loss) {
                print::line(&format!("  {title}: {line}"));
            }
        }
    }
    if args.strict && !imported.left_out.is_empty() {
        let of = |loss| imported.left_out.iter().filter(|l| l.loss == loss).count();
        return Err(Failure::run(miette!(
            code = "not-exact",
            "the scene is written, but it is not exact: approximated {}, left out {}",
            of(Loss::Approximated),
            of(Loss::LeftOut)
        )));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{instant, shutter, table};
    use etalon_import::{LeftOut, Loss};

    #[test]
    fn what_becomes_of_several_things_alike_is_one_line() {
        let of = |loss, place: u32, what: &str| LeftOut { loss, place: format!("line {place}"), what: what.to_owned() };
        let mut all: Vec<LeftOut> = (1..=6).map(|line| of(Loss::Approximated, line, "it becomes grey")).collect();
        all.push(of(Loss::LeftOut, 7, "hair is left out"));
        all.push(of(Loss::Approximated, 8, "it becomes round"));
        let read = table(&all, Loss::Approximated);
        assert_eq!(read, ["line 1, line 2, line 3, line 4 and 2 more: it becomes grey", "line 8: it becomes round"]);
        assert_eq!(table(&all, Loss::LeftOut), ["line 7: hair is left out"]);
    }

    #[test]
    fn times_are_read_as_they_are_written() {
        for (text, expected) in [("1.25s", 1.25), ("40ms", 0.04), ("2", 2.0), ("-0.5 s", -0.5), ("0s", 0.0)] {
            assert_eq!(instant(text), Ok(expected), "{text}");
        }
        for text in ["", "s", "ms", "1m", "nan", "1e999s", "1.2.3s"] {
            assert!(instant(text).is_err(), "{text}");
        }
        assert!(shutter("-1ms").is_err());
        assert_eq!(shutter("20ms"), Ok(0.02));
    }
}
