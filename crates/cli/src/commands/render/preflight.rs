//! Whether the picture fits into memory, and its files on their disks: asked before the work.

use etalon::{Channels, Subject};
use etalon_scene::Scene;
use etalon_transport::Film;
use miette::{Report, Severity, miette};

use crate::failure::Failure;
use crate::machine_limits::{address_space_left, bytes, memory_available, room_for};
use crate::output::{Format, Output};

/// Bytes a pixel that writing a picture takes beside the film: seven channels, and their encoded form.
const OF_PICTURE: u64 = 2 * 7 * 4;

/// The same for a band: three channels.
const OF_BAND: u64 = 2 * 3 * 4;

/// Address space that a thread may reserve and never use: its stack, and twice the 64 MiB heap that the C library gives it. Where this
/// is not to be had the threads share a heap, so that a small picture needs less.
const OF_THREAD: u64 = 130 << 20;

/// Refuses a picture that memory cannot hold. `stokes` counts Stokes parameters in, `threads` is the number of threads.
pub(super) fn check_memory(scene: &Scene, stokes: bool, threads: usize, failure: &mut Failure) {
    let (width, height) = (scene.film.width, scene.film.height);
    // Where one lane stands for all wavelengths it is less; that is known after the scene is prepared.
    let bands = scene.film.bands.map_or(0, |bands| bands.count * if stokes { 4 } else { 1 });
    let film = Film::bytes(width, height, scene.integrator.replicates, bands);
    let stokes = if stokes { Film::stokes_bytes(width, height, scene.integrator.replicates) } else { 0 };
    let picture = (OF_PICTURE + u64::from(bands) * OF_BAND) * u64::from(width) * u64::from(height);
    let needed = film + stokes + picture;
    let threads = threads.max(std::thread::available_parallelism().map_or(1, usize::from)) as u64;
    let reserved = (threads * OF_THREAD).min(4 * needed);
    let available =
        memory_available().into_iter().chain(address_space_left().map(|left| left.saturating_sub(reserved))).min();
    if let Some(available) = available.filter(|&available| needed > available) {
        failure.add(Failure::input(miette!(
            code = "too-large",
            help =
                "make it smaller, keep fewer bands or replicates, use fewer threads, or raise the limits (`ulimit -v`)",
            "a picture of {width} × {height} pixels with {} replicates takes {} of memory, and {} are free",
            scene.integrator.replicates,
            bytes(needed),
            bytes(available)
        )));
    }
}

/// Refuses files whose size is known and for which there is no room; warns of those that are compressed and may not fit.
pub(super) fn check_disks(
    checkpoint: bool,
    subject: &Subject,
    channels: &Channels,
    outputs: &[Output],
    failure: &mut Failure,
    warnings: &mut Vec<Report>,
) {
    let pixels = subject.crop.area();
    let stokes = if subject.records_stokes() { 72 } else { 0 };
    let sums = pixels * u64::from(subject.replicates) * (28 + stokes + 12 * u64::from(subject.band_sums()));
    let bands = subject.bands.as_ref().map_or(0, |bands| u64::from(bands.count));
    let channels = channels.count(bands, u64::from(subject.stokes_parameters()));
    for (number, output) in outputs.iter().enumerate() {
        let Some(room) = room_for(&output.path) else { continue };
        // While a checkpoint is written, the last one is still there.
        let certain =
            if output.format == Format::Part { sums } else { 0 } + if checkpoint && number == 0 { 2 * sums } else { 0 };
        let perhaps = match output.format {
            Format::Part => 0,
            Format::Exr => pixels * channels * 4,
            Format::Png => pixels * 3,
        };
        let folder = output.path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.map_or_else(|| ".".to_owned(), |folder| folder.display().to_string());
        if certain > room {
            failure.add(Failure::run(miette!(
                code = "disk-full",
                "`{}` and its checkpoints take {}, and `{folder}` has room for {}",
                output.path.display(),
                bytes(certain),
                bytes(room)
            )));
        } else if certain + perhaps > room {
            warnings.push(miette!(
                severity = Severity::Warning,
                code = "disk-nearly-full",
                "`{}` may take up to {} before it is compressed, and `{folder}` has room for {}",
                output.path.display(),
                bytes(certain + perhaps),
                bytes(room)
            ));
        }
    }
}
