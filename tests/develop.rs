//! From EXR to PNG: `etalon develop`, and the same options of `etalon render`.

use std::fs;
use std::path::{Path, PathBuf};

use etalon_picture::develop::{NOT_FINITE, palette};
use etalon_picture::{Attributes, Picture, Rgb8, decode_srgb, read_exr, read_png8, write_exr};

use crate::support::{Ran, changed_scene, entries, etalon_line, etalon_that_ends, scene};

const SMALL: &str = "--spp 8 --size 32x24 --bands 450:650:50 --quiet";

/// A small render of the Cornell box with bands, in a folder of its own.
fn rendered() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let exr = folder.path().join("x.exr");
    etalon_line(&format!("render {{}} -o {{}} {SMALL}"), [&scene("cornell.json"), &exr]).expect(0);
    (folder, exr)
}

/// An EXR with these channels, each of width × height samples.
fn exr(path: &Path, (width, height): (usize, usize), channels: &[(&str, &[f32])]) {
    let mut picture = Picture::new(width, height).unwrap();
    channels.iter().for_each(|(name, samples)| picture.insert(name, samples.to_vec()).unwrap());
    write_exr(path, &picture, &Attributes::new()).unwrap();
}

fn grey(path: &Path, size: (usize, usize), samples: &[f32]) {
    exr(path, size, &[("R", samples), ("G", samples), ("B", samples)]);
}

#[track_caller]
fn develop(image: &Path, options: &str, output: &Path) -> Ran {
    etalon_that_ends(&format!("develop {{}} -o {{}} {options}"), [image, output])
}

/// What the options make of an EXR.
#[track_caller]
fn shown(image: &Path, options: &str) -> Rgb8 {
    let folder = tempfile::tempdir().unwrap();
    let png = folder.path().join("x.png");
    develop(image, options, &png).expect(0);
    read_png8(&png).unwrap()
}

#[test]
fn a_developed_picture_has_the_bytes_of_the_rendered_one_for_every_option() {
    let (folder, exr) = rendered();
    for (index, options) in [
        "",
        "--exposure -1.5",
        "--exposure auto --curve agx",
        "--curve filmic --white-balance D50",
        "--white-balance patch:12,10,6,4 --scale 0.7",
        "--false-colour --range 100:1e5",
        "--error-map",
        "--error-map=absolute --axis linear --scale 2",
        "--band 550nm --exposure auto",
        "--band 600 --false-colour",
    ]
    .into_iter()
    .enumerate()
    {
        let [rendered, developed] = ["r", "d"].map(|name| folder.path().join(format!("{name}{index}.png")));
        // A band needs no EXR beside it; other options have no use for bands alone.
        let mut line = format!("render {{}} -o {{}} {SMALL} {options}");
        if !options.contains("--band") {
            line += &format!(" -o {}", folder.path().join("also.exr").display());
        }
        etalon_line(&line, [&scene("cornell.json"), &rendered]).expect(0);
        develop(&exr, options, &developed).expect(0);
        assert!(fs::read(&rendered).unwrap() == fs::read(&developed).unwrap(), "{options}");
    }
    // With --only the EXR lacks colours and bands, and the PNG beside it does not.
    let [only, png] = ["only.exr", "only.png"].map(|name| folder.path().join(name));
    let line = format!("render {{}} -o {{}} -o {{}} {SMALL} --aov depth --only --error-map");
    etalon_line(&line, [&scene("cornell.json"), &only, &png]).expect(0);
    assert!(fs::read(&png).unwrap() == fs::read(folder.path().join("r6.png")).unwrap());
    // Parts that are merged can be developed too.
    let part = folder.path().join("x.part");
    etalon_line(&format!("render {{}} -o {{}} {SMALL}"), [&scene("cornell.json"), &part]).expect(0);
    etalon_line("merge {} -o {} --quiet --exposure auto --curve agx", [&part, &png]).expect(0);
    assert!(fs::read(&png).unwrap() == fs::read(folder.path().join("r2.png")).unwrap());
}

