//! Deterministic integration: the second opinion on closed forms, and the referee of densities.

mod steps;

use std::{cmp::Ordering, collections::BinaryHeap};

use crate::vector::{Vec3, add, frame, normalize, scale};

pub(crate) use steps::{Clue, nonnegative};

/// The n-point Gauss–Legendre rule over (0, 1).
#[must_use]
pub fn gauss_legendre_half(n: usize) -> Vec<(f64, f64)> {
    gauss_legendre(n).iter().map(|(x, w)| (0.5 * (1.0 + x), 0.5 * w)).collect()
}

/// Nodes in (−1, 1) and weights of the n-point Gauss–Legendre rule, by Newton's method on the Legendre recurrence.
#[must_use]
pub fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let count = n as f64;
    (0..n)
        .map(|i| {
            // Tricomi's first guess converges for every n.
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (count + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..20 {
                let (mut previous, mut value) = (1.0, x);
                for k in 2..=n {
                    let k = k as f64;
                    (previous, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * previous) / k);
                }
                slope = count * (x * value - previous) / (x * x - 1.0);
                let step = value / slope;
                x -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// A definite integral and an estimate of its absolute error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integral {
    /// The value.
    pub value: f64,
    /// Estimated absolute error; the true one is usually far smaller.
    pub error: f64,
}

/// ∫ f over [a, b], adaptively to an absolute tolerance (or to rounding, or 1e5 evaluations: the error says which).
pub fn interval(mut f: impl FnMut(f64) -> f64, a: f64, b: f64, tolerance: f64) -> Integral {
    let (fine, coarse) = (gauss_legendre(12), gauss_legendre(7));
    let mut rule = |a: f64, b: f64| {
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        let mut apply = |rule: &[(f64, f64)]| rule.iter().map(|(x, w)| w * f(middle + half * x)).sum::<f64>() * half;
        let value = apply(&fine);
        (value, (value - apply(&coarse)).abs())
    };
    adapt([[a, b, 0.0, 0.0]], |cell| rule(cell[0], cell[1]), bisect, |_| tolerance, 100_000 / 19, 0.0)
}

/// ∫∫ f over [a, b] × [c, d], adaptively.
pub fn rectangle(
    f: impl FnMut(f64, f64) -> f64,
    [a, b]: [f64; 2],
    [c, d]: [f64; 2],
    tolerance: f64,
    evaluations: usize,
) -> Integral {
    rectangles(f, [[a, b, c, d]], tolerance, evaluations)
}

fn rectangles(
    mut f: impl FnMut(f64, f64) -> f64,
    cells: impl IntoIterator<Item = [f64; 4]>,
    tolerance: f64,
    evaluations: usize,
) -> Integral {
    let (fine, coarse) = (gauss_legendre(FINE), LOBATTO);
    let per_cell = fine.len() * fine.len() + coarse.len() * coarse.len();
    let mut rule = |[a, b, c, d]: [f64; 4]| {
        let (mx, hx, my, hy) = (0.5 * (a + b), 0.5 * (b - a), 0.5 * (c + d), 0.5 * (d - c));
        let mut apply = |rule: &[(f64, f64)]| {
            let mut sum = 0.0;
            for (x, wx) in rule {
                for (y, wy) in rule {
                    sum += wx * wy * f(mx + hx * x, my + hy * y);
                }
            }
            sum * hx * hy
        };
        let value = apply(&fine);
        (value, (value - apply(&coarse)).abs())
    };
    adapt(cells, &mut rule, quarter, |_| tolerance, evaluations / per_cell, INHERITED)
}

/// Nodes along each side of a rectangle.
const FINE: usize = 6;

/// The part of its error that a cell is thought to hand on to its quarters. Two symmetric rules both find half of a jump in the middle between
/// their nodes, and differ by nothing there; the larger cell around it does not. What is smooth is divided once more than needed, at most.
const INHERITED: f64 = 1.0 / 64.0;

/// The 6-point Gauss–Lobatto rule in (−1, 1), exact up to degree 9. Its outer nodes are at the ends, but for 1e-9: a rule whose nodes all
/// keep away from the ends, like Gauss's, does not see a jump near an edge of a cell, however often the rest is divided.
const LOBATTO: [(f64, f64); 6] = {
    // √(1/3 ± 2√7/21), and weights (14 ∓ √7)/30.
    const OUTER: (f64, f64) = (0.765_055_323_929_464_7, 0.378_474_956_297_847);
    const INNER: (f64, f64) = (0.285_231_516_480_645_1, 0.554_858_377_035_486_4);
    const END: (f64, f64) = (1.0 - 1e-9, 1.0 / 15.0);
    [(-END.0, END.1), (-OUTER.0, OUTER.1), (-INNER.0, INNER.1), INNER, OUTER, END]
};

/// A cone of directions, or the whole sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Unit axis.
    pub axis: [f64; 3],
    /// 1 − cos of the half angle: 2 for the whole sphere. Kept in this form because a far light's cosine is 1 in f64.
    pub one_minus_cos: f64,
}

impl Cone {
    /// Every direction.
    pub const SPHERE: Self = Self { axis: [0.0, 0.0, 1.0], one_minus_cos: 2.0 };

    /// The cone of the given half angle, rad.
    #[must_use]
    pub fn new(axis: [f64; 3], half_angle_rad: f64) -> Self {
        Self { axis: normalize(axis), one_minus_cos: 2.0 * (0.5 * half_angle_rad).sin().powi(2) }
    }

    /// The direction at a share `h` in [0, 1] of 1 − cos and the angle φ about the axis.
    #[must_use]
    pub fn direction(&self, h: f64, phi: f64) -> [f64; 3] {
        let lift = h * self.one_minus_cos;
        let sine = (lift * (2.0 - lift)).max(0.0).sqrt();
        let (s, t) = frame(self.axis);
        let (sin_phi, cos_phi) = phi.sin_cos();
        add(scale(1.0 - lift, self.axis), add(scale(sine * cos_phi, s), scale(sine * sin_phi, t)))
    }

    /// The inverse of [`direction`](Self::direction): h (above 1 outside the cone) and φ in [0, 2π).
    #[must_use]
    pub fn coordinates(&self, direction: [f64; 3]) -> (f64, f64) {
        let (s, t) = frame(self.axis);
        let dot = |a: Vec3, b: Vec3| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        // 1 − cos as half the squared chord: exact for small angles.
        let chord = [0, 1, 2].map(|i| direction[i] - self.axis[i]);
        let phi = dot(direction, t).atan2(dot(direction, s));
        let phi = if phi < 0.0 { phi + std::f64::consts::TAU } else { phi };
        (0.5 * dot(chord, chord) / self.one_minus_cos, phi)
    }
}

/// ∫ f dω over a cone of directions, adaptively to an absolute tolerance with a cap on evaluations.
///
/// The first grid is 8 × 16 cells, split at the equator of a whole sphere so that a surface's horizon lies between cells.
pub fn directions(mut f: impl FnMut([f64; 3]) -> f64, cone: Cone, tolerance: f64, evaluations: usize) -> Integral {
    let cells = (0..8).flat_map(|i| {
        (0..16).map(move |j| {
            let (i, j) = (f64::from(i), f64::from(j));
            let step = std::f64::consts::TAU / 16.0;
            [i / 8.0, (i + 1.0) / 8.0, j * step, (j + 1.0) * step]
        })
    });
    let scale = cone.one_minus_cos;
    let inner = rectangles(|h, phi| f(cone.direction(h, phi)), cells, tolerance / scale, evaluations);
    Integral { value: inner.value * scale, error: inner.error * scale }
}

struct Cell {
    bounds: [f64; 4],
    value: f64,
    /// What its two rules differ by.
    error: f64,
    /// The same, and at least a part of what the cell that it was cut from had: it decides which one is cut next.
    doubt: f64,
}

impl PartialEq for Cell {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Cell {}
impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Cell {
    fn cmp(&self, other: &Self) -> Ordering {
        self.doubt.total_cmp(&other.doubt)
    }
}

fn bisect([a, b, c, d]: [f64; 4]) -> Vec<[f64; 4]> {
    let middle = 0.5 * (a + b);
    vec![[a, middle, c, d], [middle, b, c, d]]
}

fn quarter([a, b, c, d]: [f64; 4]) -> Vec<[f64; 4]> {
    let (x, y) = (0.5 * (a + b), 0.5 * (c + d));
    vec![[a, x, c, y], [x, b, c, y], [a, x, y, d], [x, b, y, d]]
}

/// Splits the cell of the largest doubt until the sum of doubts meets the tolerance, a function of the sum of values. A cell that was cut
/// from another is thought to have at least the part `inherited` of its error, whatever its own two rules say.
fn adapt(
    start: impl IntoIterator<Item = [f64; 4]>,
    mut rule: impl FnMut([f64; 4]) -> (f64, f64),
    split: impl Fn([f64; 4]) -> Vec<[f64; 4]>,
    tolerance: impl Fn(f64) -> f64,
    most_cells: usize,
    inherited: f64,
) -> Integral {
    let mut measure = |bounds: [f64; 4]| {
        let (value, error) = rule(bounds);
        Cell { bounds, value, error, doubt: error }
    };
    let mut heap: BinaryHeap<Cell> = start.into_iter().map(&mut measure).collect();
    let mut total: f64 = heap.iter().map(|cell| cell.value).sum();
    let mut doubt: f64 = heap.iter().map(|cell| cell.doubt).sum();
    let mut cells = heap.len();
    while doubt > tolerance(total) && cells < most_cells {
        let Some(worst) = heap.pop() else { break };
        (total, doubt) = (total - worst.value, doubt - worst.doubt);
        let mut parts: Vec<Cell> = split(worst.bounds).into_iter().map(&mut measure).collect();
        let found = parts.iter().map(|cell| cell.value).sum::<f64>();
        let least = inherited * worst.doubt.max((found - worst.value).abs());
        parts.iter_mut().for_each(|cell| cell.doubt = cell.error.max(least));
        for cell in parts {
            (total, doubt) = (total + cell.value, doubt + cell.doubt);
            cells += 1;
            heap.push(cell);
        }
    }
    // Summed afresh: the running total has collected rounding.
    Integral { value: heap.iter().map(|c| c.value).sum(), error: heap.iter().map(|c| c.error).sum() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn gauss_rules_are_exact_for_polynomials_of_their_degree() {
        for n in 1..20 {
            let degree = 2 * n - 2;
            let sum: f64 = gauss_legendre(n).iter().map(|(x, w)| w * x.powi(degree as i32)).sum();
            assert!((sum - 2.0 / (degree as f64 + 1.0)).abs() < 1e-14, "{n}");
        }
    }

    #[test]
    fn intervals_reach_their_tolerance_even_at_an_end_singularity() {
        let root = interval(f64::sqrt, 0.0, 1.0, 1e-12);
        assert!((root.value - 2.0 / 3.0).abs() < 1e-12);
        assert!((interval(f64::exp, 0.0, 1.0, 1e-13).value - 1.0_f64.exp_m1()).abs() < 1e-13);
    }

    #[test]
    fn the_sphere_has_its_area_and_the_cosine_its_pi() {
        let area = directions(|_| 1.0, Cone::SPHERE, 1e-12, 100_000);
        assert!((area.value - 4.0 * PI).abs() < 1e-12);
        let cosine = directions(|d| d[2].max(0.0), Cone::SPHERE, 1e-12, 100_000);
        assert!((cosine.value - PI).abs() < 1e-12);
        // A lobe of width .01: ∫ exp(−(1 − cos)/s) dω = 2πs(1 − e^(−2/s)), off the axis of the grid.
        let axis = normalize([0.3, -0.5, 0.6]);
        let s = 1e-4;
        let lobe = |d: Vec3| {
            let gap = 0.5 * (0..3).map(|i| (d[i] - axis[i]).powi(2)).sum::<f64>();
            (-gap / s).exp()
        };
        let peak = directions(lobe, Cone::SPHERE, 1e-10, 2_000_000);
        assert!((peak.value - 2.0 * PI * s).abs() < 1e-9, "{peak:?}");
    }

    /// The facets of a rough surface end at its horizon: there the light that they refract ends with a jump, and the first cells do too,
    /// nearly.
    #[test]
    fn a_jump_just_beside_an_edge_of_a_cell_is_seen() {
        for beside in [1e-3, -1e-3, 1e-5] {
            let up_to = 0.6875 + beside;
            let found =
                rectangle(|x, y| if x < up_to { 1.0 + y } else { 0.0 }, [0.0, 1.0], [0.0, 1.0], 1e-7, 1_000_000);
            let wrong = (found.value - 1.5 * up_to).abs();
            // A million evaluations narrow it down to about 2e-5.
            assert!(wrong < 3.0 * found.error && wrong < 1e-4, "{beside}: off by {wrong}, {found:?}");
        }
    }

    #[test]
    fn a_cone_of_a_microradian_keeps_its_solid_angle_and_its_coordinates() {
        let cone = Cone::new([1.0, 2.0, -2.0], 1e-6);
        let solid = directions(|_| 1.0, cone, 0.0, 10_000).value;
        assert!((solid / (PI * 1e-12) - 1.0).abs() < 1e-9);
        let (h, phi) = cone.coordinates(cone.direction(0.25, 2.0));
        assert!((h - 0.25).abs() < 1e-8 && (phi - 2.0).abs() < 1e-8, "{h} {phi}");
    }
}
