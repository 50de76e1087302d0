//! `etalon figures` and `etalon whitted`, and the assignment's renderer beside the physical one.

use std::num::NonZero;
use std::path::{Path, PathBuf};

use etalon_picture::{read_exr, read_png8};
use etalon_whitted::{Scene, Settings, Vec3, render};

use crate::support::{entries, etalon_line};

fn reference(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../reference/assignment").join(name)
}

#[test]
fn figures_writes_16_images_like_the_ones_in_the_repository_and_an_animation() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("new/figures");
    let report = etalon_line("figures -o {} --json", [&output]).expect(0).json();
    assert_eq!(report["equal"], 16);
    assert!(report["figures"].as_array().unwrap().iter().all(|figure| figure["differing_pixels"] == 0));
    let names = entries(&output);
    assert_eq!(names.len(), 17, "{names:?}");
    assert!(names.contains(&"figure5_animation.gif".to_owned()));
    for name in names.iter().filter(|name| name.ends_with(".png")) {
        assert_eq!(read_png8(&output.join(name)).unwrap(), read_png8(&reference(name)).unwrap(), "{name}");
    }
}

#[test]
fn a_figure_that_differs_from_the_published_file_ends_figures_with_status_1() {
    let folder = tempfile::tempdir().unwrap();
    let (published, output) = (folder.path().join("published"), folder.path().join("ours"));
    std::fs::create_dir(&published).unwrap();
    for file in entries(&reference("")).into_iter().filter(|name| name.ends_with(".png")) {
        std::fs::copy(reference(&file), published.join(&file)).unwrap();
    }
    // Frame 6 in the place of frame 5.
    std::fs::copy(reference("figure5_frame06.png"), published.join("figure5_frame05.png")).unwrap();
    let ran = etalon_line("figures -o {} --published {}", [&output, &published]).expect(1).says(["1 of 16"]);
    let line = ran.stdout.lines().find(|line| line.starts_with("figure5_frame05")).unwrap();
    let differing: usize = line.split_whitespace().last().unwrap().parse().unwrap();
    assert!(differing > 1000, "{line}");
    let missing = folder.path().join("missing");
    etalon_line("figures -o {} --published {}", [&output, &missing]).expect(2).says(["missing"]);
}

#[test]
fn whitted_renders_the_published_scene_file_to_the_published_pixels() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("figure.png");
    for (flags, figure) in [
        ("", "figure3_depth_of_field.png"),
        ("--lens-radius 0", "figure2_shading_refraction.png"),
        ("--lens-radius 0 --epsilon 0", "figure1_no_epsilon.png"),
    ] {
        etalon_line(&format!("whitted {{}} -o {{}} {flags}"), [&reference("scene.json"), &output]).expect(0);
        assert_eq!(read_png8(&output).unwrap(), read_png8(&reference(figure)).unwrap(), "{flags}");
    }
}

#[test]
fn whitted_obeys_its_flags() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("small.png");
    let flags = "--size 64x48 --rays 2 --max-bounce 0 --refraction snell --json";
    let report = etalon_line(&format!("whitted {{}} -o {{}} {flags}"), [&reference("scene.json"), &output]).expect(0);
    let report = report.json();
    assert_eq!((&report["width"], &report["height"], &report["rays"]), (&64.into(), &48.into(), &2.into()));
    assert_eq!(report["nonfinite"], 0);
    let image = read_png8(&output).unwrap();
    assert_eq!((image.width, image.height), (64, 48));
}

#[test]
fn garbage_given_to_whitted_is_refused_with_status_2_and_every_place() {
    let folder = tempfile::tempdir().unwrap();
    let (bad, output) = (folder.path().join("bad.json"), folder.path().join("x.png"));
    let scene = std::fs::read_to_string(reference("scene.json")).unwrap();
    let text = scene
        .replacen("\"FocalLength\": 5.0,", "", 1)
        .replacen("\"IsPerspective\": true", "\"IsPerspective\": \"yes\"", 1)
        .replacen("\"Material\": 0", "\"Material\": 1", 1)
        .replacen("\"Radius\": 1", "\"Radius\": 0", 1);
    std::fs::write(&bad, text).unwrap();
    etalon_line("whitted {} -o {}", [&bad, &output]).expect(2).says([
        "bad.json:6:15: $.Camera: missing key",
        "$.Camera.IsPerspective",
        "$.Objects[0].Material: there is no material 1",
        "$.Objects[0].Radius: 0 is not above 0",
    ]);
    for text in ["", "{", "[1, 2]", "not JSON", "{\"etalon\": 1}"] {
        std::fs::write(&bad, text).unwrap();
        let ran = etalon_line("whitted {} -o {} --json", [&bad, &output]).expect(2);
        assert!(!ran.json()["errors"].as_array().unwrap().is_empty(), "{text}");
    }
    std::fs::write(&bad, [0xff, 0xfe, 0x00]).unwrap();
    etalon_line("whitted {} -o {}", [&bad, &output]).expect(2).says(["utf-8"]);
    etalon_line("whitted {} -o {}", [&folder.path().join("none.json"), &output]).expect(2).says(["none.json"]);
    for flags in ["--rays 0", "--size 0x4", "--epsilon -1", "--lens-radius nan", "--max-bounce -1"] {
        etalon_line(&format!("whitted {{}} -o {{}} {flags}"), [&reference("scene.json"), &output]).expect(2);
    }
    etalon_line("whitted {} -o {}", [&reference("scene.json"), &folder.path().join("x.jpg")]).expect(2).says([".png"]);
    etalon_line("whitted {} -o {}", [&reference("scene.json"), &folder.path().join("none/x.png")]).expect(1);
    assert_eq!(entries(folder.path()), ["bad.json"]);
}

