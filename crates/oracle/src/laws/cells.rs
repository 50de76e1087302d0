//! Directions counted in cells of equal solid angle, against what a density lets each cell expect.

use std::f64::consts::TAU;

use crate::{
    quadrature::{Clue, Cone, Integral, nonnegative},
    statistics::Expected,
};

/// Cells of equal height over the cone, and of equal azimuth.
const ROWS: usize = 16;
const COLUMNS: usize = 32;

/// How well a cell's expectation is wanted: to this many standard deviations of its count. All 512 cells together then hide a
/// departure of less than √(512/65536)·0.03 = 0.0027 in root mean square, a twentieth of what chance hides.
const OF_NOISE: f64 = 0.03;

/// What is small in any cell: 1e-6 of probability is 0.07 samples of 65536.
const LEAST_PROBABILITY: f64 = 1e-6;

/// Most parts that one cell is divided into; each costs some fifty evaluations of the density, where it ends some hundreds.
const PARTS: usize = 400;

/// Samples of each cell whose densities are shown to its quadrature.
const CLUES: usize = 64;

/// Counts of directions in the cells of a cone, with the densities of some of them.
pub(super) struct Cells {
    cone: Cone,
    /// How many fell into each cell.
    pub(super) observed: Vec<u64>,
    clues: Vec<Vec<Clue>>,
}

impl Cells {
    pub(super) fn new(cone: Cone) -> Self {
        let cells = ROWS * COLUMNS;
        Self { cone, observed: vec![0; cells], clues: vec![Vec::new(); cells] }
    }

    /// Counts a direction; whether it is within the cone, but for a hair of room for its rim.
    pub(super) fn count(&mut self, wi: [f64; 3], density: impl FnOnce() -> f64) -> bool {
        let (h, phi) = self.cone.coordinates(wi);
        if h > 1.0 + 1e-6 {
            return false;
        }
        let row = ((h * ROWS as f64) as usize).min(ROWS - 1);
        let column = ((phi / TAU * COLUMNS as f64) as usize).min(COLUMNS - 1);
        let cell = row * COLUMNS + column;
        self.observed[cell] += 1;
        if self.clues[cell].len() < CLUES {
            self.clues[cell].push(([h, phi], density()));
        }
        true
    }

    /// The integral of the density over each cell, where `samples` will be counted. What a sample has met is what the
    /// quadrature must find: a density that ends within a cell may be missed by all of its first nodes.
    pub(super) fn integrals(&self, density: impl Fn([f64; 3]) -> f64, samples: u32) -> Vec<Integral> {
        let scale = self.cone.one_minus_cos;
        let tolerance = |value: f64| {
            let noise = (value.max(0.0) * scale / f64::from(samples)).sqrt();
            (OF_NOISE * noise).max(LEAST_PROBABILITY) / scale
        };
        (0..ROWS * COLUMNS)
            .map(|cell| {
                let (row, column) = ((cell / COLUMNS) as f64, (cell % COLUMNS) as f64);
                let [a, b] = [row, row + 1.0].map(|x| x / ROWS as f64);
                let [c, d] = [column, column + 1.0].map(|x| x / COLUMNS as f64 * TAU);
                let over = |h: f64, phi: f64| density(self.cone.direction(h, phi));
                let inner = nonnegative(over, [a, b, c, d], &self.clues[cell], tolerance, PARTS);
                Integral { value: inner.value * scale, error: inner.error * scale }
            })
            .collect()
    }
}

/// Counts expected of this many samples, of probabilities.
pub(super) fn expected(probabilities: &[Integral], samples: u32) -> Vec<Expected> {
    let n = f64::from(samples);
    probabilities.iter().map(|cell| Expected { count: n * cell.value, error: n * cell.error }).collect()
}

/// What is left of 1, known as well as the parts together; exactly nothing where that is below `least`.
pub(super) fn rest(parts: &[Integral], least: f64) -> Integral {
    let value = 1.0 - parts.iter().map(|cell| cell.value).sum::<f64>();
    let error = parts.iter().map(|cell| cell.error).sum::<f64>();
    if value < least && error < least {
        Integral { value: 0.0, error: 0.0 }
    } else {
        Integral { value: value.max(0.0), error }
    }
}
