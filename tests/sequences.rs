//! Sequences of frames: each is the picture that it would be alone, where its keyframes say, and what is finished is kept.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use etalon_picture::Attribute;
use serde_json::{Value, json};

use crate::support::{Ran, changed_scene, command, entries, etalon_line, pixel_bits, scene, signal, words};

/// A scene in which camera and things move all the time.
const TURNTABLE: &str = "turntable.json";
const SMALL: &str = "--size 48x32 --spp 4 --threads 2";

/// The bits of a picture, and what its file says, but for the time that it took.
#[track_caller]
fn picture(path: &Path) -> (Vec<(String, Vec<u32>)>, etalon_picture::Attributes) {
    let (bits, file) = pixel_bits(path);
    let mut attributes = file.attributes;
    attributes.remove("renderTimeSeconds").expect("a render says how long it took");
    (bits, attributes)
}

/// Renders frames of the turntable.
#[track_caller]
fn render(folder: &Path, options: &str) -> Ran {
    let line = format!("render {{}} {SMALL} -o {{}} {options}");
    etalon_line(&line, [&scene(TURNTABLE), &folder.join("f-{frame:03}.exr")])
}

#[test]
fn a_frame_is_the_same_alone_in_a_sequence_and_in_a_share() {
    let [all, other, alone] = [(); 3].map(|()| tempfile::tempdir().unwrap());
    render(all.path(), "--frames 0:6:3,20 --fps 12 --quiet").expect(0);
    assert_eq!(entries(all.path()), ["f-000.exr", "f-003.exr", "f-006.exr", "f-020.exr"]);
    // In another order, by two machines, with other threads.
    for share in ["1/2", "2/2"] {
        let options = format!("--frames 20,3,0,6 --fps 12 --shard {share} --quiet");
        render(other.path(), &options).expect(0);
    }
    for name in entries(all.path()) {
        assert_eq!(picture(&all.path().join(&name)), picture(&other.path().join(&name)), "{name}");
    }
    let line = format!("render {{}} {SMALL} --frames 20 --fps 12 --quiet -o {{}}");
    etalon_line(&line, [&scene(TURNTABLE), &alone.path().join("x.exr")]).expect(0);
    let (_, attributes) = picture(&alone.path().join("x.exr"));
    assert_eq!(attributes["frame"], Attribute::Text("20".to_owned()));
    let rate = Attribute::Other { kind: "rational".to_owned(), bytes: vec![12, 0, 0, 0, 1, 0, 0, 0] };
    assert_eq!(attributes["framesPerSecond"], rate);
    assert_eq!(picture(&alone.path().join("x.exr")), picture(&all.path().join("f-020.exr")));
}

/// Frame 9 at 12 frames a second begins at 0.75 s, exactly.
#[test]
fn a_frame_is_the_still_picture_of_its_shutter_and_seed() {
    let folder = tempfile::tempdir().unwrap();
    let still = folder.path().join("still.json");
    changed_scene(TURNTABLE, &still, |scene| scene["camera"]["shutter_s"] = json!([0.75, 0.77]));
    render(folder.path(), "--frames 9 --fps 12 --seed 5 --quiet").expect(0);
    let line = format!("render {{}} {SMALL} --seed 14 --quiet -o {{}}");
    etalon_line(&line, [&still, &folder.path().join("still.exr")]).expect(0);
    let bits = |name: &str| pixel_bits(&folder.path().join(name)).0;
    assert_eq!(bits("f-009.exr"), bits("still.exr"));
    // With a fixed seed it has the numbers of seed 5.
    render(folder.path(), "--frames 9 --fps 12 --seed 5 --fixed-seed --quiet").expect(0);
    assert_ne!(bits("f-009.exr"), bits("still.exr"));
    etalon_line(&line.replace("--seed 14", "--seed 5"), [&still, &folder.path().join("still.exr")]).expect(0);
    assert_eq!(bits("f-009.exr"), bits("still.exr"));
}

