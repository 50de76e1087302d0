//! Which light a shadow ray aims at.
//!
//! Few lights are chosen in proportion to their power, with a share spread evenly: one table for all points. Of many, most are too far
//! away to matter. Those that are somewhere are chosen by a [`LightTree`], for each point anew. A tenth is left to the table: a light that
//! the tree thinks little of is still found, with a bounded weight.
//!
//! Power does not know what is in the way: in a room a lamp lights more than the sky above the roof. A trial before the picture
//! [learns](LightTable::learn) how often each light is worth a shadow ray. It leaves a tenth to the table by power, too.

use super::Light;
use super::tree::{LightBounds, LightTree};
use crate::spectral::PathSpectrum;
use etalon_optics::Vec3;
use etalon_optics::colour::colour_matching;
use etalon_scene::LightSelection;

/// Share of the choices that is spread evenly over the lights, so that a dim light beside the point is still found.
const EVEN_SHARE: f64 = 0.1;
/// Share of the choices that a tree, or what was learned, leaves to the table by power.
const TABLE_SHARE: f64 = 0.1;
/// Lights with a place from which a tree is made where the scene leaves it open.
const TREE_FROM: usize = 8;

/// All lights that shadow rays aim at, with the probability of each.
#[derive(Clone, Debug, Default)]
pub struct LightTable {
    lights: Vec<Light>,
    by_power: Table,
    near: Option<Near>,
    /// Which of the [groups](Self::groups) is chosen, if a trial has learned that.
    learned: Option<Table>,
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
        self.0.partition_point(|&c| c <= u).min(self.0.len() - 1)
    }

    /// The sum of the probabilities before this one.
    fn before(&self, index: usize) -> f64 {
        if index == 0 { 0.0 } else { self.0[index - 1] }
    }

    fn probability(&self, index: usize) -> f64 {
        self.0[index] - self.before(index)
    }
}

/// Lights chosen by where they are.
#[derive(Clone, Debug)]
struct Near {
    tree: LightTree,
    /// Which light each of the tree's is.
    within: Vec<u32>,
    /// Those that are nowhere, such as a sky, or not always at one place.
    beyond: Vec<u32>,
    /// By power: each of those beyond, then all of the tree.
    by_power: Table,
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
        let (power_beyond, power_within) = (power_of(&beyond), power_of(&within));
        // A share of what goes beyond the tree is spread evenly there, too.
        let each = EVEN_SHARE * power_beyond / beyond.len() as f64;
        let of_beyond = beyond.iter().map(|&index| (1.0 - EVEN_SHARE) * powers[index as usize] + each);
        let groups: Vec<f64> = of_beyond.chain([power_within]).collect();
        Some(Self { tree, within, beyond, by_power: Table::new(groups.into_iter(), 0.0), number })
    }

    /// A light and its probability, where these are the probabilities of those beyond and of the tree.
    fn choose(&self, groups: &Table, from: Vec3<f64>, u: f64) -> Option<(usize, f64)> {
        let group = groups.choose(u);
        let of_group = groups.probability(group);
        if let Some(&light) = self.beyond.get(group) {
            return Some((light as usize, of_group));
        }
        let u = (u - groups.before(group)) / of_group;
        let (light, probability) = self.tree.choose(from, u.min(1.0 - f64::EPSILON))?;
        Some((self.within[light as usize] as usize, of_group * probability))
    }

    fn probability(&self, groups: &Table, index: usize, from: Vec3<f64>) -> f64 {
        let of_group = groups.probability(self.group(index));
        match self.number[index] {
            Number::Within(light) => of_group * self.tree.probability(from, light),
            Number::Beyond(_) => of_group,
        }
    }

    /// The group of a light: those beyond by themselves, the tree last.
    fn group(&self, index: usize) -> usize {
        match self.number[index] {
            Number::Within(_) => self.beyond.len(),
            Number::Beyond(number) => number as usize,
        }
    }
}

/// The probability by the table and by what else is known.
fn mix(by_power: f64, otherwise: f64) -> f64 {
    TABLE_SHARE * by_power + (1.0 - TABLE_SHARE) * otherwise
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
        let by_power = Table::new(powers.iter().copied(), EVEN_SHARE);
        let by_place = match selection {
            LightSelection::Power => false,
            LightSelection::Tree => true,
            LightSelection::Auto => lights.iter().filter(|light| light.bounds().is_some()).count() >= TREE_FROM,
        };
        let near = if by_place { Near::new(&lights, &powers) } else { None };
        Self { lights, by_power, near, learned: None }
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
        let groups = self.groups();
        let Some(near) = &self.near else {
            let index = groups.choose(u);
            return Some((index, groups.probability(index)));
        };
        if u < TABLE_SHARE {
            let index = self.by_power.choose(u / TABLE_SHARE);
            return Some((index, self.probability(index, from)));
        }
        let (index, otherwise) = near.choose(groups, from, (u - TABLE_SHARE) / (1.0 - TABLE_SHARE))?;
        Some((index, mix(self.by_power.probability(index), otherwise)))
    }

    /// The probability of a light for shadow rays from a point.
    #[inline]
    pub fn probability(&self, index: usize, from: Vec3<f64>) -> f64 {
        match &self.near {
            None => self.groups().probability(index),
            Some(near) => mix(self.by_power.probability(index), near.probability(self.groups(), index, from)),
        }
    }

    /// Groups between which a trial decides: each light by itself, but those of a tree together.
    fn groups(&self) -> &Table {
        self.learned.as_ref().unwrap_or(match &self.near {
            None => &self.by_power,
            Some(near) => &near.by_power,
        })
    }

    /// The group of a light.
    pub(crate) fn group(&self, light: usize) -> usize {
        self.near.as_ref().map_or(light, |near| near.group(light))
    }

    /// How many groups there are.
    pub(crate) fn group_count(&self) -> usize {
        self.groups().0.len()
    }

    /// How often each group is chosen.
    pub(crate) fn shares(&self) -> Vec<f64> {
        (0..self.group_count()).map(|group| self.share(group, self.groups().probability(group))).collect()
    }

    /// How often each would be chosen if [`learn`](Self::learn) were given these shares.
    pub(crate) fn shares_if(&self, learned: &[f64]) -> Vec<f64> {
        learned.iter().enumerate().map(|(group, &learned)| self.share(group, self.mixed(group, learned))).collect()
    }

    /// How often a group is chosen that has this share of what is not left to the table of all lights.
    fn share(&self, group: usize, otherwise: f64) -> f64 {
        match &self.near {
            None => otherwise,
            Some(near) => {
                let by_power = |&light: &u32| self.by_power.probability(light as usize);
                let of_table = near.beyond.get(group).map_or_else(|| near.within.iter().map(by_power).sum(), by_power);
                mix(of_table, otherwise)
            }
        }
    }

    /// A share that was learned, with its part by power.
    fn mixed(&self, group: usize, learned: f64) -> f64 {
        mix(self.near.as_ref().map_or(&self.by_power, |near| &near.by_power).probability(group), learned)
    }

    /// Chooses groups as often as these shares say, whose sum is 1, but for a tenth that stays by power; or by power alone.
    pub(crate) fn learn(&mut self, shares: Option<&[f64]>) {
        let table = |shares: &[f64]| {
            let mixed: Vec<f64> = shares.iter().enumerate().map(|(group, &share)| self.mixed(group, share)).collect();
            Table::new(mixed.into_iter(), 0.0)
        };
        self.learned = shares.map(table);
    }

    /// Whether a trial has learned how often lights are chosen.
    pub fn has_learned(&self) -> bool {
        self.learned.is_some()
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
mod tests;
