//! The hits that a walk along a ray leaves behind.

use crate::{Hit, SurfaceId};

/// The hits of one ray that a walk has passed: all below a distance, and some named ones from that distance on.
///
/// A walk through surfaces that let it pass keeps its ray and asks [`Geometry::next_hit`](crate::Geometry::next_hit) for what
/// comes after these.
#[derive(Clone, Debug, Default)]
pub struct Passed {
    from: f64,
    /// Distances and surfaces. A curved surface may be hit twice, at two distances.
    named: Vec<(f64, SurfaceId)>,
}

impl Passed {
    /// Nothing is passed yet.
    pub const NOTHING: Self = Self { from: 0.0, named: Vec::new() };

    /// Forgets all that was passed, for another ray.
    pub fn clear(&mut self) {
        self.from = 0.0;
        self.named.clear();
    }

    /// Whether nothing is passed yet.
    pub fn is_nothing(&self) -> bool {
        self.named.is_empty()
    }

    /// The distance below which all is passed.
    pub fn from(&self) -> f64 {
        self.from
    }

    /// Passes a hit, and all that is closer than `from`, which is at most the hit's own distance. A smaller `from` keeps what
    /// lies before the hit, as far as it is not passed itself.
    pub fn pass(&mut self, hit: &Hit<f64>, from: f64) {
        self.from = self.from.max(from);
        self.named.retain(|&(t, _)| t >= self.from);
        self.named.push((hit.t, hit.surface));
    }

    /// Whether a hit is passed.
    pub fn holds(&self, hit: &Hit<f64>) -> bool {
        hit.t < self.from || self.named.contains(&(hit.t, hit.surface))
    }
}