#[test]
fn noise_stands_still_only_if_that_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let bits = |number: u32| pixel_bits(&folder.path().join(format!("{number}.exr"))).0;
    for (fixed, options) in [(false, ""), (true, "--fixed-seed")] {
        let line = format!("render {{}} {SMALL} --frames 1:3 {options} --quiet -o {{}}");
        etalon_line(&line, [&scene("cornell.json"), &folder.path().join("{frame}.exr")]).expect(0);
        assert_eq!(bits(1) == bits(2), fixed, "{options}");
        assert_eq!(bits(2) == bits(3), fixed, "{options}");
    }
}

/// A bright disk that faces the camera, alone in the dark. Its picture is a disk around the projection of its centre.
fn disk_scene(path: &Path, camera: &Value, disk: &Value) {
    let scene = json!({
        "etalon": 1,
        "camera": camera,
        "film": {"width": 64, "height": 48},
        "groups": {"disk": {"objects": [
            {"shape": {"type": "disk", "normal": [0, 0, 1], "radius_m": 0.3}, "material": {"type": "black"}, "emission": {"radiance": 1}}
        ]}},
        "instances": [{"group": "disk", "keyframes": disk}],
        "integrator": {"spp": 64}
    });
    fs::write(path, scene.to_string()).unwrap();
}

/// The centroid of a picture's light, in pixels from the upper left corner.
fn centroid(path: &Path) -> [f64; 2] {
    let (_, file) = pixel_bits(path);
    let light = file.picture.channel("G").unwrap();
    let width = file.picture.width();
    let (mut sum, mut x, mut y) = (0.0, 0.0, 0.0);
    for (i, &value) in light.iter().enumerate() {
        let value = f64::from(value);
        sum += value;
        x += value * ((i % width) as f64 + 0.5);
        y += value * ((i / width) as f64 + 0.5);
    }
    [x / sum, y / sum]
}

/// The edge of the disk crosses about 50 pixels or more. Points in such a pixel miss its covered area by 0.3/√64 of a pixel at most, in the
/// root mean square and as if they were independent, so that the sum of light errs by 0.27 pixels of some 200, and the centroid by that
/// share of the radius of 8 pixels: 0.011 pixels. Six times that is allowed. From frame to frame the disk moves by 1 to 5 pixels.
const CENTROID_PX: f64 = 0.066;

/// From (−1, −0.2, −1) m at 0.5 s to (1, 0.4, 1) m at 2.5 s: towards the camera, which stands at z = 6 m.
#[test]
fn a_disk_that_moves_on_a_line_is_where_its_keyframes_say_in_every_frame() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("disk.json");
    let key = |time_s: f64, to_m: [f64; 3]| json!({"time_s": time_s, "transform": [{"translate_m": to_m}]});
    let keyframes = json!([key(0.5, [-1.0, -0.2, -1.0]), key(2.5, [1.0, 0.4, 1.0])]);
    let camera = json!({"type": "perspective", "position_m": [0, 0, 6], "look_at_m": [0, 0, 0], "vertical_fov_deg": 30,
        "shutter_s": [0.02, 0.02]});
    disk_scene(&path, &camera, &keyframes);
    let line = "render {} --frames 0:24:3 --fps 8 --quiet -o {}";
    etalon_line(line, [&path, &folder.path().join("{frame}.exr")]).expect(0);
    for number in (0..=24).step_by(3) {
        let time_s = f64::from(number) / 8.0 + 0.02;
        let share = ((time_s - 0.5) / 2.0).clamp(0.0, 1.0);
        let [x, y, z] = [-1.0 + 2.0 * share, -0.2 + 0.6 * share, -1.0 + 2.0 * share];
        // Pixels in a unit of the tangent.
        let per_tangent = 24.0 / 15_f64.to_radians().tan();
        let expected = [32.0 + per_tangent * x / (6.0 - z), 24.0 - per_tangent * y / (6.0 - z)];
        let found = centroid(&folder.path().join(format!("{number}.exr")));
        let off = (0..2).map(|k| (found[k] - expected[k]).abs()).fold(0.0, f64::max);
        assert!(off < CENTROID_PX, "frame {number}: {found:?}, not {expected:?}");
    }
}

