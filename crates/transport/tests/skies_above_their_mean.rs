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
/// height lacks below. Of the corners of cells the upper ones are 1 above the mean, the lower ones 0. Between them the part falls in proportion to the
/// cosine.
#[test]
fn the_bright_share_and_the_rest_of_a_sky_are_all_of_it() {
    let whole = 2.0 * PI;
    // ∫ sin² from 0 to π/4, and half of that from there to 3π/4, where the part is ½ in the mean; times ∫ cos φ = 2.
    let bright = 2.0 * ((PI / 8.0 - 0.25) + 0.5 * (PI / 4.0 + 0.5));
    let light = Light::Environment(Arc::new(above_mean(&sky(2, 2, &[3.0, 3.0, 1.0, 1.0])).light));
    let mut random = Uniform::new(3);
    let [mut above, mut rest] = [Welford::default(), Welford::default()];
    for _ in 0..700_000 {
        let u = [random.number(), random.number()];
        above.push(light.sample(Vec3::ZERO, u, 0.0).map_or(0.0, |sample| {
            let (Density::SolidAngle(pdf), Some(Colour::Rgb([radiance, ..]))) = (sample.density, sample.colour) else {
                panic!("an image has a density and colours: {sample:?}")
            };
            light.bright_share(sample.wi) * radiance * sample.wi.x.max(0.0) / pdf
        }));
        let wi = Vec3::from_array(random.direction());
        let Light::Environment(sky) = &light else { unreachable!("it is one") };
        rest.push((1.0 - light.bright_share(wi)) * sky.look(wi).colour[0] * wi.x.max(0.0) * 4.0 * PI);
    }
    for (readings, truth) in [(above, bright), (rest, whole - bright)] {
        // Significance 6e-5 each; a bias of 2 % would be seen.
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
