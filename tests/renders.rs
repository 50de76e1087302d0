//! What a render gives: its report, its metadata, the same pixels however it is run.

use etalon_picture::{Attribute, RenderInfo};
use serde_json::Value;
use sha2::{Digest, Sha256};

use crate::support::{changed_scene, etalon_line, pixel_bits, scene};

#[test]
fn json_is_one_object_with_what_a_machine_wants_to_know() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, output) = (scene("cornell.json"), folder.path().join("x.exr"));
    let ran = etalon_line("render {} -o {} --spp 2 --seed 7 --size 20x10 --threads 2 --json", [&scene, &output]);
    let report = ran.expect(0).json();
    assert_eq!(report["scene"], scene.to_str().unwrap());
    assert_eq!(report["output"], output.to_str().unwrap());
    for (key, value) in
        [("spp", 2), ("seed", 7), ("width", 20), ("height", 10), ("threads", 2), ("nonfinite", 0), ("cut_paths", 0)]
    {
        assert_eq!(report[key], value, "{key}");
    }
    assert_eq!(report["paths"], 20 * 10 * 2);
    let number = |key: &str| report[key].as_f64().unwrap();
    assert!(number("seconds") > 0.0);
    let rate = number("paths") / number("seconds");
    assert!((number("paths_per_second") / rate - 1.0).abs() < 1e-12);
    assert_eq!(report["warnings"], Value::Array(Vec::new()));
    assert_eq!(report["errors"], Value::Array(Vec::new()));
    assert!(report["plan"]["effects"].is_array());
}

#[test]
fn a_picture_says_how_it_was_made() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, output) = (scene("cornell.json"), folder.path().join("x.exr"));
    let line = "render {} -o {} --spp 3 --seed 18446744073709551615 --size 9x5 --json";
    let report = etalon_line(line, [&scene, &output]).expect(0).json();
    let (bits, file) = pixel_bits(&output);
    let names: Vec<&str> = bits.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["B", "Error.B", "Error.G", "Error.R", "G", "R"]);
    let info = RenderInfo::from_attributes(&file.attributes).expect("all of it is there");
    assert_eq!(info.software, format!("etalon {}", env!("CARGO_PKG_VERSION")));
    assert_eq!((info.samples_per_pixel, info.seed), (3, u64::MAX));
    assert_eq!(info.scene_sha256, report["scene_sha256"]);
    let hash = Sha256::digest(std::fs::read(&scene).unwrap());
    assert_eq!(info.scene_sha256, hash.iter().map(|byte| format!("{byte:02x}")).collect::<String>());
    assert_eq!(info.render_time_s, f64::from(report["seconds"].as_f64().unwrap() as f32));
    let plan: Value = serde_json::from_str(&info.plan_json).unwrap();
    assert_eq!(plan, report["plan"]);
    assert_eq!(plan["kernel"], "shared-8");
    assert!(matches!(file.attributes["chromaticities"], Attribute::Chromaticities(_)));
}

#[test]
fn any_number_of_threads_gives_the_same_pixels_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["cornell.json", "cornell-glass.json", "fog.json", "cloud.json", "milk.json"] {
        for more in ["", "--sampler independent"] {
            let render = |threads: u32, seed: u32| {
                let output = folder.path().join("x.exr");
                let line = format!("render {{}} -o {{}} --spp 4 --size 50x37 --threads {threads} --seed {seed} {more}");
                etalon_line(&line, [&scene(name), &output]).expect(0);
                pixel_bits(&output).0
            };
            let one = render(1, 5);
            for threads in [2, 3] {
                assert!(render(threads, 5) == one, "{name} {more}: {threads} threads differ from one");
            }
            assert!(render(2, 6) != one, "{name} {more}: the seed changes nothing");
        }
    }
}

#[test]
fn a_crop_has_the_pixels_of_the_whole_picture() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["cornell.json", "fog.json"] {
        let (scene, whole, part) = (scene(name), folder.path().join("whole.exr"), folder.path().join("part.exr"));
        etalon_line("render {} -o {} --spp 2 --size 40x30", [&scene, &whole]).expect(0);
        etalon_line("render {} -o {} --spp 2 --size 40x30 --crop 7,3,22,17", [&scene, &part]).expect(0);
        let (whole, _) = pixel_bits(&whole);
        let (part, file) = pixel_bits(&part);
        assert_eq!((file.picture.width(), file.picture.height()), (22, 17));
        assert_eq!(file.picture.window(), etalon_picture::Window { origin_px: [7, 3], frame_px: [40, 30] });
        for ((_, whole), (channel, part)) in whole.iter().zip(&part) {
            for (row, samples) in part.chunks(22).enumerate() {
                let start = (row + 3) * 40 + 7;
                assert_eq!(samples, &whole[start..start + 22], "{name}: channel {channel}, row {row} of the crop");
            }
        }
    }
}

