//! The walk into an instance decides as the instance itself does.

use crate::test_support::*;
use crate::{Geometry, Instance, Placement, Primitive, Ray};
use std::sync::Arc;

/// From a thousand sizes away and more, a ray in the coordinates of what is placed errs by more than the instance's box allows for: it
/// may hit what it passes by outside. The box decides that it does not, however the instance is asked.
#[test]
fn what_a_ray_from_afar_passes_by_outside_is_not_hit() {
    // A cube turned out of the axes, placed turned back: its faces lie in those of the box, but their coordinates mix all three.
    let cube = Arc::new(Geometry::build_with(Mesh::cube().primitives(), 0).unwrap());
    assert!(cube.tree().is_some());
    let rows = [v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0), v(0.0, 0.0, 1.0)].map(|axis| turned(axis).to_array());
    let places: Vec<(V, Instance)> = (0..12)
        .map(|i| {
            let by = v(f64::from(i / 4) * 3.0, f64::from(i / 2 % 2) * 3.0, f64::from(i % 2) * 3.0);
            (by, Instance::new(Arc::clone(&cube), Placement::new(rows, by.to_array()).unwrap()).unwrap())
        })
        .collect();
    let all = places.iter().map(|(_, instance)| Primitive::from(instance.clone())).collect();
    let all = Geometry::build_with(all, 0).unwrap();
    assert!(all.tree().is_some());
    let mut random = Random::new(90);
    let (mut passed_by, mut hits) = (0, 0);
    for _ in 0..20_000 {
        // Along a face of an outer instance's box, beside it by about what is rounded on the way.
        let (by, instance) = &places[random.below(places.len())];
        let distance = random.log_uniform(2.0, 7.0);
        let off = distance * f64::EPSILON * random.log_uniform(-2.0, 1.0);
        let (across, along) = (random.signed(), random.signed());
        let direction = v(0.0, across, (1.0 - across * across).sqrt());
        let aim = v(instance.bounds().max.x + off, by.y + 0.5 * along, by.z + 0.5 * random.signed());
        let ray = Ray::free(aim - direction * distance, direction);
        let (hit, occluded) = (all.closest_hit(&ray), all.occluded(&ray));
        assert_eq!((hit, occluded), all.one_by_one(&ray), "{ray:?}");
        hits += u32::from(occluded);
        let rounded_in = places.iter().any(|(_, instance)| {
            let placement = instance.placement();
            let [x, y, z] = placement.inverse();
            let d = ray.direction;
            cube.occluded(&Ray::free(placement.local_point(ray.origin), v(x.dot(d), y.dot(d), z.dot(d))))
        });
        passed_by += u32::from(rounded_in && !occluded);
    }
    // Without them the test would say nothing.
    assert!(passed_by > 1_000 && hits > 100, "{passed_by} passed by, {hits} hit");
}
