//! A walk that passes surfaces meets each hit of its ray exactly once.

use super::brute_force::at_each_level;
use super::instances::placed_soup;
use crate::test_support::*;
use crate::traverse::all_of;
use crate::{Geometry, Hit, Passed, Primitive, PrimitiveId, Ray, Sphere};

/// All hits by a walk, nearest first.
fn walked(geometry: &Geometry, ray: &Ray<f64>) -> Vec<Hit<f64>> {
    let (mut passed, mut hits) = (Passed::NOTHING, Vec::new());
    while let Some(hit) = geometry.next_hit(ray, &passed) {
        passed.pass(&hit, hit.t);
        hits.push(hit);
    }
    hits
}

/// All hits by testing each primitive, nearest first.
fn one_by_one(geometry: &Geometry, ray: &Ray<f64>) -> Vec<Hit<f64>> {
    let mut hits = Vec::new();
    let Some(query) = crate::query::Query::new(ray) else { return hits };
    for id in 0..geometry.len() as u32 {
        all_of(geometry.primitives(), &query, PrimitiveId(id), (0.0, query.t_max), &mut |hit, surface| {
            hits.push(Hit { t: hit.t * query.scale, surface, uv: hit.uv });
            query.t_max
        });
    }
    hits.sort_by(|a, b| (a.t, a.surface).partial_cmp(&(b.t, b.surface)).unwrap());
    hits
}

fn rays(random: &mut Random, geometry: &Geometry, count: usize) -> Vec<Ray<f64>> {
    let features = features(geometry.primitives());
    (0..count)
        .map(|_| {
            let (origin, direction) = line(random, &features);
            let t_max = if random.below(4) == 0 { random.unit() * 2.0 } else { f64::INFINITY };
            let leaves = match random.below(3) {
                0 => PrimitiveId(random.below(geometry.len()) as u32),
                _ => PrimitiveId::NONE,
            };
            Ray { t_max, leaves: leaves.into(), time: random.unit(), ..Ray::free(origin, direction) }
        })
        .collect()
}

/// Each primitive once, twice or three times, in any order.
fn repeated(random: &mut Random, primitives: &[Primitive]) -> Vec<Primitive> {
    let mut all: Vec<_> = primitives.iter().flat_map(|p| vec![p.clone(); 1 + random.below(3)]).collect();
    for i in (1..all.len()).rev() {
        all.swap(i, random.below(i + 1));
    }
    all
}

#[test]
fn a_walk_meets_every_hit_once_and_in_order() {
    for (seed, flat_limit) in [(0, 0), (1, 0), (2, crate::small_scene::FLAT_LIMIT)] {
        let mut random = Random::new(900 + seed);
        let soups = [
            soup(&mut random, 40, -2.0..0.5),
            soup(&mut random, 300, -3.0..0.0),
            placed_soup(&mut random, 10),
            representable(&soup(&mut random, 60, -1.0..0.0)),
        ];
        for primitives in soups {
            let primitives = repeated(&mut random, &primitives);
            let most = at_each_level(|_| {
                let geometry = Geometry::build_with(primitives.clone(), flat_limit).unwrap();
                let mut most = 0;
                for ray in rays(&mut Random::new(950 + seed), &geometry, 1500) {
                    let (walked, all) = (walked(&geometry, &ray), one_by_one(&geometry, &ray));
                    assert_eq!(walked, all, "{ray:?}");
                    assert_eq!(geometry.closest_hit(&ray).map(|hit| hit.t), all.first().map(|hit| hit.t), "{ray:?}");
                    most = most.max(all.len());
                    // From any distance on.
                    if let Some(hit) = all.get(all.len() / 2) {
                        let mut rest = 0;
                        geometry.all_hits(&ray, hit.t, |_| {
                            rest += 1;
                            ray.t_max
                        });
                        assert_eq!(rest, all.iter().filter(|other| other.t >= hit.t).count(), "{ray:?}");
                    }
                }
                most as f64
            });
            assert!(most > 6.0, "at most {most} hits along a ray");
        }
    }
}

/// The definition of passing a flat shape: what comes next is what is hit where that shape does not exist.
#[test]
fn behind_a_flat_shape_that_is_passed_lies_what_is_hit_without_it() {
    let mut random = Random::new(77);
    let mut compared = 0;
    for _ in 0..40 {
        let flat = soup(&mut random, 30, -0.5..0.5).into_iter().filter(|p| !p.is_curved()).collect::<Vec<_>>();
        let primitives = repeated(&mut random, &flat);
        let geometry = Geometry::build(primitives.clone()).unwrap();
        for ray in rays(&mut random, &geometry, 40) {
            let ray = Ray { leaves: crate::SurfaceId::NONE, ..ray };
            let mut left: Vec<usize> = (0..primitives.len()).collect();
            for hit in walked(&geometry, &ray) {
                let rest = Geometry::build(left.iter().map(|&i| primitives[i].clone()).collect()).unwrap();
                let found = rest.closest_hit(&ray).expect("the walk found one");
                assert_eq!(found.t, hit.t);
                left.retain(|&i| i != hit.surface.primitive.0 as usize);
                compared += 1;
            }
            let rest = Geometry::build(left.iter().map(|&i| primitives[i].clone()).collect()).unwrap();
            assert_eq!(rest.closest_hit(&ray), None);
        }
    }
    assert!(compared > 1000, "{compared}");
}

#[test]
fn a_sphere_is_passed_at_both_its_crossings() {
    let ball: Primitive = Sphere::new(v(0.0, 0.0, 5.0), 1.0).unwrap().into();
    let geometry = Geometry::build(vec![ball.clone(), ball]).unwrap();
    let ray = Ray::free(v(0.0, 0.0, 0.0), v(0.0, 0.0, 1.0));
    let met: Vec<_> = walked(&geometry, &ray).iter().map(|hit| (hit.t, hit.surface.primitive.0)).collect();
    assert_eq!(met, [(4.0, 0), (4.0, 1), (6.0, 0), (6.0, 1)]);
}

#[test]
fn what_a_walk_names_stays_passed_while_what_lies_before_it_is_not() {
    let sheet = |z: f64| Primitive::from(crate::Disk::new(v(0.0, 0.0, z), v(0.0, 0.0, 1.0), 1.0).unwrap());
    let geometry = Geometry::build(vec![sheet(1.0), sheet(2.0), sheet(3.0)]).unwrap();
    let ray = Ray::free(v(0.0, 0.0, 0.0), v(0.0, 0.0, 1.0));
    let hits = walked(&geometry, &ray);
    let mut passed = Passed::NOTHING;
    passed.pass(&hits[1], hits[0].t);
    assert_eq!(geometry.next_hit(&ray, &passed), Some(hits[0]));
    passed.pass(&hits[0], hits[0].t);
    assert_eq!(geometry.next_hit(&ray, &passed), Some(hits[2]));
}
