//! Tables of functions on the unit square, and the slices of such a table for some angles of the light.

/// Functions on the unit square, one after the other (slices). Each is given at the nodes of a grid that reaches from edge to edge, and is
/// bilinear in each cell between four of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Nodes along x and along y, each at least 2.
    size: [usize; 2],
    /// x runs first, then y, then the slices.
    values: Vec<f32>,
}

/// A cell of a grid, and a place in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    /// Its column and its row.
    pub(super) index: [usize; 2],
    /// How far along x and y, from 0 to 1.
    pub(super) share: [f64; 2],
}

/// Neighbouring slices of a table, each with its weight. The weights are not negative, and their sum is 1.
#[derive(Clone, Copy, Debug)]
pub struct Slices {
    slices: [(usize, f64); 4],
    count: usize,
}

impl Slices {
    /// The slices at a place among the nodes of two parameters, of which the second runs first.
    pub(super) fn of(nodes: [&[f64]; 2], place: [f64; 2]) -> Self {
        let mut of = Self { slices: [(0, 0.0); 4], count: 0 };
        for (first, weight) in neighbours(nodes[0], place[0]) {
            for (second, share) in neighbours(nodes[1], place[1]) {
                if weight * share > 0.0 {
                    of.slices[of.count] = (first * nodes[1].len() + second, weight * share);
                    of.count += 1;
                }
            }
        }
        of
    }

    /// The sum over the slices of what `of` says of each, by their weights.
    #[inline]
    pub(super) fn mean(&self, of: impl Fn(usize) -> f64) -> f64 {
        self.slices[..self.count].iter().map(|(slice, weight)| weight * of(*slice)).sum()
    }
}

/// The nodes on both sides of a place, each with its weight in linear interpolation. Beyond the first and the last node their values hold.
pub(super) fn neighbours(nodes: &[f64], place: f64) -> [(usize, f64); 2] {
    let second = nodes.partition_point(|node| *node <= place);
    if second == 0 || second == nodes.len() {
        let end = second.saturating_sub(1);
        return [(end, 1.0), (end, 0.0)];
    }
    let [from, to] = [nodes[second - 1], nodes[second]];
    let share = (place - from) / (to - from);
    [(second - 1, 1.0 - share), (second, share)]
}

impl Table {
    /// Functions at `size` nodes along x and y.
    ///
    /// # Errors
    /// A sentence that says what is wrong; `name` is that of the table.
    pub(super) fn new(name: &str, size: [usize; 2], slices: usize, values: Vec<f32>) -> Result<Self, String> {
        if size.iter().any(|nodes| *nodes < 2) {
            return Err(format!(
                "\"{name}\" has {} × {} values at each angle; it needs 2 × 2 or more",
                size[0], size[1]
            ));
        }
        let needed = size.iter().try_fold(slices, |needed, nodes| needed.checked_mul(*nodes));
        if needed != Some(values.len()) {
            return Err(format!(
                "\"{name}\" needs {slices} × {} × {} values, but has {}",
                size[1],
                size[0],
                values.len()
            ));
        }
        if let Some(place) = values.iter().position(|value| !value.is_finite()) {
            return Err(format!("value {place} of \"{name}\" is {}: it is not finite", values[place]));
        }
        Ok(Self { size, values })
    }

    /// That no value is below 0.
    ///
    /// # Errors
    /// A sentence that says which is.
    pub(super) fn check_sign(self, name: &str) -> Result<Self, String> {
        match self.values.iter().position(|value| *value < 0.0) {
            Some(place) => Err(format!("value {place} of \"{name}\" is {}: it must be 0 or above", self.values[place])),
            None => Ok(self),
        }
    }

    /// Nodes along x and along y.
    pub(super) fn size(&self) -> [usize; 2] {
        self.size
    }

    /// The values of each slice.
    pub(super) fn slices(&self) -> impl Iterator<Item = &[f32]> {
        self.values.chunks_exact(self.size[0] * self.size[1])
    }

    /// The value of a slice at a node.
    #[inline]
    pub(super) fn node(&self, slice: usize, x: usize, y: usize) -> f64 {
        f64::from(self.values[(slice * self.size[1] + y) * self.size[0] + x])
    }

    /// The cell of a place in the square.
    #[inline]
    pub(super) fn cell(&self, place: [f64; 2]) -> Cell {
        let along = |k: usize| {
            let cells = self.size[k] - 1;
            let at = place[k] * cells as f64;
            let index = (at as usize).min(cells - 1);
            (index, at - index as f64)
        };
        let [(column, x), (row, y)] = [0, 1].map(along);
        Cell { index: [column, row], share: [x, y] }
    }

    /// The bilinear function of a slice at a place in a cell.
    #[inline]
    pub(super) fn bilinear(&self, slice: usize, cell: Cell) -> f64 {
        let ([column, row], [x, y]) = (cell.index, cell.share);
        let along = |row| {
            let [from, to] = [self.node(slice, column, row), self.node(slice, column + 1, row)];
            from + x * (to - from)
        };
        let [below, above] = [along(row), along(row + 1)];
        below + y * (above - below)
    }

    /// The function of a table with one slice, at a place in the square.
    #[inline]
    pub fn eval(&self, place: [f64; 2]) -> f64 {
        self.bilinear(0, self.cell(place))
    }
}
