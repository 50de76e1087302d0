//! Geometry that is placed is as good as geometry that is there (hard case 17).

use super::brute_force;
use crate::test_support::*;
use crate::{Cylinder, Disk, Triangle};
use crate::{Geometry, Instance, Parallelogram, Placement, Primitive, PrimitiveId, Ray, Sphere, SurfaceId};
use etalon_optics::{Real, Vec3};
use std::sync::Arc;

type Rows = [[f64; 3]; 3];

pub(super) fn build(primitives: Vec<Primitive>) -> Arc<Geometry> {
    Arc::new(Geometry::build(primitives).unwrap())
}

pub(super) fn place(geometry: &Arc<Geometry>, rows: Rows, by: V) -> Primitive {
    Instance::new(geometry.clone(), Placement::new(rows, by.to_array()).unwrap()).unwrap().into()
}

/// A similarity: turned, mirrored or not, scaled.
pub(super) fn similarity(random: &mut Random, scale: f64, mirror: bool) -> Rows {
    let f = etalon_optics::Frame::from_normal(random.direction());
    let side = if mirror { -1.0 } else { 1.0 };
    [f.s * scale, f.t * scale, f.n * (scale * side)].map(Vec3::to_array)
}

/// Any map, its three stretches spread over the decades of `scales`.
pub(super) fn affine(random: &mut Random, scales: std::ops::Range<f64>) -> Rows {
    let mirror = random.below(2) == 0;
    let turn = similarity(random, 1.0, mirror);
    let stretches = [0, 1, 2].map(|_| random.log_uniform(scales.start, scales.end));
    let other = similarity(random, 1.0, false);
    let stretched = [0, 1, 2].map(|i| Vec3::from_array(other[i]) * stretches[i]);
    turn.map(|row| (stretched[0] * row[0] + stretched[1] * row[1] + stretched[2] * row[2]).to_array())
}

pub(super) fn scaling(s: [f64; 3]) -> Rows {
    [[s[0], 0.0, 0.0], [0.0, s[1], 0.0], [0.0, 0.0, s[2]]]
}

/// The image of a shape; of a ball or a disk under a similarity.
fn baked(primitive: &Primitive, rows: &Rows, by: V) -> Primitive {
    let rows = rows.map(Vec3::from_array);
    let vector = |p: V| v(rows[0].dot(p), rows[1].dot(p), rows[2].dot(p));
    let point = |p: V| vector(p) + by;
    let scale = rows[0].length();
    let mirrors = rows[0].cross(rows[1]).dot(rows[2]) < 0.0;
    match primitive {
        Primitive::Sphere(q) => Sphere::new(point(q.centre()), q.radius() * scale).unwrap().into(),
        Primitive::Disk(q) => Disk::new(point(q.centre()), vector(q.normal()), q.radius() * scale).unwrap().into(),
        Primitive::Cylinder(q) => {
            let [a, b] = q.ends().map(point);
            Cylinder::new(a, b, q.radius() * scale, q.is_capped()).unwrap().into()
        }
        Primitive::Parallelogram(q) => {
            let [a, b] = q.edges().map(vector);
            let (a, b) = if mirrors { (b, a) } else { (a, b) };
            Parallelogram::new(point(q.corner()), a, b).unwrap().into()
        }
        Primitive::Triangle(q) => {
            let [a, b, c] = q.vertices().map(point);
            let (b, c) = if mirrors { (c, b) } else { (b, c) };
            Triangle::new(a, b, c).unwrap().into()
        }
        Primitive::Instance(_) => unreachable!("soups have none"),
    }
}

/// Primitives, placed groups of them and groups of groups.
pub(super) fn placed_soup(random: &mut Random, count: usize) -> Vec<Primitive> {
    let inner = build(soup(random, 30, -3.0..0.0));
    let mut middle = soup(random, 5, -2.0..0.0);
    middle.extend((0..12).map(|_| {
        let by = random.in_cube() * 2.0;
        place(&inner, affine(random, -1.0..0.5), by)
    }));
    let middle = build(middle);
    let mut all = soup(random, count, -2.0..0.0);
    for i in 0..count {
        let by = random.in_cube();
        all.push(place(if i % 3 == 0 { &middle } else { &inner }, affine(random, -2.0..0.0), by));
    }
    all
}

