//! Piecewise linear tables over wavelength.

/// Rows of numbers in a data file of this crate: comma-separated, `#` starts a comment line.
///
/// Panics on a malformed row: the files are compiled in, so that would be a defect of this crate.
pub(crate) fn parse_csv<const N: usize>(text: &str) -> Vec<[f64; N]> {
    text.lines()
        .filter(|line| !line.starts_with('#') && !line.is_empty())
        .map(|line| {
            let mut cells = line.split(',').map(|cell| cell.parse::<f64>().expect("a number in every cell"));
            let row = std::array::from_fn(|_| cells.next().expect("a cell in every column"));
            assert!(cells.next().is_none(), "too many columns in {line:?}");
            row
        })
        .collect()
}

/// The segment of increasing `nodes` that holds `x`, and the position within it in [0, 1]; `None` outside.
///
/// Needs at least two nodes.
#[inline]
pub(crate) fn locate(nodes: &[f64], x: f64) -> Option<(usize, f64)> {
    let last = nodes.len() - 1;
    // Written so that NaN is outside.
    if !(x >= nodes[0] && x <= nodes[last]) {
        return None;
    }
    let i = (nodes.partition_point(|&node| node <= x) - 1).min(last - 1);
    Some((i, (x - nodes[i]) / (nodes[i + 1] - nodes[i])))
}

/// `a` at t = 0, `b` at t = 1, exactly at both ends and monotone between.
#[inline(always)]
pub(crate) fn lerp(a: f64, b: f64, t: f64) -> f64 {
    (1.0 - t) * a + t * b
}
