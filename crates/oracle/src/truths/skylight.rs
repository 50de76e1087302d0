//! Standard skies of the CIE, by formula, and what comes of them through openings.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::quadrature::rectangle;
use crate::vector::{Vec3, add, cross, dot, length, normalize, scale, sub};

/// a, b, c, d and e of the skies 1 to 15 (CIE S 011/E:2003, ISO 15469:2004).
const SKIES: [[f64; 5]; 15] = [
    [4.0, -0.70, 0.0, -1.0, 0.00],
    [4.0, -0.70, 2.0, -1.5, 0.15],
    [1.1, -0.80, 0.0, -1.0, 0.00],
    [1.1, -0.80, 2.0, -1.5, 0.15],
    [0.0, -1.00, 0.0, -1.0, 0.00],
    [0.0, -1.00, 2.0, -1.5, 0.15],
    [0.0, -1.00, 5.0, -2.5, 0.30],
    [0.0, -1.00, 10.0, -3.0, 0.45],
    [-1.0, -0.55, 2.0, -1.5, 0.15],
    [-1.0, -0.55, 5.0, -2.5, 0.30],
    [-1.0, -0.55, 10.0, -3.0, 0.45],
    [-1.0, -0.32, 10.0, -3.0, 0.45],
    [-1.0, -0.32, 16.0, -3.0, 0.30],
    [-1.0, -0.15, 16.0, -3.0, 0.30],
    [-1.0, -0.15, 24.0, -2.8, 0.15],
];

/// A sky over a world whose zenith is +z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sky {
    /// 1 to 16.
    pub number: usize,
    /// Unit vector toward the sun.
    pub sun: Vec3,
    /// Radiance from below the horizon, over that of the zenith.
    pub ground: f64,
    /// φ(0) f(Zₛ).
    zenith: f64,
}

impl Sky {
    pub(super) fn new(number: usize, sun: Vec3) -> Self {
        let mut sky = Self { number, sun: normalize(sun), ground: 0.0, zenith: 1.0 };
        sky.zenith = sky.formula(1.0, sky.sun[2].clamp(-1.0, 1.0).acos());
        sky
    }

    /// φ(Z) f(χ) of cos Z and of χ, the angle from the sun.
    fn formula(&self, cos: f64, chi: f64) -> f64 {
        let Some(&[a, b, c, d, e]) = SKIES.get(self.number - 1) else {
            return (1.0 + 2.0 * cos) / 3.0;
        };
        let gradation = if cos > 0.0 { 1.0 + a * (b / cos).exp() } else { 1.0 };
        gradation * (1.0 + c * ((d * chi).exp() - (d * FRAC_PI_2).exp()) + e * chi.cos().powi(2))
    }

    /// Radiance from a direction over that of the zenith: φ(Z) f(χ)/(φ(0) f(Zₛ)).
    pub(super) fn relative(&self, toward: Vec3) -> f64 {
        let cos = toward[2] / length(toward);
        if cos < 0.0 {
            return self.ground;
        }
        let chi = length(cross(toward, self.sun)).atan2(dot(toward, self.sun));
        self.formula(cos, chi) / self.zenith
    }

    /// Irradiance on a plane of this unit normal from the sky alone, for a zenith of radiance 1, to about 2e-5.
    pub(super) fn irradiance(&self, normal: Vec3) -> f64 {
        let (across, middle) = (normal[0].hypot(normal[1]), normal[1].atan2(normal[0]));
        // Around the sun radiance has a kink: it comes to lie in the corner of each part.
        let from_middle = (self.sun[1].atan2(self.sun[0]) - middle + 3.0 * PI).rem_euclid(TAU) - PI;
        let over = |sin: f64, share: f64, side: f64| {
            // Over the sine of the elevation, in which solid angle is even; its square, since b/cos Z is steep at the horizon.
            let height = sin * sin;
            let level = (1.0 - height * height).sqrt();
            // Up to the azimuths at which the plane ends.
            let half = if across > 0.0 { (-height * normal[2] / (level * across)).clamp(-1.0, 1.0).acos() } else { PI };
            let sun = from_middle.clamp(-half, half);
            let reach = side * half - sun;
            let azimuth = middle + sun + reach * share;
            let toward = [level * azimuth.cos(), level * azimuth.sin(), height];
            2.0 * sin * reach.abs() * self.relative(toward) * dot(toward, normal).max(0.0)
        };
        let sun = self.sun[2].clamp(0.0, 1.0).sqrt();
        let part = |heights: [f64; 2], side: f64| {
            rectangle(|sin, share| over(sin, share, side), heights, [0.0, 1.0], 5e-6, 100_000).value
        };
        [[0.0, sun], [sun, 1.0]].into_iter().map(|heights| part(heights, -1.0) + part(heights, 1.0)).sum()
    }

