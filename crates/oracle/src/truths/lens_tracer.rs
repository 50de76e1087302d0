//! Lenses by the oracle's own means: axial matrices, and rays that find each surface by bisection.
//!
//! Nothing is shared with a renderer. Lengths are millimetres, z grows from the scene to the film, and the first vertex is at 0.

use crate::vector::{Vec3, add, dot, normalize, scale};

/// A surface of a lens: curvature, mm⁻¹; conic constant; A₄, A₆ …; thickness behind it; index behind it; radius of its aperture.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    pub curvature: f64,
    pub conic: f64,
    pub aspheric: Vec<f64>,
    pub thickness: f64,
    pub index: f64,
    pub semi_aperture: f64,
}

/// A plane without power.
pub(super) fn aperture(semi_aperture: f64, thickness: f64) -> Surface {
    Surface { curvature: 0.0, conic: 0.0, aspheric: Vec::new(), thickness, index: 1.0, semi_aperture }
}

/// A spherical surface; a radius of 0 is flat.
pub(super) fn spherical(radius: f64, thickness: f64, index: f64, semi_aperture: f64) -> Surface {
    let curvature = if radius == 0.0 { 0.0 } else { 1.0 / radius };
    Surface { curvature, index, ..aperture(semi_aperture, thickness) }
}

impl Surface {
    fn sag(&self, squared: f64) -> f64 {
        let c = self.curvature;
        let conic = c * squared / (1.0 + (1.0 - (1.0 + self.conic) * c * c * squared).sqrt());
        let powers = self.aspheric.iter().enumerate();
        conic + powers.map(|(k, a)| a * squared.powi(k as i32 + 2)).sum::<f64>()
    }

    /// A normal, by central differences of the sag.
    fn normal(&self, [x, y]: [f64; 2]) -> Vec3 {
        let h = 1e-5 * self.semi_aperture;
        let along = |dx: f64, dy: f64| self.sag((x + dx).powi(2) + (y + dy).powi(2));
        normalize([-(along(h, 0.0) - along(-h, 0.0)) / (2.0 * h), -(along(0.0, h) - along(0.0, -h)) / (2.0 * h), 1.0])
    }

    /// How far along a ray it is met. The ray must cross the slab that holds the surface once.
    fn distance(&self, vertex: f64, origin: Vec3, direction: Vec3) -> Option<f64> {
        let depth = self.sag(self.semi_aperture * self.semi_aperture).abs() * 1.5 + 1e-3;
        let at = |z: f64| (z - origin[2]) / direction[2];
        let off = |t: f64| {
            let p = add(origin, scale(t, direction));
            p[2] - vertex - self.sag(p[0] * p[0] + p[1] * p[1])
        };
        let (mut low, mut high) = (at(vertex + depth), at(vertex - depth));
        // A ray from the film comes from larger z.
        if !(off(low) > 0.0 && off(high) < 0.0) {
            return None;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if off(middle) > 0.0 { low = middle } else { high = middle }
        }
        Some(0.5 * (low + high))
    }
}

/// A lens, and the distance from its last vertex to the film.
#[derive(Clone, Debug)]
pub(super) struct Lens {
    pub surfaces: Vec<Surface>,
    pub film: f64,
}

impl Lens {
    /// The matrix of (y, slope) from before the first surface to behind the last, in air on both sides.
    pub(super) fn matrix(&self) -> [[f64; 2]; 2] {
        let mut matrix = [[1.0, 0.0], [0.0, 1.0]];
        let mut before = 1.0;
        let count = self.surfaces.len();
        for (i, surface) in self.surfaces.iter().enumerate() {
            let behind = surface.index;
            let bend = [[1.0, 0.0], [(before - behind) * surface.curvature / behind, before / behind]];
            matrix = product(bend, matrix);
            if i + 1 < count {
                matrix = product([[1.0, surface.thickness], [0.0, 1.0]], matrix);
            }
            before = behind;
        }
        matrix
    }

    /// Behind the last vertex, the image of a point so far before the first.
    pub(super) fn image(&self, object: f64) -> f64 {
        let [[a, b], [c, d]] = self.matrix();
        -(a * object + b) / (c * object + d)
    }

    /// Height on the film of the ray that leaves a height at a distance before the first vertex for the axis at the first vertex, where the
    /// stop is.
    pub(super) fn height_on_film(&self, object: f64, height: f64) -> f64 {
        let [[_, b], [_, d]] = self.matrix();
        (b + self.film * d) * -height / object
    }

