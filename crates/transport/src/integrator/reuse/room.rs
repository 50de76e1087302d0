//! A room for tests of paths that pixels share.

use etalon_scene::Scene;

/// A closed room whose walls emit 1/2 and reflect half, with things in it that stand between its parts: an opaque block like the walls, a
/// mirror, a glass ball. Radiance is 1 everywhere and in every direction. One wall emits .1 and reflects .9, so that what
/// paths bring differs.
pub(crate) fn room(replicates: u32) -> Scene {
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
        r#"{{"etalon": 1, "film": {{"width": 8, "height": 8}}, "integrator": {{"spp": 2048, "replicates": {replicates}, "path_reuse": "4x4"}},
            "camera": {{"type": "perspective", "position_m": [0.1, 0.2, 0.9], "look_at_m": [0, 0, -1], "vertical_fov_deg": 80}},
            "objects": [{}]}}"#,
        objects.join(",")
    );
    etalon_scene::parse(&json, "room").unwrap().0
}
