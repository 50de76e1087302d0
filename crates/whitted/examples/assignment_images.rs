//! The pictures of `docs/assignment.md` that are neither figures nor physical renders.
//!
//! `cargo run --release -p etalon-whitted --example assignment_images [DIR]`; the folder is `docs/images` if not given.

use std::error::Error;
use std::fmt::Write;
use std::num::NonZero;
use std::path::PathBuf;

use etalon_whitted::{
    Arithmetic, Figure, Film, Published, Scene, Settings, Vec3, refract_as_published, refract_snell, render,
    render_with, vec3,
};
use image::{Rgb, RgbImage, imageops};

/// The dot product summed from the right: what figure 1 is sensitive to.
struct DotFromTheRight;

impl Arithmetic for DotFromTheRight {
    fn dot(a: Vec3, b: Vec3) -> f64 {
        a.0[0] * b.0[0] + (a.0[1] * b.0[1] + a.0[2] * b.0[2])
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("docs/images"), PathBuf::from);
    acne()?.save(folder.join("assignment-acne.png"))?;
    lens()?.save(folder.join("assignment-lens.png"))?;
    std::fs::write(folder.join("assignment-grid.svg"), grid()?)?;
    std::fs::write(folder.join("assignment-refraction.svg"), refraction()?)?;
    Ok(())
}

fn picture(film: &Film) -> Result<RgbImage, &'static str> {
    RgbImage::from_raw(film.width, film.height, film.to_rgb8()).ok_or("a film has three bytes a pixel")
}

/// Enlarged pieces of pictures, side by side.
fn side_by_side(pictures: &[RgbImage], [x, y, width, height]: [u32; 4], enlarge: u32) -> RgbImage {
    let (w, h, gap) = (width * enlarge, height * enlarge, 8);
    let mut all = RgbImage::from_pixel((w + gap) * pictures.len() as u32 - gap, h, Rgb([255; 3]));
    for (i, picture) in pictures.iter().enumerate() {
        let piece = imageops::crop_imm(picture, x, y, width, height).to_image();
        let piece = imageops::resize(&piece, w, h, imageops::FilterType::Nearest);
        imageops::replace(&mut all, &piece, i64::from((w + gap) * i as u32), 0);
    }
    all
}

/// A piece of figure 1, the same of figure 2, and in white the pixels of figure 1 that another order of summation changes.
fn acne() -> Result<RgbImage, &'static str> {
    let [acne, clean, ..] = &Figure::ALL;
    let settings = |figure: &Figure| Settings { shadow_epsilon: figure.shadow_epsilon, ..Settings::default() };
    let first = picture(&render(&acne.scene(), &settings(acne)))?;
    let second = picture(&render(&clean.scene(), &settings(clean)))?;
    let other = picture(&render_with::<DotFromTheRight>(&acne.scene(), &settings(acne), |_| ()))?;
    let mut changed = first.clone();
    for (pixel, other) in changed.pixels_mut().zip(other.pixels()) {
        *pixel = if pixel == other { Rgb([0; 3]) } else { Rgb([255; 3]) };
    }
    Ok(side_by_side(&[first, second, changed], [326, 184, 64, 64], 4))
}

/// The same piece of figure 3 with 1, 5 and 50 rays a pixel.
fn lens() -> Result<RgbImage, &'static str> {
    let figure = &Figure::ALL[2];
    let with = |rays| {
        let rays = NonZero::new(rays).unwrap_or(NonZero::<u32>::MIN);
        picture(&render(&figure.scene(), &Settings { rays, ..Settings::default() }))
    };
    Ok(side_by_side(&[with(1)?, with(5)?, with(50)?], [112, 150, 80, 80], 4))
}

/// An SVG's frame around its content.
fn svg(width: u32, height: u32, content: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n{content}</svg>\n"
    )
}

