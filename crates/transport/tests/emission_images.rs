//! Surfaces that shine by an image, against closed forms and against paths that find them without shadow rays.

use etalon_scene::{Image, ImageTexture, LightSampling, Scene, Texels, TextureFilter, UvMap, Wrap, parse};
use etalon_transport::{Control, EffectName, prepare};
use std::f64::consts::PI;

/// Columns from the left, all one row high.
fn columns(texels: &[[f32; 3]]) -> ImageTexture {
    ImageTexture {
        wrap: [Wrap::Clamp; 2],
        filter: TextureFilter::Nearest,
        ..ImageTexture::new(Image::new(texels.len() as u32, 1, Texels::F32(texels.to_vec())))
    }
}

/// The mean luminance of a picture, and its standard error by the scatter of its pixels, which share no random number.
fn luminance(scene: &Scene) -> (f64, f64) {
    let prepared = prepare(scene).unwrap();
    let film = prepared.render(&prepared.whole(Some(2)), &|_| Control::Continue).unwrap();
    let pixels = film.linear_rec709();
    let luminances: Vec<f64> = pixels
        .iter()
        .map(|[r, g, b]| 0.2126 * f64::from(*r) + 0.7152 * f64::from(*g) + 0.0722 * f64::from(*b))
        .collect();
    let n = luminances.len() as f64;
    let mean = luminances.iter().sum::<f64>() / n;
    let squares: f64 = luminances.iter().map(|v| (v - mean) * (v - mean)).sum();
    (mean, (squares / (n * (n - 1.0))).sqrt())
}

const DARK: &str = r#""material": {"type": "black"}, "emission": {"radiance": {"type": "illuminant", "name": "D65"}}"#;

/// A point of a floor, seen from the side, under what `lamps` says. All pixels see the same point to 10⁻⁵ m.
fn floor(lamps: &str, groups: &str, at: [f64; 2], image: &ImageTexture) -> Scene {
    let [x, y] = at;
    let text = format!(
        r#"{{"etalon": 1, "film": {{"width": 16, "height": 16}},
        "camera": {{"type": "orthographic", "position_m": [{x}, {}, 2], "direction": [0, 1, -1], "up": [0, 0, 1], "height_m": 1e-5,
            "shutter_s": [0, 1]}},
        "objects": [{{"shape": {{"type": "disk", "normal": [0, 0, 1], "radius_m": 9}},
            "material": {{"type": "lambert", "reflectance": 0.5}}}}{lamps}]{groups},
        "integrator": {{"spp": 1024, "replicates": 1}}}}"#,
        y - 2.0,
    );
    let mut scene = parse(&text, "floor.json").unwrap_or_else(|e| panic!("{e}")).0;
    let grouped = scene.groups.iter_mut().flat_map(|group| &mut group.objects);
    for emission in scene.objects.iter_mut().chain(grouped).filter_map(|object| object.emission.as_mut()) {
        emission.image = Some(image.clone());
    }
    scene
}

/// ∫ cos θ dω over a rectangle of x by y at the height 1, seen from below its corner; odd in both, so that corners may be subtracted.
fn corner(x: f64, y: f64) -> f64 {
    let part = |x: f64, y: f64| x / (1.0 + x * x).sqrt() * (y / (1.0 + x * x).sqrt()).atan();
    0.5 * (part(x, y) + part(y, x))
}

