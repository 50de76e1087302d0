//! The path loop: the rendering equation, one path at a time.
//!
//! L(x, ω) = Le(x, ω) + ∫ f(x, ω, ω′) L(x′, −ω′) |cos θ′| dω′ is estimated along one random walk from the camera. At each
//! vertex the light that arrives from the lights themselves is found in two ways, by a shadow ray toward a light and by
//! the walk's own next step, combined by multiple importance sampling (Veach 1997).
//!
//! **Wavelengths.** All lanes follow the path that the hero drew. `beta` is f/p along it with the hero's p, and `lanes`
//! ([`WavelengthModel`]) knows each lane's own density of the same path relative to the hero's, where they can differ. The
//! balance heuristic over the lanes that could have been hero (Wilkie et al. 2014, eq. 5) then weighs lane j by
//! N·beta_j / Σ densities: plain `beta` as long as all lanes sample alike, N·beta_hero once dispersion has left the hero
//! alone.
//!
//! **Wavelengths and MIS.** Where the lanes' densities of a direction differ, the weights of shadow rays and of the walk
//! must not depend on which lane is the hero, or the two no longer add up to one for the lanes together. So what meets a
//! light's density is the mean of the lanes' own densities, each weighed by its share of the path so far.

mod direct;

use crate::absorption::{Absorption, Body};
use crate::bsdf::Lobe;
use crate::caustics::Casters;
use crate::engine::Tables;
use crate::film::Counters;
use crate::interaction::{SurfaceInteraction, Walk};
use crate::light::{Environment, LightTable};
use crate::media::{Inside, Media};
use crate::mis::{Density, power_heuristic};
use crate::model::WavelengthModel;
use crate::observer::{End, Found, Observer};
use crate::polarisation::Polarisation;
use crate::sampler::Sampler;
use crate::surface::Surfaces;
use direct::{Around, Direct};
use etalon_geometry::{Geometry, Ray, SurfaceId};
use etalon_optics::{Lanes, Vec3};
use etalon_scene::LightSampling;

/// Below this throughput a path is ended even without roulette: no film value could change (hard case 30).
pub(crate) const THROUGHPUT_FLOOR: f64 = 1e-30;
/// Vertices after which any path is cut, so that a room without absorption ends; such paths are counted and reported.
pub(crate) const MOST_VERTICES: u32 = 1 << 16;
/// Vertices before Russian roulette begins.
pub(crate) const ROULETTE_FROM_VERTEX: u32 = 2;
/// The throughput that a path keeps which roulette lets live. Less is more vertices with less noise; of 1, 1/2, 1/3, 1/4 and 1/8
/// this takes the least time to a given error in rooms of white walls and under the sky (docs/performance.md).
pub(crate) const ROULETTE_THROUGHPUT: f64 = 0.4;

/// All that a path meets.
pub(crate) struct World<'a> {
    pub geometry: &'a Geometry,
    pub surfaces: &'a Surfaces,
    pub lights: &'a LightTable,
    pub environments: &'a [Environment],
    /// The media, if the scene's solids are nested.
    pub media: Option<&'a Media>,
    /// Absorption in media, if there is any.
    pub absorption: Option<Absorption>,
    pub light_sampling: LightSampling,
    pub shadow_rays: ShadowRays,
    /// Whether some surface lets a part of the light pass as if it were not there.
    pub masks: bool,
    /// Whether light that the walk runs into may have been found by a shadow ray too.
    pub weigh_hits: bool,
    /// Most path edges from the camera to a light, at most [`MOST_VERTICES`].
    pub max_depth: u32,
    pub roulette: bool,
    /// What objects do, by heart.
    pub tables: &'a Tables,
    /// Whether no shadow ray aims at any of the skies.
    pub plain_skies: bool,
    /// What diffuse surfaces draw directions toward.
    pub casters: &'a Casters,
}

/// From which surfaces shadow rays are sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ShadowRays {
    Never,
    /// From those that can scatter what arrives from a given direction.
    WhereUseful,
    /// From every surface, although some can make nothing of it: for the study of what that costs.
    Everywhere,
}

/// The last step of the walk, as far as MIS needs it.
#[derive(Clone, Copy)]
pub(crate) enum Step {
    /// From the camera or by a delta: no shadow ray could have found what it finds.
    Unshared,
    /// Drawn with this density, the mean over the lanes, from this point of this primitive, where a shadow ray was sent too.
    Shared { from: Vec3<f64>, leaves: SurfaceId, density: f64 },
}

