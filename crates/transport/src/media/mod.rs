//! The media that a path is in.
//!
//! Which medium a stretch of a path runs through is known in two ways:
//!
//! **Solids with priorities** are tracked along the path (Schmidt & Budge, *Simple Nested Dielectrics in Ray Traced
//! Images*, JGT 7(2), 2002). Where several of them overlap, the one of the highest priority fills the place; of equal
//! priorities, the object that comes later in the scene. Both depend on the place alone, so a path and its reverse see the
//! same media. A boundary that does not change the medium is no surface at all: paths and shadow rays go through it, and it
//! is no vertex. Boundaries of solids may coincide, as where glass holds water. They are met together
//! ([`interaction`](crate::scene::interaction)), as one interface between the medium before all of them and the medium behind.
//! The boundary of a medium may carry a priority too. It has no index: at each place that of the dielectrics holds.
//!
//! **A dielectric that states both its sides** says it itself: a path that meets it from within has come through its interior, and one
//! that goes through it goes on in there, or leaves it. What such a body holds is surrounded by its interior as long as it is not itself
//! such a body. The same holds of a body of another material that is filled with a medium.
//! Such a dielectric may state a medium on its other side, too. A path that meets it from there has come through that medium. A path that
//! leaves its interior is in that medium, until it leaves another interior. Solids with priorities stand in it as in what surrounds the
//! scene: where one holds a place, such a dielectric there says nothing new.

mod albedo;
mod density;
mod equiangular;
mod interaction;
mod medium;
mod participating;
mod phase;

pub(crate) use density::Way;
pub(crate) use equiangular::Equiangular;
pub(crate) use interaction::{MediumInteraction, free_point};
pub(crate) use medium::{Coefficients, Medium};
pub(crate) use participating::{Participating, Stretch, optical_depth};

use crate::frame::SceneFrame;
use etalon_optics::RefractiveIndex;
use etalon_scene::Material;

static VACUUM: RefractiveIndex = RefractiveIndex::VACUUM;

/// Solids that a path can be in at once; more are counted as lost.
pub const DEPTH: usize = 16;

/// A solid that carries a priority.
#[derive(Clone, Debug)]
pub(crate) struct Solid {
    pub priority: u32,
    /// `None` of the boundary of a medium, which is no surface.
    pub index: Option<RefractiveIndex>,
    /// What fills it, if that does anything to light.
    pub medium: Option<Medium>,
}

/// A solid where it is placed: its object's number, and the instance (0 if it is in none).
pub(crate) type PlacedSolid = (u32, u32);

/// The media that hold a point of a path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MediumStack<'a> {
    /// The solids with priorities, in no order.
    places: [PlacedSolid; DEPTH],
    len: usize,
    /// The body around it that states both its sides.
    body: Option<PlacedMedia<'a>>,
    /// The surface whose exterior it is in, if that states a medium there.
    outside_of: Option<PlacedMedia<'a>>,
}

impl<'a> MediumStack<'a> {
    pub(crate) const NOTHING: Self = Self { places: [(0, 0); DEPTH], len: 0, body: None, outside_of: None };

    /// Whether anything is in it.
    #[inline(always)]
    pub(crate) fn is_in_a_body(&self) -> bool {
        self.len > 0 || self.body.is_some()
    }

    /// Corrects it before a dielectric that states both its sides. What lies on the side that is met is known if the dielectric states a
    /// medium there, as it always does of its interior.
    #[inline(always)]
    pub(crate) fn meet(&mut self, stated: Option<PlacedMedia<'a>>, from_front: bool) {
        let Some(stated) = stated else { return };
        if !from_front {
            self.body = Some(stated);
        } else if stated.0.exterior.is_some() && self.len == 0 {
            self.body = None;
            self.go_outside_of(stated);
        }
    }

    /// Comes to a place outside of a body. Where a solid holds that place, what the body states ends with the solid.
    #[inline(always)]
    fn go_outside_of(&mut self, stated: PlacedMedia<'a>) {
        if self.len == 0 {
            self.outside_of = stated.0.exterior.is_some().then_some(stated);
        }
    }

    /// The media behind such a dielectric.
    #[inline(always)]
    pub(crate) fn behind(&self, stated: Option<PlacedMedia<'a>>, from_front: bool) -> Self {
        let mut behind = *self;
        if let Some(stated) = stated {
            behind.body = from_front.then_some(stated);
            if !from_front {
                behind.go_outside_of(stated);
            }
        }
        behind
    }

    fn iter(&self) -> impl Iterator<Item = PlacedSolid> + '_ {
        self.places[..self.len].iter().copied()
    }

    /// Whether a solid holds it.
    pub(crate) fn holds(&self, place: PlacedSolid) -> bool {
        self.iter().any(|other| other == place)
    }

    /// The media behind boundaries of solids that coincide: each with its solid, and whether that is entered. Counts in `lost` what
    /// contradicts itself.
    pub(crate) fn crossed(&self, crossings: impl Iterator<Item = (PlacedSolid, bool)>, lost: &mut u64) -> Self {
        let mut crossed: Vec<(PlacedSolid, bool)> = Vec::new();
        for crossing in crossings {
            // Two faces of a mesh that meet in the edge that is hit are one boundary.
            if !crossed.contains(&crossing) {
                crossed.push(crossing);
            }
        }
        let mut beyond = *self;
        // First what is left, so that the order in which coincident boundaries are found does not matter.
        for enters in [false, true] {
            for &(place, _) in crossed.iter().filter(|crossing| crossing.1 == enters) {
                *lost += u64::from(!beyond.cross(place, enters));
            }
        }
        beyond
    }

    /// Goes through a boundary. False if that contradicts what was known: a solid is left that was never entered, or there
    /// are too many.
    pub(crate) fn cross(&mut self, place: PlacedSolid, enters: bool) -> bool {
        if enters {
            if self.len == DEPTH {
                return false;
            }
            self.places[self.len] = place;
            self.len += 1;
            return true;
        }
        let Some(at) = self.iter().position(|other| other == place) else { return false };
        self.len -= 1;
        self.places[at] = self.places[self.len];
        true
    }
}

