//! Camera paths: where the samples of pixels begin.

use crate::camera::{Camera, CameraRay};
use crate::film::{Counters, PixelRect};
use crate::integrator::observer::{End, Observer};
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::integrator::{MOST_VERTICES, Path, Start, trace};
use crate::light::Light;
use crate::media::MediumStack;
use crate::plan::EffectName;
use crate::polarisation::Polarisation;
use crate::sampler::{Sampler, film_and_lens, wavelength_and_time};
use crate::scene::interaction::{SurfaceInteraction, Walk};
use crate::scene::prepare::Prepared;
use crate::scene::receiver::Departure;
use crate::scene::world::{ShadowRays, World};
use crate::surface::Scattering;
use etalon_optics::{Frame, Vec3, reference_nm};
use std::ops::Range;

/// Some samples of one pixel.
#[derive(Clone, Debug)]
pub struct PixelSamples {
    /// Column.
    pub x: u32,
    /// Row.
    pub y: u32,
    /// Their numbers.
    pub samples: Range<u32>,
}

impl PixelSamples {
    /// The same samples of each pixel of a tile.
    pub(crate) fn of_tile(tile: PixelRect, samples: &Range<u32>) -> Vec<Self> {
        tile.pixels().map(|(x, y)| Self { x, y, samples: samples.clone() }).collect()
    }

    /// How many.
    pub fn count(&self) -> u32 {
        self.samples.end.saturating_sub(self.samples.start)
    }
}

/// What a camera ray meets first.
pub(crate) struct FirstSurface<'a> {
    /// Number of the object.
    pub object: u32,
    /// In the frame.
    pub position: Vec3<f64>,
    /// Toward the camera.
    pub wo: Vec3<f64>,
    /// Cosine between that and the surface's own normal: negative from behind.
    pub geometric_cos: f64,
    pub scattering: Scattering<'a>,
    /// The numbers by which the path draws its next direction.
    pub u: [f64; 3],
}

impl Prepared {
    /// The numbers of a sample by random numbers of a seed.
    fn sampler(&self, seed: u64, x: u32, y: u32, sample: u32) -> Sampler {
        let integrator = &self.scene.integrator;
        let pixel = u64::from(y) << 32 | u64::from(x);
        Sampler::new(integrator.sampler, seed, pixel, sample, integrator.replicates)
    }

    /// What a sample of the picture counts for in its pixel, if the filter is negative somewhere.
    #[inline(always)]
    pub(crate) fn filter_weight(&self, x: u32, y: u32, sample: u32) -> Option<f64> {
        self.filter.has_weights().then(|| {
            let (on_film, _) = film_and_lens(self.sampler(self.scene.integrator.seed, x, y, sample).set(0));
            let film = &self.scene.film;
            let weight = |pixel: u32, size: u32, u: f64| match film.sample_border {
                true => self.filter.weight(u),
                false => self.filter.weight_on_film(u, f64::from(pixel) + 0.5, f64::from(size)),
            };
            weight(x, film.width, on_film[0]) * weight(y, film.height, on_film[1])
        })
    }
}

/// One scene.
pub(crate) struct Tracer<'a> {
    pub(crate) prepared: &'a Prepared,
    pub(crate) camera: Camera,
    pub(crate) world: World<'a>,
    /// Of the random numbers. A trial has another than the scene.
    pub(crate) seed: u64,
    /// The block of pixels that share paths: alone, one.
    block: [u32; 2],
}

