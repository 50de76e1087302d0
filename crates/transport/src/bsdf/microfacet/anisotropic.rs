//! Means over the facets that a direction sees, for facets of two widths.
//!
//! Divided by the widths along x and y, the facets become those of width 1, whose normals h′ fill the hemisphere evenly: a direction whose
//! own image is w′ sees them with the density 2(w′·h′)⁺/(π(1 + w′_z)) (Heitz 2018). The integral is over the azimuth of h′ and, along each
//! azimuth, over its polar angle. There P = (α_x p_x, α_y p_y) is the slope of the facet itself, and the places where something begins or
//! ends are conics of P: each azimuth meets them where a quadratic equation says.
//!
//! | place | equation, s the part of the direction along the surface, µ its cosine |
//! |---|---|
//! | seen no more | s·P + µ = 0 |
//! | reflected light meets the horizon | P² − 2s·P/µ = 1 |
//! | refracted light meets the horizon | P² − 2s·P/µ + (s² − η²)/µ² = 0 |
//! | total reflection begins at the cosine c | (s·P + µ)² = c²(1 + P²) |

use super::{Facet, Ggx, crowded, gauss_rule, refined};
use etalon_optics::Vec3;
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2};
use std::sync::LazyLock;

/// The most cuts of a polar angle: its ends, and what four quadratic equations say.
const MOST_CUTS: usize = 8;

/// See [`mean_over_facets`](super::mean_over_facets).
pub(super) fn mean(ggx: &Ggx, wo: Vec3<f64>, eta: Option<f64>, loss: impl Fn(&Facet) -> f64) -> f64 {
    static RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss_rule(6));
    let view = View::new(ggx, wo, eta);
    let between = |[first, last]: [f64; 2]| {
        let panel = |a: f64, b: f64| -> f64 {
            let at = |(x, weight): &(f64, f64)| {
                weight * view.along_azimuth(first + (last - first) * (a + (b - a) * x), &loss)
            };
            (b - a) * (last - first) * RULE.iter().map(at).sum::<f64>()
        };
        refined(panel, 3e-7, 1e-3)
    };
    view.azimuths().windows(2).map(|ends| [ends[0], ends[1]]).filter(|[first, last]| first < last).map(between).sum()
}

/// Facets as one direction sees them.
struct View<'a> {
    ggx: &'a Ggx,
    wo: Vec3<f64>,
    stretch: f64,
    /// Its image among facets of width 1.
    image: Vec3<f64>,
    /// Relative index behind the facets, if light that they refract may leave upward or not at all.
    eta: Option<f64>,
}

impl<'a> View<'a> {
    fn new(ggx: &'a Ggx, wo: Vec3<f64>, eta: Option<f64>) -> Self {
        let [x, y] = ggx.alpha;
        let image = Vec3::new(x * wo.x, y * wo.y, wo.z).normalized();
        Self { ggx, wo, stretch: ggx.stretch(wo), image, eta: eta.filter(|eta| *eta < 1.0) }
    }

    /// Azimuths in turn between which means are smooth: the axes of the surface, and facets that turn toward the direction, away from it
    /// and neither.
    fn azimuths(&self) -> [f64; 9] {
        let toward = self.image.y.atan2(self.image.x).rem_euclid(FRAC_PI_2);
        std::array::from_fn(|i| {
            let quarter = FRAC_PI_2 * (i / 2) as f64;
            if i % 2 == 0 { quarter } else { quarter + toward }
        })
    }

    /// Integral over the facets of one azimuth, of their visible density times `loss`.
    fn along_azimuth(&self, azimuth: f64, loss: &impl Fn(&Facet) -> f64) -> f64 {
        static RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| {
            let crowd = |(x, weight): &(f64, f64)| (crowded(*x).0, weight * crowded(*x).1);
            gauss_rule(14).iter().map(crowd).collect()
        });
        let (sin_phi, cos_phi) = azimuth.sin_cos();
        let (mu, [x, y]) = (self.wo.z, self.ggx.alpha);
        let (a, b) = (x * cos_phi, y * sin_phi);
        // P² = `square`·tan², s·P = `toward`·tan.
        let (square, toward) = (a * a + b * b, self.wo.x * a + self.wo.y * b);
        let mut cuts = Cuts { places: [0.0; MOST_CUTS], count: 1 };
        cuts.put(if toward < 0.0 { (mu / -toward).atan() } else { FRAC_PI_2 });
        cuts.put_roots(square, -toward / mu, -1.0);
        if let Some(eta) = self.eta {
            let along = (1.0 - mu) * (1.0 + mu);
            cuts.put_roots(square, -toward / mu, (along - eta * eta) / (mu * mu));
            let critical = (1.0 - eta) * (1.0 + eta);
            cuts.put_roots(toward * toward - critical * square, mu * toward, mu * mu - critical);
        }
        let along_image = self.image.x * cos_phi + self.image.y * sin_phi;
        let mut sum = 0.0;
        for ends in cuts.sorted().windows(2).filter(|ends| ends[0] < ends[1]) {
            for (share, weight) in RULE.iter() {
                let (sin, cos) = (ends[0] + (ends[1] - ends[0]) * share).sin_cos();
                let seen = (self.image.z * cos + along_image * sin).max(0.0);
                let h = Vec3::new(a * sin, b * sin, cos).normalized();
                let c = self.wo.dot(h).clamp(0.0, 1.0);
                let wi = self.wo.reflected_about(h);
                let mirrored = match wi.z > 0.0 {
                    true => wi.z * (mu + self.stretch) / (mu * self.ggx.stretch(wi) + wi.z * self.stretch),
                    false => 0.0,
                };
                sum += (ends[1] - ends[0]) * weight * seen * sin * loss(&Facet { cos: c, mirrored, h, wo: self.wo });
            }
        }
        2.0 * FRAC_1_PI / (1.0 + self.image.z) * sum
    }
}

