//! Mesh files: what is right arrives as it is written, what is wrong is refused with its place.

use crate::common::{Parts, RIGHT};
use etalon_scene::mesh::{Cut, Part, read_obj, read_ply, write_ply};
use etalon_scene::{Code, Loaded, Mesh, NamedFile, SceneErrors, Shape};
use proptest::prelude::*;
use std::path::Path;

const SQUARE: [[f64; 3]; 4] = [[0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [1.0, 2.0, 0.5], [0.0, 2.0, 0.5]];

/// A square of one quadrilateral, in each encoding, with normals, texture coordinates and a property of no use.
fn square(encoding: &str) -> Vec<u8> {
    let mut header = format!("ply\r\nformat {encoding} 1.0\r\nelement vertex 4\r\n").replace('\r', "");
    for name in ["x", "y", "z", "quality", "nx", "ny", "nz", "s", "t"] {
        let kind = if name == "x" { "double" } else { "float" };
        header += &format!("property {kind} {name}\n");
    }
    header += "element face 1\nproperty list uchar ushort vertex_index\nend_header\n";
    let mut bytes = header.into_bytes();
    for [x, y, z] in SQUARE {
        let rest = [y as f32, z as f32, 7.0, 0.0, 0.0, 2.0, x as f32, y as f32 / 2.0];
        match encoding {
            "ascii" => {
                let words: Vec<String> = rest.iter().map(ToString::to_string).collect();
                bytes.extend(format!("{x} {}\n", words.join(" ")).bytes());
            }
            "binary_little_endian" => {
                bytes.extend(x.to_le_bytes());
                bytes.extend(rest.iter().flat_map(|v| v.to_le_bytes()));
            }
            _ => {
                bytes.extend(x.to_be_bytes());
                bytes.extend(rest.iter().flat_map(|v| v.to_be_bytes()));
            }
        }
    }
    match encoding {
        "ascii" => bytes.extend(b"4 0 1 2 3\n"),
        "binary_little_endian" => bytes.extend([4, 0, 0, 1, 0, 2, 0, 3, 0]),
        _ => bytes.extend([4, 0, 0, 0, 1, 0, 2, 0, 3]),
    }
    bytes
}

#[test]
fn a_ply_file_means_the_same_in_each_encoding() {
    let expected = Mesh {
        vertices: SQUARE.to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        normals: vec![[0.0, 0.0, 1.0]; 4],
        uvs: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        colours: Vec::new(),
    };
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let part = read_ply(&square(encoding)).unwrap_or_else(|error| panic!("{encoding}: {error}"));
        assert_eq!(part, Part { mesh: expected.clone(), faces: 1, ..Part::default() }, "{encoding}");
    }
}

#[test]
fn colours_of_a_ply_file_are_linear_or_have_the_curve_of_srgb() {
    let file = |kind: &str, names: [&str; 3], corners: &str, faces: &str, face: &str| {
        let properties: String = names.iter().map(|name| format!("property {kind} {name}\n")).collect();
        let (of_vertices, of_faces) =
            if faces.is_empty() { (properties, String::new()) } else { (String::new(), properties) };
        format!(
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n{of_vertices}element face 1\n\
             property list uchar int vertex_indices\n{of_faces}end_header\n0 0 0{corners}\n1 0 0{corners}\n1 1 0{corners}\n0 1 0{corners}\n4 0 1 2 3{face}\n"
        )
    };
    // (188/255) of the curve of sRGB is half of the light, to three digits.
    let decoded = |value: f64| ((value + 0.055) / 1.055).powf(2.4) as f32;
    for (kind, names, values, want) in [
        ("float", ["red", "green", "blue"], " 0.25 0.5 1.5", [0.25, 0.5, 1.5]),
        ("double", ["r", "g", "b"], " 0.25 0.5 1.5", [0.25, 0.5, 1.5]),
        ("float", ["color_0", "color_1", "color_2"], " 0.25 0.5 1.5", [0.25, 0.5, 1.5]),
        ("uchar", ["red", "green", "blue"], " 0 188 255", [0.0, decoded(188.0 / 255.0), 1.0]),
        ("ushort", ["r", "g", "b"], " 0 40000 65535", [0.0, decoded(40000.0 / 65535.0), 1.0]),
    ] {
        let of_vertices = read_ply(file(kind, names, values, "", "").as_bytes()).expect("a mesh");
        assert_eq!((of_vertices.mesh.colours.len(), of_vertices.face_colours.len()), (4, 0));
        let near = |found: [f32; 3]| (0..3).all(|c| (found[c] - want[c]).abs() < 1e-6);
        assert!(of_vertices.mesh.colours.iter().all(|found| near(*found)), "{kind}: {:?}", of_vertices.mesh.colours);
        // Both triangles of a face have its colour.
        let of_faces = read_ply(file(kind, names, "", "faces", values).as_bytes()).expect("a mesh");
        assert_eq!((of_faces.mesh.colours.len(), of_faces.face_colours.len()), (0, 2));
        assert!(of_faces.face_colours.iter().all(|found| near(*found)), "{kind}: {:?}", of_faces.face_colours);
        assert!(of_faces.left_out.is_empty(), "{:?}", of_faces.left_out);
    }
}

