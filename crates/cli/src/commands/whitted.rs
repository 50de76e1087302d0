//! `etalon whitted`: any file in the assignment's JSON form, rendered as the assignment prescribes.

mod format;

use std::num::NonZero;
use std::path::PathBuf;
use std::time::Instant;

use etalon_picture::{Rgb8, check_writable, write_png};
use etalon_whitted::{Published, RefractionRule, Scene, Settings, render_with};
use miette::{Report, miette};
use serde::Serialize;

use crate::args::Size;
use crate::failure::{Failure, Outcome};
use crate::print;
use crate::problem_json::{ProblemJson, problem_json, problems_json};
use crate::progress::SampleBar;
use crate::scene_report::{scene_failure, scene_warnings};

/// Render a scene in the JSON form of a course assignment (Whitted ray tracing).
///
/// The form has spheres, parallelograms, and perspective and orthographic cameras. The defaults are those of the published figures.
#[derive(clap::Args)]
#[command(after_help = "Example:
  etalon whitted assignment.json -o picture.png")]
pub(crate) struct WhittedArgs {
    /// Scene in the JSON form of the assignment.
    scene: PathBuf,
    /// PNG file to write.
    #[arg(short, long, alias = "outfile", value_name = "FILE.png")]
    output: PathBuf,
    /// Start of each shadow ray, as a fraction of the distance to the light. 0 shows shadow acne.
    #[arg(long, value_name = "E", default_value_t = 0.001, value_parser = not_negative)]
    epsilon: f64,
    /// Camera rays per pixel.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    rays: u32,
    /// Half the side of the square lens, in the units of the scene. Default: what the scene says.
    #[arg(long, value_name = "R", value_parser = not_negative)]
    lens_radius: Option<f64>,
    /// Maximum number of surfaces on the way of a mirror or refraction ray.
    #[arg(long, value_name = "N", default_value_t = 10)]
    max_bounce: u32,
    /// Width and height of the picture in pixels.
    #[arg(long, value_name = "WxH", default_value = "640x480")]
    size: Size,
    /// Formula of refracted directions.
    #[arg(long, value_enum, default_value_t = Refraction::Published)]
    refraction: Refraction,
    /// Print one JSON object on standard output. Shows no progress.
    #[arg(long)]
    json: bool,
    /// Print only warnings and errors.
    #[arg(short, long)]
    quiet: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Refraction {
    /// Equation (1) of the assignment, as published.
    Published,
    /// Snell's law.
    Snell,
}

/// What `--json` prints about a render.
#[derive(Serialize)]
struct WhittedJson {
    scene: String,
    output: Option<String>,
    width: u32,
    height: u32,
    rays: u32,
    seconds: f64,
    nonfinite: usize,
    warnings: Vec<ProblemJson>,
    errors: Vec<ProblemJson>,
}

/// What `--json` prints when there is no render to speak of.
#[derive(Serialize)]
struct RefusedJson {
    scene: String,
    errors: Vec<ProblemJson>,
}

fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        Ok(_) => Err("the value must be 0 or more, and finite".to_owned()),
        Err(error) => Err(error.to_string()),
    }
}

pub(crate) fn run(args: WhittedArgs) -> Outcome {
    let name = args.scene.display().to_string();
    match set_up(&args) {
        Ok((scene, warnings)) => render_and_write(&args, &name, &scene, warnings),
        Err(failure) => {
            if args.json {
                print::json(&RefusedJson { scene: name, errors: problems_json(&failure) });
            }
            Err(failure)
        }
    }
}

/// Does all that can fail before the work, and collects all that is wrong.
fn set_up(args: &WhittedArgs) -> Result<(Scene, Vec<Report>), Failure> {
    let mut failure = Failure::default();
    let is_png = args.output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
    if !is_png {
        failure.add(Failure::input(miette!(
            code = "output-format",
            help = "the assignment's pictures are 8-bit: name it .png",
            "`{}` is not a kind of picture that can be written",
            args.output.display()
        )));
    } else if let Err(error) = check_writable(&args.output) {
        failure.add(Failure::run(Report::from_err(error)));
    }
    let scene = load(args);
    match scene {
        Ok(scene) => failure.into_outcome().map(|()| scene),
        Err(scene) => {
            failure.add(scene);
            Err(failure)
        }
    }
}

fn load(args: &WhittedArgs) -> Result<(Scene, Vec<Report>), Failure> {
    let name = args.scene.display().to_string();
    let unreadable =
        |error: Report| Failure::input(error.wrap_err(format!("cannot read the scene `{}`", args.scene.display())));
    let bytes = etalon_picture::read_plain(&args.scene).map_err(|error| unreadable(Report::from_err(error)))?;
    let text = String::from_utf8(bytes).map_err(|error| unreadable(Report::from_err(error.utf8_error())))?;
    let (mut scene, warnings) = format::parse(&text, &name).map_err(scene_failure)?;
    if let Some(lens_radius) = args.lens_radius {
        scene.camera.lens_radius = lens_radius;
    }
    Ok((scene, scene_warnings(&name, &text, warnings)))
}

fn render_and_write(args: &WhittedArgs, name: &str, scene: &Scene, mut warnings: Vec<Report>) -> Outcome {
    let at_least_one = |n: u32| NonZero::new(n).unwrap_or(NonZero::<u32>::MIN);
    let settings = Settings {
        width: at_least_one(args.size.width),
        height: at_least_one(args.size.height),
        rays: at_least_one(args.rays),
        shadow_epsilon: args.epsilon,
        max_bounce: args.max_bounce,
        refraction: match args.refraction {
            Refraction::Published => RefractionRule::AsPublished,
            Refraction::Snell => RefractionRule::Snell,
        },
    };
    let (width, height) = (args.size.width, args.size.height);
    let rays = u64::from(width) * u64::from(height) * u64::from(args.rays);
    let bar = SampleBar::new(rays, args.quiet || args.json);
    let start = Instant::now();
    let film = render_with::<Published>(scene, &settings, |rays| bar.advance(rays));
    let seconds = start.elapsed().as_secs_f64();
    bar.clear();

    let nonfinite = film.non_finite();
    if nonfinite > 0 {
        warnings.push(miette!(
            severity = miette::Severity::Warning,
            code = "nonfinite",
            help = "causes are a light exactly on a surface, and lengths too large to be squared",
            "{nonfinite} pixels are not finite; the picture shows them black or white"
        ));
    }
    print::warnings(&warnings);
    let image = Rgb8 { width: film.width as usize, height: film.height as usize, pixels: film.to_rgb8() };
    let written = write_png(&args.output, &image, &[("Software", "etalon")]);
    let mut failure = Failure::default();
    let output = args.output.display().to_string();
    let output = match written {
        Ok(()) => Some(output),
        Err(error) => {
            failure.add(Failure::run(Report::from_err(error)));
            None
        }
    };
    if args.json {
        print::json(&WhittedJson {
            scene: name.to_owned(),
            output,
            width,
            height,
            rays: args.rays,
            seconds,
            nonfinite,
            warnings: warnings.iter().map(problem_json).collect(),
            errors: problems_json(&failure),
        });
    } else if !args.quiet && output.is_some() {
        print::line(&format!("{width} × {height} pixels, {} rays each, in {seconds:.2} s", args.rays));
    }
    failure.into_outcome()
}
