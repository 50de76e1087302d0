//! Specular connections: what a lamp without area sends to a vertex by way of mirrors and smooth interfaces.
//!
//! No path meets such a lamp by chance, and a shadow ray goes straight. So the direction is searched for: from a vertex x, a chain of mirrors
//! and interfaces takes each direction ω to a last vertex y(ω), which it leaves along d(ω). The lamp is seen from x in the directions in
//! which d(ω) points at it. With W what the chain does to radiance, E the irradiance at y across the light's direction, and r(ω) the angle by
//! which d(ω) misses the lamp,
//!
//! ∫ f·|cos θ|·W·E·δ(r(ω)) dω = Σ f·|cos θ|·W·E / |det ∂r/∂ω| over all roots of r.
//!
//! The steps of the search:
//!
//! 1. Numbers are drawn once that choose the lamp, how long the chain may be, and the lobe at each of its vertices. They stay the same from now
//!    on, so the chain is a function of ω. That a lobe was chosen is accounted for in W, as on any path.
//! 2. A direction is drawn and improved by Newton's method until the chain points at the lamp ([`solve`]).
//! 3. A root is found with a probability p that nobody knows. Further directions are drawn, and improved in the same way, until one leads to
//!    the same root. Their number has the mean 1/p, and multiplies what the root brings (Zeltner, Georgiev & Jakob 2020, *Specular Manifold
//!    Sampling*, §4.3). A root that brings nothing needs none of them.
//!
//! The estimate is unbiased if every root can be found from some direction, which holds where r is smooth around it.

mod chain;
mod solve;

use super::Path;
use super::vertex::Vertex;
use crate::film::Counters;
use crate::guiding::{GuidedTarget, specular_bodies};
use crate::integrator::observer::{Found, Observer};
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::light::{Light, LightTable, Source};
use crate::polarisation::Polarisation;
use crate::sampler::{NumberStream, Sampler};
use crate::scene::world::World;
use crate::surface::Surfaces;
use chain::Chain;
use etalon_geometry::{Geometry, Ray};
use etalon_optics::{Real, Vec3};
use solve::{Chooses, Seed};

/// Most directions that are drawn to learn how probable a root is.
const MOST_TRIALS: u32 = 1 << 16;
/// The share of the vertices behind a diffuse one from which a connection is made.
const MADE_INDIRECTLY: f64 = 0.25;
/// Light that is weaker than this, of what the lamp would bring from as far away without a chain, gets trials in proportion to its strength.
const WORTH_TRIALS: f64 = 0.05;
/// The number of the set that is of a connection as a whole, and of the first that draws a direction. Those before are of the chain's vertices.
const CONNECTION_SET: u64 = 1 << 40;
const SEED_SETS: u64 = 1 << 41;
/// The first of those with further numbers of the same.
const FURTHER_SEED_SETS: u64 = 1 << 42;

