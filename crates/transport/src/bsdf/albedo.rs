//! What single scattering between microfacets loses, tabulated when a scene is prepared, and how it is given back.
//!
//! A microfacet model counts light that meets one facet; what meets two is lost, half of it on the roughest metal at grazing
//! angles. Following Kulla & Conty (2017, *Revisiting Physically Based Shading at Imageworks*) the loss 1 − E(µ) of each
//! direction comes back as a diffuse lobe (1 − E(µ_o))(1 − E(µ_i))/(π(1 − E_avg)), which is reciprocal and exactly fills the
//! loss. The table lies below the loss between its nodes too, so that no energy is created: what a lossless surface fails to
//! return is what the table's interpolation misses, which a test bounds.

use super::microfacet::Distribution;
use super::table_store::{SharedTables, Table, Tabulated};
use etalon_optics::{Real, Vec3};
use rayon::prelude::*;
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2};
use std::sync::Arc;

/// Nodes in µ, at (i/(NODES−1))²: dense towards grazing, where the loss changes fastest.
pub(super) const NODES: usize = 81;
/// How far nodes in the relative index η may be apart, where it depends on wavelength: by this much of ln |η − 1|, by which losses change
/// evenly.
const INDEX_STEP: f64 = 0.1;
/// Most of these nodes: of indices that are next to 1, or pass it.
const MOST_INDICES: usize = 17;

/// A loss in [0, 1], linear between nodes in µ, in the relative index η and, of facets of two widths, in the azimuth.
#[derive(Clone, Debug)]
pub(crate) struct LossTable {
    /// The index of the first row, and what one row more adds; 0 for a single row.
    eta: f64,
    step: f64,
    azimuths: Azimuths,
    rows: Vec<Row>,
    /// Cumulative share, up to each node, of loss·µ dµ, the mean over the rows and azimuths: directions are drawn by it.
    cdf: [f64; NODES],
}

/// Nodes in azimuth of a table of facets of two widths.
const TURNS: usize = 13;

/// Azimuths within a quarter turn, which stands for all four: what facets lose is even in x and in y.
///
/// A direction sees slopes as wide as a = √(α_x² cos²φ + α_y² sin²φ). Nodes are at equal steps of √(a − a₀), a₀ the least width: dense
/// where the loss changes fastest, and smooth functions of the azimuth are smooth in it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Azimuths {
    /// One width: no azimuth counts.
    All,
    /// Widths along x and along y.
    Quarter([f64; 2]),
}

impl Azimuths {
    pub(super) fn of(distribution: &Distribution) -> Self {
        match distribution.isotropic_alpha() {
            Some(_) => Self::All,
            None => Self::Quarter(distribution.alpha()),
        }
    }

    /// How many nodes there are.
    pub(super) fn count(self) -> usize {
        match self {
            Self::All => 1,
            Self::Quarter(_) => TURNS,
        }
    }

    /// Where a direction lies between nodes.
    pub(super) fn place(self, w: Vec3<f64>) -> Between {
        let Self::Quarter([x, y]) = self else { return Between { index: 0, share: 0.0 } };
        let (x2, y2) = (w.x * w.x, w.y * w.y);
        let along = x2 + y2;
        // Along the normal all azimuths are one.
        let width = if along > 0.0 { ((x * x * x2 + y * y * y2) / along).sqrt() } else { x };
        let (least, most) = if x < y { (x, y) } else { (y, x) };
        let root = ((width - least) / (most - least)).clamp(0.0, 1.0).sqrt() * (TURNS - 1) as f64;
        let index = (root as usize).min(TURNS - 2);
        Between { index, share: root - index as f64 }
    }

    /// The direction of the cosine `mu` that lies at `place`, in nodes.
    pub(super) fn direction(self, mu: f64, place: f64) -> Vec3<f64> {
        let sin = ((1.0 - mu) * (1.0 + mu)).sqrt_nonnegative();
        let Self::Quarter([x, y]) = self else { return Vec3::new(sin, 0.0, mu) };
        let (least, most) = if x < y { (x, y) } else { (y, x) };
        let root = place / (TURNS - 1) as f64;
        let width = least + (most - least) * root * root;
        // Of the squared sine, what lies along the axis of the greater width.
        let across = (width - least) * (width + least) / ((most - least) * (most + least));
        let (across, rest) = (sin * across.sqrt_nonnegative(), sin * (1.0 - across).sqrt_nonnegative());
        if x < y { Vec3::new(rest, across, mu) } else { Vec3::new(across, rest, mu) }
    }