/// Lamps of 2 m by 1 m over x from −1 to 1 and y from 0 to 1 at the height 1, which shine down; u runs along +x.
fn lamps() -> Vec<(&'static str, String, String)> {
    let object = |shape: &str, more: &str| format!(r#", {{"shape": {shape}, {DARK}{more}}}"#);
    // u × v points down.
    let square = r#"{"type": "parallelogram", "origin_m": [-1, 1, 1], "u_m": [2, 0, 0], "v_m": [0, -1, 0]}"#;
    let mesh = r#"{"type": "mesh", "vertices_m": [[-1, 1, 1], [1, 1, 1], [1, 0, 1], [-1, 0, 1]], "triangles": [[0, 1, 2], [0, 2, 3]],
        "uvs": [[0, 0], [1, 0], [1, 1], [0, 1]]}"#;
    // The same mirrored in x, with u along −x, and mirrored back.
    let mirrored = r#"{"type": "mesh", "vertices_m": [[1, 1, 1], [-1, 1, 1], [-1, 0, 1], [1, 0, 1]], "triangles": [[0, 2, 1], [0, 3, 2]],
        "uvs": [[0, 0], [1, 0], [1, 1], [0, 1]]}"#;
    let back = r#", "transform": [{"scale": [-1, 1, 1]}]"#;
    // Turned by a quarter about z, and placed by an instance that turns it back and lifts it.
    let turned = r#"{"type": "mesh", "vertices_m": [[-1, -1, 0], [-1, 1, 0], [0, 1, 0], [0, -1, 0]], "triangles": [[0, 1, 2], [0, 2, 3]],
        "uvs": [[0, 0], [1, 0], [1, 1], [0, 1]]}"#;
    let placed = format!(
        r#", "groups": {{"lamp": {{"objects": [{{"shape": {turned}, {DARK}}}]}}}},
        "instances": [{{"group": "lamp", "transform": [{{"rotate": {{"axis": [0, 0, 1], "angle_deg": -90}}}}, {{"translate_m": [0, 0, 1]}}]}}]"#
    );
    vec![
        ("parallelogram", object(square, ""), String::new()),
        ("mesh", object(mesh, ""), String::new()),
        ("mirrored mesh", object(mirrored, back), String::new()),
        ("placed mesh", String::new(), placed),
    ]
}

/// Each at one in 10⁶ of a right renderer; the standard errors below resolve a bias of 1 % (what is round or moves: 2 %).
const Z: f64 = 4.9;

#[test]
fn a_lamp_of_two_halves_lights_a_floor_as_its_bright_half_does() {
    let image = columns(&[[3.0; 3], [0.0; 3]]);
    // The bright half reaches from x = −1 to 0, the point lies below x = ½ on the edge y = 0.
    let truth = 3.0 * 0.5 / PI * (corner(1.5, 1.0) - corner(0.5, 1.0));
    let mirrored = 3.0 * 0.5 / PI * 2.0 * corner(0.5, 1.0);
    assert!((mirrored / truth - 1.0).abs() > 1.0, "the wrong side must be told from the right one");
    for (name, objects, groups) in lamps() {
        for sampling in [LightSampling::Mis, LightSampling::Light, LightSampling::Bsdf] {
            let mut scene = floor(&objects, &groups, [0.5, 0.0], &image);
            scene.integrator.light_sampling = sampling;
            let (measured, error) = luminance(&scene);
            assert!(Z * error < 0.01 * truth, "{name}, {sampling:?}: {error} of {truth}");
            let z = (measured - truth) / error;
            assert!(z.abs() < Z, "{name}, {sampling:?}: {measured} ± {error} is not {truth} (z {z:.1})");
        }
        // The mutant: an image that runs the other way.
        let mut wrong = columns(&[[0.0; 3], [3.0; 3]]);
        let (measured, error) = luminance(&floor(&objects, &groups, [0.5, 0.0], &wrong));
        assert!((measured - truth) / error > 100.0 && (measured - mirrored).abs() < Z * error, "{name}: {measured}");
        // And put right by texture coordinates that run the other way.
        wrong.uv_map = UvMap::scaled([-1.0, 1.0], [1.0, 0.0]);
        let (measured, error) = luminance(&floor(&objects, &groups, [0.5, 0.0], &wrong));
        assert!((measured - truth).abs() < Z * error, "{name}, turned about: {measured} ± {error} is not {truth}");
    }
}

