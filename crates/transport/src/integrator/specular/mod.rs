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
//! 2. A direction is drawn, and improved by Newton's method until the chain points at the lamp ([`solve`]).
//! 3. One search is not drawn. It begins straight toward the lamp, or where the axis of a beam comes from. Its chain is refracted wherever it can
//!    be. So the root that it leads to counts as it is.
//! 4. Any other root is found with a probability p that nobody knows. Further directions are drawn, and improved in the same way, until one leads to
//!    the same root. Their number has the mean 1/p, and multiplies what the root brings (Zeltner, Georgiev & Jakob 2020, *Specular Manifold
//!    Sampling*, §4.3). A root that brings nothing needs none of them.
//!
//! The estimate is unbiased if every root can be found from some direction, which holds where r is smooth around it.

mod chain;
mod passed_beam;
mod refracted_shadow;
mod solve;
mod through_panes;
mod walker;

use super::Path;
use super::vertex::Vertex;
use crate::film::Counters;
use crate::guiding::{SeedNumbers, SpecularConnections, SpecularObjects};
use crate::integrator::observer::{Found, Observer};
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::light::{Light, Source};
use crate::polarisation::Polarisation;
use crate::sampler::{NumberStream, Sampler};
use crate::scene::world::World;
use chain::{Brought, Chain};
use etalon_geometry::Ray;
use etalon_optics::Vec3;
pub(crate) use passed_beam::PassedBeams;
use solve::{Chooses, Root, Seed};
use walker::Lobes;

/// Most directions that are drawn to learn how probable a root is.
const MOST_TRIALS: u32 = 1 << 16;
/// Light that is weaker than this, of what the lamp would bring from as far away without a chain, gets trials in proportion to its strength.
const WORTH_TRIALS: f64 = 0.05;
/// The number of the set that is of a connection as a whole, and of the first that draws a direction. Those before are of the chain's vertices.
const CONNECTION_SET: u64 = 1 << 40;
const SEED_SETS: u64 = 1 << 41;
/// The first of those with further numbers of the same.
const FURTHER_SEED_SETS: u64 = 1 << 42;

/// The numbers by which a connection is made.
struct Numbers {
    first: [f64; 4],
    further: NumberStream,
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
        if let Some(connections) = self.connections(world) {
            let first = sampler.connection_set(self.vertex);
            let numbers = Numbers { first, further: sampler.connection_numbers(self.vertex) };
            self.connect_by(world, connections, vertex, numbers, counters, observer);
        }
    }

    /// The lamps that are searched for, if light paths do not bring their light.
    #[inline(always)]
    fn connections(&self, world: &World<'a>) -> Option<&'a SpecularConnections> {
        let finds_sources = |specular_objects: &SpecularObjects| specular_objects.finds_sources;
        let is_brought =
            world.specular_objects.is_some_and(finds_sources) && self.is_light_traced_after_specular(world);
        world.specular_connections.filter(|_| !is_brought)
    }

    /// Tries one connection by some numbers.
    fn connect_by(
        &mut self,
        world: &World<'a>,
        connections: &SpecularConnections,
        vertex: &impl Vertex<'a>,
        numbers: Numbers,
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) {
        let before = counters.rays + counters.shadow_rays;
        self.search(world, connections, vertex, numbers, counters, observer);
        observer.connection(self.is_indirect(), counters.rays + counters.shadow_rays - before);
    }

    #[inline(never)]
    fn search(
        &mut self,
        world: &World<'a>,
        connections: &SpecularConnections,
        vertex: &impl Vertex<'a>,
        numbers: Numbers,
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) {
        if !self.has_edges_for_a_chain(world) {
            return;
        }
        let [u_made, u_length, u_kept, _] = numbers.further.set(CONNECTION_SET);
        let made = connections.shares[usize::from(self.is_indirect())];
        if u_made >= made {
            return;
        }
        let from = vertex.point().position;
        let [u_light, ..] = numbers.first;
        let Some((index, probability)) = connections.lights.choose(from, u_light) else { return };
        let light = &connections.lights.lights()[index];
        let Some(source) = light.source() else { return };
        let chain = Chain::new(self, world, vertex, numbers.further, u_length);
        let found = Search { connections, from, light, source, numbers, u_kept }.roots(chain, counters);
        let number = connections.numbers[index];
        for (brought, weight) in found.into_iter().flatten() {
            let white = self.spectrum_of_light(world, number);
            let factor = self.coloured(white, brought.colour) * (weight / (probability * made));
            if let Some(stokes) = brought.stokes {
                self.polarisation.record(stokes.map(|s| s * factor));
            }
            let found = self.gather(brought.light * factor);
            observer.light(self.vertex, Found::SpecularConnection { light: number }, found);
        }
    }
}