/// The camera moves along x while the shutter is open, so that the disk is seen where it is in the mean over that time.
#[test]
fn a_camera_with_keyframes_for_the_whole_sequence_sees_the_disk_where_it_should() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("disk.json");
    let camera = json!({"type": "orthographic", "position_m": [0, 0, 6], "look_at_m": [0, 0, 0], "height_m": 3,
        "shutter_s": [-0.05, 0.15],
        "keyframes": [{"time_s": 0, "transform": [{"translate_m": [-1, 0, 0]}]}, {"time_s": 2, "transform": [{"translate_m": [1, 0, 0]}]}]});
    disk_scene(&path, &camera, &json!([{"time_s": 0}]));
    let line = "render {} --frames 1:3 --fps 2 --quiet -o {}";
    etalon_line(line, [&path, &folder.path().join("{frame}.exr")]).expect(0);
    for number in 1..=3 {
        let middle_s = f64::from(number) / 2.0 + 0.05;
        // The disk is at x = 0; 16 pixels are a metre.
        let expected = 32.0 - 16.0 * (middle_s - 1.0);
        let [x, y] = centroid(&folder.path().join(format!("{number}.exr")));
        assert!(
            (x - expected).abs() < CENTROID_PX && (y - 24.0).abs() < CENTROID_PX,
            "frame {number}: {x}, not {expected}"
        );
    }
}

#[test]
fn finished_frames_are_kept_and_those_of_other_settings_refused() {
    let folder = tempfile::tempdir().unwrap();
    let exr = |number: u32| folder.path().join(format!("f-{number:03}.exr"));
    let png = folder.path().join("p-{frame}.png");
    let options = format!("--frames 0:3 --fps 12 -o {}", png.display());
    render(folder.path(), &options).expect(0);
    let whole: Vec<_> = (0..4).map(|number| picture(&exr(number))).collect();
    let bytes = |path: &Path| fs::read(path).unwrap();
    let first = (bytes(&exr(0)), bytes(&folder.path().join("p-0.png")));
    // One of both files of a frame is not enough.
    fs::remove_file(exr(1)).unwrap();
    fs::remove_file(folder.path().join("p-2.png")).unwrap();
    let ran = render(folder.path(), &format!("{options} --resume --json")).expect(0);
    let report = ran.json();
    let skipped: Vec<bool> =
        report["frames"].as_array().unwrap().iter().map(|frame| frame["skipped"] == true).collect();
    assert_eq!(skipped, [true, false, false, true]);
    assert_eq!((bytes(&exr(0)), bytes(&folder.path().join("p-0.png"))), first);
    for (number, whole) in whole.iter().enumerate() {
        assert_eq!(picture(&exr(number as u32)), *whole, "frame {number}");
    }
    assert!(folder.path().join("p-2.png").exists());

    // What is there is none of these.
    for (change, says) in [
        ("--frames 0:3 --fps 24", "frame"),
        ("--frames 0:3 --fps 12 --seed 9", "seed"),
        ("--frames 0:3 --fps 12 --fixed-seed", "seed"),
        ("--frames 0:3 --fps 12 --max-depth 2", "options"),
        ("--frames 0:3 --fps 12 --error 50%", "--adaptive"),
        ("--frames 0:3 --fps 12 --crop 0,0,8,8", "crop"),
        ("--frames 0:3 --fps 12 --aov depth", "--aov"),
    ] {
        let ran = render(folder.path(), &format!("{change} --resume")).expect(2);
        let of_frame_0 = !change.contains("fixed-seed") && !change.contains("fps 24");
        assert!(
            ran.stderr.contains(says) && (!of_frame_0 || ran.stderr.contains("f-000.exr")),
            "{change}: {}",
            ran.stderr
        );
        assert!(ran.stderr.contains("--resume"), "{change}: {}", ran.stderr);
    }
    render(folder.path(), &format!("{options} --resume --exposure 1")).expect(2).says(["p-0.png", "development"]);
    let other = folder.path().join("other.json");
    changed_scene(TURNTABLE, &other, |scene| scene["comment"] = json!("another"));
    let line = format!("render {{}} {SMALL} --frames 0:3 --fps 12 --resume -o {{}}");
    let names = folder.path().join("f-{frame:03}.exr");
    etalon_line(&line, [&other, &names]).expect(2).says(["SHA-256 of the scene"]);
    // A still picture, and a file that is cut short.
    etalon_line(&format!("render {{}} {SMALL} --quiet -o {{}}"), [&scene(TURNTABLE), &exr(0)]).expect(0);
    render(folder.path(), "--frames 0:3 --fps 12 --resume").expect(2).says(["not a finished frame"]);
    fs::write(exr(0), &first.0[..first.0.len() / 2]).unwrap();
    render(folder.path(), "--frames 0:3 --fps 12 --resume").expect(2).says(["f-000.exr"]);
    // Without --resume all are rendered again.
    render(folder.path(), "--frames 0:3 --fps 12 --quiet").expect(0);
    assert_eq!(picture(&exr(0)), whole[0]);
}

