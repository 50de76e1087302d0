//! Paths in media: the way along a ray, and the step that the walk takes where a medium scatters it.

use super::path::{Since, Step};
use super::specular::PassedBeams;
use super::{LightDraw, NextEvent, Path, light_weight};
use crate::film::Counters;
use crate::integrator::observer::{Found, Observer};
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::light::{Light, LitPart};
use crate::media::{Coefficients, Medium, MediumInteraction, Stretch, Way, free_point, optical_depth};
use crate::polarisation::Polarisation;
use crate::sampler::Sampler;
use crate::scene::interaction::SurfaceInteraction;
use crate::scene::world::{ShadowRays, World};
use etalon_geometry::Ray;
use etalon_optics::Lanes;

impl<'a, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Path<'a, M, P, N> {
    /// Goes along the ray through the medium that is there, up to what the ray has met. What the medium emits on this way is added, what it
    /// takes away is taken from throughput. Whether it scatters the path before: at `collision`.
    #[inline]
    pub(super) fn travel(
        &mut self,
        world: &World<'a>,
        ray: &Ray<f64>,
        met: Option<&SurfaceInteraction<'a>>,
        sampler: &Sampler,
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) -> bool {
        let Some(participating) = &world.participating else { return false };
        let start = self.passed_at.unwrap_or(ray.origin);
        let mut length = f64::INFINITY;
        if let Some(vertex) = met {
            self.stack.meet(vertex.stated_media(), vertex.meets_front());
            length = (vertex.point.position - start).length();
        }
        let way = Way { origin: start, direction: ray.direction, length, time: ray.time };
        let Some((medium, local)) = participating.along(world.media, &self.stack, &way) else { return false };
        let coefficients = medium.coefficients(&self.wavelengths.lambda_nm);
        let column_m = medium.column(&local) * participating.unit_m;
        if let Some(emitted) = medium.emitted(&coefficients, &self.wavelengths.lambda_nm, column_m) {
            self.add(observer, Found::Medium, emitted, 1.0);
        }
        if !medium.scatters() {
            self.beta *= coefficients.transmittance(column_m);
            return false;
        }
        // Sets from the other end than those of surfaces, which are what they are without media.
        let [coarse, fine, u_light, u_place] = sampler.set(u32::MAX - self.vertex);
        let lit = MediumWay { medium, coefficients, way, local, unit_m: participating.unit_m };
        if world.lights_parts && self.edges(2) <= world.max_depth {
            self.add_light_beside(world, &lit, ray, [u_light, u_place], counters, observer);
        }
        let mut beams = PassedBeams::default();
        if let Some(connections) = world.specular_connections.filter(|connections| connections.has_beams)
            && self.has_edges_for_a_chain(world)
        {
            beams = self.passed_beams(world, connections, &lit, ray, sampler, counters);
            self.connect_in_beam(world, (&lit, &beams), ray, sampler, counters, observer);
        }
        let depth = self.optical_depth.get_or_insert_with(|| optical_depth([coarse, fine]));
        match Stretch::follow(&lit.coefficients, column_m, depth) {
            Stretch::Passed { weight, lane_density } => {
                self.beta *= weight;
                self.lanes.follow(lane_density);
                false
            }
            Stretch::Scattered { column_m, weight, lane_density } => {
                let distance = medium.distance(&local, column_m / participating.unit_m);
                let mut vertex = self.medium_interaction(world, &lit, ray, distance);
                let in_beams = beams.density(distance);
                if in_beams > 0.0 {
                    let hero = lit.scattered_at(distance)[0];
                    vertex.share_of_connections = hero / (hero + in_beams);
                }
                self.beta *= weight * medium.albedo(&self.wavelengths.lambda_nm, local.at(distance));
                self.lanes.follow(lane_density);
                self.stack = vertex.stack;
                observer.scattering(self.vertex, vertex.point.position, self.beta);
                self.collision = Some(vertex);
                true
            }
        }
    }

