//! Next-event estimation: ∫ f Le |cos θ| dω over the lights, estimated by one direction toward one of them.

use super::vertex::Vertex;
use super::{MOST_VERTICES, Path};
use crate::bsdf::lambert;
use crate::film::Counters;
use crate::integrator::observer::{Found, Observer};
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::light::{LightSample, Target};
use crate::media::{MediumStack, Participating, Way};
use crate::mis::{Density, Heuristic};
use crate::polarisation::Polarisation;
use crate::scene::interaction::{SurfaceInteraction, Walk};
use crate::scene::shading_tables::BsdfKind;
use crate::scene::world::World;
use crate::spectral::Colour;
use etalon_geometry::{Ray, SurfacePoint};
use etalon_optics::{Lanes, Vec3};
use etalon_scene::LightSampling;

/// A direction toward a light that was chosen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightDraw {
    /// Number of the light, and the probability of having chosen it.
    pub light: u32,
    pub probability: f64,
    pub sample: LightSample,
    /// What a Lambertian surface makes of it, if that is known.
    pub lambert: Option<LambertTerms>,
}

/// What a Lambertian surface makes of a direction toward a light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LambertTerms {
    /// The cosine on the side of the viewer; 0 on the other.
    pub cos: f64,
    /// See [`NextEvent::weight`].
    pub weight: f64,
}

/// What the light of a [`LightDraw`] is worth if the shadow ray reaches it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NextEvent<const N: usize> {
    /// f·|cos θ|.
    pub f_cos: Lanes<f64, N>,
    /// MIS weight · scale / density of the sample.
    pub weight: f64,
}

/// The share of light that comes through along a shadow ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Visibility<const N: usize> {
    /// Through masks.
    pub share: f64,
    /// Through media that absorb.
    pub transmittance: Option<Lanes<f64, N>>,
}

impl World<'_> {
    /// Chooses a light for a point and draws a direction toward it; `None` where none of its light arrives.
    #[inline(always)]
    pub(crate) fn sample_light(&self, point: &SurfacePoint<f64>, u_light: f64, u: [f64; 2]) -> Option<LightDraw> {
        if self.lights.is_empty() {
            return None;
        }
        let (light, probability) = self.lights.choose(point.position, u_light)?;
        let sample = self.lights.lights()[light].sample(point.position, u, point.time)?;
        Some(LightDraw { light: light as u32, probability, sample, lambert: None })
    }
}

/// What the light of a sample is multiplied by: its scale over its density, and the weight of MIS against the walk.
#[inline(always)]
pub(crate) fn light_weight(
    sampling: LightSampling,
    density: Density,
    scale: f64,
    probability: f64,
    (heuristic, density_of_walk): (Heuristic, f64),
) -> f64 {
    match density {
        Density::Delta => scale / probability,
        Density::SolidAngle(density) => {
            let density = density * probability;
            let mis = match sampling {
                LightSampling::Light => 1.0,
                LightSampling::Bsdf => 0.0,
                LightSampling::Mis => heuristic.weight(density, density_of_walk),
            };
            mis * (scale / density)
        }
    }
}

impl<'a, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Path<'a, M, P, N> {
    /// What a light adds at a vertex, if nothing is in the way.
    #[inline(always)]
    pub(crate) fn next_event(
        &mut self,
        world: &World<'a>,
        vertex: &SurfaceInteraction<'a>,
        draw: &LightDraw,
    ) -> Option<NextEvent<N>> {
        let LightDraw { probability, sample, lambert, .. } = draw;
        if sample.surface == vertex.point.surface {
            // A surface is no target for its own points: rounding decides on which side of a sphere they lie, and the
            // BSDF's directions find the sphere's inside at least as well.
            return None;
        }
        let (f_cos, weight) = match (vertex.kind, lambert) {
            (BsdfKind::Lambert(slot), &Some(LambertTerms { cos, weight })) => {
                if cos == 0.0 {
                    return None;
                }
                (self.diffuse_reflectance(world, vertex, slot) * lambert::density(cos), weight)
            }
            _ => {
                let (f_cos, density_of_walk) = self.eval(world, vertex, sample.wi);
                let (sampling, against_walk) = (world.light_sampling, (sample.target.heuristic(), density_of_walk));
                (f_cos, light_weight(sampling, sample.density, sample.scale, *probability, against_walk))
            }
        };
        if f_cos.is_zero() { None } else { Some(NextEvent { f_cos, weight }) }
    }

