//! `etalon view`: a page in the browser that shows a render while its error falls.

use std::io::ErrorKind;
use std::net::{IpAddr, Ipv4Addr};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use etalon_picture::read_exr;
use etalon_scene::{Film, Scene};
use etalon_transport::Film as Sums;
use etalon_view::{LoadedScene, SceneSource, Source, Token, ViewError, Viewer};
use miette::{Report, miette};
use serde_json::Value;

use crate::failure::{Failure, Outcome};
use crate::load::{is_standard_input, load};
use crate::machine_limits::{bytes, memory_available};
use crate::overrides::Overrides;
use crate::print;
use crate::problem_json::problems_json;

/// Films at once: the one that is rendered, one that waits to be shown, and one that is being shown.
const FILMS: u64 = 3;
/// Pictures at once: the one that is shown, the one before, and a pinned one.
const PICTURES: u64 = 3;
/// Bytes of a pixel of a picture: colour, errors, samples, luminance; and of a band of it.
const OF_PIXEL: u64 = 9 * 4;
/// See [`OF_PIXEL`].
const OF_BAND: u64 = 3 * 4;

/// Show a scene in the browser while it is rendered, or a picture from a file.
///
/// The command prints the address of a page. The page shows the picture, its relative error against time, when each accuracy is predicted
/// to be reached, the error of every pixel, the spectrum under the cursor, and the paths of a pixel. The camera moves with the mouse. An
/// edit of the scene file is taken over at once.
///
/// The address holds a random token. Who does not know it gets nothing. The server listens at 127.0.0.1, so only programs on this machine
/// reach it. From another machine, use SSH: `ssh -L 8420:127.0.0.1:8420 HOST etalon view SCENE --port 8420`.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  etalon view scenes/cornell.json --open
  etalon view scenes/vase.json --error 2% --port 8420
  etalon view cornell.exr")]
pub(crate) struct ViewArgs {
    /// Scene as JSON, a model (see `etalon render`), or a picture (.exr) of Etalon or of another program.
    input: PathBuf,
    /// Port of the server. Default: one that is free.
    #[arg(long, value_name = "PORT", default_value_t = 0, hide_default_value = true)]
    port: u16,
    /// Open the page in the browser.
    #[arg(long)]
    open: bool,
    /// Relative error at which the picture is good enough, such as 2%. The page can change it.
    #[arg(long, value_name = "PERCENT", value_parser = crate::args::percentage, default_value = "1%")]
    error: f64,
    /// Number of threads. Default: all cores. It does not change the picture.
    #[arg(long, alias = "nthreads", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
    /// Address of this machine to listen at, such as 0.0.0.0 for all. It needs --token, because whoever reaches this address and knows the
    /// token can see the picture and move its camera. Nothing is encrypted.
    #[arg(long, value_name = "ADDRESS", default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST), hide_default_value = true)]
    bind: IpAddr,
    /// Token in the address: 16 characters at least, or `random`. Default: random.
    #[arg(long, value_name = "TOKEN")]
    token: Option<String>,
    #[command(flatten)]
    overrides: Overrides,
}

pub(crate) fn run(args: ViewArgs) -> Outcome {
    let token = token(&args)?;
    let (ip, port, is_opened) = (args.bind, args.port, args.open);
    let source = source(args)?;
    let viewer = Viewer::bind(source, ip, port, token).map_err(|error| not_started(error, port))?;
    print::line(viewer.address());
    print::note(&match ip.is_loopback() {
        true => "Open this address in a browser. It works on this machine only. Press Ctrl-C to end.".to_owned(),
        false => format!(
            "{}Whoever reaches {ip} and knows this address can see the picture and move its camera. Nothing is encrypted. Press \
             Ctrl-C to end.",
            elsewhere(ip)
        ),
    });
    if is_opened && let Err(why) = open(viewer.address()) {
        print::note(&format!("No browser could be opened: {why}. Open the address by hand."));
    }
    viewer.run().map_err(|error| Failure::run(Report::from_err(error)))
}

/// How another machine opens the page, where the printed address is that of this machine alone.
fn elsewhere(ip: IpAddr) -> &'static str {
    match ip.is_unspecified() {
        true => {
            "This address is for this machine. On another one, write an IP address of this machine in its place; host names are \
             refused. "
        }
        false => "",
    }
}

