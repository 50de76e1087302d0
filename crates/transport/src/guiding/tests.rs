//! Directions toward guided targets have the densities that are said of them, a room of constant radiance stays one, and directions that are
//! not weighed are noticed.

mod specular_images;

use super::{DirectionTarget, GuidedBy, GuidedTarget, Hull};
use crate::film::{PixelRect, XyzSum};
use crate::plan::PathLoop;
use crate::sampler::mix;
use crate::scene::prepare::Prepared;
use crate::warp::uniform_sphere;
use crate::{Study, prepare_study};
use etalon_geometry::{Aabb, SphereSampler};
use etalon_optics::Vec3;

/// Numbers in [0, 1).
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = mix(seed);
    move || {
        state = mix(state);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Mean and standard error.
fn mean(count: usize, mut sample: impl FnMut() -> f64) -> (f64, f64) {
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..count {
        let value = sample();
        sum += value;
        squares += value * value;
    }
    let n = count as f64;
    (sum / n, ((squares / n - (sum / n).powi(2)).max(0.0) / n).sqrt())
}

/// Whether densities integrate to one, and draws have them: integrals of (1, x, y, z²) over what is seen by draws over their densities
/// and by uniform directions. Five standard errors each: a right target fails one of the five with probability 3e-6.
fn is_sound(target: &impl DirectionTarget, density: &dyn Fn(Vec3<f64>) -> f64, from: Vec3<f64>, seed: u64) -> bool {
    draws_are_sound(&|u| target.aim(from, u), density, seed)
}

fn draws_are_sound(aim: &dyn Fn([f64; 2]) -> Vec3<f64>, density: &dyn Fn(Vec3<f64>) -> f64, seed: u64) -> bool {
    let mut u = numbers(seed);
    let count = 100_000;
    let mut uniform = || uniform_sphere([u(), u()]);
    let sphere = 4.0 * std::f64::consts::PI;
    let (whole, error) = mean(count, || sphere * density(uniform()));
    let mut sound = (whole - 1.0).abs() <= 5.0 * error;
    let moments: [fn(Vec3<f64>) -> f64; 4] = [|_| 1.0, |w| w.x, |w| w.y, |w| w.z * w.z];
    for of in moments {
        let mut u = numbers(seed ^ 1);
        let drawn = mean(count, || {
            let wi = aim([u(), u()]);
            let density = density(wi);
            // A direction may round over the rim.
            if density > 0.0 { of(wi) / density } else { 0.0 }
        });
        let mut u = numbers(seed ^ 2);
        let even = mean(count, || {
            let wi = uniform_sphere([u(), u()]);
            if density(wi) > 0.0 { sphere * of(wi) } else { 0.0 }
        });
        sound &= (drawn.0 - even.0).abs() <= 5.0 * drawn.1.hypot(even.1);
    }
    sound
}

#[test]
fn directions_toward_spheres_and_boxes_have_their_densities_and_wrong_densities_are_noticed() {
    let hull =
        |min: [f64; 3], max: [f64; 3]| Hull::from(Aabb { min: Vec3::from_array(min), max: Vec3::from_array(max) });
    let sphere = SphereSampler { centre: Vec3::new(0.2, -0.1, 0.4), radius: 0.7 };
    // One face seen, two, three; near and far.
    for (seed, from) in [[0.1, 1.5, 0.3], [2.0, 1.1, 0.1], [-1.5, -2.0, 3.0], [0.3, -0.9, 0.2]].into_iter().enumerate()
    {
        let (from, seed) = (Vec3::from_array(from), 10 * seed as u64);
        let body = hull([-0.5, -0.6, -0.2], [0.6, 0.4, 0.9]);
        assert!(is_sound(&body, &|wi| body.density(from, wi), from, seed), "box from {from:?}");
        assert!(is_sound(&sphere, &|wi| sphere.density(from, wi), from, seed), "sphere from {from:?}");
    }
    // From near, where few draws are needed to tell: a tenth too much, and the right sum with a lean to one side.
    let (body, from) = (hull([-0.5, -0.6, -0.2], [0.6, 0.4, 0.9]), Vec3::new(0.3, -0.9, 0.2));
    assert!(!is_sound(&body, &|wi| 1.1 * body.density(from, wi), from, 30));
    let mut u = numbers(5);
    let middle = mean(100_000, || body.aim(from, [u(), u()]).x).0;
    assert!(!is_sound(&body, &|wi| body.density(from, wi) * (1.0 + 0.9 * (wi.x - middle)), from, 30));
    // Flat, as a mirror on a wall is.
    let (pane, from) = (hull([-1.0, 0.5, -1.0], [1.0, 0.5, 0.3]), Vec3::new(0.2, 0.0, 0.1));
    assert!(is_sound(&pane, &|wi| pane.density(from, wi), from, 7));
}

/// What is seen of a box from far away is a flat figure: if each face is drawn as often as it is large, all directions have the same density,
/// one over the solid angle. Wrong weights of faces would be no bias, but noise.
#[test]
fn a_box_far_away_is_drawn_evenly() {
    let (min, max) = ([-0.5, -0.6, -0.2], [0.6, 0.4, 0.9]);
    let body = Hull::from(Aabb { min: Vec3::from_array(min), max: Vec3::from_array(max) });
    for from in [[300.0, 90.0, 160.0], [-80.0, 220.0, -240.0], [-130.0, -270.0, 110.0], [0.1, 300.0, -60.0]] {
        let projected = (0..3).map(|a| {
            let seen = from[a] < min[a] || from[a] > max[a];
            let area = (max[(a + 1) % 3] - min[(a + 1) % 3]) * (max[(a + 2) % 3] - min[(a + 2) % 3]);
            if seen { area * f64::abs(from[a]) } else { 0.0 }
        });
        let from = Vec3::from_array(from);
        let solid_angle = projected.sum::<f64>() / from.length().powi(3);
        let mut u = numbers(3);
        for _ in 0..1000 {
            let even = body.density(from, body.aim(from, [u(), u()])) * solid_angle;
            // Squared distances and cosines differ by as much as a box of 1.8 m across does at 300 m.
            assert!((even - 1.0).abs() < 0.02 || even == 0.0, "{even} from {from:?}");
        }
    }
}

#[test]
fn what_is_behind_a_surface_or_around_a_point_is_not_seen() {
    let up = Vec3::new(0.0, 0.0, 1.0);
    let sphere = SphereSampler { centre: Vec3::new(0.0, 0.0, 2.0), radius: 1.0 };
    let hull = Hull::from(Aabb { min: Vec3::new(-1.0, -1.0, 1.0), max: Vec3::new(1.0, 1.0, 3.0) });
    for (from, n, seen) in [
        (Vec3::ZERO, up, true),
        (Vec3::ZERO, -up, false),
        (Vec3::new(0.0, 0.0, 2.5), up, false),
        (Vec3::new(4.0, 0.0, 2.0), up, true),
    ] {
        assert_eq!((sphere.is_seen(from, n), hull.is_seen(from, n)), (seen, seen), "{from:?}, {n:?}");
    }
}

/// A closed room whose walls emit 1/2 and reflect half: radiance is 1 everywhere, whatever stands in it without loss.
fn room(path_loop: PathLoop) -> Prepared {
    let walls = [
        ("[-1, -1, -1]", "[2, 0, 0]", "[0, 2, 0]"),
        ("[-1, -1, 1]", "[2, 0, 0]", "[0, 2, 0]"),
        ("[-1, -1, -1]", "[2, 0, 0]", "[0, 0, 2]"),
        ("[-1, 1, -1]", "[2, 0, 0]", "[0, 0, 2]"),
        ("[-1, -1, -1]", "[0, 2, 0]", "[0, 0, 2]"),
        ("[1, -1, -1]", "[0, 2, 0]", "[0, 0, 2]"),
    ]
    .map(|(origin, u, v)| {
        format!(
            r#"{{"shape": {{"type": "parallelogram", "origin_m": {origin}, "u_m": {u}, "v_m": {v}}},
                "material": {{"type": "lambert", "reflectance": 0.5}}, "emission": {{"radiance": 0.5, "sides": "both"}}}}"#
        )
    });
    let json = format!(
        r#"{{"etalon": 1, "film": {{"width": 8, "height": 8}}, "integrator": {{"spp": 512, "replicates": 16}},
            "camera": {{"type": "perspective", "position_m": [0.1, 0.2, 0.9], "look_at_m": [0, 0, -1], "vertical_fov_deg": 80}},
            "objects": [{},
                {{"shape": {{"type": "sphere", "center_m": [0.4, -0.5, -0.2], "radius_m": 0.4}},
                  "material": {{"type": "dielectric", "interior": 1.5}}}},
                {{"shape": {{"type": "sphere", "center_m": [-0.5, -0.6, 0.1], "radius_m": 0.3}}, "material": {{"type": "mirror"}}}},
                {{"shape": {{"type": "parallelogram", "origin_m": [-0.6, 0.4, -0.9], "u_m": [1.2, 0, 0], "v_m": [0, 0.3, 0.3]}},
                  "material": {{"type": "mirror"}}}}]}}"#,
        walls.join(",")
    );
    let scene = etalon_scene::parse(&json, "room").unwrap().0;
    prepare_study(&scene, &Study { path_loop: Some(path_loop), ..Study::default() }).unwrap()
}