#[test]
fn tree_equals_brute_force_on_instances_within_instances() {
    for seed in 0..3 {
        for count in [2, 40] {
            let hits = brute_force::at_each_level(|_| {
                brute_force::check(placed_soup(&mut Random::new(50 + seed), count), 4_000, 150 + seed, |l| l)
            });
            assert!(hits > 0.15, "only {hits} of the rays hit anything");
        }
    }
}

#[test]
fn tree_equals_brute_force_on_placed_meshes() {
    // What is placed has a tree, of triangles alone or of others too, and is small beside the ways that rays take to it.
    let hits = |seed: u64| {
        let mut random = Random::new(80 + seed);
        let mesh = Mesh::sphere(9, 12, |p| 1.0 + 0.3 * (7.0 * p.x).sin() * (5.0 * p.y).cos()).primitives();
        let others = soup(&mut random, 40, -2.0..0.0);
        // Whose corners are those of its box: what rounding lets a ray meet outside, the box decides.
        let sheet = (0..32_u8).map(|i| {
            let corner = v(f64::from(i / 2 % 4) * 0.5 - 1.0, f64::from(i / 8) * 0.5 - 1.0, 0.0);
            let [x, y] = [v(0.5, 0.0, 0.0), v(0.0, 0.5, 0.0)];
            Triangle::new(corner, corner + x + y, corner + if i % 2 == 0 { x } else { y }).unwrap().into()
        });
        let placed = [representable(&mesh), mesh, others, sheet.collect()];
        let placed = placed.map(|p| Arc::new(Geometry::build_with(p, 0).unwrap()));
        let primitives: Vec<Primitive> = (0..60)
            .map(|i| {
                let by = random.in_cube();
                let rows = match i % 4 {
                    0 => affine(&mut random, -3.0..0.0),
                    1 => scaling([[1.0, 0.5, 0.01][i / 4 % 3]; 3]),
                    _ => {
                        let scale = random.log_uniform(-5.0, 0.0);
                        similarity(&mut random, scale, i % 4 == 2)
                    }
                };
                place(&placed[i * 7 / 4 % 4], rows, by)
            })
            .collect();
        brute_force::check(primitives, 6_000, 180 + seed, |l| l)
    };
    for seed in 0..3 {
        let hits = brute_force::at_each_level(|_| hits(seed));
        assert!(hits > 0.3, "only {hits} of the rays hit anything");
    }
}

/// Compares hits of `rays` lines on a geometry with those on its baked copy; counts them.
fn same_as_baked(random: &mut Random, placed: &Geometry, flat: &Geometry, rays: usize) -> usize {
    let bounds = flat.bounds().unwrap();
    let (centre, size) = (bounds.centre(), bounds.extent().max_component());
    let (mut hits, mut differing) = (0, 0);
    for _ in 0..rays {
        let origin = centre + random.in_cube() * size;
        let direction = centre + random.in_cube() * (0.6 * size) - origin;
        let ray = Ray::free(origin, direction);
        let (a, b) = (placed.closest_hit(&ray), flat.closest_hit(&ray));
        let (Some(a), Some(b)) = (a, b) else {
            // Only along silhouettes, which a rounding moves.
            differing += usize::from(a.is_some() != b.is_some());
            continue;
        };
        hits += 1;
        if (a.t - b.t).abs() > 1e-6 * b.t {
            differing += 1;
            continue;
        }
        let (p, q) = (placed.surface(&ray, &a), flat.surface(&ray, &b));
        assert!((p.position - q.position).length() <= 1e-6 * size);
        // One primitive of the baked copy for each of the placed one, in the order of the paths.
        assert!((p.normal - q.normal).length() < 1e-6, "{p:?} {q:?}");
        // Not more than what the map can round: |L||L⁻¹| ≤ 3 for the similarities and below 1e3 for the maps here.
        assert!(p.position_error <= 1e4 * f64::EPSILON * (size + q.position.length()), "{p:?}");
        let light = bounds.max + random.direction() * size;
        assert_eq!(
            placed.occluded(&p.spawn_to(light, SurfaceId::NONE)),
            flat.occluded(&q.spawn_to(light, SurfaceId::NONE)),
            "{p:?}"
        );
    }
    assert!(differing * 2000 <= rays, "{differing} of {rays} differ");
    hits
}

