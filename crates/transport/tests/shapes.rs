//! What becomes of a scene's shapes: which object they belong to, where transforms put them, and what is left out of meshes.

use etalon_scene::{Image, ImageTexture, MaterialKind, SpectrumTexture, Texels, TextureFilter};
use etalon_transport::{Study, prepare};
use serde_json::{Value, json};

use crate::common::rendering::{mean_y, parse, render};

/// Objects and more, seen from above: x to the right and y upward, 4 m by 2 m about the origin.
fn scene(more: &[(&str, Value)], size: [u32; 2], spp: u32) -> Value {
    let mut scene = json!({
        "etalon": 1,
        "camera": {"type": "orthographic", "position_m": [0, 0, 8], "direction": [0, 0, -1], "up": [0, 1, 0], "height_m": 2},
        "film": {"width": size[0], "height": size[1]},
        "integrator": {"spp": spp}
    });
    for (key, value) in more {
        scene[key] = value.clone();
    }
    scene
}

/// A square of 1 m whose lower left corner is at x, −½, and that shines.
fn square(x: f64, radiance: f64) -> Value {
    json!({"shape": {"type": "parallelogram", "origin_m": [x, -0.5, 0], "u_m": [1, 0, 0], "v_m": [0, 1, 0]},
        "material": {"type": "black"}, "emission": {"radiance": radiance}})
}

#[test]
fn every_object_shines_as_it_says_wherever_it_is_listed() {
    let groups = json!({
        "first": {"objects": [square(-2.0, 1.0), square(-1.0, 2.0)]},
        "second": {"objects": [square(0.0, 4.0), square(0.0, 8.0)]},
        "third": {"objects": [square(-0.5, 16.0)]}
    });
    let instances = json!([{"group": "first"}, {"group": "second", "transform": [{"translate_m": [1, 0, -1]}]},
        {"group": "third", "transform": [{"translate_m": [0.5, 0, 1]}]}]);
    // Of the two at one place the first is seen.
    for (more, want) in [
        (
            vec![("objects", json!([square(-2.0, 1.0), square(-1.0, 2.0), square(0.0, 16.0), square(1.0, 4.0)]))],
            [1, 2, 16, 4],
        ),
        (vec![("groups", groups), ("instances", instances)], [1, 2, 16, 4]),
    ] {
        let film = render(&parse(&scene(&more, [4, 2], 16).to_string()), &Study::default());
        let ys: Vec<f64> = film.xyz().map(|xyz| xyz[1]).collect();
        for (pixel, y) in ys.iter().enumerate() {
            let [unit, want] = [ys[0], f64::from(want[pixel % 4])];
            assert!((y / unit - want).abs() < 1e-6 * want, "{ys:?}");
        }
    }
}

/// Two lamps 10 m above a floor, as shadow rays find them.
#[test]
fn every_lamp_lights_as_it_says() {
    let lit = |radiances: [f64; 2]| {
        let lamps = radiances.map(|radiance| {
            let shape = json!({"type": "disk", "center_m": [0, 0, 10], "normal": [0, 0, -1], "radius_m": 0.5});
            json!({"shape": shape, "material": {"type": "black"}, "emission": {"radiance": radiance}})
        });
        let floor = json!({"shape": {"type": "disk", "normal": [0, 0, 1], "radius_m": 4}, "material": {"type": "lambert", "reflectance": 0.5}});
        let objects = json!([lamps[0], floor, lamps[1]]);
        let mut scene = scene(&[("objects", objects)], [8, 4], 64);
        scene["integrator"]["light_sampling"] = json!("light");
        mean_y(&render(&parse(&scene.to_string()), &Study::default()))
    };
    let even = lit([2.0, 2.0]);
    assert!(even > 0.0);
    for radiances in [[1.0, 3.0], [3.0, 1.0]] {
        // 2048 points on lamps that are seen under angles which differ by less than 1 %, and of which either is chosen by its power.
        assert!((lit(radiances) / even - 1.0).abs() < 0.01, "{radiances:?}");
    }
}

