//! Extensions of glTF: instances, hidden nodes, and what is said of those that are not read.

use super::shapes::Model;
use super::{imported, model, scene};
use etalon_import::Imported;
use etalon_scene::{MaterialKind, Scene};
use serde_json::{Value, json};
use std::f32::consts::FRAC_1_SQRT_2;

fn listed(imported: &Imported) -> Vec<String> {
    imported.left_out.iter().map(|l| format!("{}: {}", l.place, l.what)).collect()
}

/// Where the corner (1, 1, 0) of the square lies in each place.
fn corners(scene: &Scene) -> Vec<[f64; 3]> {
    let at = |t: &etalon_scene::Transform| {
        [0, 1, 2].map(|k| ((t.linear[k][0] + t.linear[k][1] + t.translation_m[k]) * 1e4).round() / 1e4)
    };
    scene.instances.iter().map(|instance| at(&instance.transform)).collect()
}

#[test]
fn a_mesh_is_placed_wherever_a_node_has_instances_of_it() {
    let mut model = Model::new(json!([{ "mesh": 0, "translation": [10, 0, 0] }]), &[0]);
    let translations = model.floats(&[0.0, 0.0, 0.0, 0.0, 5.0, 0.0, 0.0, 0.0, 7.0], "VEC3");
    let quarter = [0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2];
    let turns = model.floats(&[[0.0, 0.0, 0.0, 1.0], quarter, [0.0, 0.0, 0.0, 1.0]].concat(), "VEC4");
    let scales = model.floats(&[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0, 3.0, 1.0], "VEC3");
    let stated = json!({ "TRANSLATION": translations, "ROTATION": turns, "SCALE": scales });
    model.json["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing": { "attributes": stated } });
    for key in ["extensionsUsed", "extensionsRequired"] {
        model.json[key] = json!(["EXT_mesh_gpu_instancing"]);
    }
    let imported = model.import().unwrap();
    assert_eq!(listed(&imported), Vec::<String>::new());
    let scene = scene(&imported);
    assert_eq!(scene.groups.len(), 1);
    // A quarter turn takes (1, 1, 0) to (−1, 1, 0).
    assert_eq!(corners(&scene), [[11.0, 1.0, 0.0], [9.0, 6.0, 0.0], [12.0, 3.0, 7.0]]);
    let attributes = |model: &mut Model, key: &str, index: Value| {
        model.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"][key] = index;
        model.refused()
    };
    let place = "$.nodes[0].extensions.EXT_mesh_gpu_instancing: ";
    assert_eq!(
        attributes(&mut model, "SCALE", json!(99)),
        format!("{place}it names accessor 99, which does not exist")
    );
    let two = model.floats(&[1.0; 6], "VEC3");
    assert_eq!(attributes(&mut model, "SCALE", json!(two)), format!("{place}its attributes have different lengths"));
}

#[test]
fn attributes_of_instances_that_are_not_read_are_listed_and_count() {
    let mut model = Model::new(json!([{ "mesh": 0 }]), &[0]);
    let colours = model.floats(&[1.0; 12], "VEC4");
    let stated = json!({ "EXT_mesh_gpu_instancing": { "attributes": { "_COLOR_0": colours } } });
    model.json["nodes"][0]["extensions"] = stated;
    model.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    let imported = model.import().unwrap();
    assert_eq!(listed(&imported), ["$.nodes[0].extensions.EXT_mesh_gpu_instancing.attributes._COLOR_0: it is ignored"]);
    assert_eq!(corners(&scene(&imported)), [[1.0, 1.0, 0.0]; 3]);
}

#[test]
fn instances_of_a_mesh_that_joints_place_are_listed() {
    let mut model = Model::new(json!([{ "mesh": 0, "skin": 0 }, {}]), &[0, 1]);
    let joints = model.add(vec![0; 16], 5121, "VEC4");
    let weights = model.floats(&[1.0, 0.0, 0.0, 0.0].repeat(4), "VEC4");
    let translations = model.floats(&[0.0, 0.0, 0.0, 0.0, 5.0, 0.0], "VEC3");
    (model.primitive()["attributes"]["JOINTS_0"], model.primitive()["attributes"]["WEIGHTS_0"]) =
        (json!(joints), json!(weights));
    model.json["skins"] = json!([{ "joints": [1] }]);
    model.json["nodes"][0]["extensions"] =
        json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": translations } } });
    model.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    let imported = model.import().unwrap();
    let expected =
        "$.nodes[0].extensions.EXT_mesh_gpu_instancing: it is ignored: the mesh is where its joints place it";
    assert_eq!(listed(&imported), [expected]);
    assert_eq!(super::shapes::vertices(&imported)[2], [1.0, 1.0, 0.0]);
}