#[test]
fn an_instance_is_the_same_as_its_baked_copy() {
    let mut random = Random::new(60);
    let mut hits = 0;
    for round in 0..40 {
        let shapes = soup(&mut random, 25, -1.0..0.0);
        let by = random.in_cube() * 3.0;
        let scale = random.log_uniform(-5.0, 5.0);
        let similar = similarity(&mut random, scale, round % 2 == 0);
        let copy: Vec<Primitive> = shapes.iter().map(|p| baked(p, &similar, by)).collect();
        let placed = Geometry::build(vec![place(&build(shapes), similar, by)]).unwrap();
        hits += same_as_baked(&mut random, &placed, &Geometry::build(copy).unwrap(), 2_000);
        // Any map, of what stays what it is under any.
        let flat = |p: &Primitive| matches!(p, Primitive::Triangle(_) | Primitive::Parallelogram(_));
        let shapes: Vec<Primitive> = soup(&mut random, 60, -1.0..0.0).into_iter().filter(flat).collect();
        let any = affine(&mut random, -1.5..1.5);
        let copy: Vec<Primitive> = shapes.iter().map(|p| baked(p, &any, by)).collect();
        let placed = Geometry::build(vec![place(&build(shapes), any, by)]).unwrap();
        hits += same_as_baked(&mut random, &placed, &Geometry::build(copy).unwrap(), 2_000);
    }
    assert!(hits > 25_000, "{hits}");
}

#[test]
fn nested_scales_that_cancel_leave_everything_in_place() {
    // s·(1/s) for s from 1e-5 to 1e5, mirrored or not, alike along the axes or not.
    let mut random = Random::new(61);
    let mut hits = 0;
    for exponent in -5..=5 {
        for mirror in [1.0, -1.0] {
            let s = 10.0_f64.powi(exponent);
            let shapes = soup(&mut random, 40, -1.5..0.0);
            let flat = Geometry::build(shapes.clone()).unwrap();
            for (outer, inner) in [
                (scaling([mirror * s; 3]), scaling([mirror / s; 3])),
                (scaling([mirror * s, 1.0, 1.0 / s]), scaling([mirror / s, 1.0, s])),
            ] {
                let once = build(vec![place(&build(shapes.clone()), inner, Vec3::ZERO)]);
                let twice = Geometry::build(vec![place(&once, outer, Vec3::ZERO)]).unwrap();
                for _ in 0..1_000 {
                    let origin = random.in_cube() * 2.0;
                    let ray = Ray::free(origin, random.in_cube() - origin);
                    let (a, b) = (twice.closest_hit(&ray), flat.closest_hit(&ray));
                    let (Some(a), Some(b)) = (a, b) else {
                        assert_eq!(a.is_some(), b.is_some());
                        continue;
                    };
                    hits += 1;
                    assert!((a.t - b.t).abs() <= 1e-6 * b.t, "{a:?} {b:?} at {s}");
                    assert_eq!((a.surface.instance, a.surface.primitive), (2, b.surface.primitive));
                    let (p, q) = (twice.surface(&ray, &a), flat.surface(&ray, &b));
                    assert!((p.position - q.position).length() < 1e-6 && (p.normal - q.normal).length() < 1e-6);
                }
            }
        }
    }
    assert!(hits > 10_000, "{hits}");
}

