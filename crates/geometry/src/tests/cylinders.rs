//! Cylinders: held against their equation, closed at their rims, left and met again as they should be.

use crate::test_support::*;
use crate::{Cylinder, Geometry, PrimitiveId, Ray, ShapeError};
use etalon_optics::{Frame, Real, Vec3};

/// A cylinder of any proportions, and its radius.
fn any(random: &mut Random, capped: bool) -> Cylinder {
    let radius = random.log_uniform(-6.0, 6.0);
    let start = random.in_cube() * (radius * random.log_uniform(-1.0, 3.0));
    let end = start + random.direction() * (radius * random.log_uniform(-3.0, 3.0));
    Cylinder::new(start, end, radius, capped).unwrap()
}

/// A point of the inside, well away from the surface.
fn inside(random: &mut Random, c: &Cylinder) -> V {
    let f = Frame::from_normal(c.axis());
    let (x, y) = (random.signed() * 0.5, random.signed() * 0.5);
    c.centre() + (f.s * x + f.t * y) * c.radius() + f.n * (c.half_length() * random.signed() * 0.9)
}

/// How far a point is off the surface, m: outward positive.
fn off(c: &Cylinder, p: V) -> f64 {
    let o = p - c.centre();
    let z = o.dot(c.axis());
    let wall = (o - c.axis() * z).length() - c.radius();
    if c.is_capped() { wall.max(z.abs() - c.half_length()) } else { wall }
}

#[test]
fn hits_lie_on_the_surface_and_normals_point_outward() {
    fn check<R: Real>() {
        let mut random = Random::new(70);
        for i in 0..100_000 {
            let c = any(&mut random, i % 2 == 0);
            let size = c.radius() + c.half_length();
            let geometry = Geometry::build(vec![c.clone().into()]).unwrap();
            let target = inside(&mut random, &c);
            let origin = c.centre() + random.direction() * (size * random.log_uniform(0.5, 3.0));
            let ray = Ray::<R>::free(origin.cast(), (target - origin).cast());
            let Some(hit) = geometry.closest_hit(&ray) else {
                assert!(!c.is_capped(), "a closed cylinder was missed: {c:?} {ray:?}");
                continue;
            };
            let p = geometry.surface(&ray, &hit);
            let error = p.position_error.to_f64();
            // What evaluating the distance rounds comes on top.
            let rounding = 64.0 * f64::EPSILON * (size + origin.length());
            assert!(off(&c, p.position.to_f64()).abs() <= 2.0 * error + rounding, "{c:?} {p:?}");
            let stretch = if R::UNIT_ROUNDOFF.to_f64() > 1e-10 { 1e-5 } else { 1e-11 };
            assert!(error <= stretch * (size + origin.length() + c.centre().length()), "{error} {size}");
            if c.is_capped() {
                assert!(p.normal.dot(ray.direction) <= R::ZERO, "met from outside");
            }
            assert!((p.normal.length().to_f64() - 1.0).abs() < 1e-6);
        }
    }
    check::<f64>();
    check::<f32>();
}

#[test]
fn no_ray_escapes_from_a_closed_cylinder_wherever_it_is_aimed() {
    // At the wall, at the disks, and at the rims between them, from the inside and from the surface.
    let mut random = Random::new(71);
    for _ in 0..200_000 {
        let c = any(&mut random, true);
        let geometry = Geometry::build(vec![c.clone().into()]).unwrap();
        let origin = inside(&mut random, &c);
        let f = Frame::from_normal(c.axis());
        let [x, y] = {
            let d = random.direction();
            let l = d.x.hypot(d.y);
            [d.x / l, d.y / l]
        };
        let rim = (f.s * x + f.t * y) * c.radius();
        let end = c.ends()[random.below(2)];
        let target = match random.below(3) {
            0 => end + rim,
            1 => end + rim * random.unit(),
            _ => c.centre() + rim + c.axis() * (c.half_length() * random.signed()),
        };
        let ray = Ray::free(origin, target - origin);
        let hit = geometry.closest_hit(&ray).expect("a wall");
        let p = geometry.surface(&ray, &hit);
        assert!(p.normal.dot(ray.direction) >= 0.0, "met from inside");
        let back = inside(&mut random, &c) - p.position;
        let again = geometry.closest_hit(&p.spawn(back)).expect("the far side");
        assert!(again.t > 0.0 && geometry.occluded(&p.spawn(back)));
        // Outward nothing is met again.
        let out = p.normal + f.s * (0.9 * random.signed());
        if out.dot(p.normal) > 0.3 {
            assert!(geometry.closest_hit(&p.spawn(out)).is_none(), "{c:?} {p:?}");
        }
    }
}

