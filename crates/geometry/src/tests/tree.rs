//! The tree finds what brute force finds.

use super::brute_force::{agrees, check};
use crate::level;
use crate::test_support::*;
use crate::{Disk, Geometry, Parallelogram, Primitive, PrimitiveId, Ray, Sphere, SurfaceId, Triangle};
use etalon_optics::Vec3;

#[test]
fn tree_equals_brute_force_on_soups_of_all_scales() {
    for seed in 0..4 {
        let primitives = soup(&mut Random::new(seed), 200, -6.0..0.0);
        let hits = check(primitives, 20_000, 100 + seed, |l| l);
        assert!(hits > 0.3, "only {hits} of the rays hit anything");
    }
}

#[test]
fn tree_equals_brute_force_on_vertices_that_f32_represents() {
    // Such triangles are tested from the leaf, without their primitives.
    for seed in 0..2 {
        let primitives = representable(&soup(&mut Random::new(20 + seed), 200, -4.0..0.0));
        let hits = check(primitives, 20_000, 120 + seed, |l| l);
        assert!(hits > 0.3, "only {hits} of the rays hit anything");
    }
    let mesh = Mesh::sphere(40, 60, |p| 1.0 + 0.2 * (9.0 * p.x).sin() * (7.0 * p.y).cos());
    for primitives in [representable(&mesh.primitives()), mesh.primitives()] {
        let hits = check(primitives, 1_000, 130, |l| l);
        assert!(hits > 0.3, "only {hits} of the rays hit anything");
    }
}

#[test]
fn tree_equals_brute_force_on_spheres_of_all_scales() {
    for (seed, sizes) in [(30, -9.0..0.0), (31, -2.0..1.5)] {
        let mut random = Random::new(seed);
        let spheres: Vec<Primitive> = (0..300)
            .map(|_| Sphere::new(random.in_cube(), random.log_uniform(sizes.start, sizes.end)).unwrap().into())
            .collect();
        let hits = check(spheres, 20_000, 130 + seed, |l| l);
        assert!(hits > 0.3, "only {hits} of the rays hit anything");
    }
}

#[test]
fn tree_equals_brute_force_on_parallelograms_and_disks_of_all_scales() {
    for seed in 0..2 {
        let mut random = Random::new(60 + seed);
        let edge = |random: &mut Random| random.direction() * random.log_uniform(-5.0, 0.3);
        let shapes: Vec<Primitive> = (0..300)
            .filter_map(|i| match i % 3 {
                0 => {
                    Disk::new(random.in_cube(), random.direction(), random.log_uniform(-5.0, 0.0)).ok().map(Into::into)
                }
                _ => {
                    let (a, b) = (edge(&mut random), edge(&mut random));
                    Parallelogram::new(random.in_cube(), a, b).ok().map(Into::into)
                }
            })
            .collect();
        let hits = check(shapes, 15_000, 160 + seed, |l| l);
        assert!(hits > 0.3, "only {hits} of the rays hit anything");
    }
}

#[test]
fn a_ray_misses_a_tiny_triangle_beside_it() {
    // The edges' products round to the same value, which must not pass for an edge through the ray.
    let mut random = Random::new(8);
    let mut missed = 0;
    for _ in 0..100_000 {
        let size = random.log_uniform(-18.0, -13.0);
        let corners = [0, 1, 2].map(|_| random.in_cube() * size);
        let Ok(triangle) = Triangle::new(corners[0], corners[1], corners[2]) else { continue };
        let origin = random.in_cube();
        // At least a hundredth beside the triangle.
        let d = random.direction();
        let closest = origin - d * origin.dot(d);
        if closest.length() < 1e-2 {
            continue;
        }
        let geometry = Geometry::build(vec![triangle.into()]).unwrap();
        assert!(geometry.closest_hit(&Ray::free(origin, d)).is_none(), "{origin:?} {d:?} {corners:?}");
        missed += 1;
    }
    assert!(missed > 90_000);
}

