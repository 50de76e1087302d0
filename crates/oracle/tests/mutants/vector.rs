//! Three-vectors for the subjects, so that they share none with the oracle.

pub(crate) type Vec3 = [f64; 3];

pub(crate) fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn plus(a: Vec3, s: f64, b: Vec3) -> Vec3 {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

pub(crate) fn minus(a: Vec3, b: Vec3) -> Vec3 {
    plus(a, -1.0, b)
}

pub(crate) fn times(s: f64, a: Vec3) -> Vec3 {
    a.map(|x| s * x)
}

pub(crate) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn unit(a: Vec3) -> Vec3 {
    times(1.0 / dot(a, a).sqrt(), a)
}

/// Two vectors that complete a unit vector to an orthonormal frame.
pub(crate) fn frame(n: Vec3) -> (Vec3, Vec3) {
    let helper = if n[0].abs() > 0.9 { [0.0, 1.0, 0.0] } else { [1.0, 0.0, 0.0] };
    let s = unit(cross(helper, n));
    (s, cross(n, s))
}
