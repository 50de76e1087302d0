//! Statements of OBJ and MTL that are easily lost.

use super::{PNG, nothing, scene};
use etalon_import::{Imported, import_bytes};
use etalon_scene::{MaterialKind, Scene, SpectrumTexture, UvMap, Wrap};

const FACE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";

fn imported(obj: &str, mtl: &str) -> Imported {
    let near = |name: &str| match name {
        "a.mtl" => Ok(mtl.as_bytes().to_vec()),
        "b.mtl" => Ok(b"newmtl second\nKd 0.25\n".to_vec()),
        "tiles.png" => Ok(PNG.to_vec()),
        other => nothing(other),
    };
    import_bytes("obj", obj.as_bytes(), &near, "", "a.obj").unwrap()
}

fn said(imported: &Imported) -> Vec<String> {
    imported.left_out.iter().map(|l| format!("{}: {}", l.place, l.what)).collect()
}

fn diffuse(scene: &Scene, object: usize) -> f64 {
    match &scene.materials[scene.objects[object].material].kind {
        MaterialKind::Lambert { reflectance: SpectrumTexture::Uniform(reflectance) } => reflectance.eval(550.0),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_material_that_no_library_has_is_listed() {
    let imported = imported(&format!("mtllib a.mtl\n{FACE}usemtl lost\nf 1 2 3\n"), "newmtl found\nKd 1 0 0\n");
    assert_eq!(said(&imported), ["usemtl lost: no library has this material: it becomes grey"]);
}

#[test]
fn a_line_of_a_library_that_cannot_be_read_loses_itself() {
    let obj = format!("mtllib a.mtl\n{FACE}usemtl grey\nf 1 2 3\nusemtl veil\nf 1 2 3\nusemtl halo\nf 1 2 3\n");
    let mtl =
        "newmtl grey\nKd 0.5\nnewmtl veil\nKd spectral a.rfl 1\nTr 0.75\nnewmtl halo\nKd 0.5 0.5 0.5\nd -halo 0.5\n";
    let imported = imported(&obj, mtl);
    let scene = scene(&imported);
    assert!((diffuse(&scene, 0) - 0.5).abs() < 1e-12);
    assert_eq!([0, 1, 2].map(|i: usize| scene.objects[i].opacity), [1.0, 0.25, 0.5]);
    let said = said(&imported);
    assert!(said.len() == 2 && said[0].contains("a.mtl: line 4: Kd is a file of a spectrum"), "{said:?}");
    assert!(said[1].contains("line 8: d -halo"), "{said:?}");
}

#[test]
fn a_line_names_several_libraries_and_goes_on_after_a_backslash() {
    let obj = format!("mtllib a.mtl b.mtl\n{FACE}usemtl first\nf 1 \\\n2 3\nusemtl second\nf 1 2 3\n");
    let imported = imported(&obj, "newmtl first\nKd 0.5 \\\n0.5 0.5\n");
    assert_eq!(said(&imported), Vec::<String>::new());
    let scene = scene(&imported);
    assert!((diffuse(&scene, 0) - 0.5).abs() < 1e-12 && (diffuse(&scene, 1) - 0.25).abs() < 1e-12);
}

#[test]
fn an_image_is_scaled_and_moved_as_its_options_say() {
    let obj = format!("mtllib a.mtl\n{FACE}usemtl paint\nf 1/1 2/2 3/3\n");
    let imported = imported(&obj, "newmtl paint\nmap_Kd -s 2 3 1 -o 0.5 0.25 -clamp on -t 0.5 tiles.png\n");
    let scene = scene(&imported);
    let MaterialKind::Lambert { reflectance: SpectrumTexture::Image(image) } =
        &scene.materials[scene.objects[0].material].kind
    else {
        panic!("an image")
    };
    assert_eq!((image.uv_map, image.wrap), (UvMap::scaled([2.0, 3.0], [0.5, 0.25]), [Wrap::Clamp; 2]));
    let said = said(&imported);
    assert!(said.len() == 2 && said[0].contains("the option -t") && said[1].contains("-clamp"), "{said:?}");
}

#[test]
fn vertices_have_the_colours_that_their_lines_state() {
    let text = "v 0 0 0 1 0 0\nv 1 0 0 0 0.5 0\nv 0 1 0\n";
    let imported = imported(&format!("mtllib a.mtl\n{text}f 1 2 3\nusemtl paint\nf 1 2 3\n"), "newmtl paint\nKd 0.5\n");
    assert_eq!(said(&imported), Vec::<String>::new());
    let scene = scene(&imported);
    // Files state them with the curve of sRGB.
    let half = ((0.5_f64 + 0.055) / 1.055).powf(2.4) as f32;
    assert_eq!(scene.objects[0].shape.vertex_colours(), [[1.0, 0.0, 0.0], [0.0, half, 0.0], [1.0; 3]]);
    let factors =
        |i: usize| -> Vec<[f64; 3]> { scene.materials[scene.objects[i].material].kind.vertex_colours().collect() };
    assert_eq!((factors(0), factors(1)), (vec![[1.0; 3]], vec![[0.5; 3]]));
}

#[test]
fn faces_without_normals_or_coordinates_leave_those_of_others_alone() {
    let obj = format!("mtllib a.mtl\n{FACE}vn 0 0.6 0.8\nusemtl paint\nf 1/1/1 2/2/1 3/3/1\nf 1 2 3\n");
    let imported = imported(&obj, "newmtl paint\nmap_Kd tiles.png\n");
    let said = said(&imported);
    assert!(said.len() == 1 && said[0].contains("1 of its 2 faces have no texture coordinates"), "{said:?}");
    let scene = scene(&imported);
    let etalon_scene::Shape::Mesh(mesh) = &scene.objects[0].shape else { panic!("a mesh") };
    assert_eq!(mesh.normals[..3], [[0.0, 0.6, 0.8]; 3]);
    assert_eq!((mesh.normals[3..].to_vec(), mesh.uvs[3..].to_vec()), (vec![[0.0; 3]; 3], vec![[0.0; 2]; 3]));
    assert_eq!(mesh.uvs[..3], [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
}

#[test]
fn what_has_no_surface_is_listed_once_of_each_kind() {
    let imported = imported(&format!("{FACE}l 1 2 3\nl 2 3\np 1\nsurf 0 1 0 1 1 2 3\nf 1 2 3\n"), "");
    assert_eq!(
        said(&imported),
        [
            "group \"faces 0\": line 7: \"l\", and 1 more of its kind: lines have no surface",
            "group \"faces 0\": line 9: \"p\": points have no surface",
            "group \"faces 0\": line 10: \"surf\": free-form surfaces are not read"
        ]
    );
    let etalon_scene::Shape::Mesh(mesh) = &scene(&imported).objects[0].shape else { panic!("a mesh") };
    assert_eq!(mesh.triangles.len(), 1);
}

#[test]
fn smoothing_groups_have_normals() {
    let roof = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 0 -1\nv 1 1 -1\n";
    let normals = |group: &str| {
        let imported = imported(&format!("{roof}s {group}\nf 1 2 3 4\nf 2 5 6 3\n"), "");
        let etalon_scene::Shape::Mesh(mesh) = &scene(&imported).objects[0].shape else { panic!("a mesh") };
        mesh.normals.clone()
    };
    assert!(normals("off").is_empty());
    let half = 0.5_f32.sqrt();
    assert!(normals("1").iter().any(|n| (n[0] - half).abs() < 1e-6 && (n[2] - half).abs() < 1e-6));
}

#[test]
fn of_d_and_tr_that_disagree_d_is_used() {
    let obj = format!("mtllib a.mtl\n{FACE}usemtl veil\nf 1 2 3\n");
    let imported = imported(&obj, "newmtl veil\nd 0.25\nTr 0.5\n");
    assert_eq!(
        said(&imported),
        ["mtllib: a.mtl: material \"veil\": Tr and d disagree (Tr should be 1 − d): d is used"]
    );
    assert_eq!(scene(&imported).objects[0].opacity, 0.25);
}

/// A file that is placed by a scene of Mitsuba loses the same, and colours of vertices, which Mitsuba does not read there.
#[test]
fn what_a_file_of_a_scene_leaves_out_is_listed() {
    let near = |name: &str| match name {
        "a.obj" => Ok(b"v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nl 1 2\nf 1 2 3\n".to_vec()),
        "lines.obj" => Ok(b"v 0 0 0\nv 1 0 0\nl 1 2\n".to_vec()),
        other => nothing(other),
    };
    let shape = |name: &str| format!("<shape type=\"obj\"><string name=\"filename\" value=\"{name}\"/></shape>\n");
    let text = format!("<scene version=\"3.0.0\">\n{}{}</scene>", shape("a.obj"), shape("lines.obj"));
    let imported = import_bytes("xml", text.as_bytes(), &near, "", "a.xml").unwrap();
    assert_eq!(
        said(&imported),
        [
            "line 2: \"a.obj\": line 4: \"l\": lines have no surface",
            "line 3: \"lines.obj\": line 3: \"l\": lines have no surface",
            "line 3: none of its triangles has an area: it is left out",
        ]
    );
    let scene = scene(&imported);
    assert!(scene.objects.len() == 1 && scene.objects[0].shape.vertex_colours().is_empty());
}
