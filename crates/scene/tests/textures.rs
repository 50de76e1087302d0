//! Images over surfaces: what a scene says of them arrives, what is wrong is refused with its place.

use crate::common::{Parts, RIGHT};
use etalon_scene::{
    Bitangent, Code, Encoding, Image, Loaded, MaterialKind, Metal, NumberTexture, Relief, SceneErrors, SpectrumTexture,
    Texels, TextureFilter, UvMap, Wrap,
};
use std::path::Path;

fn scene_with(reflectance: &str, shape: &str, spectra: &str) -> Result<Loaded, SceneErrors> {
    let materials = format!(r#"{{"white": {{"type": "lambert", "reflectance": {reflectance}}}}}"#);
    let objects = format!(r#"[{{"shape": {shape}, "material": "white"}}]"#);
    let text = Parts { materials: &materials, objects: &objects, spectra, ..RIGHT }.text();
    etalon_scene::parse_in(&text, "test.json", Some(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests"))), None)
}

const SQUARE: &str = r#"{"type": "parallelogram", "origin_m": [0, 0, 0], "u_m": [1, 0, 0], "v_m": [0, 1, 0]}"#;
const IMAGE: &str = r#"{"type": "image", "file": "files/chequers.png"}"#;

#[test]
fn every_key_of_an_image_arrives() {
    let image = r#"{"type": "image", "file": "files/chequers.png", "encoding": "linear", "wrap": "mirror", "wrap_v": "clamp",
        "filter": "nearest", "uv_scale": [2, -3], "uv_offset": [0.5, 7], "factor": [0.5, 1, 0]}"#;
    let loaded = scene_with(image, SQUARE, r#"{"grey": 0.5}"#).unwrap();
    let MaterialKind::Lambert { reflectance: SpectrumTexture::Image(t) } = &loaded.scene.materials[0].kind else {
        panic!("an image")
    };
    assert_eq!((t.wrap, t.filter), ([Wrap::Mirror, Wrap::Clamp], TextureFilter::Nearest));
    assert_eq!((t.uv_map, t.factor), (UvMap::scaled([2.0, -3.0], [0.5, 7.0]), [0.5, 1.0, 0.0]));
    assert_eq!((t.image.width, t.image.height), (2, 2));
    assert_eq!(t.image.texels, Texels::Linear8(vec![[230; 3], [40, 40, 60], [40, 40, 60], [230; 3]]));
    assert_eq!(loaded.files.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), ["files/chequers.png"]);
}

#[test]
fn images_and_patterns_may_lie_turned_and_sheared() {
    let map = UvMap { matrix: [[0.5, -2.0], [3.0, 0.25]], offset: [0.125, 4.0] };
    let keys = r#""uv_matrix": [[0.5, -2], [3, 0.25]], "uv_offset": [0.125, 4]"#;
    // The two texels of a gradient along v have their centres at a quarter and three quarters.
    let halved = UvMap { matrix: [map.matrix[0], [1.5, 0.125]], offset: [0.125, 2.25] };
    // The texels of noise have their centres at the points of its lattice, of 4 by 8 cells.
    let centred = UvMap { offset: [0.25, 4.0625], ..map };
    for (kind, expected) in [
        (r#""image", "file": "files/chequers.png""#, map),
        (r#""checker", "first": 0.25, "second": 0.5"#, map),
        (r#""gradient", "from": 0.25, "to": 0.5, "along": "v""#, halved),
        (r#""noise", "first": 0.25, "second": 0.5, "cells": [2, 4], "octaves": 2"#, centred),
    ] {
        let loaded = scene_with(&format!(r#"{{"type": {kind}, {keys}}}"#), SQUARE, r#"{"grey": 0.5}"#).unwrap();
        let MaterialKind::Lambert { reflectance } = &loaded.scene.materials[0].kind else { panic!("diffuse") };
        assert_eq!(reflectance.image().expect("an image").uv_map, expected, "{kind}");
    }
}

/// The window of the texels that it holds is another than the one that it shows, which is 4 × 4.
#[test]
fn an_exr_image_of_a_few_bytes_cannot_claim_memory_for_texels_that_it_does_not_hold() {
    let small = include_bytes!("../fuzz/seeds/image/small.exr");
    assert!(Image::decode(small, Encoding::Auto).is_ok());
    let key = b"dataWindow\0box2i\0";
    let place = small.windows(key.len()).position(|window| window == key).unwrap() + key.len() + 12;
    for (last, said) in [([109_457_407, 0], "109457408 × 1 pixels"), ([70_000, 3], "a side has at most 65536")] {
        let mut bytes = small.to_vec();
        for (k, last) in last.into_iter().enumerate() {
            bytes[place + 4 * k..place + 4 * k + 4].copy_from_slice(&i32::to_le_bytes(last));
        }
        let error = Image::decode(&bytes, Encoding::Auto).unwrap_err();
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn an_image_may_have_a_name_among_the_spectra() {
    let spectra = format!(r#"{{"grey": "tiles", "tiles": {IMAGE}}}"#);
    let loaded = scene_with("\"grey\"", SQUARE, &spectra).unwrap();
    let MaterialKind::Lambert { reflectance } = &loaded.scene.materials[0].kind else { panic!("diffuse") };
    let texture = reflectance.image().expect("an image");
    assert_eq!((texture.wrap, texture.filter), ([Wrap::Repeat; 2], TextureFilter::Bilinear));
    assert!(matches!(texture.image.texels, Texels::Srgb8(_)));
}

#[test]
fn what_is_wrong_with_an_image_is_said_where_it_is_named() {
    let bare = r#"{"type": "box", "min_m": [0, 0, 0], "max_m": [1, 1, 1]}"#;
    for (reflectance, shape, code) in [
        (IMAGE, bare, Code::NoTextureCoordinates),
        (r#"{"type": "image", "file": "files/no.png"}"#, SQUARE, Code::File),
        (r#"{"type": "image", "file": "files/tetrahedron.ply"}"#, SQUARE, Code::ImageFile),
        (r#"{"type": "image", "file": "files/chequers.png", "factor": [2, 1, 1]}"#, SQUARE, Code::Reflectance),
        (r#"{"type": "image", "file": "files/chequers.png", "factor": [-1, 1, 1]}"#, SQUARE, Code::OutOfRange),
        (r#"{"type": "image", "file": "files/chequers.png", "uv_scale": [1e9, 1]}"#, SQUARE, Code::OutOfRange),
        (r#"{"type": "checker", "first": 0, "second": 1, "uv_matrix": [[1, 0], [-1e9, 1]]}"#, SQUARE, Code::OutOfRange),
        (r#"{"type": "noise", "first": 0, "second": 1.5}"#, SQUARE, Code::Reflectance),
        (r#"{"type": "noise", "first": 0, "second": 1, "cells": [2049, 8]}"#, SQUARE, Code::OutOfRange),
        (r#"{"type": "noise", "first": 0, "second": 1, "cells": [8, 512], "octaves": 4}"#, SQUARE, Code::OutOfRange),
        (
            r#"{"type": "checker", "first": 0, "second": 1, "uv_matrix": [[1, 0], [0, 1]], "uv_scale": [1, 1]}"#,
            SQUARE,
            Code::KeyConflict,
        ),
    ] {
        let errors = scene_with(reflectance, shape, r#"{"grey": 0.5}"#).expect_err(reflectance);
        assert_eq!(errors.problems[0].code, code, "{errors}");
    }
    // As the colour of a light.
    let lights = format!(r#"[{{"type": "environment", "radiance": {IMAGE}}}]"#);
    let errors = etalon_scene::parse(&Parts { lights: &lights, ..RIGHT }.text(), "test.json").unwrap_err();
    assert_eq!((errors.problems[0].code, errors.problems[0].line), (Code::KeyConflict, 8));
}

#[test]
fn a_surface_shines_by_an_image_of_any_brightness_but_none_below_0() {
    let with = |radiance: &str, shape: &str| {
        let material = r#"{"type": "black"}"#;
        let objects =
            format!(r#"[{{"shape": {shape}, "material": {material}, "emission": {{"radiance": {radiance}}}}}]"#);
        let text = Parts { objects: &objects, ..RIGHT }.text();
        etalon_scene::parse_in(&text, "test.json", Some(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests"))), None)
    };
    let bright = r#"{"type": "image", "file": "files/chequers.png", "factor": [50, 1, 0], "uv_scale": [2, 1]}"#;
    let scene = with(bright, SQUARE).unwrap_or_else(|errors| panic!("{errors}")).scene;
    let emission = scene.objects[0].emission.as_ref().expect("a lamp");
    let white = etalon_optics::Spectrum::illuminant(etalon_optics::Illuminant::D65, 1.0).unwrap();
    assert_eq!(emission.radiance, white);
    let image = emission.image.as_ref().expect("an image");
    assert_eq!((image.factor, image.uv_map), ([50.0, 1.0, 0.0], UvMap::scaled([2.0, 1.0], [0.0; 2])));
    let bare = r#"{"type": "box", "min_m": [0, 0, 0], "max_m": [1, 1, 1]}"#;
    for (radiance, shape, code) in [
        (bright, bare, Code::NoTextureCoordinates),
        (r#"{"type": "image", "file": "files/chequers.png", "factor": [1e31, 1, 1]}"#, SQUARE, Code::OutOfRange),
        (r#"{"type": "image", "file": "files/chequers.png", "factor": [-1, 1, 1]}"#, SQUARE, Code::OutOfRange),
    ] {
        let errors = with(radiance, shape).expect_err(radiance);
        assert_eq!(errors.problems[0].code, code, "{errors}");
    }
}

#[test]
fn images_of_opacity_normals_and_heights_arrive() {
    let with = |keys: &str| {
        let objects = format!(r#"[{{"shape": {SQUARE}, "material": {{"type": "black"}}, {keys}}}]"#);
        let text = Parts { objects: &objects, ..RIGHT }.text();
        etalon_scene::parse_in(&text, "test.json", Some(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests"))), None)
    };
    let one = |keys: &str| with(keys).unwrap_or_else(|errors| panic!("{errors}")).scene.objects.remove(0);
    let masked = one(
        r#""opacity": 0.5, "opacity_image": {"file": "files/chequers.png", "channel": "blue", "cutoff": 0.25, "uv_scale": [2, 3]}"#,
    );
    let image = masked.opacity_image.expect("an image");
    let scaled = UvMap::scaled([2.0, 3.0], [0.0; 2]);
    assert_eq!((masked.opacity, image.cutoff, image.texture.uv_map), (0.5, Some(0.25), scaled));
    // Chequers of (230, 230, 230) and (40, 40, 60), as numbers and not as sRGB.
    assert!((image.texture.image.texel(1, 0)[0] - 60.0 / 255.0).abs() < 1e-6);
    assert_eq!(image.eval([0.1, 0.1]), 1.0);
    let Some(Relief::Normals { texture, strength, bitangent, .. }) =
        one(r#""normal_map": {"file": "files/chequers.png", "strength": 2}"#).relief
    else {
        panic!("a normal map")
    };
    assert_eq!(
        (strength, texture.image.texels.clone()),
        ([2.0; 2], Texels::Linear8(vec![[230; 3], [40, 40, 60], [40, 40, 60], [230; 3]]))
    );
    assert_eq!(bitangent, Bitangent::AlongV);
    let keys = r#"{"file": "files/chequers.png", "strength": [1, -0.5], "bitangent": "across-u", "encoding": "srgb", "filter": "nearest"}"#;
    let Some(Relief::Normals { texture, strength, bitangent, .. }) = one(&format!("\"normal_map\": {keys}")).relief
    else {
        panic!("a normal map")
    };
    assert_eq!((strength, bitangent, texture.filter), ([1.0, -0.5], Bitangent::AcrossU, TextureFilter::Nearest));
    // 40/255 by the curve of sRGB.
    assert!((texture.eval([0.75, 0.75])[0] - ((40.0_f64 / 255.0 + 0.055) / 1.055).powf(2.4)).abs() < 1e-6);
    let Some(Relief::Heights { texture, .. }) =
        one(r#""bump_map": {"file": "files/chequers.png", "height_m": 1, "channel": "blue"}"#).relief
    else {
        panic!("a bump map")
    };
    assert!((texture.eval([0.75, 0.75])[0] - 60.0 / 255.0).abs() < 1e-6);
    let Some(Relief::Heights { height_m, .. }) =
        one(r#""bump_map": {"file": "files/chequers.png", "height_m": -0.1}"#).relief
    else {
        panic!("a bump map")
    };
    assert_eq!(height_m, -0.1);
    for (keys, code) in [
        (r#""opacity_image": {"file": "files/no.png"}"#, Code::File),
        (r#""bump_map": {"file": "files/chequers.png"}"#, Code::MissingKey),
        (r#""normal_map": {"file": "files/chequers.png", "strength": [1]}"#, Code::WrongLength),
        (
            r#""bump_map": {"file": "files/chequers.png", "height_m": 1}, "normal_map": {"file": "files/chequers.png"}"#,
            Code::KeyConflict,
        ),
    ] {
        let errors = with(keys).expect_err(keys);
        assert_eq!(errors.problems[0].code, code, "{errors}");
    }
}

fn material(material: &str, shape: &str) -> Result<MaterialKind, SceneErrors> {
    let objects = format!(r#"[{{"shape": {shape}, "material": {material}}}]"#);
    let text = Parts { objects: &objects, ..RIGHT }.text();
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests"));
    let scene = etalon_scene::parse_in(&text, "test.json", Some(folder), None)?.scene;
    Ok(scene.materials[scene.objects[0].material].kind.clone())
}

fn right(text: &str) -> MaterialKind {
    material(text, SQUARE).unwrap_or_else(|errors| panic!("{errors}"))
}

#[test]
fn numbers_and_colours_of_materials_come_from_images() {
    let kind = right(
        r#"{"type": "blend", "first": {"type": "black"}, "second": {"type": "oren-nayar", "roughness": 0.5,
            "reflectance": {"type": "image", "file": "files/chequers.png"}},
            "weight_image": {"file": "files/chequers.png", "channel": "blue", "factor": 0.5, "wrap_v": "clamp"}}"#,
    );
    let MaterialKind::Blend { parts, by: NumberTexture::Image(share) } = &kind else { panic!("{kind:?}") };
    assert_eq!((share.factor, share.wrap), ([0.5; 3], [Wrap::Repeat, Wrap::Clamp]));
    // (40, 40, 60) in the upper right, as numbers.
    assert!((share.eval([0.75, 0.75])[0] - 0.5 * 60.0 / 255.0).abs() < 1e-7);
    assert_eq!(parts.iter().map(|(place, _)| *place).collect::<Vec<_>>(), [0.0, 1.0]);
    assert!(kind.image().is_some());

    // Roughnesses from 40/255 to 230/255: all widths between, and one on either side.
    let kind = right(
        r#"{"type": "conductor", "reflectance": {"type": "image", "file": "files/chequers.png"},
            "roughness_image": {"file": "files/chequers.png", "channel": "red"}}"#,
    );
    let MaterialKind::Blend { parts, by: NumberTexture::Image(_) } = &kind else { panic!("{kind:?}") };
    let (first, last) = (parts[0].0, parts[parts.len() - 1].0);
    assert!(first <= 40.0 / 255.0 && 40.0 / 255.0 < 1.051 * first);
    assert!(last >= 230.0 / 255.0 && 230.0 / 255.0 > last / 1.051);
    for (roughness, part) in parts {
        let MaterialKind::RoughConductor { metal: Metal::Reflectance(SpectrumTexture::Image(_)), facets, .. } = part
        else {
            panic!("{part:?}")
        };
        assert_eq!(facets.alpha, [roughness * roughness; 2]);
    }
    // A film whose thickness is a share of 400 nm.
    let kind = right(
        r#"{"type": "dielectric", "interior": 1, "thin_film": [{"thickness_nm": 400, "index": 1.33,
            "thickness_image": {"file": "files/chequers.png", "channel": "blue", "filter": "nearest"}}]}"#,
    );
    let film = kind.film().expect("a film");
    assert!((film.layers[0].thickness_nm.eval([0.75, 0.75]) - 400.0 * 60.0 / 255.0).abs() < 1e-4, "{film:?}");
    assert!(kind.image().is_some());
    // Behind a tint, too.
    for (kind, key) in [
        ("conductor\", \"metal\": \"Ag", "reflected_tint"),
        ("dielectric\", \"interior\": \"1.5", "transmitted_tint"),
        ("plastic\", \"reflectance\": \"1.5", "reflected_tint"),
    ] {
        let text =
            format!(r#"{{"type": "{kind}", "roughness_image": {{"file": "files/chequers.png"}}, "{key}": 0.5}}"#);
        let text = text.replace("interior\": \"1.5\"", "interior\": 1.5").replace("\"1.5\"", "0.5");
        assert!(right(&text).image().is_some(), "{text}");
        let bare = r#"{"type": "box", "min_m": [0, 0, 0], "max_m": [1, 1, 1]}"#;
        assert!(material(&text, bare).is_err(), "{text}");
    }
    // Of one roughness everywhere.
    let kind = right(r#"{"type": "conductor", "reflectance": 0.5, "alpha": 0.25}"#);
    let MaterialKind::RoughConductor { metal: Metal::Reflectance(_), facets, .. } = kind else { panic!("{kind:?}") };
    assert_eq!(facets, 0.25.into());
}

#[test]
fn what_is_wrong_with_an_image_of_numbers_is_said() {
    let bare = r#"{"type": "box", "min_m": [0, 0, 0], "max_m": [1, 1, 1]}"#;
    let rough = r#"{"type": "plastic", "reflectance": 0.5, "roughness_image": {"file": "files/chequers.png"}}"#;
    let brushed = r#"{"type": "plastic", "reflectance": 0.5, "alpha_u": 0.1, "alpha_v": 0.4}"#;
    let glass =
        r#"{"type": "dielectric", "interior": 1.5, "alpha_u": 0.1, "alpha_v": 0.4, "multiple_scattering": "lost"}"#;
    assert!([rough, brushed, glass].iter().all(|text| material(text, SQUARE).is_ok()));
    for (text, counted) in [
        (glass.to_owned(), false),
        (glass.replace(", \"multiple_scattering\": \"lost\"", ""), false),
        (glass.replace("lost", "compensated").replace("0.4", "0.1"), true),
        (r#"{"type": "dielectric", "interior": 1.5, "alpha": 0.1}"#.to_owned(), true),
    ] {
        let kind = right(&text);
        assert!(matches!(kind, MaterialKind::RoughDielectric { compensated, .. } if compensated == counted), "{text}");
    }
    // Equal widths have no directions.
    assert!(material(&brushed.replace("0.4", "0.1"), bare).is_ok());
    let blend = |keys: &str| {
        format!(r#"{{"type": "blend", "first": {{"type": "black"}}, "second": {{"type": "black"}}{keys}}}"#)
    };
    let film = |keys: &str| {
        format!(r#"{{"type": "dielectric", "interior": 1.5, "thin_film": [{{"thickness_nm": 100{keys}}}]}}"#)
    };
    let rough_film = film(r#", "index": 1.4"#).replace("1.5", "1.5, \"alpha\": 0.1");
    let kind = right(&rough_film);
    assert!(matches!(kind, MaterialKind::RoughDielectric { compensated: false, film: Some(_), .. }), "{kind:?}");
    for (text, shape, code) in [
        (rough.to_owned(), bare, Code::NoTextureCoordinates),
        (rough.replace("chequers", "no"), SQUARE, Code::File),
        (rough.replace(".png\"", ".png\", \"factor\": 2"), SQUARE, Code::OutOfRange),
        (rough.replace("0.5,", "0.5, \"alpha\": 0.1,"), SQUARE, Code::KeyConflict),
        (
            r#"{"type": "dielectric", "interior": 1.5, "priority": 1, "roughness_image": {"file": "files/chequers.png"}}"#
                .to_owned(),
            SQUARE,
            Code::KeyConflict,
        ),
        (brushed.to_owned(), bare, Code::NoTextureCoordinates),
        (brushed.replace(", \"alpha_v\": 0.4", ""), SQUARE, Code::MissingKey),
        (brushed.replace("0.5,", "0.5, \"alpha\": 0.1,"), SQUARE, Code::KeyConflict),
        (brushed.replace("0.4", "0"), SQUARE, Code::OutOfRange),
        (rough.replace("0.5,", "0.5, \"alpha_u\": 0.1, \"alpha_v\": 0.2,"), SQUARE, Code::KeyConflict),
        // Where total reflection begins, tables of two widths cannot say.
        (brushed.replace("0.4", "0.4, \"coat\": 0.99"), SQUARE, Code::OutOfRange),
        (brushed.replace("0.4", "0.4, \"multiple_scattering\": \"lost\""), SQUARE, Code::KeyConflict),
        (
            rough.replace("0.5,", "0.5, \"internal_reflection\": \"lost\", \"multiple_scattering\": \"lost\","),
            SQUARE,
            Code::KeyConflict,
        ),
        (glass.replace("lost", "compensated"), SQUARE, Code::KeyConflict),
        (rough.replace("0.5,", "0.5, \"tangent_rotation_deg\": 20,"), SQUARE, Code::MissingKey),
        (film(""), SQUARE, Code::MissingKey),
        (film(r#", "index": 1.4, "metal": "Au""#), SQUARE, Code::KeyConflict),
        (film(r#", "index": 1.4, "thickness_image": {"file": "files/no.png"}"#), SQUARE, Code::File),
        (film(r#", "index": 1.4, "thickness_image": {"file": "files/chequers.png"}"#), bare, Code::NoTextureCoordinates),
        (film(r#", "index": 1.4"#).replace("100", "-1"), SQUARE, Code::OutOfRange),
        (film(r#", "index": 1.4"#).replace("100", "1e7"), SQUARE, Code::OutOfRange),
        (film(r#", "wavelengths_nm": [300, 900], "n": [1, 2]"#), SQUARE, Code::MissingKey),
        (film(r#", "index": "diamond""#), SQUARE, Code::OutsideFit),
        (r#"{"type": "conductor", "metal": "Ag", "thin_film": []}"#.to_owned(), SQUARE, Code::WrongLength),
        // A rough film passes straight on what facets cannot say, and no table holds what several facets do.
        (film(r#", "index": 1.4"#).replace("1.5", "1.5, \"alpha\": 0.1, \"priority\": 1"), SQUARE, Code::KeyConflict),
        (film(r#", "index": 1.4"#).replace("1.5", "1, \"alpha\": 0.1"), SQUARE, Code::KeyConflict),
        (
            film(r#", "index": 1.4"#).replace("1.5", "1.5, \"alpha\": 0.1, \"multiple_scattering\": \"compensated\""),
            SQUARE,
            Code::KeyConflict,
        ),
        (blend(""), SQUARE, Code::MissingKey),
        (blend(r#", "weight": 0.5, "weight_image": {"file": "files/chequers.png"}"#), SQUARE, Code::KeyConflict),
        (r#"{"type": "conductor", "reflectance": 1.5}"#.to_owned(), SQUARE, Code::Reflectance),
        (r#"{"type": "conductor", "reflectance": 0.5, "metal": "Au"}"#.to_owned(), SQUARE, Code::KeyConflict),
    ] {
        let errors = material(&text, shape).expect_err(&text);
        assert_eq!(errors.problems[0].code, code, "{errors}");
    }
}

/// Each of these takes a few bytes of the file and 50 MB of memory.
#[test]
fn noise_is_shared_by_those_who_use_the_same_and_bounded_for_all() {
    let materials = |count: u64, seed: fn(u64) -> u64| {
        let noise = |k: u64| {
            format!(
                r#""{k}": {{"type": "lambert", "reflectance": {{"type": "noise", "first": 0, "second": 1, "cells": [2048, 2048], "seed": {}}}}}"#,
                seed(k)
            )
        };
        let list: Vec<String> = (0..count).map(noise).collect();
        let text = format!(
            r#"{{"etalon": 1, "camera": {{"type": "perspective", "position_m": [0, 0, 1], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40}},
                "film": {{"width": 4, "height": 4}}, "materials": {{{}}}, "lights": [{{"type": "environment", "radiance": 1}}]}}"#,
            list.join(", ")
        );
        etalon_scene::parse(&text, "test")
    };
    let (scene, _) = materials(40, |_| 7).unwrap();
    let images = scene.materials.iter().map(|material| {
        let MaterialKind::Lambert { reflectance } = &material.kind else { panic!("diffuse") };
        std::ptr::from_ref(reflectance.image().expect("noise").image.as_ref())
    });
    assert_eq!(images.collect::<std::collections::HashSet<_>>().len(), 1);
    let errors = materials(5, |k| k).unwrap_err();
    assert!(errors.problems[0].message.contains("16777216 points"), "{errors}");
}
