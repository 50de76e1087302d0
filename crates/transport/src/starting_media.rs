//! The media that hold the origin of a camera ray.

use crate::film::Counters;
use crate::media::{Media, MediumStack};
use crate::world::World;
use etalon_geometry::Ray;

impl World<'_> {
    /// The solids that hold the origin of a ray, where they are followed.
    #[inline(always)]
    pub(crate) fn solids_around(&self, ray: &Ray<f64>, counters: &mut Counters) -> Option<MediumStack> {
        self.media.map(|media| self.entered_solids(media, ray, counters))
    }

    /// The solids whose first boundary along a ray is left, not entered.
    fn entered_solids(&self, media: &Media, ray: &Ray<f64>, counters: &mut Counters) -> MediumStack {
        let mut hits = Vec::new();
        self.geometry.all_hits(ray, 0.0, |hit| {
            hits.push(hit);
            ray.t_max
        });
        hits.sort_by(|a, b| (a.t, a.surface).partial_cmp(&(b.t, b.surface)).expect("distances are numbers"));
        let (mut stack, mut known) = (MediumStack::NOTHING, MediumStack::NOTHING);
        for hit in hits {
            let point = self.geometry.surface(ray, &hit);
            let place = self.surfaces.placed_solid(&point);
            if media.is_boundary(place.0) && !known.iter().any(|other| other == place) {
                let leaves = point.normal.dot(ray.direction) > 0.0;
                let counted = known.cross(place, true) && (!leaves || stack.cross(place, true));
                counters.lost_media += u64::from(!counted);
            }
        }
        stack
    }
}
