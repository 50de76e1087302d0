//! What moves is, at each moment, what stands still there.

use super::brute_force::{at_each_level, check_geometry};
use crate::test_support::*;
use crate::{Aabb, Geometry, Instance, Motion, Parallelogram, Placement, Pose, Primitive, Ray, ShapeError, SurfaceId};
use etalon_optics::Vec3;
use std::sync::Arc;

type Rows = [V; 3];

const IDENTITY: Rows = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];

fn scaled(s: f64) -> Rows {
    IDENTITY.map(|row| row * s)
}

fn product(a: &Rows, b: &Rows) -> Rows {
    a.map(|row| b[0] * row.x + b[1] * row.y + b[2] * row.z)
}

/// Rodrigues' formula, by the library's sine and cosine.
fn turned(axis: V, angle: f64) -> Rows {
    let (s, c) = angle.sin_cos();
    let rest = 1.0 - c;
    let v = axis;
    [
        Vec3::new(c + v.x * v.x * rest, v.x * v.y * rest - v.z * s, v.x * v.z * rest + v.y * s),
        Vec3::new(v.y * v.x * rest + v.z * s, c + v.y * v.y * rest, v.y * v.z * rest - v.x * s),
        Vec3::new(v.z * v.x * rest - v.y * s, v.z * v.y * rest + v.x * s, c + v.z * v.z * rest),
    ]
}

/// A symmetric stretch along random axes.
fn stretched(random: &mut Random, decades: f64) -> Rows {
    let f = etalon_optics::Frame::from_normal(random.direction());
    let by = [0, 1, 2].map(|_| random.log_uniform(-decades, decades));
    let sum = |i: usize, j: usize| f.s[i] * f.s[j] * by[0] + f.t[i] * f.t[j] * by[1] + f.n[i] * f.n[j] * by[2];
    [0, 1, 2].map(|i| Vec3::new(sum(0, i), sum(1, i), sum(2, i)))
}

/// A few poses through the shutter's time, alike along the axes or not.
fn motion(random: &mut Random, similar: bool) -> Motion {
    let count = 1 + random.below(4);
    let mut rotation = turned(random.direction(), random.unit() * 3.0);
    let side = if random.below(2) == 0 { 1.0 } else { -1.0 };
    let mut poses = Vec::new();
    for k in 0..count {
        rotation = product(&turned(random.direction(), random.unit() * 3.0), &rotation);
        let scale = random.log_uniform(-0.5, 0.5);
        let stretch = if similar { scaled(scale) } else { stretched(random, 0.5) };
        poses.push(Pose {
            time: (k as f64 + random.unit()) * 1.4 / count as f64 - 0.2,
            translation: random.in_cube() * 2.0,
            rotation,
            stretch: stretch.map(|row| row * side),
        });
    }
    Motion::new(&poses).unwrap()
}

fn moving(geometry: &Arc<Geometry>, motion: Motion) -> Primitive {
    Instance::moving(geometry.clone(), Arc::new(motion)).unwrap().into()
}

fn build(primitives: Vec<Primitive>) -> Arc<Geometry> {
    Arc::new(Geometry::build(primitives).unwrap())
}

/// Things that move, among them groups of things that move.
fn moving_soup(random: &mut Random, count: usize) -> Vec<Primitive> {
    let inner = build(soup(random, 20, -2.0..0.0));
    let mut middle = soup(random, 4, -2.0..0.0);
    for i in 0..6 {
        let within = motion(random, i % 2 == 0);
        middle.push(moving(&inner, within));
    }
    let middle = build(middle);
    let mut all = soup(random, count, -2.0..0.0);
    for i in 0..count {
        let within = motion(random, i % 2 == 0);
        all.push(moving(if i % 3 == 0 { &middle } else { &inner }, within));
    }
    all
}

#[test]
fn tree_equals_brute_force_on_moving_instances_at_all_times() {
    for seed in 0..3 {
        for count in [2, 40] {
            let hits = at_each_level(|_| {
                let primitives = moving_soup(&mut Random::new(950 + seed), count);
                check_geometry(&Geometry::build_with(primitives, 0).unwrap(), 3_000, 1_150 + seed, |l| l)
            });
            assert!(hits > 0.15, "only {hits} of the rays hit anything");
        }
    }
}

