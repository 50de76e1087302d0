//! Few primitives: what is filtered many at once, for one ray or for eight, is what each primitive answers alone.

use super::brute_force::check_geometry;
use crate::level;
use crate::test_support::*;
use crate::{Geometry, LANES, Primitive, PrimitiveId, Ray, Rays, SurfaceId, SurfacePoint, Triangle};
use etalon_optics::Vec3;

/// Scenes of few primitives: soups of all sizes, planes shared by many shapes, closed meshes, spheres within each other.
fn scenes() -> Vec<Vec<Primitive>> {
    let mut out = Vec::new();
    for (seed, count) in [1, 2, 3, 7, 8, 9, 15, 16, 17, 31, 33, 60, 100, 128].into_iter().enumerate() {
        let random = &mut Random::new(900 + seed as u64);
        out.push(soup(random, count, -2.0..0.0));
        out.push(soup(random, count, -6.0..0.0));
        out.push(blocks(random, count));
    }
    for offset in [v(0.0, 0.0, 0.0), v(3.0, -2.0, 5.0), v(1e6, 2e6, 3e6)] {
        let cube = Mesh::cube().map(|p| p * 2.0 + offset).primitives();
        let ball = Mesh::sphere(5, 8, |_| 0.7).map(|p| p + offset).primitives();
        out.push([cube.clone(), ball].concat());
        let spheres = (1..9).filter_map(|i| crate::Sphere::new(offset, 0.1 * f64::from(i)).ok().map(Primitive::from));
        out.push(spheres.chain(cube).collect());
    }
    out
}

/// A ray among primitives that are no further than 1 or 2 from a point, often from a surface: what it leaves and aims at, and
/// its end.
fn ray(random: &mut Random, geometry: &Geometry, features: &[V]) -> Ray<f64> {
    let mut free = || {
        let (origin, direction) = line(random, features);
        Ray::free(origin, direction)
    };
    let mut ray = free();
    if let Some(hit) = geometry.closest_hit(&ray)
        && random.below(3) > 0
    {
        let point = geometry.surface(&ray, &hit);
        ray = match random.below(3) {
            0 => point.spawn_to(features[random.below(features.len())], SurfaceId::NONE),
            _ => point.spawn(random.direction()),
        };
    }
    match random.below(8) {
        0 => ray.t_max = random.unit() * 2.0,
        1 => ray.leaves = PrimitiveId(random.below(geometry.len()) as u32).into(),
        2 => ray.aims_at = PrimitiveId(random.below(geometry.len()) as u32).into(),
        3 => ray.direction = ray.direction * 2.0_f64.powi(random.below(200) as i32 - 100),
        4 if random.below(20) == 0 => ray.origin = ray.origin * random.log_uniform(0.0, 5.0),
        5 if random.below(20) == 0 => ray.direction = random.any_vector(),
        _ => {}
    }
    ray
}

fn bits(p: &SurfacePoint<f64>) -> [u64; 7] {
    let (x, n) = (p.position, p.normal);
    [x.x, x.y, x.z, p.position_error, n.x, n.y, n.z].map(f64::to_bits)
}

/// Compares eight rays at once with each alone, on every instruction set; returns how many of them eight at once decided.
fn compare(geometry: &Geometry, rays: &Rays, active: u8) -> [usize; 2] {
    let flat = geometry.small_scene().expect("few primitives");
    let mut decided = [0, 0];
    for level in level::all() {
        let (hits, open) = flat.closest_hits(level, geometry.primitives(), rays, active);
        let (shadows, open_shadows) = flat.any_hits(level, rays, active);
        assert_eq!((hits.mask & (open | !active), shadows & (open_shadows | !active)), (0, 0));
        let points = flat.surfaces(level, geometry.primitives(), rays, &hits, hits.mask, geometry.label());
        for lane in (0..LANES).filter(|lane| active >> lane & 1 == 1) {
            let ray = rays.get(lane);
            if open >> lane & 1 == 0 {
                let alone = geometry.closest_hit(&ray);
                assert_eq!(hits.get(lane), alone, "{level:?} {ray:?}");
                decided[0] += 1;
                if let Some(hit) = alone {
                    let (one, ours) = (geometry.surface(&ray, &hit), points.get(lane));
                    assert_eq!(bits(&one), bits(&ours), "{level:?} {ray:?} {one:?} {ours:?}");
                    assert_eq!((one.surface, one.label), (ours.surface, ours.label));
                    // And what is shared among hits is what the shape computes for one.
                    let p = geometry.primitive(hit.surface.primitive).surface(ray.at(hit.t));
                    let own = SurfacePoint::rounded(&p, hit.surface, geometry.label(), 0.0);
                    assert_eq!(bits(&one), bits(&own));
                }
            }
            if open_shadows >> lane & 1 == 0 {
                assert_eq!(shadows >> lane & 1 == 1, geometry.occluded(&ray), "{level:?} {ray:?}");
                decided[1] += 1;
            }
        }
        let (all, any) = (geometry.closest_hits(rays, active), geometry.any_hits(rays, active));
        for lane in 0..LANES {
            let ray = rays.get(lane);
            let wanted = active >> lane & 1 == 1;
            assert_eq!(all.get(lane), geometry.closest_hit(&ray).filter(|_| wanted));
            assert_eq!(any >> lane & 1 == 1, wanted && geometry.occluded(&ray));
        }
    }
    decided
}

