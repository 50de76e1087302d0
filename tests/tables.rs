//! Tables of rough surfaces that are kept between runs.

use std::fs;
use std::path::{Path, PathBuf};

use tempfile::tempdir;

use crate::support::{command, pixel_bits, words};

/// Rough plastic, metal and glass under a sky.
const SCENE: &str = r#"{
    "etalon": 1,
    "camera": {"type": "perspective", "position_m": [0, 0, 9], "look_at_m": [0, 0, 0], "vertical_fov_deg": 30},
    "film": {"width": 12, "height": 4},
    "materials": {
        "plastic": {"type": "plastic", "reflectance": 0.5, "alpha": 0.3},
        "metal": {"type": "conductor", "metal": "Au", "alpha": 0.4},
        "glass": {"type": "dielectric", "interior": 1.5, "exterior": 1.0, "alpha": 0.35}
    },
    "objects": [
        {"shape": {"type": "sphere", "radius_m": 1, "center_m": [-2.5, 0, 0]}, "material": "plastic"},
        {"shape": {"type": "sphere", "radius_m": 1}, "material": "metal"},
        {"shape": {"type": "sphere", "radius_m": 1, "center_m": [2.5, 0, 0]}, "material": "glass"}
    ],
    "lights": [{"type": "environment", "radiance": 1}]
}"#;

/// What a render left: its status, what it said, and the bits of its channels.
type Ran = (Option<i32>, String, Vec<(String, Vec<u32>)>);

/// The status of a render whose tables are kept in `tables`, what it says, and the pixels.
fn render(tables: &Path, more: &str, folder: &Path) -> Ran {
    let (scene, output) = (folder.join("scene.json"), folder.join("out.exr"));
    fs::write(&scene, SCENE).unwrap();
    fs::remove_file(&output).ok();
    let mut program = command(words(&format!("render {{}} -o {{}} --spp 2 --quiet {more}"), [&scene, &output]));
    let ran = program.env("ETALON_TABLES", tables).output().expect("the program starts");
    let pixels = if output.exists() { pixel_bits(&output).0 } else { Vec::new() };
    (ran.status.code(), String::from_utf8(ran.stderr).unwrap(), pixels)
}

/// All files in the folders of a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let within = |folder: &Path| fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect::<Vec<_>>();
    let mut files: Vec<PathBuf> = within(folder).iter().flat_map(|folder| within(folder)).collect();
    files.sort();
    files
}

#[test]
fn kept_tables_change_no_bit_of_a_picture_and_broken_ones_are_made_anew() {
    let folder = tempdir().unwrap();
    let tables = folder.path().join("tables");
    for more in ["", "--polarised"] {
        let without = render(Path::new(""), more, folder.path());
        assert_eq!(without.0, Some(0), "{}", without.1);
        assert_eq!(render(&tables, more, folder.path()), without, "while they are made");
        let kept = files(&tables);
        // Metal, the coat of plastic, glass from outside and inside.
        assert!(kept.len() >= 4, "{kept:?}");
        let bytes: Vec<Vec<u8>> = kept.iter().map(|path| fs::read(path).unwrap()).collect();
        let written = || kept.iter().map(|path| fs::metadata(path).unwrap().modified().unwrap()).collect::<Vec<_>>();
        let before = written();
        assert_eq!(render(&tables, more, folder.path()), without, "read");
        assert_eq!((files(&tables), written()), (kept.clone(), before), "nothing is written a second time");
        for (k, path) in kept.iter().enumerate() {
            fs::write(path, &bytes[k][..bytes[k].len() - 8 * (k % 3 + 1) + k % 2]).unwrap();
        }
        assert_eq!(render(&tables, more, folder.path()), without, "made anew");
        assert_eq!(kept.iter().map(|path| fs::read(path).unwrap()).collect::<Vec<_>>(), bytes, "mended");
    }
}

#[test]
fn a_folder_that_cannot_be_one_is_an_error() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let (status, said, pixels) = render(&file, "", folder.path());
    assert_eq!(status, Some(2), "{said}");
    assert!(said.contains("ETALON_TABLES") && said.contains("cannot keep tables") && pixels.is_empty(), "{said}");
}