#[test]
fn at_each_moment_it_is_the_instance_that_stands_still_there() {
    let mut random = Random::new(960);
    let (mut hits, mut differing, mut stale) = (0, 0, 0);
    for round in 0..60 {
        let shapes = build(soup(&mut random, 25, -1.0..0.0));
        let motion = motion(&mut random, round % 2 == 0);
        let moves = Geometry::build(vec![moving(&shapes, motion.clone())]).unwrap();
        for _ in 0..10 {
            let time = random.unit();
            let at = motion.at(time);
            let placement = Placement::new(at.linear().map(Vec3::to_array), at.translation().to_array()).unwrap();
            let still = Geometry::build(vec![Instance::new(shapes.clone(), placement).unwrap().into()]).unwrap();
            for _ in 0..50 {
                let origin = random.in_cube() * 4.0;
                let ray = Ray { time, ..Ray::free(origin, random.in_cube() * 2.0 - origin) };
                let (a, b) = (moves.closest_hit(&ray), still.closest_hit(&ray));
                let (Some(a), Some(b)) = (a, b) else {
                    differing += usize::from(a.is_some() != b.is_some());
                    continue;
                };
                hits += 1;
                // The mutant: a ray taken into the instance as it is at another time.
                let other = Ray { time: if time < 0.5 { time + 0.5 } else { time - 0.5 }, ..ray };
                stale += usize::from(moves.closest_hit(&other).is_none_or(|c| (c.t - b.t).abs() > 1e-9 * b.t));
                if (a.t - b.t).abs() > 1e-9 * b.t {
                    differing += 1;
                    continue;
                }
                let (p, q) = (moves.surface(&ray, &a), still.surface(&ray, &b));
                assert!(
                    (p.position - q.position).length() <= p.position_error + q.position_error + 1e-12,
                    "{p:?} {q:?}"
                );
                assert!((p.normal - q.normal).length() < 1e-9);
                assert!((p.time, q.time) == (time, time) && p.spawn(p.normal).time == time);
                let local = moves.local_point(a.surface, p.position, time);
                assert!((local - still.local_point(b.surface, p.position, 0.0)).length() < 1e-12);
            }
        }
    }
    // Along silhouettes, which a rounding moves.
    assert!(hits > 5_000 && differing * 2_000 <= hits, "{differing} of {hits} differ");
    assert!(stale * 4 > hits, "the mutant is seen by {stale} of {hits} only");
}

#[test]
fn nothing_that_moves_meets_itself_again_nor_lets_a_ray_escape() {
    let mut random = Random::new(961);
    for (round, mesh) in [Mesh::cube(), Mesh::sphere(12, 12, |_| 1.0)].into_iter().cycle().take(12).enumerate() {
        let motion = motion(&mut random, round % 4 < 2);
        let geometry = Geometry::build(vec![moving(&build(mesh.primitives()), motion.clone())]).unwrap();
        for _ in 0..4_000 {
            let time = random.unit();
            let placement = motion.at(time);
            let f = mesh.faces[random.below(mesh.faces.len())].map(|i| mesh.vertices[i]);
            let (s, t) = (random.unit(), random.unit());
            let target = match random.below(3) {
                0 => f[0],
                1 => f[0] + (f[1] - f[0]) * s,
                _ => f[0] + (f[1] - f[0]) * (s * t) + (f[2] - f[0]) * (s * (1.0 - t)),
            };
            let origin = placement.point(random.in_cube() * 0.3);
            let ray = Ray { time, ..Ray::free(origin, placement.point(target) - origin) };
            let p = geometry.surface(&ray, &geometry.closest_hit(&ray).expect("a wall"));
            assert!(p.normal.dot(ray.direction) > 0.0, "the outward side stays outside");
            assert!(geometry.closest_hit(&p.spawn(p.normal)).is_none(), "the body is convex: {p:?}");
            let free = Ray { leaves: SurfaceId::NONE, ..p.spawn(p.normal) };
            assert!(geometry.closest_hit(&free).is_none(), "the error bound clears the surface by itself: {p:?}");
            assert!(
                geometry.closest_hit(&p.spawn(origin - p.position)).is_some(),
                "from within there is always a wall"
            );
        }
    }
}