/// Mean Y of the film on this thread, and its standard error by the scatter of 16 replicates.
fn level(prepared: &Prepared) -> (f64, f64) {
    let tile = PixelRect { x0: 0, y0: 0, x1: 8, y1: 8 };
    let mut sums = prepared.film().tile(tile);
    prepared.render_tile(tile, 0..prepared.scene.integrator.spp, &crate::Splats::NONE, &mut sums);
    let of_replicate =
        |r: usize| sums.xyz.iter().skip(r).step_by(16).map(|sum| sum.xyz[1] / f64::from(sum.count)).sum::<f64>() / 64.0;
    let (mean, error) = mean(16, {
        let mut r = 0;
        move || {
            r += 1;
            of_replicate(r - 1)
        }
    });
    (mean, error * (16.0_f64 / 15.0).sqrt())
}

/// Six standard errors from 16 replicates: Student's t passes that with probability 2e-5. The errors are some .0015, so that a bias of
/// 1 % is seen.
#[test]
fn a_room_of_constant_radiance_stays_one_with_directions_toward_casters() {
    let all = [GuidedBy::Bodies, GuidedBy::Images, GuidedBy::ImagesAndLenses];
    for (path_loop, guided_by) in
        [PathLoop::Scalar, PathLoop::Batch].into_iter().flat_map(|path| all.map(|guided_by| (path, guided_by)))
    {
        let mut prepared = room(path_loop);
        assert_eq!(
            (
                prepared.guided_targets.bodies.len(),
                prepared.guided_targets.lenses.len(),
                prepared.guided_targets.images.len()
            ),
            (3, 1, 12)
        );
        assert!(matches!(prepared.guided_targets.bodies[0], GuidedTarget::Box(_)));
        (prepared.guided_targets.guided_by, prepared.guided_targets.share) = (guided_by, 0.5);
        let (mean, error) = level(&prepared);
        assert!((mean - 1.0).abs() <= 6.0 * error && error < 0.003, "{path_loop:?}, {guided_by:?}: {mean} ± {error}");
    }
}

