//! Cameras: angles of view, sizes, parallel rays.

use super::*;

fn camera(camera: &str, film: &str) -> Camera {
    scene(&Parts { camera, film, ..RIGHT }.text()).camera
}

fn fov_rad(camera: &Camera) -> f64 {
    match camera.projection {
        Projection::Perspective { vertical_fov_rad, .. } => vertical_fov_rad,
        _ => panic!("perspective"),
    }
}

#[test]
fn the_angle_of_view_can_be_said_in_four_ways() {
    let view = |rest: &str| {
        let text =
            format!("{{\"type\": \"perspective\", \"position_m\": [0, 0, 5], \"look_at_m\": [0, 0, 0], {rest}}}");
        fov_rad(&camera(&text, "{\"width\": 200, \"height\": 100}"))
    };
    assert_eq!(view("\"vertical_fov_deg\": 90"), FRAC_PI_2);
    // A few roundings.
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-15, "{a} {b}");
    near(view("\"horizontal_fov_deg\": 90"), 2.0 * 0.5_f64.atan());
    near(view("\"focal_length_m\": 0.05, \"sensor_height_m\": 0.1"), FRAC_PI_2);
    near(view("\"focal_length_m\": 0.05, \"sensor_width_m\": 0.1"), 2.0 * 0.5_f64.atan());
    // A lens of radius 0 focuses all the same: the sensor stands where the image is.
    near(
        view("\"focal_length_m\": 1, \"sensor_height_m\": 4, \"lens\": {\"radius_m\": 0, \"focus_distance_m\": 2}"),
        FRAC_PI_2,
    );
}

#[test]
fn another_size_keeps_the_angle_that_the_file_says() {
    let fov = |key: &str, size| {
        let camera = format!(
            "{{\"type\": \"perspective\", \"position_m\": [0, 0, 5], \"look_at_m\": [0, 0, 0], \"{key}\": 90}}"
        );
        let text = Parts { camera: &camera, ..RIGHT }.text();
        let (scene, _) = parse_with_size(&text, "test.json", size).expect("right");
        if let Some([width, height]) = size {
            assert_eq!([scene.film.width, scene.film.height], [width, height]);
        }
        fov_rad(&scene.camera)
    };
    assert_eq!(fov("vertical_fov_deg", None), fov("vertical_fov_deg", Some([300, 100])));
    assert!((fov("horizontal_fov_deg", Some([300, 100])) - 2.0 * (1.0_f64 / 3.0).atan()).abs() < 1e-15);
}

#[test]
fn orthographic_cameras() {
    let text = "{\"type\": \"orthographic\", \"position_m\": [0, 3, 0], \"direction\": [0, -2, 0], \"up\": [0, 1, -1], \"height_m\": 4}";
    let camera = camera(text, "{\"width\": 2, \"height\": 1}");
    assert_eq!(camera.projection, Projection::Orthographic { height_m: 4.0 });
    assert_eq!((camera.forward, camera.up), ([0.0, -1.0, 0.0], [0.0, 0.0, -1.0]));
    // What the scene calls up stays at its angle to the view.
    let [x, y, z] = camera.world_up;
    assert!(x == 0.0 && y == -z && (y - 0.5_f64.sqrt()).abs() < 1e-15, "{:?}", camera.world_up);
}
