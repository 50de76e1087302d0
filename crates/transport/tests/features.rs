//! First-hit features: each has an answer that the scene states.

use etalon_scene::Scene;
use etalon_transport::{Features, Prepared, prepare};
use serde_json::{Value, json};

fn scene(objects: &Value) -> Scene {
    let json = json!({
        "etalon": 1,
        "camera": {"type": "perspective", "position_m": [0, 0, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40},
        "film": {"width": 24, "height": 16},
        "objects": objects,
        "lights": [{"type": "environment", "radiance": 1}]
    });
    etalon_scene::parse(&json.to_string(), "test").unwrap_or_else(|e| panic!("{e:?}")).0
}

fn features(objects: &Value, samples: u32) -> (Prepared, Vec<Features>) {
    let prepared = prepare(&scene(objects)).unwrap();
    let rect = prepared.whole(None).rect;
    let one = prepared.features(&[rect], samples, Some(1)).unwrap().remove(0);
    // Neither threads nor the division into rectangles change anything.
    let tiles = rect.tiles(7);
    let by_tiles = prepared.features(&tiles, samples, Some(2)).unwrap();
    for (tile, features) in tiles.iter().zip(by_tiles) {
        for ((x, y), feature) in tile.pixels().zip(features) {
            assert_eq!(feature, one[(y * 24 + x) as usize]);
            assert_eq!(Features::from_array(feature.to_array()), feature);
        }
    }
    (prepared, one)
}

fn near(a: &[f32], b: &[f32], tolerance: f32) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance)
}

#[test]
fn a_ball_has_its_own_position_and_normal_and_the_sky_has_none() {
    let ball =
        json!([{"shape": {"type": "sphere", "radius_m": 1}, "material": {"type": "lambert", "reflectance": 0.25}}]);
    // A single ray a pixel, of which every number is a point's.
    let (_, pixels) = features(&ball, 1);
    let (hits, misses): (Vec<Features>, Vec<Features>) = pixels.iter().partition(|pixel| pixel.object > 0.0);
    assert!(hits.len() > 50 && misses.len() > 50);
    for pixel in hits {
        let length = pixel.position_m.iter().map(|v| v * v).sum::<f32>().sqrt();
        // Single precision, and what a hit's position is rounded to.
        assert!((length - 1.0).abs() < 1e-6, "{pixel:?}");
        assert!(near(&pixel.normal, &pixel.position_m, 1e-6), "{pixel:?}");
        assert!((pixel.depth_m - (4.0 - pixel.position_m[2])).abs() < 1e-6, "{pixel:?}");
        assert!(near(&pixel.albedo, &[0.25; 3], 1e-6), "{pixel:?}");
    }
    for pixel in misses {
        assert_eq!(pixel, Features::default());
    }
}

#[test]
fn depth_is_along_the_view_and_normals_face_the_camera() {
    // Its own normal points away from the camera.
    let wall = json!([{
        "shape": {"type": "parallelogram", "origin_m": [-5, -5, 1], "u_m": [0, 10, 0], "v_m": [10, 0, 0]},
        "material": {"type": "lambert", "reflectance": 0.5}
    }]);
    let (_, pixels) = features(&wall, 16);
    for pixel in pixels {
        assert!((pixel.depth_m - 3.0).abs() < 1e-6 && near(&pixel.normal, &[0.0, 0.0, 1.0], 1e-6), "{pixel:?}");
        assert!((pixel.position_m[2] - 1.0).abs() < 1e-6);
        // The first edge is upward: u is the height above the corner, v the distance to its right, both over ten metres.
        let [x, y, _] = pixel.position_m;
        assert!(near(&pixel.uv, &[(y + 5.0) / 10.0, (x + 5.0) / 10.0], 1e-6), "{pixel:?}");
    }
}

