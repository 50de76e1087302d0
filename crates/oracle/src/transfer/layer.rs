//! Layers of matter between two planes, as matrices: what comes in along each direction, and what leaves along each.

/// A layer that is the same from above and from below.
#[derive(Clone, Debug)]
pub(super) struct Layer {
    /// Radiance that leaves along a direction, for each radiance that comes in along another; weights are included.
    pub(super) reflection: Matrix,
    pub(super) transmission: Matrix,
}

impl Layer {
    /// A thin layer, by the trapezoidal rule: radiance in it is the mean of that at its faces. What scatters without loss loses nothing.
    /// Each row has the cosine of its direction. `onward` and `backward` are the scattering matrices to the same hemisphere and to the other;
    /// columns include the weights of the quadrature.
    pub(super) fn thin(depth: f64, cosines: &[f64], onward: &Matrix, backward: &Matrix) -> Self {
        let count = cosines.len();
        // μ dD/dτ = −D + S₊D + S₋U for light D that goes down and U that goes up, and the same the other way round. Over a layer of the
        // depth δ, with a = 1 + ½δ(1 − S₊)/μ and b = ½δS₋/μ: aD₁ = (2 − a)D₀ + b(U₀ + U₁), aU₀ = (2 − a)U₁ + b(D₀ + D₁).
        let (mut a, mut b) = (Matrix::zero(count), Matrix::zero(count));
        for i in 0..count {
            let half = 0.5 * depth / cosines[i];
            for j in 0..count {
                *a.at(i, j) = -half * onward.row(i)[j];
                *b.at(i, j) = half * backward.row(i)[j];
            }
            *a.at(i, i) += 1.0 + half;
        }
        // No light comes in from below: U₀ = a⁻¹b(D₀ + D₁), and gD₁ = (2 − g)D₀ with g = a − ba⁻¹b.
        let reflected = a.solve(&b);
        let g = a.minus(&b.times(&reflected));
        let twice_inverse = g.solve(&Matrix::one(count).scaled(2.0));
        Self { reflection: reflected.times(&twice_inverse), transmission: twice_inverse.minus(&Matrix::one(count)) }
    }

    /// Puts two of it on each other.
    pub(super) fn double(&mut self) {
        let (r, t) = (&self.reflection, &self.transmission);
        // Down between them, D = (1 − RR)⁻¹T; up, U = RD.
        let down = Matrix::one(r.size).minus(&r.times(r)).solve(t);
        let up = r.times(&down);
        (self.reflection, self.transmission) = (t.times(&up).plus(r), t.times(&down));
    }
}

/// A square matrix, by rows.
#[derive(Clone, Debug)]
pub(super) struct Matrix {
    pub(super) size: usize,
    values: Vec<f64>,
}

impl Matrix {
    pub(super) fn zero(size: usize) -> Self {
        Self { size, values: vec![0.0; size * size] }
    }

    pub(super) fn at(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.values[row * self.size + column]
    }

    pub(super) fn row(&self, row: usize) -> &[f64] {
        &self.values[row * self.size..][..self.size]
    }

    pub(super) fn plus(mut self, other: &Self) -> Self {
        self.values.iter_mut().zip(&other.values).for_each(|(a, b)| *a += b);
        self
    }

    pub(super) fn times(&self, other: &Self) -> Self {
        let mut product = Self::zero(self.size);
        for i in 0..self.size {
            for k in 0..self.size {
                let factor = self.values[i * self.size + k];
                let row = &mut product.values[i * self.size..][..self.size];
                row.iter_mut().zip(other.row(k)).for_each(|(sum, value)| *sum += factor * value);
            }
        }
        product
    }

    pub(super) fn one(size: usize) -> Self {
        let mut one = Self::zero(size);
        (0..size).for_each(|i| *one.at(i, i) = 1.0);
        one
    }

    pub(super) fn scaled(mut self, factor: f64) -> Self {
        self.values.iter_mut().for_each(|value| *value *= factor);
        self
    }

    pub(super) fn minus(mut self, other: &Self) -> Self {
        self.values.iter_mut().zip(&other.values).for_each(|(a, b)| *a -= b);
        self
    }

    /// The solution X of self·X = right, by elimination. The matrices here are 1 and smaller numbers beside it: no pivots are needed.
    pub(super) fn solve(&self, right: &Self) -> Self {
        let (mut left, mut right) = (self.clone(), right.clone());
        let size = self.size;
        for column in 0..size {
            let pivot = left.values[column * size + column];
            for row in 0..size {
                let factor = left.values[row * size + column] / pivot;
                if row == column || factor == 0.0 {
                    continue;
                }
                for k in 0..size {
                    left.values[row * size + k] -= factor * left.values[column * size + k];
                    right.values[row * size + k] -= factor * right.values[column * size + k];
                }
            }
        }
        for row in 0..size {
            let pivot = left.values[row * size + row];
            right.values[row * size..][..size].iter_mut().for_each(|value| *value /= pivot);
        }
        right
    }
}
