//! The light that arrives at a vertex from the lights themselves: one shadow ray.

use super::{MOST_VERTICES, World};
use crate::absorption::Body;
use crate::film::Counters;
use crate::interaction::Walk;
use crate::light::{LightSample, Target};
use crate::media::Inside;
use crate::mis::{Density, power_heuristic};
use crate::model::WavelengthModel;
use crate::surface::Scattering;
use etalon_geometry::{Ray, SurfacePoint};
use etalon_optics::{Lanes, Vec3};
use etalon_scene::LightSampling;

/// What surrounds a point of a surface.
pub(super) struct Around<'a> {
    pub inside: &'a Inside,
    /// On the side of the viewer.
    pub body: Body<'a>,
    /// On the other side.
    pub beyond: Body<'a>,
}

/// What one shadow ray found.
pub(super) struct Direct<const N: usize> {
    /// Number of the light.
    pub light: u32,
    /// Direction toward it.
    pub wi: Vec3<f64>,
    /// Radiance that it adds along the path, for light that is unpolarised.
    pub radiance: Lanes<f64, N>,
}

impl World<'_> {
    /// One shadow ray: ∫ f Le |cos θ| dω over the lights, estimated by one direction toward one of them.
    #[allow(clippy::too_many_arguments, reason = "the arguments of the rendering equation, and what counts them")]
    pub(super) fn direct_light<M: WavelengthModel<N>, const N: usize>(
        &self,
        point: &SurfacePoint<f64>,
        scattering: &Scattering<'_>,
        wo: Vec3<f64>,
        (lambda_nm, lanes): (&Lanes<f64, N>, &M),
        [u_light, u1, u2, _]: [f64; 4],
        around: &Around<'_>,
        counters: &mut Counters,
    ) -> Option<Direct<N>> {
        if self.lights.is_empty() {
            return None;
        }
        let (index, probability) = self.lights.choose(point.position, u_light)?;
        let light = &self.lights.lights()[index];
        let sample = light.sample(point.position, [u1, u2], point.time)?;
        if sample.surface == point.surface {
            // A surface is no target for its own points: rounding decides on which side of a sphere they lie, and the
            // BSDF's directions find the sphere's inside at least as well.
            return None;
        }
        let (f_cos, densities) = scattering.eval(lambda_nm, wo, sample.wi);
        if f_cos.is_zero() {
            return None;
        }
        let shadow_ray = match sample.target {
            Target::Point(target) => point.spawn_to(target, sample.surface),
            Target::Infinity => point.spawn(sample.wi),
        };
        counters.shadow_rays += 1;
        let goes_through = point.normal.dot(sample.wi) * point.normal.dot(wo) < 0.0;
        let body = if goes_through { around.beyond } else { around.body };
        let mut transmittance = Lanes::ONE;
        let arriving = if self.masks || self.media.is_some() {
            self.passing(shadow_ray, (*around.inside, body), &sample, lambda_nm, &mut transmittance, counters)
        } else {
            if let Some(absorption) = &self.absorption {
                let length = sample.target.distance(point.position);
                transmittance = absorption.transmittance(body, self.media, around.inside, lambda_nm, length);
            }
            if self.geometry.occluded(&shadow_ray) { 0.0 } else { 1.0 }
        };
        if arriving == 0.0 {
            return None;
        }
        let weight = match sample.density {
            Density::Delta => sample.scale / probability,
            Density::SolidAngle(density) => {
                let density = density * probability;
                let mis = match self.light_sampling {
                    LightSampling::Light => 1.0,
                    LightSampling::Bsdf => 0.0,
                    LightSampling::Mis => power_heuristic(density, lanes.mean_density(densities)),
                };
                mis * (sample.scale / density)
            }
        };
        let shines = self.light_arriving(index, sample.wi, sample.target, point.time, lambda_nm);
        let direct = f_cos * shines * (weight * arriving);
        Some(Direct { light: index as u32, wi: sample.wi, radiance: direct * transmittance })
    }

    /// What a light sends along `wi` from the point that a shadow ray aims at, but for the scale of its sample.
    #[inline]
    pub(crate) fn light_arriving<const N: usize>(
        &self,
        light: usize,
        wi: Vec3<f64>,
        target: Target,
        time: f64,
        lambda_nm: &Lanes<f64, N>,
    ) -> Lanes<f64, N> {
        let light = &self.lights.lights()[light];
        if let (Some(emitter), Target::Point(position)) = (light.emitter(), target)
            && let Some(image) = emitter.image
            && let Some(emitted) = self.surfaces.emitted(image.object, self.geometry, (emitter.surface, position), time)
        {
            return emitted.lanes(lambda_nm);
        }
        light.lanes(lambda_nm, wi)
    }

    /// The share of light from a sampled light that reaches the start of the shadow ray: masks let their part through, media
    /// what they do not absorb, and boundaries of solids all, where they change no medium.
    fn passing<const N: usize>(
        &self,
        shadow_ray: Ray<f64>,
        (mut inside, body): (Inside, Body<'_>),
        sample: &LightSample,
        lambda_nm: &Lanes<f64, N>,
        transmittance: &mut Lanes<f64, N>,
        counters: &mut Counters,
    ) -> f64 {
        let ray = Ray { t_max: beyond_target(shadow_ray.t_max), ..shadow_ray };
        if self.media.is_none() && self.absorption.is_none() {
            return self.passing_masks(&ray, shadow_ray.t_max, counters);
        }
        let (mut walk, mut share, mut start) = (Walk::default(), 1.0, ray.origin);
        let mut absorb = |inside: &Inside, length: f64| {
            if let Some(absorption) = &self.absorption {
                *transmittance *= absorption.transmittance(body, self.media, inside, lambda_nm, length);
            }
        };
        for _ in 0..MOST_VERTICES {
            let Some(met) = self.meet(&ray, &mut walk, &mut inside, counters) else {
                absorb(&inside, sample.target.distance(start));
                return share;
            };
            absorb(&inside, (met.point.position - start).length());
            let opacity = met.surface.opacity(self.geometry, &met.point, &met.hit);
            if met.point.surface == ray.aims_at || met.hit.t >= shadow_ray.t_max && opacity == 1.0 {
                return share;
            }
            share *= 1.0 - opacity;
            if share == 0.0 {
                return 0.0;
            }
            start = met.point.position;
            walk.pass(&met);
            inside = met.beyond.unwrap_or(inside);
        }
        counters.record_cut(f64::MAX);
        0.0
    }

    /// [`World::passing`] where masks are all that a shadow ray may pass: in any order.
    fn passing_masks(&self, ray: &Ray<f64>, arrives: f64, counters: &mut Counters) -> f64 {
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
fn beyond_target(t_max: f64) -> f64 {
    if t_max < 1.0 { 1.0 + 16.0 * (1.0 - t_max) } else { t_max }
}
