//! Direct light: a shadow ray toward a light from each path whose surface can make something of it.

use super::Engine;
use super::lamps::{Aims, Flats, Rounds, aim, aim_at_disks, aim_at_rounds};
use super::level::{Level, stages};
use super::rows::{GROUPS, Mask, Row, Rows3, W, group_of, lanes};
use super::surface::of_group;
use super::tables::Form;
#[cfg(test)]
use super::tests::{Fault, is_wrong};
use crate::bsdf::lambert;
use crate::light::{LightTable, Target};
use crate::mis::{Density, power_heuristic};
use crate::model::WavelengthModel;
use crate::sampler::{CAMERA_SETS, SETS_PER_VERTEX, Samplers, Wanted};
use etalon_geometry::{LANES, Rays, SurfaceId, SurfacePoint};
use etalon_optics::Lanes;
use etalon_scene::LightSampling;

/// The lights that paths look at, and what comes of it before the shadow rays are traced. Kept from vertex to vertex.
pub(super) struct Sight<const N: usize> {
    /// Numbers of the lights, and the probabilities of having chosen them.
    light: [u32; W],
    probability: Row,
    /// Their surfaces, of those with a row form.
    surface: [SurfaceId; W],
    flats: Flats,
    rounds: Rounds,
    aims: Aims,
    rays: ShadowRows,
    /// Cosines on the viewer's side of Lambert's surfaces.
    cos: Row,
    /// f·|cos|.
    f_cos: [Lanes<f64, N>; W],
    /// What MIS, density and the light's scale make of the light.
    weight: Row,
}

/// The shadow rays of paths.
pub(super) struct ShadowRows {
    origin: Rows3,
    direction: Rows3,
    t_max: Row,
}

impl<const N: usize> Sight<N> {
    pub(super) fn new() -> Self {
        Self {
            light: [u32::MAX; W],
            probability: Row::ZERO,
            surface: [SurfaceId::NONE; W],
            flats: Flats::NONE,
            rounds: Rounds::NONE,
            aims: Aims::NONE,
            rays: ShadowRows { origin: Rows3::ZERO, direction: Rows3::ZERO, t_max: Row::ZERO },
            cos: Row::ZERO,
            f_cos: [Lanes::ZERO; W],
            weight: Row::ZERO,
        }
    }

    /// The light that a path looks at.
    #[inline(always)]
    fn look(&mut self, lane: usize, (index, probability): (usize, f64), lights: &LightTable) {
        self.probability.0[lane] = probability;
        // Where there are few lights it is mostly the same again.
        if self.light[lane] == index as u32 {
            return;
        }
        #[cfg(test)]
        if is_wrong(Fault::StaleLamp) && lane == 6 && self.light[lane] != u32::MAX {
            return;
        }
        self.light[lane] = index as u32;
        let light = &lights.lights()[index];
        self.surface[lane] = light.emitter().map_or(SurfaceId::NONE, |emitter| emitter.surface);
        self.flats.forget(lane);
        self.rounds.forget(lane);
        self.flats.put(lane, light);
        self.rounds.put(lane, light);
    }
}

