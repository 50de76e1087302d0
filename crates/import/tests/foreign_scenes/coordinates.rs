//! Images and directions on shapes of Mitsuba that have texture coordinates of another kind than ours.

use etalon_scene::{DiskCoordinates, Shape};
use serde_json::{Value, json};

use super::{imported, said, scene};

const IMAGE: &str = "<bsdf type=\"diffuse\"><texture type=\"bitmap\" name=\"reflectance\"><string name=\"filename\" value=\"chequers.png\"/></texture></bsdf>";

fn of(shape: &str, look: &str) -> String {
    format!("<scene version=\"3.0.0\"><shape type=\"{shape}\">{look}</shape></scene>")
}

fn object(text: &str) -> Value {
    let json: Value = serde_json::from_str(text).expect("a scene is JSON");
    json["objects"].as_array().and_then(|objects| objects.last()).expect("an object").clone()
}

#[test]
fn images_keep_their_place_on_round_shapes() {
    // v of a sphere runs from the pole down, that of the image from below in Etalon, that of a bitmap from above.
    for (shape, scale, offset) in [("sphere", [1.0, 1.0], [0.0, 0.0]), ("cylinder", [1.0, -1.0], [0.0, 1.0])] {
        let imported = imported("xml", &of(shape, IMAGE));
        assert_eq!(said(&imported), Vec::<String>::new(), "{shape}");
        let object = object(&imported.text);
        assert_eq!((&object["shape"]["type"], object["material"]["type"].as_str()), (&json!(shape), Some("lambert")));
        let image = &object["material"]["reflectance"];
        assert_eq!([&image["uv_scale"], &image["uv_offset"]], [&json!(scale), &json!(offset)], "{shape}");
        scene(&imported);
    }
}

#[test]
fn disks_with_an_image_are_polar_and_cubes_become_meshes() {
    for shape in ["disk", "cube"] {
        let imported = imported("xml", &of(shape, IMAGE));
        assert_eq!(said(&imported), Vec::<String>::new(), "{shape}");
        match &scene(&imported).objects[0].shape {
            Shape::Disk { coordinates, .. } => assert_eq!((*coordinates, shape), (DiskCoordinates::Polar, "disk")),
            other => assert!(matches!(other, Shape::Mesh { .. }) && shape == "cube", "{other:?}"),
        }
        // Without an image they stay what they are.
        let plain = super::imported("xml", &of(shape, ""));
        let shape = &object(&plain.text)["shape"];
        assert!(shape["type"] != "mesh" && shape.get("coordinates").is_none(), "{shape}");
    }
}

#[test]
fn an_image_moves_with_the_shape_and_what_else_is_laid_over_it() {
    let look = format!(
        "<point name=\"center\" x=\"1\" y=\"2\" z=\"3\"/><transform name=\"to_world\"><scale value=\"2\"/></transform>
        <bsdf type=\"mask\"><texture type=\"bitmap\" name=\"opacity\"><string name=\"filename\" value=\"chequers.png\"/></texture>{IMAGE}</bsdf>
        <emitter type=\"area\"><texture type=\"bitmap\" name=\"radiance\"><string name=\"filename\" value=\"chequers.png\"/></texture></emitter>"
    );
    let imported = imported("xml", &of("sphere", &look));
    assert_eq!(said(&imported), Vec::<String>::new());
    let object = object(&imported.text);
    for image in [&object["opacity_image"], &object["emission"]["radiance"], &object["material"]["reflectance"]] {
        assert_eq!(image["uv_scale"], json!([1.0, 1.0]), "{object}");
    }
    let scene = scene(&imported);
    assert_eq!(scene.objects[0].transform.translation_m, [2.0, 4.0, 6.0]);
    assert!(matches!(scene.objects[0].shape, Shape::Sphere { center: [0.0, 0.0, 0.0], .. }));
}

#[test]
fn brushed_round_shapes_keep_their_directions() {
    let brushed = "<bsdf type=\"roughconductor\"><float name=\"alpha_u\" value=\"0.1\"/><float name=\"alpha_v\" value=\"0.4\"/></bsdf>";
    for shape in ["sphere", "cylinder", "cube", "disk"] {
        let imported = imported("xml", &of(shape, brushed));
        assert_eq!(said(&imported), Vec::<String>::new(), "{shape}");
        assert_eq!(object(&imported.text)["material"]["alpha_u"], 0.1);
        scene(&imported);
    }
}

/// In pbrt, v of spheres and cylinders grows with z, that of disks toward the middle.
#[test]
fn round_shapes_of_pbrt_keep_their_images() {
    let texture = "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"chequers.png\"\nMaterial \"diffuse\" \"texture reflectance\" \"t\"";
    for (shape, kind, listed) in [("sphere", "sphere", 0), ("cylinder", "cylinder", 0), ("disk", "mesh", 1)] {
        let imported = imported("pbrt", &format!("Scale -1 1 1\nWorldBegin\n{texture}\nShape \"{shape}\"\n"));
        let said = said(&imported);
        assert!(said.len() == listed && said.iter().all(|line| line.contains("polar")), "{said:?}");
        let object = object(&imported.text);
        assert_eq!(object["shape"]["type"], kind);
        scene(&imported);
    }
    // Without an image nothing is turned.
    let plain = imported("pbrt", "Scale -1 1 1\nWorldBegin\nShape \"cylinder\"\n");
    assert_eq!(object(&plain.text)["shape"]["start_m"], json!([0, 0, -1.0]));
}

/// On a mesh without texture coordinates Mitsuba puts an image into each triangle. What has directions still needs coordinates.
#[test]
fn images_lie_in_each_triangle_of_a_mesh_without_coordinates() {
    let of = |bsdf: &str, more: &str| {
        let text = format!(
            r#"<scene version="3.0.0"><sensor type="perspective"/><shape type="ply"><string name="filename" value="bare.ply"/>{bsdf}{more}</shape></scene>"#
        );
        let imported = imported("xml", &text);
        (scene(&imported), said(&imported))
    };
    let image = |name: &str| {
        format!(r#"<texture type="bitmap" name="{name}"><string name="filename" value="chequers.png"/></texture>"#)
    };
    let diffuse = format!(r#"<bsdf type="diffuse">{}</bsdf>"#, image("reflectance"));
    let mask = format!(r#"<bsdf type="mask">{}<bsdf type="diffuse"/></bsdf>"#, image("opacity"));
    let lamp = format!(r#"<emitter type="area">{}</emitter>"#, image("radiance"));
    for (bsdf, more) in [(&diffuse[..], ""), (&mask, ""), ("", &lamp)] {
        let (scene, said) = of(bsdf, more);
        assert_eq!(said, Vec::<String>::new());
        let Shape::Mesh(mesh) = &scene.objects[0].shape else { panic!("{:?}", scene.objects[0].shape) };
        assert_eq!(mesh.uvs, [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], "{bsdf}{more}");
        // They are made of the triangles while these share vertices.
        assert_eq!(mesh.normals, [[0.0, 0.0, 1.0]; 3]);
    }
    let (scene, said) = of(
        r#"<bsdf type="roughconductor"><float name="alpha_u" value="0.1"/><float name="alpha_v" value="0.4"/></bsdf>"#,
        "",
    );
    let Shape::Mesh(mesh) = &scene.objects[0].shape else { panic!("{:?}", scene.objects[0].shape) };
    assert!(mesh.uvs.is_empty() && said.iter().any(|what| what.contains("no texture coordinates")), "{said:?}");
}