#[test]
fn a_ply_file_cut_off_anywhere_is_refused() {
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let whole = square(encoding);
        // An ASCII file may lack its last line's end.
        for length in 0..whole.len() - usize::from(encoding == "ascii") {
            let cut = read_ply(&whole[..length]);
            // Digits cut from a number leave a number; the last index of the face may so become another.
            assert!(
                cut.is_err() || encoding == "ascii" && length + 2 > whole.len(),
                "{encoding}: {length} bytes: {cut:?}"
            );
        }
    }
}

fn ascii(vertices: &str, faces: &str, counts: [&str; 2]) -> Vec<u8> {
    format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n{vertices}{faces}",
        counts[0], counts[1]
    )
    .into_bytes()
}

#[test]
fn what_is_wrong_with_a_ply_file_is_said_with_its_line_and_element() {
    let corners = "0 0 0\n1 0 0\n0 1 0\n";
    let cases: [(Vec<u8>, &str); 10] = [
        (b"obj".to_vec(), "line 1: it does not begin with \"ply\""),
        (b"ply\nformat ascii 1.0\n".to_vec(), "no \"end_header\" in its first 21 bytes"),
        (ascii(corners, "3 0 1 3\n", ["3", "1"]), "line 13: face 0 names vertex 3; there are 3, counted from 0"),
        (ascii(corners, "3 0 1 -1\n", ["3", "1"]), "line 13: face 0 names vertex -1"),
        (ascii("0 0 0\n1 1e999 0\n0 1 0\n", "3 0 1 2\n", ["3", "1"]), "line 11: vertex 1 lies at [1.0, inf, 0.0]"),
        (ascii("0 0 0\n1 x 0\n0 1 0\n", "3 0 1 2\n", ["3", "1"]), "line 11: Couldn't read element line."),
        (
            ascii(corners, "", ["3", "99999999999"]),
            "its header promises 99999999999 elements \"face\", but 0 bytes are too few for them",
        ),
        (ascii(corners, "4000000000 0\n", ["3", "1"]), "line 13: Couldn't read element line."),
        (
            b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n".to_vec(),
            "its vertices have no property \"z\"",
        ),
        (
            b"ply\nformat binary_little_endian 1.0\nelement nothing 1000000000000\nend_header\n".to_vec(),
            "its 1000000000000 elements \"nothing\" have no properties",
        ),
    ];
    for (bytes, expected) in cases {
        let error = read_ply(&bytes).expect_err(expected).to_string();
        assert!(error.starts_with(expected), "{error}\nis not\n{expected}");
    }
}

const OBJ: &str = "\
# two squares and a triangle
mtllib paints.mtl
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
vt 0 0
vt 1 1
vn 0 0 3
g front left
usemtl red
f 1/1/1 2/2/1 3/2/1 4/1/1
usemtl blue
f -4 -3 -2
g back
f 4//1 3//1 2//1
";

