//! Renders a scene file to an error and prints what it cost:
//! `cargo run --release -p etalon --example render -- scenes/cornell.json cornell.exr 0.05`

#![allow(clippy::print_stdout)]

use etalon::{Control, Scene, Settings};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(scene), Some(picture)) = (arguments.next(), arguments.next()) else {
        return Err("usage: render SCENE PICTURE.exr [ERROR]".into());
    };
    let error: f64 = arguments.next().map_or(Ok(0.05), |error| error.parse())?;

    let renderer = Scene::load(&scene)?.prepare()?;
    for effect in renderer.plan().effects.iter().filter(|effect| effect.on) {
        println!("{:?}", effect.name);
    }
    let render = renderer.render_with(&Settings { error: Some(error), ..Settings::default() }, |progress| {
        if let Some(error) = progress.error() {
            println!("{:6} samples {:8.2} s   error {:.4}", progress.samples, progress.seconds, error.relative_rmse);
        }
        Control::Continue
    })?;
    render.write_exr(&picture)?;
    println!("{picture}: {} samples a pixel in {:.2} s", render.samples(), render.seconds());
    Ok(())
}
