//! Nested dielectrics: which medium a path is in where solids touch, overlap or float in each other.
//!
//! Solids that carry a priority are tracked along the path (Schmidt & Budge, *Simple Nested Dielectrics in Ray Traced
//! Images*, JGT 7(2), 2002). Where several of them overlap, the one of the highest priority fills the place; of equal
//! priorities, the object that comes later in the scene. Both depend on the place alone, so a path and its reverse see the
//! same media. A boundary that does not change the medium is no surface at all: paths and shadow rays go through it, and it
//! is no vertex.
//!
//! Boundaries of two solids may coincide, as where glass holds water. They are found together, as one interface between the
//! medium before both and the medium behind both; an opaque surface that coincides with a boundary lies before it.

use crate::spectral::PathSpectrum;
use crate::surface::{Surface, Surfaces};
use etalon_geometry::{Geometry, Hit, Ray, SurfaceId, SurfacePoint};
use etalon_optics::{RefractiveIndex, Vec3};
use etalon_scene::{Mesh, Shape};
use std::collections::HashMap;

static VACUUM: RefractiveIndex = RefractiveIndex::VACUUM;

/// Solids that a path can be in at once; more are counted as lost.
const DEPTH: usize = 16;

/// A solid that carries a priority.
#[derive(Clone, Debug)]
pub(crate) struct Solid {
    pub priority: u32,
    pub index: RefractiveIndex,
    /// Absorption coefficient, m⁻¹, if it absorbs.
    pub absorption: Option<PathSpectrum>,
}

/// A solid where it is placed: its object's number, and the instance (0 if it is in none).
type Place = (u32, u32);

/// The solids that hold a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inside {
    places: [Place; DEPTH],
    len: usize,
}

impl Inside {
    pub(crate) const NOTHING: Self = Self { places: [(0, 0); DEPTH], len: 0 };

    fn iter(&self) -> impl Iterator<Item = Place> + '_ {
        self.places[..self.len].iter().copied()
    }

    /// Goes through a boundary. False if that contradicts what was known: a solid is left that was never entered, or there
    /// are too many.
    fn cross(&mut self, place: Place, enters: bool) -> bool {
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

/// The two media at an interface, along the walk from the camera.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interface<'a> {
    /// The medium that the path comes through.
    pub incident: &'a RefractiveIndex,
    /// The medium behind the surface.
    pub transmitted: &'a RefractiveIndex,
}

/// A surface that a path meets.
pub(crate) struct Met<'a> {
    pub hit: Hit<f64>,
    pub point: SurfacePoint<f64>,
    pub surface: Surface<'a>,
    /// The media on both sides; `None` where the material itself says.
    pub interface: Option<Interface<'a>>,
    /// What holds the path if it goes on through a boundary.
    pub beyond: Option<Beyond>,
}

/// The other side of a boundary.
#[derive(Clone, Copy)]
pub(crate) struct Beyond {
    pub inside: Inside,
    /// The primitive of the boundary that a ray from here must not meet again.
    pub leaves: SurfaceId,
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
    fn filling(&self, inside: &Inside) -> Option<Place> {
        inside.iter().max_by_key(|&place| self.rank(place))
    }

    /// Which of two solids at one place fills it: the greater.
    fn rank(&self, place: Place) -> (Option<u32>, Place) {
        (self.solid(place.0).map(|solid| solid.priority), place)
    }

    /// The medium that fills a place.
    fn medium(&self, inside: &Inside) -> &RefractiveIndex {
        self.filling(inside).and_then(|place| self.solid(place.0)).map_or(&VACUUM, |solid| &solid.index)
    }

    /// The absorption coefficient of the medium that fills a place, m⁻¹, if it absorbs.
    pub(crate) fn absorption(&self, inside: &Inside) -> Option<&PathSpectrum> {
        self.filling(inside).and_then(|place| self.solid(place.0))?.absorption.as_ref()
    }

