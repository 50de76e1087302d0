//! Deterministic integration: the second opinion on closed forms, and the referee of densities.

use std::{cmp::Ordering, collections::BinaryHeap};

use crate::vector::{Vec3, add, frame, normalize, scale};

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
    adapt([[a, b, 0.0, 0.0]], |cell| rule(cell[0], cell[1]), bisect, |_| tolerance, 100_000 / 19)
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
    let (fine, coarse) = (gauss_legendre(FINE), gauss_legendre(4));
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
    adapt(cells, &mut rule, quarter, |_| tolerance, evaluations / per_cell)
}

/// Nodes along each side of a rectangle.
const FINE: usize = 6;

/// A point (x, y) and the value there of what is to be integrated, found by other means than the rule's own nodes.
pub(crate) type Clue = ([f64; 2], f64);

/// ∫∫ f over a rectangle, f ≥ 0 and perhaps zero beyond some line, where it may end as a step or grow without bound as an inverse
/// root, to a tolerance that depends on the value.
///
/// Where some nodes meet zero and some do not, or two rules differ and most of a line's change is between two neighbours, the integral is
/// taken line by line between the places where f ends or jumps, which are found by bisection: the sum over lines is then continuous, and
/// the difference of two rules is an honest error again. (A line cut where nothing jumps is integrated as well as before.) A rule
/// whose nodes all miss where f is not zero would report 0 ± 0: where a clue lies far above all of them, the error is at least what one
/// row of nodes at its value would be.
pub(crate) fn nonnegative(
    mut f: impl FnMut(f64, f64) -> f64,
    bounds: [f64; 4],
    clues: &[Clue],
    tolerance: impl Fn(f64) -> f64,
    most_cells: usize,
) -> Integral {
    let (fine, coarse) = (gauss_legendre(FINE), gauss_legendre(4));
    let rule = |[a, b, c, d]: [f64; 4]| {
        let area = (b - a) * (d - c);
        let at = |[a, b]: [f64; 2], node: f64| 0.5 * (a + b) + 0.5 * (b - a) * node;
        let nodes = |rule: &[(f64, f64)], f: &mut dyn FnMut(f64, f64) -> f64| -> Vec<f64> {
            let along = |x: f64| rule.iter().map(move |(y, _)| (x, *y));
            rule.iter().flat_map(|(x, _)| along(*x)).map(|(x, y)| f(at([a, b], x), at([c, d], y))).collect()
        };
        let met = nodes(&fine, &mut f);
        let most = met.iter().copied().fold(0.0, f64::max);
        let zero = |i: usize, j: usize| met[i * FINE + j] == 0.0;
        let places = [[a, b], [c, d]].map(|side| std::array::from_fn(|i| at(side, fine[i].0)));
        let sum = |values: &[f64], rule: &[(f64, f64)]| {
            let weights = rule.iter().flat_map(|(_, wx)| rule.iter().map(move |(_, wy)| 0.25 * area * wx * wy));
            values.iter().zip(weights).map(|(value, weight)| value * weight).sum::<f64>()
        };
        let ends = if most > 0.0 && met.contains(&0.0) {
            // Along the axis on which more lines meet an end.
            let ends = |line: &dyn Fn(usize, usize) -> bool| {
                (0..FINE).filter(|&i| (1..FINE).any(|j| line(i, j) != line(i, j - 1))).count()
            };
            let along_y = ends(&|i, j| zero(i, j)) >= ends(&|i, j| zero(j, i));
            Some((along_y, jump(&met, &places, &mut f).map_or(0.0, |(_, level)| level)))
        } else {
            None
        };
        let by_lines = |(along_y, level): (bool, f64), f: &mut dyn FnMut(f64, f64) -> f64| {
            let mut sum = |rule: &[(f64, f64)]| {
                let (across, along) = if along_y { ([a, b], [c, d]) } else { ([c, d], [a, b]) };
                let mut line = |(node, weight): &(f64, f64)| {
                    let place = at(across, *node);
                    let over = |x: f64| if along_y { f(place, x) } else { f(x, place) };
                    0.5 * (across[1] - across[0]) * weight * line_in_pieces(over, along, level, rule)
                };
                rule.iter().map(&mut line).sum::<f64>()
            };
            (sum(&fine), sum(&coarse))
        };
        let (value, other) = match ends {
            Some(ends) => by_lines(ends, &mut f),
            None => {
                let whole = (sum(&met, &fine), sum(&nodes(&coarse, &mut f), &coarse));
                match jump(&met, &places, &mut f) {
                    Some(jump) if (whole.0 - whole.1).abs() > SMOOTH * whole.0 => by_lines(jump, &mut f),
                    _ => whole,
                }
            }
        };
        let mut error = (value - other).abs();
        let within = |[x, y]: [f64; 2]| a <= x && x <= b && c <= y && y <= d;
        let clue = clues.iter().filter(|(place, _)| within(*place)).map(|clue| clue.1).fold(0.0, f64::max);
        if clue > 2.0 * most {
            error = error.max(area * clue / FINE as f64);
        }
        (value, error)
    };
    adapt([bounds], rule, quarter, tolerance, most_cells)
}