    /// The same by midpoints over the angles.
    pub(super) fn irradiance_by_midpoints(&self, normal: Vec3) -> f64 {
        by_midpoints(normal, |toward| self.relative(toward))
    }
}

/// Irradiance on a plane of this unit normal from above, by midpoints over the angles.
pub(super) fn by_midpoints(normal: Vec3, radiance: impl Fn(Vec3) -> f64) -> f64 {
    midpoints([1500, 600], normal, radiance)
}

/// The same with so many angles from the zenith and so many azimuths.
pub(super) fn midpoints([rows, columns]: [u32; 2], normal: Vec3, radiance: impl Fn(Vec3) -> f64) -> f64 {
    let azimuth = |column: u32| TAU * (f64::from(column) + 0.5) / f64::from(columns);
    let azimuths: Vec<(f64, f64)> = (0..columns).map(|column| azimuth(column).sin_cos()).collect();
    let over = |row: u32| {
        let (sine, cosine) = (FRAC_PI_2 * (f64::from(row) + 0.5) / f64::from(rows)).sin_cos();
        let at = |(sin, cos): &(f64, f64)| {
            let toward = [sine * cos, sine * sin, cosine];
            radiance(toward) * dot(toward, normal).max(0.0)
        };
        azimuths.iter().map(at).sum::<f64>() * sine
    };
    (0..rows).map(over).sum::<f64>() * (FRAC_PI_2 / f64::from(rows)) * (TAU / f64::from(columns))
}

/// A parallelogram that light comes through, seen from one side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Opening {
    pub origin: Vec3,
    pub edges: [Vec3; 2],
}

impl Opening {
    /// The opening in two parts, one above the other, if this height lies within it and its second edge is upright; else itself.
    pub(super) fn split_at(self, height: f64) -> Vec<Self> {
        let Self { origin, edges: [u, v] } = self;
        let share = (height - origin[2]) / v[2];
        if u[2] != 0.0 || !(share > 0.0 && share < 1.0) {
            return vec![self];
        }
        let [low, high] = [scale(share, v), scale(1.0 - share, v)];
        vec![Self { origin, edges: [u, low] }, Self { origin: add(origin, low), edges: [u, high] }]
    }

    /// Irradiance at a point on a plane of this unit normal, of light that comes through the opening: `radiance` of the direction from the
    /// point outward, and of its cosine to the opening's normal.
    pub(super) fn irradiance(&self, point: Vec3, normal: Vec3, radiance: impl Fn(Vec3, f64) -> f64) -> f64 {
        let over = self.integrand(point, normal, radiance);
        rectangle(over, [0.0, 1.0], [0.0, 1.0], 1e-6, 4_000_000).value
    }

    /// The same by midpoints.
    pub(super) fn irradiance_by_midpoints(
        &self,
        point: Vec3,
        normal: Vec3,
        radiance: impl Fn(Vec3, f64) -> f64,
    ) -> f64 {
        let over = self.integrand(point, normal, radiance);
        let cells = 1000;
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(cells);
        let sum: f64 = (0..cells).map(|i| (0..cells).map(|j| over(at(i), at(j))).sum::<f64>()).sum();
        sum / f64::from(cells * cells)
    }

