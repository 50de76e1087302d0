//! Where paths arrive: the surfaces that they meet, and the light that they run into there or at infinity.

use super::Engine;
use super::rows::{GROUPS, Mask, W, group_of, lanes};
use super::tables::Form;
#[cfg(test)]
use super::tests::{Fault, is_wrong};
use crate::model::WavelengthModel;
use crate::path::{MOST_VERTICES, ShadowRays, Step};
use etalon_geometry::{LANES, Rays, SurfaceId};

impl<M: WavelengthModel<N>, const N: usize> Engine<'_, M, N> {
    /// Finds what each path meets, and tells which meet nothing.
    #[inline(always)]
    pub(super) fn meet(&mut self) -> Mask {
        let (paths, geometry) = (&mut self.paths, self.world.geometry);
        let count = u64::from(paths.alive.count_ones());
        self.counters.rays += count;
        self.counters.lane_weights += count * u64::from(M::CARRIES_WEIGHTS);
        let mut escaped = 0;
        for group in 0..GROUPS {
            let active = group_of(paths.alive, group);
            if active == 0 {
                continue;
            }
            let first = group * LANES;
            let rays = Rays {
                origin: paths.origin.group(group),
                direction: paths.direction.group(group),
                t_max: [f64::INFINITY; LANES],
                leaves: of_group(&paths.leaves, first),
                aims_at: [SurfaceId::NONE; LANES],
            };
            let hits = geometry.closest_hits(&rays, active);
            let found = geometry.surfaces(&rays, &hits, hits.mask);
            escaped |= Mask::from(active & !hits.mask) << first;
            let at = &mut paths.at;
            at.t.set_group(group, &hits.t);
            (0..2).for_each(|k| at.uv[k].set_group(group, &hits.uv[k]));
            at.position.set_group(group, &found.position);
            at.error.set_group(group, &found.position_error);
            at.normal.set_group(group, &found.normal);
            at.surface[first..][..LANES].copy_from_slice(&hits.surface);
            at.labels[first..][..LANES].copy_from_slice(&found.label);
        }
        escaped
    }

    /// Light from infinity; the paths end.
    #[inline(always)]
    pub(super) fn escape(&mut self, escaped: Mask) {
        let paths = &mut self.paths;
        let environments = self.world.environments;
        for lane in lanes(escaped) {
            if paths.shares && paths.gathered[lane].has_left() {
                paths.gathered[lane].escape(paths.direction.at(lane), self.world.plain_skies);
            }
            for (index, sky) in environments.iter().enumerate() {
                self.counters.environment_lookups += 1;
                let direction = paths.direction.at(lane);
                // No shadow ray could have found a sky that is no light.
                let mis = if self.world.weigh_hits && sky.light.is_some() {
                    self.world.weight_of_hit(paths.step(lane), SurfaceId::NONE, sky.light, direction, 0.0)
                } else {
                    1.0
                };
                let lambda_nm = &paths.wavelengths[lane].lambda_nm;
                let radiance = match self.tables.environments[index] {
                    Some(slot) => paths.known.spectrum(lane, slot, self.tables, &paths.wavelengths[lane]),
                    None => sky.radiance.lanes(lambda_nm, direction),
                };
                let light = paths.beta[lane] * radiance * (paths.model[lane].weight() * mis);
                paths.radiance[lane] += light;
            }
        }
        paths.alive &= !escaped;
    }

    /// Light from the surfaces that paths have met. Tells which paths go on, and which of those send shadow rays.
    #[inline(always)]
    pub(super) fn arrive(&mut self, met: Mask) -> (Mask, Mask) {
        let (paths, world) = (&mut self.paths, self.world);
        let (mut scatters, mut shared) = (0, 0);
        for lane in lanes(met) {
            let surface_id = paths.at.surface[lane];
            let object = world.surfaces.object_of[paths.at.labels[lane] as usize][surface_id.primitive.0 as usize];
            let record = &self.tables.objects[object as usize];
            if record.emits {
                let point = paths.at.point(lane);
                let surface = world.surfaces.of(&point);
                let direction = paths.direction.at(lane);
                if let Some(emitter) = surface.emission_along(world.geometry, &point, &paths.at.hit(lane), -direction) {
                    let mis = if world.weigh_hits {
                        world.weight_of_hit(paths.step(lane), point.surface, surface.light, direction, 0.0)
                    } else {
                        1.0
                    };
                    let lambda_nm = &paths.wavelengths[lane].lambda_nm;
                    let white =
                        paths.known.of(lane, record.emission, emitter.radiance, self.tables, &paths.wavelengths[lane]);
                    let emitted = emitter.of_white(white, lambda_nm);
                    let light = paths.beta[lane] * emitted * (paths.model[lane].weight() * mis);
                    paths.radiance[lane] += light;
                }
            }
            if paths.shares && paths.gathered[lane].has_left() {
                let (point, wo) = (paths.at.point(lane), -paths.direction.at(lane));
                paths.gathered[lane].arrive(&point, wo, record.diffuse, &mut paths.radiance[lane]);
            }
            let vertex = paths.vertex[lane];
            if vertex + 1 >= world.max_depth || vertex + 1 == MOST_VERTICES {
                if vertex + 1 == MOST_VERTICES {
                    self.counters.record_cut(paths.beta[lane].max_lane() * paths.model[lane].weight());
                }
                paths.alive &= !(1 << lane);
                continue;
            }
            scatters |= 1 << lane;
            let useful = match world.shadow_rays {
                ShadowRays::Never => false,
                ShadowRays::WhereUseful => record.solid_angle_part,
                ShadowRays::Everywhere => true,
            };
            shared |= Mask::from(useful) << lane;
            paths.at.form[lane] = record.form;
            paths.at.object[lane] = object;
            if record.form == Form::Other {
                let point = paths.at.point(lane);
                let surface = world.surfaces.of(&point);
                let hit = paths.at.hit(lane);
                paths.at.scattering[lane] = Some(surface.scattering(world.geometry, &point, &hit, None));
            }
        }
        #[cfg(test)]
        if is_wrong(Fault::LostShadowRay) {
            shared &= !0b100;
        }
        (scatters, shared)
    }
}

/// The surfaces of the group that begins at `first`.
#[inline(always)]
pub(super) fn of_group(surfaces: &[SurfaceId; W], first: usize) -> [SurfaceId; LANES] {
    // Copied at once: the library's function of an array's index is not always made part of its caller.
    *surfaces[first..].first_chunk().expect("a group is of as many")
}

impl<M, const N: usize> super::Paths<'_, M, N> {
    /// The last step of a path.
    #[inline(always)]
    fn step(&self, lane: usize) -> Step {
        match self.shared >> lane & 1 {
            0 => Step::Unshared,
            _ => Step::Shared { from: self.from.at(lane), leaves: self.leaves[lane], density: self.density.0[lane] },
        }
    }
}
