//! Linear algebra beyond glam: directions of any length, exact quarter turns, matrices written by rows, similarities.

use glam::{DAffine3, DMat3, DVec3};

/// The unit vector of a direction, however long or short; `None` for zero and for what is not finite.
pub fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    if largest == 0.0 || !v.is_finite() {
        return None;
    }
    // First near 1, so that the squares neither overflow nor underflow; a subnormal has no finite reciprocal.
    let near = v / largest;
    Some(near / near.length())
}

/// A normal of a mesh, scaled to unit length; (0, 0, 0), which stands for none, stays.
pub fn unit_normal(normal: [f64; 3]) -> [f32; 3] {
    unit(normal.into()).unwrap_or(DVec3::ZERO).as_vec3().to_array()
}

/// The rotation about a unit axis by Rodrigues' formula, counter-clockwise where the axis points at the viewer. Quarter turns are exact.
pub fn rotation(axis: DVec3, angle_deg: f64) -> DMat3 {
    let turn = angle_deg.rem_euclid(360.0);
    let (sin, cos) = match turn {
        // A tiny negative angle is rounded to 360.
        0.0 | 360.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        _ => turn.to_radians().sin_cos(),
    };
    let (x, y, z) = axis.into();
    let versine = 1.0 - cos;
    from_rows([
        [cos + x * x * versine, x * y * versine - z * sin, x * z * versine + y * sin],
        [y * x * versine + z * sin, cos + y * y * versine, y * z * versine - x * sin],
        [z * x * versine - y * sin, z * y * versine + x * sin, cos + z * z * versine],
    ])
}

/// A matrix by its rows.
pub fn from_rows(rows: [[f64; 3]; 3]) -> DMat3 {
    DMat3::from_cols_array_2d(&rows).transpose()
}

/// The rows of a matrix.
pub fn rows(matrix: &DMat3) -> [[f64; 3]; 3] {
    matrix.transpose().to_cols_array_2d()
}

/// An affine map by the upper three rows of a 4 × 4 matrix that acts on columns.
pub fn affine_from_rows(rows: &[[f64; 4]; 3]) -> DAffine3 {
    DAffine3::from_mat3_translation(from_rows(rows.map(|[x, y, z, _]| [x, y, z])), rows.map(|row| row[3]).into())
}

/// The upper three rows of the 4 × 4 matrix of an affine map.
pub fn affine_rows(map: &DAffine3) -> [[f64; 4]; 3] {
    let rows = rows(&map.matrix3);
    std::array::from_fn(|i| [rows[i][0], rows[i][1], rows[i][2], map.translation[i]])
}

/// The largest absolute value of the elements of a matrix.
pub fn largest(matrix: &DMat3) -> f64 {
    matrix.to_cols_array().into_iter().fold(0.0, |m, v| m.max(v.abs()))
}

/// The square root of the sum of the squares of all elements.
pub(crate) fn norm(matrix: &DMat3) -> f64 {
    [matrix.x_axis, matrix.y_axis, matrix.z_axis].iter().map(|column| column.length_squared()).sum::<f64>().sqrt()
}

/// The transposed inverse times the determinant.
pub fn cofactors(&DMat3 { x_axis, y_axis, z_axis }: &DMat3) -> DMat3 {
    DMat3::from_cols(y_axis.cross(z_axis), z_axis.cross(x_axis), x_axis.cross(y_axis))
}

/// How far AᵀA/s² may be from the identity for A to count as a similarity: matrices in files are often written with
/// seven digits.
const SIMILARITY: f64 = 1e-6;

/// Whether a matrix keeps the form of things: a rotation, perhaps a reflection, and one scale for all axes.
pub fn is_similarity(matrix: &DMat3) -> bool {
    let a = *matrix / largest(matrix);
    let gram = a.transpose() * a;
    let square = (0..3).map(|i| gram.col(i)[i]).sum::<f64>() / 3.0;
    (gram / square - DMat3::IDENTITY).to_cols_array().into_iter().all(|off| off.abs() <= SIMILARITY)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_of_any_length_become_unit_vectors() {
        for size in [f64::from_bits(1), f64::MIN_POSITIVE, 1e-200, 1.0, 1e200, f64::MAX] {
            assert_eq!(unit(DVec3::new(0.0, -size, 0.0)), Some(DVec3::NEG_Y), "{size}");
            let diagonal = unit(DVec3::splat(size)).unwrap();
            assert!((diagonal - DVec3::splat(1.0 / 3.0_f64.sqrt())).length() < 1e-15, "{size} {diagonal}");
        }
        for wrong in [DVec3::ZERO, DVec3::new(f64::NAN, 1.0, 0.0), DVec3::new(1.0, f64::INFINITY, 0.0)] {
            assert_eq!(unit(wrong), None);
        }
        assert_eq!(unit_normal([0.0; 3]), [0.0; 3]);
    }

    #[test]
    fn quarter_turns_are_exact() {
        let turned = |angle_deg| rotation(DVec3::Z, angle_deg) * DVec3::X;
        for quarters in -8..8_i32 {
            let expected = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y][quarters.rem_euclid(4) as usize];
            assert_eq!(turned(90.0 * f64::from(quarters)), expected, "{quarters}");
        }
        assert_eq!(turned(-1e-300), DVec3::X);
        let oblique = DVec3::new(2.0, -3.0, 6.0) / 7.0;
        let of_glam = DMat3::from_axis_angle(oblique, 1.25);
        assert!(largest(&(rotation(oblique, 1.25_f64.to_degrees()) - of_glam)) < 1e-15);
    }

    #[test]
    fn rows_are_those_of_the_matrix() {
        let rows = [[1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0], [9.0, 10.0, 11.0, 12.0]];
        let map = affine_from_rows(&rows);
        assert_eq!(map.transform_point3(DVec3::X), DVec3::new(5.0, 13.0, 21.0));
        assert_eq!(affine_rows(&map), rows);
    }

    #[test]
    fn a_similarity_may_turn_mirror_and_scale_alike() {
        for scale in [1e-200, 1.0, -3.0, 1e200] {
            let turned = rotation(DVec3::new(0.6, 0.0, 0.8), 33.0) * scale;
            assert!(is_similarity(&turned), "{scale}");
            assert!(!is_similarity(&(turned * DMat3::from_diagonal(DVec3::new(1.0, 1.0, 1.00001)))), "{scale}");
        }
        assert!(!is_similarity(&from_rows([[1.0, 1e-5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])));
    }
}
