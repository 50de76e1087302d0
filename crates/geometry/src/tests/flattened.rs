//! What is placed so thin that rays within it are little but rounding.

use crate::test_support::*;
use crate::{Cylinder, Geometry, Instance, Parallelogram, Placement, Ray, Sphere};
use etalon_optics::Vec3;
use std::sync::Arc;

/// Placed 10⁻³² m thick, things have coordinates in which a ray is little but rounding. Wherever it puts
/// what is hit, the ray has entered the bounds there, and the same is hit whether the ray ends just behind that or far beyond, so that
/// what else is there decides nothing. The first is a find of the fuzzer.
#[test]
fn what_is_flattened_beyond_all_digits_is_hit_within_its_bounds_whatever_else_ends_the_ray() {
    let things = Arc::new(
        Geometry::build(vec![
            Parallelogram::new(v(2.5, 2.5, 2.5), v(2.5, 2.5, 2.5), v(0.0, 0.0, 2.5)).unwrap().into(),
            Sphere::new(v(2.5, 3.25, 2.5), 0.625).unwrap().into(),
            Cylinder::new(v(2.5, 2.5, 0.0), v(2.5, 3.25, 2.5), 0.625, false).unwrap().into(),
            Sphere::new(v(0.0, 2.4375, 4.1875), 1.5).unwrap().into(),
            Cylinder::new(v(0.0, 2.4375, 4.1875), v(2.5, 2.5, 2.5), 1.5, false).unwrap().into(),
            Sphere::new(v(2.5, 2.5, 2.5), 1.5).unwrap().into(),
        ])
        .unwrap(),
    );
    let found = [[0.0, 0.875, 0.5], [2.166339110281533e-32, 0.0, 2.0], [4.0935447415458995e-34, 0.5, 0.5]];
    let mut random = Random::new(32);
    let (mut hits, mut early) = (0, 0);
    for i in 0..40_000 {
        let thin = random.log_uniform(-34.0, -14.0);
        let column = [0, 1, 2].map(|_| thin * (random.below(17) as f64 - 8.0));
        let mut rows = found;
        if i > 0 {
            for (row, thin) in rows.iter_mut().zip(column) {
                *row = [thin, (random.below(33) as f64 - 16.0) / 8.0, (random.below(33) as f64 - 16.0) / 8.0];
            }
        }
        let (by, origin, direction) = if i == 0 {
            (v(0.5, -4.5, 0.5), v(0.5, 0.5, 0.5), v(1.5, -4.5625, 2.0625))
        } else {
            let mut coarse = || [0, 1, 2].map(|_| (random.below(65) as f64 - 32.0) / 8.0);
            (Vec3::from_array(coarse()), Vec3::from_array(coarse()), Vec3::from_array(coarse()))
        };
        let Ok(placement) = Placement::new(rows, by.to_array()) else { continue };
        let Ok(instance) = Instance::new(things.clone(), placement) else { continue };
        let bounds = instance.bounds();
        let geometry = Geometry::build(vec![instance.into()]).unwrap();
        let ray = Ray::free(origin, direction);
        let Some(hit) = geometry.closest_hit(&ray) else { continue };
        hits += 1;
        let entry = (0..3).fold(0.0_f64, |near, k| {
            let (a, b) = ((bounds.min[k] - origin[k]) / direction[k], (bounds.max[k] - origin[k]) / direction[k]);
            if direction[k] == 0.0 { near } else { near.max(a.min(b)) }
        });
        early += u32::from(hit.t == entry);
        assert!(hit.t >= entry * (1.0 - 4.0 * f64::EPSILON), "{rows:?} {ray:?}: {} before {entry}", hit.t);
        let ends = Ray { t_max: hit.t * (1.0 + 1e-9), ..ray };
        assert_eq!(geometry.closest_hit(&ends), Some(hit), "{rows:?} {ray:?}");
    }
    // Some were put there.
    assert!(hits > 500 && early > 0, "{hits} hits, {early} at the bounds");
}
