//! Rays in the accelerator's frame.

use crate::Aabb;
use crate::frame::{Frame, Lanes4, Plain};
use crate::query::{Four, Plain4};
use crate::test_support::*;

/// A ray in `f32` that needs no rounding enters a frame as the same ray in `f64`: the same numbers, or none.
#[test]
fn a_ray_in_f32_enters_a_frame_that_only_scales_as_it_does_in_f64() {
    let mut random = Random::new(90);
    let mut entered = 0;
    for i in 0..200_000 {
        let size = 2.0_f64.powi(random.below(240) as i32 - 120);
        let half = v(1.0, random.unit(), random.unit()) * size;
        let frame = Frame::around(Aabb { min: -half, max: half });
        let near =
            |random: &mut Random| (random.in_cube() * (5.0 * size), random.direction() * random.log_uniform(-3.0, 3.0));
        let (origin, direction) =
            if i % 4 == 0 { (random.any_vector() * size, random.any_vector()) } else { near(&mut random) };
        let t_max = if i % 3 == 0 { random.any_number() } else { f64::INFINITY };
        let [o, d] = [origin, direction].map(|c| [c.x as f32, c.y as f32, c.z as f32, 0.0]);
        let wide = |c: [f32; 4]| Plain4::widened((), c);
        let exact = frame.enter_exact([o, d].map(|c| Plain::new((), c)), |unit| t_max * unit);
        let general = frame.enter_near::<Plain4>((), [wide(o), wide(d)], |unit| t_max * unit);
        // Origins that are all but zero in a large frame are rounded by less than the frame's margin.
        let tiny = o.iter().any(|&c| c != 0.0 && f64::from(c.abs()) * frame.scale() < f64::from(f32::MIN_POSITIVE));
        let within = frame.scale().log2().abs() <= 100.0;
        assert!(within || exact.is_none());
        if !within || tiny {
            continue;
        }
        assert_eq!(exact.is_some(), general.is_some(), "{o:?} {d:?} {t_max}");
        let Some((a, b)) = exact.zip(general) else { continue };
        let rows = |ray: &crate::frame::FrameRay<Plain>| {
            let boxes = &ray.boxes;
            [
                boxes.origin_near,
                boxes.origin_far,
                boxes.reciprocal_near,
                boxes.reciprocal_far,
                ray.start_along,
                ray.slopes,
            ]
            .map(|row| row.to_array()[..3].to_vec())
        };
        assert_eq!(rows(&a), rows(&b), "{o:?} {d:?}");
        assert_eq!(a.boxes.negative, b.boxes.negative);
        assert_eq!((a.axis, a.per_depth, a.error), (b.axis, b.per_depth, b.error));
        assert_eq!((a.limit, a.certain_limit, a.start), (b.limit, b.certain_limit, b.start));
        assert_eq!((a.t_max, a.t_scale), (b.t_max, b.t_scale));
        // What stands for the end is on its two sides.
        let end = a.t_max * frame.scale();
        assert!(f64::from(a.limit) >= end * (1.0 + 2.0_f64.powi(-29)), "{end} {}", a.limit);
        assert!(f64::from(a.certain_limit) <= end * (1.0 - 2.0_f64.powi(-29)), "{end} {}", a.certain_limit);
        entered += 1;
    }
    assert!(entered > 50_000, "only {entered} rays entered");
}
