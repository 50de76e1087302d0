//! The studio around models that bring no light.

use super::{nothing, scene};
use etalon_import::{Imported, import_bytes};
use etalon_scene::Shape;

/// A cube of side 2 around a point, as OBJ, its faces of the material "paint" but for a square of a share of one face's side, of
/// the material "decal".
fn cube_with_decal(center: [f64; 3], share: f64) -> String {
    let mut text = "mtllib a.mtl\n".to_owned();
    for corner in 0..8 {
        let [x, y, z] = std::array::from_fn(|k| center[k] + if corner >> k & 1 == 0 { -1.0 } else { 1.0 });
        text += &format!("v {x} {y} {z}\n");
    }
    for [a, b] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
        text += &format!("v {} {} {}\n", center[0] + share * a, center[1] + share * b, center[2] + 1.01);
    }
    text + "usemtl paint\nf 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\nusemtl decal\nf 9 10 11 12\n"
}

fn glowing_cube(share: f64, glow: f64) -> Imported {
    let mtl = format!("newmtl paint\nKd 0.5 0.5 0.5\nnewmtl decal\nKd 0 0 0\nKe {glow} {glow} {glow}\n");
    let near = move |_: &str| Ok(mtl.clone().into_bytes());
    import_bytes("obj", cube_with_decal([3.0, 5.0, -7.0], share).as_bytes(), &near, "", "cube.obj").unwrap()
}

#[test]
fn a_model_without_light_stands_in_a_studio() {
    // The only light is a decal of 1 % of a face.
    let imported = glowing_cube(0.1, 1.0);
    assert!(imported.added.iter().any(|a| a.contains("grey studio") && a.contains("too weak")), "{:?}", imported.added);
    let scene = scene(&imported);
    let object =
        |name: &str| scene.objects.iter().find(|object| object.name == name).unwrap_or_else(|| panic!("{name}"));
    let Shape::Mesh(backdrop) = &object("backdrop").shape else { panic!("a mesh") };
    // It stands on the floor, and nothing of the backdrop is between the camera and it.
    let floor = backdrop.vertices.iter().map(|v| v[1]).fold(f64::INFINITY, f64::min);
    assert!(floor < 4.0 && floor > 4.0 - 1e-3, "{floor}");
    assert!(scene.camera.position_m[1] > 4.0);
    // The lamps face the model: their normals point to its middle.
    for name in ["key light", "rim light"] {
        let Shape::Parallelogram { origin, u, v } = object(name).shape else { panic!("a parallelogram") };
        let [o, u, v] = [origin, u, v].map(glam::DVec3::from);
        let to_model = glam::DVec3::new(3.0, 5.0, -7.0) - (o + 0.5 * (u + v));
        assert!(u.cross(v).normalize().dot(to_model.normalize()) > 0.999, "{name}");
        assert!(u.length() > 2.0, "a large lamp");
    }
}

#[test]
fn a_model_with_enough_light_of_its_own_gets_no_studio() {
    for (share, glow, studio) in [(0.1, 1.0, true), (0.1, 100.0, false), (1.0, 1.0, false), (1.0, 1e-3, true)] {
        let added = glowing_cube(share, glow).added;
        assert_eq!(added.iter().any(|a| a.contains("studio")), studio, "{share} {glow}: {added:?}");
    }
}

#[test]
fn a_scene_of_another_renderer_gets_no_backdrop() {
    let pbrt = b"LookAt 0 0 5  0 0 0  0 1 0\nCamera \"perspective\"\nWorldBegin\nShape \"sphere\"\n";
    let imported = import_bytes("pbrt", pbrt, &nothing, "", "s.pbrt").unwrap();
    assert!(imported.added.iter().any(|a| a.contains("even white sky")), "{:?}", imported.added);
    assert_eq!(scene(&imported).objects.len(), 1);
}
