//! The closed forms that truths are made of.

use std::f64::consts::PI;

use crate::vector::{Vec3, add, cross, dot, length, normalize, scale, sub};

/// Irradiance from a sphere of radiance 1 and radius R at distance d > R of its centre, which stands `tilt_rad` off the
/// receiver's normal; horizon included.
///
/// Wholly above the horizon: π(R/d)²·cosβ, since a sphere looks like the disk it projects to. Cut by the horizon: with
/// h = d/R and k² = 1 − h²cos²β, (cosβ·acos(−cosβ·√(h² − 1)/sinβ) − √(k²(h² − 1)))/h² + atan √(k²/(h² − 1)), which is the
/// area, projected on the receiver, of a spherical cap cut by the plane.
#[must_use]
pub fn sphere_irradiance(radius_m: f64, distance_m: f64, tilt_rad: f64) -> f64 {
    let (h, cosine) = (distance_m / radius_m, tilt_rad.cos());
    let (h2, k2) = (h * h, 1.0 - h * h * cosine * cosine);
    if k2 <= 0.0 {
        return PI / h2 * cosine.max(0.0);
    }
    let root = (h2 - 1.0).sqrt();
    let angle = (-cosine * root / tilt_rad.sin()).acos();
    (cosine * angle - k2.sqrt() * root) / h2 + (k2.sqrt() / root).atan()
}

/// Irradiance from a disk of radiance 1 on a plane parallel to it at height h, at a distance a from its axis:
/// (π/2)(1 − (Z − 2R²)/√(Z² − 4R²)) with R = r/a, H = h/a, Z = 1 + H² + R²; on the axis πr²/(r² + h²).
///
/// Howell, *A Catalog of Radiation Heat Transfer Configuration Factors*, B-13.
#[must_use]
pub fn disk_irradiance(radius_m: f64, height_m: f64, off_axis_m: f64) -> f64 {
    let (r2, h2, a2) = (radius_m * radius_m, height_m * height_m, off_axis_m * off_axis_m);
    // The same, multiplied through by a² so that it holds on the axis too.
    let z = a2 + h2 + r2;
    0.5 * PI * (1.0 - (z - 2.0 * r2) / (z * z - 4.0 * r2 * a2).sqrt())
}

/// Configuration factor (irradiance over π for radiance 1) of a rectangle a × b parallel to the receiver at height 1 above one of
/// its own corners: (A·atan(b/√(1+a²)) + B·atan(a/√(1+b²)))/2π, A = a/√(1+a²), B = b/√(1+b²).
#[must_use]
pub fn rectangle_corner_factor(a: f64, b: f64) -> f64 {
    let (ra, rb) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
    (a / ra * (b / ra).atan() + b / rb * (a / rb).atan()) / (2.0 * PI)
}

/// Configuration factor of an element to a cylinder of radius 1 and length l whose axis is at right angles to the element's normal,
/// at the height h > 1, and which has one end above the element, for L = l and H = h, X = (1 + H)² + L², Y = (1 − H)² + L²:
/// F = atan(L/√(H² − 1))/(πH) + (L/π)·((X − 2H)/(H√(XY))·atan √(X(H − 1)/(Y(H + 1))) − atan √((H − 1)/(H + 1))/H).
///
/// Howell, *A Catalog of Radiation Heat Transfer Configuration Factors*, B-30; 1/(2H) for a cylinder without end.
#[must_use]
pub fn cylinder_factor(length: f64, height: f64) -> f64 {
    let (l, h) = (length, height);
    let (x, y) = ((1.0 + h).powi(2) + l * l, (1.0 - h).powi(2) + l * l);
    let ratio = (h - 1.0) / (h + 1.0);
    let side = (l / ((h - 1.0) * (h + 1.0)).sqrt()).atan() / (PI * h);
    let ends = (x - 2.0 * h) / (h * (x * y).sqrt()) * (x / y * ratio).sqrt().atan() - ratio.sqrt().atan() / h;
    side + l / PI * ends
}