fn line(out: &mut String, from: [f64; 2], to: [f64; 2], style: &str) -> std::fmt::Result {
    let ([x1, y1], [x2, y2]) = (from, to);
    writeln!(out, "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" {style}/>")
}

fn text(out: &mut String, at: [f64; 2], style: &str, words: &str) -> std::fmt::Result {
    writeln!(out, "<text x=\"{:.1}\" y=\"{:.1}\" {style}>{words}</text>", at[0], at[1])
}

const THIN: &str = "stroke=\"#888\" stroke-width=\"1\"";
const DASHED: &str = "stroke=\"#888\" stroke-width=\"1\" stroke-dasharray=\"4 3\"";
const BLACK: &str = "stroke=\"black\" stroke-width=\"2\"";
const BLUE: &str = "stroke=\"#1f5fbf\" stroke-width=\"2\"";
const RED: &str = "stroke=\"#c0392b\" stroke-width=\"2\"";

/// The camera and the pixel grid from the side, to scale: 40 units of drawing a unit of length.
fn grid() -> Result<String, std::fmt::Error> {
    let at = |z: f64, y: f64| [60.0 + 40.0 * (5.0 - z), 215.0 - 40.0 * y];
    let half_tangent = Published::tan(Scene::seven_spheres().camera.field_of_view_rad / 2.0);
    let (textbook, published) = (5.0 * half_tangent, 2.0 * 5.0 * half_tangent);
    let mut out = String::new();
    line(&mut out, at(5.0, 0.0), at(-6.0, 0.0), THIN)?;
    line(&mut out, at(-5.0, -published), at(-5.0, published), BLACK)?;
    line(&mut out, at(0.0, -textbook), at(0.0, textbook), DASHED)?;
    for sign in [-1.0, 1.0] {
        line(&mut out, at(5.0, 0.0), at(-5.0, sign * published), BLUE)?;
        line(
            &mut out,
            at(0.0, 0.0),
            at(-5.0, sign * published),
            "stroke=\"#c0392b\" stroke-width=\"1\" stroke-dasharray=\"4 3\"",
        )?;
    }
    let [x, y] = at(5.0, 0.0);
    writeln!(out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"4\"/>")?;
    text(&mut out, [x - 44.0, y + 26.0], "", "camera, z = 5")?;
    text(&mut out, [at(0.0, 0.0)[0] + 8.0, 238.0], "fill=\"#888\"", "z = 0")?;
    text(
        &mut out,
        [at(0.0, 0.0)[0] - 6.0, 116.0],
        "fill=\"#888\" text-anchor=\"end\"",
        &format!("f tan(fov/2) = {textbook:.3}"),
    )?;
    text(&mut out, [at(-5.0, 0.0)[0] + 8.0, 60.0], "", "pixel grid, z = −5")?;
    text(&mut out, [at(-5.0, 0.0)[0] + 8.0, 78.0], "", &format!("2 f tan(fov/2) = {published:.3}"))?;
    text(&mut out, [x + 80.0, y - 10.0], "fill=\"#1f5fbf\"", "45°: what is seen")?;
    text(&mut out, [at(-1.1, 0.0)[0], y - 10.0], "fill=\"#c0392b\"", "79.3° from z = 0")?;
    Ok(svg(640, 430, &out))
}

/// A ray at 50° that enters a body, at ri = 1 and at ri = 1/1.5, by both formulas.
fn refraction() -> Result<String, std::fmt::Error> {
    let angle_rad = 50.0_f64.to_radians();
    let (d, n) = (vec3(angle_rad.sin(), -angle_rad.cos(), 0.0), vec3(0.0, 1.0, 0.0));
    let mut out = String::new();
    for (i, (ri, name)) in
        [(1.0, "ri = 1: nothing to bend it"), (1.0 / 1.5, "ri = 1/1.5: into glass")].into_iter().enumerate()
    {
        let (x, y) = (160.0 + 320.0 * i as f64, 150.0);
        writeln!(out, "<rect x=\"{}\" y=\"{y}\" width=\"280\" height=\"140\" fill=\"#eaf2fb\"/>", x - 140.0)?;
        line(&mut out, [x - 140.0, y], [x + 140.0, y], THIN)?;
        line(&mut out, [x, y - 110.0], [x, y + 130.0], DASHED)?;
        let along = |v: Vec3, length: f64| {
            let v = length * Published::normalize(v);
            [x + v.0[0], y - v.0[1]]
        };
        line(&mut out, along(-1.0 * d, 120.0), [x, y], BLACK)?;
        let from_normal = |k: Vec3| k.0[0].atan2(-k.0[1]).to_degrees();
        for (k, style, color, word, dy) in [
            (refract_snell::<Published>(ri, d, n), BLUE, "#1f5fbf", "Snell", 0.0),
            (refract_as_published::<Published>(ri, d, n), RED, "#c0392b", "published", 16.0),
        ] {
            let Some(k) = k else { continue };
            line(&mut out, [x, y], along(k, 120.0), style)?;
            let words = format!("{word}: {:.1}°, length {:.3}", from_normal(k), Published::dot(k, k).sqrt());
            text(&mut out, [x - 136.0, y + 160.0 + dy], &format!("fill=\"{color}\" font-size=\"12\""), &words)?;
        }
        text(&mut out, [x - 136.0, 24.0], "", name)?;
        text(&mut out, [x + 6.0, y - 96.0], "fill=\"#888\"", "N")?;
        text(&mut out, [x - 136.0, y - 84.0], "", "D, 50°")?;
    }
    Ok(svg(640, 340, &out))
}
