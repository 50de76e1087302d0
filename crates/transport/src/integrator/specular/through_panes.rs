//! Lamps without area behind panes: a shadow ray goes straight through.
//!
//! A chain that passes panes and meets nothing else is straight, and so it is known. A shadow ray brings its light, each pane lets its share
//! pass, and searches leave the chain out. What a pane reflects is still searched for.

use super::refracted_shadow::ShadowPassed;
use super::walker::Walker;
use crate::film::Counters;
use crate::guiding::RefractingBodies;
use crate::integrator::observer::{Found, Observer};
use crate::integrator::vertex::Vertex;
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::integrator::{LightDraw, MOST_VERTICES, Path};
use crate::light::LightSample;
use crate::polarisation::Polarisation;
use crate::scene::world::World;
use etalon_geometry::Ray;
use etalon_optics::Lanes;

impl<'a, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Path<'a, M, P, N> {
    /// Adds the light of a lamp without area whose shadow ray is blocked, if only panes block it.
    #[inline]
    pub(super) fn add_light_through_panes(
        &mut self,
        world: &World<'a>,
        vertex: &impl Vertex<'a>,
        draw: &LightDraw,
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) {
        let (from, sample) = (vertex.point().position, &draw.sample);
        let meets = |panes: &RefractingBodies| panes.may_be_met(from, sample.wi, sample.target.distance(from));
        if self.connections(world).is_some() && world.panes.is_some_and(meets) {
            self.follow_through_panes(world, vertex, draw, counters, observer);
        }
    }

    #[inline(never)]
    fn follow_through_panes(
        &mut self,
        world: &World<'a>,
        vertex: &impl Vertex<'a>,
        LightDraw { light, probability, sample, .. }: &LightDraw,
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) {
        let (f_cos, _) = vertex.eval(self, world, sample.wi);
        if f_cos.is_zero() {
            return;
        }
        let Some(passed) = self.through_panes(world, vertex, sample, counters) else { return };
        let white = self.spectrum_of_light(world, *light);
        let factor = f_cos * self.coloured(white, sample.colour) * (sample.scale / probability);
        if let Some(stokes) = passed.stokes {
            self.polarisation.record(stokes.map(|s| s * factor));
        }
        let found = self.gather(passed.light * factor);
        observer.light(self.vertex, Found::ShadowRay { light: *light }, found);
    }

    /// What comes along a shadow ray of each unit of radiance, with the throughput of the path; `None` if something is in the way that is no pane.
    fn through_panes(
        &self,
        world: &World<'a>,
        vertex: &impl Vertex<'a>,
        sample: &LightSample,
        counters: &mut Counters,
    ) -> Option<ShadowPassed<N>> {
        let mut walker = Walker::like(self);
        let mut from = walker.leave(self, world, vertex, sample.wi);
        let walker = &mut walker.path;
        let (mut start, mut panes, mut left) = (from.origin, 0, Lanes::ONE);
        for _ in 0..MOST_VERTICES {
            counters.rays += 1;
            let ray = Ray { t_max: sample.target.distance(from.origin), ..from };
            let met = world.intersect(&ray, &mut walker.walk, &mut walker.stack, counters);
            if world.participating.is_some() {
                let to_lamp = sample.target.distance(start);
                left *= walker.transmittance_to(world, (start, &ray), met.as_ref(), to_lamp);
            }
            let Some(mut met) = met else { return Some(ShadowPassed::by(walker, left, panes, 1.0)) };
            let stops = met.share_that_stops(world);
            if stops < 1.0 {
                left *= 1.0 - stops;
                start = met.point.position;
                walker.walk.pass(&met, &mut walker.stack);
                continue;
            }
            if !world.tables.is_pane(met.surface.object, met.surface.material) {
                return None;
            }
            met.prepare_scattering(world);
            let transmitted = 1.0 - walker.reflection_probability(world, &met).unwrap_or(0.0);
            let u_lobe = 1.0_f64.next_down();
            // Nothing is drawn: the lanes keep their densities.
            let lanes = walker.lanes;
            let direction = walker.sample_direction(world, &met, [u_lobe, 0.5, 0.5], &mut ())?;
            let taken = walker.scatter(world, &met, direction, u_lobe);
            walker.lanes = lanes;
            if transmitted == 0.0 || taken.wi != sample.wi {
                return None;
            }
            walker.beta *= transmitted;
            panes += 1;
            // To this vertex, to each pane, and to the lamp.
            if walker.edges(2 + panes) > world.max_depth {
                return None;
            }
            from = met.point.spawn(taken.wi);
            start = from.origin;
        }
        None
    }
}
