//! Rays in the accelerator's frame.

use crate::Aabb;
use crate::frame::{Entry, Frame};
use crate::test_support::*;
use crate::vec4::{Four, Lanes4, Plain, Plain4};

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

/// From anywhere a ray enters a frame on its own line, before all that it meets there; what does not enter misses.
#[test]
fn a_ray_from_afar_enters_a_frame_on_its_own_line() {
    let mut random = Random::new(91);
    let (mut entered, mut missed) = (0, 0);
    for i in 0..200_000 {
        let size = random.log_uniform(-30.0, 30.0);
        let centre = random.in_cube() * (size * random.log_uniform(-2.0, 4.0));
        let half = v(1.0, random.unit(), random.unit()) * size;
        let frame = Frame::around(Aabb { min: centre - half, max: centre + half });
        let spread = if i % 2 == 0 { 1.0 } else { 8.0 };
        let target = centre + v(half.x * random.signed(), half.y * random.signed(), half.z * random.signed()) * spread;
        let mut away = random.direction();
        if i % 5 == 0 {
            // In a plane of the frame.
            away = v(0.0, away.y, away.z);
        }
        let origin = centre + away * (size * random.log_uniform(-1.0, 5.0));
        let direction = (target - origin) * random.log_uniform(-20.0, 20.0);
        let lanes = [origin, direction].map(|p| Plain4::new((), [p.x, p.y, p.z, 0.0]));
        // In the frame: to a few roundoffs of the origin's distance.
        let o = frame.place(origin);
        let towards = frame.place(target) - o;
        let reach = o.abs().max_component();
        let ray = match frame.enter_anywhere((), lanes, f64::INFINITY) {
            Entry::Ray(ray) => ray,
            Entry::Misses => {
                // As slabs tell, of a box that is larger by far more than they err by.
                let (mut near, mut far) = (0.0_f64, f64::INFINITY);
                for k in 0..3 {
                    let (a, b) = ((-1.01 - o[k]) / towards[k], (1.01 - o[k]) / towards[k]);
                    (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
                }
                assert!(near > far, "{origin:?} {direction:?} meets the frame");
                missed += 1;
                continue;
            }
            Entry::Unknown => {
                let largest = direction.abs().max_component().log2().abs();
                assert!(reach > 1e6 || largest > 199.0, "{origin:?} {direction:?}");
                continue;
            }
        };
        let along = towards / towards.abs().max_component();
        // The parameter is of a direction whose largest component is in [1, 2).
        let [begin, scale] = [ray.start, (direction * ray.t_scale).abs().max_component()];
        assert!((1.0..2.0).contains(&scale) && begin >= 0.0);
        if spread == 1.0 {
            let target_at = towards.abs().max_component() / scale;
            assert!(begin <= target_at * (1.0 + 1e-9) + 1e-9, "{origin:?} {direction:?}");
        }
        let start = o + along * (begin * scale);
        assert!(start.abs().max_component() < 4.001);
        let [near, far] = [ray.boxes.origin_near, ray.boxes.origin_far].map(Lanes4::to_array);
        for k in 0..3 {
            let side = if ray.boxes.negative >> k & 1 == 1 { -1.0 } else { 1.0 };
            // What the start computed here errs by, and what was moved: by so much the one that boxes are held against is displaced.
            let rounding = 8.0 * f64::EPSILON * (reach + 1.0) * if begin > 0.0 { 1.0 } else { -1.0 };
            assert!((f64::from(near[k]) - start[k]) * side >= rounding, "{k} {origin:?} {direction:?}");
            assert!((start[k] - f64::from(far[k])) * side >= rounding, "{k} {origin:?} {direction:?}");
            assert!((f64::from(near[k]) - start[k]).abs() < 4e-6);
        }
        entered += 1;
    }
    assert!(entered > 50_000 && missed > 20_000, "{entered} {missed}");
}