#[test]
fn a_stop_doubles_the_light_and_a_patch_becomes_grey() {
    let (_folder, exr) = rendered();
    let file = read_exr(&exr).unwrap();
    let [r, g, b] = ["R", "G", "B"].map(|name| file.picture.require(name).unwrap());
    let level = |v: f64| (255.0 * etalon_picture::encode_srgb(v)).round() as u8;
    let brighter = shown(&exr, "--exposure 1");
    for (i, pixel) in brighter.pixels.chunks_exact(3).enumerate() {
        assert_eq!(pixel, [r[i], g[i], b[i]].map(|v| level(2.0 * f64::from(v))), "{i}");
    }
    let balanced = shown(&exr, "--white-balance patch:2,8,4,6 --exposure 1");
    let mut mean = [0.0; 3];
    for (x, y) in (2..6).flat_map(|x| (8..14).map(move |y| (x, y))) {
        let start = 3 * (y * balanced.width + x);
        (0..3).for_each(|c| mean[c] += decode_srgb(f64::from(balanced.pixels[start + c]) / 255.0));
    }
    // The red wall, which is far from grey before. Levels are rounded, and no pixel of it is clipped.
    assert!(mean.iter().all(|v| (v / mean[0] - 1.0).abs() < 0.02), "{mean:?}");
}

#[test]
fn crop_and_scale_keep_what_they_show() {
    let folder = tempfile::tempdir().unwrap();
    let image = folder.path().join("x.exr");
    let samples: Vec<f32> = (0..48).map(|i| i as f32 / 48.0).collect();
    grey(&image, (8, 6), &samples);
    let whole = shown(&image, "");
    let part = shown(&image, "--crop 2,1,4,3");
    assert_eq!((part.width, part.height), (4, 3));
    for (y, row) in part.pixels.chunks_exact(12).enumerate() {
        assert_eq!(row, &whole.pixels[3 * (8 * (y + 1) + 2)..][..12]);
    }
    let mean = |image: &Rgb8| {
        let sum: f64 = image.pixels.iter().map(|level| decode_srgb(f64::from(*level) / 255.0)).sum();
        sum / image.pixels.len() as f64
    };
    for (options, size) in [("--scale 0.5", (4, 3)), ("--scale 2.5", (20, 15)), ("--scale 0.01", (1, 1))] {
        let scaled = shown(&image, options);
        assert_eq!((scaled.width, scaled.height), size, "{options}");
        assert!((mean(&scaled) - mean(&whole)).abs() < 0.004, "{options}: {} {}", mean(&scaled), mean(&whole));
    }
}

#[test]
fn automatic_exposure_is_told_and_can_be_repeated() {
    let folder = tempfile::tempdir().unwrap();
    let [image, auto, again] = ["x.exr", "auto.png", "again.png"].map(|name| folder.path().join(name));
    let mut samples = vec![0.045_f32; 64];
    samples[9] = 1e6;
    grey(&image, (8, 8), &samples);
    let ran = develop(&image, "--exposure auto", &auto).expect(0);
    // One of 64 pixels counts as bright as the others.
    assert!(ran.stdout.contains("exposure +2 EV"), "{}", ran.stdout);
    develop(&image, "--exposure 2", &again).expect(0);
    assert!(fs::read(&auto).unwrap() == fs::read(&again).unwrap());
}

#[test]
fn false_colour_has_a_bar_from_one_end_of_the_palette_to_the_other() {
    let folder = tempfile::tempdir().unwrap();
    let image = folder.path().join("x.exr");
    grey(&image, (4, 1), &[1.0, 10.0, 100.0, f32::NAN]);
    let map = shown(&image, "--false-colour --range 1:100");
    let colours: Vec<&[u8]> = map.pixels.chunks_exact(3).collect();
    for place in [0.0, 0.5, 1.0] {
        assert!(colours.iter().any(|colour| **colour == palette(place)), "{place}");
    }
    // The pixel and the square of the legend.
    assert_eq!(colours.iter().filter(|colour| ***colour == NOT_FINITE).count(), 1 + 7 * 7);
    assert!(map.width > 4 + 14 && map.height > 90);
    let ran = develop(&image, "--false-colour --range 2:50", &folder.path().join("m.png")).expect(0);
    assert!(ran.stdout.contains("luminance, channel units, from 2 to 50; pixels below: 1, above: 1"), "{}", ran.stdout);
}

