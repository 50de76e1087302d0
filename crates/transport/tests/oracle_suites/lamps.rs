//! Every area light, held to every law of a light.

use etalon_geometry::{Cylinder, Disk, Parallelogram, Sphere, Triangle};
use etalon_optics::Vec3;
use etalon_oracle::{
    emits_suite, laws,
    statistics::{Budget, Welford},
    subjects::Emits,
};

use super::lamp::{Form, Lamp};

pub(crate) fn sphere_lamp() -> Lamp {
    let (center, radius) = (Vec3::new(0.0, 0.0, 2.0), 0.5);
    Lamp::new(Sphere::new(center, radius).unwrap(), (center, radius), Form::Sphere)
}

pub(crate) fn disk_lamp() -> Lamp {
    let (center, radius) = (Vec3::new(0.3, 0.0, 1.0), 0.7);
    let disk = Disk::new(center, Vec3::new(0.6, 0.0, -0.8), radius).unwrap();
    Lamp::new(disk, (center, radius), Form::Other)
}

pub(crate) fn parallelogram_lamp() -> Lamp {
    let (corner, a, b) = (Vec3::new(-0.5, -0.4, 1.0), Vec3::new(1.0, 0.2, 0.1), Vec3::new(0.3, 0.9, 0.0));
    let center = corner + (a + b) * 0.5;
    let form = Form::Polygon(vec![corner, corner + a, corner + a + b, corner + b]);
    Lamp::new(Parallelogram::new(corner, a, b).unwrap(), (center, 0.5 * (a + b).length()), form)
}

pub(crate) fn triangle_lamp() -> Lamp {
    let (a, b, c) = (Vec3::new(-0.5, -0.4, 1.0), Vec3::new(0.6, -0.2, 1.1), Vec3::new(0.1, 0.7, 0.8));
    let center = (a + b + c) / 3.0;
    let radius = [a, b, c].map(|v| (v - center).length()).into_iter().fold(0.0, f64::max);
    Lamp::new(Triangle::new(a, b, c).unwrap(), (center, radius), Form::Polygon(vec![a, b, c]))
}

fn cylinder_lamp(capped: bool) -> Lamp {
    let (start, end, radius) = (Vec3::new(-0.3, -0.2, 1.4), Vec3::new(0.5, 0.2, 1.9), 0.3);
    let cylinder = Cylinder::new(start, end, radius, capped).unwrap();
    let reach = (0.25 * (end - start).length_squared() + radius * radius).sqrt();
    Lamp::new(cylinder, ((start + end) * 0.5, reach), Form::Other)
}

// The quadrature meets the rim of a flat light with the resolution of its grid: 2 % of the integral is what it can tell
// there. A sphere fills its cone.
emits_suite!(sphere_light, sphere_lamp(), from: [[0.0; 3], [1.0, 2.0, 0.0], [0.1, 0.0, 2.2]], pdf_tolerance: 1e-6);
emits_suite!(disk_light, disk_lamp(), from: [[0.0; 3], [1.0, 2.0, 0.0], [0.0, 0.0, 2.0]], pdf_tolerance: 0.02);
emits_suite!(parallelogram_light, parallelogram_lamp(), from: [[0.0; 3], [1.0, 2.0, 0.0]], pdf_tolerance: 0.02);
emits_suite!(triangle_light, triangle_lamp(), from: [[0.0; 3], [1.0, 2.0, 0.0]], pdf_tolerance: 0.02);

/// From outside, from within, and through an open end of the tube.
const BESIDE_CYLINDERS: [[f64; 3]; 4] = [[0.0; 3], [1.0, 2.0, 0.0], [0.1, 0.0, 1.65], [1.9, 1.2, 2.7]];

/// Besides by the laws, samples are held to the density by moments: the mean of g/p over samples is ∫g over the directions that meet the
/// lamp, here for the solid angle and the mean direction, found anew by uniform directions.
#[test]
fn cylinders_are_sampled_as_their_density_says() {
    for (capped, seed) in [(true, 1), (false, 2)] {
        let lamp = cylinder_lamp(capped);
        let mut random = etalon_oracle::Uniform::new(seed);
        for from in BESIDE_CYLINDERS {
            laws::light_sample_is_consistent(&lamp, from, seed).assert();
            laws::light_pdf_integrates_to_one(&lamp, from, 0.02, seed).assert();
            laws::light_samples_follow_pdf(&lamp, from, Budget::for_tests(8), seed).assert();
            let mut sampled = [Welford::default(); 4];
            let mut uniform = [Welford::default(); 4];
            for _ in 0..200_000 {
                let sample = lamp.sample(from, [random.number(), random.number()]);
                let g = |wi: [f64; 3]| [1.0, wi[0], wi[1], wi[2]];
                let of_sample = sample.map_or([0.0; 4], |s| g(s.wi).map(|g| g / s.pdf));
                let wi = random.direction();
                let met = if lamp.is_met(from, wi) { 4.0 * std::f64::consts::PI } else { 0.0 };
                for k in 0..4 {
                    sampled[k].push(of_sample[k]);
                    uniform[k].push(g(wi)[k] * met);
                }
            }
            for (a, b) in sampled.iter().zip(&uniform) {
                let error = a.standard_error().hypot(b.standard_error());
                let z = (a.estimate().mean - b.estimate().mean) / error;
                // 32 comparisons at 5 sigma: one wrong alarm in 50,000. A quarter of the solid angle would be seen.
                assert!(z.abs() < 5.0, "{from:?}: {a:?} {b:?}, z = {z}");
            }
            let of_solid_angle = uniform[0].standard_error() / uniform[0].estimate().mean;
            assert!(6.0 * of_solid_angle < 0.25, "{of_solid_angle}");
        }
    }
}
