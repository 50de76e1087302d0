//! Spheres seen from afar and left at a grazing angle (hard cases 1 and 3).

use crate::SurfacePoint;
use crate::test_support::*;
use crate::{Geometry, PrimitiveId, Ray, Sphere};
use etalon_optics::Real;

#[test]
fn a_sphere_is_not_missed_from_a_hundred_thousand_radii() {
    let mut random = Random::new(1);
    for _ in 0..200_000 {
        let distance = random.log_uniform(2.0, 5.0);
        let d = random.direction();
        let frame = etalon_optics::Frame::from_normal(d);
        // A line at distance b from the centre; the closest approach is the centre plus a perpendicular.
        let b = random.unit() * 0.999;
        let phi = random.unit();
        let (s, c) = f64::sin_cos_turns(phi);
        let centre = random.in_cube();
        let origin = centre + frame.s * (b * c) + frame.t * (b * s) - d * distance;
        let sphere = Sphere::new(centre, 1.0).unwrap();
        let geometry = Geometry::build(vec![sphere.into()]).unwrap();
        let ray = Ray::free(origin, d);
        let hit = geometry.closest_hit(&ray).expect("a false miss");
        let truth = distance - (1.0 - b * b).sqrt();
        // Hard case 1: 8ε·D²/r/√(1−b²), in f64; the construction itself errs as much.
        let bound = 16.0 * f64::EPSILON * distance * distance / (1.0 - b * b).sqrt();
        assert!((hit.t - truth).abs() <= bound, "{} {truth} {bound}", hit.t);
        // From f32 rays only what f32 says of the ray is lost: 1e5 radii × 2⁻²⁴ sideways.
        if b < 0.98 && geometry.closest_hit(&Ray::<f32>::free(origin.cast(), d.cast())).is_none() {
            panic!("a false miss of an f32 ray at b = {b}");
        }
    }
}

/// The point of a sphere, the only primitive of a geometry, near `p`.
fn on<R: Real>(sphere: &Sphere, p: V) -> SurfacePoint<R> {
    SurfacePoint::rounded(&sphere.surface(p), PrimitiveId(0).into(), 0, 0.0)
}

#[test]
fn a_tangential_ray_from_the_surface_does_not_hit_it_again() {
    let mut random = Random::new(2);
    for i in 0..1_000_000 {
        let radius = if i % 2 == 0 { 1.0 } else { random.log_uniform(-6.0, 6.0) };
        let geometry = Geometry::build(vec![Sphere::new(random.in_cube() * radius, radius).unwrap().into()]).unwrap();
        let crate::Primitive::Sphere(sphere) = geometry.primitive(PrimitiveId(0)) else { unreachable!() };
        let n = random.direction();
        let p = on::<f64>(sphere, sphere.centre() + n * radius);
        let f = etalon_optics::Frame::from_normal(p.normal);
        let mut d = f.s * random.signed() + f.t * random.signed();
        if d.dot(p.normal) < 0.0 {
            d = d - p.normal * (2.0 * d.dot(p.normal));
        }
        if d.dot(p.normal) >= 0.0 {
            assert!(geometry.closest_hit(&p.spawn(d)).is_none(), "re-hit");
        }
        let p = on::<f32>(sphere, sphere.centre() + n * radius);
        let d = d.cast::<f32>();
        if d.dot(p.normal) >= 0.0 {
            assert!(geometry.closest_hit(&p.spawn(d)).is_none(), "re-hit in f32");
        }
    }
}

#[test]
fn a_ray_knows_the_sphere_it_leaves_even_from_the_wrong_side_of_its_surface() {
    // Rounding may put an origin on either side: the root at the surface is dropped by name, not by its sign.
    let mut random = Random::new(5);
    for _ in 0..200_000 {
        let radius = random.log_uniform(-6.0, 6.0);
        let sphere = Sphere::new(random.in_cube() * radius, radius).unwrap();
        let n = random.direction();
        let f = etalon_optics::Frame::from_normal(n);
        let slant = random.log_uniform(-4.0, 0.0);
        let inward = (f.s * random.signed() + f.t * random.signed() - n * slant).normalized();
        let cos = -inward.dot(n);
        let off = random.signed() * 1e-14;
        let origin = sphere.centre() + n * (radius * (1.0 + off));
        let geometry = Geometry::build(vec![sphere.into()]).unwrap();
        let leaving = |d| Ray { leaves: PrimitiveId(0).into(), ..Ray::free(origin, d) };
        assert!(geometry.closest_hit(&leaving(-inward)).is_none() && !geometry.occluded(&leaving(-inward)));
        let hit = geometry.closest_hit(&leaving(inward)).expect("the far side");
        // The chord, to what the displaced origin changes of it.
        assert!((hit.t / (2.0 * radius * cos) - 1.0).abs() < 1e-13 / (cos * cos), "{} {cos}", hit.t);
    }
}

#[test]
fn a_ray_that_enters_a_sphere_leaves_it_at_the_far_side() {
    // The chord from a point of the surface is 2r·cos; the root at the surface itself must not be taken for it,
    // whatever the size and the place of the sphere.
    let mut random = Random::new(3);
    for _ in 0..200_000 {
        let radius = random.log_uniform(-6.0, 6.0);
        let centre = random.in_cube() * random.log_uniform(-6.0, 6.0);
        let sphere = Sphere::new(centre, radius).unwrap();
        let n = random.direction();
        let f = etalon_optics::Frame::from_normal(n);
        let p = on::<f64>(&sphere, centre + n * radius);
        let slant = random.log_uniform(-3.0, 0.0);
        let d = (f.s * random.signed() - n * slant).normalized();
        let geometry = Geometry::build(vec![sphere.into()]).unwrap();
        let ray = p.spawn(d);
        let hit = geometry.closest_hit(&ray).expect("the far side");
        let cos = -d.dot(p.normal);
        // The start is rounded by a few u of its coordinates: so much the chord changes for a tangential error, and
        // over the cosine for one along the normal.
        let reach = p.position.abs().max_component() + radius;
        let tolerance = 32.0 * f64::UNIT_ROUNDOFF * reach / cos;
        assert!((hit.t - 2.0 * radius * cos).abs() <= tolerance, "{} {}", hit.t, 2.0 * radius * cos);
        let q = geometry.surface(&ray, &hit);
        assert!(((q.position - centre).length() - radius).abs() <= q.position_error + 4.0 * f64::EPSILON * radius);
    }
}

#[test]
fn a_sphere_below_the_resolution_of_its_place_still_has_a_normal() {
    let sphere = Sphere::new(v(0.5, 0.5, 0.5), 1e-23).unwrap();
    let geometry = Geometry::build(vec![sphere.into()]).unwrap();
    let ray = Ray::free(v(0.5, 0.5, 0.5), v(0.5, 0.0, -0.0625));
    let p = geometry.surface(&ray, &geometry.closest_hit(&ray).expect("from within"));
    assert!((p.normal.length() - 1.0).abs() < 1e-15 && p.position.is_finite() && p.position_error < 1e-15, "{p:?}");
}

#[test]
fn a_hit_whose_parameter_single_precision_cannot_hold_is_none_there() {
    let geometry = Geometry::build(vec![Sphere::new(v(0.0, 0.0, 0.0), 1.0).unwrap().into()]).unwrap();
    let (origin, direction) = (v(0.0, 0.0, -1e20), v(0.0, 0.0, 1e-30));
    assert!(geometry.closest_hit(&Ray::free(origin, direction)).is_some());
    assert!(geometry.closest_hit(&Ray::<f32>::free(origin.cast(), direction.cast())).is_none());
}
