//! Maps of the unit square to itself that carry the uniform density to a piecewise-bilinear one, and back.
//!
//! # Formula
//!
//! Let p(x, y) be bilinear between the nodes of a grid, and scaled so that ∫∫p dx dy = 1. The map takes (u, v) to (x, y) by inversion:
//!
//! - v = ∫₀ʸ m(y′) dy′ with the marginal density m(y) = ∫₀¹ p(x, y) dx, which is linear between two rows;
//! - u m(y) = ∫₀ˣ p(x′, y) dx′, where p is linear between two columns.
//!
//! Both integrals are sums up to a node, and a quadratic function within a cell. A cell with the densities f₀ and f₁ at its ends (width 1)
//! has the integral a = f₀t + (f₁ − f₀)t²/2 up to t. So t = 2a/(f₀ + √(f₀² + 2a(f₁ − f₀))), without cancellation.
//!
//! # Parameters
//!
//! The density may depend on further parameters, here on the direction of the light. It is then given as slices at some values of these. In
//! between, the densities of the slices are interpolated, each scaled to the integral 1. All sums are linear in the density, so they are
//! interpolated by the same weights. The map stays exact: but for rounding, [`Warp::density`] is the density of [`Warp::sample`], and
//! [`Warp::invert`] is its inverse.
//!
//! # Source
//!
//! J. Dupuy & W. Jakob 2018, *An Adaptive Parameterization for Efficient Material Acquisition and Rendering*, ACM Transactions on Graphics
//! 37(6), section 4 (warps by inversion of marginal and conditional densities); the linear case is inverted as in M. Pharr, W. Jakob & G.
//! Humphreys 2023, *Physically Based Rendering*, 4th edition, section A.5.1.

use super::table::{Cell, Slices, Table};

/// A density on the unit square that depends on parameters, with its map.
#[derive(Clone, Debug, PartialEq)]
pub struct Warp {
    table: Table,
    /// By which each slice is multiplied, so that its integral is 1.
    scale: Vec<f64>,
    /// ∫₀ˣ p dx′ at each node.
    along: Vec<f64>,
    /// ∫₀ʸ m dy′ at each row of each slice.
    across: Vec<f64>,
}

impl Warp {
    /// The densities of a table without negative values.
    ///
    /// # Errors
    /// A sentence that says which slice is 0 everywhere; `name` is that of the table.
    pub(super) fn new(name: &str, table: Table) -> Result<Self, String> {
        let [columns, rows] = table.size();
        let [width, height] = [columns, rows].map(|nodes| 1.0 / (nodes - 1) as f64);
        let (mut scale, mut along, mut across) = (Vec::new(), Vec::new(), Vec::new());
        for (slice, values) in table.slices().enumerate() {
            let (first, first_row) = (along.len(), across.len());
            for row in values.chunks_exact(columns) {
                along.extend(sums(row.iter().map(|value| f64::from(*value)), width));
            }
            let marginal: Vec<f64> = along[first..].iter().skip(columns - 1).step_by(columns).copied().collect();
            across.extend(sums(marginal.into_iter(), height));
            let whole = across[across.len() - 1];
            if whole <= 0.0 {
                return Err(format!(
                    "\"{name}\" is 0 everywhere for direction {slice} of the light: nothing can be drawn from it"
                ));
            }
            scale.push(1.0 / whole);
            along[first..].iter_mut().chain(&mut across[first_row..]).for_each(|sum| *sum /= whole);
        }
        Ok(Self { table, scale, along, across })
    }

    /// The density at a place.
    #[inline]
    pub fn density(&self, slices: &Slices, place: [f64; 2]) -> f64 {
        let cell = self.table.cell(place);
        slices.mean(|slice| self.scale[slice] * self.table.bilinear(slice, cell))
    }

