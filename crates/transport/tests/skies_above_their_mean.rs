//! Images of everything around of which shadow rays find what is brighter than the mean: sampled as their density says, and found as a whole.

use crate::environments::{Sky, sky, subject, uneven, uneven_square};
use etalon_optics::Vec3;
use etalon_oracle::statistics::Welford;
use etalon_oracle::subjects::Emits;
use etalon_oracle::{Uniform, emits_suite};
use etalon_scene::{EnvironmentImage, LightSampling};
use etalon_transport::light::{EnvironmentLight, Light};
use etalon_transport::mis::Density;
use etalon_transport::spectral::Colour;
use std::f64::consts::PI;
use std::sync::Arc;

const RANGE_NM: [f64; 2] = [400.0, 700.0];

/// A sky that paths run into as well. Shadow rays find what is brighter than the mean.
fn above_mean(image: &EnvironmentImage) -> Sky {
    Sky { light: EnvironmentLight::new(image, RANGE_NM, LightSampling::Mis), irradiance: |_| None }
}

// Corners that are cut at the mean.
emits_suite!(uneven_sky_above_its_mean, above_mean(&uneven()), from: [[0.0; 3]], pdf_tolerance: 1e-4);

emits_suite!(uneven_equal_area_sky_above_its_mean, above_mean(&uneven_square()), from: [[0.0; 3]], pdf_tolerance: 2e-2);

/// On an upright plate, under a radiance that falls from 3 above to 1 below, in proportion to the angle from 45° to 135°: what is above 2 at one
/// height lacks below. Shadow rays for the part above the mean leave out the cells below 135°, ∫ 2 sin² of their angles.
#[test]
fn all_of_a_sky_is_found_where_shadow_rays_are_for_its_bright_part() {
    let (truth, left_out) = (2.0 * PI, 2.0 * (PI / 8.0 - 0.25));
    let light = Light::Environment(Arc::new(above_mean(&sky(2, 2, &[3.0, 3.0, 1.0, 1.0])).light));
    let mut random = Uniform::new(3);
    let [mut all, mut bright] = [Welford::default(), Welford::default()];
    for _ in 0..700_000 {
        let u = [random.number(), random.number()];
        for (sample, readings) in
            [(light.sample_all(Vec3::ZERO, u, 0.0), &mut all), (light.sample(Vec3::ZERO, u, 0.0), &mut bright)]
        {
            readings.push(sample.map_or(0.0, |sample| {
                let (Density::SolidAngle(pdf), Some(Colour::Rgb([radiance, ..]))) = (sample.density, sample.colour)
                else {
                    panic!("an image has a density and colours: {sample:?}")
                };
                radiance * sample.wi.x.max(0.0) / pdf
            }));
        }
    }
    for (readings, truth) in [(all, truth), (bright, truth - left_out)] {
        // Significance 6e-5 each; a bias of 2 % would be seen, less than half of what is left out.
        let (estimate, error) = (readings.estimate(), readings.standard_error());
        let z = (estimate.mean - truth) / error;
        assert!(z.abs() < 4.0 && 9.0 * error < 0.02 * truth, "{estimate:?} is not {truth}: z = {z}");
    }
}

#[test]
fn shadow_rays_leave_what_is_darker_than_the_mean_to_paths() {
    let (whole, bright) = (subject(&uneven_square(), |_| None), above_mean(&uneven_square()));
    let mean = uneven_square().image;
    let mean = (0..16).map(|i| mean.texel(i % 4, i / 4)[0]).sum::<f64>() / 16.0;
    let mut random = Uniform::new(6);
    for _ in 0..10_000 {
        let wi = random.direction();
        let radiance = whole.light.look(Vec3::from_array(wi)).colour[0];
        assert_eq!(radiance > mean, bright.pdf([0.0; 3], wi) > 0.0, "{wi:?}: {radiance}");
    }
}