    /// Sends the shadow ray; `None` if nothing comes through.
    #[inline(always)]
    pub(crate) fn visibility(
        &self,
        world: &World<'a>,
        vertex: &impl Vertex<'a>,
        sample: &LightSample,
        counters: &mut Counters,
    ) -> Option<Visibility<N>> {
        counters.shadow_rays += 1;
        let shadow_ray = match sample.target {
            Target::Point(target) => vertex.point().spawn_to(target, sample.surface),
            Target::Infinity => vertex.point().spawn(sample.wi),
        };
        if !world.meets_groups {
            return (!world.geometry.occluded(&shadow_ray)).then(|| self.unobstructed(world, vertex, sample));
        }
        let ray = Ray { t_max: beyond_target(shadow_ray.t_max), ..shadow_ray };
        let visibility = if world.media.is_none() && world.participating.is_none() {
            Visibility { share: world.share_through_masks(&ray, shadow_ray.t_max, counters), transmittance: None }
        } else {
            self.through_media(world, vertex, sample, &ray, shadow_ray.t_max, counters)
        };
        (visibility.share > 0.0).then_some(visibility)
    }

    /// What comes through where no surface is in the way.
    #[inline(always)]
    pub(crate) fn unobstructed(
        &self,
        world: &World<'a>,
        vertex: &impl Vertex<'a>,
        sample: &LightSample,
    ) -> Visibility<N> {
        let transmittance = world.participating.as_ref().map(|participating| {
            let length = sample.target.distance(vertex.point().position);
            let stack = vertex.media_toward(self, sample.wi);
            let point = vertex.point();
            let way = Way { origin: point.position, direction: sample.wi, length, time: point.time };
            participating.transmittance(world.media, &stack, &self.wavelengths.lambda_nm, &way)
        });
        Visibility { share: 1.0, transmittance }
    }

    /// Masks let their part of the light through, media what they do not absorb, and boundaries of solids all, where they change no medium.
    fn through_media(
        &self,
        world: &World<'a>,
        vertex: &impl Vertex<'a>,
        sample: &LightSample,
        ray: &Ray<f64>,
        arrives: f64,
        counters: &mut Counters,
    ) -> Visibility<N> {
        let mut stack = vertex.media_toward(self, sample.wi);
        let (mut walk, mut share, mut start) = (Walk::default(), 1.0, ray.origin);
        let mut transmittance = Lanes::ONE;
        for _ in 0..MOST_VERTICES {
            let met = world.intersect(ray, &mut walk, &mut stack, counters);
            let length = match &met {
                Some(met) => {
                    stack.meet(met.stated_media(), met.meets_front());
                    (met.point.position - start).length()
                }
                None => sample.target.distance(start),
            };
            let way = Way { origin: start, direction: sample.wi, length, time: ray.time };
            transmittance *= self.transmittance(world, &stack, &way);
            let Some(met) = met else { return Visibility { share, transmittance: Some(transmittance) } };
            let opacity = met.opacity(world);
            if met.point.surface == ray.aims_at || met.hit.t >= arrives && opacity == 1.0 {
                return Visibility { share, transmittance: Some(transmittance) };
            }
            share *= 1.0 - opacity;
            if share == 0.0 {
                return Visibility { share, transmittance: None };
            }
            start = met.point.position;
            walk.pass(&met, &mut stack);
        }
        counters.record_cut(f64::MAX);
        Visibility { share: 0.0, transmittance: None }
    }