#[test]
fn few_primitives_filtered_at_once_answer_as_each_alone() {
    for (seed, primitives) in scenes().into_iter().enumerate() {
        let centre = primitives.iter().map(Primitive::bounds).reduce(crate::Aabb::union).unwrap().centre();
        let offset = if centre.length() > 2.5 { centre } else { Vec3::ZERO };
        let geometry = Geometry::build(primitives).unwrap();
        assert!(geometry.small_scene().is_some());
        check_geometry(&geometry, 2_500, 400 + seed as u64, |(o, d)| (o + offset, d));
    }
}

#[test]
fn eight_rays_at_once_are_answered_as_each_alone() {
    let (mut asked, mut decided) = (0, [0, 0]);
    for (seed, primitives) in scenes().into_iter().enumerate() {
        let mut random = Random::new(500 + seed as u64);
        let features = features(&primitives);
        let geometry = Geometry::build(primitives).unwrap().with_label(seed as u32);
        for _ in 0..400 {
            let mut rays = Rays::NONE;
            for lane in 0..LANES {
                rays.set(lane, &ray(&mut random, &geometry, &features));
            }
            let active = random.below(256) as u8;
            asked += active.count_ones() as usize * level::all().len();
            let [closest, any] = compare(&geometry, &rays, active);
            decided = [decided[0] + closest, decided[1] + any];
        }
    }
    // Rays here are made to be hard, and cylinders and disks have no filter. Were the fall-back to serve all, this would be zero.
    assert!(decided.iter().all(|&d| d * 4 > asked), "only {decided:?} of {asked} rays were decided eight at once");
}

#[test]
fn filters_that_know_nothing_of_rounding_are_found_out() {
    // Rays from the origin at the vertices and edges of a mesh, which f32 cannot represent: with errors bounded by nothing the
    // filters lose hits, and the test above sees it.
    let mesh = Mesh::sphere(5, 9, |p| 1.0 + 0.3 * p.x);
    let primitives = mesh.primitives();
    assert!(primitives.len() <= 128);
    let (honest, blind) = (Geometry::build(primitives.clone()).unwrap(), {
        let mut geometry = Geometry::build(primitives).unwrap();
        geometry.forget_rounding();
        geometry
    });
    let mut wrong = [0, 0];
    let mut random = Random::new(77);
    for _ in 0..2_000 {
        let edge = mesh.edges()[random.below(mesh.edges().len())];
        let [a, b] = edge.map(|i| mesh.vertices[i]);
        let ray = Ray::free(Vec3::ZERO, a + (b - a) * random.unit());
        let query = crate::query::Query::new(&ray).unwrap();
        for (geometry, wrong) in [&honest, &blind].into_iter().zip(&mut wrong) {
            *wrong += usize::from(geometry.closest(&query) != geometry.closest_flat(&query));
        }
    }
    assert_eq!(wrong[0], 0);
    assert!(wrong[1] > 20, "{wrong:?}");
}

#[test]
fn eight_rays_among_many_primitives_or_instances_are_answered_as_each_alone() {
    let mut random = Random::new(8);
    let geometry = Geometry::build(soup(&mut random, 300, -2.0..0.0)).unwrap();
    assert!(geometry.small_scene().is_none());
    for _ in 0..300 {
        let mut rays = Rays::NONE;
        for lane in 0..LANES {
            let (origin, direction) = line(&mut random, &[]);
            rays.set(lane, &Ray::free(origin, direction));
        }
        let active = random.below(256) as u8;
        let (hits, any) = (geometry.closest_hits(&rays, active), geometry.any_hits(&rays, active));
        let points = geometry.surfaces(&rays, &hits, hits.mask);
        for lane in (0..LANES).filter(|lane| active >> lane & 1 == 1) {
            let ray = rays.get(lane);
            assert_eq!(hits.get(lane), geometry.closest_hit(&ray));
            assert_eq!(any >> lane & 1 == 1, geometry.occluded(&ray));
            if let Some(hit) = hits.get(lane) {
                assert_eq!(bits(&points.get(lane)), bits(&geometry.surface(&ray, &hit)));
            }
        }
    }
}

#[test]
fn ties_of_coplanar_shapes_go_to_the_lowest_id_for_eight_rays_too() {
    let t = Triangle::new(v(-1.0, -1.0, 1.0), v(2.0, -1.0, 1.0), v(-1.0, 2.0, 1.0)).unwrap();
    let geometry = Geometry::build(vec![t.into(); 20]).unwrap();
    let mut rays = Rays::NONE;
    for lane in 0..LANES {
        rays.set(lane, &Ray::free(v(0.1 * lane as f64 - 0.3, 0.0, 0.0), v(0.0, 0.0, 1.0)));
    }
    let hits = geometry.closest_hits(&rays, 0xFF);
    for lane in 0..LANES {
        assert_eq!(hits.get(lane).unwrap().surface, PrimitiveId(0).into());
    }
}
