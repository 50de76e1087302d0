//! A trial before a picture: which wavelengths bring light in each region of it.
//!
//! The variance of a path whose hero goes on alone is least if heroes are drawn in proportion to the root of the mean square of what each
//! brings. So that is learned, group by group of wavelengths and region by region, from samples that are thrown away. They fall into two halves.
//! What the one half has taught is judged by the other: chance alone then wins nothing.

use crate::film::Counters;
use crate::integrator::tracer::Tracer;
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::polarisation::Polarisation;
use crate::sampler::mix;
use crate::scene::prepare::Prepared;
use crate::wavelength::guide::{GROUPS, HeroDensity, Regions, WavelengthGuide};
use rayon::prelude::*;
use std::ops::Range;

/// Share of the variance that may be left at most in a region. A density of its own costs no time, but disturbs how evenly the samples of a
/// pixel are spread.
const WORTH_IT: f64 = 0.8;
/// Share of the regions that must win something.
const FEWEST: f64 = 0.02;
/// What neighbouring regions, and neighbouring groups, count for in what a region learns.
const NEAR: [f64; 3] = [0.5, 1.0, 0.5];

/// What half of the samples of a region came to, by the group of the hero: CIE XYZ squared and summed, and how many there were.
#[derive(Clone)]
struct Half {
    squares: [f64; GROUPS],
    count: [f64; GROUPS],
}

impl Half {
    const NOTHING: Self = Self { squares: [0.0; GROUPS], count: [0.0; GROUPS] };

    fn add(&mut self, other: &Self, weight: f64) {
        for group in 0..GROUPS {
            self.squares[group] += weight * other.squares[group];
            self.count[group] += weight * other.count[group];
        }
    }

    /// The root of the mean square of each group, where neighbouring groups count too.
    fn density(&self) -> Option<HeroDensity> {
        let around = |of: &[f64; GROUPS], group: usize| -> f64 {
            neighbours(group, GROUPS).map(|near| NEAR[near + 1 - group] * of[near]).sum()
        };
        HeroDensity::new(&std::array::from_fn(|group| {
            let count = around(&self.count, group);
            if count > 0.0 { (around(&self.squares, group) / count).sqrt() } else { 0.0 }
        }))
    }

    /// The mean square of these samples where heroes are drawn by `density`, and where they are drawn evenly: exact for paths whose hero goes on
    /// alone. Others lose less.
    fn mean_squares(&self, density: Option<&HeroDensity>) -> [f64; 2] {
        let count: f64 = self.count.iter().sum();
        let of_group = |group: usize| self.squares[group] / density.map_or(1.0, |density| density.of_group(group));
        let [guided, even] = [(0..GROUPS).map(of_group).sum::<f64>(), self.squares.iter().sum()];
        if count > 0.0 { [guided / count, even / count] } else { [0.0; 2] }
    }
}

/// What the samples of one region came to.
#[derive(Clone)]
struct Region {
    halves: [Half; 2],
    xyz: [f64; 3],
    count: f64,
    rays: u64,
}

impl Region {
    const NOTHING: Self = Self { halves: [Half::NOTHING; 2], xyz: [0.0; 3], count: 0.0, rays: 0 };
}

/// A place of a row of so many and the places beside it: those at the ends have one neighbour.
fn neighbours(at: usize, end: usize) -> Range<usize> {
    (at.max(1) - 1)..(at + 2).min(end)
}

/// What the samples of all regions came to.
pub(crate) struct WavelengthTrial {
    regions: Regions,
    of_region: Vec<Region>,
    /// Rays of all kinds that were cast, and paths.
    rays: u64,
    paths: u64,
}

/// A trial by one kernel: this many samples in each region, evenly spread, with random numbers of a seed.
pub(crate) fn try_wavelengths<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
    prepared: &Prepared,
    seed: u64,
    regions: Regions,
    samples: u32,
) -> WavelengthTrial {
    let mut tracer = Tracer::new(prepared);
    tracer.seed = seed;
    let of_region = (0..regions.count()).into_par_iter().map(|number| {
        let mut region = Region::NOTHING;
        let pixels = pixels_of(prepared, &regions, number);
        for k in 0..samples {
            // Pixels take turns; of very many, some are left out, evenly.
            let pixel = (u64::from(k) * u64::from(samples.max(pixels.area)) / u64::from(samples)) as u32;
            let (x, y) = pixels.at(pixel % pixels.area);
            let mut counters = Counters::default();
            let path = tracer.sample::<M, P, N>(x, y, pixel / pixels.area, &mut counters, &mut ());
            region.rays += counters.rays + counters.shadow_rays;
            let received = path.received();
            let xyz = M::to_xyz(prepared, &received.wavelengths, received.radiance);
            let square: f64 = xyz.iter().map(|v| v * v).sum();
            // What is not finite the picture reports.
            if !square.is_finite() {
                continue;
            }
            let cells = prepared.wavelengths.count();
            let group = received.wavelengths.place.cell(cells) as usize / (cells as usize / GROUPS);
            let half = &mut region.halves[(mix(u64::from(k)) & 1) as usize];
            half.squares[group] += square;
            half.count[group] += 1.0;
            (0..3).for_each(|c| region.xyz[c] += xyz[c]);
            region.count += 1.0;
        }
        region
    });
    // In the order of the regions, whichever thread they are tried by.
    let of_region: Vec<Region> = of_region.collect();
    let rays = of_region.iter().map(|region| region.rays).sum();
    WavelengthTrial { regions, rays, paths: of_region.len() as u64 * u64::from(samples), of_region }
}