/// A search for chains from a point to a lamp.
struct Search<'s> {
    connections: &'s SpecularConnections,
    from: Vec3<f64>,
    light: &'s Light,
    source: Source,
    numbers: Numbers,
    /// Decides whether light that is weak gets trials.
    u_kept: f64,
}

impl Search<'_> {
    /// What comes from the lamp, and its weight: along the chain that is not drawn, and along one that is.
    fn roots<'a, V: Vertex<'a>, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
        &self,
        mut chain: Chain<'_, 'a, V, M, P, N>,
        counters: &mut Counters,
    ) -> [Option<(Brought<N>, f64)>; 2] {
        chain.choose(Lobes::Sure);
        let seed = match self.light {
            // A prism turns a beam far aside: its axis says where it comes from.
            Light::Beam(beam) => self.seed_by(&beam.ray([0.0; 2]), &mut chain, counters),
            _ => Some(Seed { direction: self.source.toward(self.from), chooses: Chooses::Nearest }),
        };
        let sure = seed.and_then(|seed| chain.solve(&seed, &self.source, counters));
        let first = sure.as_ref().and_then(|root| chain.bring(root, self.light, counters));
        chain.choose(Lobes::Drawn);
        [first.map(|brought| (brought, 1.0)), self.drawn(&mut chain, sure.as_ref(), counters)]
    }

    /// A root that is drawn, and the number of trials that find it again. It is not `sure`, which counts already.
    fn drawn<'a, V: Vertex<'a>, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
        &self,
        chain: &mut Chain<'_, 'a, V, M, P, N>,
        sure: Option<&Root>,
        counters: &mut Counters,
    ) -> Option<(Brought<N>, f64)> {
        let root = self.seed(0, chain, counters).and_then(|seed| chain.solve(&seed, &self.source, counters))?;
        if sure.is_some_and(|sure| root.is(sure)) {
            return None;
        }
        let brought = chain.bring(&root, self.light, counters)?;
        // Trials are for what is worth them.
        let kept = (brought.concentration / WORTH_TRIALS).min(1.0);
        if self.u_kept >= kept {
            return None;
        }
        let mut is_found = |trial: u32| {
            let seed = self.seed(trial, chain, counters);
            let approached = seed.and_then(|seed| chain.approach(&seed, &self.source, counters));
            approached.is_some_and(|approached| approached.is_beside(&root))
        };
        // How many directions are drawn until one leads to the same root.
        let Some(trials) = (1..=MOST_TRIALS).find(|trial| is_found(*trial)) else {
            counters.record_cut(f64::MAX);
            return None;
        };
        Some((brought, f64::from(trials) / kept))
    }

    /// Where a search begins that is drawn.
    fn seed<'a, V: Vertex<'a>, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
        &self,
        trial: u32,
        chain: &mut Chain<'_, 'a, V, M, P, N>,
        counters: &mut Counters,
    ) -> Option<Seed> {
        let u = self.numbers.of_seed(trial);
        let Some(lamp_ray) = self.connections.lamp_ray(self.from, self.light, &self.source, &u) else {
            let direction = self.connections.direction(self.from, &self.source, &u);
            return Some(Seed { direction, chooses: Chooses::By(u.vertices) });
        };
        self.seed_by(&lamp_ray, chain, counters)
    }

    /// Toward the last vertex of the chain that a ray of the lamp follows.
    fn seed_by<'a, V: Vertex<'a>, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
        &self,
        lamp_ray: &Ray<f64>,
        chain: &mut Chain<'_, 'a, V, M, P, N>,
        counters: &mut Counters,
    ) -> Option<Seed> {
        let (last, vertices) = chain.of_lamp(lamp_ray, counters)?;
        let way = last - self.from;
        Some(Seed { direction: way / way.length(), chooses: Chooses::This(vertices) })
    }
}