    /// The place at a distance along a way.
    pub(super) fn medium_interaction(
        &self,
        world: &World<'a>,
        lit: &MediumWay<'a, N>,
        ray: &Ray<f64>,
        distance: f64,
    ) -> MediumInteraction<'a> {
        let MediumWay { medium, way, .. } = *lit;
        let position = way.at(distance);
        // Boundaries that change no medium may lie between the place and what the ray has met.
        let stack = self.walk.media_before((position - ray.origin).length()).unwrap_or(self.stack);
        let density = if world.lights_parts { self.lanes.mean_density(lit.scattered_at(distance)) } else { 0.0 };
        MediumInteraction {
            point: free_point(position, ray.time),
            wo: -ray.direction,
            medium,
            stack,
            way,
            distance,
            density,
            share_of_connections: 1.0,
        }
    }

    /// Adds the light of a lamp without area that a place of the way sends on toward the path's origin. The place is chosen where the lamp
    /// shines. The balance heuristic weighs it against places where the path is scattered.
    fn add_light_beside(
        &mut self,
        world: &World<'a>,
        lit: &MediumWay<'a, N>,
        ray: &Ray<f64>,
        [u_light, u_place]: [f64; 2],
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) {
        let Some((light, probability)) = world.lights.choose(lit.way.origin, u_light) else { return };
        let Some(seen) = beside(&world.lights.lights()[light], &lit.coefficients, &lit.way, lit.unit_m) else { return };
        let distance = seen.distance(u_place);
        if !(distance > 0.0 && distance < lit.way.length) {
            return;
        }
        let vertex = self.medium_interaction(world, lit, ray, distance);
        let Some(sample) = world.lights.lights()[light].sample(vertex.point.position, [0.0; 2], ray.time) else {
            return;
        };
        let phase = vertex.medium.phase.density(-vertex.wo.dot(sample.wi));
        let by_lamp = probability * seen.density(distance);
        let by_scattering = vertex.density * world.lights.probability(light, vertex.point.position);
        let weight = sample.scale / (by_lamp + by_scattering);
        let f_cos = lit.scattered_toward(distance, &self.wavelengths.lambda_nm) * phase;
        if f_cos.is_zero() {
            return;
        }
        let draw = LightDraw { light: light as u32, probability, sample, lambert: None };
        if let Some(visible) = self.visibility(world, &vertex, &sample, counters) {
            self.add_light(world, &vertex, &draw, &NextEvent { f_cos, weight }, &visible, observer);
        }
    }

    /// The walk's step from where a medium scatters it: direct light by one shadow ray, a direction by the phase function, Russian roulette. Returns
    /// the ray on which the path goes on.
    #[inline]
    pub(crate) fn scatter_in_medium(
        &mut self,
        world: &World<'a>,
        sampler: &Sampler,
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) -> Option<Ray<f64>> {
        let vertex = &self.collision.take().expect("it is asked for where a medium scatters the path");
        let sees_lights = world.shadow_rays != ShadowRays::Never;
        if sees_lights {
            let [u_light, u1, u2, _] = sampler.vertex_set(self.vertex, 1);
            if let Some(draw) = world.sample_light(&vertex.point, u_light, [u1, u2])
                && let Some(next) = self.next_event_in_medium(world, vertex, &draw)
            {
                let visible = match self.starts_within_body(world, vertex, &draw) {
                    true => None,
                    false => self.visibility(world, vertex, &draw.sample, counters),
                };
                match visible {
                    Some(visible) => self.add_light(world, vertex, &draw, &next, &visible, observer),
                    None => self.add_refracted_light(world, vertex, &draw, sampler, counters, observer),
                }
            }
            let beta = self.beta;
            self.beta *= vertex.share_of_connections;
            self.connect(world, vertex, sampler, counters, observer);
            self.beta = beta;
        }
        let [_, u1, u2, u_roulette] = sampler.vertex_set(self.vertex, 0);
        // The phase function over its own density: throughput stays as it is, but for polarisation.
        let phase = &vertex.medium.phase;
        let (wi, density) = match self.polarisation.linear_worth(&self.beta) {
            None => phase.sample(vertex.wo, [u1, u2]),
            Some(worth) => {
                let (wi, density, around) = phase.sample_polarised(vertex.wo, &worth, [u1, u2]);
                self.polarisation.follow(vertex.wo, wi, || phase.mueller(vertex.wo, wi));
                // Where it is 0 no direction is drawn but by rounding, and no light is worth anything.
                self.beta *= self.polarisation.normalise() * if around > 0.0 { 1.0 / around } else { 0.0 };
                // Without `around`, as for directions to lamps: any densities will do for weights that add up to 1.
                (wi, density)
            }
        };
        self.guiding = 1.0;
        self.step = match sees_lights {
            true => Step::Shared {
                from: vertex.point.position,
                leaves: vertex.point.surface,
                density,
                since: Since::Nothing,
            },
            false => Step::Unshared,
        };
        self.leave_ray(world);
        self.survives(world, 1.0, u_roulette, observer).then(|| vertex.point.spawn(wi))
    }

    /// What a light adds at a point of a medium, if nothing is in the way.
    fn next_event_in_medium(
        &self,
        world: &World<'a>,
        vertex: &MediumInteraction<'a>,
        LightDraw { light, probability, sample, .. }: &LightDraw,
    ) -> Option<NextEvent<N>> {
        let density = vertex.medium.phase.density(-vertex.wo.dot(sample.wi));
        let against_walk = (sample.target.heuristic(), density);
        let mut weight = light_weight(world.light_sampling, sample.density, sample.scale, *probability, against_walk);
        let lamp = &world.lights.lights()[*light as usize];
        let coefficients = || vertex.medium.coefficients(&self.wavelengths.lambda_nm);
        if let (true, Some(participating)) = (lamp.lights_parts(), &world.participating)
            && let Some(seen) = beside(lamp, &coefficients(), &vertex.way, participating.unit_m)
        {
            let by_lamp = world.lights.probability(*light as usize, vertex.way.origin) * seen.density(vertex.distance);
            weight /= 1.0 + by_lamp / (vertex.density * probability);
        }
        (density > 0.0).then(|| NextEvent { f_cos: Lanes::splat(density), weight })
    }
}

