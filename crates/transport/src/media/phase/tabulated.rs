//! Phase functions of tables, linear in the cosine of the angle between their rows.

use crate::polarisation::mueller::{IDENTITY, Matrix};
use etalon_scene::{PhaseMatrix, PhaseTable};
use std::f64::consts::PI;

/// A table whose integral over the sphere is 1.
#[derive(Clone, Debug)]
pub(super) struct Tabulated {
    cosines: Vec<f64>,
    /// Densities over the cosine there: 2π times those over the sphere.
    densities: Vec<f64>,
    /// The share of light with a smaller cosine.
    below: Vec<f64>,
    /// F₁₁, F₁₂, F₂₂, F₃₃, F₃₄ and F₄₄ there, to any scale.
    matrices: Option<Vec<[f64; 6]>>,
}

impl Tabulated {
    pub(super) fn new(table: &PhaseTable) -> Self {
        let PhaseTable { cosines, values, matrix } = table;
        let mut below = vec![0.0];
        for i in 1..cosines.len() {
            let area = 0.5 * (values[i] + values[i - 1]) * (cosines[i] - cosines[i - 1]);
            below.push(below[i - 1] + area);
        }
        let total = below[below.len() - 1];
        below.iter_mut().for_each(|share| *share /= total);
        let of_row = |matrix: &PhaseMatrix, i: usize| {
            let PhaseMatrix { f12, f22, f33, f34, f44 } = matrix;
            [values, f12, f22, f33, f34, f44].map(|element| element[i])
        };
        let matrices = matrix.as_ref().map(|matrix| (0..values.len()).map(|i| of_row(matrix, i)).collect());
        let densities = values.iter().map(|value| value / total).collect();
        Self { cosines: cosines.clone(), densities, below, matrices }
    }

    /// The row after a cosine, and how far that is from the row before it to this one, in [0, 1].
    #[inline]
    fn place(&self, cos: f64) -> (usize, f64) {
        let i = self.cosines.partition_point(|c| *c <= cos).clamp(1, self.cosines.len() - 1);
        let [from, to] = [self.cosines[i - 1], self.cosines[i]];
        (i, ((cos - from) / (to - from)).clamp(0.0, 1.0))
    }

    #[inline]
    pub(super) fn density(&self, cos: f64) -> f64 {
        let (i, t) = self.place(cos);
        let [first, last] = [self.densities[i - 1], self.densities[i]];
        (first + (last - first) * t) / (2.0 * PI)
    }

    /// What it does to polarisation, over its first element, in frames whose x is across the plane of scattering. The first axis of the
    /// table's frames lies in that plane, so Q has the other sign there. `None` if it depolarises.
    #[inline]
    pub(super) fn mueller(&self, cos: f64) -> Option<Matrix> {
        let rows = self.matrices.as_ref()?;
        let (i, t) = self.place(cos);
        let [f11, f12, f22, f33, f34, f44] =
            std::array::from_fn(|k| rows[i - 1][k] + (rows[i][k] - rows[i - 1][k]) * t);
        if f11 <= 0.0 {
            // No light goes there.
            return Some(IDENTITY);
        }
        let [f12, f22, f33, f34, f44] = [f12, f22, f33, f34, f44].map(|element| element / f11);
        Some([[1.0, -f12, 0.0, 0.0], [-f12, f22, 0.0, 0.0], [0.0, 0.0, f33, f34], [0.0, 0.0, -f34, f44]])
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