#[test]
fn rotation_takes_a_constant_rate_about_one_axis() {
    let mut random = Random::new(962);
    for _ in 0..2_000 {
        let axis = random.direction();
        let angle = random.unit() * 3.0;
        let start = turned(random.direction(), random.unit() * 6.0);
        let pose = |time, turn: f64, scale: f64, x: f64| Pose {
            time,
            translation: v(x, 1.0, -2.0),
            rotation: product(&start, &turned(axis, turn)),
            stretch: scaled(scale),
        };
        let motion = Motion::new(&[pose(-0.5, 0.0, 1.0, 4.0), pose(1.5, angle, 3.0, 8.0)]).unwrap();
        let time = random.unit();
        let share = 0.5 * (time + 0.5);
        let (got, want) = (motion.at(time), pose(time, angle * share, 1.0 + 2.0 * share, 4.0 + 4.0 * share));
        let linear = product(&want.rotation, &want.stretch);
        for i in 0..3 {
            // A few roundings of numbers up to 3; the axis of a small turn is as uncertain as the turn is small.
            assert!((got.linear()[i] - linear[i]).length() < 1e-14 * 3.0, "{got:?} {linear:?}");
        }
        assert!((got.translation() - want.translation).length() < 1e-14);
    }
}

/// LOOSENESS of `instance.rs` in practice: a similarity's inverse by its transpose, of motions of all kinds.
#[test]
fn the_inverse_of_a_similarity_is_as_good_as_the_error_bounds_say() {
    let mut random = Random::new(963);
    let mut worst = 0.0_f64;
    for _ in 0..20_000 {
        let placement = motion(&mut random, true).at(random.unit());
        let p = random.in_cube();
        let back = placement.local_point(placement.vector(p) + placement.translation()) - p;
        // What the map itself rounds: translations are below 4, scales above 0.3.
        worst = worst.max(back.length() - 16.0 * 5.0 * f64::EPSILON / 0.3);
        let [a, b, c] = placement.linear();
        let square = a.length_squared();
        for (x, y) in [(a, b), (b, c), (c, a)] {
            worst = worst.max((x.dot(y) / square).abs());
        }
        worst = worst.max((b.length_squared() / square - 1.0).abs());
    }
    assert!(worst < 64.0 * f64::EPSILON * 0.5, "{} unit roundoffs", worst / f64::EPSILON * 2.0);
}

/// A rod that turns by 170° sweeps almost a disk; at both ends it lies nearly along the same line.
fn rod() -> (Arc<Geometry>, Motion) {
    let rod = Parallelogram::new(v(-1.0, -0.01, 0.0), v(2.0, 0.0, 0.0), v(0.0, 0.02, 0.0)).unwrap();
    let pose = |time, degrees: f64| Pose {
        time,
        translation: v(5.0, 0.0, 0.0),
        rotation: turned(v(0.0, 0.0, 1.0), degrees.to_radians()),
        stretch: IDENTITY,
    };
    (build(vec![rod.into()]), Motion::new(&[pose(0.0, 5.0), pose(1.0, 175.0)]).unwrap())
}

