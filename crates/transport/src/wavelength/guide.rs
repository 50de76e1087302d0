//! Wavelengths by region of the picture: more of those that bring light there.
//!
//! Behind a prism a pixel shows light of few wavelengths. A hero that is drawn as everywhere else is mostly another, and finds nothing. So each
//! region of the picture may have a density of its own over the hero's number, learned before the picture and then frozen. It is constant in each
//! of [`GROUPS`] groups of cells. The other lanes remain the rotations of the hero.
//!
//! **MIS.** Each lane might have been the hero. The density of a path is therefore the mean over its lanes, each with the density of its wavelength
//! as hero times that of the path that it would have taken (Wilkie et al. 2014, eq. 5, with densities that differ). So the lanes of a path begin
//! with [`Wavelengths::density`] instead of 1.

use super::{WavelengthDistribution, Wavelengths};
use etalon_optics::Lanes;

/// Groups of cells, each a stretch of the same probability: the hero's is drawn by the region. A multiple of the lanes of a path.
pub(crate) const GROUPS: usize = 128;
/// Share of the heroes that is drawn as everywhere (a defensive mixture): so no sample is worth more than 1/0.3 of what it would be otherwise.
pub(crate) const UNIFORM_SHARE: f64 = 0.3;
/// Just below 1, so that a group and this part of it are still in the group after rounding.
const BELOW_ONE: f64 = 1.0 - 1.0 / (1_u64 << 40) as f64;

/// Squares of pixels that cover the film, row by row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Regions {
    /// Of a square, pixels.
    pub side: u32,
    pub columns: u32,
    pub rows: u32,
}

impl Regions {
    /// Of a film of this size, in squares of at least `side` pixels and so large that there are about `most` of them at most.
    pub(crate) fn new(width: u32, height: u32, side: u32, most: u32) -> Self {
        let pixels = f64::from(width) * f64::from(height);
        // However long and thin it is.
        let side = side.max((pixels / f64::from(most)).sqrt().ceil() as u32).max(width.max(height).div_ceil(most));
        Self { side, columns: width.div_ceil(side), rows: height.div_ceil(side) }
    }

    /// How many.
    pub(crate) fn count(&self) -> usize {
        self.columns as usize * self.rows as usize
    }

    fn of_pixel(&self, x: u32, y: u32) -> usize {
        (y / self.side) as usize * self.columns as usize + (x / self.side) as usize
    }
}

/// The probability of all groups before each, and of all: of one region.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct HeroDensity {
    cumulative: Box<[f64; GROUPS + 1]>,
}

impl HeroDensity {
    /// In proportion to `wanted`, beside [`UNIFORM_SHARE`]; `None` if that is nothing or no number.
    pub(crate) fn new(wanted: &[f64; GROUPS]) -> Option<Self> {
        let sum: f64 = wanted.iter().sum();
        if !(sum > 0.0 && sum.is_finite()) {
            return None;
        }
        let mut cumulative = Box::new([0.0; GROUPS + 1]);
        for (group, own) in wanted.iter().enumerate() {
            cumulative[group + 1] =
                cumulative[group] + UNIFORM_SHARE / GROUPS as f64 + (1.0 - UNIFORM_SHARE) * (own / sum);
        }
        let all = cumulative[GROUPS];
        cumulative.iter_mut().for_each(|probability| *probability /= all);
        Some(Self { cumulative })
    }

    /// Of the hero in a group, over that of an even one.
    pub(crate) fn of_group(&self, group: usize) -> f64 {
        (self.cumulative[group + 1] - self.cumulative[group]) * GROUPS as f64
    }

    /// The group of a number in [0, 1), and the number that draws the same place of an even density.
    fn draw(&self, u: f64) -> (usize, f64) {
        // The first is 0 and the last is 1.
        let group = self.cumulative.partition_point(|&before| before <= u) - 1;
        let (before, after) = (self.cumulative[group], self.cumulative[group + 1]);
        let part = ((u - before) / (after - before)).min(BELOW_ONE);
        (group, (group as f64 + part) / GROUPS as f64)
    }
}

/// The densities of all regions: see the module.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct WavelengthGuide {
    pub regions: Regions,
    /// Of each region, where it is worth it.
    pub densities: Vec<Option<HeroDensity>>,
}