#[test]
fn hidden_nodes_and_those_below_them_are_not_seen_and_give_no_light() {
    let mut model = model();
    let seen = scene(&imported(&model).unwrap());
    model["extensionsRequired"] = json!(["KHR_node_visibility"]);
    // Of two nodes with a mesh the first stands above the second; the light has a node of its own, and so has the camera.
    for (node, instances, lights) in [(1, 3, 3), (0, 0, 3), (4, 6, 2), (3, 6, 3)] {
        let mut hidden = model.clone();
        hidden["nodes"][node]["extensions"]["KHR_node_visibility"] = json!({ "visible": false });
        if node == 0 {
            // Nothing at all is left to see.
            let why = imported(&hidden).unwrap_err();
            assert!(why.contains("no surfaces"), "{why}");
            continue;
        }
        let found = scene(&imported(&hidden).unwrap());
        assert_eq!((found.instances.len(), found.lights.len()), (instances, lights), "{node}");
        assert_eq!(found.camera.position_m, seen.camera.position_m);
    }
}

#[test]
fn each_extension_that_is_not_read_is_one_line_with_what_the_picture_lacks() {
    let mut model = model();
    model["extensionsUsed"] = json!([
        "KHR_lights_punctual",
        "EXT_lights_image_based",
        "KHR_xmp_json_ld",
        "KHR_animation_pointer",
        "ACME_materials_velvet",
        "ACME_smoke",
        "EXT_texture_webp"
    ]);
    model["materials"][0]["extensions"]["ACME_materials_velvet"] = json!({ "strength": 1 });
    let lines = listed(&imported(&model).unwrap());
    let of_extensions: Vec<&str> =
        lines.iter().map(String::as_str).filter(|line| line.starts_with("$.extensionsUsed")).collect();
    assert_eq!(
        of_extensions,
        [
            "$.extensionsUsed[1]: EXT_lights_image_based: it is ignored: the light of its surroundings is missing",
            "$.extensionsUsed[3]: KHR_animation_pointer: it is ignored: what it animates stays as it is: materials, lights and cameras",
            "$.extensionsUsed[4]: ACME_materials_velvet: it is ignored: surfaces look as they do without it",
            "$.extensionsUsed[5]: ACME_smoke: it is ignored: what it says is not in the picture",
            "$.extensionsUsed[6]: EXT_texture_webp: images in WebP cannot be read, only PNG and JPEG; those that its textures name \
             beside them are used. `gltf-transform png` makes them",
        ]
    );
    assert_eq!(lines.iter().filter(|line| line.contains("velvet")).count(), 1, "{lines:#?}");
    // One that is not declared is listed where it stands.
    model["extensionsUsed"] = json!([]);
    let lines = listed(&imported(&model).unwrap());
    let expected =
        "$.materials[0].extensions.ACME_materials_velvet: it is ignored: surfaces look as they do without it";
    assert!(lines.iter().any(|line| line == expected), "{lines:#?}");
}

#[test]
fn animations_of_anything_but_nodes_do_not_keep_a_model_from_being_read() {
    let mut model = Model::new(json!([{ "mesh": 0 }]), &[0]);
    model.animate(0, "translation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 8.0, 0.0, 0.0]);
    let pointer = json!({ "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": "/materials/0/alphaCutoff" } } });
    let channels = model.json["animations"][0]["channels"].as_array_mut().unwrap();
    channels.insert(0, json!({ "sampler": 0, "target": pointer }));
    model.json["extensionsUsed"] = json!(["KHR_animation_pointer"]);
    let imported = model.at(0.5, 0.0).unwrap();
    let expected = "$.extensionsUsed[0]: KHR_animation_pointer: it is ignored: what it animates stays as it is: materials, lights and cameras";
    assert_eq!(listed(&imported), [expected]);
    // Halfway to 8.
    assert_eq!(super::shapes::vertices(&imported)[0][0], 4.0);
    // Channels are counted as in the file.
    model.animate(0, "translation", "LINEAR", &[0.0, 1.0], &[0.0; 6]);
    let second = "$.animations[0].channels[2]: it is the second channel of the same property of the same node";
    assert_eq!(model.at(0.5, 0.0).unwrap_err(), second);
}

#[test]
fn a_required_extension_that_cannot_be_read_is_named() {
    let mut model = model();
    model["extensionsRequired"] = json!(["KHR_texture_transform", "ACME_smoke"]);
    let why = imported(&model).unwrap_err();
    assert_eq!(why, "$.extensionsRequired: it requires ACME_smoke, which cannot be read");
    // Those that change no picture, and images, of which each is listed.
    model["extensionsRequired"] = json!(["KHR_xmp_json_ld", "KHR_texture_basisu"]);
    model["textures"][0] = json!({ "extensions": { "KHR_texture_basisu": { "source": 0 } } });
    let lines = listed(&imported(&model).unwrap());
    let expected = "its image is in KTX2 (KHR_texture_basisu), and only PNG and JPEG can be read: `gltf-transform ktxdecompress` makes them";
    assert!(lines.iter().any(|line| line.ends_with(expected)), "{lines:#?}");
}