    /// What a path meets next, and `ray` and `inside` brought before it. Counts in `lost` what contradicts itself.
    pub(crate) fn meet<'a>(
        &'a self,
        geometry: &Geometry,
        surfaces: &'a Surfaces,
        ray: &mut Ray<f64>,
        inside: &mut Inside,
        lost: &mut u64,
    ) -> Option<Met<'a>> {
        loop {
            let hit = geometry.closest_hit(ray)?;
            let point = geometry.surface(ray, &hit);
            let surface = surfaces.of(&point);
            if self.solid(surface.object).is_none() {
                let around = self.medium(inside);
                let interface = surface.takes_medium().then_some(Interface { incident: around, transmitted: around });
                return Some(Met { hit, point, surface, interface, beyond: None });
            }
            let boundary = self.boundary(geometry, surfaces, (&hit, &point), ray.direction, inside, lost);
            let beyond = match boundary {
                Boundary::Opaque(hit, point) => {
                    let around = self.medium(inside);
                    let surface = surfaces.of(&point);
                    let interface =
                        surface.takes_medium().then_some(Interface { incident: around, transmitted: around });
                    return Some(Met { hit, point, surface, interface, beyond: None });
                }
                Boundary::Solid(beyond) => beyond,
            };
            let (before, behind) = (self.filling(inside), self.filling(&beyond.inside));
            if before != behind {
                // Where boundaries coincide, the solid of the highest priority that has its medium on either side decides what
                // its surface does: of the one before if it is left here, and of the one behind if it is entered.
                let left = before.filter(|&place| !beyond.inside.iter().any(|other| other == place));
                let entered = behind.filter(|&place| !inside.iter().any(|other| other == place));
                let deciding = left.into_iter().chain(entered).max_by_key(|&place| self.rank(place));
                let mut surface = surface;
                if let Some((object, _)) = deciding {
                    surface.bsdf = surfaces.bsdf_of(object);
                }
                let interface = Interface { incident: self.medium(inside), transmitted: self.medium(&beyond.inside) };
                return Some(Met { hit, point, surface, interface: Some(interface), beyond: Some(beyond) });
            }
            *inside = beyond.inside;
            let t_max = ray.t_max - hit.t;
            let aims_at = ray.aims_at;
            *ray = Ray { leaves: beyond.leaves, aims_at, t_max, ..point.spawn(ray.direction) };
        }
    }

    /// Whether a shadow ray is stopped by anything but boundaries that change no medium.
    pub(crate) fn occluded(
        &self,
        geometry: &Geometry,
        surfaces: &Surfaces,
        mut ray: Ray<f64>,
        mut inside: Inside,
        lost: &mut u64,
    ) -> bool {
        let aims_at = ray.aims_at;
        let met = self.meet(geometry, surfaces, &mut ray, &mut inside, lost);
        met.is_some_and(|met| met.point.surface != aims_at)
    }

    /// The solids that hold the origin of a ray: those whose first boundary along it is left, not entered.
    pub(crate) fn around(&self, geometry: &Geometry, surfaces: &Surfaces, ray: &Ray<f64>, lost: &mut u64) -> Inside {
        let mut inside = Inside::NOTHING;
        let mut known = Inside::NOTHING;
        let mut ray = *ray;
        while let Some(hit) = geometry.closest_hit(&ray) {
            let point = geometry.surface(&ray, &hit);
            let primitives = self.coincident(geometry, surfaces, (&hit, &point), ray.direction);
            for (_, point) in primitives.iter().flatten() {
                let place = place(surfaces, point);
                if self.solid(place.0).is_some() && !known.iter().any(|other| other == place) {
                    let leaves = point.normal.dot(ray.direction) > 0.0;
                    let counted = known.cross(place, true) && (!leaves || inside.cross(place, true));
                    *lost += u64::from(!counted);
                }
            }
            let leaves = primitives[1].map_or(point.surface, |(_, other)| other.surface);
            ray = Ray { leaves, ..point.spawn(ray.direction) };
        }
        inside
    }

    /// What lies at a boundary of a solid.
    fn boundary(
        &self,
        geometry: &Geometry,
        surfaces: &Surfaces,
        (hit, point): (&Hit<f64>, &SurfacePoint<f64>),
        direction: Vec3<f64>,
        inside: &Inside,
        lost: &mut u64,
    ) -> Boundary {
        let enters = |point: &SurfacePoint<f64>| point.normal.dot(direction) < 0.0;
        let mut beyond = Beyond { inside: *inside, leaves: point.surface };
        let mut crossed = [(place(surfaces, point), enters(point)); MOST_COINCIDENT];
        let mut count = 1;
        let points = self.coincident(geometry, surfaces, (hit, point), direction);
        for (hit, other) in points[1..].iter().flatten() {
            let place = place(surfaces, other);
            if self.solid(place.0).is_none() {
                return Boundary::Opaque(*hit, *other);
            }
            beyond.leaves = other.surface;
            // Two faces of a mesh that meet in the edge that is hit are one boundary.
            let crossing = (place, enters(other));
            if !crossed[..count].contains(&crossing) {
                crossed[count] = crossing;
                count += 1;
            }
        }
        // First what is left, so that the order in which coincident boundaries are found does not matter.
        for enters in [false, true] {
            for &(place, _) in crossed[..count].iter().filter(|crossing| crossing.1 == enters) {
                if !beyond.inside.cross(place, enters) {
                    *lost += 1;
                }
            }
        }
        Boundary::Solid(beyond)
    }

    /// The points of all surfaces that coincide with `point` up to the errors of their positions, itself first.
    ///
    /// They are looked for on a short ray through the point. Each look leaves one primitive out by name, so three that
    /// coincide are found for certain, more (where a line is shared by four solids) perhaps not.
    fn coincident(
        &self,
        geometry: &Geometry,
        surfaces: &Surfaces,
        (hit, point): (&Hit<f64>, &SurfacePoint<f64>),
        direction: Vec3<f64>,
    ) -> [Option<(Hit<f64>, SurfacePoint<f64>)>; MOST_COINCIDENT] {
        let mut found = [None; MOST_COINCIDENT];
        found[0] = Some((*hit, *point));
        let cos = point.normal.dot(direction).abs();
        if self.solid(place(surfaces, point).0).is_none() || cos == 0.0 {
            return found;
        }
        // Each of two positions may be off by its bound; half as much again for the rounding of this ray.
        let reach = 4.0 * point.position_error / cos;
        // Rounded away from the surface: where coordinates are exact, the bound is below their spacing.
        let origin = point.spawn(-direction).origin - direction * reach;
        let t_max = 2.0 * (point.position - origin).dot(direction);
        let mut leaves = point.surface;
        for next in 1..MOST_COINCIDENT {
            let probe = Ray { origin, direction, t_max, leaves, aims_at: SurfaceId::NONE, time: point.time };
            let Some(hit) = geometry.closest_hit(&probe) else { break };
            let other = geometry.surface(&probe, &hit);
            let apart = (other.position - point.position).dot(point.normal).abs();
            let seen = found.iter().flatten().any(|(_, seen)| seen.surface == other.surface);
            if seen || apart > 2.0 * (point.position_error + other.position_error) {
                break;
            }
            leaves = other.surface;
            found[next] = Some((hit, other));
        }
        found
    }
}

