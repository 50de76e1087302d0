//! Depth of field: time and error against the rays a pixel and the lens's radius, as a Markdown table.
//!
//! `cargo run --release -p etalon-whitted --example depth_of_field`, about two minutes on one core.

use std::io::Write;
use std::num::NonZero;
use std::time::Instant;

use etalon_whitted::{Figure, Film, Scene, Settings, render};

/// Rays a pixel of the pictures that stand for the truth.
const REFERENCE_RAYS: u32 = 2048;
/// Radii of the lens; the published one is 0.08.
const RADII: [f64; 4] = [0.0, 0.02, 0.08, 0.32];

fn main() -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    writeln!(
        out,
        "Figure 3 at 320 × 240, one thread.\n\n| rays a pixel | seconds | {} |",
        join(RADII, |r| format!("radius {r}"))
    )?;
    writeln!(out, "|---:|---:|{}", "---:|".repeat(RADII.len()))?;
    let references = RADII.map(|radius| timed(radius, REFERENCE_RAYS).0);
    for rays in [1, 2, 5, 10, 20, 50, 100, 200] {
        let films = RADII.map(|radius| timed(radius, rays));
        let seconds = films.iter().map(|film| film.1).sum::<f64>() / RADII.len() as f64;
        let errors: Vec<f64> = films.iter().zip(&references).map(|(film, truth)| rms_levels(&film.0, truth)).collect();
        writeln!(out, "| {rays} | {seconds:.3} | {} |", join(errors, |error| format!("{error:.2}")))?;
    }
    let mut least = [f64::INFINITY; RADII.len()];
    for _ in 0..10 {
        for (least, radius) in least.iter_mut().zip(RADII) {
            *least = least.min(timed(radius, 5).1);
        }
    }
    let least = join(RADII.iter().zip(least), |(radius, seconds)| format!("{radius}: {seconds:.4}"));
    writeln!(out, "\nSeconds for 5 rays a pixel by radius, least of 10 interleaved runs: {least}")?;
    Ok(())
}

fn join<T>(values: impl IntoIterator<Item = T>, format: impl Fn(T) -> String) -> String {
    values.into_iter().map(format).collect::<Vec<_>>().join(" | ")
}

fn timed(lens_radius: f64, rays: u32) -> (Film, f64) {
    let mut scene: Scene = Figure::ALL[2].scene();
    scene.camera.lens_radius = lens_radius;
    let settings = Settings {
        width: const { NonZero::new(320).unwrap() },
        height: const { NonZero::new(240).unwrap() },
        rays: NonZero::new(rays).unwrap_or(NonZero::<u32>::MIN),
        ..Settings::default()
    };
    let (start, start_on_cpu_s) = (Instant::now(), on_cpu_s());
    let film = render(&scene, &settings);
    let on_cpu = on_cpu_s().zip(start_on_cpu_s).map(|(end, start)| end - start);
    (film, on_cpu.unwrap_or_else(|| start.elapsed().as_secs_f64()))
}

/// Seconds that this thread has been running, which other work on the machine does not change; `None` but on Linux.
fn on_cpu_s() -> Option<f64> {
    let statistics = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(statistics.split_whitespace().next()?.parse::<f64>().ok()? * 1e-9)
}

/// Root mean square difference of the values that are shown, in 8-bit levels.
fn rms_levels(film: &Film, truth: &Film) -> f64 {
    let shown = |film: &Film| -> Vec<f64> { film.pixels.iter().flat_map(|p| p.0).map(|c| c.clamp(0.0, 1.0)).collect() };
    let (ours, theirs) = (shown(film), shown(truth));
    let sum: f64 = ours.iter().zip(&theirs).map(|(a, b)| (a - b) * (a - b)).sum();
    255.0 * (sum / ours.len() as f64).sqrt()
}