impl<'a> Tracer<'a> {
    pub(crate) fn new(prepared: &'a Prepared) -> Self {
        let integrator = &prepared.scene.integrator;
        let plan = prepared.plan();
        // Forced on a scene without solids, they are nothing to walk through.
        let media = prepared.media.as_ref().filter(|media| media.solids.iter().any(Option::is_some));
        // A meter's plate is a vertex that the limit on depth does not count.
        let of_receiver = u32::from(!prepared.receivers.is_empty());
        let max_depth = integrator.max_depth.map_or(MOST_VERTICES, |depth| depth.saturating_add(of_receiver));
        let masks = plan.runs(EffectName::Masks) || prepared.has_boundaries || integrator.hide_lights;
        Self {
            prepared,
            seed: integrator.seed,
            camera: prepared.tracing_camera(),
            block: prepared.path_reuse().unwrap_or([1, 1]),
            world: World {
                geometry: &prepared.geometry,
                surfaces: &prepared.surfaces,
                lights: &prepared.lights,
                environments: &prepared.environments,
                media,
                participating: prepared.participating(),
                light_sampling: integrator.light_sampling,
                shadow_rays: prepared.shadow_rays(),
                masks,
                meets_groups: masks || media.is_some(),
                moves: plan.runs(EffectName::Motion),
                lights_parts: prepared.shadow_rays() != ShadowRays::Never
                    && prepared.lights.lights().iter().any(Light::lights_parts),
                weigh_hits: prepared.lights.can_be_met() || plan.runs(EffectName::Mis),
                max_depth: max_depth.min(MOST_VERTICES),
                hides_lights: integrator.hide_lights,
                counts_panes: integrator.count_panes || integrator.max_depth.is_none(),
                roulette: integrator.roulette,
                fluoresces: plan.runs(EffectName::Fluorescence),
                tables: &prepared.tables,
                plain_skies: prepared.environments.iter().all(|sky| sky.light.is_none()),
                refracting_bodies: prepared.refracting_bodies.as_ref().filter(|_| prepared.refracts_shadow_rays()),
                specular_connections: prepared.specular_connections.as_ref(),
                panes: prepared.panes.as_ref(),
                specular_objects: prepared.specular_objects.as_ref(),
                guided_targets: &prepared.guided_targets,
            },
        }
    }

    pub(crate) fn sampler(&self, x: u32, y: u32, sample: u32) -> Sampler {
        self.prepared.sampler(self.seed, x, y, sample)
    }

    /// The sampler of what the pixels of a block have in common.
    #[inline]
    pub(crate) fn of_block(&self, x: u32, y: u32, sample: u32) -> Sampler {
        let [width, height] = self.block;
        self.sampler(x / width * width, y / height * height, sample)
    }

    /// The point of the film, in [−1, 1]², that two numbers draw for a pixel.
    #[inline]
    pub(crate) fn film_point(&self, x: u32, y: u32, u: [f64; 2]) -> [f64; 2] {
        let film = &self.prepared.scene.film;
        let (width, height) = (f64::from(film.width), f64::from(film.height));
        let filter = &self.prepared.filter;
        let place = |centre: f64, size: f64, u: f64| {
            centre + if film.sample_border { filter.offset(u) } else { filter.offset_on_film(u, centre, size) }
        };
        let column = place(f64::from(x) + 0.5, width, u[0]);
        let row = place(f64::from(y) + 0.5, height, u[1]);
        [2.0 * column / width - 1.0, 1.0 - 2.0 * row / height]
    }

    /// The ray of a sample at a wavelength, if the lens lets it pass.
    fn camera_ray(
        &self,
        x: u32,
        y: u32,
        sampler: &Sampler,
        wavelength_nm: f64,
        counters: &mut Counters,
    ) -> Option<CameraRay> {
        let (on_film, on_lens) = film_and_lens(sampler.set(0));
        let film = self.film_point(x, y, on_film);
        counters.lens_draws += u64::from(self.camera.has_lens());
        let time = self.time(sampler, counters);
        self.camera.ray_of(film, on_lens, time, wavelength_nm)
    }

