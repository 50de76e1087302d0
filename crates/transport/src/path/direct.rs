//! The light that arrives at a vertex from the lights themselves: one shadow ray.

use super::{MOST_VERTICES, World};
use crate::absorption::Body;
use crate::compiled;
use crate::film::Counters;
use crate::light::{LightSample, Target};
use crate::media::Inside;
use crate::mis::{Density, power_heuristic};
use crate::model::WavelengthModel;
use crate::surface::Scattering;
use etalon_geometry::{Ray, SurfacePoint};
use etalon_optics::{Lanes, Real, Vec3};
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
pub(super) struct Direct<R, const N: usize> {
    /// Number of the light.
    pub light: u32,
    /// Direction toward it.
    pub wi: Vec3<f64>,
    /// Radiance that it adds along the path, for light that is unpolarised.
    pub radiance: Lanes<R, N>,
}

impl World<'_> {
    /// One shadow ray: ∫ f Le |cos θ| dω over the lights, estimated by one direction toward one of them.
    #[allow(clippy::too_many_arguments, reason = "the arguments of the rendering equation, and what counts them")]
    pub(super) fn direct_light<R: Real, M: WavelengthModel<R, N>, const N: usize>(
        &self,
        point: &SurfacePoint<f64>,
        scattering: &Scattering<'_>,
        wo: Vec3<f64>,
        (lambda_nm, lanes): (&Lanes<f64, N>, &M),
        [u_light, u1, u2, _]: [f64; 4],
        around: &Around<'_>,
        counters: &mut Counters,
    ) -> Option<Direct<R, N>> {
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
        let arriving = if compiled::MASKS && self.masks {
            self.passing(shadow_ray, (*around.inside, body), &sample, lambda_nm, &mut transmittance, counters)
        } else {
            if let Some(absorption) = &self.absorption {
                let length = sample.target.distance(point.position);
                transmittance = absorption.transmittance(body, self.media, around.inside, lambda_nm, length);
            }
            let occluded = match self.media {
                Some(media) if compiled::NESTED_DIELECTRICS => {
                    media.occluded(self.geometry, self.surfaces, shadow_ray, *around.inside, &mut counters.lost_media)
                }
                _ => self.geometry.occluded(&shadow_ray),
            };
            if occluded { 0.0 } else { 1.0 }
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
        let direct = f_cos * shines * R::from_f64(weight * arriving);
        Some(Direct { light: index as u32, wi: sample.wi, radiance: direct * transmittance })
    }

    /// What a light sends along `wi` from the point that a shadow ray aims at, but for the scale of its sample.
    #[inline]
    pub(crate) fn light_arriving<R: Real, const N: usize>(
        &self,
        light: usize,
        wi: Vec3<f64>,
        target: Target,
        time: f64,
        lambda_nm: &Lanes<f64, N>,
    ) -> Lanes<R, N> {
        let light = &self.lights.lights()[light];
        if compiled::TEXTURES
            && let (Some(emitter), Target::Point(position)) = (light.emitter(), target)
            && let Some(image) = emitter.image
            && let Some(emitted) = self.surfaces.emitted(image.object, self.geometry, (emitter.surface, position), time)
        {
            return emitted.lanes(lambda_nm);
        }
        light.lanes(lambda_nm, wi)
    }

    /// The share of light from a sampled light that reaches the start of the shadow ray: masks let their part through, and
    /// media what they do not absorb.
    fn passing<R: Real, const N: usize>(
        &self,
        mut shadow_ray: Ray<f64>,
        (mut inside, body): (Inside, Body<'_>),
        sample: &LightSample,
        lambda_nm: &Lanes<f64, N>,
        transmittance: &mut Lanes<R, N>,
        counters: &mut Counters,
    ) -> f64 {
        let mut share = 1.0;
        let mut absorb = |inside: &Inside, length: f64| {
            if let Some(absorption) = &self.absorption {
                *transmittance *= absorption.transmittance(body, self.media, inside, lambda_nm, length);
            }
        };
        for _ in 0..MOST_VERTICES {
            let start = shadow_ray.origin;
            let Some(met) = self.meet(&mut shadow_ray, &mut inside, counters) else {
                absorb(&inside, sample.target.distance(start));
                return share;
            };
            absorb(&inside, (met.point.position - start).length());
            let aims_at = shadow_ray.aims_at;
            if self.media.is_some() && met.point.surface == aims_at {
                return share;
            }
            share *= 1.0 - met.surface.opacity(self.geometry, &met.point, &met.hit);
            if share == 0.0 {
                return 0.0;
            }
            shadow_ray = match sample.target {
                Target::Point(target) => met.point.spawn_to(target, sample.surface),
                Target::Infinity => met.point.spawn(shadow_ray.direction),
            };
            if let Some(beyond) = met.beyond {
                shadow_ray.leaves = beyond.leaves;
                inside = beyond.inside;
            }
        }
        counters.record_cut(f64::MAX);
        0.0
    }
}
