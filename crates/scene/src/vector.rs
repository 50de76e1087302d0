//! Vectors in double precision, without overflow or underflow on the way.

pub type Vector = [f64; 3];

pub fn add(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|i| a[i] + b[i])
}

pub fn sub(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|i| a[i] - b[i])
}

pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn scale(a: Vector, s: f64) -> Vector {
    a.map(|c| c * s)
}

/// Length of a vector whose components are not far from 1.
pub fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// The unit vector of a direction, however long or short; `None` for zero and for what is not finite.
pub fn unit(a: Vector) -> Option<Vector> {
    let largest = a.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
    if largest == 0.0 || a.iter().any(|c| !c.is_finite()) {
        return None;
    }
    // First near 1, so that the squares neither overflow nor underflow; a subnormal has no finite reciprocal.
    let near = a.map(|c| c / largest);
    let length = length(near);
    Some(near.map(|c| c / length))
}

/// A 3×3 matrix by rows.
pub type Matrix = [[f64; 3]; 3];

pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

pub fn apply(a: &Matrix, v: Vector) -> Vector {
    std::array::from_fn(|i| dot(a[i], v))
}
