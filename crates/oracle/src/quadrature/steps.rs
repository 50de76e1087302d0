//! Integrals of what ends or jumps within the domain.

use super::{FINE, Integral, adapt, gauss_legendre, quarter};

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
    adapt([bounds], rule, quarter, tolerance, most_cells, 0.0)
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

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
}