#[test]
fn a_turning_rod_stays_in_its_bounds_and_the_boxes_of_its_ends_would_lose_it() {
    let (rod, motion) = rod();
    let instance = Instance::moving(rod.clone(), Arc::new(motion.clone())).unwrap();
    let end = |time| Instance::new(rod.clone(), motion.at(time)).unwrap().bounds();
    let ends = end(0.0).union(end(1.0));
    let mut lost = 0;
    for i in 0..=1_000 {
        let placement = motion.at(f64::from(i) / 1_000.0);
        for p in [v(-1.0, -0.01, 0.0), v(1.0, -0.01, 0.0), v(1.0, 0.01, 0.0), v(-1.0, 0.01, 0.0)] {
            assert!(instance.bounds().contains(placement.point(p)), "at {i}");
            lost += usize::from(!ends.contains(placement.point(p)));
        }
    }
    assert!(lost > 3_000, "the mutant loses only {lost}");
    // Tight: the disk is 2 by 2, and the sixteenth part of a turn of 170° leaves 0.5 % of its radius.
    let extent = instance.bounds().extent();
    assert!(extent.x < 2.02 && extent.y < 2.02 && extent.z < 0.02, "{extent:?}");
    // What rays see: at half time it stands upright, and away from it there is nothing.
    let geometry = Geometry::build(vec![instance.into()]).unwrap();
    let at = |x: f64, y: f64, time| geometry.occluded(&Ray { time, ..Ray::free(v(x, y, 3.0), v(0.0, 0.0, -1.0)) });
    assert!(at(5.0, 0.9, 0.5) && !at(5.0, 0.9, 0.0) && !at(5.0, 0.9, 1.0) && !at(5.9, 0.0, 0.5));
}

/// Bounds of each part of the shutter's time hold all points at all its times.
#[test]
fn points_stay_in_the_bounds_of_their_part_of_the_time() {
    let mut random = Random::new(964);
    for _ in 0..1_000 {
        let similar = random.below(2) == 0;
        let motion = motion(&mut random, similar);
        let inner = Aabb { min: v(-1.0, -0.2, 0.5), max: v(2.0, 0.3, 0.6) };
        let from = random.unit();
        let to = from + random.unit() * (1.0 - from);
        let swept = motion.swept([from, to], inner, &[inner]);
        for _ in 0..40 {
            let p = inner.min + v(3.0 * random.unit(), 0.5 * random.unit(), 0.1 * random.unit());
            let placed = motion.at(from + (to - from) * random.unit()).point(p);
            assert!(swept.contains(placed), "{swept:?} {placed:?}");
        }
    }
}

#[test]
fn poses_that_no_motion_joins_are_refused() {
    use ShapeError::{NotFinite, Singular, Unjoinable};
    let pose = |time, degrees: f64, stretch: Rows| Pose {
        time,
        translation: Vec3::ZERO,
        rotation: turned(v(0.0, 1.0, 0.0), degrees.to_radians()),
        stretch,
    };
    let one = |stretch| Motion::new(&[pose(0.0, 0.0, stretch)]);
    assert!(one(IDENTITY).is_ok() && one(scaled(-2.0)).is_ok());
    assert_eq!(Motion::new(&[]), Err(Unjoinable));
    assert_eq!(one(scaled(0.0)), Err(Singular));
    assert_eq!(one(scaled(f64::NAN)), Err(NotFinite));
    assert_eq!(one([v(1.0, 0.0, 0.0), v(0.0, -1.0, 0.0), v(0.0, 0.0, -1.0)]), Err(Unjoinable));
    assert_eq!(one([v(1.0, 0.5, 0.0), v(0.0, 1.0, 0.0), v(0.0, 0.0, 1.0)]), Err(Unjoinable));
    let two = |degrees, stretch, time| Motion::new(&[pose(0.0, 0.0, IDENTITY), pose(time, degrees, stretch)]);
    assert_eq!(two(180.0, IDENTITY, 1.0), Err(Unjoinable));
    assert_eq!(two(10.0, scaled(-1.0), 1.0), Err(Unjoinable));
    assert_eq!(two(10.0, IDENTITY, 0.0), Err(Unjoinable));
    assert!(two(179.9, scaled(2.0), 1.0).is_ok());
    let skewed = Pose { rotation: [v(1.0, 0.1, 0.0), v(0.0, 1.0, 0.0), v(0.0, 0.0, 1.0)], ..pose(0.0, 0.0, IDENTITY) };
    assert_eq!(Motion::new(&[skewed]), Err(Unjoinable));
}
