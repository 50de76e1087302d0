//! Reads a scene file and prints what is in it, or everything that is wrong with it:
//! `cargo run --release -p etalon-scene --example check -- scenes/cornell.json`

#![allow(clippy::print_stdout)]

use etalon_scene::{LoadError, Problem, load};

fn print(problem: &Problem) {
    let Problem { severity, line, column, json_path, message, .. } = problem;
    println!("{severity} at {line}:{column}, {json_path}: {message}");
    if let Some(hint) = &problem.hint {
        println!("    {hint}");
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("usage: check SCENE.json")?;
    match load(&path) {
        Ok((scene, warnings)) => {
            warnings.iter().for_each(print);
            println!("{path}: {} × {} pixels", scene.film.width, scene.film.height);
            println!(
                "{} objects, {} lights, {} samples a pixel",
                scene.objects.len(),
                scene.lights.len(),
                scene.integrator.spp
            );
            Ok(())
        }
        Err(LoadError::Invalid(errors)) => {
            errors.problems.iter().for_each(print);
            Err(errors.summary().into())
        }
        Err(error) => Err(error.into()),
    }
}
