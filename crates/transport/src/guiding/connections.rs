//! Where searches for specular connections begin: the lamps without area, and the mirrors and bodies of glass by which they may be seen.

use super::{GuidedTarget, specular_bodies};
use crate::light::{Light, LightTable, Source};
use crate::surface::Surfaces;
use etalon_geometry::{Geometry, Ray};
use etalon_optics::{Real, Vec3};

// The kinds of searches, as a number in [0, 1) chooses. Below the first bound, a search begins toward the place where a ray of the lamp leaves its
// last mirror or interface; below the second straight toward the lamp; below the third toward a body; otherwise in any direction.
const FROM_LAMP: f64 = 0.4;
const STRAIGHT: f64 = 0.6;
const TOWARD_BODIES: f64 = 0.9;

/// The numbers by which a search begins.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SeedNumbers {
    /// Chooses the kind of search.
    pub kind: f64,
    /// Chooses a mirror or a body of glass.
    pub body: f64,
    /// Choose a point of it.
    pub point: [f64; 2],
    /// Chooses how many vertices the chain is to have; of a ray of the lamp, the third coordinate of the point.
    pub vertices: f64,
}

/// The lamps and surfaces of a scene between which light goes by specular chains.
#[derive(Clone, Debug)]
pub(crate) struct SpecularConnections {
    /// Lamps without area, and their numbers among all.
    pub(crate) lights: LightTable,
    pub(crate) numbers: Vec<u32>,
    /// Whether there are beams among them.
    pub(crate) has_beams: bool,
    /// Mirrors and bodies of glass, toward which directions are drawn.
    bodies: Vec<GuidedTarget>,
    /// A distance from any of them beyond which there is nothing.
    reach: f64,
    /// The shares of the vertices from which connections are made. The first is of vertices to which the path has come from the camera or by way
    /// of a mirror or glass. The second is of those to which it has come straight from a vertex that scatters. A trial chooses them.
    pub(crate) shares: [f64; 2],
}

/// The shares without a trial. What the camera sees directly is seen best.
pub(crate) const USUAL_SHARES: [f64; 2] = [1.0, 0.25];

impl SpecularConnections {
    /// Those of a scene; `table` makes a table of some lights. `None` if it has no lamp without area.
    pub(crate) fn new(
        surfaces: &Surfaces,
        geometry: &Geometry,
        lights: &LightTable,
        table: impl FnOnce(Vec<Light>) -> LightTable,
    ) -> Option<Self> {
        let deltas = lights.lights().iter().enumerate().filter(|(_, light)| light.source().is_some());
        let (numbers, deltas): (Vec<u32>, Vec<Light>) = deltas.map(|(i, light)| (i as u32, light.clone())).unzip();
        if deltas.is_empty() {
            return None;
        }
        let has_beams = deltas.iter().any(|light| matches!(light, Light::Beam(_)));
        let bodies = specular_bodies(surfaces, geometry, |of| surfaces.properties[of.material].has_delta());
        let bodies = bodies.into_iter().map(|(body, _)| body).collect();
        let reach = geometry.bounds().map_or(1.0, |bounds| bounds.extent().length());
        Some(Self { lights: table(deltas), numbers, has_beams, bodies, reach, shares: USUAL_SHARES })
    }

    /// A direction from a point by which a search may begin: straight toward the lamp, toward a body, or any.
    pub(crate) fn direction(&self, from: Vec3<f64>, source: &Source, u: &SeedNumbers) -> Vec3<f64> {
        match (u.kind, self.body(u)) {
            (..STRAIGHT, _) => source.toward(from),
            (..TOWARD_BODIES, Some(body)) if body.can_be_aimed_at(from) => body.aim(from, u.point),
            _ => anywhere(u.point),
        }
    }

    /// A ray of a lamp that may come to a point by way of a mirror or glass, if a search is to begin by one.
    pub(crate) fn lamp_ray(
        &self,
        from: Vec3<f64>,
        light: &Light,
        source: &Source,
        u: &SeedNumbers,
    ) -> Option<Ray<f64>> {
        if u.kind >= FROM_LAMP {
            return None;
        }
        if let Light::Beam(beam) = light {
            return Some(beam.ray(u.point));
        }
        let through = self.body(u)?.place_near(from, [u.point[0], u.point[1], u.vertices]);
        let (origin, direction) = match source {
            Source::Point(point) => (*point, through - *point),
            Source::Direction(toward) => (through + *toward * self.reach, -*toward),
        };
        Some(Ray::free(origin, direction / direction.length()))
    }

    fn body(&self, u: &SeedNumbers) -> Option<&GuidedTarget> {
        self.bodies.get((u.body * self.bodies.len() as f64) as usize)
    }
}

/// A direction, of which all are equally likely.
fn anywhere([u1, u2]: [f64; 2]) -> Vec3<f64> {
    let (sin, cos) = f64::sin_cos_turns(u2);
    let z = 1.0 - 2.0 * u1;
    let across = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(across * cos, across * sin, z)
}
