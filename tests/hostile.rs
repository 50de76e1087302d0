//! Files that once ended the program, took all memory or never came to an end: each is read, or refused, within 10 s of
//! processor time and 1 GiB of address space, and never by a panic or a signal.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use serde_json::json;

use crate::support::{changed_scene, words};

/// Memory and time of one run: 1 GiB, 10 s of processor time.
const BOUNDS: &str = "ulimit -v 1048576 && ulimit -t 10 && exec \"$0\" \"$@\"";
/// A run that waits for something that never comes uses no processor time.
const PATIENCE: Duration = Duration::from_secs(300);

/// Runs the program within the bounds; what it says on standard error.
#[track_caller]
fn bounded<const N: usize>(line: &str, paths: [&Path; N], statuses: &[i32]) -> String {
    let mut command = Command::new("sh");
    command.args(["-c", BOUNDS, env!("CARGO_BIN_EXE_etalon")]).args(words(line, paths));
    command.env("NO_COLOR", "1").env("RAYON_NUM_THREADS", "2").current_dir(env!("CARGO_TARGET_TMPDIR"));
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("sh starts");
    let mut stderr = child.stderr.take().expect("it is piped");
    let said = std::thread::spawn(move || {
        let mut bytes = Vec::new();
        stderr.read_to_end(&mut bytes).map(|_| String::from_utf8_lossy(&bytes).into_owned())
    });
    let began = Instant::now();
    let ended: ExitStatus = loop {
        if let Some(ended) = child.try_wait().expect("it can be waited for") {
            break ended;
        }
        if began.elapsed() > PATIENCE {
            child.kill().expect("it can be ended");
        }
        std::thread::sleep(Duration::from_millis(10));
    };
    let said = said.join().expect("it was read").expect("it can be read");
    let head: String = said.chars().take(2000).collect();
    assert!(
        ended.code().is_some_and(|code| statuses.contains(&code)),
        "{line} {paths:?}: {ended}, not {statuses:?}:\n{head}"
    );
    assert!(said.len() < 100_000, "{line} {paths:?}: {} bytes of messages", said.len());
    said
}

/// Gives a file to the commands that read its kind, which are to end with one of these statuses.
#[track_caller]
fn check(path: &Path, folder: &Path, statuses: &[i32]) {
    let (picture, scene) = (folder.join("picture.exr"), folder.join("scene.json"));
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("json") => {
            bounded("render {} -o {} --spp 4 --size 32x24 --threads 2", [path, &picture], statuses);
        }
        Some("exr") => {
            bounded("compare {} {}", [path, path], statuses);
            bounded("explain {}", [&under_a_sky(path, folder)], &[0, 2]);
        }
        _ => {
            bounded("import {} -o {}", [path, &scene], statuses);
            bounded("render {} -o {} --spp 4 --size 32x24 --threads 2", [path, &picture], statuses);
        }
    }
}

/// A scene with a picture as its sky.
fn under_a_sky(path: &Path, folder: &Path) -> PathBuf {
    std::fs::copy(path, folder.join("sky.exr")).unwrap();
    let scene = folder.join("sky.json");
    changed_scene("cornell.json", &scene, |scene| {
        scene["lights"] = json!([{ "type": "environment", "image": { "file": "sky.exr" } }]);
    });
    scene
}

#[test]
#[allow(clippy::print_stdout)] // A test that checks less than it could says so.
fn files_that_broke_the_program_are_rendered_or_refused_within_bounds() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/cases");
    let Ok(entries) = std::fs::read_dir(&cases) else {
        println!("{} is missing: only the files that the next test makes are checked", cases.display());
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    for path in entries.map(|entry| entry.unwrap().path()) {
        let statuses: &[i32] = match path.file_name().and_then(|name| name.to_str()).unwrap() {
            "coplanar-mask.json" | "spot-through-prism.json" | "oneline-valid-scene-with-warning-panics.json" => &[0],
            "cyc.xml" | "cyc1.xml" | "dbl.xml" | "dd.xml" | "mixd.pbrt" | "dwa-abort.exr" => &[2],
            // Compared with itself: what is not finite differs from all values.
            "allnan.exr" => &[1],
            "ca.exr" => &[0],
            _ => &[0, 1, 2],
        };
        check(&path, folder.path(), statuses);
    }
    if cases.join("ca.exr").exists() {
        bounded("compare {} {}", [&cases.join("ca.exr"), &cases.join("allnan.exr")], &[1]);
    }
}

/// An EXR file of 4 × 4 pixels in one chunk of DWA, which says that its first section unpacks to `claim` bytes.
fn dwa(claim: u64) -> Vec<u8> {
    let mut file = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        file.extend_from_slice(format!("{name}\0{kind}\0").as_bytes());
        file.extend_from_slice(&(value.len() as u32).to_le_bytes());
        file.extend_from_slice(value);
    };
    let ints = |list: &[u32]| list.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    // Of 32-bit floats, none left out.
    let channel = |name: &str| [name.as_bytes(), &[0], &ints(&[2, 0, 1, 1])].concat();
    attribute("channels", "chlist", &[channel("B"), channel("G"), channel("R"), vec![0]].concat());
    attribute("compression", "compression", &[8]);
    attribute("dataWindow", "box2i", &ints(&[0, 0, 3, 3]));
    attribute("displayWindow", "box2i", &ints(&[0, 0, 3, 3]));
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &1_f32.to_le_bytes());
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1_f32.to_le_bytes());
    file.push(0);
    let chunk = file.len() as u64 + 8;
    file.extend_from_slice(&chunk.to_le_bytes());
    file.extend_from_slice(&ints(&[0, 88]));
    file.extend([0, claim, 0, 0, 0, 0, 0, 0, 0, 0, 0].iter().flat_map(|counter: &u64| counter.to_le_bytes()));
    file
}

