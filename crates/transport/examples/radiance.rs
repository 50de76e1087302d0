//! Renders a scene file and prints, in a grid, the radiance that arrives with its standard error:
//! `cargo run --release -p etalon-transport --example radiance -- scenes/cornell.json`

#![allow(clippy::print_stdout)]

use etalon_transport::{Control, prepare};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("usage: radiance SCENE.json")?;
    let (mut scene, _) = etalon_scene::load(&path)?;
    (scene.film.width, scene.film.height, scene.integrator.spp) = (64, 64, 64);
    let prepared = prepare(&scene)?;
    let effects = prepared.plan().effects.iter().filter(|effect| effect.on);
    println!("effects: {}", effects.map(|effect| format!("{:?}", effect.name)).collect::<Vec<_>>().join(", "));

    let whole = prepared.whole(None);
    let film = prepared.render(&whole, &|_| Control::Continue)?;
    for y in (4..64).step_by(8) {
        let row = (4..64).step_by(8).map(|x| {
            let pixel = film.pixel(x, y);
            // The replicates of a pixel are independent: their scatter is the error of their mean.
            let error = pixel.variance(|xyz| [xyz[1]]).map_or(f64::INFINITY, |([variance], _)| variance.sqrt());
            format!("{:7.3} ± {error:.3}", pixel.xyz()[1])
        });
        println!("{}", row.collect::<Vec<_>>().join(" "));
    }
    if let Some(error) = film.error(whole.rect) {
        println!("relative error of the picture {:.4}, from {} paths", error.relative_rmse, film.counters.paths);
    }
    Ok(())
}
