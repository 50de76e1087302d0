//! Sheets that scatter light to both sides, of pbrt and glTF.

use base64::Engine as _;
use etalon_scene::{MaterialKind, SpectrumTexture};
use serde_json::{Value, json};

use super::{imported, scene};

/// The shares of a translucent material at 550 nm.
fn shares(kind: &MaterialKind) -> [f64; 2] {
    let MaterialKind::Translucent { reflectance, transmittance } = kind else { panic!("{kind:?}") };
    [reflectance, transmittance].map(|texture| match texture {
        SpectrumTexture::Uniform(spectrum) => spectrum.eval(550.0),
        other => panic!("{other:?}"),
    })
}

#[test]
fn diffuse_transmission_of_pbrt() {
    let of = |keys: &str| {
        let model = imported(
            "pbrt",
            &format!("WorldBegin\nMaterial \"diffusetransmission\" {keys}\nShape \"disk\"\nLightSource \"infinite\"\n"),
        );
        let said: Vec<String> =
            model.left_out.iter().map(|l| l.what.clone()).filter(|what| what.contains("add up")).collect();
        let scene = scene(&model);
        (shares(&scene.materials[scene.objects[0].material].kind), said)
    };
    assert_eq!(of(""), ([0.25, 0.25], vec![]));
    let (found, said) = of("\"float scale\" 0.5 \"rgb reflectance\" [ 0.5 0.5 0.5 ] \"rgb transmittance\" [ 1 1 1 ]");
    assert_eq!((found, said), ([0.25, 0.5], vec![]));
    let (found, said) = of("\"rgb reflectance\" [ 0.5 0.5 0.5 ] \"rgb transmittance\" [ 1 1 1 ]");
    assert!((found[0] - 1.0 / 3.0).abs() < 1e-12 && (found[1] - 2.0 / 3.0).abs() < 1e-12, "{found:?}");
    assert_eq!(said, ["reflectance and transmittance add up to 1.500: both are divided by it"]);
}

#[test]
fn thin_principled_sheets_of_mitsuba() {
    let of = |keys: &str| {
        let sheet = format!("<bsdf type=\"principledthin\"><rgb name=\"base_color\" value=\"0.5\"/>{keys}</bsdf>");
        let model =
            imported("xml", &format!("<scene version=\"3.0.0\"><shape type=\"rectangle\">{sheet}</shape></scene>"));
        assert_eq!(model.left_out.len(), 1, "that it is approximated: {:?}", model.left_out);
        let scene = scene(&model);
        scene.materials[scene.objects[0].material].kind.clone()
    };
    assert!(matches!(of(""), MaterialKind::Lambert { .. }));
    assert_eq!(shares(&of("<float name=\"diff_trans\" value=\"0.5\"/>")), [0.375, 0.125]);
    assert_eq!(shares(&of("<float name=\"diff_trans\" value=\"2\"/>")), [0.0, 0.5]);
    // Of squares of 0.4 and 1.4 each is a sheet of its own.
    let squares = "<texture name=\"diff_trans\" type=\"checkerboard\"><float name=\"color0\" value=\"0.4\"/><float name=\"color1\" value=\"1.4\"/></texture>";
    let MaterialKind::Blend { parts, .. } = of(squares) else { panic!("a blend") };
    let found: Vec<_> = parts.iter().flat_map(|(_, part)| shares(part)).collect();
    assert!(found.iter().zip([0.15, 0.35, 0.4, 0.1]).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
}

#[test]
fn diffuse_transmission_of_gltf() {
    let of = |specular: f64, extension: Value| {
        let positions: Vec<u8> =
            [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
        let data = base64::engine::general_purpose::STANDARD.encode(&positions);
        let model = json!({
            "asset": { "version": "2.0" },
            "buffers": [{ "byteLength": 36, "uri": format!("data:application/octet-stream;base64,{data}") }],
            "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
            "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] }],
            "materials": [{
                "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.5, 0.5, 1.0], "metallicFactor": 0.0 },
                "extensions": {
                    "KHR_materials_specular": { "specularFactor": specular },
                    "KHR_materials_diffuse_transmission": extension
                }
            }],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }],
            "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }], "scene": 0
        });
        let model = imported("gltf", &model.to_string());
        let said: Vec<String> = model
            .left_out
            .iter()
            .filter(|l| l.place.ends_with("diffuse_transmission"))
            .map(|l| l.what.clone())
            .collect();
        let scene = scene(&model);
        (scene.materials[scene.objects[0].material].kind.clone(), said)
    };
    let (kind, said) =
        of(0.0, json!({ "diffuseTransmissionFactor": 1, "diffuseTransmissionColorFactor": [0.75, 0.75, 0.75] }));
    assert_eq!((shares(&kind), said), ([0.0, 0.75], vec![]));
    let (kind, said) = of(0.0, json!({ "diffuseTransmissionFactor": 0.25 }));
    let MaterialKind::Blend { parts, by } = &kind else { panic!("{kind:?}") };
    assert!(matches!(parts[0].1, MaterialKind::Lambert { .. }) && by.mean() == 0.25 && said.is_empty(), "{said:?}");
    assert_eq!(shares(&parts[1].1), [0.0, 1.0]);
    let (kind, said) =
        of(1.0, json!({ "diffuseTransmissionFactor": 0.25, "diffuseTransmissionTexture": { "index": 0 } }));
    let MaterialKind::Blend { parts, .. } = &kind else { panic!("{kind:?}") };
    assert!(matches!(parts[0].1, MaterialKind::Plastic { .. }) && said.len() == 2, "{said:?}");
    let (kind, said) = of(0.0, json!({}));
    assert!(matches!(kind, MaterialKind::Lambert { .. }) && said.is_empty(), "{said:?}");
}
