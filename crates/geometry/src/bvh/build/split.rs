//! Where a node is split.

use super::span::{Extent, Item, Span};
use crate::level::Loop;

/// Above this many primitives a node is split between bins, below at any of their sorted centres.
pub(super) const SWEEP_LIMIT: usize = 64;
/// Bins an axis.
const BINS: usize = 32;
/// Items that are compared at once.
const ROW: usize = 16;

/// What the heuristic weighs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Costs {
    /// Primitives that a leaf tests at the cost of one.
    pub(crate) block: u32,
    /// Cost of visiting a node, in units of testing a block.
    pub(crate) node: f32,
}

impl Costs {
    /// Cost of testing some primitives whose box is this.
    #[inline(always)]
    pub(super) fn leaf(self, bounds: Span, count: usize) -> f32 {
        let block = if bounds.is_instance_leaf() { 1 } else { self.block };
        (count as u32).div_ceil(block) as f32
    }
}

/// A split that the heuristic found.
pub(super) struct Split {
    pub(super) cost: f32,
    axis: usize,
    position: Position,
}

pub(super) enum Position {
    /// Twice-centres below this bin go left.
    Bin(BinMap, usize),
    /// This many of the primitives, in this order, go left.
    Rank(usize, Order),
}

/// The places of up to [`SWEEP_LIMIT`] primitives, in some order.
pub(super) type Order = [u8; SWEEP_LIMIT];

/// Maps twice-centres to bins.
#[derive(Clone, Copy)]
pub(super) struct BinMap {
    lower: f32,
    per_unit: f32,
}

impl BinMap {
    fn new(lower: f32, upper: f32) -> Option<Self> {
        let per_unit = BINS as f32 * (1.0 - f32::EPSILON) / (upper - lower);
        (upper > lower && per_unit.is_finite()).then_some(Self { lower, per_unit })
    }

    /// The bin of a twice-centre that is not below the lowest.
    #[inline(always)]
    fn bin(self, centre2: f32) -> usize {
        // Rounded to an integer as the last bits of a number whose last bit counts ones, which is done sooner than a conversion that
        // knows of all numbers.
        const ONES: f32 = 1.5 * (1 << 23) as f32;
        let rounded = ((centre2 - self.lower) * self.per_unit - 0.5) + ONES;
        (rounded.to_bits() as usize % (2 * BINS)).min(BINS - 1)
    }
}

/// The split between bins that costs least, of items and their extent; none if no plane separates their centres.
pub(super) struct Bins<'a>(pub(super) Costs, pub(super) &'a [Item], pub(super) &'a Extent);

impl Loop for Bins<'_> {
    type Output = Option<Split>;

    #[inline(always)]
    fn run(self) -> Option<Split> {
        let Self(costs, items, extent) = self;
        let maps: [Option<BinMap>; 3] =
            [0, 1, 2].map(|k| BinMap::new(extent.centres.lower(k), extent.centres.upper(k)));
        // An axis without a map has one bin.
        let all = maps.map(|map| map.unwrap_or(BinMap { lower: 0.0, per_unit: 0.0 }));
        let (mut spans, mut counts) = ([[Span::EMPTY; BINS]; 3], [[0_u32; BINS]; 3]);
        for item in items {
            let centre2 = item.span().centre2();
            for k in 0..3 {
                let bin = all[k].bin(centre2[k]);
                spans[k][bin].add(item.span());
                counts[k][bin] += 1;
            }
        }
        let mut best: Option<Split> = None;
        for k in 0..3 {
            let Some(map) = maps[k] else { continue };
            let mut right = [(0.0_f32, 0_u32); BINS];
            let mut sum = (Span::EMPTY, 0);
            for bin in (1..BINS).rev() {
                sum = (sum.0.union(spans[k][bin]), sum.1 + counts[k][bin]);
                right[bin] = (sum.0.half_area() * costs.leaf(sum.0, sum.1 as usize), sum.1);
            }
            let mut sum = (Span::EMPTY, 0);
            for bin in 1..BINS {
                sum = (sum.0.union(spans[k][bin - 1]), sum.1 + counts[k][bin - 1]);
                if sum.1 == 0 || right[bin].1 == 0 {
                    continue;
                }
                let cost = sum.0.half_area() * costs.leaf(sum.0, sum.1 as usize) + right[bin].0;
                if best.as_ref().is_none_or(|b| cost < b.cost) {
                    best = Some(Split { cost, axis: k, position: Position::Bin(map, bin) });
                }
            }
        }
        best
    }
}

/// The split anywhere in the order of their centres that costs least, of up to [`SWEEP_LIMIT`] items and their extent; none if no
/// plane separates their centres.
pub(super) struct Sweep<'a>(pub(super) Costs, pub(super) &'a [Item], pub(super) &'a Extent);

impl Loop for Sweep<'_> {
    type Output = Option<Split>;

    #[inline(always)]
    fn run(self) -> Option<Split> {
        let Self(costs, items, extent) = self;
        let mut best: Option<(f32, usize, usize)> = None;
        let mut orders = [[0; SWEEP_LIMIT]; 3];
        let mut right = [0.0_f32; SWEEP_LIMIT];
        for k in 0..3 {
            if extent.centres.lower(k) >= extent.centres.upper(k) {
                continue;
            }
            let order = &mut orders[k];
            sort(items, k, order);
            let order = &order[..items.len()];
            let at = |rank: usize| items[usize::from(order[rank])].span();
            let mut sum = Span::EMPTY;
            for rank in (1..order.len()).rev() {
                sum = sum.union(at(rank));
                right[rank] = sum.half_area() * costs.leaf(sum, order.len() - rank);
            }
            let mut sum = Span::EMPTY;
            for rank in 1..order.len() {
                sum = sum.union(at(rank - 1));
                let cost = sum.half_area() * costs.leaf(sum, rank) + right[rank];
                if best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, k, rank));
                }
            }
        }
        best.map(|(cost, axis, rank)| Split { cost, axis, position: Position::Rank(rank, orders[axis]) })
    }
}

