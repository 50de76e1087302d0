//! Direct light: a shadow ray toward a light from each path whose surface can make something of it.

use super::Batch;
use super::arrive::of_group;
use super::lamps::{LightSamples, PlanarLights, SphereLights, aim, aim_at_disks, aim_at_spheres};
use super::level::{Level, stages};
use super::paths::vertex;
use super::rows::{GROUPS, Mask, Row, Rows3, W, group_of, lanes, surface_point};
use super::skies::{FEWEST_LOOKS, SkyLights, aim_at_sky};
use crate::bsdf::lambert;
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::integrator::{LambertTerms, LightDraw, NextEvent, beyond_target, light_weight};
use crate::light::{Light, LightSample, LightTable, Target};
use crate::mis::{Density, Heuristic};
use crate::polarisation::Polarisation;
use crate::sampler::{CAMERA_SETS, SETS_PER_VERTEX, Samplers, Wanted};
use etalon_geometry::{LANES, Rays, SurfaceId};
use etalon_optics::{Lanes, Vec3};
use etalon_scene::LightSampling;

/// The lights that paths look at, and how they are seen. Kept from vertex to vertex.
pub(super) struct Lights {
    /// Numbers of the lights, and the probabilities of having chosen them.
    light: [u32; W],
    probability: Row,
    /// Their surfaces, of those that are aimed at in rows.
    surface: [SurfaceId; W],
    planar: PlanarLights,
    spheres: SphereLights,
    skies: SkyLights,
    light_samples: LightSamples,
    /// What Lambertian surfaces make of them.
    cos: Row,
    weight: Row,
    /// The paths whose lights are aimed at in rows, and the samples of the others.
    rows: Mask,
    others: [Option<LightSample>; W],
    rays: ShadowRows,
}

/// The shadow rays of paths.
pub(super) struct ShadowRows {
    origin: Rows3,
    direction: Rows3,
    t_max: Row,
}

impl Lights {
    pub(super) fn new() -> Self {
        Self {
            light: [u32::MAX; W],
            probability: Row::ZERO,
            surface: [SurfaceId::NONE; W],
            planar: PlanarLights::NONE,
            spheres: SphereLights::NONE,
            skies: SkyLights::NONE,
            light_samples: LightSamples::NONE,
            cos: Row::ZERO,
            weight: Row::ZERO,
            rows: 0,
            others: [None; W],
            rays: ShadowRows { origin: Rows3::ZERO, direction: Rows3::ZERO, t_max: Row::ZERO },
        }
    }

    /// The direction toward it that was drawn for a path.
    #[inline(always)]
    fn draw(&self, lane: usize) -> Option<LightDraw> {
        let (light, probability) = (self.light[lane], self.probability.0[lane]);
        if self.rows >> lane & 1 == 1 {
            let lambert = Some(LambertTerms { cos: self.cos.0[lane], weight: self.weight.0[lane] });
            let sample = match self.skies.mask >> lane & 1 {
                1 => self.skies.sample(lane, self.light_samples.wi.at(lane)),
                _ => self.light_samples.sample(lane, self.surface[lane]),
            }?;
            return Some(LightDraw { light, probability, sample, lambert });
        }
        let sample = self.others[lane]?;
        Some(LightDraw { light, probability, sample, lambert: None })
    }

    /// The light that a path looks at.
    #[inline(always)]
    fn look(&mut self, lane: usize, (index, probability): (usize, f64), lights: &LightTable) {
        self.probability.0[lane] = probability;
        // Where there are few lights it is mostly the same again.
        if self.light[lane] == index as u32 {
            return;
        }
        self.light[lane] = index as u32;
        let light = &lights.lights()[index];
        self.surface[lane] = light.emitter().map_or(SurfaceId::NONE, |emitter| emitter.surface);
        self.planar.forget(lane);
        self.spheres.forget(lane);
        self.planar.put(lane, light);
        self.spheres.put(lane, light);
        self.skies.put(lane, light);
    }
}

