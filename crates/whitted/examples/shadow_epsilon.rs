//! Shadow acne: how many pixels of the seven spheres are wrong at which shadow epsilon, as a Markdown table.
//!
//! What they are compared with is an epsilon of 1e-9: far above the rounding errors, far below the size of a sphere.
//!
//! `cargo run --release -p etalon-whitted --example shadow_epsilon`, a few seconds.

use std::io::Write;

use etalon_whitted::{Figure, Film, Settings, Vec3, render};

fn main() -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    let figure = &Figure::ALL[0];
    let with = |shadow_epsilon| render(&figure.scene(), &Settings { shadow_epsilon, ..Settings::default() });
    let right = with(1e-9);
    let background = right.pixels[0];
    let spheres = right.pixels.iter().filter(|p| **p != background).count();
    writeln!(out, "{spheres} pixels of the picture show a sphere.\n")?;
    writeln!(out, "| epsilon | pixels that change | darker | lighter | light |\n|---:|---:|---:|---:|---:|")?;
    for epsilon in [0.0, 1e-17, 1e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-9, 1e-6, 1e-3, 1e-2, 0.1, 0.3] {
        let film = with(epsilon);
        let (ours, theirs) = (film.to_rgb8(), right.to_rgb8());
        // Red: it has no ambient part.
        let red = || ours.iter().step_by(3).zip(theirs.iter().step_by(3));
        let changed = ours.chunks(3).zip(theirs.chunks(3)).filter(|(a, b)| a != b).count();
        let (darker, lighter) = (red().filter(|(a, b)| a < b).count(), red().filter(|(a, b)| a > b).count());
        let share = light(&film, background) / light(&right, background);
        writeln!(out, "| {epsilon:e} | {changed} | {darker} | {lighter} | {share:.4} |")?;
    }
    Ok(())
}

/// All red light of the spheres: red has no ambient part.
fn light(film: &Film, background: Vec3) -> f64 {
    film.pixels.iter().filter(|p| **p != background).map(|p| p.0[0]).sum()
}
