//! The files a render is written to.

use std::path::{Path, PathBuf};

use etalon_picture::develop::Tone;
use etalon_picture::{ExrFile, PictureError, RenderInfo, check_writable, read_exr, write_exr};
use miette::{Report, miette};
use serde::Serialize;

use crate::developing::{Developing, warn_not_finite};
use crate::failure::Failure;
use crate::load::is_standard_input;

/// What a file name's extension asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Format {
    /// Everything, as 32-bit floats.
    Exr,
    /// What a screen shows, in 8 bits.
    Png,
    /// Every sum with every bit, for `etalon merge`.
    Part,
}

impl Format {
    /// The format that a name asks for.
    pub(crate) fn of(path: &Path) -> Result<Self, Failure> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("exr") => Ok(Self::Exr),
            Some("png") => Ok(Self::Png),
            Some("part") => Ok(Self::Part),
            _ => Err(Failure::input(miette!(
                code = "output-format",
                help = "name it .exr for the linear picture with all its data, .png for 8-bit sRGB, .part for `etalon merge`",
                "`{}` is not a kind of picture that can be written",
                path.display()
            ))),
        }
    }
}

/// A file to be written.
#[derive(Clone, Debug)]
pub(crate) struct Output {
    /// Its name.
    pub path: PathBuf,
    /// What to write.
    pub format: Format,
}

/// A file that was written, for the report.
#[derive(Debug, Serialize)]
pub(crate) struct Written {
    /// Its name.
    pub path: String,
    /// What it is.
    pub format: Format,
    /// Pixels that the format could not hold as they are; `null` for a format that holds everything.
    pub clipped_pixels: Option<usize>,
    /// What became of the values, in words.
    #[serde(skip)]
    pub description: Option<String>,
}

impl Written {
    /// A file that holds everything.
    pub(crate) fn whole(output: &Output) -> Self {
        let path = output.path.display().to_string();
        Self { path, format: output.format, clipped_pixels: None, description: None }
    }

    /// Whether it is this output.
    pub(crate) fn is(&self, output: &Output) -> bool {
        self.path == output.path.display().to_string()
    }
}

/// The picture of a scene that no output was named for, in the folder where the program runs.
pub(crate) fn of_scene(scene: &Path) -> PathBuf {
    let name = scene.file_stem().filter(|_| !is_standard_input(scene)).unwrap_or_else(|| "scene".as_ref());
    let mut name = name.to_owned();
    name.push(".exr");
    PathBuf::from(name)
}

/// Refuses to replace what is no picture of this program.
pub(crate) fn check_own(path: &Path) -> Result<(), Failure> {
    // A name that is taken in any way, also by a link that leads nowhere.
    if path.symlink_metadata().is_err() {
        return Ok(());
    }
    let software = read_exr(path).ok().and_then(|file| RenderInfo::from_attributes(&file.attributes));
    if software.is_some_and(|info| info.software.starts_with("etalon ")) {
        return Ok(());
    }
    Err(Failure::run(miette!(
        code = "output-exists",
        help = format!("name the picture: -o FILE, with `-o {}` to replace the file", path.display()),
        "the picture would be `{}`, which exists and is not a picture of Etalon",
        path.display()
    )))
}

/// Refuses outputs that would take the place of what the scene is read from: its own file, and those that it names.
pub(crate) fn check_inputs(outputs: &[Output], scene: &Path, files: &[String], failure: &mut Failure) {
    let folder = if is_standard_input(scene) { Path::new("") } else { scene.parent().unwrap_or(Path::new("")) };
    let inputs = files.iter().map(|name| folder.join(name)).chain([scene.to_owned()]);
    let inputs: Vec<PathBuf> = inputs.filter_map(|path| path.canonicalize().ok()).collect();
    for output in outputs {
        if output.path.canonicalize().is_ok_and(|path| inputs.contains(&path)) {
            failure.add(Failure::input(miette!(
                code = "output-is-input",
                help = "name another file",
                "the scene is read from `{}`, which the output would replace",
                output.path.display()
            )));
        }
    }
}