    /// The share of a turn that a node stands for: the hat that is 1 there and 0 at its neighbours, by the midpoints of many azimuths.
    fn weights(self) -> Vec<f64> {
        const STEPS: u32 = 4096;
        let mut weights = vec![0.0; self.count()];
        if let Self::All = self {
            return vec![1.0];
        }
        for i in 0..STEPS {
            let (sin, cos) = (FRAC_PI_2 * (f64::from(i) + 0.5) / f64::from(STEPS)).sin_cos();
            let Between { index, share } = self.place(Vec3::new(cos, sin, 0.0));
            weights[index] += (1.0 - share) / f64::from(STEPS);
            weights[index + 1] += share / f64::from(STEPS);
        }
        weights
    }
}

/// A table of losses, from where all are kept.
pub(crate) fn shared(
    of: Tabulated,
    distribution: &Distribution,
    eta: [f64; 2],
    make: impl FnOnce() -> LossTable,
) -> Arc<LossTable> {
    static KNOWN: SharedTables<LossTable> = SharedTables::new();
    KNOWN.get(of, distribution, eta, make)
}

#[derive(Clone, Debug)]
struct Row {
    /// At each node in azimuth.
    loss: Vec<[f64; NODES]>,
    /// 2∫ loss·µ dµ, of the interpolated loss, the mean over azimuths.
    average: f64,
}

/// Where an argument lies between nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Between {
    pub(super) index: usize,
    pub(super) share: f64,
}

/// The cosine of a node. From a table: each look-up of a loss asks for two.
pub(super) const fn node(i: usize) -> f64 {
    const ALL: [f64; NODES] = {
        let (mut nodes, mut i) = ([0.0; NODES], 0);
        while i < NODES {
            let x = i as f64 / (NODES - 1) as f64;
            nodes[i] = x * x;
            i += 1;
        }
        nodes
    };
    ALL[i]
}

impl LossTable {
    /// Tabulates `loss(direction, η)`, known to the relative error `error`, for relative indices within `eta`.
    pub(crate) fn new(
        azimuths: Azimuths,
        eta: [f64; 2],
        error: f64,
        loss: impl Fn(Vec3<f64>, f64) -> f64 + Sync,
    ) -> Self {
        let count = if eta[0] == eta[1] { 1 } else { indices(eta) };
        let step = if count == 1 { 0.0 } else { (eta[1] - eta[0]) / (count - 1) as f64 };
        let at = |r: f64| eta[0] + step * r;
        let turns = azimuths.count();
        let row = |r: usize| {
            let value = |k: usize| {
                let wo = azimuths.direction(node(k % NODES).max(1e-6), (k / NODES) as f64);
                loss(wo, at(r as f64)).max(0.0)
            };
            let values: Vec<f64> = (0..turns * NODES).into_par_iter().map(value).collect();
            let loss = values.chunks(NODES).map(|values| std::array::from_fn(|i| values[i])).collect();
            Row { loss, average: 0.0 }
        };
        let rows = (0..count).map(row).collect();
        let mut table = Self { eta: eta[0], step, azimuths, rows, cdf: [0.0; NODES] };
        // Where the table is too high between nodes, these are lowered, which cannot raise it anywhere else. A node keeps the lesser of the
        // shares that its two cells may keep.
        for r in 0..count {
            for &half in if r + 1 < count { &[0.0, 0.5][..] } else { &[0.0] } {
                let eta = at(r as f64 + half);
                for place in (0..2 * turns - 1).map(|k| 0.5 * k as f64) {
                    let exact = |mu: f64| loss(azimuths.direction(mu, place), eta).max(0.0);
                    let share = |(mu, exact): (f64, f64)| {
                        let held = table.eval(azimuths.direction(mu, place), eta);
                        if held > exact { exact / held } else { 1.0 }
                    };
                    let kept_by =
                        |i: usize| table.checks(i, place, eta, exact).into_iter().map(share).fold(1.0, f64::min);
                    let cells: Vec<f64> = (1..NODES).into_par_iter().map(kept_by).collect();
                    let kept = |i: usize| cells[i.max(1) - 1].min(cells[i.min(NODES - 2)]);
                    let rows = &mut table.rows[r..=if half > 0.0 { r + 1 } else { r }];
                    let turns = place.floor() as usize..=place.ceil() as usize;
                    for loss in rows.iter_mut().flat_map(|row| &mut row.loss[turns.clone()]) {
                        loss.iter_mut().enumerate().for_each(|(i, v)| *v *= kept(i));
                    }
                }
            }
        }
        let weights = azimuths.weights();
        let mean_cell = |row: &Row, i: usize| -> f64 {
            weights.iter().zip(&row.loss).map(|(weight, loss)| weight * cell(loss, i)).sum()
        };
        for row in &mut table.rows {
            row.loss.iter_mut().flatten().for_each(|v| *v *= 1.0 - error);
            row.average = (1..NODES).map(|i| mean_cell(row, i)).sum();
        }
        let mean: f64 = table.rows.iter().map(|row| row.average).sum();
        for i in 1..NODES {
            let share: f64 = table.rows.iter().map(|row| mean_cell(row, i)).sum();
            // Nothing is lost: nothing is ever drawn.
            table.cdf[i] = table.cdf[i - 1] + if mean > 0.0 { share / mean } else { 0.0 };
        }
        table.cdf[NODES - 1] = 1.0;
        table
    }