#[test]
fn a_stretched_ball_is_an_ellipsoid_with_its_outward_side_outside() {
    fn check<R: Real>(tolerance: f64, decades: f64) {
        let mut random = Random::new(62);
        let ball = build(vec![Sphere::new(v(0.0, 0.0, 0.0), 1.0).unwrap().into()]);
        for _ in 0..2_000 {
            let axes = [0, 1, 2].map(|_| random.log_uniform(-decades, decades));
            let signed = [0, 1, 2].map(|k| if random.below(2) == 0 { axes[k] } else { -axes[k] });
            let by = random.in_cube();
            let geometry = Geometry::build(vec![place(&ball, scaling(signed), by)]).unwrap();
            let towards = random.direction();
            let origin = by + v(towards.x * axes[0], towards.y * axes[1], towards.z * axes[2]) * 3.0;
            let aim = by + v(random.signed() * axes[0], random.signed() * axes[1], random.signed() * axes[2]) * 0.5;
            let ray = Ray::<R>::free(origin.cast(), (aim - origin).cast());
            let p = geometry.surface(&ray, &geometry.closest_hit(&ray).expect("the ellipsoid"));
            let local = p.position.to_f64() - by;
            let scaled = v(local.x / axes[0], local.y / axes[1], local.z / axes[2]);
            assert!((scaled.length() - 1.0).abs() < 10.0 * tolerance, "{scaled:?}");
            // The gradient of Σ(x/a)².
            let gradient = v(scaled.x / axes[0], scaled.y / axes[1], scaled.z / axes[2]).normalized();
            assert!((p.normal.to_f64() - gradient).length() < 100.0 * tolerance, "{p:?} {gradient:?}");
            // Outward nothing is hit again, inward the far side always is.
            let tangent = etalon_optics::Frame::from_normal(p.normal);
            let slant = R::from_f64(random.log_uniform(-4.0, 0.0));
            let along = tangent.s * R::from_f64(random.signed()) + tangent.t * R::from_f64(random.signed());
            let (out, inward) = (along + p.normal * slant, along - p.normal * slant);
            assert!(geometry.closest_hit(&p.spawn(out)).is_none() && !geometry.occluded(&p.spawn(out)));
            let far = geometry.closest_hit(&p.spawn(inward));
            assert!(far.is_some_and(|hit| hit.surface == p.surface), "{p:?}");
        }
    }
    check::<f64>(1e-12, 1.5);
    // An origin rounded to f32 sees the normal of a place that far away: curvatures above 30 would turn it by more than
    // the slants here.
    check::<f32>(1e-4, 0.5);
}

#[test]
fn no_ray_escapes_from_a_placed_mesh_nor_meets_it_again() {
    fn check<R: Real>(geometry: &Geometry, inner: &Mesh, map: impl Fn(V) -> V, seed: u64) {
        let mut random = Random::new(seed);
        let bounds = geometry.bounds().unwrap();
        for _ in 0..20_000 {
            let f = inner.faces[random.below(inner.faces.len())].map(|i| inner.vertices[i]);
            let (s, t) = (random.unit(), random.unit());
            let target = match random.below(3) {
                0 => f[0],
                1 => f[0] + (f[1] - f[0]) * s,
                _ => f[0] + (f[1] - f[0]) * (s * t) + (f[2] - f[0]) * (s * (1.0 - t)),
            };
            let origin = map(random.in_cube() * 0.3);
            let ray = Ray::<R>::free(origin.cast(), map(target).cast::<R>() - origin.cast());
            let hit = geometry.closest_hit(&ray).expect("a wall");
            let p = geometry.surface(&ray, &hit);
            // The normal points outward, wherever the map took it.
            assert!(p.normal.dot(ray.direction) > R::ZERO);
            let again = geometry.closest_hit(&p.spawn(p.normal));
            assert!(again.is_none(), "the body is convex {p:?} {again:?} {target:?} {f:?}");
            let back = p.spawn(origin.cast::<R>() - p.position);
            assert!(geometry.closest_hit(&back).is_some(), "from the inside there is always a wall: {back:?}");
        }
        assert!(bounds.extent().max_component() > 0.0);
    }
    let mut random = Random::new(63);
    for (k, mesh) in [Mesh::cube(), Mesh::sphere(16, 16, |_| 1.0)].into_iter().enumerate() {
        for scales in [0.0..0.0, -1.0..1.0, -2.0..2.0] {
            let rows = affine(&mut random, scales);
            let by = random.in_cube() * 4.0;
            let placement = Placement::new(rows, by.to_array()).unwrap();
            let geometry = Geometry::build(vec![place(&build(mesh.primitives()), rows, by)]).unwrap();
            check::<f64>(&geometry, &mesh, |p| placement.point(p), k as u64);
            check::<f32>(&geometry, &mesh, |p| placement.point(p), k as u64);
        }
    }
}

