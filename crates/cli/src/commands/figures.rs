//! `etalon figures`: the published assignment figures, compared pixel for pixel.

mod animation;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use etalon_picture::{Rgb8, read_png8, write_atomically, write_png};
use etalon_whitted::{Figure, Settings, render};
use miette::{Report, miette};
use rayon::prelude::*;
use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::failure::{Failure, Outcome};
use crate::print;

/// Where the published files are looked for when nothing else is said.
const PUBLISHED: &str = "../shared/assignment/figures";
/// SHA-256 of the published files' decoded pixels.
const HASHES: &str = include_str!("../../../../reference/assignment/sha256.txt");
/// Name of the animation.
const ANIMATION: &str = "figure5_animation.gif";
/// How long the animation shows a frame.
const FRAME_TIME: Duration = Duration::from_millis(40);

/// Render the 16 published images and the animation of a course assignment, and count the pixels that differ.
///
/// The hashes of the published images are built in. If the files are available, every pixel is compared as well. The exit status is 1 if any
/// pixel differs.
#[derive(clap::Args)]
#[command(after_help = "Example:
  etalon figures -o figures")]
pub(crate) struct FiguresArgs {
    /// Folder for the images. It is created if it does not exist.
    #[arg(short, long, alias = "outfile", value_name = "DIR", default_value = "figures")]
    output: PathBuf,
    /// Folder with the published PNG files. Default: ../shared/assignment/figures, if it exists.
    #[arg(long, value_name = "DIR")]
    published: Option<PathBuf>,
    /// Print one JSON object on standard output instead of the table.
    #[arg(long)]
    json: bool,
}

/// What became of one image.
#[derive(Debug, Serialize)]
struct Row {
    name: &'static str,
    seconds: f64,
    equal: bool,
    /// `None`: the hash differs, and there was no file to count in.
    differing_pixels: Option<usize>,
}

/// What `--json` prints.
#[derive(Serialize)]
struct FiguresJson<'a> {
    output: String,
    /// The folder with the published files, if pixels were compared one by one.
    published: Option<String>,
    equal: usize,
    figures: &'a [Row],
    animation: String,
}

pub(crate) fn run(args: FiguresArgs) -> Outcome {
    let published = args.published.clone().or_else(|| Some(PathBuf::from(PUBLISHED)).filter(|path| path.is_dir()));
    std::fs::create_dir_all(&args.output).map_err(|error| {
        Failure::run(Report::from_err(error).wrap_err(format!("cannot create the folder `{}`", args.output.display())))
    })?;

    // Each image is one sequence of random numbers, so it is rendered by one thread; the images go to all of them.
    let done: Result<Vec<(Row, Rgb8)>, Failure> =
        Figure::ALL.par_iter().map(|figure| make(figure, &args.output, published.as_deref())).collect();
    let (rows, images): (Vec<Row>, Vec<Rgb8>) = done?.into_iter().unzip();

    let gif_path = args.output.join(ANIMATION);
    let gif = animation::encode(&images[4..], FRAME_TIME)
        .map_err(|error| Failure::run(Report::from_err(error).wrap_err("cannot make the animation")))?;
    write_atomically(&gif_path, |out| out.write_all(&gif)).map_err(|error| Failure::run(Report::from_err(error)))?;

    let equal = rows.iter().filter(|row| row.equal).count();
    if args.json {
        print::json(&FiguresJson {
            output: args.output.display().to_string(),
            published: published.map(|path| path.display().to_string()),
            equal,
            figures: &rows,
            animation: gif_path.display().to_string(),
        });
    } else {
        print::line(&table(&rows, published.as_deref()));
        print::line(&format!("{} PNG files and {ANIMATION} are in {}", rows.len(), args.output.display()));
    }
    if equal == rows.len() {
        return Ok(());
    }
    let different = rows.len() - equal;
    Err(Failure::run(miette!(
        code = "figures-differ",
        "{different} of {} images differ from the published ones",
        rows.len()
    )))
}

