//! The command `etalon import`: a foreign scene becomes a scene file that shows the same picture.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::support::{entries, etalon_line, pixel_bits};

/// A floor of two triangles, for files of OBJ.
const FLOOR: &str = "mtllib floor.mtl\nv -1 0 -1\nv 1 0 -1\nv -1 0 1\nv 1 0 1\nusemtl paint\nf 1 3 2\nf 2 3 4\n";

/// The same floor in a glTF file, with positions and indices in base 64. `{}` stands for keys of its material.
const GLTF: &str = r#"{ "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
  "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 }] }],
  "materials": [{ "name": "paint", "pbrMetallicRoughness": { "baseColorFactor": [0.6, 0.3, 0.1, 1], "metallicFactor": 0 }{} }],
  "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, 0, -1], "max": [1, 0, 1] },
    { "bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR" }],
  "bufferViews": [{ "buffer": 0, "byteLength": 48 }, { "buffer": 0, "byteOffset": 48, "byteLength": 12 }],
  "buffers": [{ "byteLength": 60, "uri": "data:application/octet-stream;base64,AACAvwAAAAAAAIC/AACAPwAAAAAAAIC/AACAvwAAAAAAAIA/AACAPwAAAAAAAIA/AAACAAEAAQACAAMA" }] }"#;

/// `{}` stands for keys of its material.
const MTL: &str = "newmtl paint\nKd 0.6 0.3 0.1\n{}";

/// `{}` stands for further elements.
const MITSUBA: &str = r#"<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="5"/></integrator>
  <sensor type="perspective"><float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0, 2, 5" target="0, 0, 0" up="0, 1, 0"/></transform></sensor>
  <shape type="obj"><string name="filename" value="parts/floor.obj"/><bsdf type="twosided"><bsdf type="diffuse"/></bsdf></shape>
  <shape type="sphere"><float name="radius" value="0.5"/><bsdf type="roughconductor"><string name="material" value="Au"/></bsdf></shape>
  <emitter type="constant"><float name="radiance" value="0.5"/></emitter>{}
</scene>"#;

/// `{}` stands for further directives.
const PBRT: &str = r#"LookAt 0 2 5  0 0 0  0 1 0
Camera "perspective" "float fov" 40
Integrator "volpath" "integer maxdepth" 5
MakeNamedMedium "haze" "string type" "homogeneous" "float sigma_a" 0.25 "float sigma_s" 0.5
WorldBegin
LightSource "infinite" "rgb L" [0.5 0.6 0.7]
Shape "trianglemesh" "point3 P" [-1 0 -1  1 0 -1  -1 0 1  1 0 1] "integer indices" [0 2 1 1 2 3]
AttributeBegin
MediumInterface "haze" ""
Material "dielectric" "float eta" 1.33
Shape "sphere" "float radius" 0.5
AttributeEnd
{}"#;

/// A foreign scene, and what it may say beyond what a scene of Etalon can.
struct Foreign {
    file: &'static str,
    text: &'static str,
    /// Adds something that is approximated, and something that is left out.
    lossy: &'static str,
    /// Words of their messages.
    approximated: &'static str,
    left_out: &'static str,
    /// How many mesh files its scene has: one of its own, and that of the studio where the model has no light.
    meshes: usize,
}