#[test]
fn a_plot_shows_the_values_of_the_file() {
    let (folder, exr) = rendered();
    let svg = folder.path().join("x.svg");
    let file = read_exr(&exr).unwrap();
    for (region, width, height) in [("16,20", 1, 1), ("10,8,6,4", 6, 4)] {
        develop(&exr, &format!("--spectrum {region}"), &svg).expect(0);
        let text = fs::read_to_string(&svg).unwrap();
        let start: Vec<usize> = region.split(',').map(|n| n.parse().unwrap()).collect();
        let mean = |nm: usize| {
            let samples = file.picture.require(&format!("S0.{nm},000000nm")).unwrap();
            let pixels = (0..width * height).map(|i| (start[1] + i / width) * 32 + start[0] + i % width);
            pixels.map(|i| f64::from(samples[i])).sum::<f64>() / (width * height) as f64
        };
        let number = |line: &str, name: &str| -> f64 {
            line.split_once(&format!("{name}=\"")).unwrap().1.split_once('"').unwrap().0.parse().unwrap()
        };
        let points: Vec<[f64; 2]> = text
            .lines()
            .filter(|line| line.starts_with("<circle"))
            .map(|line| [number(line, "cx"), number(line, "cy")])
            .collect();
        let means: Vec<f64> = (450..=650).step_by(50).map(mean).collect();
        assert_eq!(points.len(), means.len());
        // The axes are straight: by the first and the last band for wavelengths, by the least and the greatest value for values.
        let order = |i: &usize, j: &usize| means[*i].total_cmp(&means[*j]);
        let [least, most] = [(0..5).min_by(order).unwrap(), (0..5).max_by(order).unwrap()];
        for (i, point) in points.iter().enumerate() {
            let x = points[0][0] + i as f64 / 4.0 * (points[4][0] - points[0][0]);
            let share = (means[i] - means[least]) / (means[most] - means[least]);
            let y = points[least][1] + share * (points[most][1] - points[least][1]);
            assert!(
                (point[0] - x).abs() <= 1.0 && (point[1] - y).abs() <= 1.0,
                "{region} {i}: {point:?}, expected {x} {y}"
            );
        }
        // A bar and two caps for each band.
        let drawn = text.lines().filter(|line| line.starts_with("<polyline") && line.contains("#0072B2"));
        assert_eq!(drawn.count(), 1 + 3 * 5, "{text}");
    }
    for (options, says) in [("--spectrum 32,0", "32 × 24"), ("--spectrum 0,0,33,1", "32 × 24")] {
        fs::remove_file(&svg).unwrap_or_default();
        develop(&exr, options, &svg).expect(2).says([says]);
        assert!(!svg.exists());
    }
    let png = folder.path().join("x.png");
    develop(&exr, "--spectrum 1,1", &png).expect(2).says([".svg"]);
}

#[test]
fn pictures_of_other_renderers_are_shown_as_they_are_meant() {
    let folder = tempfile::tempdir().unwrap();
    let image = folder.path().join("x.exr");
    exr(&image, (1, 1), &[("X", &[0.9505]), ("Y", &[1.0]), ("Z", &[1.0891])]);
    assert!(shown(&image, "").pixels.iter().all(|level| *level >= 254));
    exr(&image, (1, 1), &[("Y", &[0.5])]);
    assert_eq!(shown(&image, "").pixels, [188; 3]);
    exr(&image, (1, 1), &[("S0.500,000000nm", &[0.5]), ("S0.600,000000nm", &[0.5])]);
    assert!(shown(&image, "").pixels.iter().any(|level| *level > 0));
    exr(&image, (1, 1), &[("Z", &[0.5]), ("N.X", &[1.0])]);
    let png = folder.path().join("x.png");
    develop(&image, "", &png).expect(2).says(["x.exr", "`R`", "N.X, Z"]);
    assert_eq!(entries(folder.path()), ["x.exr"]);
}