/// Understands the names of the outputs, and finds out whether they can be written, before anything is computed.
/// Everything that is wrong with any of them goes into `failure`.
pub(crate) fn plan(paths: &[PathBuf], failure: &mut Failure) -> Vec<Output> {
    let mut outputs: Vec<Output> = Vec::new();
    for path in paths {
        let format = match Format::of(path) {
            Ok(format) => format,
            Err(unknown) => {
                failure.add(unknown);
                continue;
            }
        };
        if outputs.iter().any(|output| output.path == *path) {
            failure.add(Failure::input(miette!(
                code = "output-twice",
                "`{}` is given as output twice",
                path.display()
            )));
            continue;
        }
        if let Err(error) = check_writable(path) {
            failure.add(Failure::run(Report::from_err(error)));
        }
        outputs.push(Output { path: path.clone(), format });
    }
    outputs
}

/// Writes a picture and what is said about it to one output.
pub(crate) fn write(output: &Output, file: &ExrFile, developing: &Developing) -> Result<Written, Failure> {
    let path = output.path.as_path();
    let failed = |error| Failure::run(Report::from_err(error));
    let mut written = Written::whole(output);
    match output.format {
        Format::Exr => write_exr(path, &file.picture, &file.attributes).map_err(failed)?,
        Format::Png => {
            let developed = developing.write(path, file, None).map_err(|error| match error {
                PictureError::Develop { why } => {
                    Failure::run(miette!(code = "develop", "cannot make `{}`: {why}", path.display()))
                }
                other => failed(other),
            })?;
            crate::print::warnings(&warn_not_finite(path, &developed));
            written.description = Some(developing.describe(&developed));
            if let Tone::Picture { clipping, .. } = developed.tone {
                written.clipped_pixels = Some(clipping.any);
            }
        }
        Format::Part => unreachable!("parts are written from the canvas"),
    }
    Ok(written)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use etalon_picture::{Attributes, Picture};

    /// The options when none is given.
    fn plain() -> Developing {
        #[derive(Parser)]
        struct Options {
            #[command(flatten)]
            developing: Developing,
        }
        Options::parse_from(["etalon"]).developing
    }

    fn file(pixels: &[[f32; 3]]) -> ExrFile {
        ExrFile { picture: Picture::from_rgb(pixels.len(), 1, pixels).unwrap(), attributes: Attributes::new() }
    }

    #[test]
    fn a_folder_that_goes_away_during_the_render_is_an_error_that_names_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let gone = folder.path().join("gone");
        std::fs::create_dir(&gone).unwrap();
        let mut failure = Failure::default();
        let outputs = plan(&[gone.join("a.exr"), gone.join("a.png")], &mut failure);
        assert!(failure.into_outcome().is_ok());
        std::fs::remove_dir(&gone).unwrap();
        let file = file(&[[0.5; 3]]);
        for output in &outputs {
            let failure = write(output, &file, &plain()).map(drop).unwrap_err();
            let json = serde_json::to_value(crate::problem_json::problems_json(&failure)).unwrap();
            let message = json[0]["message"].as_str().unwrap();
            assert!(message.contains(&output.path.display().to_string()), "{message}");
        }
    }

    #[test]
    fn every_kind_of_clipped_pixel_counts_once() {
        let folder = tempfile::tempdir().unwrap();
        let outputs = plan(&[folder.path().join("a.png"), folder.path().join("a.exr")], &mut Failure::default());
        let pixels = [[0.5_f32; 3], [9.0, 9.0, 0.0], [-9.0, 0.5, 0.5], [9.0, -9.0, 0.0], [f32::NAN, 0.0, 0.0]];
        let file = file(&pixels);
        let clipped = outputs
            .iter()
            .map(|output| write(output, &file, &plain()).unwrap_or_else(|_| panic!("writable")).clipped_pixels);
        assert_eq!(clipped.collect::<Vec<_>>(), [Some(4), None]);
    }
}
