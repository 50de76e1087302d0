//! Chequerboards of Mitsuba and pbrt lie where they lie there.

use etalon_scene::{ImageTexture, MaterialKind, Scene, SpectrumTexture};

use super::{imported, on_its_side, said, scene};

fn board(scene: &Scene) -> &ImageTexture {
    match on_its_side(&scene.materials[scene.objects[0].material].kind) {
        MaterialKind::Lambert { reflectance: SpectrumTexture::Image(image) } => image,
        other => panic!("a chequerboard, not {other:?}"),
    }
}

fn mitsuba(keys: &str) -> String {
    format!(
        r#"<scene version="3.0.0"><shape type="rectangle"><bsdf type="diffuse"><texture type="checkerboard" name="reflectance">
        {keys}</texture></bsdf></shape></scene>"#
    )
}

#[test]
fn fields_of_mitsuba_are_half_a_unit_wide() {
    let keys = r#"<rgb name="color0" value="0.75, 0.5, 0.25"/><float name="color1" value="0.125"/>
        <transform name="to_uv"><scale x="2" y="3"/><translate x="0.25"/></transform>"#;
    let imported = imported("xml", &mitsuba(keys));
    assert!(said(&imported).is_empty(), "{:?}", said(&imported));
    let scene = scene(&imported);
    for i in 0..40 {
        for k in 0..40 {
            let (u, v) = ((f64::from(i) + 0.3) / 40.0, (f64::from(k) + 0.7) / 40.0);
            // As the plugin's documentation says: the fractions of both coordinates lie on the same side of a half.
            let [x, y] = [2.0 * u + 0.25, 3.0 * v].map(|t| t - t.floor() > 0.5);
            let expected = if x == y { [0.75, 0.5, 0.25] } else { [0.125; 3] };
            assert_eq!(board(&scene).eval([u, v]), expected, "{u} {v}");
        }
    }
    // Left out, they are 0.4 and 0.2.
    let plain = super::scene(&super::imported("xml", &mitsuba("")));
    let near = |a: [f64; 3], b: f64| a.iter().all(|v| (v - b).abs() < 1e-7);
    assert!(near(board(&plain).eval([0.1, 0.1]), 0.4) && near(board(&plain).eval([0.6, 0.1]), 0.2));
}

#[test]
fn fields_of_pbrt_are_a_unit_wide() {
    let text = r#"WorldBegin
Texture "board" "spectrum" "checkerboard" "float uscale" 4 "float vscale" 6 "rgb tex1" [ 0.75 0.5 0.25 ] "rgb tex2" [ 0.125 0.125 0.125 ]
Texture "half" "spectrum" "scale" "texture tex" "board" "float scale" 0.5
Material "diffuse" "texture reflectance" "NAME"
Shape "trianglemesh" "point3 P" [ 0 0 0 1 0 0 0 1 0 ] "integer indices" [ 0 1 2 ] "point2 uv" [ 0 0 1 0 0 1 ]
"#;
    for (name, factor) in [("board", 1.0), ("half", 0.5)] {
        let imported = imported("pbrt", &text.replace("NAME", name));
        assert!(said(&imported).is_empty(), "{:?}", said(&imported));
        let scene = scene(&imported);
        for i in 0..40 {
            for k in 0..40 {
                let (u, v) = ((f64::from(i) + 0.3) / 40.0, (f64::from(k) + 0.7) / 40.0);
                let even = ((4.0 * u).floor() + (6.0 * v).floor()) as i64 % 2 == 0;
                let expected = if even { [0.75, 0.5, 0.25] } else { [0.125; 3] };
                assert_eq!(board(&scene).eval([u, v]), expected.map(|c| factor * c), "{name}: {u} {v}");
            }
        }
    }
}

#[test]
fn what_a_chequerboard_cannot_be_here_is_listed() {
    let solid = r#"WorldBegin
Texture "board" "spectrum" "checkerboard" "integer dimension" 3 "float tex1" 0.75 "float tex2" 0.25
Material "diffuse" "texture reflectance" "board"
Shape "sphere"
"#;
    let imported = imported("pbrt", solid);
    assert!(said(&imported)[0].contains("becomes its mean"), "{:?}", said(&imported));
}

#[test]
fn a_turned_chequerboard_of_mitsuba_stays_turned() {
    let turned = imported("xml", &mitsuba(r#"<transform name="to_uv"><rotate z="1" angle="30"/></transform>"#));
    assert!(said(&turned).is_empty(), "{:?}", said(&turned));
    let scene = scene(&turned);
    let (sin, cos) = 30.0_f64.to_radians().sin_cos();
    for i in 0..40 {
        for k in 0..40 {
            let (u, v) = ((f64::from(i) + 0.3) / 40.0, (f64::from(k) + 0.7) / 40.0);
            let [x, y] = [u * cos - v * sin, u * sin + v * cos].map(|t| t - t.floor() > 0.5);
            let expected: f64 = if x == y { 0.4 } else { 0.2 };
            assert!((board(&scene).eval([u, v])[0] - expected).abs() < 1e-7, "{u} {v}");
        }
    }
}

#[test]
fn chequerboards_of_numbers_are_images_of_their_own() {
    let board = r#"<texture type="checkerboard" name="NAME"><float name="color0" value="0.25"/><float name="color1" value="0.75"/>
        <transform name="to_uv"><scale x="2" y="3"/></transform></texture>"#;
    let blend = format!(
        r#"<scene version="3.0.0"><shape type="rectangle"><bsdf type="blendbsdf">{}<bsdf type="diffuse"/><bsdf type="plastic"/>
        </bsdf></shape></scene>"#,
        board.replace("NAME", "weight")
    );
    let imported = imported("xml", &blend);
    assert!(said(&imported).is_empty(), "{:?}", said(&imported));
    let scene = scene(&imported);
    let MaterialKind::Blend { by, .. } = &scene.materials[scene.objects[0].material].kind else { panic!("a blend") };
    for (u, v) in [(0.1, 0.1), (0.3, 0.1), (0.1, 0.2), (0.4, 0.3), (0.9, 0.95)] {
        let [x, y] = [2.0 * u, 3.0 * v].map(|t: f64| t - t.floor() > 0.5);
        // Numbers lie the other way round than colours there.
        let expected = if x == y { 0.75 } else { 0.25 };
        assert!((by.eval([u, v]) - expected).abs() < 1e-5, "{u} {v}: {}", by.eval([u, v]));
    }
}
