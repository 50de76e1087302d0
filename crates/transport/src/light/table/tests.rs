use super::*;
use crate::light::{AreaLight, DirectionalLight, Emitter, EnvironmentLight, PointLight, SpotLight};
use etalon_geometry::{Cylinder, Disk, Parallelogram, Primitive, PrimitiveId, Sphere, Triangle};
use etalon_optics::{Spectrum, Vec3};
use etalon_scene::{EnvironmentImage, EnvironmentProjection, Image, LightSampling, Texels};
use std::f64::consts::PI;
use std::sync::Arc;

fn white_sky() -> EnvironmentImage {
    EnvironmentImage {
        image: Arc::new(Image::new(2, 3, Texels::F32(vec![[1.0; 3]; 6]))),
        name: String::new(),
        projection: EnvironmentProjection::LatitudeLongitude,
        forward: [1.0, 0.0, 0.0],
        right: [0.0, -1.0, 0.0],
        up: [0.0, 0.0, 1.0],
        white: Spectrum::ONE,
    }
}

fn area(shape: impl Into<Primitive>, emitter: Emitter) -> Light {
    Light::Area(AreaLight::new(&shape.into(), emitter).unwrap())
}

/// Radiant power of a surface is π times radiance, area and sides, of a point 4π times intensity, of parallel light the
/// irradiance on the scene's disk, of a sky 4π times that. Only the noise depends on it.
#[test]
fn lights_are_chosen_by_their_power() {
    let (x, y) = (Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 3.0, 0.0));
    let shines = |front, back| Emitter {
        radiance: PathSpectrum::Constant(1.0).into(),
        front,
        back,
        surface: PrimitiveId(0).into(),
        image: None,
    };
    let one = || PathSpectrum::Constant(1.0);
    let point = || PointLight { position: Vec3::ZERO, intensity: one(), per_m: 2.0 };
    let lights = vec![
        area(Sphere::new(Vec3::ZERO, 2.0).unwrap(), shines(true, false)),
        area(Parallelogram::new(Vec3::ZERO, x, y).unwrap(), shines(true, true)),
        area(Disk::new(Vec3::ZERO, Vec3::new(0.0, 0.0, 1.0), 3.0).unwrap(), shines(false, true)),
        area(Triangle::new(Vec3::ZERO, x, y).unwrap(), shines(true, true)),
        area(Cylinder::new(Vec3::ZERO, x, 1.5, false).unwrap(), shines(true, false)),
        Light::Point(point()),
        Light::Spot(SpotLight { point: point(), axis: Vec3::new(0.0, 0.0, 1.0), cosines: [0.8, 0.5] }),
        Light::Directional(DirectionalLight { toward: Vec3::new(0.0, 0.0, 1.0), irradiance: one() }),
        Light::Environment(Arc::new(EnvironmentLight::new(&white_sky(), [360.0, 830.0], LightSampling::Mis))),
    ];
    // A spot's smooth edge lets half of the light between its cosines pass: 2π(1 − .65) of the sphere. Half a metre is 1 here.
    let of_points = [4.0 * 4.0, 2.0 * 4.0 * (1.0 - 0.65)];
    let powers = [16.0 * PI, 2.0 * 6.0, 9.0 * PI, 2.0 * 3.0, 2.0 * PI * 1.5 * 2.0]
        .into_iter()
        .chain(of_points)
        .chain([25.0, 25.0 * 4.0 * PI])
        .map(|power: f64| power * PI)
        .collect::<Vec<_>>();
    let total: f64 = powers.iter().sum();
    let table = LightTable::new(lights, 5.0, [360.0, 830.0], LightSelection::Auto);
    let from = Vec3::ZERO;
    for (i, power) in powers.iter().enumerate() {
        let share = 0.9 * power / total + 0.1 / 9.0;
        assert!(
            (table.probability(i, from) - share).abs() < 1e-14,
            "{i}: {} is not {share}",
            table.probability(i, from)
        );
    }
}

