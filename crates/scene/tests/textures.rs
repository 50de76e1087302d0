//! Images over surfaces: what a scene says of them arrives, what is wrong is refused with its place.

mod common;

use common::{Parts, RIGHT};
use etalon_scene::{Code, Loaded, MaterialKind, Relief, SceneErrors, SpectrumTexture, Texels, TextureFilter, Wrap};
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
    assert_eq!((t.uv_scale, t.uv_offset, t.factor), ([2.0, -3.0], [0.5, 7.0], [0.5, 1.0, 0.0]));
    assert_eq!((t.image.width, t.image.height), (2, 2));
    assert_eq!(t.image.texels, Texels::Linear8(vec![[230; 3], [40, 40, 60], [40, 40, 60], [230; 3]]));
    assert_eq!(loaded.files.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), ["files/chequers.png"]);
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
    assert_eq!((masked.opacity, image.cutoff, image.texture.uv_scale), (0.5, Some(0.25), [2.0, 3.0]));
    // Chequers of (230, 230, 230) and (40, 40, 60), as numbers and not as sRGB.
    assert!((image.texture.image.texel(1, 0)[0] - 60.0 / 255.0).abs() < 1e-6);
    assert_eq!(image.eval([0.1, 0.1]), 1.0);
    let Some(Relief::Normals { texture, strength }) =
        one(r#""normal_map": {"file": "files/chequers.png", "strength": 2}"#).relief
    else {
        panic!("a normal map")
    };
    assert_eq!(
        (strength, texture.image.texels.clone()),
        (2.0, Texels::Linear8(vec![[230; 3], [40, 40, 60], [40, 40, 60], [230; 3]]))
    );
    let Some(Relief::Heights { height_m, .. }) =
        one(r#""bump_map": {"file": "files/chequers.png", "height_m": -0.1}"#).relief
    else {
        panic!("a bump map")
    };
    assert_eq!(height_m, -0.1);
    for (keys, code) in [
        (r#""opacity_image": {"file": "files/no.png"}"#, Code::File),
        (r#""bump_map": {"file": "files/chequers.png"}"#, Code::MissingKey),
        (
            r#""bump_map": {"file": "files/chequers.png", "height_m": 1}, "normal_map": {"file": "files/chequers.png"}"#,
            Code::KeyConflict,
        ),
    ] {
        let errors = with(keys).expect_err(keys);
        assert_eq!(errors.problems[0].code, code, "{errors}");
    }
}