/// Renders, compares and writes one image.
fn make(figure: &Figure, output: &Path, published: Option<&Path>) -> Result<(Row, Rgb8), Failure> {
    let settings = Settings { shadow_epsilon: figure.shadow_epsilon, ..Settings::default() };
    let start = Instant::now();
    let film = render(&figure.scene(), &settings);
    let seconds = start.elapsed().as_secs_f64();
    let image = Rgb8 { width: film.width as usize, height: film.height as usize, pixels: film.to_rgb8() };
    write_png(&output.join(figure.name).with_extension("png"), &image, &[("Software", "etalon")])
        .map_err(|error| Failure::run(Report::from_err(error)))?;

    let differing_pixels = match published {
        Some(folder) => {
            let path = folder.join(figure.name).with_extension("png");
            let theirs = read_png8(&path).map_err(|error| Failure::input(Report::from_err(error)))?;
            Some(differing_pixels(&image, &theirs))
        }
        None => None,
    };
    let hash_equal = sha256(&image.pixels) == committed_hash(figure.name);
    if differing_pixels == Some(0) && !hash_equal {
        return Err(Failure::run(miette!(
            code = "figures-hash",
            "{}.png equals the published file, but neither has the built-in hash",
            figure.name
        )));
    }
    let equal = hash_equal && differing_pixels.unwrap_or(0) == 0;
    let differing_pixels = if equal { Some(0) } else { differing_pixels };
    Ok((Row { name: figure.name, seconds, equal, differing_pixels }, image))
}

/// Pixels of `ours` that `theirs` does not have as they are.
fn differing_pixels(ours: &Rgb8, theirs: &Rgb8) -> usize {
    if (ours.width, ours.height) != (theirs.width, theirs.height) {
        return ours.width * ours.height;
    }
    ours.pixels.chunks_exact(3).zip(theirs.pixels.chunks_exact(3)).filter(|(a, b)| a != b).count()
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

fn committed_hash(name: &str) -> &'static str {
    let entry = |line: &'static str| {
        let (hash, file) = line.split_once("  ")?;
        (file.strip_suffix(".png") == Some(name)).then_some(hash)
    };
    HASHES.lines().find_map(entry).expect("every figure has a hash, which a test asserts")
}

fn table(rows: &[Row], published: Option<&Path>) -> String {
    let mut text = String::from("image                       seconds  pixels that differ, of 307200\n");
    for row in rows {
        let differing = row.differing_pixels.map_or("some".to_owned(), |pixels| pixels.to_string());
        text += &format!("{:<27} {:>7.3}  {differing:>18}\n", row.name, row.seconds);
    }
    text += "compared by hash";
    match published {
        Some(folder) => text += &format!(", and pixel by pixel with the files in {}", folder.display()),
        None => text += &format!(" only: the published files are not in {PUBLISHED}"),
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_has_a_hash_and_every_hash_is_a_figures() {
        for figure in &Figure::ALL {
            assert_eq!(committed_hash(figure.name).len(), 64);
        }
        assert_eq!(HASHES.lines().count(), Figure::ALL.len());
    }

    #[test]
    fn one_wrong_pixel_is_found_and_so_is_another_size() {
        let image = Rgb8 { width: 2, height: 1, pixels: vec![1, 2, 3, 4, 5, 6] };
        assert_eq!(differing_pixels(&image, &image), 0);
        let other = Rgb8 { pixels: vec![1, 2, 3, 4, 5, 7], ..image.clone() };
        assert_eq!(differing_pixels(&image, &other), 1);
        let turned = Rgb8 { width: 1, height: 2, ..image.clone() };
        assert_eq!(differing_pixels(&image, &turned), 2);
    }

    #[test]
    fn a_published_file_that_differs_in_one_pixel_is_reported_with_the_count() {
        let folder = tempfile::tempdir().unwrap();
        let figure = &Figure::ALL[1];
        let (row, mut image) = make(figure, folder.path(), None).unwrap_or_else(|_| panic!("nothing to fail"));
        assert!(row.equal);
        assert_eq!(read_png8(&folder.path().join("figure2_shading_refraction.png")).unwrap(), image);

        let published = tempfile::tempdir().unwrap();
        image.pixels[3 * 1234] ^= 1;
        write_png(&published.path().join(figure.name).with_extension("png"), &image, &[]).unwrap();
        let (row, _) =
            make(figure, folder.path(), Some(published.path())).unwrap_or_else(|_| panic!("files are there"));
        assert!(!row.equal);
        assert_eq!(row.differing_pixels, Some(1));
        assert!(make(&Figure::ALL[0], folder.path(), Some(published.path())).is_err(), "a missing file is an error");
    }
}
