//! How far one EXR picture is from another, by three measures:
//! `cargo run --release -p etalon-picture --example distance -- picture.exr reference.exr`
//!
//! Without arguments, it compares a grey gradient with one that has a brighter square.

#![allow(clippy::print_stdout)]

use std::path::Path;

use etalon_picture::{PIXELS_PER_DEGREE, Picture, PictureError, compare, flip, read_exr};

fn gradient(square: f32) -> Result<Picture, PictureError> {
    let pixel = |index: usize| {
        let (x, y) = (index % 64, index / 64);
        let inside = (24..40).contains(&x) && (24..40).contains(&y);
        [x as f32 / 63.0 + if inside { square } else { 0.0 }; 3]
    };
    Picture::from_rgb(64, 64, &(0..64 * 64).map(pixel).collect::<Vec<_>>())
}

fn main() -> Result<(), PictureError> {
    let paths: Vec<String> = std::env::args().skip(1).collect();
    let (picture, reference) = match paths.as_slice() {
        [picture, reference] => (read_exr(Path::new(picture))?.picture, read_exr(Path::new(reference))?.picture),
        _ => (gradient(0.1)?, gradient(0.0)?),
    };
    let metrics = compare(&picture, &reference, &["R", "G", "B"])?;
    println!("RMSE   {:.6}", metrics.rmse);
    println!("relMSE {:.6}", metrics.rel_mse);
    let seen = flip(&picture, &reference, 1.0, PIXELS_PER_DEGREE)?;
    println!("FLIP   {:.6} in the mean, {:.6} at most", mean(&seen), seen.iter().fold(0.0, |a: f64, &b| a.max(b)));
    Ok(())
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
