//! A picture under way: divided, put down and taken up without a byte changed.

use etalon_control::{Canvas, Shard};
use etalon_transport::{Control, Prepared, TileSums, prepare};
use serde_json::json;

/// A room of 40 × 30 pixels, which cut tiles, with 8 samples each: a mirror, glass, and lamps of several kinds.
fn room() -> Prepared {
    let wall = |origin: [f64; 3], u: [f64; 3], v: [f64; 3], material: &str| json!({"material": material, "shape": {"type": "parallelogram", "origin_m": origin, "u_m": u, "v_m": v}});
    let json = json!({
        "etalon": 1,
        "camera": {
            "type": "perspective", "position_m": [0.0, 1.0, 3.5], "look_at_m": [0.0, 0.9, 0.0],
            "vertical_fov_deg": 40, "lens": {"radius_m": 0.02, "focus_distance_m": 3.5}
        },
        "film": {"width": 40, "height": 30},
        "materials": {
            "white": {"type": "lambert", "reflectance": 0.7},
            "mirror": {"type": "mirror", "reflectance": 0.9},
            "glass": {"type": "dielectric", "interior": "N-BK7"},
            "black": {"type": "black"}
        },
        "objects": [
            wall([-1.0, 0.0, -1.0], [0.0, 0.0, 5.0], [2.0, 0.0, 0.0], "white"),
            wall([-1.0, 0.0, -1.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], "white"),
            wall([1.0, 0.0, -1.0], [0.0, 0.0, 5.0], [0.0, 2.0, 0.0], "mirror"),
            {
                "material": "black", "emission": {"radiance": {"type": "illuminant", "name": "D65", "scale": 8}},
                "shape": {"type": "disk", "center_m": [0.0, 1.99, 0.0], "normal": [0, -1, 0], "radius_m": 0.3}
            },
            {"material": "glass", "shape": {"type": "sphere", "center_m": [0.4, 0.4, 0.4], "radius_m": 0.4}}
        ],
        "lights": [{"type": "point", "position_m": [0.5, 1.5, 1.5], "intensity": 0.2}, {"type": "environment", "radiance": 0.2}],
        "integrator": {"spp": 8, "seed": 11}
    });
    let (scene, _) = etalon_scene::parse(&json.to_string(), "room").unwrap_or_else(|errors| panic!("{errors}"));
    prepare(&scene).unwrap()
}

/// Renders a share of the picture, putting it down as bytes after every stage and taking it up on a new canvas.
fn by_stages(prepared: &Prepared, shard: Shard, stages: &[u32]) -> Canvas {
    let rect = prepared.whole(None).rect;
    let mut canvas = Canvas::new(prepared, rect, shard, None);
    for &samples in stages {
        canvas.advance(prepared, &|_| samples, Some(2), &|_| Control::Continue).unwrap();
        let next = Canvas::new(prepared, rect, shard, None);
        for number in 0..canvas.tiles() {
            let (tile, sums) = canvas.tile(number);
            let replicates = prepared.scene().integrator.replicates;
            let sums =
                TileSums::from_bytes(&sums.to_bytes(), tile.rect.area(), replicates, prepared.band_sums()).unwrap();
            assert!(next.take_up(&tile, &sums));
            assert!(!next.take_up(&tile, &sums), "a tile was taken up twice");
        }
        canvas = next;
    }
    canvas
}

#[test]
fn a_picture_put_down_divided_and_taken_up_has_the_same_bytes() {
    let prepared = room();
    let film = prepared.render(&prepared.whole(Some(1)), &|_| Control::Continue).unwrap();
    assert_eq!(by_stages(&prepared, Shard::WHOLE, &[1, 2, 7, 8]).into_film(), film);
    for of in [2, 3, 6] {
        let whole = Canvas::new(&prepared, prepared.whole(None).rect, Shard::WHOLE, None);
        for index in 0..of {
            let part = by_stages(&prepared, Shard { index, of }, &[3, 8]);
            (0..part.tiles()).for_each(|number| {
                let (tile, sums) = part.tile(number);
                assert!(whole.take_up(&tile, &sums));
            });
        }
        assert_eq!(whole.into_film(), film, "{of} parts");
    }
}

#[test]
fn a_canvas_that_is_stopped_goes_on_where_it_was() {
    let prepared = room();
    let film = prepared.render(&prepared.whole(Some(1)), &|_| Control::Continue).unwrap();
    let canvas = Canvas::new(&prepared, prepared.whole(None).rect, Shard::WHOLE, None);
    canvas.advance(&prepared, &|_| 8, Some(1), &|_| Control::Stop).unwrap();
    assert_eq!(canvas.samples(), [0, 8]);
    canvas.advance(&prepared, &|_| 5, Some(2), &|_| Control::Continue).unwrap();
    assert_eq!(canvas.samples(), [5, 8]);
    canvas.advance(&prepared, &|_| 8, Some(2), &|_| Control::Continue).unwrap();
    assert_eq!(canvas.into_film(), film);
}
