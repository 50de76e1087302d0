//! Images on surfaces, against closed forms.

use etalon_scene::{
    Image, ImageTexture, MaterialKind, Scene, SpectrumTexture, Texels, TextureFilter, UvMap, Wrap, parse,
};
use etalon_transport::{Control, prepare};
use std::sync::Arc;

/// Four columns and two rows of colours.
const TEXELS: [[f32; 3]; 8] = [
    [0.9, 0.1, 0.1],
    [0.2, 0.8, 0.3],
    [0.1, 0.2, 0.95],
    [0.5, 0.5, 0.5],
    [1.0, 1.0, 1.0],
    [0.0, 0.0, 0.0],
    [0.7, 0.6, 0.1],
    [0.05, 0.9, 0.8],
];

fn texture(filter: TextureFilter) -> ImageTexture {
    ImageTexture { wrap: [Wrap::Clamp; 2], filter, ..ImageTexture::new(Image::new(4, 2, Texels::F32(TEXELS.to_vec()))) }
}

/// A square of 4 × 2 m that fills the picture, under a sky of D65: each pixel shows what the surface reflects.
fn picture(shape: &str, texture: ImageTexture, size: [u32; 2], spp: u32) -> Vec<[f64; 3]> {
    let text = format!(
        r#"{{"etalon": 1, "film": {{"width": {}, "height": {}}},
        "camera": {{"type": "orthographic", "position_m": [2, 1, 3], "direction": [0, 0, -1], "height_m": 2}},
        "objects": [{{"shape": {shape}, "material": {{"type": "lambert", "reflectance": 0.5}}}}],
        "lights": [{{"type": "environment", "radiance": {{"type": "illuminant", "name": "D65"}}}}],
        "integrator": {{"spp": {spp}}}}}"#,
        size[0], size[1]
    );
    let mut scene: Scene = parse(&text, "square.json").unwrap_or_else(|e| panic!("{e}")).0;
    scene.materials[0].kind = MaterialKind::Lambert { reflectance: SpectrumTexture::Image(texture) };
    let prepared = prepare(&scene).unwrap();
    let film = prepared.render(&prepared.whole(Some(2)), &|_| Control::Continue).unwrap();
    film.linear_rec709().iter().map(|p| p.map(f64::from)).collect()
}

const SQUARE: &str = r#"{"type": "parallelogram", "origin_m": [0, 0, 0], "u_m": [4, 0, 0], "v_m": [0, 2, 0]}"#;
/// The same square as a mesh whose texture coordinates say the same.
const MESH: &str = r#"{"type": "mesh", "vertices_m": [[0,0,0],[4,0,0],[4,2,0],[0,2,0]], "triangles": [[0,1,2],[0,2,3]],
    "uvs": [[0,0],[1,0],[1,1],[0,1]]}"#;

#[test]
fn every_texel_shows_its_colour_under_daylight() {
    // The white of the film is that of Rec. 709's four digits, 3e-4 beside the tabulated D65. 4096 Sobol points of four
    // wavelengths leave 2e-3 (measured against a run of ten times as many).
    for shape in [SQUARE, MESH] {
        let pixels = picture(shape, texture(TextureFilter::Nearest), [4, 2], 4096);
        for (pixel, texel) in pixels.iter().zip(TEXELS) {
            for c in 0..3 {
                assert!((pixel[c] - f64::from(texel[c])).abs() < 4e-3, "{pixel:?} is not {texel:?}");
            }
        }
    }
    // A mutant, upside down, is far off.
    let mut upside_down = texture(TextureFilter::Nearest);
    upside_down.uv_map = UvMap::scaled([1.0, -1.0], [0.0, 1.0]);
    assert!((picture(SQUARE, upside_down, [4, 2], 64)[0][1] - 0.1).abs() > 0.5);
}

#[test]
fn a_mirrored_transform_turns_the_picture_about_and_leaves_the_texture_on_its_surface() {
    for shape in [SQUARE, MESH] {
        let straight = picture(shape, texture(TextureFilter::Nearest), [4, 2], 256);
        let text = format!(
            r#"{{"etalon": 1, "film": {{"width": 4, "height": 2}},
            "camera": {{"type": "orthographic", "position_m": [2, 1, 3], "direction": [0, 0, -1], "height_m": 2}},
            "objects": [{{"shape": {shape}, "material": {{"type": "lambert", "reflectance": 0.5}},
                "transform": [{{"scale": [-1, 1, 1]}}, {{"translate_m": [4, 0, 0]}}]}}],
            "lights": [{{"type": "environment", "radiance": {{"type": "illuminant", "name": "D65"}}}}],
            "integrator": {{"spp": 256}}}}"#
        );
        let mut scene = parse(&text, "square.json").unwrap().0;
        let reflectance = SpectrumTexture::Image(texture(TextureFilter::Nearest));
        scene.materials[0].kind = MaterialKind::Lambert { reflectance };
        let prepared = prepare(&scene).unwrap();
        let film = prepared.render(&prepared.whole(Some(2)), &|_| Control::Continue).unwrap();
        for (i, mirrored) in film.linear_rec709().iter().enumerate() {
            let other = straight[i / 4 * 4 + 3 - i % 4];
            for c in 0..3 {
                // Other random numbers: the noise of 256 points.
                assert!((f64::from(mirrored[c]) - other[c]).abs() < 0.03, "{mirrored:?} is not {other:?}");
            }
        }
    }
}

/// A textured body in a furnace shows its texture: the mean over the picture is the mean of the texels, which bilinear
/// interpolation keeps where the image repeats.
#[test]
fn interpolation_keeps_the_mean() {
    let mut repeated = texture(TextureFilter::Bilinear);
    repeated.wrap = [Wrap::Repeat; 2];
    let pixels = picture(SQUARE, repeated, [16, 8], 256);
    for c in 0..3 {
        let shown = pixels.iter().map(|p| p[c]).sum::<f64>() / pixels.len() as f64;
        let texels = TEXELS.iter().map(|t| f64::from(t[c])).sum::<f64>() / 8.0;
        // 32,768 points.
        assert!((shown - texels).abs() < 4e-3, "{shown} is not {texels}");
    }
}

#[test]
fn white_texels_are_white_at_every_wavelength() {
    let mut white = texture(TextureFilter::Bilinear);
    white.image = Arc::new(Image::new(1, 1, Texels::Srgb8(vec![[255; 3]])));
    // Each sample is worth the sky itself, as with the constant reflectance 1: the same noise.
    let shown = picture(SQUARE, white, [2, 2], 64);
    let text = format!(
        r#"{{"etalon": 1, "film": {{"width": 2, "height": 2}},
        "camera": {{"type": "orthographic", "position_m": [2, 1, 3], "direction": [0, 0, -1], "height_m": 2}},
        "objects": [{{"shape": {SQUARE}, "material": {{"type": "lambert", "reflectance": 1}}}}],
        "lights": [{{"type": "environment", "radiance": {{"type": "illuminant", "name": "D65"}}}}],
        "integrator": {{"spp": 64}}}}"#
    );
    let prepared = prepare(&parse(&text, "white.json").unwrap().0).unwrap();
    let film = prepared.render(&prepared.whole(Some(2)), &|_| Control::Continue).unwrap();
    for (pixel, white) in shown.iter().zip(film.linear_rec709()) {
        for c in 0..3 {
            // One path may end by roulette where the other's throughput was rounded below 1: not in an open scene.
            assert!((pixel[c] - f64::from(white[c])).abs() < 1e-1, "{pixel:?} is not {white:?}");
        }
    }
}
