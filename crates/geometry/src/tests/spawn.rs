//! Rays that leave a surface.

use crate::ray::ExactPoint;
use crate::test_support::*;
use crate::{Geometry, Parallelogram, Primitive, PrimitiveId, Ray, SurfaceId, SurfacePoint, Triangle};
use etalon_optics::{Real, Vec3};

/// From hits on a scene of flat, connected primitives, leaves to the side that the ray came from and counts rays that
/// hit what they left or a coplanar neighbour: any hit nearer than `near`.
fn rehits<R: Real>(geometry: &Geometry, rays: usize, seed: u64, near: f64) -> (usize, usize) {
    let mut random = Random::new(seed);
    let features =
        features(&(0..geometry.len() as u32).map(|i| geometry.primitive(PrimitiveId(i)).clone()).collect::<Vec<_>>());
    let (mut tried, mut lost) = (0, 0);
    while tried < rays {
        let origin = v(random.signed() * 3.0, random.signed() * 3.0, 2.0 + random.unit());
        let target = if tried % 2 == 0 { features[random.below(features.len())] } else { random.in_cube() };
        let ray = Ray::<R>::free(origin.cast(), (target - origin).cast());
        let Some(hit) = geometry.closest_hit(&ray) else { continue };
        let p = geometry.surface(&ray, &hit);
        tried += 1;
        let d = random.direction();
        let d = if d.dot(p.normal.to_f64()) * ray.direction.dot(p.normal).to_f64() > 0.0 { -d } else { d };
        if let Some(hit) = geometry.closest_hit(&p.spawn(d.cast())) {
            lost += usize::from(hit.t.to_f64() < near);
        }
    }
    (tried, lost)
}

#[test]
fn a_ray_leaves_a_plane_of_triangles_without_meeting_it_again() {
    // Hard case 12, in general position: 2 × 8 × 8 triangles of a plane, hit on edges, vertices and between.
    let mut primitives: Vec<Primitive> = Vec::new();
    let at = |i: i32, j: i32| turned(v(f64::from(i) * 0.25 - 1.0, f64::from(j) * 0.25 - 1.0, 0.0)) + v(0.3, 7.0, -0.2);
    for i in 0..8 {
        for j in 0..8 {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            primitives.push(Triangle::new(a, b, c).unwrap().into());
            primitives.push(Triangle::new(a, c, d).unwrap().into());
        }
    }
    let plane = Geometry::build(primitives.clone()).unwrap();
    let mut random = Random::new(1);
    let features = features(&primitives);
    let n = turned(v(0.0, 0.0, 1.0));
    for _ in 0..500_000 {
        let target = features[random.below(features.len())];
        let origin = v(0.3, 7.0, -0.2) + random.direction() * 3.0;
        leaves_the_plane::<f64>(&plane, origin, target, n, &mut random);
        leaves_the_plane::<f32>(&plane, origin, target, n, &mut random);
    }
}

fn leaves_the_plane<R: Real>(plane: &Geometry, origin: V, target: V, n: V, random: &mut Random) {
    let ray = Ray::<R>::free(origin.cast(), (target - origin).cast());
    let Some(hit) = plane.closest_hit(&ray) else { return };
    let p = plane.surface(&ray, &hit);
    let d = random.direction();
    if d.dot(n).abs() < 1e-4 {
        // The triangles are rounded: their planes differ by that much and more, and may be met again for good.
        return;
    }
    let hit = plane.closest_hit(&p.spawn(d.cast()));
    assert!(hit.is_none(), "{p:?} leaves along {d:?} and hits {hit:?}");
    assert!(!plane.occluded(&p.spawn(d.cast())));
}

#[test]
fn rays_leave_soups_of_rectangles_without_meeting_them_again() {
    // Exactly coplanar, axis-parallel rectangles that overlap and abut. Their other sides are at least 1/4 away, except
    // near corners, which a position within 1e-9 (f64) or 1e-3 (f32) of the hit cannot tell apart.
    let floor: Vec<Primitive> = (0..40)
        .map(|i| {
            let (x, y) = (f64::from(i % 7) * 0.25 - 1.0, f64::from(i % 5) * 0.25 - 1.0);
            Parallelogram::new(v(x, y, 0.1), v(0.5, 0.0, 0.0), v(0.0, 0.75, 0.0)).unwrap().into()
        })
        .collect();
    let floor = Geometry::build(floor).unwrap();
    assert_eq!(rehits::<f64>(&floor, 500_000, 2, f64::INFINITY).1, 0);
    assert_eq!(rehits::<f32>(&floor, 500_000, 3, f64::INFINITY).1, 0);
}