/// Lambert's formula (1760): irradiance at the origin, on a plane with the given unit normal, from a polygon of radiance 1
/// whose corners run counter-clockwise seen from the origin; the polygon is cut at the horizon first.
///
/// E = ½Σθᵢ(γᵢ·n), θᵢ the angle that edge i subtends and γᵢ the unit normal of the plane through it and the origin.
#[must_use]
pub fn lambert_polygon(corners: &[[f64; 3]], normal: [f64; 3]) -> f64 {
    signed_polygon(&clip(corners, normal), normal).abs()
}

/// The same without the cut: what lies below the horizon counts as negative.
pub(super) fn signed_polygon(corners: &[Vec3], normal: Vec3) -> f64 {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let sum: f64 = edges
        .map(|(a, b)| {
            let across = cross(*a, *b);
            let (sine, cosine) = (length(across), dot(*a, *b));
            if sine == 0.0 { 0.0 } else { sine.atan2(cosine) * dot(across, normal) / sine }
        })
        .sum();
    0.5 * sum
}

/// Sutherland & Hodgman's clip of a polygon at the plane through the origin.
fn clip(corners: &[Vec3], normal: Vec3) -> Vec<Vec3> {
    let mut kept = Vec::new();
    for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let (above, next) = (dot(*a, normal), dot(*b, normal));
        if above >= 0.0 {
            kept.push(*a);
        }
        if above * next < 0.0 {
            kept.push(add(*a, scale(above / (above - next), sub(*b, *a))));
        }
    }
    kept
}

/// Transmittance of a stack of lossless interfaces with the given reflectances, all orders of reflection added as powers:
/// (1 − T)/T = Σ Rᵢ/(1 − Rᵢ), because R/T adds up for lossless layers (Stokes 1862).
#[must_use]
pub fn stack_transmittance(reflectances: &[f64]) -> f64 {
    1.0 / (1.0 + reflectances.iter().map(|r| r / (1.0 - r)).sum::<f64>())
}

/// Diffuse external reflectance 2∫R(μ)μ dμ of a smooth interface to index n > 1, in Walsh's (1926) closed form as given by
/// Duntley (1942).
#[must_use]
pub fn walsh_reflectance(n: f64) -> f64 {
    let n2 = n * n;
    let n4 = n2 * n2;
    0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
        + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
        - 2.0 * n2 * n * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
        + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * n.ln()
}

/// Irradiance at a point by quadrature over a parallelogram of radiance 1: the second way.
pub(super) fn parallelogram_by_quadrature(origin: Vec3, u: Vec3, v: Vec3, at: Vec3, normal: Vec3) -> f64 {
    let area = cross(u, v);
    let integrand = |a: f64, b: f64| {
        let to = sub(add(origin, add(scale(a, u), scale(b, v))), at);
        let d2 = dot(to, to);
        dot(to, normal).max(0.0) * dot(to, area).abs() / (d2 * d2)
    };
    crate::quadrature::rectangle(integrand, [0.0, 1.0], [0.0, 1.0], 1e-11, 2_000_000).value
}

/// Irradiance at the origin by quadrature over a triangle of radiance 1.
pub(super) fn triangle_by_quadrature(a: Vec3, b: Vec3, c: Vec3, normal: Vec3) -> f64 {
    let area = cross(sub(b, a), sub(c, a));
    let integrand = |s: f64, t: f64| {
        // The square folded onto the triangle: corner b at s = 0, the edge b–c by t.
        let to = add(a, scale(s, add(sub(b, a), scale(t, sub(c, b)))));
        let d2 = dot(to, to);
        s * dot(to, normal).max(0.0) * dot(to, area).abs() / (d2 * d2)
    };
    crate::quadrature::rectangle(integrand, [0.0, 1.0], [0.0, 1.0], 1e-11, 2_000_000).value
}

/// Irradiance at a point by quadrature over a disk of radiance 1.
pub(super) fn disk_by_quadrature(center: Vec3, disk_normal: Vec3, radius: f64, at: Vec3, normal: Vec3) -> f64 {
    let (s, t) = crate::vector::frame(normalize(disk_normal));
    let integrand = |r: f64, phi: f64| {
        let point = add(center, add(scale(r * phi.cos(), s), scale(r * phi.sin(), t)));
        let to = sub(point, at);
        let d2 = dot(to, to);
        r * dot(to, normal).max(0.0) * dot(to, disk_normal).abs() / (d2 * d2)
    };
    crate::quadrature::rectangle(integrand, [0.0, radius], [0.0, 2.0 * PI], 1e-11, 2_000_000).value
}

