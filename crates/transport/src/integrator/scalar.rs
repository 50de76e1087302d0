//! One path at a time: the specification of what is rendered.

use super::{Arrival, Intersection, Path};
use crate::film::Counters;
use crate::integrator::observer::{End, Observer};
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::polarisation::Polarisation;
use crate::sampler::Sampler;
use crate::scene::interaction::SurfaceInteraction;
use crate::scene::world::World;
use etalon_geometry::Ray;

/// Follows `path` from its camera ray to its end; its radiance is then what arrives at the camera.
pub(crate) fn trace<'a, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
    world: &World<'a>,
    path: &mut Path<'a, M, P, N>,
    mut ray: Ray<f64>,
    sampler: &Sampler,
    counters: &mut Counters,
    observer: &mut impl Observer<N>,
) {
    loop {
        // Next surface: where does the ray lead?
        counters.rays += 1;
        counters.lane_weights += u64::from(M::CARRIES_WEIGHTS);
        let mut met = world.intersect(&ray, &mut path.walk, &mut path.stack, counters);

        // Emission: what shines there, or at infinity, or on the way? Masks let the ray pass, media may scatter it before.
        match path.arrive(world, &ray, Intersection::of(met.as_mut()), sampler, counters, observer) {
            Arrival::Scatters => {}
            Arrival::Passed => continue,
            Arrival::Collides => {
                match path.scatter_in_medium(world, sampler, counters, observer) {
                    Some(next) => ray = next,
                    None => break,
                }
                continue;
            }
            Arrival::Escaped | Arrival::Ended => break,
        }
        let Some(vertex) = met else { break };

        match path.go_on(world, &vertex, sampler, counters, observer) {
            Some(next) => ray = next,
            None => break,
        }
    }
}

impl<'a, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Path<'a, M, P, N> {
    /// Finds the direct light at a vertex, and takes the step from there: the next ray, or `None` where the path ends.
    #[inline(always)]
    pub(crate) fn go_on(
        &mut self,
        world: &World<'a>,
        vertex: &SurfaceInteraction<'a>,
        sampler: &Sampler,
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) -> Option<Ray<f64>> {
        // Direct light: one shadow ray toward one light.
        if vertex.sees_lights {
            self.direct_light(world, vertex, sampler, counters, observer);
            self.connect(world, vertex, sampler, counters, observer);
        }

        // Scattering: in which direction does the walk go on?
        let [u_lobe, u1, u2, u_roulette] = sampler.vertex_set(self.vertex, 0);
        let Some(direction) = self.sample_direction(world, vertex, [u_lobe, u1, u2], observer) else {
            observer.end(End::Absorbed);
            return None;
        };
        let taken = self.scatter(world, vertex, direction, u_lobe);

        // Russian roulette.
        self.survives(world, taken.guiding, u_roulette, observer).then(|| vertex.point.spawn(taken.wi))
    }

    /// Adds the light of one direction toward one light, where the shadow ray comes through.
    #[inline(always)]
    pub(crate) fn direct_light(
        &mut self,
        world: &World<'a>,
        vertex: &SurfaceInteraction<'a>,
        sampler: &Sampler,
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) {
        let [u_light, u1, u2, _] = sampler.vertex_set(self.vertex, 1);
        if let Some(draw) = world.sample_light(&vertex.point, u_light, [u1, u2])
            && let Some(next) = self.next_event(world, vertex, &draw)
        {
            match self.visibility(world, vertex, &draw.sample, counters) {
                Some(visible) => self.add_light(world, vertex, &draw, &next, &visible, observer),
                None => self.add_refracted_light(world, vertex, &draw, sampler, counters, observer),
            }
        }
    }
}