#[test]
fn what_cannot_be_shown_is_refused_and_nothing_is_written() {
    let (folder, exr) = rendered();
    let rgb = folder.path().join("rgb.exr");
    grey(&rgb, (2, 2), &[1.0; 4]);
    let png = folder.path().join("x.png");
    fs::write(&png, "mine").unwrap();
    let before = entries(folder.path());
    for (image, options, says) in [
        (&exr, "--crop 0,0,33,24", "32 × 24"),
        (&exr, "--crop 0,0,0,1", "X,Y,W,H"),
        (&exr, "--crop 20,30,4,14", "20,4,10,10"),
        (&exr, "--white-balance patch:40,0,1,1", "32 × 24"),
        (&exr, "--white-balance moonlight", "3200K"),
        (&exr, "--band 700nm", "450 to 650 nm"),
        (&exr, "--scale 1e9", "pixels"),
        (&exr, "--scale 0", "factor"),
        (&exr, "--curve aces", "agx"),
        (&exr, "--exposure nan", "finite"),
        (&exr, "--exposure 1e9", "1000"),
        (&exr, "--false-colour --range 0:1", "above 0"),
        (&exr, "--false-colour --exposure 1", "--exposure"),
        (&exr, "--false-colour --error-map", "--error-map"),
        (&exr, "--range 1:2", "--false-colour"),
        (&rgb, "--error-map", "Error.R"),
        (&rgb, "--band 550", "--bands"),
        (&rgb, "--exposure auto --crop 0,0,3,1", "2 × 2"),
    ] {
        develop(image, options, &png).expect(2).says([says]);
    }
    let jpg = folder.path().join("x.jpg");
    develop(&exr, "", &jpg).expect(2).says([".png"]);
    develop(&exr, "", &exr).expect(2).says([".png"]);
    develop(&folder.path().join("none.exr"), "", &png).expect(2).says(["none.exr"]);
    develop(&png, "", &folder.path().join("y.png")).expect(2).says(["x.png"]);
    develop(&exr, "", &folder.path().join("none/y.png")).expect(1).says(["none"]);
    etalon_line("develop {}", [&exr]).expect(2).says(["--output"]);
    // What the user has under the name of the output is still there.
    assert_eq!(fs::read_to_string(&png).unwrap(), "mine");
    assert_eq!(entries(folder.path()), before);
}

#[test]
fn what_is_not_finite_is_said_with_its_place_and_hostile_files_end() {
    let folder = tempfile::tempdir().unwrap();
    let [image, png] = ["x.exr", "x.png"].map(|name| folder.path().join(name));
    let mut samples = vec![0.5_f32; 12];
    samples[7] = f32::NAN;
    samples[9] = f32::NEG_INFINITY;
    samples[2] = -3.0;
    samples[4] = f32::MAX;
    grey(&image, (4, 3), &samples);
    for options in
        ["", "--exposure auto", "--scale 0.5", "--curve agx --white-balance A", "--false-colour", "--exposure 1000"]
    {
        develop(&image, options, &png).expect(0).says(["not-finite", "2 pixels", "column 3, row 1"]);
    }
    // Nothing but what is no light.
    grey(&image, (2, 1), &[f32::NAN, -1.0]);
    for options in ["--exposure auto", "--false-colour", "--white-balance patch:1,0,1,1"] {
        develop(&image, options, &png).expect(2).says(["x.exr"]);
    }
    // Cut off, and with a size that it cannot hold.
    grey(&image, (64, 64), &vec![0.25; 4096]);
    let bytes = fs::read(&image).unwrap();
    fs::remove_file(&png).unwrap();
    for cut in [0, 4, 100, bytes.len() / 2, bytes.len() - 1] {
        fs::write(&image, &bytes[..cut]).unwrap();
        develop(&image, "", &png).expect(2).says(["x.exr"]);
    }
    let window = bytes.windows(10).position(|name| name == b"dataWindow").unwrap() + "dataWindow\0box2i\0".len() + 4;
    let mut huge = bytes;
    huge[window + 8..window + 16].copy_from_slice(&[0xff, 0xff, 0xff, 0x7e, 0xff, 0xff, 0xff, 0x7e]);
    fs::write(&image, &huge).unwrap();
    develop(&image, "", &png).expect(2).says(["x.exr"]);
    assert_eq!(entries(folder.path()), ["x.exr"]);
}

#[test]
fn a_render_refuses_what_its_png_could_not_show_before_it_begins() {
    let folder = tempfile::tempdir().unwrap();
    let (png, cornell) = (folder.path().join("x.png"), scene("cornell.json"));
    // Ends at once, although the picture would take hours.
    let long = "--spp 1000000 --size 512x512 --quiet";
    for (options, says) in [
        ("--band 550", "--bands"),
        ("--band 800 --bands 450:650:50", "450 to 650 nm"),
        ("--white-balance patch:500,0,20,1", "512 × 512"),
        ("--scale 1000", "pixels"),
        ("--false-colour --range 0:1", "--range"),
        ("--crop 0,0,8,8 --white-balance patch:8,0,1,1", "8 × 8"),
    ] {
        etalon_that_ends(&format!("render {{}} -o {{}} {long} {options}"), [&cornell, &png]).expect(2).says([says]);
    }
    let single = folder.path().join("single.json");
    changed_scene("furnace.json", &single, |scene| scene["integrator"]["replicates"] = 1.into());
    etalon_that_ends(&format!("render {{}} -o {{}} {long} --error-map"), [&single, &png])
        .expect(2)
        .says(["replicates"]);
    assert_eq!(entries(folder.path()), ["single.json"]);
}