/// A floor under a sky with a lamp, and a mirror ball that throws the lamp's light on it. Camera paths have to find it.
fn floor() -> Prepared {
    let json = r#"{"etalon": 1, "film": {"width": 48, "height": 48},
        "integrator": {"spp": 256, "replicates": 16, "light_tracing": "never"},
        "camera": {"type": "perspective", "position_m": [0, 3, 6], "look_at_m": [0, -0.5, 0], "vertical_fov_deg": 30},
        "objects": [
            {"shape": {"type": "disk", "center_m": [0, -1, 0], "normal": [0, 1, 0], "radius_m": 30},
             "material": {"type": "lambert", "reflectance": 0.5}},
            {"shape": {"type": "sphere", "center_m": [0, 0.1, 0], "radius_m": 1}, "material": {"type": "mirror"}},
            {"shape": {"type": "sphere", "center_m": [3, 6, 1], "radius_m": 0.3}, "material": {"type": "black"},
             "emission": {"radiance": 100}}],
        "lights": [{"type": "environment", "radiance": 0.2}]}"#;
    prepare_study(&etalon_scene::parse(json, "floor").unwrap().0, &Study::default()).unwrap()
}

/// Mean over pixels of the variance of Y, by the scatter of 16 replicates, relative to its square.
fn noise(prepared: &Prepared) -> f64 {
    let film = &prepared.scene.film;
    let tile = PixelRect { x0: 0, y0: 0, x1: film.width, y1: film.height };
    let mut sums = prepared.film().tile(tile);
    prepared.render_tile(tile, 0..prepared.scene.integrator.spp, &crate::Splats::NONE, &mut sums);
    let of_pixel = |replicates: &[XyzSum]| {
        let mut y = replicates.iter().map(|sum| sum.xyz[1] / f64::from(sum.count));
        let (mean, error) = mean(16, || y.next().unwrap());
        error * error / (mean * mean)
    };
    sums.xyz.chunks(16).map(of_pixel).sum::<f64>() / f64::from(film.width * film.height)
}