#[test]
fn a_ray_through_the_open_ends_meets_nothing_and_one_at_the_wall_meets_it_twice() {
    let open = Cylinder::new(v(0.0, 0.0, -1.0), v(0.0, 0.0, 1.0), 0.5, false).unwrap();
    let geometry = Geometry::build(vec![open.clone().into()]).unwrap();
    let through = |x: f64, y: f64| Ray::free(v(x, y, -3.0), v(0.0, 0.0, 1.0));
    assert!(geometry.closest_hit(&through(0.2, 0.1)).is_none());
    assert!(geometry.closest_hit(&through(0.6, 0.1)).is_none());
    let across = Ray::free(v(-2.0, 0.0, 0.25), v(1.0, 0.0, 0.0));
    let hit = geometry.closest_hit(&across).unwrap();
    let p = geometry.surface(&across, &hit);
    assert_eq!((hit.t, p.normal, p.position), (1.5, v(-1.0, 0.0, 0.0), v(-0.5, 0.0, 0.25)));
    let on = p.spawn(across.direction);
    let far = geometry.closest_hit(&on).unwrap();
    assert_eq!(far.surface, PrimitiveId(0).into());
    let q = geometry.surface(&on, &far);
    assert_eq!((q.position, q.normal), (v(0.5, 0.0, 0.25), v(1.0, 0.0, 0.0)));
    assert!(geometry.closest_hit(&q.spawn(across.direction)).is_none());
    // In at an open end, out through the wall.
    let slanted = Ray::free(v(0.0, 0.0, -2.0), v(0.25, 0.0, 1.0));
    let hit = geometry.closest_hit(&slanted).unwrap();
    assert_eq!(hit.t, 2.0);
    // The closed one is met at its end, the same way for zeros of both signs.
    let closed = Cylinder::new(v(0.0, 0.0, -1.0), v(0.0, 0.0, 1.0), 0.5, true).unwrap();
    let geometry = Geometry::build(vec![closed.clone().into()]).unwrap();
    for zero in [0.0, -0.0] {
        for x in [0.0, 0.25, 0.5] {
            let ray = Ray::free(v(x, 0.0, -3.0), v(zero, zero, 1.0));
            let hit = geometry.closest_hit(&ray).unwrap();
            assert_eq!((hit.t, geometry.surface(&ray, &hit).normal.z.abs() > 0.5 || x == 0.5), (2.0, true));
        }
    }
    let tau = std::f64::consts::TAU;
    assert!((closed.area() / (tau * 0.5 * 2.5) - 1.0).abs() < 1e-15 && (open.area() / tau - 1.0).abs() < 1e-15);
}

#[test]
fn a_cylinder_is_met_at_the_right_distance_from_far_away() {
    // Hard case 1, for cylinders: from 1e2 to 1e5 radii away, none is missed, and distances are right.
    let mut random = Random::new(72);
    for _ in 0..50_000 {
        let c = Cylinder::new(v(0.0, 0.0, -1.0), v(0.0, 0.0, 1.0), 1.0, true).unwrap();
        let geometry = Geometry::build(vec![c.into()]).unwrap();
        let far = random.log_uniform(2.0, 5.0);
        let (b, z) = (random.signed() * 0.999, random.signed() * 0.999);
        // Along x past the axis at distance b: the wall is at −√(1 − b²).
        let ray = Ray::free(v(-far, b, z), v(1.0, 0.0, 0.0));
        let hit = geometry.closest_hit(&ray).expect("the wall");
        let expected = far - ((1.0 - b) * (1.0 + b)).sqrt();
        assert!((hit.t - expected).abs() <= 8.0 * f64::EPSILON * far * far / (1.0 - b * b).sqrt(), "{far} {b}");
    }
}

#[test]
fn cylinders_without_extent_or_numbers_are_refused() {
    use ShapeError::{NoArea, NotFinite, OutOfRange};
    let (o, x) = (Vec3::ZERO, v(1.0, 0.0, 0.0));
    assert_eq!(Cylinder::new(o, o, 1.0, true), Err(NoArea));
    assert_eq!(Cylinder::new(o, x, 0.0, true), Err(NoArea));
    assert_eq!(Cylinder::new(o, x, -1.0, true), Err(NoArea));
    assert_eq!(Cylinder::new(o, v(f64::NAN, 0.0, 0.0), 1.0, true), Err(NotFinite));
    assert_eq!(Cylinder::new(o, x, f64::INFINITY, true), Err(NotFinite));
    assert_eq!(Cylinder::new(o, x * 1e40, 1.0, true), Err(OutOfRange));
    assert_eq!(Cylinder::new(o, x * 1e-40, 1.0, true), Err(OutOfRange));
}

#[test]
fn two_equal_tubes_that_a_ray_touches_are_met_at_one_distance() {
    // The roots of a touching ray may round past each other; which of them counts must not depend on what was met before.
    let tube = |_| Cylinder::new(v(0.0, 4.6875, 4.625), v(0.0, 0.9375, 4.9375), 4.625, false).unwrap().into();
    let ray = Ray::free(v(4.625, 2.875, 4.625), v(0.0, 4.625, 6.5));
    let hits = [1, 2, 20].map(|n| Geometry::build((0..n).map(tube).collect()).unwrap().closest_hit(&ray));
    assert!(hits[0].is_some() && hits.iter().all(|hit| *hit == hits[0]), "{hits:?}");
}