const ALL: [Foreign; 4] = [
    Foreign {
        file: "floor.obj",
        text: FLOOR,
        lossy: "Tf 0.5 1 1\nillum 4\n",
        approximated: "it becomes opaque",
        left_out: "material \"paint\": Tf is ignored",
        meshes: 2,
    },
    Foreign {
        file: "floor.gltf",
        text: GLTF,
        lossy: r#", "extensions": { "KHR_materials_unlit": {}, "KHR_materials_volume": { "thicknessFactor": 1 },
  "KHR_materials_transmission": { "transmissionFactor": 0.7 } }"#,
        approximated: "it becomes fully transmitting",
        left_out: "the surface is lit like any other",
        meshes: 2,
    },
    Foreign {
        file: "room.xml",
        text: MITSUBA,
        lossy: "\n  <shape type=\"hair\"/>\n  <shape type=\"sphere\"><bsdf type=\"velvet\"/></shape>",
        approximated: "the material \"velvet\" is not known: it becomes grey",
        left_out: "line 8: the shape \"hair\" (curves) is not seen and has no shadow",
        meshes: 1,
    },
    Foreign {
        file: "room.pbrt",
        text: PBRT,
        lossy: "Shape \"curve\"\nMaterial \"velvet\"\nShape \"sphere\"\n",
        approximated: "\"velvet\"",
        left_out: "\"curve\"",
        meshes: 1,
    },
];

/// Writes a scene and the files that it names into a folder.
fn written(foreign: &Foreign, further: &str, folder: &Path) -> PathBuf {
    fs::create_dir_all(folder.join("parts")).unwrap();
    fs::write(folder.join("floor.mtl"), MTL.replace("{}", further)).unwrap();
    fs::write(folder.join("parts/floor.obj"), FLOOR).unwrap();
    let path = folder.join(foreign.file);
    // Braces of JSON stand in pairs, too.
    let text = match foreign.text.rfind("{}") {
        Some(at) => format!("{}{further}{}", &foreign.text[..at], &foreign.text[at + 2..]),
        None => foreign.text.to_owned(),
    };
    fs::write(&path, text).unwrap();
    path
}

/// The pixels of a render of 8 × 8.
fn rendered(scene: &Path, folder: &Path) -> Vec<(String, Vec<u32>)> {
    let picture = folder.join("picture.exr");
    etalon_line("render {} -o {} --spp 4 --seed 11 --size 8x8", [scene, &picture]).expect(0);
    pixel_bits(&picture).0
}

#[test]
fn an_imported_scene_shows_what_the_foreign_file_shows_to_the_bit() {
    for foreign in &ALL {
        for further in ["", foreign.lossy] {
            let (from, to) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
            let model = written(foreign, further, from.path());
            let json = to.path().join("small.json");
            let ran = etalon_line("import {} -o {}", [&model, &json]).expect(0);
            assert!(ran.stderr.is_empty(), "{}: {}", foreign.file, ran.stderr);
            let direct = rendered(&model, from.path());
            let light =
                |(name, bits): &(String, Vec<u32>)| name == "G" && bits.iter().any(|bits| f32::from_bits(*bits) > 0.0);
            assert!(direct.iter().any(light), "{} is black", foreign.file);
            assert!(rendered(&json, to.path()) == direct, "{} {further}", foreign.file);
            // What was imported needs nothing of the model, and may be moved.
            drop(from);
            let moved = tempfile::tempdir().unwrap();
            let elsewhere = moved.path().join("else where");
            fs::rename(to.path(), &elsewhere).unwrap();
            assert!(rendered(&elsewhere.join("small.json"), moved.path()) == direct, "{} moved", foreign.file);
        }
    }
}

#[test]
fn an_imported_mesh_is_a_file_beside_the_scene() {
    for foreign in &ALL {
        let folder = tempfile::tempdir().unwrap();
        let model = written(foreign, "", folder.path());
        let json = folder.path().join("small.json");
        let report = etalon_line("import {} -o {} --json", [&model, &json]).expect(0).json();
        let scene: Value = serde_json::from_str(&fs::read_to_string(&json).unwrap()).unwrap();
        let placed = scene["groups"].as_object().into_iter().flat_map(|groups| groups.values());
        let objects = placed.chain([&scene]).flat_map(|owner| owner["objects"].as_array().unwrap());
        let meshes: Vec<&str> = objects.filter_map(|object| object["shape"]["file"].as_str()).collect();
        assert_eq!(meshes.len(), foreign.meshes, "{}: {scene}", foreign.file);
        for mesh in meshes {
            // A relative path with slashes, whatever the system.
            let name = mesh.strip_prefix("small-files/").unwrap_or_else(|| panic!("{mesh}"));
            assert!(name.ends_with(".ply") && !name.contains(['/', '\\', ':']), "{mesh}");
            let bytes = fs::read(folder.path().join("small-files").join(name)).unwrap();
            assert!(bytes.starts_with(b"ply\n"), "{mesh}");
            assert!(report["files"].as_array().unwrap().iter().any(|file| file == mesh), "{report}");
        }
        assert_eq!(entries(&folder.path().join("small-files")).len(), report["files"].as_array().unwrap().len());
        assert_eq!(report["taken_over"]["meshes"], 1);
    }
}