#[test]
fn what_is_round_shines_alike_whether_shadow_rays_or_paths_find_it() {
    let image = columns(&[[3.0, 1.0, 0.2], [0.0; 3], [0.3, 0.5, 2.0], [0.1; 3], [1.0; 3]]);
    for shape in [
        r#"{"type": "sphere", "center_m": [0.2, 0.4, 1], "radius_m": 0.6}"#,
        r#"{"type": "disk", "center_m": [0.2, 0.4, 1], "normal": [0.3, 0.1, -1], "radius_m": 0.8}"#,
        r#"{"type": "cylinder", "start_m": [-0.5, 0.4, 0.9], "end_m": [1, 0.6, 1.2], "radius_m": 0.4}"#,
    ] {
        let lamp = format!(r#", {{"shape": {shape}, {DARK}}}"#);
        let by = |sampling| {
            let mut scene = floor(&lamp, "", [0.4, 0.1], &image);
            scene.integrator.light_sampling = sampling;
            luminance(&scene)
        };
        let [(a, of_a), (b, of_b)] = [by(LightSampling::Light), by(LightSampling::Bsdf)];
        let error = of_a.hypot(of_b);
        assert!(Z * error < 0.02 * a, "{shape}: {error} of {a}");
        assert!((a - b).abs() < Z * error, "{shape}: {a} by shadow rays is not {b} by paths (± {error})");
    }
}

#[test]
fn a_moving_lamp_takes_its_image_along() {
    let (_, objects, _) = lamps().swap_remove(1);
    let moving = format!(
        r#", "groups": {{"lamp": {{"objects": [{}]}}}}, "instances": [{{"group": "lamp", "keyframes": [
            {{"time_s": 0}}, {{"time_s": 1, "transform": [{{"translate_m": [0.8, 0, 0]}}]}}]}}]"#,
        &objects[2..]
    );
    let image = columns(&[[3.0; 3], [0.0; 3]]);
    let by = |sampling| {
        let mut scene = floor("", &moving, [0.5, 0.0], &image);
        scene.integrator.light_sampling = sampling;
        luminance(&scene)
    };
    // The mean over the shutter: the bright half from x = −1 + s to s, s from 0 to 0.8, seen from x = ½.
    const STEPS: u32 = 10_000;
    let seen = |s: f64| corner(1.5 - s, 1.0) - corner(0.5 - s, 1.0);
    let mean = (0..STEPS).map(|i| seen(0.8 * (f64::from(i) + 0.5) / f64::from(STEPS))).sum::<f64>() / f64::from(STEPS);
    let truth = 3.0 * 0.5 / PI * mean;
    for sampling in [LightSampling::Mis, LightSampling::Light, LightSampling::Bsdf] {
        let (measured, error) = by(sampling);
        assert!(Z * error < 0.02 * truth, "{sampling:?}: {error} of {truth}");
        assert!((measured - truth).abs() < Z * error, "{sampling:?}: {measured} ± {error} is not {truth}");
    }
}

#[test]
fn every_texel_shines_with_its_colour_and_counts_as_an_image() {
    let texels = [[0.9, 0.1, 0.1], [0.2, 8.0, 0.3], [0.1, 0.2, 0.95], [5.0, 5.0, 5.0]];
    let text = format!(
        r#"{{"etalon": 1, "film": {{"width": 4, "height": 1}},
        "camera": {{"type": "orthographic", "position_m": [0, 0.5, -3], "direction": [0, 0, 1], "up": [0, -1, 0], "height_m": 0.5}},
        "objects": [{}], "integrator": {{"spp": 4096}}}}"#,
        &lamps()[0].1[2..]
    );
    let mut scene = parse(&text, "lamp.json").unwrap_or_else(|e| panic!("{e}")).0;
    assert!(!prepare(&scene).unwrap().plan().runs(EffectName::Textures));
    let emission = scene.objects[0].emission.as_mut().unwrap();
    emission.image = Some(columns(&texels));
    let prepared = prepare(&scene).unwrap();
    assert!(prepared.plan().runs(EffectName::Textures));
    let film = prepared.render(&prepared.whole(Some(2)), &|_| Control::Continue).unwrap();
    for (pixel, texel) in film.linear_rec709().iter().zip(texels) {
        let brightest = texel.into_iter().fold(0.0, f32::max);
        for c in 0..3 {
            // 4096 points of eight wavelengths leave 10⁻³ of the brightest channel, and the white of the film has four digits.
            assert!((pixel[c] - texel[c]).abs() < 3e-3 * brightest, "{pixel:?} is not {texel:?}");
        }
    }
}
