//! What the published figures do not show: parallelograms and the orthographic camera. The check is an area, counted in pixels.

use std::num::NonZero;

use etalon_whitted::{Camera, Material, Object, Scene, Settings, Shape, Vec3, render, vec3};

const WIDTH: u32 = 800;
const HEIGHT: u32 = 600;
const FOCAL_LENGTH: f64 = 2.0;

fn flat(red: f64) -> Material {
    Material {
        ambient: vec3(red, 0.0, 0.0),
        diffuse: Vec3::default(),
        specular: Vec3::default(),
        mirror: Vec3::default(),
        refraction: Vec3::default(),
        refraction_index: 1.0,
        shininess: 1.0,
    }
}

/// How many pixels are red, without lights, lens or background.
fn red_pixels(is_perspective: bool, objects: Vec<Object>) -> usize {
    let scene = Scene {
        background: Vec3::default(),
        ambient: vec3(1.0, 1.0, 1.0),
        camera: Camera {
            is_perspective,
            position: vec3(0.0, 0.0, 3.0),
            // A tangent of the half angle of 1/2: half the grid's height is 2 · 2 · 1/2 = 2.
            field_of_view_rad: 2.0 * 0.5_f64.atan(),
            focal_length: FOCAL_LENGTH,
            lens_radius: 0.0,
        },
        lights: vec![],
        objects,
    };
    let settings = Settings {
        width: const { NonZero::new(WIDTH).unwrap() },
        height: const { NonZero::new(HEIGHT).unwrap() },
        rays: NonZero::<u32>::MIN,
        ..Settings::default()
    };
    let film = render(&scene, &settings);
    assert_eq!(film.non_finite(), 0);
    film.pixels.iter().filter(|p| p.0[0] > 0.5).count()
}

/// The grid is 4 high for 600 pixels, and spans as much per pixel across.
const PIXELS_PER_UNIT: f64 = 150.0;

/// An outline of length L (in pixels) can gain or lose at most the cells that it crosses, of which there are at most 2 L + 4.
fn assert_area(found: usize, area: f64, outline: f64) {
    let expected = area * PIXELS_PER_UNIT * PIXELS_PER_UNIT;
    let slack = 2.0 * outline * PIXELS_PER_UNIT + 4.0;
    assert!((found as f64 - expected).abs() < slack, "{found} pixels, expected {expected} within {slack}");
    assert!(slack < 0.05 * expected, "the test sees nothing");
}

#[test]
fn an_orthographic_sphere_covers_its_disk_at_any_distance() {
    for z in [0.0, -50.0] {
        let shape = Shape::Sphere { center: vec3(0.3, -0.2, z), radius: 1.5 };
        let found = red_pixels(false, vec![Object { shape, material: flat(1.0) }]);
        let pi = std::f64::consts::PI;
        assert_area(found, pi * 1.5 * 1.5, 2.0 * pi * 1.5);
    }
}

fn parallelogram(z: f64, scale: f64) -> Shape {
    Shape::Parallelogram {
        origin: vec3(-scale, -1.2 * scale, z),
        u: vec3(1.5 * scale, 0.3 * scale, 0.0),
        v: vec3(-0.2 * scale, 2.0 * scale, 0.0),
    }
}

#[test]
fn a_parallelogram_covers_the_area_of_its_cross_product_seen_from_either_side() {
    let (area, outline) = (1.5 * 2.0 + 0.3 * 0.2, 2.0 * (1.5_f64.hypot(0.3) + 2.0_f64.hypot(0.2)));
    let found = red_pixels(false, vec![Object { shape: parallelogram(-7.0, 1.0), material: flat(1.0) }]);
    assert_area(found, area, outline);
    // In the grid's own plane, z = −2, a perspective ray meets the grid point itself; twice as far away, twice the size.
    for (z, scale) in [(-FOCAL_LENGTH, 1.0), (3.0 - 2.0 * (3.0 + FOCAL_LENGTH), 2.0)] {
        let found = red_pixels(true, vec![Object { shape: parallelogram(z, scale), material: flat(1.0) }]);
        assert_area(found, area, outline);
    }
    let Shape::Parallelogram { origin, u, v } = parallelogram(-7.0, 1.0) else { unreachable!() };
    let turned = Shape::Parallelogram { origin, u: v, v: u };
    let found = red_pixels(false, vec![Object { shape: turned, material: flat(1.0) }]);
    assert_area(found, area, outline);
}

