//! The media that hold the origin of a camera ray.

use crate::film::Counters;
use crate::media::{Media, MediumStack, PlacedMedia};
use crate::scene::world::World;
use etalon_geometry::{Passed, Ray};

impl<'a> World<'a> {
    /// The media that hold the origin of a ray, where they are followed.
    #[inline(always)]
    pub(crate) fn media_around(&self, ray: &Ray<f64>, counters: &mut Counters) -> Option<MediumStack<'a>> {
        self.follows_media().then(|| self.find_media_around(ray, counters))
    }

    fn find_media_around(&self, ray: &Ray<f64>, counters: &mut Counters) -> MediumStack<'a> {
        let solids = self.media.map(|media| self.entered_solids(media, ray, counters));
        let mut stack = solids.unwrap_or(MediumStack::NOTHING);
        stack.meet(self.participating.and_then(|_| self.entered_body(ray)), false);
        stack
    }

    /// The solids whose first boundary along a ray is left, not entered.
    fn entered_solids(&self, media: &Media, ray: &Ray<f64>, counters: &mut Counters) -> MediumStack<'a> {
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
            if media.is_boundary(place.0) && !known.holds(place) {
                let leaves = point.normal.dot(ray.direction) > 0.0;
                let counted = known.cross(place, true) && (!leaves || stack.cross(place, true));
                counters.lost_media += u64::from(!counted);
            }
        }
        stack
    }

    /// The body that states both its sides and holds the origin of a ray: that of the first such surface along it, whatever stands before
    /// that, if the ray comes to it from within. What lies outside of a surface that is met from without is known where nothing stands
    /// before it: [`MediumStack::meet`] finds that.
    fn entered_body(&self, ray: &Ray<f64>) -> Option<PlacedMedia<'a>> {
        let mut passed = Passed::NOTHING;
        while let Some(hit) = self.geometry.next_hit(ray, &passed) {
            let point = self.geometry.surface(ray, &hit);
            if let Some(stated) = self.surfaces.of(&point).stated_media() {
                return (point.normal.dot(ray.direction) >= 0.0).then_some((stated, point.surface.instance));
            }
            passed.pass(&hit, hit.t);
        }
        None
    }
}