    /// Cosines between nodes `i − 1` and `i`, and what `exact` says there: among them about where the table is most too high.
    ///
    /// A chord of a smooth curve differs from it as a parabola with its top in the middle does, so three cosines tell. Where they do not
    /// lie on one, as at a kink, the place is searched by golden sections.
    fn checks(&self, i: usize, place: f64, eta: f64, exact: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        const SECTIONS: usize = 8;
        // A third of what a table may hold too much in a single direction.
        const ON_PARABOLA: f64 = 3e-5;
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        let mut checks = Vec::with_capacity(3);
        let mut excess = |share: f64| {
            let mu = node(i - 1) + share * (node(i) - node(i - 1));
            checks.push((mu, exact(mu)));
            self.eval(self.azimuths.direction(mu, place), eta) - checks[checks.len() - 1].1
        };
        let found = [0.25, 0.5, 0.75].map(&mut excess);
        if [found[0], found[2]].iter().any(|side| (side - 0.75 * found[1]).abs() > ON_PARABOLA) {
            let highest = (0..3).max_by(|&a, &b| found[a].total_cmp(&found[b])).expect("there are three");
            let (mut from, mut to) = (0.25 * highest as f64, 0.25 * highest as f64 + 0.5);
            let inner = |from: f64, to: f64| [to - golden * (to - from), from + golden * (to - from)];
            let mut at = inner(from, to);
            let mut values = at.map(&mut excess);
            for _ in 0..SECTIONS {
                if values[0] > values[1] {
                    (to, at) = (at[1], inner(from, at[1]));
                    values = [excess(at[0]), values[0]];
                } else {
                    (from, at) = (at[0], inner(at[0], to));
                    values = [values[1], excess(at[1])];
                }
            }
        }
        checks
    }

    /// A direction (z > 0) whose cosine follows loss·µ: uniform in µ² between two nodes.
    pub(crate) fn sample(&self, u: [f64; 2]) -> Vec3<f64> {
        let i = self.cdf.partition_point(|c| *c <= u[0]).clamp(1, NODES - 1);
        let within = (u[0] - self.cdf[i - 1]) / (self.cdf[i] - self.cdf[i - 1]);
        let (a2, b2) = (node(i - 1) * node(i - 1), node(i) * node(i));
        let z2 = a2 + (b2 - a2) * within;
        let (sin_phi, cos_phi) = f64::sin_cos_turns(u[1]);
        let sin = (1.0 - z2).sqrt_nonnegative();
        Vec3::new(sin * cos_phi, sin * sin_phi, z2.sqrt())
    }

    /// The density of [`LossTable::sample`] at the cosine `mu`, sr⁻¹.
    pub(crate) fn density(&self, mu: f64) -> f64 {
        let i = cell_of(mu);
        let (a2, b2) = (node(i) * node(i), node(i + 1) * node(i + 1));
        (self.cdf[i + 1] - self.cdf[i]) / (b2 - a2) * mu * FRAC_1_PI
    }