#[test]
fn a_replayed_path_is_the_one_that_made_the_pixel() {
    for (name, pixels) in [
        ("cornell.json", [(0, 0), (3, 4), (7, 7), (4, 1)]),
        // In mist, in a cloud of a density grid, and in milk behind glass.
        ("fog.json", [(0, 0), (3, 4), (7, 7), (4, 1)]),
        ("cloud.json", [(3, 3), (4, 3), (3, 4), (4, 4)]),
        ("milk.json", [(3, 3), (4, 3), (3, 5), (4, 6)]),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let (path, output) = (scene(name), folder.path().join("x.exr"));
        let settings = "--spp 1 --size 8x8 --seed 3";
        etalon_line(&format!("render {{}} -o {{}} {settings}"), [&path, &output]).expect(0);
        let file = etalon_picture::read_exr(&output).unwrap();
        let mut scatterings = 0;
        for (x, y) in pixels {
            let line = format!("render {{}} {settings} --pixel {x},{y} --sample 0");
            let replay = etalon_line(&format!("{line} --json"), [&path]).expect(0).json();
            let xyz: [f64; 3] = serde_json::from_value(replay["xyz"].clone()).unwrap();
            let rgb = etalon_optics::colour::rec709_from_xyz(xyz);
            for (channel, expected) in ["R", "G", "B"].into_iter().zip(rgb) {
                let read = file.picture.channel(channel).unwrap()[y * 8 + x];
                assert_eq!(read, expected as f32, "{name}: {channel} of {x},{y}");
            }
            let text = etalon_line(&line, [&path]).expect(0).stdout;
            for event in replay["events"].as_array().unwrap() {
                let line = match event["event"].as_str().unwrap() {
                    "vertex" => format!("vertex {}: {}", event["vertex"], event["object"]),
                    "scattering" => {
                        scatterings += 1;
                        format!("vertex {}: medium", event["vertex"])
                    }
                    "light" => format!("light at vertex {}", event["vertex"]),
                    "end" => format!("end: {}", event["because"].as_str().unwrap()),
                    other => panic!("an event of kind {other}"),
                };
                assert!(text.contains(&line), "`{line}` is not in:\n{text}");
            }
        }
        assert_eq!(scatterings > 0, name != "cornell.json", "{name}: {scatterings} scatterings");
    }
}

#[test]
fn quiet_is_quiet_and_a_bar_is_for_terminals_only() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, output) = (scene("cornell.json"), folder.path().join("x.exr"));
    let ran = etalon_line("render {} -o {} --spp 1 --size 8x8 --quiet", [&scene, &output]).expect(0);
    assert_eq!((ran.stdout.as_str(), ran.stderr.as_str()), ("", ""));
    let ran = etalon_line("render {} -o {} --spp 1 --size 8x8", [&scene, &output]).expect(0);
    assert!(ran.stdout.contains("8 × 8 pixels") && ran.stdout.contains("x.exr"), "{}", ran.stdout);
    assert_eq!(ran.stderr, "");
}

#[test]
fn a_size_from_the_command_line_is_the_size_in_the_file() {
    // A camera whose angle is stated across the width: it must not be taken from the file's own proportions.
    let folder = tempfile::tempdir().unwrap();
    let pixels_of = |film: Value, flags: &str| {
        let (scene, output) = (folder.path().join("scene.json"), folder.path().join("x.exr"));
        changed_scene("metals.json", &scene, |scene| {
            let camera = scene["camera"].as_object_mut().unwrap();
            camera.remove("vertical_fov_deg");
            camera.insert("horizontal_fov_deg".to_owned(), 40.into());
            scene["film"] = film;
        });
        etalon_line(&format!("render {{}} -o {{}} --spp 1 -q {flags}"), [&scene, &output]).expect(0);
        pixel_bits(&output).0
    };
    let said = pixels_of(serde_json::json!({ "width": 24, "height": 36 }), "");
    assert_eq!(pixels_of(serde_json::json!({ "width": 40, "height": 10 }), "--size 24x36"), said);
}

#[test]
fn more_solids_in_one_place_than_are_tracked_are_warned_of_with_the_limit() {
    let folder = tempfile::tempdir().unwrap();
    let (file, output) = (folder.path().join("onion.json"), folder.path().join("x.exr"));
    let shells = |count: u32| {
        changed_scene("furnace.json", &file, |scene| {
            let shell = |k: u32| {
                serde_json::json!({
                    "shape": { "type": "sphere", "radius_m": 1.0 - 0.01 * f64::from(k) },
                    "material": { "type": "dielectric", "interior": 1.0 + 0.01 * f64::from(k), "priority": k }
                })
            };
            scene["objects"] = (1..=count).map(shell).collect();
        });
        etalon_line("render {} -o {} --size 16x12 --spp 4", [&file, &output]).expect(0).stderr
    };
    assert!(!shells(16).contains("lost-media"));
    let said = shells(17);
    assert!(said.contains("lost-media") && said.contains("more than 16 solids at once"), "{said}");
}