/// Two rules that differ by less than this part of the integral have met no jump that matters.
const SMOOTH: f64 = 1e-4;

/// Whether values at the nodes of a rectangle, of which `places` has the coordinates, jump from one above 0 to another, along which axis (y if
/// true), and the middle of the largest jump: where, on at least two lines along that axis, most of the whole change is between two
/// neighbours, and at least half of that still is between points so near to each other that only a jump can be.
fn jump(met: &[f64], places: &[[f64; FINE]; 2], f: &mut dyn FnMut(f64, f64) -> f64) -> Option<(bool, f64)> {
    let most = met.iter().copied().fold(0.0, f64::max);
    let at = |along_y: bool, i: usize, j: usize| if along_y { met[i * FINE + j] } else { met[j * FINE + i] };
    let lines = |along_y: bool| {
        let step = move |i: usize, j: usize| match (at(along_y, i, j - 1), at(along_y, i, j)) {
            // Where it ends, which is no matter of levels.
            (before, after) if before == 0.0 || after == 0.0 => 0.0,
            (before, after) => (after - before).abs(),
        };
        (0..FINE).filter_map(move |i| {
            let (whole, (size, j)) =
                (1..FINE).map(|j| (step(i, j), j)).fold((0.0, (0.0, 0)), |(sum, most), (size, j)| {
                    (sum + size, if size > most.0 { (size, j) } else { most })
                });
            (size > 0.6 * whole && size > 0.05 * most).then_some((size, i, j))
        })
    };
    let along_y = lines(true).count() >= lines(false).count();
    let (size, i, j) = lines(along_y).max_by(|a, b| a.0.total_cmp(&b.0)).filter(|_| lines(along_y).count() >= 2)?;
    let level = 0.5 * (at(along_y, i, j) + at(along_y, i, j - 1));
    // What grows steeply, such as toward an inverse root, is no jump.
    let [across, along] = if along_y { [&places[0], &places[1]] } else { [&places[1], &places[0]] };
    let mut over = |x: f64| if along_y { f(across[i], x) } else { f(x, across[i]) };
    let (mut low, mut high) = (along[j - 1], along[j]);
    let below = at(along_y, i, j - 1) <= level;
    for _ in 0..24 {
        let middle = 0.5 * (low + high);
        if (over(middle) <= level) == below { low = middle } else { high = middle }
    }
    ((over(low) - over(high)).abs() > 0.5 * size).then_some((along_y, level))
}

/// Most places between two neighbouring nodes at which a line is cut.
const MOST_PLACES: usize = 4;

/// ∫ f over [a, b] where f is zero in some parts, or jumps across `level`, which the nodes of the rule tell from the others. These places
/// are found by bisection to 2⁻²⁴ of the interval, and nodes gather there (x = t²(3 − 2t)), so that an inverse root is integrated like
/// a step.
fn line_in_pieces(mut f: impl FnMut(f64) -> f64, [a, b]: [f64; 2], level: f64, rule: &[(f64, f64)]) -> f64 {
    let inner = rule.iter().map(|(node, _)| 0.5 * (a + b) + 0.5 * (b - a) * node);
    let mut places: Vec<f64> = [a, b].into_iter().chain(inner).collect();
    places.sort_by(f64::total_cmp);
    let mut kind = |x: f64| {
        let value = f(x);
        (value > 0.0, value > level)
    };
    let kinds: Vec<_> = places.iter().map(|&x| kind(x)).collect();
    let (mut pieces, mut begin) = (Vec::new(), a);
    for (pair, kinds) in places.windows(2).zip(kinds.windows(2)) {
        // One place after the other: what grows without bound before it ends crosses the level and then ends.
        let (mut low, mut now) = (pair[0], kinds[0]);
        for _ in 0..MOST_PLACES {
            if now == kinds[1] {
                break;
            }
            let mut high = pair[1];
            while high - low > (b - a) * 0.5_f64.powi(24) {
                let middle = 0.5 * (low + high);
                if kind(middle) == now { low = middle } else { high = middle }
            }
            if now.0 {
                pieces.push([begin, low]);
            }
            (begin, low, now) = (high, high, kind(high));
        }
    }
    if kinds[kinds.len() - 1].0 {
        pieces.push([begin, b]);
    }
    let mut sum = 0.0;
    for [begin, end] in pieces {
        for (node, weight) in rule {
            let t = 0.5 + 0.5 * node;
            sum += 3.0 * t * (1.0 - t) * weight * f(begin + (end - begin) * t * t * (3.0 - 2.0 * t)) * (end - begin);
        }
    }
    sum
}

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
    error: f64,
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
        self.error.total_cmp(&other.error)
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

