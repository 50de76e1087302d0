//! Points of a ray chosen by the angle at which a point sees them (Kulla & Fajardo, *Importance Sampling Techniques for Path Tracing in
//! Participating Media*, CGF 31(4), 2012).
//!
//! Light of a point lamp falls off as 1/d². A path that is scattered where its medium says comes near the lamp by chance, and finds very much
//! light there: the variance has no bound. With the angle, which takes ds/d² for its measure, this factor is gone.

use super::Way;
use etalon_optics::{Real, Vec3, atan2_turns};
use std::f64::consts::TAU;

/// A way as a point beside it sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Equiangular {
    /// Distance along the way of the place that is nearest to the point, and the distance of both.
    nearest: f64,
    beside: f64,
    /// Angles, in turns, at which the ends of the way are seen, from the nearest place on.
    ends: [f64; 2],
}

impl Equiangular {
    /// The part of a way between two distances; `None` where the point lies on its line, or sees it at no angle.
    pub(crate) fn new(way: &Way, [from, to]: [f64; 2], point: Vec3<f64>) -> Option<Self> {
        let toward = point - way.origin;
        let nearest = toward.dot(way.direction);
        let beside = (toward - way.direction * nearest).length();
        if beside == 0.0 {
            return None;
        }
        let angle = |distance: f64| match distance == f64::INFINITY {
            true => 0.25,
            false => atan2_turns(distance - nearest, beside),
        };
        let ends = [angle(from), angle(to)];
        (ends[1] > ends[0]).then_some(Self { nearest, beside, ends })
    }

    /// The distance of the point from the way's line.
    pub(crate) fn beside(&self) -> f64 {
        self.beside
    }

    /// Draws a distance along the way.
    pub(crate) fn distance(&self, u: f64) -> f64 {
        let [first, last] = self.ends;
        // The sine and cosine of turns from 0 on: a quarter is taken off again.
        let (sin, cos) = f64::sin_cos_turns(first + (last - first) * u + 0.25);
        self.nearest - self.beside * cos / sin
    }

    /// The density with which [`Equiangular::distance`] draws a distance, per unit of length.
    pub(crate) fn density(&self, distance: f64) -> f64 {
        let along = distance - self.nearest;
        self.beside / ((self.ends[1] - self.ends[0]) * TAU * (self.beside * self.beside + along * along))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_drawn_with_the_density_that_is_stated() {
        let direction = Vec3::new(0.36, 0.48, 0.8);
        let point = Vec3::new(0.5, -0.2, 0.3);
        for length in [2.0, f64::INFINITY] {
            let way = Way { origin: Vec3::new(0.1, 0.2, -0.5), direction, length, time: 0.0 };
            let seen = Equiangular::new(&way, [0.0, length], point).expect("it is beside the way");
            // The share of the light before the distance that is drawn by u is u.
            let mut share = 0.0;
            let mut at = 0.0;
            for i in 1..=100 {
                let to = seen.distance(f64::from(i) / 101.0);
                let n = 2_000;
                let step = (to - at) / f64::from(n);
                share += (0..n).map(|k| seen.density(at + (f64::from(k) + 0.5) * step)).sum::<f64>() * step;
                assert!((share - f64::from(i) / 101.0).abs() < 1e-6, "{length} {i}: {share}");
                assert!(to > at && to < length);
                at = to;
            }
        }
        let on_the_line = Way { origin: point, direction, length: 1.0, time: 0.0 };
        assert!(Equiangular::new(&on_the_line, [0.0, 1.0], point).is_none());
    }
}