/// The pixels of a region.
struct Pixels {
    first: [u32; 2],
    width: u32,
    area: u32,
}

impl Pixels {
    fn at(&self, number: u32) -> (u32, u32) {
        (self.first[0] + number % self.width, self.first[1] + number / self.width)
    }
}

fn pixels_of(prepared: &Prepared, regions: &Regions, number: usize) -> Pixels {
    let film = &prepared.scene.film;
    let number = number as u32;
    let first = [number % regions.columns * regions.side, number / regions.columns * regions.side];
    let [width, height] = [(film.width - first[0]).min(regions.side), (film.height - first[1]).min(regions.side)];
    Pixels { first, width, area: width * height }
}

impl WavelengthTrial {
    /// Rays of all kinds of one path, in the mean.
    pub(crate) fn rays_of_path(&self) -> f64 {
        self.rays as f64 / self.paths as f64
    }

    /// The densities that this teaches, if they are worth it.
    pub(crate) fn guide(&self) -> Option<WavelengthGuide> {
        let around: Vec<Region> = (0..self.of_region.len()).map(|number| self.around(number)).collect();
        let learned: Vec<[Option<HeroDensity>; 2]> =
            around.iter().map(|region| region.halves.each_ref().map(Half::density)).collect();
        // Each half by what the other has taught.
        let judged: Vec<[f64; 2]> = (0..self.of_region.len())
            .map(|number| {
                let by =
                    |half: usize| self.of_region[number].halves[half].mean_squares(learned[number][1 - half].as_ref());
                let [a, b] = [by(0), by(1)];
                [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
            })
            .collect();
        let level = |region: &Region| -> f64 {
            region.xyz.iter().map(|v| v * v).sum::<f64>() / (region.count * region.count).max(1.0)
        };
        let of_region = around.iter().enumerate().map(|(number, region)| {
            let level = level(region);
            let [guided, even] = self.judged_around(number, &judged).map(|square| (square - level).max(0.0));
            let mut both = region.halves[0].clone();
            both.add(&region.halves[1], 1.0);
            both.density().filter(|_| guided < WORTH_IT * even)
        });
        let guide = WavelengthGuide { regions: self.regions, densities: of_region.collect() };
        (guide.guided() as f64 >= FEWEST * guide.densities.len() as f64).then_some(guide)
    }

    /// The regions about one, itself among them, each with what it counts for.
    fn near(&self, number: usize) -> impl Iterator<Item = (usize, f64)> + use<'_> {
        let (columns, rows) = (self.regions.columns as usize, self.regions.rows as usize);
        let (column, row) = (number % columns, number / columns);
        neighbours(row, rows).flat_map(move |y| {
            neighbours(column, columns).map(move |x| (y * columns + x, NEAR[y + 1 - row] * NEAR[x + 1 - column]))
        })
    }

    /// What the samples about a region came to.
    fn around(&self, number: usize) -> Region {
        let mut sum = Region::NOTHING;
        for (near, weight) in self.near(number) {
            let region = &self.of_region[near];
            (0..2).for_each(|half| sum.halves[half].add(&region.halves[half], weight));
            (0..3).for_each(|c| sum.xyz[c] += weight * region.xyz[c]);
            sum.count += weight * region.count;
        }
        sum
    }

    /// The mean squares about a region.
    fn judged_around(&self, number: usize, judged: &[[f64; 2]]) -> [f64; 2] {
        let (mut sum, mut weights) = ([0.0; 2], 0.0);
        for (near, weight) in self.near(number) {
            (0..2).for_each(|k| sum[k] += weight * judged[near][k]);
            weights += weight;
        }
        sum.map(|sum| sum / weights)
    }
}