/// Polar angles between which something is smooth; the first two are the ends.
struct Cuts {
    places: [f64; MOST_CUTS],
    count: usize,
}

impl Cuts {
    fn put(&mut self, angle: f64) {
        self.places[self.count] = angle;
        self.count += 1;
    }

    /// Where the tangent solves a·t² + 2b·t + c = 0, between the ends.
    fn put_roots(&mut self, a: f64, b: f64, c: f64) {
        let discriminant = b * b - a * c;
        if discriminant < 0.0 {
            return;
        }
        // Neither root is a difference of like numbers.
        let q = -(b + discriminant.sqrt().copysign(b));
        for tangent in [q / a, c / q] {
            let angle = tangent.atan();
            if angle > 0.0 && angle < self.places[1] {
                self.put(angle);
            }
        }
    }

    fn sorted(&mut self) -> &[f64] {
        let places = &mut self.places[..self.count];
        places.sort_by(f64::total_cmp);
        places
    }
}

#[cfg(test)]
mod tests {
    use super::super::mean_over_facets;
    use super::*;
    use etalon_scene::Microfacets;
    use std::f64::consts::TAU;

    fn facets(alpha: [f64; 2]) -> Ggx {
        Ggx::new(&Microfacets { alpha, rotation_rad: 0.0 })
    }

    fn toward(mu: f64, turns: f64) -> Vec3<f64> {
        let (sin, cos) = (TAU * turns).sin_cos();
        let along = ((1.0 - mu) * (1.0 + mu)).sqrt();
        Vec3::new(along * cos, along * sin, mu)
    }

    /// As for one width: to 5e-6 of all light.
    #[test]
    fn the_facets_that_a_direction_sees_together_fill_it() {
        for alpha in [[1e-4, 1.0], [0.03, 0.3], [0.8, 0.2], [1.0, 1e-3]] {
            for mu in [1e-6, 1e-3, 0.1, 0.7, 1.0] {
                for eta in [None, Some(1.5), Some(1.0 / 1.5), Some(1.0 / 2.4), Some(0.999), Some(1e-9)] {
                    for turns in [0.0, 0.04, 0.2, 0.25] {
                        let all = mean(&facets(alpha), toward(mu, turns), eta, |_| 1.0);
                        assert!((all - 1.0).abs() < 5e-6, "η {eta:?}, α {alpha:?} µ {mu} turns {turns}: {all}");
                    }
                }
            }
        }
    }

    /// Two equal widths are one, which another quadrature knows.
    #[test]
    fn equal_widths_have_the_mean_of_one() {
        for alpha in [0.01, 0.1, 0.5, 1.0] {
            let ggx = facets([alpha; 2]);
            for mu in [1e-3, 0.05, 0.3, 0.745, 0.95] {
                for eta in [None, Some(1.5), Some(1.0 / 1.5), Some(1.0 / 2.4)] {
                    // Fresnel's kink and both horizons.
                    let loss = |facet: &Facet| {
                        let reflected = eta.map_or(1.0, |eta| {
                            etalon_optics::fresnel::dielectric(facet.cos, eta).map_or(1.0, |f| f.reflectance)
                        });
                        1.0 - reflected * facet.mirrored
                    };
                    let truth = mean_over_facets(&ggx, toward(mu, 0.0), eta, loss);
                    for turns in [0.0, 0.1, 0.25, 0.6] {
                        let read = mean(&ggx, toward(mu, turns), eta, loss);
                        // The outer integral has no cuts where azimuths touch the cones of total reflection and of the horizon: at
                        // grazing angles it errs by some 1e-4 of the light.
                        assert!(
                            (read - truth).abs() < 1e-3,
                            "η {eta:?}, α {alpha} µ {mu} turns {turns}: {read} {truth}"
                        );
                    }
                }
            }
        }
    }
}