/// A way through a medium that scatters.
pub(in crate::integrator) struct MediumWay<'a, const N: usize> {
    medium: &'a Medium,
    coefficients: Coefficients<N>,
    pub(super) way: Way,
    /// The same in the coordinates of the medium.
    local: Way,
    /// Metres in a unit of the frame.
    unit_m: f64,
}

impl<const N: usize> MediumWay<'_, N> {
    /// The share of light that comes through from a distance, times the density of the medium there and a unit's length.
    fn through(&self, distance: f64) -> Lanes<f64, N> {
        let column_m = self.medium.column(&Way { length: distance, ..self.local }) * self.unit_m;
        let density = self.medium.density(self.local.at(distance));
        self.coefficients.transmittance(column_m) * (density * self.unit_m)
    }

    /// The density with which paths are scattered at a distance, in each lane, per unit of the frame.
    pub(super) fn scattered_at(&self, distance: f64) -> Lanes<f64, N> {
        self.through(distance) * self.coefficients.extinction
    }

    /// The share of light that a unit's length scatters at a distance and that comes to the beginning.
    pub(super) fn scattered_toward(&self, distance: f64, lambda_nm: &Lanes<f64, N>) -> Lanes<f64, N> {
        let albedo = self.medium.albedo(lambda_nm, self.local.at(distance));
        self.through(distance) * self.coefficients.scattering * albedo
    }
}

/// The part of a way that a lamp without area lights, if it is not too deep in the medium. Beyond that, other light prevails, and a place
/// chosen for this lamp gains nothing.
fn beside<const N: usize>(light: &Light, coefficients: &Coefficients<N>, way: &Way, unit_m: f64) -> Option<LitPart> {
    /// Optical depth between the lamp and the way, or in a beam along the way.
    const DEEPEST: f64 = 4.0;
    let lit = LitPart::new(light, way)?;
    (coefficients.extinction.max_lane() * lit.beside() * unit_m < DEEPEST).then_some(lit)
}