/// Files of the same kinds as those that broke the program, by name, with the exit status that they call for.
fn made() -> Vec<(&'static str, Vec<u8>, i32)> {
    let sphere = "<shape type=\"sphere\"><ref id=\"m0\"/></shape>";
    let mitsuba = |elements: &str| format!("<scene version=\"3.0.0\">{elements}{sphere}</scene>");
    let rows = |count: usize, row: &dyn Fn(usize) -> String| (1..=count).map(row).collect::<String>();
    let grey = "<bsdf type=\"diffuse\" id=\"m0\"/>";
    let mask = |i: usize| format!("<bsdf type=\"mask\" id=\"m{}\"><ref id=\"m{i}\"/></bsdf>", i - 1);
    let blend =
        |i: usize| format!("<bsdf type=\"blendbsdf\" id=\"m{0}\"><ref id=\"m{i}\"/><ref id=\"m{i}\"/></bsdf>", i - 1);
    let parameter = |i: usize| format!("<default name=\"a{i}\" value=\"$a{0}$a{0}\"/>", i - 1);
    let mix = |i: usize| {
        let of = i - 1;
        format!("MakeNamedMaterial \"m{i}\" \"string type\" \"mix\" \"string materials\" [\"m{of}\" \"m{of}\"]\n")
    };
    let numbers = rows(10_000, &|i| format!("{} 0.5 ", 300 + i));
    vec![
        ("cycle.xml", mitsuba("<bsdf type=\"twosided\" id=\"m0\"><ref id=\"m0\"/></bsdf>"), 2),
        ("chain.xml", mitsuba(&rows(100_000, &mask)), 2),
        ("doubling.xml", mitsuba(&format!("{}<bsdf type=\"diffuse\" id=\"m40\"/>", rows(40, &blend))), 2),
        ("parameters.xml", mitsuba(&format!("<default name=\"a0\" value=\"0123456789\"/>{grey}{}", rows(40, &parameter))), 2),
        ("mix.pbrt", format!("WorldBegin MakeNamedMaterial \"m0\" {} Shape \"sphere\"", rows(40, &mix)), 2),
        (
            "saved.pbrt",
            format!(
                "WorldBegin Material \"diffuse\" \"spectrum reflectance\" [{numbers}] {} Shape \"sphere\"",
                "AttributeBegin ".repeat(60_000)
            ),
            0,
        ),
        ("names.pbrt", format!("WorldBegin {} Shape \"sphere\"", "MakeNamedMaterial \"a\" ".repeat(100_000)), 0),
        (
            "minified.json",
            {
                let points = rows(20_000, &|i| format!("[{i},{},0],", i % 7));
                let mesh = format!(
                    "{{\"type\":\"mesh\",\"vertices_m\":[{points}[0,0,0]],\"triangles\":[[0,1,8],[3,3,3]]}}"
                );
                format!(
                    "{{\"etalon\":1,\"camera\":{},\"film\":{{\"width\":8,\"height\":8}},\"materials\":{},\"objects\":\
                     [{{\"material\":\"m\",\"shape\":{mesh}}}]}}",
                    json!({ "type": "perspective", "position_m": [0, 0, 9], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40 }),
                    json!({ "m": { "type": "lambert", "reflectance": 0.5 } }),
                )
            },
            0,
        ),
    ]
    .into_iter()
    .map(|(name, text, status)| (name, text.into_bytes(), status))
    .chain([("dwa.exr", dwa(1 << 40), 2)])
    .collect()
}

#[test]
fn files_made_to_break_the_program_are_rendered_or_refused_within_bounds() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes, status) in made() {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        check(&path, folder.path(), &[status]);
    }
    let said = bounded("explain {}", [&under_a_sky(&folder.path().join("dwa.exr"), folder.path())], &[2]);
    assert!(said.contains("values; at most"), "{said}");
}

#[test]
fn many_groups_materials_and_meshes_take_linear_time() {
    let folder = tempfile::tempdir().unwrap();
    let count = 100_000;
    let path = folder.path().join("groups.obj");
    let groups: String = (0..count).map(|i| format!("g g{i}\nusemtl m{i}\nf 1 2 3\n")).collect();
    std::fs::write(&path, format!("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{groups}")).unwrap();
    let library: String = (0..count).map(|i| format!("newmtl m{i}\nKd 0.5 0.5 0.5\n")).collect();
    std::fs::write(folder.path().join("m.mtl"), library).unwrap();
    bounded("explain {}", [&path], &[0]);
}
