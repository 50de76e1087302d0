//! Light that a path runs into: on surfaces and at infinity, weighed against the shadow rays that may have found it.

use super::Path;
use super::path::{Since, Step, Through};
use crate::film::Counters;
use crate::integrator::observer::{Found, Observer};
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::light::{Brightness, Environment, EnvironmentRadiance, Light, Look};
use crate::mis::Heuristic;
use crate::polarisation::Polarisation;
use crate::scene::interaction::SurfaceInteraction;
use crate::scene::shading_tables::Slot;
use crate::scene::world::World;
use crate::spectral::Colour;
use etalon_geometry::{Ray, SurfaceId};
use etalon_optics::{Lanes, Vec3};
use etalon_scene::LightSampling;

impl<'a, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Path<'a, M, P, N> {
    /// Adds the light from infinity.
    #[inline(always)]
    pub(super) fn add_environments(
        &mut self,
        world: &World<'a>,
        ray: &Ray<f64>,
        mut sky: Option<Look>,
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) {
        for (environment, slot) in world.environments.iter().zip(&world.tables.environments) {
            counters.environment_lookups += 1;
            let (radiance, seen) = self.radiance_from(world, environment, *slot, ray, &mut sky);
            let mis = match seen {
                None => 1.0,
                // No shadow ray aims at what light paths leave.
                Some(seen) if environment.light.is_some() && self.is_light_traced(world) => {
                    1.0 - environment.radiance.bright_share(seen)
                }
                Some(seen) => self.weight_of_hit(world, ray, None, || environment.light, |_, _| seen.density),
            };
            self.add(observer, Found::Environment, radiance, mis);
        }
    }

    /// What a sky shows along a ray, and how bright that is to shadow rays, if they aim at it.
    #[inline(always)]
    fn radiance_from(
        &mut self,
        world: &World<'a>,
        environment: &Environment,
        slot: Slot,
        ray: &Ray<f64>,
        sky: &mut Option<Look>,
    ) -> (Lanes<f64, N>, Option<Brightness>) {
        let white = self.spectra.of(slot, environment.radiance.spectrum(), world.tables, &self.wavelengths);
        match &environment.radiance {
            EnvironmentRadiance::Uniform(_) => (white, None),
            EnvironmentRadiance::Image(image) => {
                let look = sky.take().unwrap_or_else(|| image.look(ray.direction));
                (self.coloured(white, Some(Colour::Rgb(look.colour))), Some(look.brightness()))
            }
            EnvironmentRadiance::Sky(of) => {
                let look = of.look(ray.direction);
                (self.coloured(white, look.colour) * look.relative, Some(look.brightness))
            }
        }
    }

    /// What the sky of a light shows along a ray.
    pub(super) fn radiance_of_sky(&mut self, world: &World<'a>, ray: &Ray<f64>, light: u32) -> Option<Lanes<f64, N>> {
        let skies = world.environments.iter().zip(&world.tables.environments);
        let (sky, slot) = skies.into_iter().find(|(sky, _)| sky.light == Some(light))?;
        Some(self.radiance_from(world, sky, *slot, ray, &mut None).0)
    }

    /// What a surface emits toward where the path came from.
    #[inline(always)]
    pub(super) fn radiance_of_surface(
        &mut self,
        world: &World<'a>,
        vertex: &SurfaceInteraction<'a>,
    ) -> Option<Lanes<f64, N>> {
        let SurfaceInteraction { hit, point, surface, wo, .. } = vertex;
        let emitted = surface.emission_along(world.geometry, point, hit, *wo)?;
        let slot = world.tables.objects[surface.object as usize].emission;
        let white = self.spectra.of(slot, emitted.radiance, world.tables, &self.wavelengths);
        Some(self.coloured(white, emitted.colour.map(Colour::Rgb)))
    }

    /// Adds the light that the surface emits.
    #[inline(always)]
    pub(super) fn add_emission(
        &mut self,
        world: &World<'a>,
        ray: &Ray<f64>,
        vertex: &SurfaceInteraction<'a>,
        observer: &mut impl Observer<N>,
    ) {
        let SurfaceInteraction { point, surface, .. } = vertex;
        if self.is_light_traced(world) && surface.light(point.surface).is_some() {
            return;
        }
        let Some(radiance) = self.radiance_of_surface(world, vertex) else { return };
        let density = |light: &Light, from| light.density(from, ray.direction, ray.time);
        let mis = self.weight_of_hit(world, ray, Some(point.surface), || surface.light(point.surface), density);
        self.add(observer, Found::Emitter, radiance, mis);
    }

    /// Adds light that the walk has run into.
    #[inline(always)]
    pub(super) fn add(&mut self, observer: &mut impl Observer<N>, how: Found, radiance: Lanes<f64, N>, mis: f64) {
        let found = self.polarisation.receive(self.beta * radiance * (self.lanes.weight() * mis));
        let found = self.gather(found);
        observer.light(self.vertex, how, found);
    }

    /// The MIS weight of light that the walk ran into, `on` a surface or at infinity. `light` finds its number, if shadow rays aim at it, and
    /// `density_of` the density with which they take the direction of the walk from a point.
    #[inline(always)]
    fn weight_of_hit(
        &self,
        world: &World<'a>,
        ray: &Ray<f64>,
        on: Option<SurfaceId>,
        light: impl Fn() -> Option<u32>,
        density_of: impl Fn(&Light, Vec3<f64>) -> f64,
    ) -> f64 {
        let Step::Shared { from, leaves, density, since } = self.step else { return 1.0 };
        // The far side of the sphere that it left: see `next_event`. Shadow rays do not aim at the far side of one that it has passed, either.
        let passed = if let Since::Mask(shines) = since { on == Some(shines) } else { false };
        if !world.weigh_hits || on == Some(leaves) || passed {
            return 1.0;
        }
        let Some(light) = light() else { return 1.0 };
        let heuristic = Heuristic::of(on.is_none());
        if let Since::Interfaces(Through { wi, .. }) = since {
            return heuristic.weight(density, world.density_toward(light, (from, leaves), wi, ray.time));
        }
        let light = light as usize;
        let of_direction = density_of(&world.lights.lights()[light], from);
        match world.light_sampling {
            // No shadow ray could have found it.
            _ if of_direction == 0.0 => 1.0,
            LightSampling::Light => 0.0,
            LightSampling::Bsdf => 1.0,
            LightSampling::Mis => heuristic.weight(density, world.lights.probability(light, from) * of_direction),
        }
    }
}
