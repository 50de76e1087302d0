//! Meshes of PLY and OBJ, and the materials of MTL.

use super::{PNG, glb, imported, model, nothing, scene};
use etalon_import::{Imported, import_bytes};
use etalon_scene::{LightKind, MaterialKind, Projection, SpectrumTexture, UvMap};
use proptest::prelude::*;
use serde_json::json;

#[test]
fn a_mesh_alone_gets_a_camera_that_sees_all_of_it_and_light() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n100 0 0\n104 0 0\n100 2 0\n3 0 1 2\n";
    let imported = import_bytes("ply", ply.as_bytes(), &nothing, "", "t.ply").unwrap();
    assert_eq!(imported.added.len(), 2, "{:?}", imported.added);
    let scene = scene(&imported);
    assert!(matches!(scene.lights[0].kind, LightKind::Environment { .. }));
    let Projection::Perspective { vertical_fov_rad, .. } = scene.camera.projection else { panic!("perspective") };
    // Every corner is within the half angle of the picture's height.
    for corner in [[100.0, 0.0, 0.0], [104.0, 0.0, 0.0], [100.0, 2.0, 0.0]] {
        let to: [f64; 3] = std::array::from_fn(|i| corner[i] - scene.camera.position_m[i]);
        let dot: f64 = to.iter().zip(scene.camera.forward).map(|(a, b)| a * b).sum();
        let length = to.iter().map(|v| v * v).sum::<f64>().sqrt();
        assert!((dot / length).acos() < 0.5 * vertical_fov_rad);
    }
}

#[test]
fn a_mesh_alone_shows_the_colours_of_its_vertices_or_faces() {
    let head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    let colour = "property float red\nproperty float green\nproperty float blue\n";
    let list = "element face 1\nproperty list uchar int vertex_indices\n";
    let of_vertices = format!(
        "{head}{colour}{list}end_header\n0 0 0 0.25 0.5 0.75\n1 0 0 0.25 0.5 0.75\n0 1 0 0.25 0.5 0.75\n3 0 1 2\n"
    );
    let of_faces = format!("{head}{list}{colour}end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 0.25 0.5 0.75\n");
    for ply in [of_vertices, of_faces] {
        let imported = import_bytes("ply", ply.as_bytes(), &nothing, "", "t.ply").unwrap();
        assert!(imported.left_out.is_empty(), "{:?}", imported.left_out);
        let scene = scene(&imported);
        assert_eq!(scene.objects[0].shape.vertex_colours(), [[0.25, 0.5, 0.75]; 3]);
        let MaterialKind::Lambert { reflectance } = &scene.materials[scene.objects[0].material].kind else {
            panic!("diffuse")
        };
        assert_eq!(reflectance.vertex_colours(), Some([1.0; 3]));
    }
}

#[test]
fn obj_materials_become_paint_mirrors_glass_and_lamps() {
    let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n\
        usemtl paint\nf 1/1 2/2 3/3\nusemtl mirror\nf 1 2 3\nusemtl glass\nf 1 2 3\nusemtl lamp\nf 1 2 3\nusemtl bare\nf 1 2 3\n";
    let mtl = "newmtl paint\nKd 0.5 0.25 1\nmap_Kd -s 2 1 1 -t 0.5 sub\\tiles.png\nKs 1 1 1\nmap_Bump b.png\n\
        newmtl mirror\nKd 0 0 0\nKs 0.9 0.9 0.9\nillum 3\nnewmtl glass\nd 0.1\nNi 1.45\nillum 7\nnewmtl lamp\nKe 3 2 1\nKd 0 0 0\n";
    let near = |name: &str| match name {
        "a.mtl" => Ok(mtl.as_bytes().to_vec()),
        "sub/tiles.png" => Ok(PNG.to_vec()),
        other => nothing(other),
    };
    let imported = import_bytes("obj", obj.as_bytes(), &near, "x/", "a.obj").unwrap();
    let scene = scene(&imported);
    let kind = |i: usize| &scene.materials[scene.objects[i].material].kind;
    let MaterialKind::Plastic { reflectance: SpectrumTexture::Image(image), .. } = kind(0) else { panic!("an image") };
    assert_eq!(image.factor, [0.5, 0.25, 1.0]);
    assert_eq!(image.uv_map, UvMap::scaled([2.0, 1.0], [0.0, 0.0]));
    assert!(matches!(kind(1), MaterialKind::Mirror { .. }));
    let MaterialKind::Dielectric { interior, .. } = kind(2) else { panic!("glass") };
    assert!((interior.eval(500.0) - 1.45).abs() < 1e-6);
    assert!(scene.objects[3].emission.is_some() && scene.objects[4].emission.is_none());
    let said: Vec<String> = imported.left_out.iter().map(|l| format!("{}: {}", l.place, l.what)).collect();
    for part in ["map_bump", "Ks", "the option -t of map_Kd"] {
        assert!(said.iter().any(|line| line.contains("\"paint\"") && line.contains(part)), "{part}: {said:#?}");
    }
    // Without its library it is grey, and says so.
    let lost = import_bytes("obj", obj.as_bytes(), &nothing, "", "a.obj").unwrap();
    assert!(lost.left_out.iter().any(|l| l.what.contains("a.mtl")), "{:?}", lost.left_out);
    // Beside the backdrop and two lamps of the studio.
    assert_eq!(self::scene(&lost).objects.len(), 1 + 3);
}

