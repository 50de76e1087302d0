//! Phase functions of tables, linear in the cosine of the angle between their rows.

use etalon_scene::PhaseTable;
use std::f64::consts::PI;

/// A table whose integral over the sphere is 1.
#[derive(Clone, Debug)]
pub(super) struct Tabulated {
    cosines: Vec<f64>,
    /// Densities over the cosine there: 2π times those over the sphere.
    densities: Vec<f64>,
    /// The share of light with a smaller cosine.
    below: Vec<f64>,
}

impl Tabulated {
    pub(super) fn new(table: &PhaseTable) -> Self {
        let PhaseTable { cosines, values } = table;
        let mut below = vec![0.0];
        for i in 1..cosines.len() {
            let area = 0.5 * (values[i] + values[i - 1]) * (cosines[i] - cosines[i - 1]);
            below.push(below[i - 1] + area);
        }
        let total = below[below.len() - 1];
        below.iter_mut().for_each(|share| *share /= total);
        Self { cosines: cosines.clone(), densities: values.iter().map(|value| value / total).collect(), below }
    }

    #[inline]
    pub(super) fn density(&self, cos: f64) -> f64 {
        let i = self.cosines.partition_point(|c| *c <= cos).clamp(1, self.cosines.len() - 1);
        let [from, to] = [self.cosines[i - 1], self.cosines[i]];
        let [first, last] = [self.densities[i - 1], self.densities[i]];
        let t = ((cos - from) / (to - from)).clamp(0.0, 1.0);
        (first + (last - first) * t) / (2.0 * PI)
    }

    /// Inverts the distribution, whose density is linear between two rows.
    #[inline]
    pub(super) fn cosine(&self, u: f64) -> f64 {
        let i = self.below.partition_point(|share| *share <= u).clamp(1, self.below.len() - 1);
        let [from, to] = [self.cosines[i - 1], self.cosines[i]];
        let [first, last] = [self.densities[i - 1], self.densities[i]];
        let width = to - from;
        // ½(last − first)/width·x² + first·x = rest, in the form that is exact where both are nearly equal.
        let rest = u - self.below[i - 1];
        let slope = (last - first) / width;
        let root = (first * first + 2.0 * slope * rest).max(0.0).sqrt();
        let sum = first + root;
        let x = if sum > 0.0 { 2.0 * rest / sum } else { 0.0 };
        from + x.min(width)
    }
}
