//! Directions of reflected and refracted rays: equation (1) as it was published, and as Snell's law has it.

use crate::vector::{Arithmetic, Vec3};

/// How refracted directions are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RefractionRule {
    /// Equation (1) of the report with its sign error; `RefractionIndex` is used as `ri` on the way in and out.
    AsPublished,
    /// Snell's law: `RefractionIndex` is the index of the body in air, and what cannot leave is reflected inside.
    Snell,
}

/// `d` mirrored at a surface with unit normal `n`; as long as `d` is.
pub fn reflect<A: Arithmetic>(d: Vec3, n: Vec3) -> Vec3 {
    d - A::dot(n, d) * (2.0 * n)
}

/// Equation (1) as published: `K = ri D + (ri (N·D) − √(1 − ri² (1 − (N·D)²))) N`, for a direction as long as it comes.
///
/// `None` where the root is of a negative number, for which the report has no answer. The sign of the first `N·D` belongs
/// to `−N·D`: with `ri` = 1 a ray that enters is bent to `D + 2 (N·D) N`, although there is nothing to bend it.
pub fn refract_as_published<A: Arithmetic>(ri: f64, d: Vec3, n: Vec3) -> Option<Vec3> {
    let cosine = A::dot(n, d);
    let radicand = 1.0 - ri * ri * (1.0 - cosine * cosine);
    (radicand >= 0.0).then(|| ri * d + (ri * cosine - radicand.sqrt()) * n)
}

/// Snell's law: `K = ri D − (ri (N·D) + √(1 − ri² (1 − (N·D)²))) N`, for unit `d` and unit `n` that oppose each other
/// (`N·D` ≤ 0), where `ri` is the index that `d` travels in over the index that `K` travels in.
///
/// `None` is total internal reflection.
pub fn refract_snell<A: Arithmetic>(ri: f64, d: Vec3, n: Vec3) -> Option<Vec3> {
    let cosine = A::dot(n, d);
    let radicand = 1.0 - ri * ri * (1.0 - cosine * cosine);
    (radicand >= 0.0).then(|| ri * d - (ri * cosine + radicand.sqrt()) * n)
}

/// Where a ray goes at a surface with outward unit normal `n`, by either rule; `None` where the ray ends.
pub fn refract<A: Arithmetic>(rule: RefractionRule, index: f64, d: Vec3, n: Vec3) -> Option<Vec3> {
    match rule {
        RefractionRule::AsPublished => refract_as_published::<A>(index, d, n),
        RefractionRule::Snell => {
            let d = A::normalize(d);
            let (ratio, facing) = if A::dot(d, n) < 0.0 { (1.0 / index, n) } else { (index, -1.0 * n) };
            Some(refract_snell::<A>(ratio, d, facing).unwrap_or_else(|| reflect::<A>(d, facing)))
        }
    }
}
