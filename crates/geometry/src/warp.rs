//! Maps from the unit square to disks, hemispheres and spheres.

use etalon_optics::{Real, Vec3};

/// Uniform point of the unit disk, by the concentric map of Shirley & Chiu 1997 (area-preserving, low distortion).
#[inline(always)]
pub fn concentric_disk(u: [f64; 2]) -> [f64; 2] {
    let a = 2.0 * u[0] - 1.0;
    let b = 2.0 * u[1] - 1.0;
    // Choices without branches, so that a loop over points is vectorised.
    let wide = a.abs() > b.abs();
    let (radius, other) = if wide { (a, b) } else { (b, a) };
    // The angle in turns, within an eighth of an axis; NaN in the middle.
    let eighth = 0.125 * (other / radius);
    let turns = if wide { eighth } else { 0.25 - eighth };
    let turns = if turns < 0.0 { turns + 1.0 } else { turns };
    let (sin, cos) = f64::sin_cos_turns(turns);
    if radius == 0.0 { [0.0, 0.0] } else { [radius * cos, radius * sin] }
}

/// Direction about +z with density cos θ / π (Malley's method).
#[inline(always)]
pub fn cosine_hemisphere(u: [f64; 2]) -> Vec3<f64> {
    let [x, y] = concentric_disk(u);
    Vec3::new(x, y, (1.0 - x * x - y * y).sqrt_nonnegative())
}

/// Uniform direction, density 1/4π.
#[inline]
pub fn uniform_sphere(u: [f64; 2]) -> Vec3<f64> {
    let z = 1.0 - 2.0 * u[0];
    // 1 − z² without cancellation.
    let radius = 2.0 * (u[0] * (1.0 - u[0])).sqrt_nonnegative();
    let (sin, cos) = f64::sin_cos_turns(u[1]);
    Vec3::new(radius * cos, radius * sin, z)
}

/// Direction uniform in the cone about +z whose half angle has 1 − cos = `one_minus_cos`.
#[inline(always)]
pub fn uniform_cone(u: [f64; 2], one_minus_cos: f64) -> Vec3<f64> {
    let a = u[0] * one_minus_cos;
    let sin_theta = (a * (2.0 - a)).sqrt_nonnegative();
    let (sin, cos) = f64::sin_cos_turns(u[1]);
    Vec3::new(sin_theta * cos, sin_theta * sin, 1.0 - a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_axes_of_the_square_become_the_axes_of_the_disk() {
        let close = |u: [f64; 2], want: [f64; 2]| {
            let got = concentric_disk(u);
            assert!((got[0] - want[0]).hypot(got[1] - want[1]) < 1e-15, "{u:?}: {got:?} is not {want:?}");
        };
        close([0.5, 0.5], [0.0, 0.0]);
        for (u, r) in [(0.75, 0.5), (0.125, -0.75), (0.0, -1.0)] {
            close([u, 0.5], [r, 0.0]);
            close([0.5, u], [0.0, r]);
            // The diagonals, where both halves of the map meet.
            let d = r * 0.5_f64.sqrt();
            close([u, u], [d, d]);
            close([u, 1.0 - u], [d, -d]);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4096))]
        #[test]
        fn every_map_lands_on_its_domain(u0 in 0.0..1.0_f64, u1 in 0.0..1.0_f64, c in 0.0..2.0_f64) {
            let [x, y] = concentric_disk([u0, u1]);
            prop_assert!(x * x + y * y <= 1.0 + 1e-15);
            // Each direction is unit to a few roundoffs.
            for v in [cosine_hemisphere([u0, u1]), uniform_sphere([u0, u1]), uniform_cone([u0, u1], c)] {
                prop_assert!((v.length() - 1.0).abs() < 1e-15, "{v:?}");
            }
            prop_assert!(uniform_cone([u0, u1], c).z >= 1.0 - c - 1e-15);
        }
    }

    /// Moments on a 256 × 256 midpoint grid against their exact integrals. The grid's own error is
    /// largest at the rim of the hemisphere, where the cosine is a square root: n^-1.5 = 2.4e-4. A wrong density moves
    /// each moment by percents.
    #[test]
    fn moments_match_the_densities() {
        let n = 256;
        let mean = |f: &dyn Fn([f64; 2]) -> f64| {
            let grid = |i: usize| (i as f64 + 0.5) / n as f64;
            (0..n * n).map(|k| f([grid(k % n), grid(k / n)])).sum::<f64>() / (n * n) as f64
        };
        let close = |got: f64, want: f64| assert!((got - want).abs() < 2.4e-4, "{got} is not {want}");
        close(mean(&|u| concentric_disk(u)[0].powi(2)), 0.25);
        close(mean(&|u| cosine_hemisphere(u).z), 2.0 / 3.0);
        close(mean(&|u| uniform_sphere(u).x.powi(2)), 1.0 / 3.0);
        close(mean(&|u| uniform_sphere(u).z.powi(2)), 1.0 / 3.0);
        close(mean(&|u| uniform_cone(u, 0.25).z), 1.0 - 0.125);
    }
}
