//! Which light a shadow ray aims at.
//!
//! Few lights are chosen in proportion to their power, with a share spread evenly: one table for all points. Of many, most are too far
//! away to matter: those that are somewhere are chosen by a [`LightTree`], for each point anew, with a tenth left to the table, so that
//! a light which the tree thinks little of is still found with a bounded weight.

use super::Light;
use super::tree::{LightBounds, LightTree};
use crate::spectral::PathSpectrum;
use etalon_optics::Vec3;
use etalon_optics::colour::colour_matching;
use etalon_scene::LightSelection;

/// Share of the choices that is spread evenly over the lights, so that a dim light beside the point is still found.
const EVEN_SHARE: f64 = 0.1;
/// Share of the choices that a tree leaves to the table.
const TABLE_SHARE: f64 = 0.1;
/// Lights with a place from which a tree is made where the scene leaves it open.
const TREE_FROM: usize = 8;

/// All lights that shadow rays aim at, with the probability of each.
#[derive(Clone, Debug, Default)]
pub struct LightTable {
    lights: Vec<Light>,
    /// By power.
    table: Table,
    near: Option<Near>,
}

/// Cumulative probabilities; the last is 1.
#[derive(Clone, Debug, Default)]
struct Table(Vec<f64>);

impl Table {
    /// Probabilities in proportion to `weights`, and `even` of all spread evenly.
    fn new(weights: impl ExactSizeIterator<Item = f64> + Clone, even: f64) -> Self {
        let total: f64 = weights.clone().sum();
        let each = even / weights.len() as f64;
        let mut sum = 0.0;
        let mut cdf: Vec<f64> = weights
            .map(|weight| {
                sum += (1.0 - even) * weight / total + each;
                sum
            })
            .collect();
        if let Some(last) = cdf.last_mut() {
            *last = 1.0;
        }
        Self(cdf)
    }

    fn choose(&self, u: f64) -> usize {
        self.0.partition_point(|&c| c <= u)
    }

    fn probability(&self, index: usize) -> f64 {
        self.0[index] - if index == 0 { 0.0 } else { self.0[index - 1] }
    }
}

/// Lights chosen by where they are.
#[derive(Clone, Debug)]
struct Near {
    tree: LightTree,
    /// Which light each of the tree's is.
    within: Vec<u32>,
    /// Those that are nowhere, such as a sky, or not always at one place, by power; and the part of the choices that is theirs.
    beyond: Vec<u32>,
    beyond_table: Table,
    beyond_share: f64,
    /// Of each light, its number in the tree or among those beyond.
    number: Vec<Number>,
}

#[derive(Clone, Copy, Debug)]
enum Number {
    Within(u32),
    Beyond(u32),
}

impl Near {
    fn new(lights: &[Light], powers: &[f64]) -> Option<Self> {
        let (mut bounds, mut within, mut beyond) = (Vec::new(), Vec::new(), Vec::new());
        let number = lights
            .iter()
            .zip(powers)
            .enumerate()
            .map(|(index, (light, &power))| match light.bounds() {
                Some(place) => {
                    within.push(index as u32);
                    bounds.push(LightBounds { power, ..place });
                    Number::Within(within.len() as u32 - 1)
                }
                None => {
                    beyond.push(index as u32);
                    Number::Beyond(beyond.len() as u32 - 1)
                }
            })
            .collect();
        let tree = LightTree::new(&bounds)?;
        let power_of = |of: &[u32]| of.iter().map(|&index| powers[index as usize]).sum::<f64>();
        let beyond_share = power_of(&beyond) / (power_of(&beyond) + power_of(&within));
        let beyond_table = Table::new(beyond.iter().map(|&index| powers[index as usize]), EVEN_SHARE);
        Some(Self { tree, within, beyond, beyond_table, beyond_share, number })
    }

    /// A light and its probability.
    fn choose(&self, from: Vec3<f64>, u: f64) -> Option<(usize, f64)> {
        if u < self.beyond_share {
            let number = self.beyond_table.choose(u / self.beyond_share).min(self.beyond.len() - 1);
            return Some((self.beyond[number] as usize, self.beyond_share * self.beyond_table.probability(number)));
        }
        let u = (u - self.beyond_share) / (1.0 - self.beyond_share);
        let (light, probability) = self.tree.choose(from, u.min(1.0 - f64::EPSILON))?;
        Some((self.within[light as usize] as usize, (1.0 - self.beyond_share) * probability))
    }

    fn probability(&self, index: usize, from: Vec3<f64>) -> f64 {
        match self.number[index] {
            Number::Within(light) => (1.0 - self.beyond_share) * self.tree.probability(from, light),
            Number::Beyond(light) => self.beyond_share * self.beyond_table.probability(light as usize),
        }
    }
}

/// The probability of a light by the table and by the tree.
fn mix(by_power: f64, by_place: f64) -> f64 {
    TABLE_SHARE * by_power + (1.0 - TABLE_SHARE) * by_place
}