impl World<'_> {
    /// Radiance that arrives along `ray` at each wavelength.
    #[allow(clippy::too_many_arguments, reason = "what a path starts with, draws from, and tells")]
    pub(crate) fn radiance<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
        &self,
        mut ray: Ray<f64>,
        mut inside: Inside,
        polarisation: &mut P,
        lambda_nm: &Lanes<f64, N>,
        sampler: &Sampler,
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) -> Lanes<f64, N> {
        let mut radiance = Lanes::ZERO;
        let mut beta = Lanes::<f64, N>::ONE;
        let mut lanes = M::start();
        // ∏ η²: the part of beta that comes back when the path leaves the medium, which roulette must not count.
        let mut eta_squared = 1.0;
        // What a direction drawn toward a caster took from beta since the last diffuse surface, which roulette must not count either.
        let mut aim_factor = 1.0;
        let mut step = Step::Unshared;
        let mut body = match self.absorption {
            Some(_) => Body::around(self.geometry, self.surfaces, &ray),
            None => Body::default(),
        };
        let mut walk = Walk::default();
        // Surfaces passed as if they were not there, which are no vertices of the path, and where the last one was.
        let mut passes = 0;
        let mut start = ray.origin;
        // The number that decides whether the next surface is passed.
        let mut u_mask = None;
        let mut vertex = 0;

        loop {
            let lane_weight = lanes.weight();
            counters.lane_weights += u64::from(M::CARRIES_WEIGHTS);
            counters.rays += 1;
            let Some(met) = self.meet(&ray, &mut walk, &mut inside, counters) else {
                if let Some(absorption) = &self.absorption {
                    beta *= absorption.transmittance(body, self.media, &inside, lambda_nm, f64::INFINITY);
                }
                if let Some(gathered) = observer.gathers().filter(|gathered| gathered.has_left()) {
                    gathered.escape(ray.direction, self.plain_skies);
                }
                let environments = self.environments;
                for sky in environments {
                    counters.environment_lookups += 1;
                    let mis = if self.weigh_hits {
                        self.weight_of_hit(step, SurfaceId::NONE, sky.light, ray.direction, ray.time)
                    } else {
                        1.0
                    };
                    let radiance_of_sky = sky.radiance.lanes(lambda_nm, ray.direction);
                    let light = polarisation.receive(beta * radiance_of_sky * (lane_weight * mis));
                    observer.light(vertex, Found::Environment, light);
                    radiance += light;
                }
                observer.end(End::Escaped);
                break;
            };
            let SurfaceInteraction { hit, point, surface, interface, .. } = &met;
            let wo = -ray.direction;
            let from_front = point.normal.dot(wo) > 0.0;
            if let Some(absorption) = &self.absorption {
                body = body.before(surface, from_front);
                let length = (point.position - start).length();
                beta *= absorption.transmittance(body, self.media, &inside, lambda_nm, length);
            }
            observer.vertex(vertex, point.position, surface.object, beta);

            if let Some(emitter) = surface.emission_along(self.geometry, point, hit, wo) {
                let mis = if self.weigh_hits {
                    self.weight_of_hit(step, point.surface, surface.light, ray.direction, ray.time)
                } else {
                    1.0
                };
                let light = polarisation.receive(beta * emitter.lanes(lambda_nm) * (lane_weight * mis));
                observer.light(vertex, Found::Emitter, light);
                radiance += light;
            }
            if let Some(gathered) = observer.gathers().filter(|gathered| gathered.has_left()) {
                gathered.arrive(point, wo, self.tables.is_diffuse(surface.object), &mut radiance);
            }
            let opacity = if self.masks { surface.opacity(self.geometry, point, hit) } else { 1.0 };
            if opacity < 1.0 && passes < MOST_VERTICES {
                let u = u_mask.unwrap_or_else(|| sampler.vertex_set(vertex, 1)[3]);
                if u >= opacity {
                    // The last step goes on, and with it what MIS knows of it: the shadow ray passed here too. What is left of
                    // the number is uniform again.
                    u_mask = Some((u - opacity) / (1.0 - opacity));
                    passes += 1;
                    start = point.position;
                    walk.pass(&met);
                    if let Some(beyond) = met.beyond {
                        inside = beyond;
                    }
                    continue;
                }
            }
            if vertex + 1 >= self.max_depth || vertex + 1 == MOST_VERTICES {
                if vertex + 1 == MOST_VERTICES {
                    counters.record_cut(beta.max_lane() * lane_weight);
                }
                observer.end(End::Depth);
                break;
            }

            let scattering = surface.scattering(self.geometry, point, hit, *interface);
            let shared = match self.shadow_rays {
                ShadowRays::Never => false,
                ShadowRays::WhereUseful => surface.bsdf.has_solid_angle_part(),
                ShadowRays::Everywhere => true,
            };
            if shared {
                let u = sampler.vertex_set(vertex, 1);
                let around = Around { inside: &inside, body, beyond: body.beyond(surface, from_front) };
                if let Some(Direct { light: index, wi, radiance: direct }) =
                    self.direct_light(point, &scattering, wo, (lambda_nm, &lanes), u, &around, counters)
                {
                    let mueller = || scattering.mueller(lambda_nm, wo, wi, Lobe::SolidAngle);
                    let light = polarisation.receive_scattered(wo, wi, mueller, beta * direct * lane_weight);
                    observer.light(vertex, Found::ShadowRay { light: index }, light);
                    radiance += light;
                }
            }

            let [u_lobe, u1, u2, u_roulette] = sampler.vertex_set(vertex, 0);
            let Some((next, mixture)) = self.casters.sample(point, &scattering, lambda_nm, wo, [u_lobe, u1, u2]) else {
                observer.end(End::Absorbed);
                break;
            };
            beta *= next.weight;
            let (unaimed, aim) = (beta, mixture.factor(1.0));
            beta *= aim;
            observer.direction(&mixture);
            if let Density::SolidAngle(_) = next.density {
                aim_factor = mixture.aim_factor();
            }
            let lobe = match next.density {
                Density::Delta => Lobe::Delta(u_lobe),
                Density::SolidAngle(_) => Lobe::SolidAngle,
            };
            polarisation.follow(wo, next.wi, || scattering.mueller(lambda_nm, wo, next.wi, lobe));
            let mean_of_hero = lanes.follow(next.lane_density);
            eta_squared *= next.eta * next.eta;
            step = match next.density {
                Density::SolidAngle(density) if shared => {
                    let density = density * mean_of_hero;
                    Step::Shared { from: point.position, leaves: point.surface, density }
                }
                Density::SolidAngle(_) | Density::Delta => Step::Unshared,
            };
            ray = point.spawn(next.wi);
            walk.restart();
            (start, u_mask) = (ray.origin, None);
            let goes_through = point.normal.dot(next.wi) * point.normal.dot(wo) < 0.0;
            if goes_through {
                body = body.beyond(surface, from_front);
            }
            if let Some(beyond) = met.beyond.filter(|_| goes_through) {
                inside = beyond;
            }

            if !beta.is_finite() {
                // Shown to the film, which counts and locates it.
                observer.end(End::NonFinite);
                return beta;
            }
            if !matches!(next.density, Density::Delta)
                && let Some(gathered) = observer.gathers().filter(|gathered| gathered.begins())
            {
                let diffuse = self.tables.is_diffuse(surface.object) && lanes.together();
                gathered.leave(
                    vertex,
                    point,
                    wo,
                    diffuse,
                    (&unaimed, aim),
                    (&mut radiance, &mut beta, &mut eta_squared),
                );
            }
            let throughput = (beta.max_lane() * lanes.weight()) * eta_squared;
            if throughput < THROUGHPUT_FLOOR {
                observer.end(End::Vanished);
                break;
            }
            if self.roulette && vertex + 1 >= ROULETTE_FROM_VERTEX {
                // No cap below one: it would make the variance infinite between good mirrors (hard case 29).
                let survival = (throughput / (aim_factor * ROULETTE_THROUGHPUT)).min(1.0);
                if u_roulette >= survival {
                    observer.end(End::Roulette);
                    break;
                }
                beta /= survival;
            }
            vertex += 1;
        }
        radiance
    }

    /// The MIS weight of light that the walk ran into `on` a surface whose light, if any, is number `light`.
    pub(crate) fn weight_of_hit(&self, step: Step, on: SurfaceId, light: Option<u32>, wi: Vec3<f64>, time: f64) -> f64 {
        match (step, light) {
            (Step::Unshared, _) | (_, None) => 1.0,
            // The far side of the sphere that it left: see `direct_light`.
            (Step::Shared { leaves, .. }, _) if leaves == on => 1.0,
            (Step::Shared { from, density, .. }, Some(light)) => {
                let light = light as usize;
                let of_direction = self.lights.lights()[light].density(from, wi, time);
                match self.light_sampling {
                    // No shadow ray could have found it.
                    _ if of_direction == 0.0 => 1.0,
                    LightSampling::Light => 0.0,
                    LightSampling::Bsdf => 1.0,
                    LightSampling::Mis => power_heuristic(density, self.lights.probability(light, from) * of_direction),
                }
            }
        }
    }
}