/// A trial finds that images are worth it, and they are: the noise of a floor that a mirror ball throws light on falls to less than a
/// half. It would not if roulette ended paths for the weight that aiming takes from them.
#[test]
fn lamps_in_a_mirror_ball_are_aimed_at_and_that_leaves_less_noise() {
    let mut prepared = floor();
    assert_eq!(prepared.guided_targets.guided_by, GuidedBy::Images);
    let aimed = noise(&prepared);
    prepared.guided_targets.guided_by = GuidedBy::Nothing;
    let alone = noise(&prepared);
    assert!(aimed < 0.5 * alone, "{aimed} of {alone}");
}

/// A room with a lamp under its ceiling, which is lit from the floor, not least where a ball of glass throws light on it, and through the ball. Camera paths have
/// to find it.
fn vault() -> Prepared {
    let walls = [
        ("[-1, -1, -1]", "[2, 0, 0]", "[0, 0, 4]"),
        ("[-1, 1, -1]", "[2, 0, 0]", "[0, 0, 4]"),
        ("[-1, -1, -1]", "[2, 0, 0]", "[0, 2, 0]"),
        ("[-1, -1, -1]", "[0, 2, 0]", "[0, 0, 4]"),
        ("[1, -1, -1]", "[0, 2, 0]", "[0, 0, 4]"),
    ]
    .map(|(origin, u, v)| {
        format!(
            r#"{{"shape": {{"type": "parallelogram", "origin_m": {origin}, "u_m": {u}, "v_m": {v}}},
                "material": {{"type": "lambert", "reflectance": 0.7}}}}"#
        )
    });
    let json = format!(
        r#"{{"etalon": 1, "film": {{"width": 32, "height": 32}},
            "integrator": {{"spp": 256, "replicates": 16, "light_tracing": "never"}},
            "camera": {{"type": "perspective", "position_m": [0, 0, 3.5], "look_at_m": [0, 0.3, 0], "vertical_fov_deg": 38}},
            "objects": [{},
                {{"shape": {{"type": "sphere", "center_m": [0.4, -0.6, 0.2], "radius_m": 0.4}},
                  "material": {{"type": "dielectric", "interior": 1.5}}}},
                {{"shape": {{"type": "disk", "center_m": [0, 0.99, 0], "normal": [0, -1, 0], "radius_m": 0.25}},
                  "material": {{"type": "black"}}, "emission": {{"radiance": 20}}}}]}}"#,
        walls.join(",")
    );
    prepare_study(&etalon_scene::parse(&json, "vault").unwrap().0, &Study::default()).unwrap()
}

/// A trial finds that whole lenses are worth it beside images, and they are.
#[test]
fn balls_of_glass_are_aimed_at_beside_images_and_that_leaves_less_noise() {
    let mut prepared = vault();
    assert_eq!(prepared.guided_targets.guided_by, GuidedBy::ImagesAndLenses);
    let with_lenses = noise(&prepared);
    prepared.guided_targets.guided_by = GuidedBy::Images;
    let images = noise(&prepared);
    assert!(with_lenses < 0.85 * images, "{with_lenses} of {images}");
}
