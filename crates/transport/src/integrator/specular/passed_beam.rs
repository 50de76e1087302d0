//! Fog behind a prism: places of a way that a beam lights after mirrors and glass.
//!
//! A path that is scattered where its medium says meets a narrow beam by chance. So a second place of each way is chosen, in the beam, and a
//! connection is made from there; the balance heuristic weighs it against the first. Where the beam goes is known from its middle ray alone,
//! at the wavelength of the hero. What lies beside is left to the first place. Since each hero has a beam of its own, its own density of
//! being scattered is what is weighed against, not the mean over the lanes.

use super::{Numbers, Path, SEED_SETS};
use crate::film::Counters;
use crate::guiding::SpecularConnections;
use crate::integrator::MOST_VERTICES;
use crate::integrator::medium::MediumWay;
use crate::integrator::observer::Observer;
use crate::integrator::specular::chain::Chain;
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::light::Light;
use crate::polarisation::Polarisation;
use crate::sampler::Sampler;
use crate::scene::world::World;
use etalon_geometry::Ray;

/// The set of numbers that choose a part and a place in it.
const PLACE_SET: u64 = (1 << 40) + 1;

/// Parts of a way in which beams are after mirrors or glass, as distances along it.
#[derive(Clone, Debug, Default)]
pub(crate) struct PassedBeams(Vec<[f64; 2]>);

impl PassedBeams {
    /// Draws a place; `None` if there are no parts.
    fn distance(&self, [u_part, u_place]: [f64; 2]) -> Option<f64> {
        let [first, last] = *self.0.get((u_part * self.0.len() as f64) as usize)?;
        Some(first + (last - first) * u_place)
    }

    /// The density with which [`PassedBeams::distance`] draws a distance, per unit of length.
    pub(crate) fn density(&self, distance: f64) -> f64 {
        let holding = self.0.iter().filter(|[first, last]| (*first..=*last).contains(&distance));
        holding.map(|[first, last]| 1.0 / (last - first)).sum::<f64>() / (self.0.len() as f64).max(1.0)
    }
}

impl<'a, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Path<'a, M, P, N> {
    /// The parts of a way through a medium in which beams are that mirrors or glass have sent there.
    #[inline(never)]
    pub(in crate::integrator) fn passed_beams(
        &self,
        world: &World<'a>,
        connections: &SpecularConnections,
        lit: &MediumWay<'a, N>,
        ray: &Ray<f64>,
        sampler: &Sampler,
        counters: &mut Counters,
    ) -> PassedBeams {
        let start = self.medium_interaction(world, lit, ray, 0.0);
        // Numbers of their own: the parts must not hang on what connections draw.
        let numbers = sampler.connection_numbers(2 * MOST_VERTICES + self.vertex);
        let mut chain = Chain::new(self, world, &start, numbers, 1.0);
        let parts = connections.lights.lights().iter().filter_map(|light| {
            let Light::Beam(beam) = light else { return None };
            let passed = chain.passed(&beam.ray([0.0; 2]), counters)?;
            let part = beam.passed_part(&passed, &lit.way)?;
            part[1].is_finite().then_some(part)
        });
        PassedBeams(parts.collect())
    }

    /// Adds the light of a beam that a place within it sends on toward the path's origin, by way of mirrors and glass.
    pub(in crate::integrator) fn connect_in_beam(
        &mut self,
        world: &World<'a>,
        (lit, beams): (&MediumWay<'a, N>, &PassedBeams),
        ray: &Ray<f64>,
        sampler: &Sampler,
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) {
        let Some(connections) = world.specular_connections else { return };
        let further = sampler.connection_numbers(MOST_VERTICES + self.vertex);
        let [u_part, u_place, ..] = further.set(PLACE_SET);
        let Some(distance) = beams.distance([u_part, u_place]) else { return };
        if !(distance > 0.0 && distance < lit.way.length) {
            return;
        }
        let vertex = self.medium_interaction(world, lit, ray, distance);
        // As if the hero had been scattered there, but for the density with which the place was found.
        let densities = lit.scattered_at(distance);
        let hero = densities[0];
        if hero <= 0.0 {
            return;
        }
        let (beta, lanes) = (self.beta, self.lanes);
        self.beta *=
            lit.scattered_toward(distance, &self.wavelengths.lambda_nm) * (1.0 / (beams.density(distance) + hero));
        self.lanes.follow(densities * (1.0 / hero));
        let numbers = Numbers { first: further.set(SEED_SETS), further };
        self.connect_by(world, connections, &vertex, numbers, counters, observer);
        (self.beta, self.lanes) = (beta, lanes);
    }
}