/// Splits the cell with the largest error until the sum of errors meets the tolerance, a function of the sum of values.
fn adapt(
    start: impl IntoIterator<Item = [f64; 4]>,
    mut rule: impl FnMut([f64; 4]) -> (f64, f64),
    split: impl Fn([f64; 4]) -> Vec<[f64; 4]>,
    tolerance: impl Fn(f64) -> f64,
    most_cells: usize,
) -> Integral {
    let mut measure = |bounds: [f64; 4]| {
        let (value, error) = rule(bounds);
        Cell { bounds, value, error }
    };
    let mut heap: BinaryHeap<Cell> = start.into_iter().map(&mut measure).collect();
    let mut total: f64 = heap.iter().map(|cell| cell.value).sum();
    let mut error: f64 = heap.iter().map(|cell| cell.error).sum();
    let mut cells = heap.len();
    while error > tolerance(total) && cells < most_cells {
        let Some(worst) = heap.pop() else { break };
        (total, error) = (total - worst.value, error - worst.error);
        for bounds in split(worst.bounds) {
            let cell = measure(bounds);
            (total, error) = (total + cell.value, error + cell.error);
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
    fn what_ends_within_a_rectangle_or_hides_in_its_corner_is_integrated_to_the_error_that_is_stated() {
        // A quarter disk of height 3, a step along a line of the grid, a wedge that no node of the first rule meets, and a silhouette.
        let unit = [0.0, 1.0, 0.0, 1.0];
        let disk = |x: f64, y: f64| if x * x + y * y < 1.0 { 3.0 } else { 0.0 };
        let step = |_: f64, y: f64| if y < 1.0 / 3.0 { 1.0 } else { 0.0 };
        let wedge = |x: f64, y: f64| if x + y < 0.02 { 1.0 } else { 0.0 };
        let rim = |x: f64, y: f64| if x + 2.0 * y < 1.0 { 1.0 / (1.0 - x - 2.0 * y).sqrt() } else { 0.0 };
        let met = nonnegative(disk, unit, &[], |value| 1e-4 * value, 1000);
        assert!((met.value - 0.75 * PI).abs() < met.error && met.error < 1e-4 * PI, "{met:?}");
        let met = nonnegative(step, unit, &[], |_| 1e-6, 100);
        assert!((met.value - 1.0 / 3.0).abs() < 1e-6 && met.error < 1e-6, "{met:?}");
        assert_eq!(nonnegative(wedge, unit, &[], |_| 1e-9, 20), Integral { value: 0.0, error: 0.0 });
        let met = nonnegative(wedge, unit, &[([0.009, 0.001], 1.0)], |value| 1e-3 * value, 1000);
        assert!((met.value - 2e-4).abs() < met.error.max(1e-9) && met.error < 4e-7, "{met:?}");
        // The disk on a ground of 1, and on one that rises.
        let raised = |x: f64, y: f64| 1.0 + disk(x, y);
        let met = nonnegative(raised, unit, &[], |value| 1e-4 * value, 1000);
        assert!((met.value - 1.0 - 0.75 * PI).abs() < met.error && met.error < 4e-4, "{met:?}");
        let sloping = |x: f64, y: f64| 1.0 + x + 2.0 * y + disk(x, y);
        let met = nonnegative(sloping, unit, &[], |value| 1e-4 * value, 1000);
        assert!((met.value - 2.5 - 0.75 * PI).abs() < met.error && met.error < 5e-4, "{met:?}");
        // ∫ from 0 to 1/2 of 2·√(1 − 2y) dy.
        let met = nonnegative(rim, unit, &[], |_| 1e-4, 1000);
        assert!((met.value - 2.0 / 3.0).abs() < met.error.max(1e-6) && met.error < 1e-4, "{met:?}");
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

    #[test]
    fn a_cone_of_a_microradian_keeps_its_solid_angle_and_its_coordinates() {
        let cone = Cone::new([1.0, 2.0, -2.0], 1e-6);
        let solid = directions(|_| 1.0, cone, 0.0, 10_000).value;
        assert!((solid / (PI * 1e-12) - 1.0).abs() < 1e-9);
        let (h, phi) = cone.coordinates(cone.direction(0.25, 2.0));
        assert!((h - 0.25).abs() < 1e-8 && (phi - 2.0).abs() < 1e-8, "{h} {phi}");
    }
}