#[test]
fn what_dissolves_in_an_obj_file_lets_light_by() {
    let obj =
        "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl veil\nf 1 2 3\nusemtl glass\nf 1 2 3\nusemtl wall\nf 1 2 3\n";
    let mtl = "newmtl veil\nKd 0.5 0.5 0.5\nd 0.25\nnewmtl glass\nd 0.25\nNi 1.5\nnewmtl wall\nd 1\nillum 4\n";
    let near = |name: &str| if name == "a.mtl" { Ok(mtl.as_bytes().to_vec()) } else { nothing(name) };
    let imported = import_bytes("obj", obj.as_bytes(), &near, "", "a.obj").unwrap();
    let scene = scene(&imported);
    assert_eq!([0, 1, 2].map(|i: usize| scene.objects[i].opacity), [0.25, 1.0, 1.0]);
    assert!(matches!(scene.materials[scene.objects[1].material].kind, MaterialKind::Dielectric { .. }));
    let said: Vec<&str> = imported.left_out.iter().map(|l| l.what.as_str()).collect();
    assert!(said.len() == 1 && said[0].contains("it becomes opaque"), "{said:?}");
}

/// A BMP file of one red pixel: 14 bytes of head, 40 of description, blue, green, red and a byte that fills the row.
#[test]
fn an_image_of_an_obj_file_may_be_a_bmp_file() {
    let mut bmp = b"BM".to_vec();
    for number in [58_u32, 0, 54, 40, 1, 1, 1 | 24 << 16, 0, 4, 2835, 2835, 0, 0, 0x00ff_0000] {
        bmp.extend(number.to_le_bytes());
    }
    let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl paint\nf 1/1 2/2 3/3\n";
    let near = |name: &str| match name {
        "a.mtl" => Ok(b"newmtl paint\nmap_Kd red.bmp\n".to_vec()),
        "red.bmp" => Ok(bmp.clone()),
        other => nothing(other),
    };
    let imported = import_bytes("obj", obj.as_bytes(), &near, "x/", "a.obj").unwrap();
    assert!(imported.left_out.is_empty(), "{:?}", imported.left_out);
    let scene = scene(&imported);
    let MaterialKind::Lambert { reflectance: SpectrumTexture::Image(image) } =
        &scene.materials[scene.objects[0].material].kind
    else {
        panic!("an image")
    };
    assert_eq!(image.image.texel(0, 0), [1.0, 0.0, 0.0]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn no_change_of_bytes_makes_an_import_panic(at in 0_usize..6000, with in any::<[u8; 3]>()) {
        let mut bytes = glb(&model());
        let at = at % (bytes.len() - 3);
        bytes[at..at + 3].copy_from_slice(&with);
        if let Ok(imported) = import_bytes("glb", &bytes, &nothing, "", "m.glb") {
            let _ = imported.parse("m", None);
        }
    }
}

#[test]
fn weak_transmission_and_filters_of_mtl_are_listed() {
    let listed = |imported: &Imported, place: &str, what: &str| {
        imported.left_out.iter().any(|l| l.place.contains(place) && l.what.contains(what))
    };
    let weak = |factor: f64| {
        let mut model = model();
        model["materials"] = json!([{ "pbrMetallicRoughness": { "metallicFactor": 0 }, "extensions": { "KHR_materials_volume": { "thicknessFactor": 1 },
                "KHR_materials_transmission": { "transmissionFactor": factor } } }]);
        for primitive in model["meshes"]
            .as_array_mut()
            .unwrap()
            .iter_mut()
            .flat_map(|mesh| mesh["primitives"].as_array_mut().unwrap())
        {
            primitive["material"] = json!(0);
        }
        imported(&model).unwrap()
    };
    assert!(listed(&weak(0.25), "KHR_materials_transmission", "becomes opaque"));
    assert!(
        !listed(&weak(0.0), "KHR_materials_transmission", "opaque")
            && !listed(&weak(1.0), "KHR_materials_transmission", "")
    );

    let filtered = |filter: &str| {
        let mtl = format!("newmtl m\nKd 0.5 0.5 0.5\nTf {filter}\n");
        let near = |name: &str| if name == "m.mtl" { Ok(mtl.clone().into_bytes()) } else { nothing(name) };
        let obj = b"mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        import_bytes("obj", obj, &near, "", "model").unwrap()
    };
    assert!(listed(&filtered("0.5 1 1"), "m", "Tf is ignored"));
    assert!(!listed(&filtered("1 1 1.0"), "m", "Tf"));
}