#[test]
fn a_signal_keeps_the_finished_frames_and_the_sums_of_the_one_under_way() {
    let [broken, unbroken] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    // A quarter of a second or so a frame.
    let line = "render {} --size 96x64 --spp 128 --threads 2 --frames 0:3 --fps 12 --quiet -o {}";
    let in_folder = |folder: &Path| folder.join("f-{frame}.exr");
    etalon_line(line, [&scene(TURNTABLE), &in_folder(unbroken.path())]).expect(0);
    let mut interrupted = 0;
    for _ in 0..20 {
        let resumed = format!("{line} --resume");
        let mut child = command(words(&resumed, [&scene(TURNTABLE), &in_folder(broken.path())])).spawn().unwrap();
        let finished = || entries(broken.path()).iter().filter(|name| name.ends_with(".exr")).count();
        let (start, before) = (Instant::now(), finished());
        // In the midst of the frame after the next that is finished.
        while finished() <= before && start.elapsed() < Duration::from_secs(60) {
            if child.try_wait().unwrap().is_some() {
                break;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        std::thread::sleep(Duration::from_millis(100));
        if child.try_wait().unwrap().is_none() {
            signal(&child, "INT");
        }
        let output = child.wait_with_output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        match output.status.code() {
            Some(0) => break,
            Some(130) => interrupted += 1,
            other => panic!("{other:?}: {said}"),
        }
        assert!(said.contains("of 4 frames are finished") && said.contains("--resume"), "{said}");
        for name in entries(broken.path()).iter().filter(|name| name.ends_with(".exr")) {
            assert_eq!(picture(&broken.path().join(name)), picture(&unbroken.path().join(name)), "{name}");
        }
    }
    assert!(interrupted > 0, "it was never interrupted: too short for this machine");
    assert_eq!(entries(broken.path()), entries(unbroken.path()));
    for name in entries(unbroken.path()) {
        assert_eq!(picture(&broken.path().join(&name)), picture(&unbroken.path().join(&name)), "{name}");
    }
}

#[test]
fn mistakes_in_frames_and_names_are_found_before_anything_is_rendered() {
    let folder = tempfile::tempdir().unwrap();
    let names =
        [folder.path().join("x-{frame}.exr"), folder.path().join("x.exr"), folder.path().join("x-{frame:q}.exr")];
    let part = folder.path().join("x-{frame}.part");
    for (options, name, says) in [
        ("--frames 5:3", &names[0], "comes before"),
        ("--frames 0:9:0", &names[0], "at least 1"),
        ("--frames a", &names[0], "FIRST:LAST"),
        ("--frames 1,1", &names[0], "twice"),
        ("--frames 0:3 --fps 0", &names[0], "24000/1001"),
        ("--fps 24", &names[1], "--frames"),
        ("--fixed-seed", &names[1], "--frames"),
        ("--frames 0:3", &names[1], "x-{frame:04}.exr"),
        ("--frames 0:3", &names[2], "{frame:q}"),
        ("--frames 0:3", &part, "not rendered in parts"),
        ("", &names[0], "--frames is not given"),
        ("--frames 0:3 --shard 5/5", &names[0], "no frame"),
        ("--frames 0:3 --shard 5/4", &names[0], "share"),
    ] {
        let line = format!("render {{}} {options} -o {{}}");
        etalon_line(&line, [&scene(TURNTABLE), name]).expect(2).says([says]);
    }
    etalon_line("render {} --frames 0:3 --pixel 1,1", [&scene(TURNTABLE)]).expect(2).says(["one frame"]);
    assert_eq!(entries(folder.path()), [""; 0]);
}

/// The disk is in the middle of the picture at 1.5 s, in frame 12, and not in frame 0.
#[test]
fn a_path_of_a_frame_is_one_of_its_picture() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("disk.json");
    let camera = json!({"type": "orthographic", "position_m": [0, 0, 6], "look_at_m": [0, 0, 0], "height_m": 3});
    let key = |time_s: f64, x: f64| json!({"time_s": time_s, "transform": [{"translate_m": [x, 0, 0]}]});
    disk_scene(&path, &camera, &json!([key(0.5, -1.0), key(2.5, 1.0)]));
    let path_of =
        |options: &str| etalon_line(&format!("render {{}} --pixel 32,24 {options}"), [&path]).expect(0).stdout;
    let there = path_of("--frames 12 --fps 8 --seed 2");
    assert!(there.contains("groups.disk.objects[0]"), "{there}");
    assert_eq!(there, path_of("--frames 12 --fps 24/3 --seed 14 --fixed-seed"));
    assert!(!path_of("").contains("groups.disk.objects[0]"));
    assert_eq!(path_of("--frames 0"), path_of(""));
}

#[test]
fn a_sequence_without_a_name_for_its_pictures_has_that_of_its_scene() {
    let folder = tempfile::tempdir().unwrap();
    let mut run = command(words(&format!("render {{}} {SMALL} --frames 0:1"), [&scene(TURNTABLE)]));
    let output = run.current_dir(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(entries(folder.path()), ["turntable-0000.exr", "turntable-0001.exr"]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(
        said.contains("frame 0, 1 of 2,") && said.contains("frame 1, 2 of 2:") && said.contains("remaining"),
        "{said}"
    );
    fs::write(folder.path().join("turntable-0001.exr"), "mine").unwrap();
    let ran = crate::support::ends({
        let mut again = command(words(&format!("render {{}} {SMALL} --frames 0:1"), [&scene(TURNTABLE)]));
        again.current_dir(folder.path());
        again
    });
    ran.expect(1).says(["turntable-0001.exr"]);
}

#[test]
fn progress_for_a_farm_goes_from_the_first_frame_to_the_last() {
    let folder = tempfile::tempdir().unwrap();
    let said = render(folder.path(), "--frames 0:3 --progress openjd").expect(0).stdout;
    let told: Vec<f64> = said.lines().filter_map(|line| line.strip_prefix("openjd_progress: ")?.parse().ok()).collect();
    assert!(told.windows(2).all(|pair| pair[0] <= pair[1]), "{told:?}");
    assert_eq!(told.last(), Some(&100.0));
    assert!(told.iter().any(|&percent| percent > 0.0 && percent <= 25.0), "{told:?}");
}

#[test]
fn a_quote_of_a_sequence_tells_the_total() {
    let line = "quote {} --size 32x24 --frames 0:47 --fps 12 --error 50%,20% --pilot 0.5s --threads 2 --clock cpu";
    let quote = etalon_line(&format!("{line} --json"), [&scene(TURNTABLE)]).expect(0).json();
    let piloted = quote["piloted"].as_array().unwrap();
    let frames: Vec<u64> = piloted.iter().map(|piloted| piloted["frame"].as_u64().unwrap()).collect();
    assert_eq!(frames, [0, 12, 24, 35, 47]);
    for i in 0..2 {
        let sum: f64 = piloted
            .iter()
            .map(|one| one["stands_for"].as_f64().unwrap() * one["quote"]["estimates"][i]["seconds"].as_f64().unwrap())
            .sum();
        let total = quote["estimates"][i]["seconds"].as_f64().unwrap();
        assert!((sum / total - 1.0).abs() < 1e-12 && total > 0.0, "{sum} is not {total}");
    }
    let text = etalon_line(line, [&scene(TURNTABLE)]).expect(0).stdout;
    assert!(text.contains("48 frames of 32 × 24 pixels") && text.contains("0, 12, 24, 35, 47"), "{text}");
}

#[test]
fn farms_render_every_frame_once() {
    let folder = tempfile::tempdir().unwrap();
    let [script, shows]: [PathBuf; 2] = ["job.sh", "shows.sh"].map(|name| folder.path().join(name));
    let picture = folder.path().join("it's {frame:04}.exr");
    let mut arguments =
        words("farm {} --frames 0:99:5 --fps 24000/1001 --shards 7 --slurm --spp 12", [&scene(TURNTABLE)]);
    arguments.extend([
        "-o".to_owned(),
        script.display().to_string(),
        "--picture".to_owned(),
        picture.display().to_string(),
    ]);
    crate::support::etalon(&arguments).expect(0);
    assert!(Command::new("sh").arg("-n").arg(&script).status().unwrap().success());
    fs::write(&shows, "#!/bin/sh\nfor word in \"$@\"; do echo \"$word\"; done\n").unwrap();
    Command::new("chmod").arg("+x").arg(&shows).status().unwrap();
    let task = Command::new("sh").arg(&script).env("ETALON", &shows).env("SLURM_ARRAY_TASK_ID", "3").output().unwrap();
    let said = String::from_utf8(task.stdout).unwrap();
    let given: Vec<&str> = said.lines().collect();
    let name = picture.display().to_string();
    for part in [
        vec!["--frames", "0:99:5", "--fps", "24000/1001"],
        vec!["--shard", "3/7"],
        vec!["-o", &name],
        vec!["--resume"],
        vec!["--spp", "12"],
    ] {
        assert!(given.windows(part.len()).any(|window| window == part), "{part:?} is not in {given:?}");
    }

    let ran = etalon_line("farm {} --frames 0:99:5 --fixed-seed --openjd", [&scene(TURNTABLE)]).expect(0);
    let template = ran.json();
    let steps = template["steps"].as_array().unwrap();
    assert_eq!(steps.len(), 1);
    assert_eq!(steps[0]["parameterSpace"]["taskParameterDefinitions"][0]["range"], "1-20");
    let words: Vec<&str> =
        steps[0]["script"]["actions"]["onRun"]["args"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    let line = words.join(" ");
    for part in ["--frames 0:99:5 --fps 24 --fixed-seed", "--shard {{Task.Param.Share}}/20", "--progress openjd"] {
        assert!(line.contains(part), "{part} is not in {line}");
    }
    let pictures = template["parameterDefinitions"].as_array().unwrap();
    assert!(pictures.iter().any(|one| one["default"].as_str().unwrap().ends_with("turntable-{frame:04}.exr")));

    etalon_line("farm {} --frames 0:3 --shards 5 --slurm", [&scene(TURNTABLE)]).expect(2).says(["5 shares"]);
    let plain = folder.path().join("plain.exr");
    etalon_line("farm {} --frames 0:3 --slurm --picture {}", [&scene(TURNTABLE), &plain])
        .expect(2)
        .says(["{frame:04}"]);
    etalon_line("farm {} --slurm", [&scene(TURNTABLE)]).expect(2).says(["--shards"]);
}
