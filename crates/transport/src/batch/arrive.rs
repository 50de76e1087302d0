//! Where paths arrive: the surfaces that they meet.

use super::Batch;
use super::paths::vertex;
use super::rows::{GROUPS, Mask, W, group_of, lanes};
use super::skies::{FEWEST_LOOKS, look_at_sky};
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::integrator::{Arrival, Intersection};
use crate::light::Look;
use crate::polarisation::Polarisation;
use crate::scene::interaction::SurfaceInteraction;
use crate::scene::world::World;
use etalon_geometry::{Hit, LANES, SurfaceId, SurfacePoint};
use etalon_optics::Vec3;

impl<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Batch<'_, M, P, N> {
    /// Finds what the ray of each path meets, and lets the path arrive there. Tells which scatter.
    #[inline(always)]
    pub(super) fn arrive(&mut self) -> Mask {
        let count = self.paths.alive.count_ones();
        self.counters.rays += u64::from(count);
        self.counters.lane_weights += u64::from(count) * u64::from(M::CARRIES_WEIGHTS);
        let mut scatters = 0;
        for group in 0..GROUPS {
            let active = group_of(self.paths.alive, group);
            if active == 0 {
                continue;
            }
            scatters |= match self.world {
                // What moves is found ray by ray.
                World { moves: true, .. } => self.arrive_one_by_one(active, group * LANES),
                World { meets_groups: true, .. } => self.arrive_in_groups(active, group),
                _ => self.arrive_at_once(active, group),
            };
        }
        scatters
    }

    #[inline(always)]
    fn arrive_at_once(&mut self, active: u8, group: usize) -> Mask {
        let (first, rays, world) = (group * LANES, self.paths.rays(group), self.world);
        let hits = world.geometry.closest_hits(&rays, active);
        let found = world.geometry.surfaces(&rays, &hits, hits.mask);
        let paths = &mut self.paths;
        paths.position.set_group(group, &found.position);
        paths.error.set_group(group, &found.position_error);
        paths.normal.set_group(group, &found.normal);
        for lane in lanes(hits.mask.into()) {
            let at = |rows: &[[f64; LANES]; 3]| Vec3::new(rows[0][lane], rows[1][lane], rows[2][lane]);
            let surface = hits.surface[lane];
            let hit = Hit { t: hits.t[lane], surface, uv: [hits.uv[0][lane], hits.uv[1][lane]] };
            let point = SurfacePoint {
                position: at(&found.position),
                position_error: found.position_error[lane],
                normal: at(&found.normal),
                surface,
                label: found.label[lane],
                time: 0.0,
            };
            let (direction, surface) = (at(&rays.direction), world.surfaces.of(&point));
            match &mut paths.at[first + lane] {
                Some(there) => there.renew(direction, hit, point, surface),
                none => *none = Some(SurfaceInteraction::new(direction, hit, point, surface)),
            }
        }
        let escapes = active & !hits.mask;
        let mut looks = [Look::BLACK; LANES];
        let sky = if escapes.count_ones() >= FEWEST_LOOKS { world.first_image_of_the_sky() } else { None };
        if let Some(sky) = sky {
            look_at_sky(self.level, sky, &rays.direction, escapes, &mut looks);
        }
        let mut scatters = 0;
        for lane in lanes(active.into()) {
            scatters |= self.arrive_path(first + lane, hits.mask >> lane & 1 == 1, sky.map(|_| looks[lane % LANES]));
        }
        scatters
    }

    /// As above; but hits are only the first surfaces of groups that coincide.
    #[inline(always)]
    fn arrive_in_groups(&mut self, active: u8, group: usize) -> Mask {
        let first = group * LANES;
        let rays = self.paths.rays(group);
        // Those that go on along their rays have passed surfaces.
        let begin = lanes(active.into())
            .filter(|lane| self.paths.paths[first + lane].walk.begins())
            .fold(0, |mask, lane| mask | 1 << lane);
        let hits = self.world.geometry.closest_hits(&rays, begin);
        let mut scatters = 0;
        for lane in lanes(active.into()) {
            let known = (begin >> lane & 1 == 1).then(|| {
                let (t, surface, uv) = (hits.t[lane], hits.surface[lane], [hits.uv[0][lane], hits.uv[1][lane]]);
                (hits.mask >> lane & 1 == 1).then_some(Hit { t, surface, uv })
            });
            scatters |= self.arrive_alone(first + lane, known);
        }
        scatters
    }

    #[inline(always)]
    fn arrive_one_by_one(&mut self, active: u8, first: usize) -> Mask {
        lanes(Mask::from(active) << first).fold(0, |scatters, lane| scatters | self.arrive_alone(lane, None))
    }

    /// Lets a path arrive whose ray is cast alone, unless what it hits first is known.
    #[inline(always)]
    fn arrive_alone(&mut self, lane: usize, first: Option<Option<Hit<f64>>>) -> Mask {
        let (paths, world, counters) = (&mut self.paths, self.world, &mut self.counters);
        let ray = paths.ray(lane);
        let path = &mut paths.paths[lane];
        let (walk, stack) = (&mut path.walk, &mut path.stack);
        paths.at[lane] = match first {
            None => world.intersect(&ray, walk, stack, counters),
            Some(None) => None,
            Some(Some(first)) => world.intersect_group(&ray, first, walk, stack, counters),
        };
        if let Some(met) = &paths.at[lane] {
            paths.position.set(lane, met.point.position);
            paths.error.0[lane] = met.point.position_error;
            paths.normal.set(lane, met.point.normal);
        }
        let meets = paths.at[lane].is_some();
        self.arrive_path(lane, meets, None)
    }

    /// Lets a path arrive at what it has met, if it has met something. Its bit if it scatters. See [`Intersection::Nothing`] for `sky`.
    #[inline(always)]
    fn arrive_path(&mut self, lane: usize, meets: bool, sky: Option<Look>) -> Mask {
        let (paths, world) = (&mut self.paths, self.world);
        paths.ray_count[lane] += 1;
        let ray = paths.ray(lane);
        let (path, sampler) = (&mut paths.paths[lane], paths.samplers.lane(lane));
        let met = match &mut paths.at[lane] {
            Some(met) if meets => Intersection::Surface(met),
            _ => Intersection::Nothing(sky),
        };
        match path.arrive(world, &ray, met, sampler, &mut self.counters, &mut ()) {
            Arrival::Scatters => {
                if paths.shares {
                    paths.reuse_path[lane].arrive(world, vertex(&paths.at, lane), &mut path.radiance);
                }
                return 1 << lane;
            }
            Arrival::Passed => {}
            Arrival::Collides => {
                let before = self.counters.rays + self.counters.shadow_rays;
                let next = path.scatter_in_medium(world, sampler, &mut self.counters, &mut ());
                paths.ray_count[lane] += (self.counters.rays + self.counters.shadow_rays - before) as u32;
                paths.vertex[lane] = path.vertex;
                match next {
                    Some(ray) => paths.put_ray(lane, &ray),
                    None => paths.alive &= !(1 << lane),
                }
            }
            Arrival::Ended => paths.alive &= !(1 << lane),
            Arrival::Escaped => {
                if paths.shares {
                    paths.reuse_path[lane].escape(world, ray.direction);
                }
                paths.alive &= !(1 << lane);
            }
        }
        0
    }
}

/// The surfaces of the group that begins at `first`.
#[inline(always)]
pub(super) fn of_group(surfaces: &[SurfaceId; W], first: usize) -> [SurfaceId; LANES] {
    // Copied at once: the library's function of an array's index is not always made part of its caller.
    *surfaces[first..].first_chunk().expect("a group is of as many")
}
