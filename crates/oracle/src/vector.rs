//! Three-vectors as plain arrays.

pub(crate) type Vec3 = [f64; 3];

pub(crate) fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn scale(s: f64, a: Vec3) -> Vec3 {
    [s * a[0], s * a[1], s * a[2]]
}

pub(crate) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn length(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

pub(crate) fn normalize(a: Vec3) -> Vec3 {
    scale(1.0 / length(a), a)
}

pub(crate) fn is_finite(a: Vec3) -> bool {
    a.iter().all(|x| x.is_finite())
}

/// Largest absolute difference of a component; NaN when any component is NaN.
pub(crate) fn distance_max(a: Vec3, b: Vec3) -> f64 {
    let worst = |x: f64, y: f64| if x.is_nan() || y.is_nan() { f64::NAN } else { x.max(y) };
    let d = sub(a, b).map(f64::abs);
    worst(worst(d[0], d[1]), d[2])
}

/// Two unit vectors that complete a unit vector to a right-handed frame (s, t, n).
pub(crate) fn frame(n: Vec3) -> (Vec3, Vec3) {
    // The axis least aligned with n keeps the cross product well conditioned.
    let axis = if n[0].abs() < n[1].abs().min(n[2].abs()) {
        [1.0, 0.0, 0.0]
    } else if n[1].abs() < n[2].abs() {
        [0.0, 1.0, 0.0]
    } else {
        [0.0, 0.0, 1.0]
    };
    let s = normalize(cross(axis, n));
    (s, cross(n, s))
}

/// The vector nearest to `a` that a subject of the given machine epsilon can represent, so that rounding the input is
/// not counted against it.
pub(crate) fn representable(a: Vec3, epsilon: f64) -> Vec3 {
    a.map(|x| representable_scalar(x, epsilon))
}

/// The number nearest to `x` that a subject of the given machine epsilon can represent.
pub(crate) fn representable_scalar(x: f64, epsilon: f64) -> f64 {
    if epsilon > 1e-10 { f64::from(x as f32) } else { x }
}