#[test]
fn strict_fails_where_something_was_lost_and_writes_the_scene_all_the_same() {
    for foreign in &ALL {
        let folder = tempfile::tempdir().unwrap();
        let json = folder.path().join("small.json");
        let model = written(foreign, "", folder.path());
        let line = "import {} -o {} --strict";
        let ran = etalon_line(line, [&model, &json]).expect(0);
        assert!(!ran.stdout.contains("approximated") && !ran.stdout.contains("left out"), "{}", ran.stdout);
        let exact = fs::read(&json).unwrap();
        let model = written(foreign, foreign.lossy, folder.path());
        etalon_line(line, [&model, &json]).expect(1).says(["not-exact", "the scene is written"]);
        assert!(fs::read(&json).unwrap() != exact, "{}", foreign.file);
        etalon_line("explain {}", [&json]).expect(0);
    }
}

#[test]
fn a_table_names_what_was_taken_over_approximated_and_left_out() {
    for foreign in &ALL {
        let folder = tempfile::tempdir().unwrap();
        let (model, json) = (written(foreign, foreign.lossy, folder.path()), folder.path().join("small.json"));
        let ran = etalon_line("import {} -o {}", [&model, &json]).expect(0);
        let line_of = |title: &str, words: &str| {
            let found = ran.stdout.lines().any(|line| line.trim_start().starts_with(title) && line.contains(words));
            assert!(found, "{}: no line `{title} … {words}` in:\n{}", foreign.file, ran.stdout);
        };
        line_of("taken over:", "1 mesh file");
        line_of("taken over:", "object");
        line_of("approximated:", foreign.approximated);
        line_of("left out:", foreign.left_out);
        // The same in the comment of the scene, and for machines.
        let scene: Value = serde_json::from_str(&fs::read_to_string(&json).unwrap()).unwrap();
        let report = etalon_line("import {} -o {} --json", [&model, &json]).expect(0).json();
        for (key, title, words) in
            [("approximated", "approximated: ", foreign.approximated), ("left_out", "left out: ", foreign.left_out)]
        {
            let things = report[key].as_array().unwrap();
            for thing in things {
                let [place, what] = ["place", "what"].map(|key| thing[key].as_str().unwrap());
                let told = format!("{title}{place}: {what}");
                assert!(scene["comment"].as_array().unwrap().iter().any(|line| *line == told), "{told}\n{scene}");
            }
            let names = |thing: &Value| format!("{}: {}", thing["place"], thing["what"]).replace(['\\', '"'], "");
            let words = words.replace('"', "");
            assert!(things.iter().any(|thing| names(thing).contains(&words)), "{words}: {report}");
        }
    }
}

/// A scene of Etalon is no model: there is nothing to convert, and it stays as it is.
#[test]
fn a_scene_is_not_imported_again() {
    let folder = tempfile::tempdir().unwrap();
    let (model, json) = (written(&ALL[2], "", folder.path()), folder.path().join("small.json"));
    etalon_line("import {} -o {}", [&model, &json]).expect(0);
    let before = fs::read(&json).unwrap();
    etalon_line("import {} -o {}", [&json, &folder.path().join("again.json")]).expect(2).says([".json cannot be read"]);
    assert_eq!(fs::read(&json).unwrap(), before);
    assert!(!folder.path().join("again.json").exists());
}