impl LightTable {
    /// A table over lights of a scene with this bounding radius; lights that emit nothing within the
    /// wavelengths `range_nm` are left out.
    pub fn new(lights: Vec<Light>, scene_radius: f64, range_nm: [f64; 2], selection: LightSelection) -> Self {
        Self::weighed(lights, scene_radius, selection, |spectrum| visible_sum(spectrum, range_nm))
    }

    /// The same where `worth` says how much a spectrum counts; lights of no worth are left out.
    pub(crate) fn weighed(
        lights: Vec<Light>,
        scene_radius: f64,
        selection: LightSelection,
        worth: impl Fn(&PathSpectrum) -> f64,
    ) -> Self {
        // The triangles of a mesh share their spectrum, and come one after the other.
        let mut last: Option<(*const PathSpectrum, f64)> = None;
        let powers = lights.iter().map(|light| {
            let spectrum = light.spectrum();
            let visible = match last {
                Some((of, visible)) if std::ptr::eq(of, spectrum) => visible,
                _ => worth(spectrum),
            };
            last = Some((spectrum, visible));
            light.power_factor(scene_radius) * visible
        });
        let (lights, powers): (Vec<_>, Vec<_>) =
            lights.iter().cloned().zip(powers).filter(|&(_, power)| power > 0.0).unzip();
        let table = Table::new(powers.iter().copied(), EVEN_SHARE);
        let by_place = match selection {
            LightSelection::Power => false,
            LightSelection::Tree => true,
            LightSelection::Auto => lights.iter().filter(|light| light.bounds().is_some()).count() >= TREE_FROM,
        };
        let near = if by_place { Near::new(&lights, &powers) } else { None };
        Self { lights, table, near }
    }

    /// The power of all lights at a wavelength, nm, in a scene of this radius.
    pub(crate) fn power_at(&self, wavelength_nm: f64, scene_radius: f64) -> f64 {
        // The triangles of a mesh share their spectrum, and come one after the other.
        let mut last: Option<(*const PathSpectrum, f64)> = None;
        let powers = self.lights.iter().map(|light| {
            let spectrum = light.spectrum();
            let value = match last {
                Some((of, value)) if std::ptr::eq(of, spectrum) => value,
                _ => spectrum.eval(wavelength_nm),
            };
            last = Some((spectrum, value));
            light.power_factor(scene_radius) * value
        });
        powers.sum()
    }

    /// Whether there is no light to aim at.
    pub fn is_empty(&self) -> bool {
        self.lights.is_empty()
    }

    /// Whether lights are chosen for each point anew, by where they are.
    pub fn chooses_by_place(&self) -> bool {
        self.near.is_some()
    }

    /// Whether the walk itself may run into a light that is aimed at.
    pub fn can_be_met(&self) -> bool {
        self.lights.iter().any(Light::can_be_met)
    }

    /// The lights, in the order of their indices.
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// The index of the light that `u` in [0, 1) chooses for shadow rays from a point, and its probability; `None` where no light
    /// shines.
    #[inline]
    pub fn choose(&self, from: Vec3<f64>, u: f64) -> Option<(usize, f64)> {
        let by_power = |u: f64| self.table.choose(u).min(self.lights.len() - 1);
        let Some(near) = &self.near else {
            let index = by_power(u);
            return Some((index, self.table.probability(index)));
        };
        if u < TABLE_SHARE {
            let index = by_power(u / TABLE_SHARE);
            return Some((index, self.probability(index, from)));
        }
        let (index, by_place) = near.choose(from, (u - TABLE_SHARE) / (1.0 - TABLE_SHARE))?;
        Some((index, mix(self.table.probability(index), by_place)))
    }

    /// The probability of a light for shadow rays from a point.
    #[inline]
    pub fn probability(&self, index: usize, from: Vec3<f64>) -> f64 {
        let by_power = self.table.probability(index);
        match &self.near {
            None => by_power,
            Some(near) => mix(by_power, near.probability(index, from)),
        }
    }
}

/// ∫ S·(x̄ + ȳ + z̄ + floor) by 256 equal steps of the range: only the choice of lights depends on it. The floor keeps
/// lights whose wavelengths are hardly visible.
pub(crate) fn visible_sum(spectrum: &PathSpectrum, range_nm: [f64; 2]) -> f64 {
    weighted_sum(spectrum, range_nm, |_| 0.0)
}

/// The same, where wavelengths count for more than the eye sees of them.
pub(crate) fn weighted_sum(spectrum: &PathSpectrum, [first, last]: [f64; 2], more: impl Fn(f64) -> f64) -> f64 {
    let steps = 256;
    let at = |i: i32| first + (last - first) * (f64::from(i) + 0.5) / f64::from(steps);
    let weight = |nm: f64| colour_matching(nm).iter().sum::<f64>() + 1e-3 + more(nm);
    (0..steps).map(at).map(|nm| spectrum.eval(nm) * weight(nm)).sum()
}

#[cfg(test)]
mod tests {
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
        let table = LightTable::new(lights, 5.0, [360.0, 830.0], LightSelection::Tree);
        assert!(table.chooses_by_place());
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
}
