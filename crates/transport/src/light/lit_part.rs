//! Places of a ray that are chosen for the light of one lamp without area: evenly within a beam, by the angle at which a point sees them
//! otherwise.

use super::Light;
use crate::media::{Equiangular, Way};

/// The part of a way that a lamp's light comes to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LitPart {
    ends: [f64; 2],
    /// Of a lamp at a point.
    by_angle: Option<Equiangular>,
}

impl LitPart {
    /// `None` where none of the light comes, or the way goes along a beam for ever.
    pub(crate) fn new(light: &Light, way: &Way) -> Option<Self> {
        let ends = light.lit_part(way)?;
        let by_angle = match light.position() {
            Some(point) => Some(Equiangular::new(way, ends, point)?),
            None if ends[1].is_finite() => None,
            None => return None,
        };
        Some(Self { ends, by_angle })
    }

    /// How far it is from the lamp, or, in a beam, from where the way begins.
    pub(crate) fn beside(&self) -> f64 {
        self.by_angle.map_or(self.ends[0], |by_angle| by_angle.beside())
    }

    /// Draws a distance along the way.
    pub(crate) fn distance(&self, u: f64) -> f64 {
        let [first, last] = self.ends;
        self.by_angle.map_or(first + (last - first) * u, |by_angle| by_angle.distance(u))
    }

    /// The density with which [`LitPart::distance`] draws a distance, per unit of length.
    pub(crate) fn density(&self, distance: f64) -> f64 {
        let [first, last] = self.ends;
        match self.by_angle {
            _ if distance < first || distance > last => 0.0,
            Some(by_angle) => by_angle.density(distance),
            None => 1.0 / (last - first),
        }
    }
}