    fn row(&self, eta: f64) -> Between {
        if self.rows.len() == 1 {
            return Between { index: 0, share: 0.0 };
        }
        let x = ((eta - self.eta) / self.step).clamp(0.0, (self.rows.len() - 1) as f64);
        let index = (x as usize).min(self.rows.len() - 2);
        Between { index, share: x - index as f64 }
    }

    /// The loss, in [0, 1], in a direction on either side of the surface, at the relative index `eta`.
    pub(crate) fn eval(&self, w: Vec3<f64>, eta: f64) -> f64 {
        let mu = w.z.abs();
        let i = cell_of(mu);
        let share = ((mu - node(i)) / (node(i + 1) - node(i))).min(1.0);
        let along = |loss: &[f64; NODES]| loss[i] + share * (loss[i + 1] - loss[i]);
        let turn = self.azimuths.place(w);
        self.between(eta, |row| {
            let first = along(&row.loss[turn.index]);
            if turn.share == 0.0 { first } else { first + turn.share * (along(&row.loss[turn.index + 1]) - first) }
        })
    }

    /// 2∫ loss·µ dµ.
    pub(crate) fn average(&self, eta: f64) -> f64 {
        self.between(eta, |row| row.average)
    }

    fn between(&self, eta: f64, value: impl Fn(&Row) -> f64) -> f64 {
        let Between { index, share } = self.row(eta);
        let first = value(&self.rows[index]);
        if share == 0.0 { first } else { first + share * (value(&self.rows[index + 1]) - first) }
    }
}

impl Table for LossTable {
    const SORT: &'static str = "losses";

    fn to_numbers(&self) -> Vec<f64> {
        let of_row = |row: &Row| [&[row.average], row.loss.as_flattened()].concat();
        [&[self.eta, self.step], &self.cdf[..], &self.rows.iter().flat_map(of_row).collect::<Vec<f64>>()].concat()
    }

    fn from_numbers(numbers: &[f64], distribution: &Distribution) -> Option<Self> {
        let azimuths = Azimuths::of(distribution);
        let (&[eta, step], numbers) = numbers.split_first_chunk()?;
        let (&cdf, numbers) = numbers.split_first_chunk()?;
        let rows = numbers.chunks(1 + azimuths.count() * NODES).map(|row| {
            let (&average, row) = row.split_first()?;
            Some(Row { loss: all_turns(row, azimuths)?, average })
        });
        let rows: Vec<Row> = rows.collect::<Option<_>>()?;
        (!rows.is_empty()).then_some(Self { eta, step, azimuths, rows, cdf })
    }
}

/// A row of a table: the values of each azimuth, one after the other. `None` if there are more or fewer.
pub(super) fn all_turns<T: Copy>(values: &[T], azimuths: Azimuths) -> Option<Vec<[T; NODES]>> {
    let (turns, rest) = values.as_chunks();
    (rest.is_empty() && turns.len() == azimuths.count()).then(|| turns.to_vec())
}

/// The least and the greatest of a positive, smooth function of the wavelength within `range_nm`, at 65 places: the relative indices that a
/// table is to hold.
pub(super) fn extremes([first, last]: [f64; 2], of: impl Fn(f64) -> f64) -> [f64; 2] {
    (0..=64)
        .map(|i| of(first + (last - first) * f64::from(i) / 64.0))
        .fold([f64::MAX, 0.0_f64], |[least, most], value| [least.min(value), most.max(value)])
}

/// Nodes that a range of relative indices needs.
fn indices([first, last]: [f64; 2]) -> usize {
    let range = ((last - 1.0) / (first - 1.0)).abs().ln().abs();
    let passes = (first - 1.0) * (last - 1.0) <= 0.0;
    if passes { MOST_INDICES } else { (2 + (range / INDEX_STEP) as usize).min(MOST_INDICES) }
}

/// The cell of a cosine: it lies between nodes `i` and `i + 1`.
fn cell_of(mu: f64) -> usize {
    ((mu.sqrt() * (NODES - 1) as f64) as usize).min(NODES - 2)
}

/// 2∫ v·µ dµ between nodes `i − 1` and `i` of values that are linear there: Simpson's rule is exact.
fn cell(values: &[f64; NODES], i: usize) -> f64 {
    let (a, b) = (node(i - 1), node(i));
    let (fa, fb) = (values[i - 1], values[i]);
    2.0 * (b - a) / 6.0 * (fa * a + (fa + fb) * (a + b) + fb * b)
}