impl<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Batch<'_, M, P, N> {
    /// Sends a shadow ray from each path that scatters and sees lights, and adds what it finds.
    #[inline(always)]
    pub(super) fn add_light(&mut self, scatters: Mask) {
        let (paths, world) = (&self.paths, self.world);
        let mut shared = 0;
        for lane in lanes(scatters) {
            shared |= Mask::from(vertex(&paths.at, lane).sees_lights) << lane;
        }
        if shared == 0 || world.lights.is_empty() {
            return;
        }
        self.add_direct_light(shared);
        if self.world.specular_connections.is_some() {
            self.connect(shared);
        }
    }

    /// Adds the light of lamps without area that comes by way of mirrors and smooth interfaces, path by path.
    fn connect(&mut self, shared: Mask) {
        for lane in lanes(shared) {
            let before = self.counters.rays + self.counters.shadow_rays;
            let (path, vertex) = (&mut self.paths.paths[lane], vertex(&self.paths.at, lane));
            path.connect(self.world, vertex, self.paths.samplers.lane(lane), &mut self.counters, &mut ());
            let rays = self.counters.rays + self.counters.shadow_rays - before;
            self.paths.ray_count[lane] += rays as u32;
        }
    }

    #[inline(always)]
    fn add_direct_light(&mut self, mut shared: Mask) {
        let (paths, world, draws) = (&mut self.paths, self.world, &mut self.lights);
        let mut numbers = [[0.0; W]; 4];
        let lights = world.lights.lights();
        let chooses = lights.len() > 1;
        vertex_numbers(self.level, &paths.samplers, &paths.vertex, 1, [true, true, chooses, false], &mut numbers);
        let [u1, u2, u_light, _] = &numbers;
        for lane in lanes(shared) {
            let from = paths.position.at(lane);
            match if chooses { world.lights.choose(from, u_light[lane]) } else { Some((0, 1.0)) } {
                Some(chosen) => draws.look(lane, chosen, world.lights),
                None => shared &= !(1 << lane),
            }
        }
        if draws.planar.mask & shared != 0 {
            aim(self.level, &paths.position, [u1, u2], &draws.planar, &mut draws.light_samples);
        }
        if draws.planar.disks & shared != 0 {
            aim_at_disks(self.level, &paths.position, [u1, u2], &draws.planar, &mut draws.light_samples);
        }
        let mut rows = draws.planar.mask | draws.planar.disks;
        if draws.spheres.mask & shared != 0 {
            let mut outside = [false; W];
            aim_at_spheres(
                self.level,
                &paths.position,
                [u1, u2],
                &draws.spheres,
                &mut draws.light_samples,
                &mut outside,
            );
            // Those within a sphere are asked for one by one.
            rows |= lanes(draws.spheres.mask).fold(0, |mask, lane| mask | Mask::from(outside[lane]) << lane);
        }
        let mut skies = draws.skies.mask & shared;
        while skies != 0 {
            let index = draws.light[skies.trailing_zeros() as usize];
            let same =
                lanes(skies).filter(|&lane| draws.light[lane] == index).fold(0, |mask: Mask, lane| mask | 1 << lane);
            skies &= !same;
            if let (Light::Environment(sky), FEWEST_LOOKS..) = (&lights[index as usize], same.count_ones()) {
                aim_at_sky(self.level, sky, [u1, u2], same, &mut draws.skies, &mut draws.light_samples);
                rows |= same;
            }
        }
        lambert_cosines(self.level, (&paths.normal, &paths.direction, &draws.light_samples.wi), &mut draws.cos);
        let Lights { cos, light_samples, probability, weight, skies, .. } = draws;
        let densities = (&light_samples.density, &*probability);
        weights(self.level, world.light_sampling, cos, densities, skies.mask, weight);
        let mut next = [NextEvent { f_cos: Lanes::ZERO, weight: 0.0 }; W];
        let mut asks: Mask = 0;
        draws.rows = rows;
        for lane in lanes(shared) {
            if rows >> lane & 1 == 0 {
                let (from, u) = (paths.position.at(lane), [u1[lane], u2[lane]]);
                draws.others[lane] = lights[draws.light[lane] as usize].sample(from, u, paths.time[lane]);
            }
            let Some(draw) = draws.draw(lane) else { continue };
            if let Some(event) = paths.paths[lane].next_event(world, vertex(&paths.at, lane), &draw) {
                next[lane] = event;
                asks |= 1 << lane;
            }
        }
        if world.meets_groups || world.moves {
            // Where only boundaries of solids may let light pass and nothing absorbs it, what meets nothing needs no walk.
            let mut meets = asks;
            if world.media.is_some() && world.participating.is_none() && !world.moves {
                meets = asks & !self.unoccluded(asks, beyond_target);
            }
            for lane in lanes(asks) {
                let Some(draw) = self.lights.draw(lane) else { continue };
                let (path, vertex) = (&mut self.paths.paths[lane], vertex(&self.paths.at, lane));
                let before = self.counters.rays + self.counters.shadow_rays;
                let visible = if meets >> lane & 1 == 1 {
                    path.visibility(world, vertex, &draw.sample, &mut self.counters)
                } else {
                    self.counters.shadow_rays += 1;
                    Some(path.unobstructed(world, vertex, &draw.sample))
                };
                self.paths.ray_count[lane] += (self.counters.rays + self.counters.shadow_rays - before) as u32;
                match visible {
                    Some(visible) => path.add_light(world, vertex, &draw, &next[lane], &visible, &mut ()),
                    None => self.add_refracted_light(lane, &draw),
                }
            }
            return;
        }
        self.counters.shadow_rays += u64::from(asks.count_ones());
        lanes(asks).for_each(|lane| paths.ray_count[lane] += 1);
        let unoccluded = self.unoccluded(asks, |t_max| t_max);
        for lane in lanes(unoccluded) {
            let Some(draw) = self.lights.draw(lane) else { continue };
            let (path, vertex) = (&mut self.paths.paths[lane], vertex(&self.paths.at, lane));
            let visible = path.unobstructed(world, vertex, &draw.sample);
            path.add_light(world, vertex, &draw, &next[lane], &visible, &mut ());
        }
        if world.refracting_bodies.is_some() || world.panes.is_some() {
            for lane in lanes(asks & !unoccluded) {
                if let Some(draw) = self.lights.draw(lane) {
                    self.add_refracted_light(lane, &draw);
                }
            }
        }
    }

    /// Adds the light that comes to a path through the glass in the way of its shadow ray.
    fn add_refracted_light(&mut self, lane: usize, draw: &LightDraw) {
        let before = self.counters.rays;
        let (path, vertex) = (&mut self.paths.paths[lane], vertex(&self.paths.at, lane));
        let sampler = self.paths.samplers.lane(lane);
        path.add_refracted_light(self.world, vertex, draw, sampler, &mut self.counters, &mut ());
        self.paths.ray_count[lane] += (self.counters.rays - before) as u32;
    }

    /// Which shadow rays meet nothing up to where `end` says that they end.
    #[inline(always)]
    fn unoccluded(&mut self, mut asks: Mask, end: impl Fn(f64) -> f64) -> Mask {
        if asks == 0 {
            return 0;
        }
        let (paths, geometry, draws) = (&mut self.paths, self.world.geometry, &mut self.lights);
        let (mut leaves, mut surfaces) = ([SurfaceId::NONE; W], [SurfaceId::NONE; W]);
        let mut endless: Mask = 0;
        for lane in lanes(asks) {
            leaves[lane] = vertex(&paths.at, lane).point.surface;
            surfaces[lane] = draws.surface[lane];
            if draws.rows >> lane & 1 == 1 {
                endless |= draws.skies.mask & 1 << lane;
                continue;
            }
            let Some(sample) = &draws.others[lane] else { continue };
            surfaces[lane] = sample.surface;
            match sample.target {
                Target::Point(point) => draws.light_samples.point.set(lane, point),
                Target::Infinity => {
                    draws.light_samples.wi.set(lane, sample.wi);
                    endless |= 1 << lane;
                }
            }
        }
        let (rays, light_samples) = (&mut draws.rays, &draws.light_samples);
        let from = (&paths.position, &paths.error, &paths.normal);
        if endless != asks {
            shadow_rays(self.level, from, &light_samples.point, rays);
        }
        if endless != 0 {
            endless_rays(self.level, from, &light_samples.wi, endless, rays);
            lanes(endless).for_each(|lane| surfaces[lane] = SurfaceId::NONE);
        }
        for t_max in &mut rays.t_max.0 {
            *t_max = end(*t_max);
        }
        if asks.count_ones() as usize <= LANES {
            // As many as are cast at once, wherever they are.
            let mut from = [0; LANES];
            lanes(asks).enumerate().for_each(|(place, lane)| from[place % LANES] = lane);
            let packed = Rays {
                origin: rays.origin.of(&from),
                direction: rays.direction.of(&from),
                t_max: rays.t_max.of(&from),
                leaves: from.map(|lane| leaves[lane]),
                aims_at: from.map(|lane| surfaces[lane]),
            };
            let active = ((1_u32 << asks.count_ones()) - 1) as u8;
            for place in lanes(geometry.any_hits(&packed, active).into()) {
                asks &= !(1 << from[place % LANES]);
            }
        } else {
            for group in 0..GROUPS {
                let first = group * LANES;
                let packed = Rays {
                    origin: rays.origin.group(group),
                    direction: rays.direction.group(group),
                    t_max: rays.t_max.group(group),
                    leaves: of_group(&leaves, first),
                    aims_at: of_group(&surfaces, first),
                };
                asks &= !(Mask::from(geometry.any_hits(&packed, group_of(asks, group))) << first);
            }
        }
        asks
    }
}

