//! Cells of equal probability: how wavelengths are drawn and what depends on them is looked up, without a search and without a division.
//!
//! The density over wavelengths is constant within each cell, and all cells have the same probability, so the cell of a random number
//! is its leading bits and the place within it the rest. The lanes of a path are equidistant in probability: [`TURNS`] cells that
//! are a [`TURNS`]th of all apart, at the same place within each. A table of anything by cells therefore keeps these side by side, in a
//! row, twice over: what the lanes of a path need is one stretch of a row, from the hero's turn on.

use etalon_optics::Lanes;

/// Most lanes of a path; their number divides it.
pub(crate) const TURNS: usize = 8;

/// Where the wavelengths of a path are: the hero's cell and the place within it, which all lanes share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    row: u32,
    /// Which of the cells of the row is the hero's.
    turn: u32,
    /// From 0 where cells begin to 1 where they end, never 1.
    pub fraction: f64,
}

impl Place {
    /// Of wavelengths that are not drawn.
    pub(crate) const NONE: Self = Self { row: 0, turn: 0, fraction: 0.0 };

    /// The hero's cell among this many.
    pub(crate) fn cell(&self, cells: u32) -> u32 {
        self.row + self.turn * (cells / TURNS as u32)
    }

    /// Drawn by `u` in [0, 1) from this many cells, a power of two.
    #[inline(always)]
    pub(crate) fn draw(u: f64, cells: u32) -> Self {
        // Exact: a power of two.
        let x = u * f64::from(cells);
        let cell = x as u32;
        let rows = cells / TURNS as u32;
        Self { row: cell & (rows - 1), turn: cell >> rows.trailing_zeros(), fraction: x - f64::from(cell) }
    }
}

/// Two numbers for each cell, by what they mean a value and how much it grows.
#[derive(Clone, Debug)]
pub(crate) struct CellTable {
    rows: Vec<Row>,
}

/// Of the cells of a row, twice over.
#[derive(Clone, Debug)]
#[repr(align(64))]
struct Row {
    value: [f64; 2 * TURNS],
    step: [f64; 2 * TURNS],
}

impl CellTable {
    /// What `of` says of each of this many cells.
    pub(crate) fn new(cells: u32, of: impl Fn(u32) -> [f64; 2]) -> Self {
        let rows = cells / TURNS as u32;
        let row = |row| {
            let of_turn: [_; TURNS] = std::array::from_fn(|turn| of(row + turn as u32 * rows));
            let twice = |k: usize| std::array::from_fn(|turn| of_turn[turn % TURNS][k]);
            Row { value: twice(0), step: twice(1) }
        };
        Self { rows: (0..rows).map(row).collect() }
    }

    /// Both numbers in the cells of a path's lanes.
    #[inline(always)]
    pub(crate) fn at<const N: usize>(&self, place: &Place) -> [Lanes<f64, N>; 2] {
        assert!(TURNS.is_multiple_of(N), "tables by cells are for paths whose lanes are dealt evenly");
        let (row, turn) = (&self.rows[place.row as usize], place.turn as usize % TURNS);
        let (mut value, mut step) = (Lanes::ZERO, Lanes::ZERO);
        for lane in 0..N {
            value[lane] = row.value[turn + lane * (TURNS / N)];
            step[lane] = row.step[turn + lane * (TURNS / N)];
        }
        [value, step]
    }

    /// What changes linearly along cells, there.
    #[inline(always)]
    pub(crate) fn along<const N: usize>(&self, place: &Place) -> Lanes<f64, N> {
        let [value, step] = self.at(place);
        value + step * place.fraction
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_are_equal_shares_of_all_cells_apart_and_begin_with_the_hero() {
        let cells = 64;
        let table = CellTable::new(cells, |cell| [f64::from(cell), 1.0]);
        for i in 0..1000 {
            let u = (f64::from(i) + 0.25) / 1000.0;
            let place = Place::draw(u, cells);
            let apart = |n: usize, lane: usize| (u * 64.0 + (lane * 64 / n) as f64) % 64.0;
            let eight = table.along::<8>(&place);
            let four = table.along::<4>(&place);
            // Sixty-four and the remainder of numbers below it are exact.
            (0..8).for_each(|lane| assert!((eight[lane] - apart(8, lane)).abs() < 1e-12, "{u}: {eight:?}"));
            (0..4).for_each(|lane| assert!((four[lane] - apart(4, lane)).abs() < 1e-12, "{u}: {four:?}"));
            assert_eq!(table.along::<1>(&place)[0], eight[0]);
        }
        (0..64).for_each(|cell| assert_eq!(Place::draw((f64::from(cell) + 0.5) / 64.0, cells).cell(cells), cell));
        let last = Place::draw(1.0_f64.next_down(), cells);
        assert!(last.fraction < 1.0 && table.at::<1>(&last)[0][0] == 63.0);
    }
}
