//! 3 × 3 matrices between colour spaces.

/// A 3 × 3 matrix, row after row.
pub type Matrix = [[f64; 3]; 3];

/// Matrix times vector.
pub const fn multiply(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    [
        m[0][0] * v[0] + m[0][1] * v[1] + m[0][2] * v[2],
        m[1][0] * v[0] + m[1][1] * v[1] + m[1][2] * v[2],
        m[2][0] * v[0] + m[2][1] * v[1] + m[2][2] * v[2],
    ]
}

/// The inverse by cofactors; the colour matrices are well conditioned. Not finite where the matrix has no inverse.
pub const fn inverse(m: &Matrix) -> Matrix {
    let cof = [
        [
            m[1][1] * m[2][2] - m[1][2] * m[2][1],
            m[0][2] * m[2][1] - m[0][1] * m[2][2],
            m[0][1] * m[1][2] - m[0][2] * m[1][1],
        ],
        [
            m[1][2] * m[2][0] - m[1][0] * m[2][2],
            m[0][0] * m[2][2] - m[0][2] * m[2][0],
            m[0][2] * m[1][0] - m[0][0] * m[1][2],
        ],
        [
            m[1][0] * m[2][1] - m[1][1] * m[2][0],
            m[0][1] * m[2][0] - m[0][0] * m[2][1],
            m[0][0] * m[1][1] - m[0][1] * m[1][0],
        ],
    ];
    let d = m[0][0] * cof[0][0] + m[0][1] * cof[1][0] + m[0][2] * cof[2][0];
    [
        [cof[0][0] / d, cof[0][1] / d, cof[0][2] / d],
        [cof[1][0] / d, cof[1][1] / d, cof[1][2] / d],
        [cof[2][0] / d, cof[2][1] / d, cof[2][2] / d],
    ]
}

/// The product a·b: first b, then a.
pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}