/// Irradiance below the middle of a cylinder of radius 1, radiance 1 and length 2l at the height h, over the side that is seen.
pub(super) fn cylinder_by_quadrature(half_length: f64, height: f64) -> f64 {
    let integrand = |phi: f64, y: f64| {
        let (x, z) = (phi.sin(), height - phi.cos());
        let d2 = x * x + y * y + z * z;
        // Cosines at the element and at the cylinder, each times the distance.
        z * (height * phi.cos() - 1.0) / (d2 * d2)
    };
    let rim = (1.0 / height).acos();
    crate::quadrature::rectangle(integrand, [-rim, rim], [-half_length, half_length], 1e-11, 2_000_000).value
}

/// Irradiance by quadrature over the cone that a sphere of radiance 1 fills.
pub(super) fn sphere_by_quadrature(radius: f64, distance: f64, tilt_rad: f64) -> f64 {
    let s = radius / distance;
    let cone = crate::quadrature::Cone {
        axis: [tilt_rad.sin(), 0.0, tilt_rad.cos()],
        one_minus_cos: s * s / (1.0 + (1.0 - s * s).sqrt()),
    };
    crate::quadrature::directions(|d| d[2].max(0.0), cone, 1e-10, 3_000_000).value
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64, tolerance: f64) {
        assert!((a - b).abs() <= tolerance, "{a} is not {b}");
    }

    #[test]
    fn closed_forms_agree_with_quadrature() {
        for tilt in [0.0, 1.0, 1.3, 1.5, 1.8, 2.0] {
            close(sphere_irradiance(1.0, 2.0, tilt), sphere_by_quadrature(1.0, 2.0, tilt), 1e-7);
        }
        for off in [0.0, 0.5, 3.0] {
            let second = disk_by_quadrature([off, 0.0, 1.0], [0.0, 0.0, 1.0], 1.0, [0.0; 3], [0.0, 0.0, 1.0]);
            close(disk_irradiance(1.0, 1.0, off), second, 1e-9);
        }
        let corner =
            parallelogram_by_quadrature([0.0, 0.0, 1.0], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0; 3], [0.0, 0.0, 1.0]);
        close(PI * rectangle_corner_factor(2.0, 3.0), corner, 1e-9);
        for (length, height) in [(2.0, 3.0), (0.1, 1.2), (30.0, 2.0)] {
            close(2.0 * PI * cylinder_factor(length, height), cylinder_by_quadrature(length, height), 1e-8);
        }
        close(cylinder_factor(1e9, 3.0), 1.0 / 6.0, 1e-8);
        let corners = [[1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [0.0, 0.0, 2.0]];
        let up = [0.0, 0.0, 1.0];
        close(lambert_polygon(&corners, up), triangle_by_quadrature(corners[0], corners[1], corners[2], up), 1e-9);
        close(lambert_polygon(&corners, up), 0.302_299_894, 1e-9);
        let cut = [[1.0, -1.0, -1.0], [1.0, 1.0, -1.0], [1.0, 0.0, 2.0]];
        close(lambert_polygon(&cut, up), triangle_by_quadrature(cut[0], cut[1], cut[2], up), 1e-5);
    }

    #[test]
    fn walsh_agrees_with_quadrature_of_fresnel() {
        for n in [1.33, 1.5, 2.417] {
            let integrand = |mu: f64| 2.0 * mu * crate::laws::fresnel_exact(mu, n).reflectance();
            close(walsh_reflectance(n), crate::quadrature::interval(integrand, 0.0, 1.0, 1e-12).value, 1e-10);
        }
        close(walsh_reflectance(1.5), 0.091_777_959_4, 1e-10);
        // From inside, by the same light the other way: 1 − (1 − r)/n².
        close(1.0 - (1.0 - walsh_reflectance(1.5)) / 2.25, 0.596_345_76, 1e-8);
    }

    #[test]
    fn a_stack_of_one_plate_is_the_known_plate() {
        close(stack_transmittance(&[0.04, 0.04]), 2.0 * 1.5 / (1.5 * 1.5 + 1.0), 1e-15);
    }
}
