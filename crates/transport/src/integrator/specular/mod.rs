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
use crate::polarisation::Polarisation;
use crate::sampler::{NumberStream, Sampler};
use crate::scene::world::World;
use chain::Chain;
pub(crate) use passed_beam::PassedBeams;
use solve::{Chooses, Seed};

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
        let mut chain = Chain::new(self, world, vertex, numbers.further, u_length);
        let seed = |trial: u32, chain: &mut Chain<'_, 'a, _, M, P, N>, counters: &mut Counters| {
            let u = numbers.of_seed(trial);
            let Some(lamp_ray) = connections.lamp_ray(from, light, &source, &u) else {
                let direction = connections.direction(from, &source, &u);
                return Some(Seed { direction, chooses: Chooses::By(u.vertices) });
            };
            let (last, vertices) = chain.of_lamp(&lamp_ray, counters)?;
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
        let white = self.spectrum_of_light(world, number);
        let factor = self.coloured(white, brought.colour) * (f64::from(trials) / (probability * kept * made));
        if let Some(stokes) = brought.stokes {
            self.polarisation.record(stokes.map(|s| s * factor));
        }
        let found = self.gather(brought.light * factor);
        observer.light(self.vertex, Found::SpecularConnection { light: number }, found);
    }
}
