//! Smooth spectra in [0, 1] with three coefficients (Jakob & Hanika 2019), and the search for those of a colour.
//!
//! Wenzel Jakob and Johannes Hanika, *A Low-Dimensional Function Space for Efficient Spectral Upsampling*, Computer
//! Graphics Forum 38(2), 2019: s(λ) = ½ + p(λ)/(2√(1 + p(λ)²)) with a quadratic p. The coefficients are solved for here,
//! not read from a table: Newton's method, continued from the grey of the same mean.

use crate::colour::CIE_RANGE_NM;

/// Centre and half width of the range over which the quadratic's argument runs from −1 to 1, nm.
const CENTRE_NM: f64 = (CIE_RANGE_NM[0] + CIE_RANGE_NM[1]) / 2.0;
const HALF_WIDTH_NM: f64 = (CIE_RANGE_NM[1] - CIE_RANGE_NM[0]) / 2.0;

/// s(c₀ + c₁t + c₂t²) with t = (λ − 595 nm)/235 nm and s(p) = ½ + p/(2√(1 + p²)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sigmoid {
    /// Coefficients of 1, t, t².
    pub coefficients: [f64; 3],
}

/// ½ + p/(2√(1 + p²)), without cancellation for large negative p.
#[inline(always)]
fn sigmoid(p: f64) -> f64 {
    let root = (1.0 + p * p).sqrt();
    let below = 0.5 / (root * (root + p.abs()));
    if p < 0.0 { below } else { 1.0 - below }
}

/// The p at which the sigmoid is `v` in (0, 1).
fn inverse_sigmoid(v: f64) -> f64 {
    (v - 0.5) / (v * (1.0 - v)).sqrt()
}

#[inline(always)]
fn argument(wavelength_nm: f64) -> f64 {
    (wavelength_nm - CENTRE_NM) / HALF_WIDTH_NM
}

impl Sigmoid {
    /// Value at a wavelength in nm, in [0, 1]: one square root and one division.
    #[inline(always)]
    pub fn eval(&self, wavelength_nm: f64) -> f64 {
        let [c0, c1, c2] = self.coefficients;
        let t = argument(wavelength_nm);
        sigmoid(c0 + t * (c1 + t * c2))
    }

    /// The largest value over a closed range, nm: at an end or at the vertex of the quadratic.
    pub fn max_over(&self, range_nm: [f64; 2]) -> f64 {
        let [_, c1, c2] = self.coefficients;
        let ends = self.eval(range_nm[0]).max(self.eval(range_nm[1]));
        let vertex = CENTRE_NM - HALF_WIDTH_NM * c1 / (2.0 * c2);
        if vertex > range_nm[0] && vertex < range_nm[1] { ends.max(self.eval(vertex)) } else { ends }
    }
}

/// Linear maps from a spectrum, by its values at 360, 361, … nm, to three numbers.
pub(super) type Observer = [[f64; 3]];

/// The sigmoid whose three numbers under `observer` come closest to `target`, and how far off the worst of them is.
///
/// `target` must lie within (0, 1) times what the spectrum 1 gives, or at its border; the mean must be above 0.
pub(super) fn fit(observer: &Observer, target: [f64; 3]) -> (Sigmoid, f64) {
    let scale = target.iter().copied().fold(0.0, f64::max);
    let grey = (target.iter().sum::<f64>() / 3.0).clamp(1e-9, 1.0 - 1e-9);
    let mut at = [inverse_sigmoid(grey), 0.0, 0.0];
    // Continuation from grey (done = 0) to the target (done = 1) keeps every start close to its solution; a colour at
    // the border of the reachable ones makes the steps shrink, and the search stops where it no longer helps.
    let (mut done, mut step) = (0.0_f64, 0.25_f64);
    while done < 1.0 && step > 1e-5 {
        let next = (done + step).min(1.0);
        let goal = target.map(|v| grey + next * (v - grey));
        let (found, error) = newton(observer, goal, at);
        if error <= 1e-6 * scale {
            (at, done, step) = (found, next, 1.5 * step);
        } else {
            step *= 0.4;
        }
    }
    let (found, error) = newton(observer, target, at);
    (Sigmoid { coefficients: found }, error)
}