    /// The integrand over the unit square.
    fn integrand(&self, point: Vec3, normal: Vec3, radiance: impl Fn(Vec3, f64) -> f64) -> impl Fn(f64, f64) -> f64 {
        let Self { origin, edges: [u, v] } = *self;
        let across = cross(u, v);
        let area = length(across);
        let face = scale(1.0 / area, across);
        move |a: f64, b: f64| {
            let way = sub(add(origin, add(scale(a, u), scale(b, v))), point);
            let distance = length(way);
            let toward = scale(1.0 / distance, way);
            let (here, there) = (dot(toward, normal).max(0.0), dot(toward, face).abs());
            radiance(toward, there) * here * there * area / (distance * distance)
        }
    }
}

/// Transmittance for unpolarised light of a slab of index n and internal transmittance e^(−τ/cos θₜ): s and p apart, all reflections added.
pub(super) fn slab(cos: f64, n: f64, tau: f64) -> f64 {
    let inner = (1.0 - (1.0 - cos * cos) / (n * n)).sqrt();
    let through = (-tau / inner).exp();
    let of = |r: f64| {
        let reflectance = r * r;
        through * (1.0 - reflectance).powi(2) / (1.0 - (reflectance * through).powi(2))
    };
    let s = (cos - n * inner) / (cos + n * inner);
    let p = (n * cos - inner) / (n * cos + inner);
    0.5 * (of(s) + of(p))
}

/// A direction of this elevation and azimuth from +x, degrees.
pub(super) fn direction(elevation_deg: f64, azimuth_deg: f64) -> Vec3 {
    let (sin, cos) = elevation_deg.to_radians().sin_cos();
    let (y, x) = azimuth_deg.to_radians().sin_cos();
    [cos * x, cos * y, sin]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn the_uniform_sky_is_uniform_and_the_overcast_ones_agree_roughly() {
        let sun = direction(40.0, 70.0);
        let even = Sky::new(5, sun);
        assert!((even.irradiance([0.0, 0.0, 1.0]) - PI).abs() < 1e-6);
        assert!((even.irradiance_by_midpoints([0.0, 0.0, 1.0]) - PI).abs() < 1e-5);
        // ∫ (1 + 2 cos)/3 cos dω = π/3 + 4π/9.
        assert!((Sky::new(16, sun).irradiance([0.0, 0.0, 1.0]) - 7.0 * PI / 9.0).abs() < 1e-6);
        for number in 1..=16 {
            let sky = Sky::new(number, sun);
            assert!((sky.relative([0.0, 0.0, 1.0]) - 1.0).abs() < 1e-12, "{number}");
            let (a, b) = (sky.irradiance([0.6, 0.0, 0.8]), sky.irradiance_by_midpoints([0.6, 0.0, 0.8]));
            assert!((a - b).abs() < 2e-4 * a, "{number}: {a} {b}");
        }
        // The standard overcast sky has a third of the zenith's luminance at the horizon, to a few percent.
        let ratio = Sky::new(1, sun).relative([1.0, 0.0, 0.0]);
        assert!((ratio - 1.0 / 3.0).abs() < 0.01, "{ratio}");
    }

    #[test]
    fn an_opening_over_the_room_is_the_known_configuration_factor() {
        // A point 0.25 m below the edge of an opening of 4 × 4 m, on the wall.
        let opening = Opening { origin: [0.0, -2.0, 3.0], edges: [[4.0, 0.0, 0.0], [0.0, 4.0, 0.0]] };
        let factor = opening.irradiance([0.0, 0.0, 2.75], [1.0, 0.0, 0.0], |_, _| 1.0) / PI;
        let root = 16.0625_f64.sqrt();
        let closed = (8.0_f64.atan() - 0.25 / root * (2.0 / root).atan()) / PI;
        assert!((closed - 0.451_23).abs() < 5e-6, "{closed}");
        assert!((factor - closed).abs() < 1e-6, "{factor}");
    }

    #[test]
    fn a_slab_at_right_angles_is_the_known_one() {
        let r = (0.52_f64 / 2.52).powi(2);
        assert!((slab(1.0, 1.52, 0.0) - (1.0 - r) / (1.0 + r)).abs() < 1e-15);
        assert!(slab(0.01, 1.52, 0.0) < 0.1);
    }
}