#[test]
fn tree_equals_brute_force_on_triangles_that_converge() {
    // Triangles of 2⁰ to 2⁻⁵⁰ around a corner.
    let shifted = |p: &Primitive| match p {
        Primitive::Triangle(t) => {
            let [a, b, c] = t.vertices().map(|q| q + v(1.0, 1.0, 1.0));
            Triangle::new(a, b, c).ok().map(Primitive::from)
        }
        _ => None,
    };
    let primitives: Vec<Primitive> = converging(50).iter().filter_map(shifted).collect();
    let mut all = primitives.clone();
    for k in 1..6 {
        // Copies at other places about the same corner.
        let s = 1.0 + 0.13 * f64::from(k);
        all.extend(primitives.iter().filter_map(|p| match p {
            Primitive::Triangle(t) => {
                let [a, b, c] = t.vertices().map(|q| v(q.y * s, q.z, q.x / s));
                Triangle::new(a, b, c).ok().map(Primitive::from)
            }
            _ => None,
        }));
    }
    let hits = check(all, 20_000, 140, |l| l);
    assert!(hits > 0.1, "only {hits} of the rays hit anything");
}

#[test]
fn tree_equals_brute_force_where_surfaces_lie_close_behind_each_other() {
    for seed in 0..3 {
        let shapes = stacks(&mut Random::new(70 + seed), 200);
        // All that is flat in trees of triangles alone, too.
        let triangles = shapes.iter().filter(|p| matches!(p, Primitive::Triangle(_))).cloned().collect();
        for primitives in [representable(&shapes), triangles, shapes] {
            let hits = check(primitives, 15_000, 170 + seed, |l| l);
            assert!(hits > 0.3, "only {hits} of the rays hit anything");
        }
    }
}

#[test]
fn tree_equals_brute_force_in_shared_slab_planes() {
    for seed in 0..4 {
        let primitives = blocks(&mut Random::new(seed), 150);
        let hits = check(primitives, 20_000, 200 + seed, |(o, d)| {
            // Half of the origins on the grid that all the planes lie on.
            let snap = |c: f64| if d.x > 0.0 { (c * 4.0).round() * 0.25 } else { c };
            (v(snap(o.x), snap(o.y), snap(o.z)), d)
        });
        assert!(hits > 0.3, "only {hits} of the rays hit anything");
    }
}

#[test]
fn tree_equals_brute_force_far_from_the_origin() {
    let offset = v(3.0e6, -1.0e6, 2.0e6);
    let primitives = soup(&mut Random::new(7), 200, -3.0..0.0).iter().filter_map(|p| placed(p, 1.0, offset)).collect();
    let hits = check(primitives, 20_000, 300, |(o, d)| (o + offset, d));
    assert!(hits > 0.15, "only {hits} of the rays hit anything");
}

#[test]
fn ten_thousand_identical_primitives_neither_overflow_nor_slow_the_build() {
    let t = Triangle::new(v(0.0, 0.0, 1.0), v(1.0, 0.0, 1.0), v(0.0, 1.0, 1.0)).unwrap();
    let geometry = Geometry::build(vec![t.into(); 10_000]).unwrap();
    let ray = Ray::free(v(0.2, 0.2, 0.0), v(0.0, 0.0, 1.0));
    let hit = geometry.closest_hit(&ray).unwrap();
    assert_eq!((hit.surface, hit.t), (PrimitiveId(0).into(), 1.0), "ties go to the lowest id");
}

#[test]
fn a_million_coincident_boxes_build_in_seconds() {
    let s = Sphere::new(v(1.0, 2.0, 3.0), 0.5).unwrap();
    let start = std::time::Instant::now();
    let geometry = Geometry::build(vec![s.into(); 1_000_000]).unwrap();
    // n log n takes about a second; a quadratic build would take hours.
    assert!(start.elapsed().as_secs() < 60);
    assert!(geometry.occluded(&Ray::free(Vec3::<f32>::ZERO, Vec3::new(1.0, 2.0, 3.0))));
}

