//! A scene in code, as a picture in the plainest of formats:
//! `cargo run --release -p etalon-whitted --example picture > picture.ppm`

use std::io::Write;
use std::num::NonZero;

use etalon_whitted::{Light, Scene, Settings, render, vec3};

fn main() -> std::io::Result<()> {
    // The published scene of seven spheres, under one light from the left, with the lens open.
    let mut scene = Scene::seven_spheres();
    scene.lights = vec![Light { position: vec3(-8.0, 6.0, 6.0), color: vec3(120.0, 110.0, 100.0) }];
    scene.camera.lens_radius = 0.1;
    let settings = Settings { rays: NonZero::new(16).expect("not zero"), ..Settings::default() };

    let film = render(&scene, &settings);
    let mut out = std::io::stdout().lock();
    write!(out, "P6\n{} {}\n255\n", film.width, film.height)?;
    out.write_all(&film.to_rgb8())
}