    /// Where the map takes a place of the square, (u, v).
    pub fn sample(&self, slices: &Slices, [u, v]: [f64; 2]) -> [f64; 2] {
        let [columns, rows] = self.table.size();
        let across = |row: usize| slices.mean(|slice| self.across[slice * rows + row]);
        let row = last_below(rows, v, across);
        let y =
            within([self.marginal(slices, row), self.marginal(slices, row + 1)], (v - across(row)) * (rows - 1) as f64);
        let along = |column: usize| self.along(slices, column, row, y);
        let u = u * along(columns - 1);
        let column = last_below(columns, u, along);
        let density = |column: usize| {
            let cell = Cell {
                index: [column.min(columns - 2), row],
                share: [if column == columns - 1 { 1.0 } else { 0.0 }, y],
            };
            slices.mean(|slice| self.scale[slice] * self.table.bilinear(slice, cell))
        };
        let x = within([density(column), density(column + 1)], (u - along(column)) * (columns - 1) as f64);
        [(column as f64 + x) / (columns - 1) as f64, (row as f64 + y) / (rows - 1) as f64]
    }

    /// The place that [`Warp::sample`] takes to `place`, and the density there. A place without density has no such place: it comes with the
    /// density 0.
    pub fn invert(&self, slices: &Slices, place: [f64; 2]) -> ([f64; 2], f64) {
        let [columns, rows] = self.table.size();
        let cell = self.table.cell(place);
        let ([column, row], [x, y]) = (cell.index, cell.share);
        let integral = |[from, to]: [f64; 2], t: f64| t * (from + 0.5 * t * (to - from));
        let marginal = [self.marginal(slices, row), self.marginal(slices, row + 1)];
        let v = slices.mean(|slice| self.across[slice * rows + row]) + integral(marginal, y) / (rows - 1) as f64;
        let density = |share: f64| {
            let cell = Cell { share: [share, y], ..cell };
            slices.mean(|slice| self.scale[slice] * self.table.bilinear(slice, cell))
        };
        let below =
            self.along(slices, column, row, y) + integral([density(0.0), density(1.0)], x) / (columns - 1) as f64;
        let here = density(x);
        match self.along(slices, columns - 1, row, y) {
            whole if whole > 0.0 && here > 0.0 => ([(below / whole).min(1.0), v.min(1.0)], here),
            _ => ([0.0; 2], 0.0),
        }
    }

    /// The marginal density at a row.
    fn marginal(&self, slices: &Slices, row: usize) -> f64 {
        self.along(slices, self.table.size()[0] - 1, row, 0.0)
    }

    /// ∫₀ˣ p dx′ up to a column, the share `y` of the way from one row to the next.
    fn along(&self, slices: &Slices, column: usize, row: usize, y: f64) -> f64 {
        let [columns, rows] = self.table.size();
        let at = |row: usize| slices.mean(|slice| self.along[(slice * rows + row) * columns + column]);
        let from = at(row);
        if y == 0.0 { from } else { from + y * (at(row + 1) - from) }
    }
}

/// The integrals of a function that is linear between nodes a `width` apart, up to each node.
fn sums(values: impl Iterator<Item = f64>, width: f64) -> impl Iterator<Item = f64> {
    let mut before: Option<(f64, f64)> = None;
    values.map(move |value| {
        let sum = before.map_or(0.0, |(last, sum)| sum + 0.5 * width * (last + value));
        before = Some((value, sum));
        sum
    })
}

/// The last of the first `nodes` − 1 nodes whose sum is at most `sum`: the beginning of the cell in which it is reached.
fn last_below(nodes: usize, sum: f64, of: impl Fn(usize) -> f64) -> usize {
    let (mut low, mut high) = (0, nodes - 1);
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if of(middle) <= sum { low = middle } else { high = middle }
    }
    low
}

/// How far from 0 to 1 the integral of a linear density is reached, whose values at both ends are these.
fn within([from, to]: [f64; 2], integral: f64) -> f64 {
    // Rounding may push the difference of what is reached and the last sum below 0, and the quotient past 1.
    let integral = integral.max(0.0);
    let denominator = from + (from * from + 2.0 * integral * (to - from)).max(0.0).sqrt();
    if denominator > 0.0 { (2.0 * integral / denominator).min(1.0) } else { 0.0 }
}