/// Newton's method with a line search; the best coefficients found and their largest residual.
fn newton(observer: &Observer, target: [f64; 3], start: [f64; 3]) -> ([f64; 3], f64) {
    let mut at = start;
    let (mut residual, mut jacobian) = residual_and_jacobian(observer, target, at);
    for _ in 0..40 {
        let Some(direction) = solve(jacobian, residual) else { break };
        let mut length = 1.0;
        let improved = loop {
            let trial: [f64; 3] = std::array::from_fn(|i| at[i] - length * direction[i]);
            let (r, j) = residual_and_jacobian(observer, target, trial);
            if square(r) < square(residual) {
                (at, residual, jacobian) = (trial, r, j);
                break true;
            }
            length *= 0.5;
            if length < 1e-4 {
                break false;
            }
        };
        if !improved || largest(residual) == 0.0 {
            break;
        }
    }
    (at, largest(residual))
}

fn square(v: [f64; 3]) -> f64 {
    // NaN (coefficients that overflowed) must never look like an improvement.
    let sum = v.iter().map(|x| x * x).sum::<f64>();
    if sum.is_nan() { f64::INFINITY } else { sum }
}

fn largest(v: [f64; 3]) -> f64 {
    v.iter().fold(0.0, |max, x| x.abs().max(max))
}

/// What `observer` sees of the sigmoid less `target`, and its derivatives: `jacobian[row][coefficient]`.
fn residual_and_jacobian(observer: &Observer, target: [f64; 3], at: [f64; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
    let mut residual = target.map(|v| -v);
    let mut jacobian = [[0.0; 3]; 3];
    for (i, weights) in observer.iter().enumerate() {
        let t = argument(CIE_RANGE_NM[0] + i as f64);
        let p = at[0] + t * (at[1] + t * at[2]);
        let root = (1.0 + p * p).sqrt();
        let value = sigmoid(p);
        let slope = 0.5 / (root * root * root);
        for row in 0..3 {
            residual[row] += weights[row] * value;
            let w = weights[row] * slope;
            jacobian[row][0] += w;
            jacobian[row][1] += w * t;
            jacobian[row][2] += w * t * t;
        }
    }
    (residual, jacobian)
}

/// Solves a 3 × 3 system by elimination with row pivoting; `None` if it is singular.
fn solve(mut m: [[f64; 3]; 3], mut v: [f64; 3]) -> Option<[f64; 3]> {
    for column in 0..3 {
        let pivot = (column..3).max_by(|&a, &b| m[a][column].abs().total_cmp(&m[b][column].abs()))?;
        m.swap(column, pivot);
        v.swap(column, pivot);
        if m[column][column] == 0.0 || !m[column][column].is_finite() {
            return None;
        }
        for row in column + 1..3 {
            let factor = m[row][column] / m[column][column];
            for k in column..3 {
                m[row][k] -= factor * m[column][k];
            }
            v[row] -= factor * v[column];
        }
    }
    let z = v[2] / m[2][2];
    let y = (v[1] - m[1][2] * z) / m[1][1];
    let x = (v[0] - m[0][1] * y - m[0][2] * z) / m[0][0];
    let solution = [x, y, z];
    solution.iter().all(|s| s.is_finite()).then_some(solution)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sigmoid_is_accurate_in_both_tails() {
        // s(p) ≈ 1/(4p²) − 3/(16p⁴) for large negative p; the next term is 1e-24 of it.
        let p = -1e4_f64;
        let expected = 0.25 / (p * p) - 3.0 / 16.0 / p.powi(4);
        assert!((sigmoid(p) / expected - 1.0).abs() < 1e-15);
        assert_eq!(sigmoid(0.0), 0.5);
        assert_eq!(sigmoid(f64::MAX.sqrt()), 1.0);
        for i in -100..=100 {
            let p = f64::from(i) / 10.0;
            assert!((sigmoid(p) + sigmoid(-p) - 1.0).abs() < 2e-16);
            assert!((inverse_sigmoid(sigmoid(p)) - p).abs() < 1e-11 * (1.0 + p * p * p.abs()));
        }
    }
}