/// Suns and a sky have no place in a tree.
#[test]
fn lights_within_a_tree_and_beyond_it_are_chosen_as_often_as_is_said() {
    let shines = |radiance: f64| Emitter {
        radiance: PathSpectrum::Constant(radiance).into(),
        front: true,
        back: false,
        surface: PrimitiveId(0).into(),
        image: None,
    };
    let ball = |x: f64, radius: f64| Sphere::new(Vec3::new(x, 0.5, -0.25), radius).unwrap();
    let sun = |irradiance: f64| {
        let (toward, irradiance) = (Vec3::new(0.0, 0.0, 1.0), PathSpectrum::Constant(irradiance));
        Light::Directional(DirectionalLight { toward, irradiance })
    };
    let lights = vec![
        sun(0.5),
        area(ball(-3.0, 0.5), shines(10.0)),
        area(ball(0.0, 0.25), shines(20.0)),
        Light::Environment(Arc::new(EnvironmentLight::new(&white_sky(), [360.0, 830.0], LightSampling::Mis))),
        area(ball(4.0, 1.0), shines(5.0)),
        sun(3.0),
    ];
    let count = lights.len();
    let mut table = LightTable::new(lights, 5.0, [360.0, 830.0], LightSelection::Tree);
    assert!(table.chooses_by_place() && !table.has_learned());
    are_chosen_as_often_as_is_said(&table, count);
    // The suns and the sky, then the tree.
    table.learn(Some(&[0.5, 0.0, 0.1, 0.4]));
    let (shares, from) = (table.shares(), Vec3::new(0.0, 2.0, 0.0));
    let of_tree: f64 = [1, 2, 4].map(|lamp| table.probability(lamp, from)).iter().sum();
    assert!((shares[3] - of_tree).abs() < 1e-14 && (table.probability(0, from) - shares[0]).abs() < 1e-14);
    let foretold = table.shares_if(&[0.5, 0.0, 0.1, 0.4]);
    assert!(shares.iter().zip(foretold).all(|(share, foretold)| (share - foretold).abs() < 1e-14));
    assert!(shares[0] > 0.4 && shares[1] > 0.0 && (shares.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    are_chosen_as_often_as_is_said(&table, count);
    table.learn(None);
    assert!(!table.has_learned());
}

/// A tenth stays by power, so what was missed is still found.
#[test]
fn few_lights_are_chosen_as_was_learned() {
    let sun = |irradiance: f64| {
        let (toward, irradiance) = (Vec3::new(0.0, 0.0, 1.0), PathSpectrum::Constant(irradiance));
        Light::Directional(DirectionalLight { toward, irradiance })
    };
    let mut table = LightTable::new(vec![sun(1.0), sun(3.0)], 5.0, [360.0, 830.0], LightSelection::Auto);
    table.learn(Some(&[1.0, 0.0]));
    // By power 0.9 · 1/4 + 0.1/2 and 0.9 · 3/4 + 0.1/2.
    let expected = [0.9 + 0.1 * 0.275, 0.1 * 0.725];
    let probability = |index| table.probability(index, Vec3::ZERO);
    assert!((0..2).all(|index| (probability(index) - expected[index]).abs() < 1e-14));
    are_chosen_as_often_as_is_said(&table, 2);
}

fn are_chosen_as_often_as_is_said(table: &LightTable, count: usize) {
    for from in [Vec3::new(0.0, 2.0, 0.0), Vec3::new(-2.0, 0.5, 0.0), Vec3::new(30.0, -4.0, 2.0)] {
        const STEPS: u32 = 100_000;
        let mut chosen = vec![0_u32; count];
        for i in 0..STEPS {
            let (index, probability) = table.choose(from, (f64::from(i) + 0.5) / f64::from(STEPS)).unwrap();
            chosen[index] += 1;
            assert!((probability / table.probability(index, from) - 1.0).abs() < 1e-12, "{index}");
        }
        for (index, chosen) in chosen.into_iter().enumerate() {
            let (found, told) = (f64::from(chosen) / f64::from(STEPS), table.probability(index, from));
            // What chooses a light are two intervals, of which each end is off by a step at most.
            assert!(told > 0.0 && (found - told).abs() < 4.0 / f64::from(STEPS), "{index}: {found} is not {told}");
        }
    }
}

#[test]
fn a_spectrum_counts_by_what_an_observer_makes_of_it() {
    // x̄, ȳ and z̄ have the same integral, 106.857 nm; the floor adds 0.47.
    let mean = visible_sum(&PathSpectrum::Constant(1.0), [360.0, 830.0]) * 470.0 / 256.0;
    assert!((mean - (3.0 * 106.857 + 0.47)).abs() < 0.1, "{mean}");
}
