//! The two builders of trees: the same hits of both, and of the crate `obvhs` with its own traversal.

use super::brute_force::at_each_level;
use crate::test_support::*;
use crate::{Geometry, Instance, Motion, Pose, Primitive, PrimitiveId, Ray, Sphere, SurfaceId, TreeBuilder, Triangle};
use etalon_optics::Vec3;
use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use proptest::prelude::*;
use std::sync::Arc;

const BUILDERS: [TreeBuilder; 2] = [TreeBuilder::Thorough, TreeBuilder::Fast];

/// Trees of both builders, even of few primitives.
fn trees(primitives: &[Primitive]) -> [Geometry; 2] {
    BUILDERS.map(|builder| Geometry::build_as(primitives.to_vec(), 0, builder).expect("few enough primitives"))
}

/// Hits of both builders, held to each other bit for bit; how many there are.
fn agree(trees: &[Geometry; 2], ray: &Ray<f64>) -> usize {
    let [a, b] = trees.each_ref().map(|tree| tree.closest_hit(ray));
    assert_eq!(format!("{a:?}"), format!("{b:?}"), "{ray:?}");
    let shadow = Ray { t_max: a.map_or(1.0, |hit| hit.t * 1.5), ..*ray };
    assert_eq!(trees[0].occluded(&shadow), trees[1].occluded(&shadow), "{shadow:?}");
    usize::from(a.is_some())
}

#[test]
fn hits_do_not_depend_on_the_builder() {
    at_each_level(|_| {
        let mut random = Random::new(61);
        let mut hits = 0;
        for (count, decades) in [(9, -2.0..0.0), (200, -3.0..0.0), (3000, -3.0..-1.0)] {
            // Stacks and blocks have surfaces that coincide, on planes that boxes share.
            for primitives in
                [soup(&mut random, count, decades), blocks(&mut random, count), stacks(&mut random, count)]
            {
                let (trees, points) = (trees(&primitives), features(&primitives));
                for _ in 0..300 {
                    let (origin, direction) = line(&mut random, &points);
                    hits += agree(&trees, &Ray::free(origin, direction));
                }
            }
        }
        assert!(hits > 1000, "{hits}");
        hits as f64
    });
}

/// A triangle that goes 1 m along x, at `place` when the shutter opens.
fn mover(place: V) -> Primitive {
    let still = Triangle::new(v(-0.1, -0.1, 0.0), v(0.2, -0.1, 0.0), v(-0.1, 0.2, 0.0)).expect("a triangle");
    moving(&Arc::new(Geometry::build(vec![still.into()]).expect("one primitive")), place)
}

fn moving(geometry: &Arc<Geometry>, place: V) -> Primitive {
    let unit = [v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0), v(0.0, 0.0, 1.0)];
    let pose = |time: f64| Pose { time, translation: place + v(time, 0.0, 0.0), rotation: unit, stretch: unit };
    let motion = Motion::new(&[pose(0.0), pose(1.0)]).expect("a motion");
    Primitive::Instance(Box::new(Instance::moving(geometry.clone(), Arc::new(motion)).expect("an instance")))
}

/// Both builders on threads with a stack of 512 KiB, which a tree that is a chain overflows.
fn on_small_stacks(test: impl FnOnce() + Send) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).stack_size(512 << 10).build().expect("a pool");
    pool.install(test);
}

#[test]
fn a_hundred_thousand_identical_moving_primitives_build_and_answer() {
    on_small_stacks(|| {
        let one = mover(v(0.0, 0.0, 0.0));
        let alone = Geometry::build(vec![one.clone()]).expect("one primitive");
        let many = Geometry::build_by(vec![one; 100_000], TreeBuilder::Fast).expect("few enough primitives");
        for time in [0.0, 0.25, 0.9] {
            for x in [-0.05, 0.3, 0.95] {
                let ray = Ray { time, ..Ray::free(v(x, 0.0, -1.0), v(0.0, 0.0, 1.0)) };
                let hits = [&alone, &many].map(|geometry| geometry.closest_hit(&ray));
                let told = hits.map(|hit| hit.map(|hit| (hit.t, hit.uv, hit.surface.primitive)));
                // Of those that coincide the first is hit.
                assert_eq!(told[0], told[1]);
                assert_eq!(alone.occluded(&ray), many.occluded(&ray));
            }
        }
    });
}

#[test]
fn primitives_an_ulp_apart_build_and_answer() {
    on_small_stacks(|| {
        let (mut x, mut line) = (1.0_f64, Vec::new());
        for _ in 0..100_000 {
            line.push(Sphere::new(v(x, 0.0, 0.0), 1e-3).expect("a sphere").into());
            x = x.next_up();
        }
        let ours = BUILDERS.map(|builder| Geometry::build_by(line.clone(), builder).expect("few enough primitives"));
        let mut hits = 0;
        for i in 0..20 {
            let target = v(1.0 + 1e-4 * f64::from(i - 10), 2e-4, 0.0);
            hits += agree(&ours, &Ray::free(v(0.9, 0.3, -1.0), target - v(0.9, 0.3, -1.0)));
        }
        assert!(hits > 10, "{hits}");
    });
}