    /// The same surfaces met in the other order.
    pub(super) fn reversed(&self) -> Self {
        let count = self.surfaces.len();
        let before = |i: usize| if i == 0 { 1.0 } else { self.surfaces[i - 1].index };
        let turned = (0..count).rev().map(|i| {
            let surface = &self.surfaces[i];
            let thickness = if i == 0 { 0.0 } else { self.surfaces[i - 1].thickness };
            Surface { curvature: -surface.curvature, index: before(i), thickness, ..surface.clone() }
        });
        Self { surfaces: turned.collect(), film: self.film }
    }

    /// Follows a ray from a point of the film toward a point of the last vertex plane. Returns where it leaves the first surface, its
    /// direction there, and the share of unpolarised light that comes through bare glass.
    pub(super) fn trace(&self, film: [f64; 2], toward: [f64; 2]) -> Option<(Vec3, Vec3, f64)> {
        let count = self.surfaces.len();
        let mut vertex: f64 = self.surfaces[..count - 1].iter().map(|surface| surface.thickness).sum();
        let mut origin = [film[0], film[1], vertex + self.film];
        let mut direction = normalize([toward[0] - film[0], toward[1] - film[1], -self.film]);
        let mut share = 1.0;
        for i in (0..count).rev() {
            let surface = &self.surfaces[i];
            origin = add(origin, scale(surface.distance(vertex, origin, direction)?, direction));
            if origin[0].hypot(origin[1]) > surface.semi_aperture {
                return None;
            }
            let before = if i == 0 { 1.0 } else { self.surfaces[i - 1].index };
            if before != surface.index {
                let normal = surface.normal([origin[0], origin[1]]);
                let ratio = surface.index / before;
                let cos_i = -dot(direction, normal);
                let cos_t2 = 1.0 - ratio * ratio * (1.0 - cos_i * cos_i);
                if cos_t2 <= 0.0 {
                    return None;
                }
                let cos_t = cos_t2.sqrt();
                let s = (ratio * cos_i - cos_t) / (ratio * cos_i + cos_t);
                let p = (cos_i - ratio * cos_t) / (cos_i + ratio * cos_t);
                share *= 1.0 - 0.5 * (s * s + p * p);
                direction = normalize(add(scale(ratio, direction), scale(ratio * cos_i - cos_t, normal)));
            }
            if i > 0 {
                vertex -= self.surfaces[i - 1].thickness;
            }
        }
        Some((origin, direction, share))
    }

    /// The share of the light on the middle of the film that comes from a disk on the axis, at a distance before the last vertex. It is
    /// counted over rays in the meridian that meet the last vertex plane no farther than `reach` from the axis.
    pub(super) fn share_from_disk(&self, reach: f64, distance: f64, radius: f64) -> f64 {
        const RAYS: u32 = 400;
        let (mut all, mut from_disk) = (0.0, 0.0);
        for i in 0..RAYS {
            let y = reach * (f64::from(i) + 0.5) / f64::from(RAYS);
            let Some((at, direction, _)) = self.trace([0.0; 2], [0.0, y]) else { continue };
            let weight = y / (y * y + self.film * self.film).powi(2);
            let height = at[1] - direction[1] / direction[2] * (distance + at[2]);
            all += weight;
            from_disk += if height.abs() < radius { weight } else { 0.0 };
        }
        from_disk / all
    }

    /// Where on the film, at x = 0, a ray must begin that leaves the middle of the first surface for a height at a distance before it. It is
    /// found by bisection over the film, and over the last plane for the ray that meets that middle.
    pub(super) fn traced_height_on_film(&self, object: f64, height: f64, guess: f64) -> f64 {
        let slope_of = |film: f64| {
            let radius = self.surfaces.last().expect("a surface").semi_aperture;
            let at_first = |y: f64| self.trace([0.0, film], [0.0, y]).map(|(at, _, _)| at[1]);
            // The rays that come through, and the one among them that meets the first surface in its middle.
            let steps = 20_000;
            let open: Vec<(f64, f64)> = (0..=steps)
                .map(|i| radius * (2.0 * f64::from(i) / f64::from(steps) - 1.0))
                .filter_map(|y| Some((y, at_first(y)?)))
                .collect();
            let pair = open.windows(2).find(|pair| pair[0].1 * pair[1].1 <= 0.0).expect("a ray through the middle");
            let share = pair[0].1 / (pair[0].1 - pair[1].1);
            let y = pair[0].0 + share * (pair[1].0 - pair[0].0);
            let (_, direction, _) = self.trace([0.0, film], [0.0, y]).expect("it comes through");
            -direction[1] / direction[2] * object
        };
        // The height seen grows evenly with that on the film over so short a way.
        let (a, b) = (0.9 * guess, 1.1 * guess);
        let (seen_a, seen_b) = (slope_of(a), slope_of(b));
        a + (b - a) * (height - seen_a) / (seen_b - seen_a)
    }
}

fn product(a: [[f64; 2]; 2], b: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    [0, 1].map(|i| [0, 1].map(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
}