/// What lies on both sides of a surface, and the instance that places it (0 if it is in none).
pub(crate) type PlacedMedia<'a> = (&'a StatedMedia, u32);

/// What lies on both sides of a dielectric that states both, or of a body that is filled. A medium is `None` if it does nothing to light.
#[derive(Clone, Debug)]
pub(crate) struct StatedMedia {
    pub interior: Option<Medium>,
    /// `None` where the surface does not say what lies there.
    pub exterior: Option<Option<Medium>>,
}

impl StatedMedia {
    /// Those of a material; `None` if the place decides them. Few of many materials state media.
    pub(crate) fn of(material: &Material, range_nm: [f64; 2], frame: &SceneFrame) -> Option<Box<Self>> {
        let is_filled = material.medium.is_some() && material.kind.solid().is_none();
        let medium = |medium| Medium::new(medium, range_nm, frame);
        let stated = || Self {
            interior: material.medium.as_deref().and_then(medium),
            exterior: material.exterior_medium.as_deref().map(medium),
        };
        (is_filled || material.kind.media().is_some()).then(|| Box::new(stated()))
    }
}

/// The two media at an interface, along the walk from the camera.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interface<'a> {
    /// The medium that the path comes through.
    pub incident: &'a RefractiveIndex,
    /// The medium behind the surface.
    pub transmitted: &'a RefractiveIndex,
}

/// The solids of a scene that carry priorities.
#[derive(Clone, Debug)]
pub(crate) struct Media {
    /// The solid that each object bounds.
    pub solids: Vec<Option<Solid>>,
}

impl Media {
    fn solid(&self, object: u32) -> Option<&Solid> {
        self.solids[object as usize].as_ref()
    }

    /// The solid whose medium fills a point.
    fn filling(&self, stack: &MediumStack<'_>) -> Option<PlacedSolid> {
        stack.iter().max_by_key(|&place| self.rank(place))
    }

    /// The solid whose index holds at a point: the one that would fill it if there were no boundaries of media.
    fn refracting(&self, stack: &MediumStack<'_>) -> Option<PlacedSolid> {
        stack.iter().filter(|&place| self.index(place).is_some()).max_by_key(|&place| self.rank(place))
    }

    fn index(&self, place: PlacedSolid) -> Option<&RefractiveIndex> {
        self.solid(place.0)?.index.as_ref()
    }

    /// Whether the same solid fills two places.
    pub(crate) fn filled_alike(&self, here: &MediumStack<'_>, there: &MediumStack<'_>) -> bool {
        self.filling(here) == self.filling(there)
    }

    /// Which of two solids at one place fills it: the greater.
    fn rank(&self, place: PlacedSolid) -> (Option<u32>, PlacedSolid) {
        (self.solid(place.0).map(|solid| solid.priority), place)
    }

    /// The solid that fills a place, if one does, and the instance that places it.
    #[inline]
    fn filling_solid(&self, stack: &MediumStack<'_>) -> Option<(&Solid, u32)> {
        self.filling(stack).and_then(|place| Some((self.solid(place.0)?, place.1)))
    }

    /// The index at a place.
    pub(crate) fn medium(&self, stack: &MediumStack<'_>) -> &RefractiveIndex {
        self.refracting(stack).and_then(|place| self.index(place)).unwrap_or(&VACUUM)
    }

    /// Whether an object is the boundary of a solid.
    pub(crate) fn is_boundary(&self, object: u32) -> bool {
        self.solid(object).is_some()
    }

    /// The object whose material decides what an interface does, between what holds the path before it and behind it. It is one of the
    /// solids whose index lies on either side, and which begin or end here: the one of the highest priority. `None` if the same solid's
    /// index holds on both sides. Then there is no interface.
    pub(crate) fn deciding(&self, before: &MediumStack<'_>, behind: &MediumStack<'_>) -> Option<Option<u32>> {
        let (near, far) = (self.refracting(before), self.refracting(behind));
        if near == far {
            return None;
        }
        let left = near.filter(|&place| !behind.holds(place));
        let entered = far.filter(|&place| !before.holds(place));
        let deciding = left.into_iter().chain(entered).max_by_key(|&place| self.rank(place));
        Some(deciding.map(|(object, _)| object))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Glass that holds juice stands in smoke, which has a priority, and a bubble that states the juice outside of it stands in the juice.
    #[test]
    fn where_a_solid_holds_a_place_what_a_surface_states_there_changes_nothing() {
        let states = |exterior| StatedMedia { interior: None, exterior };
        let (glass, bubble) = (states(None), states(Some(None)));
        for (solids, has_body, is_outside) in [(0, false, true), (1, true, false)] {
            let mut stack = MediumStack::NOTHING;
            (stack.body, stack.len) = (Some((&glass, 0)), solids);
            stack.meet(Some((&bubble, 0)), true);
            assert_eq!((stack.body.is_some(), stack.outside_of.is_some()), (has_body, is_outside), "{solids} solids");
        }
    }
}
