//! What the program does where the command line does not say it.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::Stdio;

use crate::support::{Ran, command, ends, entries, etalon_line, pixel_bits, scene, words};

/// Runs the program in a folder.
fn in_folder<const N: usize>(folder: &Path, line: &str, paths: [&Path; N]) -> Ran {
    let mut command = command(words(line, paths));
    command.current_dir(folder);
    ends(command)
}

/// Makes a file.
type Make = fn(&Path);

const SMALL: &str = "--spp 1 --size 4x4";

#[test]
fn a_picture_without_a_name_is_named_after_its_scene_and_replaces_only_pictures_of_etalon() {
    let folder = tempfile::tempdir().unwrap();
    let (at, cornell) = (folder.path(), scene("cornell.json"));
    let ran = in_folder(at, &format!("render {{}} {SMALL}"), [&cornell]).expect(0);
    assert!(ran.stdout.contains("cornell.exr"), "{}", ran.stdout);
    assert_eq!(entries(at), ["cornell.exr"]);
    // Its own picture is replaced.
    let before = fs::read(at.join("cornell.exr")).unwrap();
    in_folder(at, &format!("render {{}} {SMALL} --seed 7"), [&cornell]).expect(0);
    assert_ne!(fs::read(at.join("cornell.exr")).unwrap(), before);

    // Nothing else is: text, a picture by another program, a folder, a link.
    let foreign: [(&str, Make); 4] = [
        ("text", |path| fs::write(path, "notes").unwrap()),
        ("picture", |path| {
            let picture = etalon_picture::Picture::from_rgb(1, 1, &[[1.0; 3]]).unwrap();
            etalon_picture::write_exr(path, &picture, &etalon_picture::Attributes::default()).unwrap();
        }),
        ("folder", |path| fs::create_dir(path).unwrap()),
        ("link", |path| {
            #[cfg(unix)]
            std::os::unix::fs::symlink("nowhere", path).unwrap();
            #[cfg(not(unix))]
            fs::write(path, "notes").unwrap();
        }),
    ];
    for (what, make) in foreign {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cornell.exr");
        make(&path);
        let before = fs::read(&path).ok();
        in_folder(folder.path(), &format!("render {{}} {SMALL}"), [&cornell])
            .expect(1)
            .says(["cornell.exr", "-o FILE"]);
        assert_eq!(fs::read(&path).ok(), before, "{what}");
        assert_eq!(entries(folder.path()), ["cornell.exr"], "{what}");
    }
}

#[test]
fn a_scene_comes_from_standard_input() {
    let folder = tempfile::tempdir().unwrap();
    let run = |text: &str, line: &str| {
        let mut command = command(words(line, []));
        let mut child = command.current_dir(folder.path()).stdin(Stdio::piped()).spawn().unwrap();
        child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
        let output = child.wait_with_output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Ran { status: output.status.code().unwrap(), stdout: text(output.stdout), stderr: text(output.stderr) }
    };
    let cornell = scene("cornell.json");
    run(&fs::read_to_string(&cornell).unwrap(), &format!("render - {SMALL}")).expect(0);
    assert_eq!(entries(folder.path()), ["scene.exr"]);
    let file = folder.path().join("file.exr");
    etalon_line(&format!("render {{}} -o {{}} {SMALL}"), [&cornell, &file]).expect(0);
    assert_eq!(pixel_bits(&folder.path().join("scene.exr")).0, pixel_bits(&file).0);
    // A mistake has its place.
    run("{\"camera\": 3}", &format!("render - {SMALL}")).expect(2).says(["standard input", "camera"]);
}

#[test]
fn numbers_and_paths_have_their_usual_forms() {
    let folder = tempfile::tempdir().unwrap();
    let (file, cornell) = (folder.path().join("x.exr"), scene("cornell.json"));
    let ran = etalon_line("render {} -o {} --spp 1e1 --size 4x4 --json", [&cornell, &file]).expect(0);
    assert_eq!(ran.json()["spp"], 10);
    let (first, without) = ("render {} --pixel 1,1 --sample 0", "render {} --pixel 1,1");
    assert_eq!(etalon_line(first, [&cornell]).expect(0).stdout, etalon_line(without, [&cornell]).expect(0).stdout);
    etalon_line("render {} -o {} --error 2", [&cornell, &file]).expect(2).says(["2%", "0.02"]);
}

#[test]
fn channels_that_no_output_can_hold_are_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let (png, exr, cornell) = (folder.path().join("x.png"), folder.path().join("x.exr"), scene("cornell.json"));
    for option in ["--aov depth", "--bands 450:650:100"] {
        let name = option.split(' ').next().unwrap();
        let ran = etalon_line(&format!("render {{}} -o {{}} {SMALL} {option}"), [&cornell, &png]).expect(2);
        assert!(ran.stderr.contains(name) && ran.stderr.contains("-o NAME.exr"), "{}", ran.stderr);
        assert_eq!(entries(folder.path()), [""; 0]);
    }
    etalon_line(&format!("render {{}} -o {{}} -o {{}} {SMALL} --aov depth"), [&cornell, &png, &exr]).expect(0);
}

#[test]
fn a_png_is_compared_as_it_looks() {
    let folder = tempfile::tempdir().unwrap();
    let (one, two, cornell) = (folder.path().join("one.png"), folder.path().join("two.png"), scene("cornell.json"));
    etalon_line(&format!("render {{}} -o {{}} {SMALL}"), [&cornell, &one]).expect(0);
    etalon_line(&format!("render {{}} -o {{}} {SMALL} --exposure 1"), [&cornell, &two]).expect(0);
    let equal = etalon_line("compare {} {}", [&one, &one]).expect(0).stdout;
    assert!(equal.contains("all values are equal"), "{equal}");
    // It knows no errors, so a difference is not tested.
    let untested = etalon_line("compare {} {}", [&one, &two]).expect(3).stdout;
    assert!(untested.contains("no channel Error."), "{untested}");
}