impl<M: WavelengthModel<N>, const N: usize> Engine<'_, M, N> {
    /// Sends a shadow ray from each of `shared`, and adds what it finds.
    #[inline(always)]
    pub(super) fn direct_light(&mut self, shared: Mask) {
        let world = self.world;
        if shared == 0 || world.lights.is_empty() {
            return;
        }
        let (paths, sight) = (&mut self.paths, &mut self.sight);
        let mut numbers = [[0.0; W]; 4];
        let lights = world.lights.lights();
        let chooses = lights.len() > 1;
        vertex_numbers(self.level, &paths.samplers, &paths.vertex, 1, [true, true, chooses, false], &mut numbers);
        let [u1, u2, u_light, _] = &numbers;
        let mut shared = shared;
        for lane in lanes(shared) {
            let from = paths.at.position.at(lane);
            match if chooses { world.lights.choose(from, u_light[lane]) } else { Some((0, 1.0)) } {
                Some(chosen) => sight.look(lane, chosen, world.lights),
                None => shared &= !(1 << lane),
            }
        }
        if sight.flats.mask & shared != 0 {
            aim(self.level, &paths.at.position, [u1, u2], &sight.flats, &mut sight.aims);
        }
        if sight.flats.disks & shared != 0 {
            aim_at_disks(self.level, &paths.at.position, [u1, u2], &sight.flats, &mut sight.aims);
        }
        let mut rows = sight.flats.mask | sight.flats.disks;
        if sight.rounds.mask & shared != 0 {
            let mut outside = [false; W];
            aim_at_rounds(self.level, &paths.at.position, [u1, u2], &sight.rounds, &mut sight.aims, &mut outside);
            // Those within a sphere are asked for one by one.
            rows |= lanes(sight.rounds.mask).fold(0, |mask, lane| mask | Mask::from(outside[lane]) << lane);
        }
        // What each shadow ray aims at.
        let mut surfaces = [SurfaceId::NONE; W];
        let mut endless: Mask = 0;
        let mut seen: Mask = 0;
        for lane in lanes(shared & rows) {
            let aims = sight.aims.lit[lane] && sight.surface[lane] != paths.at.surface[lane];
            surfaces[lane] = sight.surface[lane];
            seen |= Mask::from(aims) << lane;
        }
        let mut others = [const { None }; W];
        for lane in lanes(shared & !rows) {
            let light = &lights[sight.light[lane] as usize];
            let Some(sample) = light.sample(paths.at.position.at(lane), [u1[lane], u2[lane]], 0.0) else { continue };
            if sample.surface == paths.at.surface[lane] {
                // A surface is no target for its own points: see the plain loop.
                continue;
            }
            match sample.target {
                Target::Point(point) => {
                    surfaces[lane] = sample.surface;
                    sight.aims.point.set(lane, point);
                }
                Target::Infinity => endless |= 1 << lane,
            }
            sight.aims.wi.set(lane, sample.wi);
            if let Density::SolidAngle(density) = sample.density {
                sight.aims.density.0[lane] = density;
            }
            others[lane] = Some((sample.density, sample.scale));
            seen |= 1 << lane;
        }
        lambert_cosines(self.level, (&paths.at.normal, &paths.direction, &sight.aims.wi), &mut sight.cos);
        weights(
            self.level,
            world.light_sampling,
            &sight.cos,
            &sight.aims.density,
            &sight.probability,
            &mut sight.weight,
        );

        let mut asks: Mask = 0;
        for lane in lanes(seen) {
            let lambda_nm = &paths.wavelengths[lane].lambda_nm;
            let parted = paths.parted >> lane & 1 == 1;
            let (f_cos, mean_density) = match paths.at.form[lane] {
                Form::Lambert(slot) => {
                    if sight.cos.0[lane] == 0.0 {
                        continue;
                    }
                    let pdf = lambert::density(sight.cos.0[lane]);
                    let reflectance = paths.known.spectrum(lane, slot, self.tables, &paths.wavelengths[lane]);
                    let mean = if parted { paths.model[lane].mean_density(Lanes::splat(pdf)) } else { pdf };
                    (reflectance * pdf, mean)
                }
                // Deltas make nothing of it.
                Form::Mirror(_) | Form::Dielectric(_) => continue,
                Form::Other => {
                    let scattering = paths.at.scattering[lane].as_ref().expect("what is not Lambert's has been made");
                    let (f_cos, densities) =
                        scattering.eval(lambda_nm, -paths.direction.at(lane), sight.aims.wi.at(lane));
                    (f_cos, paths.model[lane].mean_density(densities))
                }
            };
            if f_cos.is_zero() {
                continue;
            }
            sight.f_cos[lane] = f_cos;
            let (density, scale) = match others[lane] {
                None => (Density::SolidAngle(sight.aims.density.0[lane]), 1.0),
                Some(sample) => sample,
            };
            if parted || paths.at.form[lane] == Form::Other || others[lane].is_some() {
                sight.weight.0[lane] =
                    weight(world.light_sampling, density, scale, sight.probability.0[lane], mean_density);
            }
            asks |= 1 << lane;
            paths.shadow_rays[lane] += 1;
        }
        self.counters.shadow_rays += u64::from(asks.count_ones());
        if asks == 0 {
            return;
        }
        shadow_rays(
            self.level,
            (&paths.at.position, &paths.at.error, &paths.at.normal),
            &sight.aims.point,
            &mut sight.rays,
        );
        for lane in lanes(asks & endless) {
            let ray = paths.at.point(lane).spawn(sight.aims.wi.at(lane));
            sight.rays.origin.set(lane, ray.origin);
            sight.rays.direction.set(lane, ray.direction);
            sight.rays.t_max.0[lane] = ray.t_max;
        }
        if asks.count_ones() as usize <= LANES {
            // As many as are cast at once, wherever they are.
            let mut from = [0; LANES];
            lanes(asks).enumerate().for_each(|(place, lane)| from[place % LANES] = lane);
            let rays = Rays {
                origin: sight.rays.origin.of(&from),
                direction: sight.rays.direction.of(&from),
                t_max: sight.rays.t_max.of(&from),
                leaves: from.map(|lane| paths.at.surface[lane]),
                aims_at: from.map(|lane| surfaces[lane]),
            };
            let active = ((1_u32 << asks.count_ones()) - 1) as u8;
            for place in lanes(world.geometry.any_hits(&rays, active).into()) {
                asks &= !(1 << from[place % LANES]);
            }
        } else {
            for group in 0..GROUPS {
                let first = group * LANES;
                let rays = Rays {
                    origin: sight.rays.origin.group(group),
                    direction: sight.rays.direction.group(group),
                    t_max: sight.rays.t_max.group(group),
                    leaves: of_group(&paths.at.surface, first),
                    aims_at: of_group(&surfaces, first),
                };
                asks &= !(Mask::from(world.geometry.any_hits(&rays, group_of(asks, group))) << first);
            }
        }
        for lane in lanes(asks) {
            let index = sight.light[lane] as usize;
            let lambda_nm = &paths.wavelengths[lane].lambda_nm;
            let arriving = match self.tables.lights[index] {
                Some(slot) => paths.known.spectrum(lane, slot, self.tables, &paths.wavelengths[lane]),
                None => {
                    let (wi, point) = (sight.aims.wi.at(lane), Target::Point(sight.aims.point.at(lane)));
                    world.light_arriving(index, wi, point, 0.0, lambda_nm)
                }
            };
            let direct = sight.f_cos[lane] * arriving * sight.weight.0[lane];
            let found = paths.beta[lane] * direct * paths.model[lane].weight();
            paths.radiance[lane] += found;
        }
    }
}