#[test]
fn backs_that_viewers_hide_are_said_to_be_added() {
    let mut model = model();
    // The glass is seen through.
    let added = imported(&model).unwrap().added;
    assert_eq!(added, ["the backs of 2 materials that are not doubleSided: viewers of glTF hide them"]);
    model["materials"][0]["doubleSided"] = json!(true);
    let added = imported(&model).unwrap().added;
    assert_eq!(added, ["the back of a material that is not doubleSided: viewers of glTF hide it"]);
}

#[test]
fn cameras_see_nothing_nearer_than_they_say() {
    let mut model = model();
    assert_eq!(scene(&imported(&model).unwrap()).camera.near_m, 0.1);
    model["cameras"][0] =
        json!({ "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "znear": 0.25, "zfar": 100 } });
    // Along −z.
    assert_eq!(scene(&imported(&model).unwrap()).camera.position_m, [0.0, 1.0, 8.75]);
}

/// The material of the first part, and what is listed of it.
fn with(stated: Value) -> (MaterialKind, f64, Vec<String>) {
    let mut model = model();
    model["extensionsUsed"] = json!(["KHR_materials_pbrSpecularGlossiness"]);
    model["materials"][0] =
        json!({ "alphaMode": "BLEND", "extensions": { "KHR_materials_pbrSpecularGlossiness": stated } });
    let imported = imported(&model).unwrap();
    let lines = imported.left_out.iter().filter(|l| l.place.contains("Glossiness")).map(|l| l.what.clone()).collect();
    let scene = scene(&imported);
    let part = &scene.groups[scene.instances[0].group].objects[0];
    (scene.materials[part.material].kind.clone(), part.opacity, lines)
}

#[test]
fn specular_and_glossiness_become_a_coat_or_a_metal() {
    let (kind, opacity, lines) = with(json!({
        "diffuseFactor": [0.5, 0.25, 0.25, 0.75], "specularFactor": [0.04, 0.04, 0.04], "glossinessFactor": 0.5
    }));
    let MaterialKind::Plastic { coat, facets: Some(facets), .. } = &kind else { panic!("{kind:?}") };
    // ((n − 1)/(n + 1))² = 0.04; α = (1 − 0.5)².
    assert!((coat.eval(550.0) - 1.5).abs() < 1e-9 && (facets.alpha[0] - 0.25).abs() < 1e-9);
    assert_eq!(
        (opacity, lines),
        (0.75, vec!["a diffuse base under a coat that reflects 0.040 head-on is used".to_owned()])
    );

    let (kind, opacity, lines) =
        with(json!({ "diffuseFactor": [0, 0, 0, 1], "specularFactor": [0.9, 0.6, 0.3], "glossinessFactor": 0.9 }));
    assert!(matches!(kind, MaterialKind::RoughConductor { .. }), "{kind:?}");
    let metal = "it has no diffuse colour: a metal of its specular colour is used";
    assert_eq!((opacity, lines), (1.0, vec![metal.to_owned()]));

    let (kind, _, lines) = with(json!({ "specularFactor": [0, 0, 0] }));
    assert!(matches!(kind, MaterialKind::Lambert { .. }), "{kind:?}");
    let diffuse =
        "it reflects nothing head-on: a diffuse surface is used, which reflects nothing at grazing angles either";
    assert_eq!(lines, [diffuse]);

    // Images: that of the diffuse colour as it is, of the other the mean.
    let (kind, _, lines) =
        with(json!({ "diffuseTexture": { "index": 0 }, "specularGlossinessTexture": { "index": 0 } }));
    assert!(lines.iter().any(|line| line == "its mean is used"), "{lines:?}");
    let kind = match kind {
        MaterialKind::Tinted { kind, .. } => *kind,
        kind => kind,
    };
    let MaterialKind::Plastic { reflectance, .. } = &kind else { panic!("{kind:?}") };
    assert!(matches!(reflectance, etalon_scene::SpectrumTexture::Image(_)), "{reflectance:?}");
}

#[test]
fn what_stands_beside_specular_and_glossiness_is_listed() {
    let mut model = model();
    model["materials"][0] = json!({ "occlusionTexture": { "index": 0 }, "extensions": {
        "KHR_materials_pbrSpecularGlossiness": {}, "KHR_materials_unlit": {}, "KHR_materials_ior": { "ior": 1.4 },
        "KHR_materials_clearcoat": { "clearcoatFactor": 1 }, "KHR_materials_emissive_strength": { "emissiveStrength": 2 },
    } });
    let lines = listed(&imported(&model).unwrap());
    let beside = "it is ignored beside KHR_materials_pbrSpecularGlossiness";
    for expected in [
        "occlusionTexture: it is ignored: shadows are traced".to_owned(),
        "extensions.KHR_materials_unlit: it is ignored: the surface is lit like any other".to_owned(),
        format!("extensions.KHR_materials_ior: {beside}"),
        format!("extensions.KHR_materials_clearcoat: {beside}"),
    ] {
        let expected = format!("$.materials[0].{expected}");
        assert_eq!(lines.iter().filter(|line| **line == expected).count(), 1, "{expected} in {lines:#?}");
    }
    assert_eq!(lines.iter().filter(|line| line.ends_with(beside)).count(), 2, "{lines:#?}");
}