/// The places of items in the order of their centres along an axis; equal ones keep their order.
///
/// Each is compared with each: of so few that is done sooner, in vectors, than branches that nothing foretells sort them.
#[inline(always)]
fn sort(items: &[Item], axis: usize, order: &mut Order) {
    let count = items.len();
    // Those that are missing come last.
    let mut centres = [f32::INFINITY; SWEEP_LIMIT];
    for (centre, item) in centres.iter_mut().zip(items) {
        *centre = item.centre2(axis);
    }
    // How many are less.
    let mut ranks = [0_u32; SWEEP_LIMIT];
    let rows = count.div_ceil(ROW);
    for &other in &centres[..count] {
        let (rank_rows, centre_rows) = (ranks.as_chunks_mut::<ROW>().0, centres.as_chunks::<ROW>().0);
        for (ranks, centres) in rank_rows.iter_mut().zip(centre_rows).take(rows) {
            for i in 0..ROW {
                ranks[i] += u32::from(other < centres[i]);
            }
        }
    }
    let mut taken = [0_u8; SWEEP_LIMIT];
    for (place, &rank) in ranks[..count].iter().enumerate() {
        let rank = rank as usize % SWEEP_LIMIT;
        order[(rank + usize::from(taken[rank])) % SWEEP_LIMIT] = place as u8;
        taken[rank] += 1;
    }
}

/// Puts the left items before the right ones, counts them and measures both.
pub(super) struct Partition<'a>(pub(super) &'a mut [Item], pub(super) Option<Split>, pub(super) &'a Extent);

impl Loop for Partition<'_> {
    type Output = (usize, [Extent; 2]);

    #[inline(always)]
    fn run(self) -> (usize, [Extent; 2]) {
        let Self(items, split, extent) = self;
        let rank = match split {
            Some(Split { axis, position: Position::Bin(map, bin), .. }) => {
                let (mut left, mut right) = (Extent::EMPTY, Extent::EMPTY);
                let (mut i, mut j) = (0, items.len());
                while i < j {
                    if map.bin(items[i].centre2(axis)) < bin {
                        left.add(&items[i]);
                        i += 1;
                    } else {
                        right.add(&items[i]);
                        j -= 1;
                        items.swap(i, j);
                    }
                }
                return (i, [left, right]);
            }
            Some(Split { position: Position::Rank(rank, order), .. }) => {
                let mut sorted = [items[0]; SWEEP_LIMIT];
                let sorted = &mut sorted[..items.len()];
                for (item, &place) in sorted.iter_mut().zip(&order) {
                    *item = items[usize::from(place)];
                }
                items.copy_from_slice(sorted);
                rank
            }
            None => {
                // No plane separates the centres, or the tree is too deep: halve.
                let size = |k: usize| extent.centres.upper(k) - extent.centres.lower(k);
                let axis = (1..3).fold(0, |best, k| if size(k) > size(best) { k } else { best });
                let half = items.len() / 2;
                items.select_nth_unstable_by_key(half, |item| item.key(axis));
                half
            }
        };
        (rank, [Extent::of(&items[..rank]), Extent::of(&items[rank..])])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Box32;
    use crate::test_support::Random;

    #[test]
    fn items_are_sorted_as_a_stable_sort_sorts_them() {
        let mut random = Random::new(7);
        for count in 1..=SWEEP_LIMIT {
            // Few values, so that many are equal, both zeros among them.
            let values = [0.0, -0.0, 1.0, 2.5, -3.0, 1e-30, 1e30];
            let items: Vec<Item> = (0..count as u32)
                .map(|id| {
                    let x = values[(values.len() as f64 * random.unit()) as usize];
                    Item::new(&Box32 { min: [x, 0.0, 0.0], max: [x, 1.0, 1.0] }, id, false)
                })
                .collect();
            let mut order = [0; SWEEP_LIMIT];
            sort(&items, 0, &mut order);
            let mut places: Vec<u8> = (0..count as u8).collect();
            let centre = |place: u8| items[usize::from(place)].centre2(0);
            places.sort_by(|&a, &b| centre(a).partial_cmp(&centre(b)).unwrap());
            assert_eq!(order[..count], places);
        }
    }

    #[test]
    fn bins_rise_with_the_centre_and_hold_a_share_of_the_range_each() {
        let mut random = Random::new(8);
        for _ in 0..200 {
            let lower = 10.0 * random.unit() as f32 - 5.0;
            let upper = lower + 10_f64.powf(-random.unit()) as f32;
            let map = BinMap::new(lower, upper).unwrap();
            assert_eq!([map.bin(lower), map.bin(upper)], [0, BINS - 1]);
            let (mut last, mut counts) = (0, [0; BINS]);
            for i in 0..=32_000 {
                let centre2 = (lower + (upper - lower) * (i as f32 / 32_000.0)).clamp(lower, upper);
                let bin = map.bin(centre2);
                assert!(bin >= last, "{bin} after {last}");
                last = bin;
                counts[bin] += 1;
            }
            // A range is 200,000 steps of the numbers and more, so that a bin holds a thousand of these to a few.
            assert!(counts.iter().all(|&n| (900..=1100).contains(&n)), "{counts:?}");
        }
    }
}