stages! {
    /// Set number `set` of the vertex that each path is at: (point 1, point 2, choice, decision).
    fn vertex_numbers(
        samplers: &Samplers<W>,
        vertex: &[u32; W],
        set: u32,
        wanted: Wanted,
        numbers: &mut [[f64; W]; 4],
    ) {
        let mut sets = [0; W];
        for lane in 0..W {
            sets[lane] = CAMERA_SETS + vertex[lane] * SETS_PER_VERTEX + set;
        }
        samplers.sets(&sets, wanted, numbers);
    }

    /// Cosines of directions on the viewer's side of surfaces; 0 on the other.
    fn lambert_cosines(surface: (&Rows3, &Rows3, &Rows3), cos: &mut Row) {
        let (normal, direction, wi) = surface;
        for lane in 0..W {
            cos.0[lane] = lambert::common_cosine(normal.at(lane), -direction.at(lane), wi.at(lane));
        }
    }

    /// [`light_weight`] of points of lights, against Lambert's directions.
    fn weights(sampling: LightSampling, cos: &Row, densities: (&Row, &Row), skies: Mask, weights: &mut Row) {
        let (density, probability) = densities;
        let weight = |lane: usize, sampling: LightSampling, heuristic: Heuristic| {
            let of_light = Density::SolidAngle(density.0[lane]);
            let against_walk = (heuristic, lambert::density(cos.0[lane]));
            light_weight(sampling, of_light, 1.0, probability.0[lane], against_walk)
        };
        // Outside of the loops, which are to have no branches.
        match (sampling, skies) {
            (LightSampling::Mis, 0) => {
                for lane in 0..W {
                    weights.0[lane] = weight(lane, LightSampling::Mis, Heuristic::Power);
                }
            }
            (LightSampling::Mis, _) => {
                for lane in 0..W {
                    let [of_lamp, of_sky] =
                        [Heuristic::Power, Heuristic::Balance].map(|heuristic| weight(lane, LightSampling::Mis, heuristic));
                    weights.0[lane] = if skies >> lane & 1 == 1 { of_sky } else { of_lamp };
                }
            }
            (LightSampling::Light | LightSampling::Bsdf, _) => {
                for lane in 0..W {
                    weights.0[lane] = weight(lane, sampling, Heuristic::Power);
                }
            }
        }
    }

    /// Rays from surfaces to points.
    fn shadow_rays(from: (&Rows3, &Row, &Rows3), target: &Rows3, rays: &mut ShadowRows) {
        for lane in 0..W {
            let point = surface_point(from, lane);
            let ray = point.spawn_to(target.at(lane), SurfaceId::NONE);
            rays.origin.set(lane, ray.origin);
            rays.direction.set(lane, ray.direction);
            rays.t_max.0[lane] = ray.t_max;
        }
    }
    /// Rays from surfaces that never end, of the paths of `mask`, in place of those that are there.
    fn endless_rays(from: (&Rows3, &Row, &Rows3), wi: &Rows3, mask: Mask, rays: &mut ShadowRows) {
        for lane in 0..W {
            let ray = surface_point(from, lane).spawn(wi.at(lane));
            let choose = |new: f64, there: f64| if mask >> lane & 1 == 1 { new } else { there };
            let mix = |new: Vec3<f64>, there: Vec3<f64>| {
                Vec3::new(choose(new.x, there.x), choose(new.y, there.y), choose(new.z, there.z))
            };
            rays.origin.set(lane, mix(ray.origin, rays.origin.at(lane)));
            rays.direction.set(lane, mix(ray.direction, rays.direction.at(lane)));
            rays.t_max.0[lane] = choose(ray.t_max, rays.t_max.0[lane]);
        }
    }
}