#[test]
fn zeros_of_both_signs_in_a_direction_give_the_same_hit_on_both_faces() {
    // Hard cases 15 and 16: rays in the slab planes of flat boxes.
    let mut primitives = Vec::new();
    for i in 0..32 {
        let z = f64::from(i) * 0.25;
        primitives.push(Parallelogram::new(v(0.0, 0.0, z), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0)).unwrap().into());
        primitives.push(Parallelogram::new(v(2.0, z, 0.0), v(0.0, 0.25, 0.0), v(0.0, 0.0, 8.0)).unwrap().into());
    }
    let geometry = Geometry::build(primitives).unwrap();
    for (zx, zy) in [(0.0, 0.0), (-0.0, 0.0), (0.0, -0.0), (-0.0, -0.0)] {
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (0.5, 0.0), (0.5, 0.5)] {
            for (z, dz, expected) in [(-1.0, 1.0, 1.0), (9.0, -1.0, 1.25)] {
                let hit = geometry.closest_hit(&Ray::free(v(x, y, z), v(zx, zy, dz))).unwrap();
                assert_eq!(hit.t, expected, "{x} {y} {zx} {zy} {dz}");
                let ray = Ray::<f32>::free(v(x, y, z).cast(), v(zx, zy, dz).cast());
                assert_eq!(geometry.closest_hit(&ray).unwrap().t, expected as f32);
                assert!(geometry.occluded(&ray));
            }
        }
        for z in [0.0, 0.5, 7.75, 8.0] {
            let hit = geometry.closest_hit(&Ray::free(v(1.5, 0.25, z), v(1.0, zx, zy))).unwrap();
            assert_eq!(hit.t, 0.5, "{z} {zx} {zy}");
        }
    }
}

#[test]
fn scaling_by_powers_of_two_changes_no_bit_of_a_hit() {
    let base = soup(&mut Random::new(5), 100, -3.0..0.0);
    let scaled: Vec<Geometry> = [-40, 0, 40]
        .map(|e| {
            let s = 2.0_f64.powi(e);
            let primitives = base.iter().filter_map(|p| placed(p, s, Vec3::ZERO)).collect();
            Geometry::build(primitives).unwrap()
        })
        .into();
    let mut random = Random::new(6);
    for _ in 0..20_000 {
        let (o, d) = line(&mut random, &[]);
        let [a, b, c] = [-40, 0, 40].map(|e| {
            let s = 2.0_f64.powi(e);
            let g = &scaled[(e / 40 + 1) as usize];
            let ray = Ray::free(o * s, d);
            g.closest_hit(&ray).map(|h| {
                let p = g.surface(&ray, &h);
                (h.t / s, h.surface, h.uv, p.position * (1.0 / s), p.position_error / s, p.normal)
            })
        });
        assert_eq!(a, b);
        assert_eq!(b, c);
    }
}

#[test]
fn rays_of_which_no_point_is_defined_hit_nothing() {
    let geometry = Geometry::build(soup(&mut Random::new(1), 50, -1.0..0.0)).unwrap();
    let nan = f64::NAN;
    for (o, d) in [
        (v(nan, 0.0, 0.0), v(1.0, 0.0, 0.0)),
        (v(0.0, 0.0, 0.0), v(0.0, nan, 1.0)),
        (v(0.0, 0.0, 0.0), v(0.0, -0.0, 0.0)),
        (v(f64::INFINITY, 0.0, 0.0), v(-1.0, 0.0, 0.0)),
        (v(0.0, 0.0, 0.0), v(f64::INFINITY, 0.0, 0.0)),
    ] {
        assert!(geometry.closest_hit(&Ray::free(o, d)).is_none());
        assert!(!geometry.occluded(&Ray::free(o, d)));
    }
    for far in [1e30, 1e200, 1e307] {
        // So far away that the scene is below the rounding of the origin: no panic, and the same as brute force.
        let line = (v(far, 0.5 * far, 0.0), v(-2.0, -1.0, 0.0));
        agrees(&geometry, line, f64::INFINITY, PrimitiveId::NONE, 0.0);
    }
    let empty = Geometry::build(Vec::new()).unwrap();
    assert!(empty.closest_hit(&Ray::free(v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0))).is_none());
    assert!(empty.bounds().is_none() && empty.is_empty());
}