/// The token, which an address that others reach must be given on purpose.
fn token(args: &ViewArgs) -> Result<Token, Failure> {
    match args.token.as_deref() {
        None if !args.bind.is_loopback() => Err(Failure::input(miette!(
            code = "bind-without-token",
            help = "add `--token random`, or a token of your own; or leave out --bind and use SSH (see `etalon view --help`)",
            "other machines reach {}: whoever knows the token can see the picture and move its camera, and nothing is encrypted",
            args.bind
        ))),
        None | Some("random") => Token::random().map_err(|why| Failure::run(miette!("{why}"))),
        Some(text) => Token::new(text).map_err(|why| Failure::input(miette!(code = "token", "{why}"))),
    }
}

fn source(args: ViewArgs) -> Result<Source, Failure> {
    let path = args.input.clone();
    let name = path.display().to_string();
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr")) {
        let file = read_exr(&path).map_err(|error| Failure::input(Report::from_err(error)))?;
        return Ok(Source::Picture { name, file: Box::new(file) });
    }
    if is_standard_input(&path) {
        return Err(Failure::input(miette!(
            code = "view-file",
            "`etalon view` reads the scene again after each edit, so it needs a file"
        )));
    }
    let study = args.overrides.study();
    let (error, threads) = (args.error, args.threads.map(|threads| threads as usize));
    let read = move || load_scene(&path, &args.overrides);
    let first = read()?;
    let load = Box::new(move || read().map_err(|failure| problems(&failure)));
    Ok(Source::Scene(Box::new(SceneSource { name, first, load, study, error, threads })))
}

/// A scene, and the files that it was read from.
fn load_scene(path: &Path, overrides: &Overrides) -> Result<LoadedScene, Failure> {
    let began = SystemTime::now();
    let mut loaded = load(path, overrides.film_size(), overrides.parameters())?;
    overrides.apply(&mut loaded.scene)?;
    check_memory(&loaded.scene)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let files = std::iter::once(path.to_owned()).chain(loaded.files.iter().map(|name| folder.join(name))).collect();
    let warnings = loaded.warnings.iter().map(ToString::to_string).collect();
    Ok(LoadedScene { scene: loaded.scene, sha256: loaded.sha256, warnings, files, began })
}

/// Refuses a picture that memory cannot hold, also where an edit makes it so large.
fn check_memory(scene: &Scene) -> Outcome {
    let &Film { width, height, ref bands, stokes, .. } = &scene.film;
    let (replicates, bands) =
        (scene.integrator.replicates, bands.map_or(0, |bands| bands.count * if stokes { 4 } else { 1 }));
    let stokes = if stokes { Sums::stokes_bytes(width, height, replicates) } else { 0 };
    let pixels = u64::from(width) * u64::from(height);
    let pictures = PICTURES * pixels * (OF_PIXEL + u64::from(bands) * OF_BAND);
    let needed = FILMS * (Sums::bytes(width, height, replicates, bands) + stokes) + pictures;
    match memory_available() {
        Some(available) if needed > available => Err(Failure::input(miette!(
            code = "too-large",
            help = "make it smaller with --size, or keep fewer bands or replicates",
            "to view a picture of {width} × {height} pixels takes {} of memory, and {} are free",
            bytes(needed),
            bytes(available)
        ))),
        _ => Ok(()),
    }
}

fn problems(failure: &Failure) -> Vec<Value> {
    problems_json(failure)
        .iter()
        .map(|problem| serde_json::to_value(problem).expect("a problem is plain data"))
        .collect()
}

fn not_started(error: ViewError, port: u16) -> Failure {
    match &error {
        ViewError::Bind { source, .. } if source.kind() == ErrorKind::AddrInUse => {
            Failure::run(miette!(code = "port", help = "leave out --port to take a free one", "port {port} is taken"))
        }
        ViewError::Picture(_) => Failure::input(Report::from_err(error)),
        _ => Failure::run(Report::from_err(error)),
    }
}

/// Opens an address in the browser that the system prefers.
fn open(address: &str) -> Result<(), String> {
    let (program, before): (&str, &[&str]) = if cfg!(target_os = "macos") {
        ("open", &[])
    } else if cfg!(windows) {
        ("cmd", &["/C", "start", ""])
    } else {
        ("xdg-open", &[])
    };
    let mut command = std::process::Command::new(program);
    command.args(before).arg(address).stdout(std::process::Stdio::null()).stderr(std::process::Stdio::null());
    command.spawn().map(|_| ()).map_err(|error| format!("`{program}`: {error}"))
}