/// Sizes and distances over all decades that shapes may have, beside each other.
#[test]
fn extremes_of_size_and_place_build_and_answer() {
    let mut random = Random::new(63);
    let mut primitives: Vec<Primitive> = Vec::new();
    let mut refused = 0;
    while primitives.len() < 3000 {
        let scale = random.log_uniform(-300.0, 300.0);
        let at = random.in_cube() * random.log_uniform(-300.0, 300.0);
        match Triangle::new(at, at + random.in_cube() * scale, at + random.in_cube() * scale) {
            Ok(triangle) => primitives.push(triangle.into()),
            Err(_) => refused += 1,
        }
    }
    let (trees, points) = (trees(&primitives), features(&primitives));
    assert!(refused > 100);
    let hits: usize = (0..2000)
        .map(|_| {
            let (origin, target) = (points[random.below(points.len())], points[random.below(points.len())]);
            agree(&trees, &Ray::free(origin, target - origin))
        })
        .sum();
    assert!(hits > 100, "{hits}");
}

/// Triangles as corner and edges.
fn triangles() -> impl Strategy<Value = Vec<Primitive>> {
    let point = |size: f64| prop::array::uniform3(-size..size).prop_map(Vec3::from_array);
    let triangle = (point(1.0), point(0.4), point(0.4)).prop_filter_map("no area", |(corner, a, b)| {
        Triangle::new(corner, corner + a, corner + b).ok().map(Primitive::from)
    });
    prop::collection::vec(triangle, 9..300)
}

/// Closest hit, and whether there is any before `t_max`, by obvhs: its tree, its traversal in `f32`, and of what it finds the test of
/// one primitive in `f64`. Boxes are widened by 1e-5, a hundred roundings of coordinates below 2: a box that holds a hit is never missed.
fn referee(primitives: &[Primitive], ray: &Ray<f64>, t_max: f64) -> (Option<(f64, u32)>, bool) {
    let corner = |p: V| Vec3A::from_array(p.to_array().map(|c| c as f32));
    let boxes: Vec<Aabb> =
        primitives.iter().map(|p| Aabb::new(corner(p.bounds().min) - 1e-5, corner(p.bounds().max) + 1e-5)).collect();
    let ids = (0..boxes.len() as u32).collect();
    let tree = PlocBuilder::new().build(PlocSearchDistance::Low, &boxes, ids, SortPrecision::U64, 0);
    let alone: Vec<Geometry> =
        primitives.iter().map(|p| Geometry::build(vec![p.clone()]).expect("one primitive")).collect();
    let own = |t_max: f64| obvhs::ray::Ray::new(corner(ray.origin), corner(ray.direction), 0.0, t_max as f32);
    let mut best: Option<(f64, u32)> = None;
    tree.ray_traverse(own(f64::INFINITY), &mut obvhs::ray::RayHit::none(), |_, place| {
        let id = tree.primitive_indices[place];
        let Some(hit) = alone[id as usize].closest_hit(ray) else { return f32::INFINITY };
        if best.is_none_or(|best| (hit.t, id) < best) {
            best = Some((hit.t, id));
        }
        // Beyond rounding, so that no hit as close is left out.
        (hit.t * 1.0001 + 1e-4) as f32
    });
    let before = Ray { t_max, ..*ray };
    let missed = tree.ray_traverse_miss(own(t_max), |_, place| {
        if alone[tree.primitive_indices[place] as usize].occluded(&before) { 0.0 } else { f32::INFINITY }
    });
    (best, !missed)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn obvhs_finds_the_same_hits(primitives in triangles(), seed in 0_u64..1 << 40) {
        let (trees, mut random) = (trees(&primitives), Random::new(seed));
        for _ in 0..40 {
            let (origin, target) = (random.in_cube() * 2.0, random.in_cube());
            let ray = Ray::free(origin, target - origin);
            let t_max = 2.0 * random.unit();
            let (closest, any) = referee(&primitives, &ray, t_max);
            for tree in &trees {
                let hit = tree.closest_hit(&ray).map(|hit| (hit.t, hit.surface));
                // A primitive is tested alone as it is among others: the same bits.
                prop_assert_eq!(hit, closest.map(|(t, id)| (t, SurfaceId::from(PrimitiveId(id)))));
                prop_assert_eq!(tree.occluded(&Ray { t_max, ..ray }), any);
            }
        }
    }
}