#[test]
fn whatever_the_numbers_nothing_panics_and_the_tree_equals_brute_force() {
    let mut random = Random::new(40);
    let (mut shapes, mut hits) = (0, 0);
    let levels = level::all();
    for round in 0..3_000 {
        let primitives: Vec<Primitive> = (0..60)
            .filter_map(|_| {
                let [a, b, c] = [0, 1, 2].map(|_| random.any_vector());
                match random.below(4) {
                    0 => Sphere::new(a, b.x).ok().map(Primitive::from),
                    1 => Disk::new(a, b, c.x).ok().map(Primitive::from),
                    2 => Parallelogram::new(a, b, c).ok().map(Primitive::from),
                    _ => Triangle::new(a, b, c).ok().map(Primitive::from),
                }
            })
            .collect();
        shapes += primitives.len();
        let features = features(&primitives);
        // In turn with a tree and without.
        let level = levels[round / 2 % levels.len()];
        let geometry = level::forced(level, || Geometry::build_with(primitives, [0, 128][round % 2]).unwrap());
        for _ in 0..30 {
            let mut point = || match random.below(2) {
                0 if !features.is_empty() => features[random.below(features.len())],
                _ => random.any_vector(),
            };
            let (origin, target) = (point(), point());
            let ray = Ray::free(origin, target - origin);
            if let Some(hit) = geometry.closest_hit(&ray) {
                assert!(!hit.t.is_nan() && hit.uv.iter().all(|w| (0.0..=1.0).contains(w)), "{ray:?} {hit:?}");
                let p = geometry.surface(&ray, &hit);
                p.spawn(ray.direction);
                p.spawn_to(origin, SurfaceId::NONE);
            }
            let t_max = random.any_number();
            hits += agrees(&geometry, (origin, target - origin), t_max, PrimitiveId(random.below(9) as u32), 0.0);
        }
    }
    assert!(shapes > 30_000 && hits > 10_000, "{shapes} {hits}");
}

#[test]
fn shapes_that_have_no_area_or_no_numbers_are_refused() {
    use crate::ShapeError::{NoArea, NotFinite, OutOfRange};
    let (o, x, y) = (v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0));
    assert_eq!(Triangle::new(o, x, v(f64::NAN, 0.0, 0.0)), Err(NotFinite));
    assert_eq!(Triangle::new(o, x, x), Err(NoArea));
    assert_eq!(Triangle::new(o, x * 0.1, x * 0.3), Err(NoArea));
    assert_eq!(Triangle::new(o, x, v(1e40, 1.0, 0.0)), Err(OutOfRange));
    assert_eq!(Parallelogram::new(o, x, x * -2.0), Err(NoArea));
    assert_eq!(Parallelogram::new(o, x, v(0.0, f64::INFINITY, 0.0)), Err(NotFinite));
    assert_eq!(Parallelogram::new(v(1e20, 0.0, 0.0), x, y), Err(NoArea), "the corners round to a line");
    assert_eq!(Sphere::new(o, 0.0), Err(NoArea));
    assert_eq!(Sphere::new(o, -1.0), Err(NoArea));
    assert_eq!(Sphere::new(o, f64::NAN), Err(NotFinite));
    assert_eq!(Sphere::new(o, 1e-40), Err(OutOfRange));
    assert_eq!(Disk::new(o, o, 1.0), Err(NoArea));
    assert_eq!(Disk::new(o, x, f64::INFINITY), Err(NotFinite));
    // A needle that f64 resolves is a triangle (hard case 13).
    assert!(Triangle::new(o, x * 1e5, v(5e4, 1.0, 0.0)).is_ok());
    assert!(Triangle::new(o, x, v(0.5, 1e-25, 0.0)).is_ok());
}

#[test]
fn tie_at_one_distance_goes_to_the_lowest_id_in_any_order() {
    let square = |x: f64| Parallelogram::new(v(x, -1.0, 1.0), v(2.0, 0.0, 0.0), v(0.0, 2.0, 0.0)).unwrap();
    for n in [2, 40] {
        let primitives: Vec<Primitive> = (0..n).map(|i| square(-1.0 - f64::from(i % 7) * 0.1).into()).collect();
        let geometry = Geometry::build(primitives).unwrap();
        let hit = geometry.closest_hit(&Ray::free(v(0.0, 0.0, 0.0), v(0.0, 0.0, 1.0))).unwrap();
        assert_eq!((hit.t, hit.surface), (1.0, PrimitiveId(0).into()));
    }
}