#[test]
fn a_ray_that_leaves_one_instance_may_meet_the_next_of_the_same_primitive() {
    let square =
        build(vec![Parallelogram::new(v(-1.0, -1.0, 0.0), v(2.0, 0.0, 0.0), v(0.0, 2.0, 0.0)).unwrap().into()]);
    let identity = scaling([1.0; 3]);
    let pair = build(vec![place(&square, identity, v(0.0, 0.0, 0.0)), place(&square, identity, v(0.0, 0.0, 1.0))]);
    let all = Geometry::build(vec![
        place(&square, identity, v(0.0, 0.0, -1.0)),
        place(&pair, identity, v(0.0, 0.0, 0.0)),
        place(&pair, scaling([1.0, 1.0, -1.0]), v(0.0, 0.0, 5.0)),
    ])
    .unwrap();
    let mut ray = Ray::free(v(0.25, 0.5, -2.0), v(0.0, 0.0, 1.0));
    let mut found = Vec::new();
    while let Some(hit) = all.closest_hit(&ray) {
        let p = all.surface(&ray, &hit);
        assert_eq!(p.normal.z, if p.position.z > 3.0 { -1.0 } else { 1.0 }, "a mirror turns the outward side with it");
        found.push((p.position.z, hit.surface.instance, all.path(hit.surface)));
        ray = p.spawn(ray.direction);
    }
    let path = |indices: &[u32]| indices.iter().map(|&i| PrimitiveId(i)).collect::<Vec<_>>();
    let expected = [
        (-1.0, 1, path(&[0])),
        (0.0, 3, path(&[1, 0])),
        (1.0, 4, path(&[1, 1])),
        (4.0, 7, path(&[2, 1])),
        (5.0, 6, path(&[2, 0])),
    ];
    assert_eq!(found, expected);
    // Aimed at, a surface hides nothing; its twins do.
    let at = |instance| SurfaceId { instance, primitive: PrimitiveId(0) };
    let to = |z: f64, aims_at| Ray { t_max: 1.5, aims_at, ..Ray::free(v(0.0, 0.0, z - 1.0), v(0.0, 0.0, 1.0)) };
    assert!(!all.occluded(&to(-1.0, at(1))) && all.occluded(&to(-1.0, at(3))));
    assert!(!all.occluded(&to(5.5, at(6))) && all.occluded(&to(5.5, at(7))));
}

#[test]
fn ties_between_instances_go_to_the_first_in_any_tree() {
    let square: Primitive = Parallelogram::new(v(-1.0, -1.0, 0.0), v(2.0, 0.0, 0.0), v(0.0, 2.0, 0.0)).unwrap().into();
    let shared = build(vec![square.clone(), square.clone()]);
    for count in [2, 50] {
        let mut primitives: Vec<Primitive> =
            (0..count).map(|_| place(&shared, scaling([1.0; 3]), Vec3::ZERO)).collect();
        primitives.push(square.clone());
        let ray = Ray::free(v(0.1, 0.2, -1.0), v(0.0, 0.0, 1.0));
        let hit = Geometry::build(primitives.clone()).unwrap().closest_hit(&ray).unwrap();
        assert_eq!((hit.t, hit.surface), (1.0, SurfaceId { instance: 1, primitive: PrimitiveId(0) }));
        primitives.rotate_right(1);
        let hit = Geometry::build(primitives).unwrap().closest_hit(&ray).unwrap();
        assert_eq!((hit.t, hit.surface), (1.0, PrimitiveId(0).into()));
    }
}

#[test]
fn which_of_two_instances_is_nearer_does_not_depend_on_the_order_however_near_both_are() {
    let plane = build(vec![Triangle::new(v(-1.0, -1.0, 0.0), v(1.0, -1.0, 0.0), v(0.0, 1.0, 0.0)).unwrap().into()]);
    let mut differ = 0;
    for ulps in 1..4000_u64 {
        // From below the plane by some of the smallest numbers, of which the larger instance's units are eight.
        let height = f64::from_bits(37 * ulps);
        let ray = Ray::free(v(0.0, -0.2, -height), v(0.0, 0.0, 1.0));
        let placed = [1.0, 8.0].map(|scale| place(&plane, scaling([scale; 3]), Vec3::ZERO));
        let [a, b] = placed.clone().map(|one| build(vec![one]).closest_hit(&ray).map(|hit| hit.t));
        differ += usize::from(a != b);
        let nearest = a.into_iter().chain(b).fold(f64::INFINITY, f64::min);
        let [first, second] = placed;
        for order in [vec![first.clone(), second.clone()], vec![second, first]] {
            for geometry in [build(order.clone()), Arc::new(Geometry::build_with(order, 0).unwrap())] {
                let hit = geometry.closest_hit(&ray);
                assert_eq!(hit.map(|hit| hit.t), Some(nearest).filter(|t| t.is_finite()), "{height:e}");
                assert_eq!(hit, geometry.one_by_one(&ray).0);
            }
        }
    }
    assert!(differ > 100, "{differ}");
}
