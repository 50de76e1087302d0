//! Which light a shadow ray aims at: in proportion to its power, with a share spread evenly.

use super::Light;
use crate::spectral::PathSpectrum;
use etalon_optics::colour::colour_matching;

/// Share of the choices that is spread evenly over the lights, so that a dim light beside the point is still found.
const EVEN_SHARE: f64 = 0.1;

/// All lights that shadow rays aim at, with the probability of each.
#[derive(Clone, Debug, Default)]
pub struct LightTable {
    lights: Vec<Light>,
    /// Cumulative probability after each light; the last is 1.
    cdf: Vec<f64>,
}

impl LightTable {
    /// A table over lights of a scene with this bounding radius; lights that emit nothing within the
    /// wavelengths `range_nm` are left out.
    pub fn new(lights: Vec<Light>, scene_radius: f64, range_nm: [f64; 2]) -> Self {
        // The triangles of a mesh share their spectrum, and come one after the other.
        let mut last: Option<(*const PathSpectrum, f64)> = None;
        let powers = lights.iter().map(|light| {
            let spectrum = light.spectrum();
            let visible = match last {
                Some((of, visible)) if std::ptr::eq(of, spectrum) => visible,
                _ => visible_sum(spectrum, range_nm),
            };
            last = Some((spectrum, visible));
            light.power_factor(scene_radius) * visible
        });
        let (lights, powers): (Vec<_>, Vec<_>) =
            lights.iter().cloned().zip(powers).filter(|&(_, power)| power > 0.0).unzip();
        let total: f64 = powers.iter().sum();
        let even = EVEN_SHARE / powers.len() as f64;
        let mut sum = 0.0;
        let mut cdf: Vec<f64> = powers
            .iter()
            .map(|power| {
                sum += (1.0 - EVEN_SHARE) * power / total + even;
                sum
            })
            .collect();
        if let Some(last) = cdf.last_mut() {
            *last = 1.0;
        }
        Self { lights, cdf }
    }

    /// Whether there is no light to aim at.
    pub fn is_empty(&self) -> bool {
        self.lights.is_empty()
    }

    /// Whether the walk itself may run into a light that is aimed at.
    pub fn can_be_met(&self) -> bool {
        self.lights.iter().any(Light::can_be_met)
    }

    /// The lights, in the order of their indices.
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// The index of the light that `u` in [0, 1) chooses.
    pub fn choose(&self, u: f64) -> usize {
        self.cdf.partition_point(|&c| c <= u)
    }

    /// The probability of a light.
    pub fn probability(&self, index: usize) -> f64 {
        self.cdf[index] - if index == 0 { 0.0 } else { self.cdf[index - 1] }
    }
}

/// ∫ S·(x̄ + ȳ + z̄ + floor) by 256 equal steps of the range: only the choice of lights depends on it. The floor keeps
/// lights whose wavelengths are hardly visible.
fn visible_sum(spectrum: &PathSpectrum, [first, last]: [f64; 2]) -> f64 {
    let steps = 256;
    let at = |i: i32| first + (last - first) * (f64::from(i) + 0.5) / f64::from(steps);
    (0..steps).map(at).map(|nm| spectrum.eval(nm) * (colour_matching(nm).iter().sum::<f64>() + 1e-3)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::{
        CylinderLight, DirectionalLight, DiskLight, Emitter, EnvironmentLight, ParallelogramLight, PointLight,
        SphereLight, SpotLight, TriangleLight,
    };
    use etalon_geometry::{Cylinder, Disk, Parallelogram, PrimitiveId, Sphere, Triangle};
    use etalon_optics::{Spectrum, Vec3};
    use etalon_scene::{EnvironmentImage, Image, Texels};
    use std::f64::consts::PI;
    use std::sync::Arc;

    fn white_sky() -> EnvironmentImage {
        EnvironmentImage {
            image: Arc::new(Image { width: 2, height: 3, texels: Texels::F32(vec![[1.0; 3]; 6]) }),
            name: String::new(),
            forward: [1.0, 0.0, 0.0],
            right: [0.0, -1.0, 0.0],
            up: [0.0, 0.0, 1.0],
            white: Spectrum::ONE,
        }
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
        };
        let one = || PathSpectrum::Constant(1.0);
        let point = || PointLight { position: Vec3::ZERO, intensity: one(), per_m: 2.0 };
        let lights = vec![
            Light::Sphere(SphereLight::new(Sphere::new(Vec3::ZERO, 2.0).unwrap(), shines(true, false))),
            Light::Parallelogram(ParallelogramLight::new(
                Parallelogram::new(Vec3::ZERO, x, y).unwrap(),
                shines(true, true),
            )),
            Light::Disk(DiskLight::new(
                Disk::new(Vec3::ZERO, Vec3::new(0.0, 0.0, 1.0), 3.0).unwrap(),
                shines(false, true),
            )),
            Light::Triangle(TriangleLight::new(Triangle::new(Vec3::ZERO, x, y).unwrap(), shines(true, true))),
            Light::Cylinder(
                CylinderLight::new(Cylinder::new(Vec3::ZERO, x, 1.5, false).unwrap(), shines(true, false)).unwrap(),
            ),
            Light::Point(point()),
            Light::Spot(SpotLight { point: point(), axis: Vec3::new(0.0, 0.0, 1.0), cosines: [0.8, 0.5] }),
            Light::Directional(DirectionalLight { toward: Vec3::new(0.0, 0.0, 1.0), irradiance: one() }),
            Light::Environment(Arc::new(EnvironmentLight::new(&white_sky(), [360.0, 830.0]))),
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
        let table = LightTable::new(lights, 5.0, [360.0, 830.0]);
        for (i, power) in powers.iter().enumerate() {
            let share = 0.9 * power / total + 0.1 / 9.0;
            assert!((table.probability(i) - share).abs() < 1e-14, "{i}: {} is not {share}", table.probability(i));
        }
    }

    #[test]
    fn a_spectrum_counts_by_what_an_observer_makes_of_it() {
        // x̄, ȳ and z̄ have the same integral, 106.857 nm; the floor adds 0.47.
        let mean = visible_sum(&PathSpectrum::Constant(1.0), [360.0, 830.0]) * 470.0 / 256.0;
        assert!((mean - (3.0 * 106.857 + 0.47)).abs() < 0.1, "{mean}");
    }
}