#[test]
fn the_nearer_of_two_objects_is_seen_and_of_two_equal_ones_the_first() {
    let object = |z, red| Object { shape: parallelogram(z, 1.0), material: flat(red) };
    let alone = red_pixels(false, vec![object(-7.0, 1.0)]);
    assert_eq!(red_pixels(false, vec![object(-8.0, 0.0), object(-7.0, 1.0)]), alone);
    assert_eq!(red_pixels(false, vec![object(-7.0, 1.0), object(-8.0, 0.0)]), alone);
    assert_eq!(red_pixels(false, vec![object(-7.0, 1.0), object(-7.0, 0.0)]), alone);
    assert_eq!(red_pixels(false, vec![object(-7.0, 0.0), object(-7.0, 1.0)]), 0);
}

#[test]
fn a_parallelogram_seen_edge_on_and_one_behind_the_camera_are_not_seen() {
    let edge_on =
        Shape::Parallelogram { origin: vec3(0.0, -1.0, -5.0), u: vec3(0.0, 2.0, 0.0), v: vec3(0.0, 0.0, 1.0) };
    assert_eq!(red_pixels(false, vec![Object { shape: edge_on, material: flat(1.0) }]), 0);
    assert_eq!(red_pixels(false, vec![Object { shape: parallelogram(4.0, 1.0), material: flat(1.0) }]), 0);
    let behind = Shape::Sphere { center: vec3(0.0, 0.0, 5.0), radius: 1.0 };
    assert_eq!(red_pixels(true, vec![Object { shape: behind, material: flat(1.0) }]), 0);
}

#[test]
fn a_defocused_edge_is_a_straight_ramp_as_wide_as_the_square_lens_casts_it() {
    const RAYS: u32 = 2000;
    const ROWS: u32 = 20;
    let (camera_z, lens_radius, edge_x) = (3.0, 0.08, 0.1);
    for z in [0.5, -1.0, -2.0, -6.0] {
        // A wall to the right of x = 0.1, larger than the picture otherwise.
        let wall =
            Shape::Parallelogram { origin: vec3(edge_x, -50.0, z), u: vec3(50.0, 0.0, 0.0), v: vec3(0.0, 100.0, 0.0) };
        let scene = Scene {
            background: Vec3::default(),
            ambient: vec3(1.0, 1.0, 1.0),
            camera: Camera {
                is_perspective: true,
                position: vec3(0.0, 0.0, camera_z),
                field_of_view_rad: 2.0 * 0.05_f64.atan(),
                focal_length: FOCAL_LENGTH,
                lens_radius,
            },
            lights: vec![],
            objects: vec![Object { shape: wall, material: flat(1.0) }],
        };
        let settings = Settings {
            width: const { NonZero::new(100).unwrap() },
            height: const { NonZero::new(ROWS).unwrap() },
            rays: const { NonZero::new(RAYS).unwrap() },
            ..Settings::default()
        };
        let film = render(&scene, &settings);
        // The lens point l and the grid point g see the wall where l + (g − l) s ≥ 0.1, with s the share of the way.
        let s = (camera_z - z) / (camera_z + FOCAL_LENGTH);
        let half_width = 100.0 / f64::from(ROWS) * (2.0 * FOCAL_LENGTH * 0.05);
        for i in 0..100 {
            let grid_x = -half_width + f64::from(i) * (2.0 * half_width / 100.0);
            // Share of the lens [−r, r] on which l (1 − s) ≥ 0.1 − g s.
            let (slope, needed) = (1.0 - s, edge_x - grid_x * s);
            let expected = if slope.abs() < 1e-12 {
                f64::from(u8::from(needed <= 0.0))
            } else {
                let limit = (needed / slope).clamp(-lens_radius, lens_radius);
                let beyond = (lens_radius - limit) / (2.0 * lens_radius);
                if slope > 0.0 { beyond } else { 1.0 - beyond }
            };
            let column = (0..ROWS).map(|j| film.pixels[(j * 100 + i) as usize].0[0]).sum::<f64>() / f64::from(ROWS);
            // 40,000 rays a column: 6 σ, which 100 columns in 4 scenes exceed with a chance below 1e-6. A round lens
            // differs by 0.06, a lens 5 % too wide by 0.025 at the ramp's ends.
            let deviation = (expected * (1.0 - expected) / f64::from(RAYS * ROWS)).sqrt();
            let bound = 6.0 * deviation + 1e-3;
            assert!((column - expected).abs() < bound, "z {z}, column {i}: {column} and not {expected} within {bound}");
        }
    }
}