/// What the light of a sample is multiplied by: its scale over its density, and the weight of MIS against the walk.
#[inline(always)]
fn weight(sampling: LightSampling, density: Density, scale: f64, probability: f64, mean_density: f64) -> f64 {
    match density {
        Density::Delta => scale / probability,
        Density::SolidAngle(density) => {
            let density = density * probability;
            let mis = match sampling {
                LightSampling::Light => 1.0,
                LightSampling::Bsdf => 0.0,
                LightSampling::Mis => power_heuristic(density, mean_density),
            };
            mis * (scale / density)
        }
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

    /// [`weight`] of points of lights, against Lambert's directions.
    fn weights(sampling: LightSampling, cos: &Row, density: &Row, probability: &Row, weights: &mut Row) {
        match sampling {
            LightSampling::Mis => {
                for lane in 0..W {
                    let of_walk = lambert::density(cos.0[lane]);
                    let of_light = Density::SolidAngle(density.0[lane]);
                    weights.0[lane] = weight(LightSampling::Mis, of_light, 1.0, probability.0[lane], of_walk);
                }
            }
            LightSampling::Light | LightSampling::Bsdf => {
                for lane in 0..W {
                    let of_light = Density::SolidAngle(density.0[lane]);
                    weights.0[lane] = weight(sampling, of_light, 1.0, probability.0[lane], 0.0);
                }
            }
        }
    }

    /// Rays from surfaces to points.
    fn shadow_rays(from: (&Rows3, &Row, &Rows3), target: &Rows3, rays: &mut ShadowRows) {
        let (position, error, normal) = from;
        for lane in 0..W {
            let from = SurfacePoint {
                position: position.at(lane),
                position_error: error.0[lane],
                normal: normal.at(lane),
                surface: SurfaceId::NONE,
                label: 0,
                time: 0.0,
            };
            let ray = from.spawn_to(target.at(lane), SurfaceId::NONE);
            rays.origin.set(lane, ray.origin);
            rays.direction.set(lane, ray.direction);
            rays.t_max.0[lane] = ray.t_max;
        }
    }
}
