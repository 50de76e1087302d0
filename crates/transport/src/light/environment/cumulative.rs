//! Discrete distributions by their cumulative sums, searched from a guide table (Chen and Asau, *On Generating Random Variates from an
//! Empirical Distribution*, AIIE Transactions 6(2), 1974).
//!
//! A search by halves through a row of an image misses the cache at each of its first steps. The guide says for each of n equal parts
//! of [0, 1) where its first number lies, so that a search begins within a few entries of its end. It finds the same entry.

use etalon_optics::Real;

/// Rows of entries, each row a distribution of its own.
#[derive(Clone, Debug)]
pub(super) struct Cumulative {
    width: usize,
    /// Cumulative share of each entry in its row; the last of a row is 1, or 0 if the row is black.
    sums: Vec<f64>,
    /// For each of `width` equal parts of [0, 1), row after row: the entry in which it begins.
    guide: Vec<u32>,
}

impl Cumulative {
    /// For rows of this many entries.
    pub(super) fn new(width: usize, rows: usize) -> Self {
        Self { width, sums: Vec::with_capacity(width * rows), guide: Vec::with_capacity(width * rows) }
    }

    /// Adds a row of entries of these weights, and says their sum.
    pub(super) fn push(&mut self, weights: impl Iterator<Item = f64>) -> f64 {
        let first = self.sums.len();
        let mut whole = 0.0;
        self.sums.extend(weights.map(|weight| {
            whole += weight;
            whole
        }));
        let row = &mut self.sums[first..];
        assert_eq!(row.len(), self.width, "each row has as many entries");
        if whole > 0.0 {
            row.iter_mut().for_each(|sum| *sum /= whole);
        }
        let mut entry = 0;
        for part in 0..self.width {
            let begin = part as f64 / self.width as f64;
            while entry + 1 < self.width && row[entry] <= begin {
                entry += 1;
            }
            self.guide.push(entry as u32);
        }
        whole
    }

    /// The entry of each row that its `u` in [0, 1) chooses, and where between the ends of the entry `u` lies, in [0, 1). In loops of one access
    /// to memory each: most accesses miss the cache, and so they do not wait for one another.
    #[inline(always)]
    pub(super) fn choose_each<const W: usize>(&self, rows: &[usize; W], u: &[f64; W]) -> [(usize, f64); W] {
        let mut ranges = [(0, 0); W];
        for k in 0..W {
            ranges[k] = self.guided(rows[k], u[k]);
        }
        let mut first = [0.0; W];
        for k in 0..W {
            first[k] = self.sums[rows[k] * self.width + ranges[k].0];
        }
        let mut chosen = [(0, 0.0); W];
        for k in 0..W {
            chosen[k] = self.within(rows[k], ranges[k], first[k], u[k]);
        }
        chosen
    }

    /// The first and the last entry of a row that `u` may choose.
    #[inline(always)]
    fn guided(&self, row: usize, u: f64) -> (usize, usize) {
        let guide = &self.guide[row * self.width..][..self.width];
        let part = ((u * self.width as f64) as usize).min(self.width - 1);
        // Rounding may put `u` into a neighbour of its part.
        let from = guide[part.saturating_sub(1)] as usize;
        (from, guide.get(part + 2).map_or(self.width - 1, |&after| after as usize))
    }

    /// The entry that `u` chooses among some, the first of which ends at `first`.
    #[inline(always)]
    fn within(&self, row: usize, (from, to): (usize, usize), first: f64, u: f64) -> (usize, f64) {
        let sums = &self.sums[row * self.width..][..self.width];
        let entry =
            if from == to || u < first { from } else { from + 1 + sums[from + 1..to].partition_point(|&sum| sum <= u) };
        let start = if entry == 0 { 0.0 } else { sums[entry - 1] };
        let within = (u - start) / (sums[entry] - start);
        (entry, if within.is_finite() { within.clamp(0.0, f64::ONE_MINUS_EPSILON) } else { 0.5 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Without a guide.
    fn searched(sums: &[f64], u: f64) -> usize {
        sums.partition_point(|&sum| sum <= u).min(sums.len() - 1)
    }

    proptest! {
        /// The guide changes no choice: of any weights, many of them zero and some of them huge, at any number and next to every sum.
        #[test]
        fn the_guide_finds_what_a_search_finds(
            weights in prop::collection::vec(prop_oneof![Just(0.0), 0.0..1.0, Just(1e9), Just(1e-12)], 1..200),
            us in prop::collection::vec(0.0..1.0_f64, 50),
        ) {
            let mut table = Cumulative::new(weights.len(), 2);
            table.push(weights.iter().rev().copied());
            let whole = table.push(weights.iter().copied());
            prop_assert!((whole - weights.iter().sum::<f64>()).abs() <= 1e-12 * whole);
            let sums = table.sums[weights.len()..].to_vec();
            let parts = (0..weights.len()).map(|part| part as f64 / weights.len() as f64);
            let near = sums.iter().copied().chain(parts).flat_map(|sum| [sum.next_down(), sum, sum.next_up()]);
            for u in us.iter().copied().chain(near).filter(|u| (0.0..1.0).contains(u)) {
                let [(entry, within)] = table.choose_each(&[1], &[u]);
                prop_assert_eq!(entry, searched(&sums, u), "{}", u);
                prop_assert!((0.0..1.0).contains(&within));
            }
        }
    }
}
