//! Scenes that a program makes, whose references lead nowhere: refused by `prepare`, never a panic.

use etalon_scene::{
    Bitangent, EnvironmentImage, EnvironmentProjection, Image, ImageTexture, Light, LightKind, MaterialKind, Mesh,
    Motion, NumberTexture, OpacityImage, ReferenceError, Relief, Scene, Shape, SpectrumTexture, Terminator, Texels,
};
use etalon_transport::{PrepareError, prepare};
use serde_json::json;
use std::sync::Arc;

/// A ball, and two groups, the second of which places the first.
fn scene() -> Scene {
    let ball = json!({"type": "sphere", "center_m": [0, 0, 0], "radius_m": 1});
    let (scene, _) = etalon_scene::parse(
        &json!({
            "etalon": 1,
            "camera": {"type": "perspective", "position_m": [0, 1, 9], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40},
            "film": {"width": 4, "height": 4},
            "materials": {
                "gold": {"type": "conductor", "metal": "Au"},
                "grey": {"type": "lambert", "reflectance": 0.5},
                "mix": {"type": "blend", "first": "grey", "second": "gold", "weight": 0.5},
            },
            "groups": {
                "inner": {"objects": [{"name": "kernel", "shape": ball, "material": "grey"}]},
                "outer": {"instances": [{"name": "within", "group": "inner"}]},
            },
            "instances": [{"name": "placed", "group": "outer", "transform": [{"translate_m": [3, 0, 0]}]}],
            "objects": [{"name": "ball", "shape": ball, "material": "mix"}],
            "lights": [{"type": "environment", "radiance": 1}],
        })
        .to_string(),
        "test",
    )
    .unwrap_or_else(|errors| panic!("{errors}"));
    scene
}

fn triangle() -> Mesh {
    Mesh { vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], triangles: vec![[0, 1, 2]], ..Mesh::default() }
}

/// An image of 2 × 2 that has one texel.
fn torn() -> Image {
    let mut image = Image::new(1, 1, Texels::F32(vec![[0.5; 3]]));
    (image.width, image.height) = (2, 2);
    image
}

/// The error of the scene with something broken.
#[track_caller]
fn broken(change: impl FnOnce(&mut Scene)) -> ReferenceError {
    let mut scene = scene();
    assert!(prepare(&scene).is_ok());
    change(&mut scene);
    match prepare(&scene) {
        Err(PrepareError::Reference(error)) => error,
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("the scene is accepted"),
    }
}

#[test]
fn a_number_out_of_range_is_an_error_that_names_who_has_it() {
    let error = broken(|scene| scene.objects[0].material = 3);
    assert_eq!(error.to_string(), r#"object "ball" has material 3, but the scene has 3"#);
    let error = broken(|scene| scene.materials.clear());
    assert!(matches!(error, ReferenceError::Material { count: 0, .. }), "{error}");
    let error = broken(|scene| scene.groups[0].objects[0].material = usize::MAX);
    assert!(matches!(&error, ReferenceError::Material { object, .. } if object == "kernel"), "{error}");

    let error = broken(|scene| scene.instances[0].group = 2);
    assert_eq!(error.to_string(), r#"instance "placed" places group 2, but it may only place the first 2"#);
    // A group that places itself, and one after it.
    for group in [1, 2] {
        let error = broken(|scene| scene.groups[1].instances[0].group = group);
        assert!(matches!(error, ReferenceError::Group { index, count: 1, .. } if index == group), "{error}");
    }
}

#[test]
fn meshes_whose_arrays_do_not_fit_are_an_error() {
    let with = |mesh: Mesh| broken(|scene| scene.objects[0].shape = Shape::Mesh(Arc::new(mesh)));
    let error = with(Mesh { triangles: vec![[0, 1, 2], [0, 3, 1]], ..triangle() });
    assert_eq!(error.to_string(), r#"object "ball": triangle 1 has vertex 3, but the mesh has 3"#);
    let error = with(Mesh { normals: vec![[0.0, 0.0, 1.0]; 2], ..triangle() });
    assert_eq!(error.to_string(), r#"object "ball": 2 normals for 3 vertices"#);
    let error = with(Mesh { uvs: vec![[0.0; 2]; 4], ..triangle() });
    assert_eq!(error.to_string(), r#"object "ball": 4 texture coordinates for 3 vertices"#);
}

#[test]
fn images_with_too_few_texels_are_an_error_wherever_they_are() {
    let texture =
        || ImageTexture { image: Arc::new(torn()), ..ImageTexture::new(Image::new(1, 1, Texels::F32(vec![[1.0; 3]]))) };
    let torn_image = |error: ReferenceError, owner: &str| {
        assert_eq!(error.to_string(), format!("{owner}: an image of 2 × 2 has 1 texels"));
    };
    torn_image(
        broken(|scene| scene.objects[0].opacity_image = Some(OpacityImage { texture: texture(), cutoff: None })),
        "object \"ball\"",
    );
    let relief = || Relief::Normals {
        texture: texture(),
        strength: [1.0; 2],
        bitangent: Bitangent::AlongV,
        terminator: Terminator::Mirrored,
    };
    torn_image(broken(|scene| scene.groups[0].objects[0].relief = Some(relief())), "object \"kernel\"");
    let lambert = || MaterialKind::Lambert { reflectance: SpectrumTexture::Image(texture()) };
    let name = scene().materials[0].name.clone();
    torn_image(broken(|scene| scene.materials[0].kind = lambert()), &format!("material \"{name}\""));
    // In a part of a blend, and as its weight.
    let blend = |first, by| MaterialKind::Blend { parts: vec![(0.0, first), (1.0, MaterialKind::Black)], by };
    for kind in [blend(lambert(), 0.5.into()), blend(MaterialKind::Black, NumberTexture::Image(texture()))] {
        torn_image(broken(|scene| scene.materials[0].kind = kind), &format!("material \"{name}\""));
    }
    let sky = LightKind::ImageEnvironment(EnvironmentImage {
        image: Arc::new(torn()),
        name: String::new(),
        projection: EnvironmentProjection::LatitudeLongitude,
        forward: [1.0, 0.0, 0.0],
        right: [0.0, 1.0, 0.0],
        up: [0.0, 0.0, 1.0],
        white: etalon_optics::Spectrum::ONE,
    });
    torn_image(broken(|scene| scene.lights.push(Light { name: "sky".into(), kind: sky })), "light \"sky\"");
}

#[test]
fn motions_and_blends_of_nothing_are_an_error() {
    let error = broken(|scene| scene.instances[0].motion = Some(Motion { keyframes: vec![] }));
    assert_eq!(error.to_string(), r#"instance "placed": a motion without a keyframe"#);
    let empty = MaterialKind::Blend { parts: vec![], by: 0.5.into() };
    let error = broken(|scene| scene.materials[0].kind = empty);
    assert!(matches!(error, ReferenceError::EmptyBlend { .. }), "{error}");
}
