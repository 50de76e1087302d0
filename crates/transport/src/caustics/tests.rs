//! Directions toward casters have the densities that are said of them, a room of constant radiance stays one, and directions that are
//! not weighed are noticed.

use super::{Caster, Hull, Target};
use crate::film::PixelRect;
use crate::light::Round;
use crate::plan::PathLoop;
use crate::prepare::Prepared;
use crate::sampler::mix;
use crate::warp::uniform_sphere;
use crate::{Study, prepare_study};
use etalon_geometry::Aabb;
use etalon_optics::Vec3;
use std::cell::Cell;

thread_local! {
    static UNWEIGHED: Cell<bool> = const { Cell::new(false) };
}

/// Whether directions of this thread are to be taken as if they had all been drawn by the cosine.
pub(super) fn is_unweighed() -> bool {
    UNWEIGHED.get()
}

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
fn is_sound(target: &impl Target, density: &dyn Fn(Vec3<f64>) -> f64, from: Vec3<f64>, seed: u64) -> bool {
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
            let wi = target.aim(from, [u(), u()]);
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
    let round = Round { centre: Vec3::new(0.2, -0.1, 0.4), radius: 0.7, front: true };
    // One face seen, two, three; near and far.
    for (seed, from) in [[0.1, 1.5, 0.3], [2.0, 1.1, 0.1], [-1.5, -2.0, 3.0], [0.3, -0.9, 0.2]].into_iter().enumerate()
    {
        let (from, seed) = (Vec3::from_array(from), 10 * seed as u64);
        let body = hull([-0.5, -0.6, -0.2], [0.6, 0.4, 0.9]);
        assert!(is_sound(&body, &|wi| body.density(from, wi), from, seed), "box from {from:?}");
        assert!(is_sound(&round, &|wi| round.density_of(from, wi), from, seed), "sphere from {from:?}");
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

#[test]
fn what_is_behind_a_surface_or_around_a_point_is_not_seen() {
    let up = Vec3::new(0.0, 0.0, 1.0);
    let round = Round { centre: Vec3::new(0.0, 0.0, 2.0), radius: 1.0, front: true };
    let hull = Hull::from(Aabb { min: Vec3::new(-1.0, -1.0, 1.0), max: Vec3::new(1.0, 1.0, 3.0) });
    for (from, n, seen) in [
        (Vec3::ZERO, up, true),
        (Vec3::ZERO, -up, false),
        (Vec3::new(0.0, 0.0, 2.5), up, false),
        (Vec3::new(4.0, 0.0, 2.0), up, true),
    ] {
        assert_eq!((round.is_seen(from, n), hull.is_seen(from, n)), (seen, seen), "{from:?}, {n:?}");
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
    prepared.render_tile(tile, 0..prepared.scene.integrator.spp, sums.borrow());
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
fn a_room_of_constant_radiance_stays_one_with_directions_toward_casters_and_not_if_they_are_not_weighed() {
    for path_loop in [PathLoop::Plain, PathLoop::Lanes] {
        let mut prepared = room(path_loop);
        assert_eq!(prepared.casters.bodies.len(), 3);
        assert!(matches!(prepared.casters.bodies[0], Caster::Box(_)));
        prepared.casters.each = 0.5 / 3.0;
        let (mean, error) = level(&prepared);
        assert!((mean - 1.0).abs() <= 6.0 * error && error < 0.003, "{path_loop:?}: {mean} ± {error}");
        UNWEIGHED.set(true);
        let (mean, error) = level(&prepared);
        UNWEIGHED.set(false);
        assert!((mean - 1.0).abs() > 6.0 * error, "{path_loop:?} unweighed: {mean} ± {error}");
    }
}
