//! The walk into an instance decides as the instance itself does.

use crate::level;
use crate::test_support::*;
use crate::{Geometry, Instance, Placement, Primitive, Ray, Triangle};
use std::sync::Arc;

/// From many millions of sizes away a ray in the coordinates of what is placed errs by more than the instance's box, which is made of
/// boxes in `f32`, is too wide: it may hit what it passes by outside. The box decides that it does not, however the instance is asked.
#[test]
fn what_a_ray_from_afar_passes_by_outside_is_not_hit() {
    for level in level::all() {
        // Without them the test would say nothing.
        let passed_by = level::forced(level, passed_by);
        assert!(passed_by > 100, "{passed_by} of the rays passed by what they hit within");
    }
}

/// Holds such rays against the test of each instance; counts those that hit what is within, and not the instance.
fn passed_by() -> u32 {
    // A square sheet, turned in its plane: its corners are the ends of its box, and coordinates within mix two of those outside.
    let sheet = (0..32_u8).map(|i| {
        let corner = v(f64::from(i / 2 % 4) * 0.5 - 1.0, f64::from(i / 8) * 0.5 - 1.0, 0.0);
        let [x, y] = [v(0.5, 0.0, 0.0), v(0.0, 0.5, 0.0)];
        Triangle::new(corner, corner + x + y, corner + if i % 2 == 0 { x } else { y }).unwrap().into()
    });
    let sheet = Arc::new(Geometry::build_with(sheet.collect(), 0).unwrap());
    assert!(sheet.tree().is_some());
    let (s, c) = (0.6, 0.8);
    let places: Vec<Instance> = (0..12)
        .map(|i| {
            let by = [f64::from(i / 4) * 3.0, f64::from(i / 2 % 2) * 3.0, f64::from(i % 2) * 3.0];
            let placement = Placement::new([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]], by).unwrap();
            Instance::new(Arc::clone(&sheet), placement).unwrap()
        })
        .collect();
    let all = Geometry::build_with(places.iter().cloned().map(Primitive::from).collect(), 0).unwrap();
    assert!(all.tree().is_some());
    let mut random = Random::new(90);
    let mut passed_by = 0;
    for _ in 0..20_000 {
        let instance = &places[random.below(places.len())];
        let placement = instance.placement();
        // Past a corner, beside the box by about what is rounded on the way.
        let distance = random.log_uniform(10.0, 13.0);
        let rounding = distance * f64::EPSILON;
        let corner = placement.point(v(1.0, -1.0, 0.0));
        let aim = v(
            instance.bounds().max.x + rounding * random.log_uniform(-2.0, 0.0),
            corner.y + rounding * random.signed(),
            corner.z,
        );
        let across = 0.9 * random.signed();
        let direction = v(0.0, across, (1.0 - across * across).sqrt());
        let ray = Ray::free(aim - direction * distance, direction);
        let (hit, occluded) = (all.closest_hit(&ray), all.occluded(&ray));
        assert_eq!((hit, occluded), all.one_by_one(&ray), "{ray:?}");
        let [x, y, z] = placement.inverse().map(|row| row.dot(ray.direction));
        let rounded_in = sheet.occluded(&Ray::free(placement.local_point(ray.origin), v(x, y, z)));
        passed_by += u32::from(rounded_in && !occluded);
    }
    passed_by
}