#[test]
fn a_light_close_above_a_shared_edge_is_seen_from_it() {
    // Hard case 12: excluding the hit triangle by id alone would let its neighbour hide the light.
    let (a, b, c, d) = (v(-1.0, -1.0, 0.1), v(1.0, -1.0, 0.1), v(1.0, 1.0, 0.1), v(-1.0, 1.0, 0.1));
    for lift in [1e-2, 1e-4, 1e-6] {
        let light = v(-0.5, -0.5, 0.1 + lift);
        let lamp = Parallelogram::new(light, v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0)).unwrap();
        let geometry = Geometry::build(vec![
            Triangle::new(a, b, c).unwrap().into(),
            Triangle::new(a, c, d).unwrap().into(),
            lamp.into(),
        ])
        .unwrap();
        let mut random = Random::new(9);
        for _ in 0..20_000 {
            let s = random.signed() * 0.99;
            let ray = Ray::free(v(s, s, 0.1 + 0.5 * lift), v(0.0, 0.0, -1.0));
            let hit = geometry.closest_hit(&ray).unwrap();
            assert!(hit.surface.primitive.0 < 2);
            let p = geometry.surface(&ray, &hit);
            let target = light + v(random.unit(), random.unit(), 0.0);
            assert!(!geometry.occluded(&p.spawn_to(target, PrimitiveId(2).into())));
        }
    }
}

#[test]
fn a_shadow_ray_ends_before_the_neighbours_of_its_target() {
    // The lamp is two triangles: the one not aimed at must not hide the other, at normal to grazing angles.
    let (a, b, c, d) = (v(-1.0, -1.0, 2.3), v(1.0, -1.0, 2.3), v(1.0, 1.0, 2.3), v(-1.0, 1.0, 2.3));
    let floor = Parallelogram::new(v(-9.0, -9.0, 0.1), v(18.0, 0.0, 0.0), v(0.0, 18.0, 0.0)).unwrap();
    let geometry = Geometry::build(vec![
        floor.into(),
        Triangle::new(a, b, c).unwrap().into(),
        Triangle::new(a, c, d).unwrap().into(),
    ])
    .unwrap();
    fn check<R: Real>(geometry: &Geometry) {
        let mut random = Random::new(10);
        for _ in 0..200_000 {
            let ray = Ray::<R>::free(v(random.signed(), random.signed(), 1.0).cast(), v(0.1, 0.2, -1.0).cast());
            let hit = geometry.closest_hit(&ray).unwrap();
            let p = geometry.surface(&ray, &hit);
            let s = random.signed();
            let ray = p.spawn_to(v(s, s, 2.3).cast(), PrimitiveId(1).into());
            assert!(!geometry.occluded(&ray), "{ray:?}");
        }
    }
    check::<f64>(&geometry);
    check::<f32>(&geometry);
}

#[test]
fn a_position_beyond_what_is_representable_is_off_by_infinity() {
    // At right angles to the normal, too.
    for normal in [v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0)] {
        let point = ExactPoint { position: v(1.0, 1e39, 0.0), error: Vec3::splat(1e20), normal, curvature: 0.0 };
        let single = SurfacePoint::<f32>::rounded(&point, SurfaceId::NONE, 0, 0.0);
        assert_eq!(single.position_error, f32::INFINITY);
        let double = SurfacePoint::<f64>::rounded(&point, SurfaceId::NONE, 0, 0.0);
        assert!((double.position_error - 1e20).abs() < 1e6, "{double:?}");
    }
}

#[test]
fn position_errors_bound_the_distance_to_the_true_surface() {
    // The truth of a plane: n·(p − a), with the exact normal (3, 4, 12)/13 of an exact construction.
    let (o, x, y) = (v(1.0, 2.0, 3.0), v(4.0, -3.0, 0.0), v(12.0, 0.0, -3.0));
    let geometry = Geometry::build(vec![Parallelogram::new(o, x, y).unwrap().into()]).unwrap();
    let n = v(3.0, 4.0, 12.0) * (1.0 / 13.0);
    fn check<R: Real>(geometry: &Geometry, o: V, n: V, random: &mut Random) {
        let target = o + v(4.0, -3.0, 0.0) * random.unit() + v(12.0, 0.0, -3.0) * random.unit();
        let origin = target + random.direction() * random.log_uniform(-2.0, 5.0);
        let ray = Ray::<R>::free(origin.cast(), (target - origin).cast());
        let Some(hit) = geometry.closest_hit(&ray) else { return };
        let p = geometry.surface(&ray, &hit);
        let distance = (p.position.to_f64() - o).dot(n);
        // The evaluation of this line errs too, by a few u of the offset.
        let slop = 8.0 * f64::UNIT_ROUNDOFF * 20.0;
        assert!(distance.abs() <= p.position_error.to_f64() + slop, "{distance} {p:?}");
        assert!(p.position_error.to_f64() <= 64.0 * 20.0 * R::UNIT_ROUNDOFF.to_f64(), "useless: {p:?}");
        for d in [n, -n] {
            let off = (p.spawn(d.cast()).origin.to_f64() - o).dot(d);
            assert!(off >= -slop, "{off} on the wrong side of {p:?}");
        }
    }
    let mut random = Random::new(11);
    for _ in 0..200_000 {
        check::<f64>(&geometry, o, n, &mut random);
        check::<f32>(&geometry, o, n, &mut random);
    }
}
