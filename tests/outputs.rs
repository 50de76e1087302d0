//! Files: found out beforehand whether they can be written, written whole or not at all.

use std::fs;
use std::time::{Duration, Instant};

use crate::support::{command, ends, entries, etalon_line, etalon_that_ends, scene, words};

/// A render that would take minutes, so that a test that waits for it fails by its time.
const LONG: &str = "--spp 1000000 --size 256x256 --threads 1";

#[test]
fn an_output_that_cannot_be_written_fails_before_anything_is_rendered() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene("cornell.json");
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    fs::create_dir(folder.path().join("folder.exr")).unwrap();
    for (output, cause) in [
        ("missing/x.exr", "does not exist"),
        ("missing/x.png", "does not exist"),
        ("file/x.exr", "not a directory"),
        ("folder.exr", "names a folder"),
    ] {
        let start = Instant::now();
        let ran = etalon_line(&format!("render {{}} -o {{}} {LONG}"), [&scene, &folder.path().join(output)]).expect(1);
        assert!(start.elapsed() < Duration::from_secs(20), "it rendered first");
        assert!(ran.stderr.contains(output) && ran.stderr.contains(cause), "{output}: {}", ran.stderr);
        let ran = etalon_line(&format!("render {{}} -o {{}} --json {LONG}"), [&scene, &folder.path().join(output)]);
        let message = ran.expect(1).json()["errors"][0]["message"].as_str().unwrap().to_owned();
        assert!(message.contains(output) && message.contains(cause), "{message}");
    }
    assert_eq!(entries(folder.path()), ["file", "folder.exr"]);
}

#[test]
fn one_run_writes_both_formats_and_says_what_the_png_clipped() {
    let folder = tempfile::tempdir().unwrap();
    let (exr, png) = (folder.path().join("x.exr"), folder.path().join("x.PNG"));
    let line = "render {} -o {} -o {} --spp 1 --size 16x12 --exposure 8";
    let ran = etalon_line(line, [&scene("cornell.json"), &exr, &png]).expect(0);
    assert!(ran.stdout.contains("pixels clipped"), "{}", ran.stdout);
    assert_eq!(entries(folder.path()), ["x.PNG", "x.exr"]);
    let shown = etalon_picture::read_png8(&png).unwrap();
    assert_eq!((shown.width, shown.height), (16, 12));

    // The PNG is the EXR, exposed and encoded.
    let file = etalon_picture::read_exr(&exr).unwrap();
    let (expected, clipping) = etalon_picture::encode_srgb8(&file.picture, 8.0).unwrap();
    assert_eq!(shown, expected);
    let report = etalon_line(&format!("{line} --json"), [&scene("cornell.json"), &exr, &png]).expect(0).json();
    assert_eq!(report["outputs"][0]["clipped_pixels"], serde_json::Value::Null);
    assert_eq!(report["outputs"][1]["clipped_pixels"], clipping.any);
    assert!(clipping.any > 0);
}

#[test]
fn an_exposure_that_nothing_shows_is_worth_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("x.exr");
    let line = "render {} -o {} --spp 1 --size 4x4 --exposure 1 --json";
    let ran = etalon_line(line, [&scene("cornell.json"), &output]).expect(0).says(["--exposure"]);
    assert_eq!(ran.json()["warnings"][0]["code"], "develop-unused");
}

#[test]
fn a_render_that_is_killed_leaves_nothing_under_the_outputs_name() {
    let folder = tempfile::tempdir().unwrap();
    let (new, old) = (folder.path().join("new.exr"), folder.path().join("old.png"));
    fs::write(&old, "the picture of yesterday").unwrap();
    let line = format!("render {{}} -o {{}} -o {{}} {LONG}");
    let mut child = command(words(&line, [&scene("cornell.json"), &new, &old])).spawn().unwrap();
    // Long enough to be in the midst of rendering; the outcome must not depend on where exactly.
    std::thread::sleep(Duration::from_millis(700));
    assert!(child.try_wait().unwrap().is_none(), "the render was to take minutes");
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(entries(folder.path()), ["old.png"]);
    assert_eq!(fs::read_to_string(&old).unwrap(), "the picture of yesterday");
}

#[test]
#[cfg(unix)]
fn named_pipes_are_refused_and_nothing_waits_for_their_other_end() {
    let folder = tempfile::tempdir().unwrap();
    let cornell = scene("cornell.json");
    let pipe = |name: &str| {
        let path = folder.path().join(name);
        assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
        path
    };
    let (exr, png, part) = (pipe("x.exr"), pipe("x.png"), pipe("x.part"));
    let (json, glb, checkpoint) = (pipe("x.json"), pipe("x.glb"), pipe("y.exr.checkpoint"));
    let output = folder.path().join("y.exr");
    for path in [&exr, &png, &part] {
        let line = "render {} -o {} --spp 1 --size 16x12";
        etalon_that_ends(line, [&cornell, path]).expect(1).says(["named pipe"]);
    }
    let model = folder.path().join("model.obj");
    fs::write(&model, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    etalon_that_ends("farm {} --shards 2 --slurm -o {}", [&cornell, &json]).expect(1).says(["named pipe"]);
    etalon_that_ends("import {} -o {}", [&model, &json]).expect(1).says(["named pipe"]);
    etalon_that_ends("explain {}", [&json]).expect(2).says(["not a plain file"]);
    for (line, paths, status) in [
        ("render {} -o {}", [&json, &output], 2),
        ("render {} -o {}", [&glb, &output], 2),
        ("whitted {} -o {}", [&json, &output], 2),
        ("compare {} {}", [&exr, &exr], 2),
        ("merge {} -o {}", [&part, &output], 2),
        ("merge --list {} -o {}", [&part, &output], 2),
    ] {
        let ran = etalon_that_ends(line, paths.map(|path| path.as_path()));
        assert_eq!(ran.status, status, "{line}: {}", ran.stderr);
        assert!(ran.stderr.contains("not a plain file"), "{line}: {}", ran.stderr);
    }
    let line = "render {} -o {} --spp 1 --size 16x12 --resume";
    let ran = etalon_that_ends(line, [&cornell, &output]).expect(1);
    assert!(ran.stderr.contains(checkpoint.to_str().unwrap()), "{}", ran.stderr);
}

#[test]
#[cfg(unix)]
fn a_render_that_nobody_listens_to_any_more_is_finished() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("x.exr");
    let line = "render {} -o {} --spp 64 --size 64x48 --progress openjd";
    let mut child = command(words(line, [&scene("cornell.json"), &output])).spawn().unwrap();
    drop(child.stdout.take());
    let ended = child.wait_with_output().unwrap();
    assert_eq!(ended.status.code(), Some(0), "{}", String::from_utf8_lossy(&ended.stderr));
    assert_eq!(entries(folder.path()), ["x.exr"]);
}

#[test]
#[cfg(target_os = "linux")]
fn a_picture_that_the_limits_of_the_process_do_not_hold_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    // Some 3.2 GB, of which the limits leave 0.6 GB; the machine itself may have them.
    let line =
        words("render {} -o {} --size 5000x4000 --spp 1", [&scene("cornell.json"), &folder.path().join("x.exr")]);
    for limit in ["-v", "-d"] {
        let mut limited = std::process::Command::new("sh");
        let program = env!("CARGO_BIN_EXE_etalon");
        limited.args(["-c", &format!("ulimit {limit} 600000 && exec \"$@\""), "sh", program]).args(&line);
        limited.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped());
        ends(limited).expect(2).says(["of memory, and", "too-large"]);
    }
}
