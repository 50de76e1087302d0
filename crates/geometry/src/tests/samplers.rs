//! Directions toward shapes: held against uniform directions, of which rays tell whether they meet the shape.

use crate::test_support::*;
use crate::{Cylinder, Disk, Geometry, Parallelogram, Primitive, Ray, ShapeSampler, Sphere, Triangle};
use etalon_optics::Vec3;
use std::f64::consts::PI;

fn shapes() -> [(&'static str, Primitive); 6] {
    let v = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
    let tube = |capped| Cylinder::new(v(-0.3, -0.2, 1.4), v(0.5, 0.2, 1.9), 0.4, capped).unwrap().into();
    [
        ("sphere", Sphere::new(v(0.0, 0.0, 1.5), 0.6).unwrap().into()),
        ("disk", Disk::new(v(0.3, 0.0, 1.0), v(0.6, 0.0, -0.8), 0.7).unwrap().into()),
        ("parallelogram", Parallelogram::new(v(-0.5, -0.4, 1.0), v(1.0, 0.2, 0.1), v(0.3, 0.9, 0.0)).unwrap().into()),
        ("triangle", Triangle::new(v(-0.7, -0.4, 0.8), v(0.8, -0.2, 1.1), v(0.1, 0.9, 0.9)).unwrap().into()),
        ("cylinder", tube(true)),
        ("tube", tube(false)),
    ]
}

/// Whether the integrals of 1, x, y and z over the directions that meet a shape are the same by samples over their densities as by uniform
/// directions, within five standard errors of both: a right sampler fails one of the four with probability 2e-6.
fn is_sound(shape: &Primitive, density: &dyn Fn(f64) -> f64, from: V, random: &mut Random) -> bool {
    const COUNT: u32 = 100_000;
    let geometry = Geometry::build(vec![shape.clone()]).unwrap();
    let sampler = shape.sampler().unwrap();
    let mut sums = [[[0.0; 2]; 4]; 2];
    for _ in 0..COUNT {
        let sample = sampler.sample(from, [random.unit(), random.unit()]);
        let uniform = random.direction();
        let met = geometry.closest_hit(&Ray::free(from, uniform)).is_some();
        let draws = [
            (sample.wi, if sample.valid { 1.0 / density(sample.density) } else { 0.0 }),
            (uniform, if met { 4.0 * PI } else { 0.0 }),
        ];
        for (sums, (wi, weight)) in sums.iter_mut().zip(draws) {
            for (sum, g) in sums.iter_mut().zip([1.0, wi.x, wi.y, wi.z]) {
                // What is invalid has no direction.
                let value = if weight > 0.0 { g * weight } else { 0.0 };
                *sum = [sum[0] + value, sum[1] + value * value];
            }
        }
    }
    let n = f64::from(COUNT);
    let mean = |[sum, squares]: [f64; 2]| (sum / n, ((squares / n - (sum / n).powi(2)).max(0.0) / n).sqrt());
    let [ours, uniform] = sums;
    ours.into_iter().zip(uniform).all(|(ours, uniform)| {
        let ((a, ea), (b, eb)) = (mean(ours), mean(uniform));
        // A constant sum has no scatter, but its rounding.
        (a - b).abs() <= 5.0 * ea.hypot(eb) + 1e-9
    })
}

/// Before shapes, beside and behind them; and for those that enclose something, from within.
#[test]
fn directions_have_their_densities_and_wrong_densities_are_noticed() {
    let mut random = Random::new(31);
    for (name, shape) in shapes() {
        for from in [[0.0; 3], [1.0, 2.0, 0.0], [0.4, -0.3, 4.0], [0.05, 0.02, 1.6]] {
            let from = Vec3::from_array(from);
            assert!(is_sound(&shape, &|density| density, from, &mut random), "{name} from {from:?}");
        }
        // Uniform directions know the solid angle from here to 3 % at worst, one standard error.
        assert!(!is_sound(&shape, &|density| 1.3 * density, Vec3::ZERO, &mut random), "{name}: the mutant");
    }
}

/// What a sample says of itself: its density is that of its direction, its point lies along it on the shape, and a ray sees the side that it
/// states.
#[test]
fn samples_are_what_they_state() {
    let mut random = Random::new(32);
    for (name, shape) in shapes() {
        let geometry = Geometry::build(vec![shape.clone()]).unwrap();
        let sampler = shape.sampler().unwrap();
        let mut valid = 0;
        for _ in 0..20_000 {
            let from = Vec3::new(0.0, 0.0, 1.5) + random.direction() * random.log_uniform(-2.0, 1.0);
            let sample = sampler.sample(from, [random.unit(), random.unit()]);
            if !sample.valid {
                continue;
            }
            valid += 1;
            let of_direction = sampler.density(from, sample.wi);
            assert_eq!((sample.density, sample.front), (of_direction.density, of_direction.front), "{name} {from:?}");
            assert!((sample.wi.length() - 1.0).abs() < 1e-14);
            let toward = sample.point - from;
            assert!((toward.normalized() - sample.wi).length() < 1e-9, "{name} {from:?} {sample:?}");
            // A direction to the rim may miss by its rounding.
            let ray = Ray::free(from, sample.wi);
            let Some(hit) = geometry.closest_hit(&ray) else { continue };
            let point = geometry.surface(&ray, &hit);
            let seen = (point.position - sample.point).length() < 1e-6;
            assert!(!seen || (point.normal.dot(sample.wi) < 0.0) == sample.front, "{name} {from:?} {sample:?}");
        }
        assert!(valid > 9000, "{name}: {valid}");
    }
}

/// The cylinder finds its own points. They are those that rays find in a geometry that holds nothing else, to the bit.
#[test]
fn a_cylinder_sees_of_itself_what_rays_see_of_it_alone() {
    let mut random = Random::new(33);
    let mut twice = 0;
    for i in 0..20_000 {
        let radius = random.log_uniform(-2.0, 2.0);
        let start = random.in_cube();
        let end = start + random.direction() * random.log_uniform(-2.0, 1.0);
        let cylinder = Cylinder::new(start, end, radius, i % 2 == 0).unwrap();
        let geometry = Geometry::build(vec![cylinder.clone().into()]).unwrap();
        let from = cylinder.centre() + random.direction() * random.log_uniform(-2.0, 2.0);
        let wi = (cylinder.centre() + random.in_cube() * radius - from).normalized();
        let mut ray = Ray::free(from, wi);
        let mut density = 0.0;
        for crossing in 0..2 {
            let Some(hit) = geometry.closest_hit(&ray) else { break };
            let point = geometry.surface(&ray, &hit);
            density += (point.position - from).length_squared() / (wi.dot(point.normal).abs() * cylinder.area());
            ray = point.spawn(wi);
            twice += crossing;
        }
        assert_eq!(ShapeSampler::Cylinder(cylinder).density(from, wi).density, density, "{from:?} {wi:?}");
    }
    assert!(twice > 5000, "{twice}");
}
