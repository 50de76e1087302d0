//! Which placements there may be, and what they hold.

use super::instances::{affine, build, place, scaling, similarity};
use crate::level;
use crate::test_support::*;
use crate::{Geometry, Instance, Placement, Primitive, Ray, ShapeError, Sphere};
use etalon_optics::Vec3;
use etalon_simd::Level;
use std::sync::Arc;
#[test]
fn placements_that_flatten_and_instances_of_nothing_are_refused() {
    use ShapeError::{Empty, NotFinite, OutOfRange, Singular};
    let zero = [0.0; 3];
    assert_eq!(Placement::new(scaling([1.0, 1.0, 0.0]), zero), Err(Singular));
    assert_eq!(Placement::new([[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [0.0, 0.0, 1.0]], zero), Err(Singular));
    assert_eq!(Placement::new(scaling([1.0, f64::NAN, 1.0]), zero), Err(NotFinite));
    assert_eq!(Placement::new(scaling([1.0; 3]), [f64::INFINITY, 0.0, 0.0]), Err(NotFinite));
    assert_eq!(Placement::new(scaling([1e-40; 3]), zero), Err(OutOfRange));
    assert_eq!(Placement::new([[1.0, 1.0, 0.0], [1.0, 1.0 + 1e-15, 0.0], [0.0, 0.0, 1.0]], zero), Err(Singular));
    // Products too small for double precision: what is left of the determinant is no zero, but means nothing. Found by the fuzzer.
    let row = [0.5, -4.5, -0.5625];
    assert_eq!(Placement::new([row, [5.60206894132e-312, 0.0, 0.0], row], zero), Err(Singular));
    // As small as an inverse in range allows.
    assert!(Placement::new(scaling([1.0 / (1_u128 << 119) as f64; 3]), zero).is_ok());
    let placement = Placement::new(scaling([1e30; 3]), zero).unwrap();
    assert_eq!(Instance::new(build(Vec::new()), placement), Err(Empty));
    let far = build(vec![Sphere::new(v(1e30, 0.0, 0.0), 1.0).unwrap().into()]);
    assert_eq!(Instance::new(far, placement), Err(OutOfRange));
    // Too many, by doubling: refused before the numbers overflow. Too deep as well.
    let mut nest = build(vec![Sphere::new(v(0.0, 0.0, 0.0), 1.0).unwrap().into()]);
    let two =
        |g: &Arc<Geometry>| vec![place(g, scaling([1.0; 3]), Vec3::ZERO), place(g, scaling([1.0; 3]), Vec3::ZERO)];
    for _ in 0..30 {
        nest = build(two(&nest));
    }
    assert!(matches!(Geometry::build(two(&nest)), Err(crate::GeometryError::TooManyInstances(_))));
    let mut nest = build(vec![Sphere::new(v(0.0, 0.0, 0.0), 1.0).unwrap().into()]);
    for _ in 0..crate::MAX_NESTING {
        nest = build(vec![place(&nest, scaling([1.0; 3]), Vec3::ZERO)]);
    }
    assert!(nest.occluded(&Ray::free(v(-3.0, 0.0, 0.0), v(1.0, 0.0, 0.0))));
    let deeper = Geometry::build(vec![place(&nest, scaling([1.0; 3]), Vec3::ZERO)]);
    assert!(matches!(deeper, Err(crate::GeometryError::TooDeep(_))));
}

#[test]
fn what_is_shared_is_held_once() {
    let mesh = build(Mesh::sphere(100, 100, |_| 1.0).primitives());
    let mut random = Random::new(64);
    let instances: Vec<Primitive> = (0..10_000)
        .map(|_| {
            let by = random.in_cube() * 100.0;
            place(&mesh, similarity(&mut random, 0.5, false), by)
        })
        .collect();
    let scene = Geometry::build(instances).unwrap();
    // 200 million triangles in a few megabytes; an instance with its share of the tree takes less than 1000 bytes.
    assert!(scene.memory_bytes() < mesh.memory_bytes() + 10_000 * 1000, "{}", scene.memory_bytes());
    assert!(scene.memory_bytes() > mesh.memory_bytes());
    let alone = Ray::<f32>::free(Vec3::ZERO, Vec3::new(0.3, 0.5, 0.7));
    assert_eq!(scene.closest_hit(&alone).is_some(), scene.occluded(&alone));
}

#[test]
fn the_box_of_an_instance_is_the_same_in_all_instruction_sets() {
    for seed in 0..4 {
        let bounds = |level: Level| {
            level::forced(level, || {
                let mut random = Random::new(64 + seed);
                let mesh = Mesh::sphere(30, 40, |p| 1.0 + 0.3 * (7.0 * p.x).sin() * (5.0 * p.y).cos()).primitives();
                let placed = [build(mesh), build(soup(&mut random, 1_000, -3.0..0.0))];
                let place =
                    |geometry| Geometry::build(vec![place(geometry, affine(&mut random, -1.0..1.0), Vec3::ZERO)]);
                placed.each_ref().map(place).map(|geometry| geometry.unwrap().bounds())
            })
        };
        let portable = bounds(Level::Baseline);
        assert!(level::all().into_iter().all(|level| bounds(level) == portable));
    }
}
