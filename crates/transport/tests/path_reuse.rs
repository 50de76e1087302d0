//! Paths that neighbouring pixels share: the same by both loops and in any part of a picture.

use etalon_scene::{PathReuse, Scene};
use etalon_transport::{Control, Extent, Film, PathLoop, PixelRect, Prepared, Study, prepare_study};

mod common;

const REPLICATES: u32 = 16;

fn prepared(scene: &Scene, path_loop: PathLoop) -> Prepared {
    prepare_study(scene, &Study { path_loop: Some(path_loop), ..Study::default() }).unwrap()
}

fn render(prepared: &Prepared, extent: &Extent) -> Film {
    prepared.render(extent, &|_| Control::Continue).unwrap()
}

/// A closed room whose walls shine, with things in it that stand between its parts.
fn room() -> Scene {
    let flat = |origin: &str, u: &str, v: &str, albedo: f64| {
        format!(
            r#"{{"shape": {{"type": "parallelogram", "origin_m": {origin}, "u_m": {u}, "v_m": {v}}},
                "material": {{"type": "lambert", "reflectance": {albedo}}},
                "emission": {{"radiance": {}, "sides": "both"}}}}"#,
            1.0 - albedo
        )
    };
    let objects = [
        flat("[-1, -1, -1]", "[2, 0, 0]", "[0, 2, 0]", 0.5),
        flat("[-1, -1, 1]", "[2, 0, 0]", "[0, 2, 0]", 0.5),
        flat("[-1, -1, -1]", "[2, 0, 0]", "[0, 0, 2]", 0.9),
        flat("[-1, 1, -1]", "[2, 0, 0]", "[0, 0, 2]", 0.5),
        flat("[-1, -1, -1]", "[0, 2, 0]", "[0, 0, 2]", 0.5),
        flat("[1, -1, -1]", "[0, 2, 0]", "[0, 0, 2]", 0.5),
        flat("[-0.3, -1, -0.5]", "[0, 1.4, 0]", "[0.4, 0, 0.9]", 0.8),
        flat("[0.5, 0.2, -0.9]", "[0, 0.7, 0]", "[-0.7, 0, 0.3]", 0.5),
        r#"{"shape": {"type": "sphere", "center_m": [0.5, -0.6, -0.2], "radius_m": 0.35},
            "material": {"type": "dielectric", "interior": 1.5}}"#
            .to_owned(),
        r#"{"shape": {"type": "sphere", "center_m": [-0.6, -0.6, 0.1], "radius_m": 0.3}, "material": {"type": "mirror"}}"#
            .to_owned(),
    ];
    let json = format!(
        r#"{{"etalon": 1, "film": {{"width": 8, "height": 8}}, "integrator": {{"spp": 2048, "replicates": {REPLICATES}, "path_reuse": "4x4"}},
            "camera": {{"type": "perspective", "position_m": [0.1, 0.2, 0.9], "look_at_m": [0, 0, -1], "vertical_fov_deg": 80}},
            "objects": [{}]}}"#,
        objects.join(",")
    );
    etalon_scene::parse(&json, "room").unwrap().0
}

/// The ready-made scenes, small: of an odd size, so that some blocks are cut off by the film.
#[test]
fn many_paths_at_once_share_as_the_plain_loop_does() {
    let mut covered = 0;
    let blocks = [PathReuse::Block2x2, PathReuse::Block4x2, PathReuse::Block4x4];
    for ((name, mut scene), reuse) in common::ready_made([13, 10], 4).into_iter().zip(blocks.into_iter().cycle()) {
        scene.integrator.path_reuse = reuse;
        let study = Study { path_loop: Some(PathLoop::Lanes), ..Study::default() };
        let Ok(lanes) = prepare_study(&scene, &study) else { continue };
        let plain = prepared(&scene, PathLoop::Plain);
        let (lanes, plain) = (render(&lanes, &lanes.whole(Some(2))), render(&plain, &plain.whole(Some(2))));
        assert_eq!(lanes.counters, plain.counters, "{name}, {reuse:?}");
        assert!(lanes == plain, "{name}, {reuse:?}: the films differ");
        covered += 1;
    }
    assert!(covered >= 5, "only {covered} were covered");
}

#[test]
fn a_pixel_is_the_same_in_any_part_of_the_picture() {
    let mut scene = room();
    (scene.film.width, scene.film.height, scene.integrator.spp) = (22, 19, 16);
    for path_loop in [PathLoop::Plain, PathLoop::Lanes] {
        let prepared = prepared(&scene, path_loop);
        let whole = render(&prepared, &prepared.whole(Some(2)));
        let crop = PixelRect { x0: 3, y0: 5, x1: 21, y1: 18 };
        let part = render(&prepared, &Extent { rect: crop, ..prepared.whole(Some(1)) });
        for (x, y) in crop.pixels() {
            assert_eq!(part.pixel(x, y), whole.pixel(x, y), "{path_loop:?}: {x}, {y}");
        }
        // Samples in pieces, too.
        let mut pieces = prepared.film();
        for samples in [0..5, 5..16] {
            let extent = Extent { samples, ..prepared.whole(Some(2)) };
            prepared.render_onto(&mut pieces, &extent, &|_| Control::Continue).unwrap();
        }
        assert!(pieces.pixels().eq(whole.pixels()), "{path_loop:?}");
    }
}

#[test]
fn where_paths_cannot_be_shared_the_scene_is_refused_with_the_reason() {
    let mut scene = room();
    scene.integrator.precision = etalon_scene::Precision::F32;
    let refused = prepare_study(&scene, &Study::default()).map(|_| ()).unwrap_err().to_string();
    assert_eq!(refused, "neighbouring pixels cannot share paths: wavelengths are carried in single precision");
}