#[test]
fn a_shape_that_is_scaled_and_moved_is_the_shape_that_says_so() {
    let steps = json!([{"scale": 2}, {"translate_m": [0.5, 0.25, -1]}]);
    let shapes = [
        (
            json!({"type": "sphere", "center_m": [0, 0, 1], "radius_m": 0.25}),
            json!({"type": "sphere", "center_m": [0.5, 0.25, 1], "radius_m": 0.5}),
        ),
        (
            json!({"type": "disk", "center_m": [-0.5, 0, 0], "normal": [0, 0, 1], "radius_m": 0.25}),
            json!({"type": "disk", "center_m": [-0.5, 0.25, -1], "normal": [0, 0, 1], "radius_m": 0.5}),
        ),
        (
            json!({"type": "cylinder", "start_m": [-0.5, 0, 0], "end_m": [0.25, 0, 0], "radius_m": 0.25, "capped": true}),
            json!({"type": "cylinder", "start_m": [-0.5, 0.25, -1], "end_m": [1, 0.25, -1], "radius_m": 0.5, "capped": true}),
        ),
        (
            json!({"type": "parallelogram", "origin_m": [0, 0, 0], "u_m": [0.5, 0, 0], "v_m": [0, 0.25, 0]}),
            json!({"type": "parallelogram", "origin_m": [0.5, 0.25, -1], "u_m": [1, 0, 0], "v_m": [0, 0.5, 0]}),
        ),
        (
            json!({"type": "mesh", "vertices_m": [[0, 0, 0], [0.5, 0, 0], [0, 0.25, 0.25]], "triangles": [[0, 1, 2]]}),
            json!({"type": "mesh", "vertices_m": [[0.5, 0.25, -1], [1.5, 0.25, -1], [0.5, 0.75, -0.5]], "triangles": [[0, 1, 2]]}),
        ),
    ];
    for (shape, stated) in shapes {
        let picture = |object: Value| {
            let sky = json!([{"type": "point", "position_m": [1, 1, 4], "intensity": 8}]);
            let objects = json!([object]);
            render(&parse(&scene(&[("objects", objects), ("lights", sky)], [16, 8], 4).to_string()), &Study::default())
        };
        let material = json!({"type": "lambert", "reflectance": 0.5});
        let placed = picture(json!({"shape": shape, "material": material, "transform": steps}));
        let stated = picture(json!({"shape": stated, "material": material}));
        assert!(mean_y(&stated) > 0.0);
        assert!(placed.pixels().eq(stated.pixels()), "{shape}");
    }
}

/// Two squares of two triangles each, with coordinates, and among them triangles so small that their corners are one where they are moved to.
#[test]
fn triangles_without_area_are_left_out_and_the_others_keep_their_coordinates() {
    let mesh = |triangles: Value| {
        let shape = json!({"type": "mesh", "triangles": triangles,
            "vertices_m": [[-2.5, -1.5, 0], [-0.5, -1.5, 0], [-0.5, 0.5, 0], [-2.5, 0.5, 0], [1.5, -1.5, 0], [1.5, 0.5, 0], [0, 0, 0], [1e-20, 0, 0], [0, 1e-20, 0]],
            "uvs": [[0, 0], [0.5, 0], [0.5, 1], [0, 1], [1, 0], [1, 1], [0, 0], [1, 0], [0, 1]]});
        let objects = json!([{"shape": shape, "material": {"type": "lambert", "reflectance": 0.5}, "transform": [{"translate_m": [0.5, 0.5, 0]}]}]);
        let sky = json!([{"type": "environment", "radiance": 1}]);
        let mut scene = parse(&scene(&[("objects", objects), ("lights", sky)], [4, 2], 64).to_string());
        let texels = [[0.9, 0.1, 0.1], [0.2, 0.8, 0.3], [0.1, 0.2, 0.95], [0.5, 0.5, 0.5]];
        let image = Image::new(4, 1, Texels::F32(texels.to_vec()));
        let texture = ImageTexture { filter: TextureFilter::Nearest, ..ImageTexture::new(image) };
        scene.materials[0].kind = MaterialKind::Lambert { reflectance: SpectrumTexture::Image(texture) };
        (prepare(&scene).unwrap().warnings().to_vec(), render(&scene, &Study::default()))
    };
    let (none, whole) = mesh(json!([[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]]));
    let (two, without) = mesh(json!([[6, 7, 8], [0, 1, 2], [0, 2, 3], [6, 8, 7], [1, 4, 5], [1, 5, 2]]));
    assert!(none.is_empty(), "{none:?}");
    assert!(two.len() == 1 && two[0].contains("2 of 6 triangles have no area"), "{two:?}");
    assert!(without.pixels().eq(whole.pixels()));
}
