//! Affine maps, as files of other programs state them.

use etalon_scene::vector::{Vector, cross, dot, length, scale, sub, unit};
use serde_json::{Value, json};

/// The upper three rows of a matrix that acts on columns.
pub(crate) type Rows = [[f64; 4]; 3];

pub(crate) const IDENTITY: Rows = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

/// a·b: first b, then a.
pub(crate) fn product(a: &Rows, b: &Rows) -> Rows {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum::<f64>() + if j == 3 { a[i][3] } else { 0.0 })
    })
}

pub(crate) fn translation(by: Vector) -> Rows {
    let mut rows = IDENTITY;
    (0..3).for_each(|i| rows[i][3] = by[i]);
    rows
}

pub(crate) fn scaling(by: Vector) -> Rows {
    let mut rows = IDENTITY;
    (0..3).for_each(|i| rows[i][i] = by[i]);
    rows
}

/// Counter-clockwise when the axis points at the viewer; `None` for an axis without a direction.
pub(crate) fn rotation(axis: Vector, angle_deg: f64) -> Option<Rows> {
    let [x, y, z] = unit(axis)?;
    // Quarter turns are exact.
    let turn = angle_deg.rem_euclid(360.0);
    let (sin, cos) = match turn {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        _ => turn.to_radians().sin_cos(),
    };
    let c = 1.0 - cos;
    Some([
        [cos + x * x * c, x * y * c - z * sin, x * z * c + y * sin, 0.0],
        [y * x * c + z * sin, cos + y * y * c, y * z * c - x * sin, 0.0],
        [z * x * c - y * sin, z * y * c + x * sin, cos + z * z * c, 0.0],
    ])
}

/// A camera at `origin`: the columns of the map are up × forward, the up at right angles to the view, and forward. `None`
/// if there is no view, or up lies along it.
pub(crate) fn looking(origin: Vector, target: Vector, up: Vector) -> Option<Rows> {
    let forward = unit(sub(target, origin))?;
    let side = unit(cross(unit(up)?, forward))?;
    let up = cross(forward, side);
    Some(std::array::from_fn(|i| [side[i], up[i], forward[i], origin[i]]))
}

pub(crate) fn column(m: &Rows, k: usize) -> Vector {
    std::array::from_fn(|i| m[i][k])
}

pub(crate) fn determinant(m: &Rows) -> f64 {
    dot(column(m, 0), cross(column(m, 1), column(m, 2)))
}

/// `None` if it has none.
pub(crate) fn inverse(m: &Rows) -> Option<Rows> {
    let [a, b, c] = [0, 1, 2].map(|k| column(m, k));
    let determinant = dot(a, cross(b, c));
    let rows = [cross(b, c), cross(c, a), cross(a, b)].map(|row| scale(row, 1.0 / determinant));
    let moved = rows.map(|row| -dot(row, column(m, 3)));
    let inverse: Rows = std::array::from_fn(|i| [rows[i][0], rows[i][1], rows[i][2], moved[i]]);
    inverse.iter().flatten().all(|v| v.is_finite()).then_some(inverse)
}

pub(crate) fn point(m: &Rows, p: Vector) -> Vector {
    std::array::from_fn(|i| dot([m[i][0], m[i][1], m[i][2]], p) + m[i][3])
}

pub(crate) fn direction(m: &Rows, d: Vector) -> Vector {
    std::array::from_fn(|i| dot([m[i][0], m[i][1], m[i][2]], d))
}

/// Whether it keeps the form of things: rotation, reflection, one scale, to one part in 10⁶, which is what the format asks.
pub(crate) fn is_similarity(m: &Rows) -> bool {
    let columns = [0, 1, 2].map(|k| column(m, k));
    let lengths = columns.map(length);
    let longest = lengths.iter().fold(0.0_f64, |a, b| a.max(*b));
    let tolerance = 1e-6 * longest;
    lengths.iter().all(|l| (l - longest).abs() <= tolerance)
        && [(0, 1), (0, 2), (1, 2)].iter().all(|&(i, j)| dot(columns[i], columns[j]).abs() <= tolerance * longest)
}

/// As a list of steps of the format, or null for the identity.
pub(crate) fn steps(m: &Rows) -> Value {
    if *m == IDENTITY { Value::Null } else { json!([{ "matrix": m }]) }
}
