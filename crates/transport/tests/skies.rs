//! Skies by formula: sampled as their density says, bright where they should be.

use etalon_geometry::SurfaceId;
use etalon_optics::{Spectrum, Vec3};
use etalon_oracle::emits_suite;
use etalon_oracle::subjects::{Emits, Emitted};
use etalon_scene::{CieSky, DaylightSky, LightSampling};
use etalon_transport::light::{Light, SkyLight, SkyLook, Target};
use etalon_transport::mis::Density;
use etalon_transport::spectral::Colour;
use std::f64::consts::PI;
use std::sync::Arc;

const RANGE_NM: [f64; 2] = [400.0, 700.0];

/// A sky, as the oracle sees a light at infinity.
struct Sky {
    light: Arc<SkyLight>,
    irradiance: fn([f64; 3]) -> Option<f64>,
}

/// Toward the sun and toward the zenith.
fn directions() -> [Vec3<f64>; 2] {
    [Vec3::new(0.6, 0.3, 0.5).normalized(), Vec3::new(0.2, -0.3, 1.0).normalized()]
}

/// A standard sky that shadow rays alone find.
fn standard(number: u8, ground: f64, irradiance: fn([f64; 3]) -> Option<f64>) -> Sky {
    Sky { irradiance, ..standard_for(LightSampling::Light, number, ground) }
}

fn standard_for(sampling: LightSampling, number: u8, ground: f64) -> Sky {
    let [sun, up] = directions().map(|direction| direction.to_array());
    let sky = CieSky { number, up, sun, zenith: Spectrum::ONE, ground };
    Sky { light: Arc::new(SkyLight::new(&sky, RANGE_NM, sampling)), irradiance: |_| None }
}

fn daylight(turbidity: f64, ground: f64) -> Sky {
    let [sun, up] = directions().map(|direction| direction.to_array());
    let mean = Spectrum::daylight([0.0; 2]).unwrap();
    let sky = DaylightSky { turbidity, up, sun, ground, mean };
    Sky { light: Arc::new(SkyLight::daylight(&sky, RANGE_NM, LightSampling::Light)), irradiance: |_| None }
}

impl Emits for Sky {
    fn sample(&self, from_m: [f64; 3], u: [f64; 2]) -> Option<Emitted> {
        let s = Light::Sky(Arc::clone(&self.light)).sample(Vec3::from_array(from_m), u, 0.0)?;
        let Density::SolidAngle(pdf) = s.density else { panic!("a sky has no delta") };
        let SkyLook { relative, colour, .. } = self.light.look(s.wi);
        assert_eq!((s.target, s.surface), (Target::Infinity, SurfaceId::NONE));
        assert_eq!((s.scale, s.colour), (relative, colour));
        Some(Emitted { wi: s.wi.to_array(), distance_m: f64::INFINITY, radiance: s.scale, pdf })
    }

    fn pdf(&self, _: [f64; 3], wi: [f64; 3]) -> f64 {
        self.light.look(Vec3::from_array(wi)).brightness.density
    }

    fn radiance(&self, _: [f64; 3], wi: [f64; 3]) -> f64 {
        self.light.look(Vec3::from_array(wi)).relative
    }

    fn irradiance(&self, _: [f64; 3], normal: [f64; 3]) -> Option<f64> {
        (self.irradiance)(normal)
    }
}

// Skies with a bright ground, so that every direction that the table knows is drawn; the table has creases along its rows and columns.
emits_suite!(clear_sky, standard(12, 0.5, |_| None), from: [[0.0; 3]], pdf_tolerance: 1e-3);
emits_suite!(clear_sky_above_its_mean, standard_for(LightSampling::Mis, 12, 0.5), from: [[0.0; 3]], pdf_tolerance: 1e-3);
emits_suite!(daylight_sky, daylight(3.0, 0.5), from: [[0.0; 3]], pdf_tolerance: 1e-3);
emits_suite!(even_sky, standard(5, 1.0, |_| Some(PI)), from: [[0.0; 3]], pdf_tolerance: 1e-5);

#[test]
fn standard_skies_are_one_at_the_zenith_and_shine_everywhere_above_the_horizon() {
    for number in 1..=16 {
        let Sky { light, .. } = standard(number, 0.0, |_| None);
        let [_, up] = directions();
        assert!((light.look(up).relative - 1.0).abs() < 1e-14, "{number}");
        for i in 0..2000 {
            let [u, v] = [f64::from(i) / 2000.0, (f64::from(i) * 0.618_033_988_749).fract()];
            let wi = etalon_transport::warp::uniform_sphere([u, v]);
            let look = light.look(wi);
            if wi.dot(up) >= 0.0 {
                assert!(look.relative > 0.0 && look.brightness.density > 0.0, "{number}: {wi:?} {look:?}");
            } else {
                assert_eq!(look.relative, 0.0, "{number}: {wi:?}");
            }
        }
    }
}

/// The sky is bluer at a right angle to the sun than toward it and at the horizon, and of the zenith's colour below that.
#[test]
fn daylight_is_blue_away_from_the_sun_and_shows_its_ground() {
    let Sky { light, .. } = daylight(2.5, 0.25);
    let [sun, up] = directions();
    let first = |wi: Vec3<f64>| match light.look(wi).colour {
        Some(Colour::Daylight([first, _])) => first,
        other => panic!("{other:?}"),
    };
    let at_right_angles = (up - sun * up.dot(sun)).normalized();
    let level = (sun - up * (up.dot(sun) - 0.02)).normalized();
    assert!(first(at_right_angles) > first(sun) && first(at_right_angles) > first(level));
    let [zenith, ground] = [up, -up].map(|wi| light.look(wi));
    assert_eq!(ground.colour, zenith.colour);
    assert!((ground.relative / zenith.relative - 0.25).abs() < 1e-14);
}