impl WavelengthGuide {
    /// The wavelengths of a path of a pixel whose hero is drawn by `u` in [0, 1).
    pub(crate) fn sample_lanes<const N: usize>(
        &self,
        distribution: &WavelengthDistribution,
        x: u32,
        y: u32,
        u: f64,
    ) -> Wavelengths<N> {
        let Some(density) = &self.densities[self.regions.of_pixel(x, y)] else { return distribution.sample_lanes(u) };
        let (group, u) = density.draw(u);
        let of_lane = |lane: usize| density.of_group((group + lane * (GROUPS / N)) % GROUPS);
        Wavelengths { density: Lanes::from_fn(of_lane), ..distribution.sample_lanes(u) }
    }

    /// How many regions have a density of their own.
    pub(crate) fn guided(&self) -> usize {
        self.densities.iter().flatten().count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::wavelength_lanes::{Hero, WavelengthModel};

    /// A density with a peak, over all wavelengths that are drawn.
    fn peaked() -> HeroDensity {
        let mut wanted = [0.0; GROUPS];
        wanted[40] = 3.0;
        wanted[41] = 1.0;
        HeroDensity::new(&wanted).expect("there is something")
    }

    #[test]
    fn nothing_is_wanted_or_no_number_gives_no_density() {
        assert_eq!(HeroDensity::new(&[0.0; GROUPS]), None);
        assert_eq!(HeroDensity::new(&[f64::NAN; GROUPS]), None);
        assert_eq!(HeroDensity::new(&[f64::INFINITY; GROUPS]), None);
    }

    /// Counted over an even comb of numbers: each group is drawn as often as its density says, and the place is in it.
    #[test]
    fn groups_are_drawn_by_their_density() {
        let density = peaked();
        let n = 1 << 20;
        let mut drawn = [0_u32; GROUPS];
        for i in 0..n {
            let (group, u) = density.draw((f64::from(i) + 0.5) / f64::from(n));
            assert_eq!((u * GROUPS as f64) as usize, group);
            drawn[group] += 1;
        }
        for (group, &count) in drawn.iter().enumerate() {
            let expected = density.of_group(group) / GROUPS as f64 * f64::from(n);
            // One tooth of the comb at each end.
            assert!((f64::from(count) - expected).abs() <= 2.0, "{group}: {count} instead of {expected}");
            assert!(density.of_group(group) >= 0.999 * UNIFORM_SHARE);
        }
        let (group, u) = density.draw(1.0_f64.next_down());
        assert!(group == GROUPS - 1 && u < 1.0);
    }

    /// Whatever the density, the mean over the hero's number of what any spectrum comes to is the same: where lanes go together, and where the
    /// hero goes on alone.
    #[test]
    fn the_density_of_heroes_changes_no_mean() {
        let distribution = WavelengthDistribution::new([360.0, 830.0]);
        let regions = Regions { side: 4, columns: 1, rows: 1 };
        let guide = WavelengthGuide { regions, densities: vec![Some(peaked())] };
        let spectrum = |nm: f64| if nm > 540.0 && nm < 560.0 { nm } else { 1.0 };
        let n = 1 << 20;
        let mean = |guided: bool, alone: bool| {
            let mut sum = [0.0; 3];
            for i in 0..n {
                let u = (f64::from(i) + 0.5) / f64::from(n);
                let w: Wavelengths<8> = match guided {
                    true => guide.sample_lanes(&distribution, 0, 0, u),
                    false => distribution.sample_lanes(u),
                };
                let followed = if alone { Lanes::ONE.hero_only() } else { Lanes::ONE };
                let mut lanes = Hero::<8>::start(&w);
                lanes.follow(followed);
                let weight = lanes.weight();
                let radiance = Lanes::from_fn(|lane| spectrum(w.lambda_nm[lane]) * followed[lane] * weight);
                let xyz = distribution.to_xyz(&w, radiance);
                (0..3).for_each(|c| sum[c] += xyz[c] / f64::from(n));
            }
            sum
        };
        let expected = mean(false, false);
        for (guided, alone) in [(false, true), (true, false), (true, true)] {
            let found = mean(guided, alone);
            // The comb errs by a tooth, 1e-6 of the range, at each step of spectrum and density: there are some hundred, of values up to 1e3.
            (0..3).for_each(|c| assert!((found[c] / expected[c] - 1.0).abs() < 1e-4, "{found:?} is not {expected:?}"));
        }
    }

    #[test]
    fn regions_cover_the_film_and_are_not_too_many() {
        for (width, height) in [(1, 1), (640, 400), (5, 300), (4000, 3000), (1, 1_000_000)] {
            let regions = Regions::new(width, height, 4, 4096);
            assert!(regions.side >= 4 && regions.of_pixel(width - 1, height - 1) == regions.count() - 1);
            // Those at two edges may be cut.
            assert!(regions.count() <= 2 * 4096);
        }
    }
}