#[test]
fn an_obj_file_gives_a_part_for_each_group_and_material() {
    let library = |path: &Path| match path.to_str() {
        Some("paints.mtl") => Ok(b"newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n".to_vec()),
        _ => Err("no such library".to_owned()),
    };
    let obj = read_obj(OBJ.as_bytes(), Cut::Outline, library).unwrap();
    let names: Vec<_> =
        obj.parts.iter().map(|p| (p.name.as_deref().unwrap(), p.material.as_deref().unwrap())).collect();
    assert_eq!(names, [("front left", "red"), ("front left", "blue"), ("back", "blue")]);
    let red = &obj.parts[0].mesh;
    assert_eq!(red.vertices, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(red.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(red.normals, [[0.0, 0.0, 1.0]; 4]);
    assert_eq!(red.uvs, [[0.0, 0.0], [1.0, 1.0], [1.0, 1.0], [0.0, 0.0]]);
    assert_eq!((obj.parts[1].mesh.normals.len(), obj.parts[2].mesh.uvs.len()), (0, 0));
    assert_eq!(obj.materials.len(), 2);
    assert_eq!(obj.missing_libraries, Vec::<String>::new());

    let lost = read_obj(OBJ.as_bytes(), Cut::Outline, |_| Err("gone".to_owned())).unwrap();
    assert_eq!(lost.missing_libraries, ["gone"]);
    assert_eq!(lost.parts.iter().map(|p| p.mesh.triangles.len()).sum::<usize>(), 4);
}

#[test]
fn what_is_wrong_with_an_obj_file_is_said_with_its_line() {
    for (text, expected) in [
        ("v 0 0 0\nv 1 x 0\n", "line 2: "),
        ("v 0 0 0\nf 1 2 9\nv 1 1 1\n", "line 3: "),
        // The library that reads OBJ files takes such numbers modulo 2⁶⁴ (a fuzzer found it).
        (
            "v 0 0 0\nvt 0 0\nf 1/-1 1/1 1/-3\n",
            "line 3: a face names texture coordinate -3, where there are only 1 so far",
        ),
        ("v 0 0 0\nf 1//9223372036854775807 1 1\n", "line 2: a face names normal 9223372036854775807, more than"),
        ("v 0 0 0\nf 1 0 1\n", "line 2: a face names vertex 0, but the first has the number 1"),
        ("v 0 0 0\nv nan 0 0\nv 1 1 1\nf 1 2 3\n", "its faces: vertex 1 lies at [NaN, 0.0, 0.0]"),
    ] {
        let error = read_obj(text.as_bytes(), Cut::Outline, |_| Ok(Vec::new())).expect_err(expected).to_string();
        assert!(error.starts_with(expected), "{error}\nis not\n{expected}");
    }
}

fn scene_with(shape: &str, folder: &Path) -> Result<Loaded, SceneErrors> {
    let objects =
        format!("[{{\"shape\": {shape}, \"material\": \"white\"}}, {{\"shape\": {shape}, \"material\": \"white\"}}]");
    etalon_scene::parse_in(&Parts { objects: &objects, ..RIGHT }.text(), "test.json", Some(folder), None)
}

#[test]
fn a_scene_reads_a_mesh_file_once_and_remembers_its_hash() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("square.ply"), square("ascii")).unwrap();
    let loaded = scene_with(r#"{"type": "mesh", "file": "square.ply"}"#, folder.path()).unwrap();
    let [Shape::Mesh(a), Shape::Mesh(b)] = [&loaded.scene.objects[0].shape, &loaded.scene.objects[1].shape] else {
        panic!("meshes")
    };
    assert!(std::sync::Arc::ptr_eq(a, b));
    assert_eq!((a.normals.len(), a.triangles.len()), (4, 2));
    assert_eq!(loaded.files.len(), 1);
    assert_eq!(loaded.files[0].name, "square.ply");
    let first = loaded.files[0].sha256.clone();
    std::fs::write(folder.path().join("square.ply"), square("binary_big_endian")).unwrap();
    let other = scene_with(r#"{"type": "mesh", "file": "square.ply", "shading": "flat"}"#, folder.path()).unwrap();
    assert_ne!(other.files[0].sha256, first);
    let Shape::Mesh(flat) = &other.scene.objects[0].shape else { panic!("a mesh") };
    assert!(flat.normals.is_empty());
}

#[test]
fn a_group_of_an_obj_file_can_be_named() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.OBJ"), OBJ).unwrap();
    let triangles = |shape: &str| {
        let loaded = scene_with(shape, folder.path()).unwrap();
        let Shape::Mesh(mesh) = &loaded.scene.objects[0].shape else { panic!("a mesh") };
        assert!(mesh.normals.is_empty() || mesh.normals.len() == mesh.vertices.len());
        mesh.triangles.len()
    };
    // The red square and the triangle at the back: the blue one is half of the red square once more.
    assert_eq!(triangles(r#"{"type": "mesh", "file": "a.OBJ"}"#), 3);
    assert_eq!(triangles(r#"{"type": "mesh", "file": "a.OBJ", "group": "back"}"#), 1);
    let errors = scene_with(r#"{"type": "mesh", "file": "a.OBJ", "group": "bakc"}"#, folder.path()).unwrap_err();
    assert_eq!(errors.problems[0].code, Code::UnknownName);
}

#[test]
fn a_scene_says_where_it_names_a_file_that_is_missing_or_wrong() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("short.ply"), &square("binary_little_endian")[..300]).unwrap();
    std::fs::create_dir(folder.path().join("folder.ply")).unwrap();
    for (file, code, message) in [
        ("no.ply", Code::File, "no.ply"),
        ("folder.ply", Code::File, "not a plain file"),
        ("short.ply", Code::MeshFile, "short.ply: its header promises"),
        ("short.stl", Code::FileFormat, "short.stl"),
    ] {
        let errors = scene_with(&format!(r#"{{"type": "mesh", "file": "{file}"}}"#), folder.path()).unwrap_err();
        // Two objects name it, one error is enough.
        let problem = &errors.problems[0];
        assert_eq!((problem.code, problem.line, errors.problems.len()), (code, 7, 1), "{errors}");
        assert_eq!(problem.json_path, "$.objects[0].shape.file");
        assert!(problem.message.contains(message), "{}", problem.message);
    }
    let text =
        Parts { objects: r#"[{"shape": {"type": "mesh", "file": "a.ply"}, "material": "white"}]"#, ..RIGHT }.text();
    assert_eq!(etalon_scene::parse(&text, "test.json").unwrap_err().problems[0].code, Code::File);
}

#[test]
fn files_in_memory_may_be_used_twice_and_those_that_lack_get_a_hint() {
    let file = |name: &str, bytes: &[u8]| NamedFile { name: name.to_owned(), bytes: bytes.to_vec() };
    let files = [file("square.ply", b"an older one"), file("square.ply", &square("ascii")), file("unused.obj", b"")];
    let object = |name: &str, shading: &str| {
        format!(r#"{{"shape": {{"type": "mesh", "file": "{name}", "shading": "{shading}"}}, "material": "white"}}"#)
    };
    let parse = |objects: String| {
        etalon_scene::parse_with_files(&Parts { objects: &objects, ..RIGHT }.text(), "test.json", &files, Some([6, 4]))
    };
    // Two meshes are made of one file.
    let both = format!("[{}, {}]", object("square.ply", "flat"), object("square.ply", "smooth"));
    let loaded = parse(both).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!((loaded.scene.objects.len(), loaded.scene.film.width, loaded.files.len()), (2, 6, 1));

    for (name, hint) in [("sqare.ply", r#"did you mean "square.ply"?"#), ("sky.obj", r#"there are "square.ply""#)] {
        let errors = parse(format!("[{}]", object(name, "flat"))).unwrap_err();
        let problem = &errors.problems[0];
        assert_eq!((problem.code, problem.json_path.as_str()), (Code::File, "$.objects[0].shape.file"));
        assert!(problem.message.contains("not among the files in memory"), "{}", problem.message);
        assert!(problem.hint.as_ref().is_some_and(|text| text.starts_with(hint)), "{:?}", problem.hint);
    }
}

#[test]
fn listed_meshes_may_have_normals_and_texture_coordinates() {
    let shape = r#"{"type": "mesh", "vertices_m": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]],
        "normals": [[0,0,2],[0,3,4],[0,0,1]], "uvs": [[0,0],[1,0],[0,1]]}"#;
    let loaded = scene_with(shape, Path::new("")).unwrap();
    let Shape::Mesh(mesh) = &loaded.scene.objects[0].shape else { panic!("a mesh") };
    assert_eq!(mesh.normals, [[0.0, 0.0, 1.0], [0.0, 0.6, 0.8], [0.0, 0.0, 1.0]]);
    assert_eq!(mesh.uvs, [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    let short = shape.replace(",[0,0,1]]", "]");
    assert_eq!(scene_with(&short, Path::new("")).unwrap_err().problems[0].code, Code::WrongLength);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_written_mesh_is_read_back_the_same(
        vertices in prop::collection::vec(prop::array::uniform3(-1e6_f64..1e6), 3..40),
        extra in any::<[bool; 3]>(),
        picks in prop::collection::vec(prop::array::uniform3(0_usize..1000), 1..40),
    ) {
        let count = vertices.len();
        let mesh = Mesh {
            normals: if extra[0] { vec![[0.0, 0.6, 0.8]; count] } else { Vec::new() },
            uvs: if extra[1] { (0..count).map(|i| [i as f32 * 0.1, -1.5]).collect() } else { Vec::new() },
            colours: if extra[2] { (0..count).map(|i| [i as f32 * 0.01, 0.5, 2.0]).collect() } else { Vec::new() },
            triangles: picks.iter().map(|t| t.map(|i| (i % count) as u32)).collect(),
            vertices,
        };
        let mut bytes = Vec::new();
        write_ply(&mesh, &mut bytes).unwrap();
        prop_assert_eq!(read_ply(&bytes).unwrap().mesh, mesh);
    }

    #[test]
    fn no_bytes_make_a_reader_panic(
        at in 0_usize..400, with in any::<[u8; 4]>(), encoding in 0_usize..3, noise in prop::collection::vec(any::<u8>(), 0..200),
    ) {
        let mut bytes = square(["ascii", "binary_little_endian", "binary_big_endian"][encoding]);
        let at = at.min(bytes.len() - 4);
        bytes[at..at + 4].copy_from_slice(&with);
        let _ = read_ply(&bytes);
        let _ = read_ply(&noise);
        let mut text = OBJ.as_bytes().to_vec();
        let at = at % (text.len() - 4);
        text[at..at + 4].copy_from_slice(&with);
        let _ = read_obj(&text, Cut::Fans, |_| Ok(noise.clone()));
        let _ = read_obj(&noise, Cut::Outline, |_| Ok(text.clone()));
    }
}