/// The solid that a point bounds, if its object is one.
fn place(surfaces: &Surfaces, point: &SurfacePoint<f64>) -> Place {
    (surfaces.of(point).object, point.surface.instance)
}

/// Where a shape is open, so that it bounds no solid; `None` if it is closed.
///
/// A mesh is closed if each edge is shared by two triangles that pass it in opposite directions, vertices at the same
/// place counting as one.
pub(crate) fn open_edges(shape: &Shape) -> Option<String> {
    match shape {
        Shape::Sphere { .. } => None,
        Shape::Cylinder { capped, .. } => (!capped).then(|| "a tube is open at its ends".to_owned()),
        Shape::Parallelogram { .. } => Some("a parallelogram has an edge".to_owned()),
        Shape::Disk { .. } => Some("a disk has an edge".to_owned()),
        Shape::Mesh(mesh) => {
            let Mesh { vertices, triangles, .. } = mesh.as_ref();
            let at = |i: u32| vertices[i as usize].map(|v| (v + 0.0).to_bits());
            let mut open: HashMap<_, i64> = HashMap::new();
            for triangle in triangles {
                for i in 0..3 {
                    let (a, b) = (at(triangle[i]), at(triangle[(i + 1) % 3]));
                    let (edge, turn) = if a < b { ((a, b), 1) } else { ((b, a), -1) };
                    *open.entry(edge).or_default() += turn;
                }
            }
            let count = open.values().filter(|&&balance| balance != 0).count();
            (count > 0).then(|| format!("{count} edges of its mesh are open"))
        }
    }
}

/// Surfaces that may be found at one place.
const MOST_COINCIDENT: usize = 4;

enum Boundary {
    /// An opaque surface coincides with it.
    Opaque(Hit<f64>, SurfacePoint<f64>),
    /// Boundaries of solids alone, and what is behind them.
    Solid(Beyond),
}
