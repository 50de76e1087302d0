//! The closest hit so far, and what replaces it.

use crate::query::Query;
use crate::ray::{Found, RawHit};
use crate::{Primitive, PrimitiveId, SurfaceId};

/// The closest hit so far.
pub(crate) struct Best {
    hit: Option<(RawHit, PrimitiveId)>,
    /// The surface of the hit, if it is within an instance.
    within: Option<SurfaceId>,
    pub(crate) t_max: f64,
}

impl Best {
    pub(crate) fn new(t_max: f64) -> Self {
        Self { hit: None, within: None, t_max }
    }

    /// The hit with its surface.
    #[inline(always)]
    pub(crate) fn found(&self) -> Option<Found> {
        self.hit.map(|(hit, id)| (hit, self.within.unwrap_or(SurfaceId::from(id))))
    }

    /// Tests a primitive and tells whether its hit is the best so far.
    #[inline]
    pub(crate) fn test(&mut self, primitives: &[Primitive], query: &Query, id: PrimitiveId) -> bool {
        match &primitives[id.0 as usize] {
            // Left as a whole.
            Primitive::Instance(_) if query.leaves == id => false,
            Primitive::Instance(instance) => {
                let mut surface = None;
                let found = self.take(id, |t_max| {
                    let (hit, within) = instance.closest(query, t_max)?;
                    surface = Some(within);
                    Some(hit)
                });
                if found {
                    self.within = surface;
                }
                found
            }
            shape => self.take(id, |t_max| shape.intersect(query, t_max, query.leaves == id)),
        }
    }

    /// Takes what a test with a limit finds for a primitive, if it is the best so far.
    #[inline(always)]
    pub(crate) fn take(&mut self, id: PrimitiveId, intersect: impl FnOnce(f64) -> Option<RawHit>) -> bool {
        let found = intersect(self.limit(id));
        if let Some(hit) = found {
            self.set(hit, id);
        }
        found.is_some()
    }

    /// The end, exclusive, up to which a hit of a primitive is the best so far.
    #[inline(always)]
    pub(crate) fn limit(&self, id: PrimitiveId) -> f64 {
        // An equal distance counts for a lower id, whatever the order of the tests.
        match self.hit {
            Some((hit, best)) if id < best => hit.t.next_up(),
            _ => self.t_max,
        }
    }

    /// Takes a hit that is the best so far.
    #[inline(always)]
    pub(crate) fn set(&mut self, hit: RawHit, id: PrimitiveId) {
        self.hit = Some((hit, id));
        self.within = None;
        self.t_max = hit.t;
    }

    /// Takes a hit within an instance that is the best so far.
    #[inline(always)]
    pub(crate) fn set_in_instance(&mut self, hit: RawHit, id: PrimitiveId, surface: SurfaceId) {
        self.set(hit, id);
        self.within = Some(surface);
    }
}