/// The lamps and surfaces of a scene between which light goes by specular chains.
#[derive(Clone, Debug)]
pub(crate) struct SpecularConnections {
    /// Lamps without area, and their numbers among all.
    lights: LightTable,
    numbers: Vec<u32>,
    /// Mirrors and bodies of glass, toward which directions are drawn.
    bodies: Vec<GuidedTarget>,
    /// A distance from any of them beyond which there is nothing.
    reach: f64,
}

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
        let bodies = specular_bodies(surfaces, geometry, |of| surfaces.properties[of.material].has_delta());
        let bodies = bodies.into_iter().map(|(body, _)| body).collect();
        let reach = geometry.bounds().map_or(1.0, |bounds| bounds.extent().length());
        Some(Self { lights: table(deltas), numbers, bodies, reach })
    }

    /// Where the search may begin from a point: straight toward the lamp, toward a body, or anywhere.
    fn seed(&self, from: Vec3<f64>, source: &Source, u: &SeedNumbers) -> Seed {
        let direction = match (u.kind, self.body(u)) {
            (..STRAIGHT, _) => source.toward(from),
            (..TOWARD_BODIES, Some(body)) if body.can_be_aimed_at(from) => body.aim(from, u.point),
            _ => anywhere(u.point),
        };
        Seed { direction, chooses: Chooses::By(u.vertices) }
    }

    /// A ray of a lamp that may come to a point by way of a mirror or glass.
    fn lamp_ray(&self, from: Vec3<f64>, light: &Light, source: &Source, u: &SeedNumbers) -> Option<Ray<f64>> {
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

/// Shares of the seeds: those up to the first number are where a ray of the lamp leaves its last mirror or interface, those up to the next straight
/// toward the lamp, and toward bodies; the rest is anywhere.
const FROM_LAMP: f64 = 0.4;
const STRAIGHT: f64 = 0.6;
const TOWARD_BODIES: f64 = 0.9;

/// A direction, all alike.
fn anywhere([u1, u2]: [f64; 2]) -> Vec3<f64> {
    let (sin, cos) = f64::sin_cos_turns(u2);
    let z = 1.0 - 2.0 * u1;
    let across = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(across * cos, across * sin, z)
}

/// The numbers by which a connection is made.
struct Numbers {
    first: [f64; 4],
    further: NumberStream,
}

/// The numbers by which a search begins.
struct SeedNumbers {
    kind: f64,
    body: f64,
    point: [f64; 2],
    vertices: f64,
}

impl Numbers {
    /// Those of the direction that is drawn as number `trial`.
    fn of_seed(&self, trial: u32) -> SeedNumbers {
        let trial = u64::from(trial);
        let [_, kind, u1, u2] = if trial == 0 { self.first } else { self.further.set(SEED_SETS + trial) };
        let [body, vertices, ..] = self.further.set(FURTHER_SEED_SETS + trial);
        SeedNumbers { kind, body, point: [u1, u2], vertices }
    }
}

impl<'a, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Path<'a, M, P, N> {
    /// Adds the light of one lamp without area that comes to a vertex by way of mirrors and smooth interfaces, if the scene has such.
    #[inline(always)]
    pub(crate) fn connect(
        &mut self,
        world: &World<'a>,
        vertex: &impl Vertex<'a>,
        sampler: &Sampler,
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) {
        if let Some(connections) = world.specular_connections {
            self.connect_by(world, connections, vertex, sampler, counters, observer);
        }
    }

    #[inline(never)]
    fn connect_by(
        &mut self,
        world: &World<'a>,
        connections: &SpecularConnections,
        vertex: &impl Vertex<'a>,
        sampler: &Sampler,
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) {
        // A lamp, a mirror and this vertex take two more edges.
        if self.vertex + 2 >= world.max_depth {
            return;
        }
        let numbers =
            Numbers { first: sampler.connection_set(self.vertex), further: sampler.connection_numbers(self.vertex) };
        let [u_made, u_length, u_kept, _] = numbers.further.set(CONNECTION_SET);
        // What a path sees directly is seen best.
        let made = if self.is_indirect() { MADE_INDIRECTLY } else { 1.0 };
        if u_made >= made {
            return;
        }
        let from = vertex.point().position;
        let [u_light, ..] = numbers.first;
        let Some((index, probability)) = connections.lights.choose(from, u_light) else { return };
        let light = &connections.lights.lights()[index];
        let Some(source) = light.source() else { return };
        let mut chain = Chain::new(self, world, vertex, numbers.further, u_length);
        let seed = |trial: u32, chain: &mut Chain<'_, 'a, _, M, P, N>, counters: &mut Counters| {
            let u = numbers.of_seed(trial);
            if u.kind >= FROM_LAMP {
                return Some(connections.seed(from, &source, &u));
            }
            let (last, vertices) = chain.of_lamp(&connections.lamp_ray(from, light, &source, &u)?, counters)?;
            let way = last - from;
            Some(Seed { direction: way / way.length(), chooses: Chooses::This(vertices) })
        };
        let Some(root) = seed(0, &mut chain, counters).and_then(|seed| chain.solve(&seed, &source, counters)) else {
            return;
        };
        let Some(brought) = chain.bring(&root, light, counters) else { return };
        // Trials are for what is worth them.
        let kept = (brought.concentration / WORTH_TRIALS).min(1.0);
        if u_kept >= kept {
            return;
        }
        let mut is_found = |trial: u32| {
            let approached =
                seed(trial, &mut chain, counters).and_then(|seed| chain.approach(&seed, &source, counters));
            approached.is_some_and(|approached| approached.is_beside(&root))
        };
        // How many directions are drawn until one leads to the same root.
        let Some(trials) = (1..=MOST_TRIALS).find(|trial| is_found(*trial)) else {
            counters.record_cut(f64::MAX);
            return;
        };
        let number = connections.numbers[index];
        let factor = self.spectrum_of_light(world, number) * (f64::from(trials) / (probability * kept * made));
        if let Some(stokes) = brought.stokes {
            self.polarisation.record(stokes.map(|s| s * factor));
        }
        let found = self.gather(brought.light * factor);
        observer.light(self.vertex, Found::SpecularConnection { light: number }, found);
    }
}