    /// The first surface that the path of a sample meets, masks passed as the path passes them.
    pub(crate) fn first_surface(
        &self,
        x: u32,
        y: u32,
        sample: u32,
        counters: &mut Counters,
    ) -> Option<FirstSurface<'_>> {
        let sampler = self.sampler(x, y, sample);
        let middle_nm = reference_nm(self.prepared.scene.integrator.wavelength_range_nm);
        let ray = self.camera_ray(x, y, &sampler, middle_nm, counters)?.ray;
        let mut stack = self.world.media_around(&ray, counters).unwrap_or(MediumStack::NOTHING);
        let mut walk = Walk::default();
        let [.., mut u_mask] = sampler.vertex_set(0, 1);
        for _ in 0..MOST_VERTICES {
            let met = self.world.intersect(&ray, &mut walk, &mut stack, counters)?;
            let (hit, point, surface) = (&met.hit, &met.point, &met.surface);
            let is_hidden = self.world.hides_lights && met.surface.shines();
            let opacity = if is_hidden { 0.0 } else { met.share_that_stops(&self.world) };
            if u_mask >= opacity {
                u_mask = (u_mask - opacity) / (1.0 - opacity);
                walk.pass(&met, &mut stack);
                continue;
            }
            let [u_lobe, u1, u2, _] = sampler.vertex_set(0, 0);
            let wo = met.wo;
            return Some(FirstSurface {
                object: surface.object,
                position: point.position,
                wo,
                geometric_cos: point.normal.dot(wo),
                scattering: surface.scattering(self.world.geometry, point, hit, met.interface),
                u: [u_lobe, u1, u2],
            });
        }
        None
    }

    /// One camera path: a pure function of the scene, its seed, the pixel and the number of the sample.
    pub(crate) fn sample<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
        &self,
        x: u32,
        y: u32,
        sample: u32,
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) -> Path<'a, M, P, N> {
        let sampler = self.sampler(x, y, sample);
        if !self.prepared.receivers.is_empty() {
            return self.measured(x, y, sample, &sampler, counters, observer);
        }
        let mut path = Path::idle();
        let (start, passes) = self.start::<M, P, N>(x, y, sample, &sampler, counters);
        path.begin(&self.world, &start);
        if !passes {
            observer.end(End::Blocked);
            return path;
        }
        trace(&self.world, &mut path, start.ray, &sampler, counters, observer);
        path
    }

    /// One path that begins at the receiver of a column of the film, the same after its first vertex.
    fn measured<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
        &self,
        x: u32,
        y: u32,
        sample: u32,
        sampler: &Sampler,
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) -> Path<'a, M, P, N> {
        let drawn = || wavelength_and_time(self.of_block(x, y, sample).set(1)).0;
        let wavelengths = M::wavelengths(self.prepared, x, y, drawn);
        let time = self.time(sampler, counters);
        let departure = self.prepared.receivers[x as usize].depart(sampler.set(0), time);
        let ray = departure.first_ray();
        let stack = self.world.media_around(&ray, counters);
        let mut path = Path::idle();
        // Light that a white plate depolarises has no preferred axis; a cone shows it as an eye with this axis to its right.
        let polarisation = P::at_camera(ray.direction, Frame::from_normal(ray.direction).s);
        path.begin(&self.world, &Start { ray, stack, wavelengths, polarisation, weight: 1.0, hero_only: false });
        let first = match departure {
            Departure::Plane(point) => {
                let surface = self.world.surfaces.white_receiver();
                let mut vertex = SurfaceInteraction::of_receiver(point, surface);
                vertex.prepare_scattering(&self.world);
                path.go_on(&self.world, &vertex, sampler, counters, observer)
            }
            Departure::Free(ray) => {
                // The plane of a plate is a vertex of its own, so that both count edges alike.
                path.vertex = 1;
                Some(ray)
            }
        };
        if let Some(ray) = first {
            trace(&self.world, &mut path, ray, sampler, counters, observer);
        }
        path
    }

    /// The time of a sample, from 0 as the shutter opens to 1 as it closes.
    fn time(&self, sampler: &Sampler, counters: &mut Counters) -> f64 {
        if !self.world.moves {
            return 0.0;
        }
        counters.time_draws += 1;
        wavelength_and_time(sampler.set(1)).1
    }

    /// Where the path of a sample begins, and whether the camera's lens lets it.
    pub(crate) fn start<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
        &self,
        x: u32,
        y: u32,
        sample: u32,
        sampler: &Sampler,
        counters: &mut Counters,
    ) -> (Start<'a, P, N>, bool) {
        let drawn = || wavelength_and_time(self.of_block(x, y, sample).set(1)).0;
        let wavelengths = M::wavelengths(self.prepared, x, y, drawn);
        let drawn = self.camera_ray(x, y, sampler, wavelengths.lambda_nm[0], counters);
        let Some(CameraRay { ray, weight, hero_only }) = drawn else {
            return (Start::blocked(wavelengths), false);
        };
        let stack = self.world.media_around(&ray, counters);
        let polarisation = P::at_camera(ray.direction, self.camera.right(ray.time));
        (Start { ray, stack, wavelengths, polarisation, weight, hero_only }, true)
    }
}
