//! Paths in media: the way along a ray, and the step that the walk takes where a medium scatters it.

use super::path::Step;
use super::{LightDraw, NextEvent, Path, light_weight};
use crate::film::Counters;
use crate::integrator::observer::{Found, Observer};
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::media::{MediumInteraction, Participating, Stretch, Way, optical_depth};
use crate::polarisation::Polarisation;
use crate::sampler::Sampler;
use crate::scene::interaction::SurfaceInteraction;
use crate::scene::world::{ShadowRays, World};
use etalon_geometry::Ray;
use etalon_optics::Lanes;

impl<'a, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Path<'a, M, P, N> {
    /// Goes along the ray through the medium that is there, up to what the ray has met. What the medium emits on this way is added, what it
    /// takes away is taken from throughput. Returns where it scatters the path, if it does so before.
    #[inline]
    pub(super) fn travel(
        &mut self,
        world: &World<'a>,
        participating: &Participating<'a>,
        ray: &Ray<f64>,
        met: Option<&SurfaceInteraction<'a>>,
        sampler: &Sampler,
        observer: &mut impl Observer<N>,
    ) -> Option<MediumInteraction<'a>> {
        let start = self.passed_at.unwrap_or(ray.origin);
        let mut length = f64::INFINITY;
        if let Some(vertex) = met {
            self.stack.meet(vertex.surface.interior(), vertex.meets_front());
            length = (vertex.point.position - start).length();
        }
        let medium = participating.around(world.media, &self.stack)?;
        let coefficients = medium.coefficients(&self.wavelengths.lambda_nm);
        let way = Way { origin: start, direction: ray.direction, length };
        let column_m = medium.column(&way) * participating.unit_m;
        if let Some(emitted) = medium.emitted(&coefficients, &self.wavelengths.lambda_nm, column_m) {
            self.add(observer, Found::Medium, emitted, 1.0);
        }
        if !medium.scatters() {
            self.beta *= coefficients.transmittance(column_m);
            return None;
        }
        let depth = self.optical_depth.get_or_insert_with(|| {
            // Sets from the other end than those of surfaces, which are what they are without media.
            let [coarse, fine, ..] = sampler.set(u32::MAX - self.vertex);
            optical_depth([coarse, fine])
        });
        match Stretch::follow(&coefficients, column_m, depth) {
            Stretch::Passed { weight, lane_density } => {
                self.beta *= weight;
                self.lanes.follow(lane_density);
                None
            }
            Stretch::Scattered { column_m, weight, lane_density } => {
                self.beta *= weight;
                self.lanes.follow(lane_density);
                let position = start + ray.direction * medium.distance(&way, column_m / participating.unit_m);
                if let Some(before) = self.walk.media_before((position - ray.origin).length()) {
                    self.stack = before;
                }
                observer.scattering(self.vertex, position, self.beta);
                Some(MediumInteraction::new(position, ray.time, -ray.direction, medium))
            }
        }
    }

    /// The walk's step from a point of a medium: direct light by one shadow ray, a direction by the phase function, Russian roulette. Returns
    /// the ray on which the path goes on.
    #[inline]
    pub(crate) fn scatter_in_medium(
        &mut self,
        world: &World<'a>,
        vertex: &MediumInteraction<'a>,
        sampler: &Sampler,
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) -> Option<Ray<f64>> {
        let sees_lights = world.shadow_rays != ShadowRays::Never;
        if sees_lights {
            let [u_light, u1, u2, _] = sampler.vertex_set(self.vertex, 1);
            if let Some(draw) = world.sample_light(&vertex.point, u_light, [u1, u2])
                && let Some(next) = Self::next_event_in_medium(world, vertex, &draw)
                && let Some(visible) = self.visibility(world, vertex, &draw.sample, counters)
            {
                self.add_light(world, vertex, &draw, &next, &visible, observer);
            }
        }
        let [_, u1, u2, u_roulette] = sampler.vertex_set(self.vertex, 0);
        // The phase function over its own density: throughput stays as it is.
        let (wi, density) = vertex.medium.phase.sample(vertex.wo, [u1, u2]);
        self.polarisation.follow(vertex.wo, wi, || vertex.medium.phase.mueller(vertex.wo, wi));
        self.guiding = 1.0;
        self.step = match sees_lights {
            true => Step::Shared { from: vertex.point.position, leaves: vertex.point.surface, density },
            false => Step::Unshared,
        };
        self.leave_ray(world);
        self.survives(world, 1.0, u_roulette, observer).then(|| vertex.point.spawn(wi))
    }

    /// What a light adds at a point of a medium, if nothing is in the way.
    fn next_event_in_medium(
        world: &World<'a>,
        vertex: &MediumInteraction<'a>,
        LightDraw { probability, sample, .. }: &LightDraw,
    ) -> Option<NextEvent<N>> {
        let density = vertex.medium.phase.density(-vertex.wo.dot(sample.wi));
        let weight = light_weight(world.light_sampling, sample.density, sample.scale, *probability, density);
        (density > 0.0).then(|| NextEvent { f_cos: Lanes::splat(density), weight })
    }
}