    /// What the medium along a ray lets through from a point of it up to the surface that it has met, or else up to a length. The path is in that medium then.
    pub(super) fn transmittance_to(
        &mut self,
        world: &World<'a>,
        (origin, ray): (Vec3<f64>, &Ray<f64>),
        met: Option<&SurfaceInteraction<'a>>,
        otherwise: f64,
    ) -> Lanes<f64, N> {
        if let Some(met) = met {
            self.stack.meet(met.stated_media(), met.meets_front());
        }
        let length = met.map_or(otherwise, |met| (met.point.position - origin).length());
        self.transmittance(world, &self.stack, &Way { origin, direction: ray.direction, length, time: ray.time })
    }

    pub(super) fn transmittance(&self, world: &World<'a>, stack: &MediumStack<'a>, way: &Way) -> Lanes<f64, N> {
        let lambda_nm = &self.wavelengths.lambda_nm;
        let through =
            |participating: &Participating<'a>| participating.transmittance(world.media, stack, lambda_nm, way);
        world.participating.as_ref().map_or(Lanes::ONE, through)
    }

    /// Adds the light of a next event that has come through.
    #[inline(always)]
    pub(crate) fn add_light(
        &mut self,
        world: &World<'a>,
        vertex: &impl Vertex<'a>,
        draw: &LightDraw,
        next: &NextEvent<N>,
        visible: &Visibility<N>,
        observer: &mut impl Observer<N>,
    ) {
        let LightDraw { light, sample: LightSample { wi, target, colour, .. }, .. } = *draw;
        let colour = colour.or_else(|| world.colour_of_emitter(light, target, vertex.point().time));
        let white = self.spectrum_of_light(world, light);
        let arriving = self.coloured(white, colour);
        let mut direct = next.f_cos * arriving * (next.weight * visible.share);
        if let Some(transmittance) = visible.transmittance {
            direct *= transmittance;
        }
        let lambda_nm = &self.wavelengths.lambda_nm;
        let mueller = || vertex.mueller(lambda_nm, wi);
        let found = self.beta * direct * self.lanes.weight();
        let found = self.polarisation.receive_scattered(vertex.wo(), wi, mueller, found);
        let found = self.gather(found);
        observer.light(self.vertex, Found::ShadowRay { light }, found);
    }
}

impl World<'_> {
    /// The colour that an image gives an emitting surface at the point that a shadow ray aims at.
    #[inline(always)]
    pub(super) fn colour_of_emitter(&self, light: u32, target: Target, time: f64) -> Option<Colour> {
        let emitter = self.lights.lights()[light as usize].emitter()?;
        let (image, Target::Point(position)) = (emitter.image?, target) else { return None };
        self.surfaces.emitted(image.object, self.geometry, (emitter.surface, position), time)?.colour.map(Colour::Rgb)
    }

    /// The share of light that comes through where masks are all that a shadow ray may pass: in any order.
    fn share_through_masks(&self, ray: &Ray<f64>, arrives: f64, counters: &mut Counters) -> f64 {
        let mut share = 1.0;
        self.geometry.all_hits(ray, 0.0, |hit| {
            counters.rays += 1;
            if hit.surface == ray.aims_at {
                return ray.t_max;
            }
            let point = self.geometry.surface(ray, &hit);
            let opacity = self.surfaces.of(&point).opacity(self.geometry, &point, &hit);
            if hit.t < arrives || opacity < 1.0 {
                share *= 1.0 - opacity;
            }
            if share == 0.0 { 0.0 } else { ray.t_max }
        });
        share
    }
}

/// Where the search for masks along a shadow ray ends: beyond its target by some times as much as the ray itself ends short of it,
/// for rounding. A mask that coincides with a light lies before it.
pub(crate) fn beyond_target(t_max: f64) -> f64 {
    if t_max < 1.0 { 1.0 + 16.0 * (1.0 - t_max) } else { t_max }
}