#[test]
fn the_albedo_is_the_share_that_a_material_scatters_and_has_its_colour() {
    let ball = |material: Value| json!([{"shape": {"type": "sphere", "radius_m": 2}, "material": material}]);
    let middle = |material: Value| features(&ball(material), 64).1[8 * 24 + 12].albedo;
    for material in [
        json!({"type": "mirror", "reflectance": 1}),
        json!({"type": "dielectric", "interior": 1.5}),
        json!({"type": "lambert", "reflectance": 1}),
    ] {
        assert!(near(&middle(material.clone()), &[1.0; 3], 1e-5), "{material}: {:?}", middle(material.clone()));
    }
    for rgb in [[0.8, 0.2, 0.1], [0.1, 0.5, 0.3], [0.2, 0.3, 0.9]] {
        let albedo = middle(json!({"type": "lambert", "reflectance": {"type": "rgb", "rgb": rgb}}));
        // Sixteen wavelengths stand for a smooth spectrum.
        assert!(near(&albedo, &rgb, 0.02), "{albedo:?} is not {rgb:?}");
    }
}

#[test]
fn objects_are_told_apart_by_number_and_name() {
    let two = json!([
        {"name": "left", "shape": {"type": "sphere", "center_m": [-1, 0, 0], "radius_m": 0.9}, "material": {"type": "mirror", "reflectance": 1}},
        {"name": "right", "shape": {"type": "sphere", "center_m": [1, 0, 0], "radius_m": 0.9}, "material": {"type": "mirror", "reflectance": 1}}
    ]);
    let (prepared, pixels) = features(&two, 32);
    assert_eq!(prepared.object_names(), ["left", "right"]);
    let row = &pixels[8 * 24..9 * 24];
    assert!(row[..12].iter().all(|pixel| pixel.object == 1.0 || pixel.object == 0.0));
    assert!(row[12..].iter().all(|pixel| pixel.object == 2.0 || pixel.object == 0.0));
    assert!((row[7].object, row[16].object) == (1.0, 2.0), "{row:?}");
    // Of a pixel that sees two it is the one that more rays meet, in whichever order they are listed. The pixel on the right of the
    // middle is 0.182 m wide.
    for (border, seen) in [(0.04, "right"), (0.14, "left")] {
        for order in [[0, 1], [1, 0]] {
            let half = |x: f64, name: &str| {
                let shape =
                    json!({"type": "parallelogram", "origin_m": [x, -9, 0], "u_m": [9, 0, 0], "v_m": [0, 18, 0]});
                json!({"name": name, "shape": shape, "material": {"type": "black"}})
            };
            let halves = [half(border - 9.0, "left"), half(border, "right")];
            let (prepared, pixels) = features(&json!(order.map(|i| halves[i].clone())), 64);
            let names = prepared.object_names();
            for (x, name) in [(11, "left"), (12, seen), (13, "right")] {
                assert_eq!(names[pixels[8 * 24 + x].object as usize - 1], name, "{x} {order:?}");
            }
        }
    }
}

/// A wall seen through another.
#[test]
fn what_a_mask_lets_through_is_of_what_is_behind_it() {
    let objects = |opacity: f64| {
        json!([
            {"shape": {"type": "disk", "center_m": [0, 0, 2], "normal": [0, 0, 1], "radius_m": 9}, "opacity": opacity,
                "material": {"type": "lambert", "reflectance": 0.5}},
            {"shape": {"type": "disk", "center_m": [0, 0, -2], "normal": [0, 0, 1], "radius_m": 9},
                "material": {"type": "lambert", "reflectance": 0.25}}
        ])
    };
    for opacity in [0.0, 0.25, 1.0] {
        let (_, pixels) = features(&objects(opacity), 64);
        let mean =
            |of: fn(&Features) -> f32| pixels.iter().map(|p| f64::from(of(p))).sum::<f64>() / pixels.len() as f64;
        // 24,576 Sobol points of a yes or no, which would scatter by 0.003 if they were random.
        assert!((mean(|p| p.depth_m) - (opacity * 2.0 + (1.0 - opacity) * 6.0)).abs() < 0.02, "{opacity}");
        assert!((mean(|p| p.albedo[1]) - (opacity * 0.5 + (1.0 - opacity) * 0.25)).abs() < 0.002, "{opacity}");
    }
}