#[test]
fn the_physical_scenes_beside_the_figures_render() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("x.png");
    for name in ["physical-pinhole.json", "physical-sphere-in-focus.json"] {
        etalon_line("render {} -o {} --spp 1 --size 16x12", [&reference(name), &output]).expect(0);
    }
}

/// Red of the diffuse term alone on a grid of `width` × 3/4 `width` points.
fn diffuse_term(width: u32) -> Vec<f64> {
    let mut scene = Scene::seven_spheres();
    (scene.background, scene.ambient, scene.camera.lens_radius) = (Vec3::default(), Vec3::default(), 0.0);
    for object in &mut scene.objects {
        (object.material.specular, object.material.mirror) = (Vec3::default(), Vec3::default());
    }
    let settings = Settings {
        width: NonZero::new(width).unwrap(),
        height: NonZero::new(width / 4 * 3).unwrap(),
        rays: NonZero::<u32>::MIN,
        // Above the rounding errors, and too small to shine through a sphere's rim.
        shadow_epsilon: 1e-9,
        ..Settings::default()
    };
    render(&scene, &settings).pixels.iter().map(|pixel| pixel.0[0]).collect()
}

/// Two renderers that share no code: what the assignment calls diffuse is the direct light of point lamps on Lambert spheres.
#[test]
fn the_diffuse_term_of_the_assignment_is_the_physical_renderers_direct_light() {
    const WIDTH: usize = 64;
    const HEIGHT: usize = 48;
    /// Points across a pixel.
    const FINE: usize = 16;
    const SPP: usize = 1024;
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("diffuse.exr");
    let line = format!("render {{}} -o {{}} --size {WIDTH}x{HEIGHT} --spp {SPP}");
    etalon_line(&line, [&reference("diffuse-only.json"), &output]).expect(0);
    let file = read_exr(&output).unwrap();
    let physical: Vec<f64> = ["R", "G", "B"]
        .map(|name| file.picture.channel(name).unwrap().iter().map(|&v| f64::from(v)).collect::<Vec<_>>())
        .into_iter()
        .reduce(|a, b| a.iter().zip(&b).map(|(a, b)| a + b).collect())
        .unwrap()
        .iter()
        .map(|sum| sum / 3.0)
        .collect();

    let fine = diffuse_term((WIDTH * FINE) as u32);
    let mut ours = vec![0.0; WIDTH * HEIGHT];
    for (i, value) in fine.iter().enumerate() {
        let (x, y) = (i % (WIDTH * FINE) / FINE, i / (WIDTH * FINE) / FINE);
        ours[y * WIDTH + x] += value / (FINE * FINE) as f64;
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let lit = ours.iter().filter(|value| **value > 0.02).count();
    // The root mean square relative difference of the lit pixels: noise, if all is well.
    let noise = |ours: &[f64]| {
        let pairs = physical.iter().zip(ours).filter(|(_, ours)| **ours > 0.02);
        (pairs.map(|(a, b)| (a / b - 1.0).powi(2)).sum::<f64>() / lit as f64).sqrt()
    };
    let (ratio, rms) = (mean(&physical) / mean(&ours), noise(&ours));
    // Measured 0.040: a sample's relative deviation of 1.3, from the choice of the lamp and of the wavelength, over 1024
    // samples. A picture that is one pixel off has 0.59, and one that is darker by a tenth 0.11.
    assert!(rms < 0.06, "{rms}");
    let mut shifted = ours.clone();
    shifted.rotate_left(1);
    assert!(noise(&shifted) > 0.1, "a shift by a pixel would not be seen: {}", noise(&shifted));
    // 4 standard errors: wrong by chance once in 16,000, blind to a bias below 0.6 %.
    let bound = 4.0 * rms / (lit as f64).sqrt();
    assert!((ratio - 1.0).abs() < bound && bound < 0.01, "{ratio}, bound {bound}");
}
