//! The kernels: the path loop instantiated for a scalar type, and the table that names them.

use crate::camera::Camera;
use crate::film::{Counters, Film, NonFinite, PixelRect, PixelSum};
use crate::observer::Observer;
use crate::path::{MOST_VERTICES, World};
use crate::prepare::Prepared;
use crate::sampler::Sampler;
use crate::wavelength::Wavelengths;
use etalon_optics::{Lanes, Real};
use etalon_scene::Precision;
use std::ops::Range;

/// Wavelengths that a path carries.
pub(crate) const LANES: usize = 4;

/// A kernel: adds samples to one tile.
pub(crate) type Kernel = fn(&Prepared, PixelRect, Range<u32>, &Film) -> (Vec<PixelSum>, Counters);

/// The whole table.
pub(crate) fn kernel(precision: Precision) -> Kernel {
    match precision {
        Precision::F32 => render_tile::<f32>,
        Precision::F64 => render_tile::<f64>,
    }
}

/// The samples `samples` of every pixel of `tile`, added to what the film holds in the order of their numbers.
fn render_tile<R: Real>(
    prepared: &Prepared,
    tile: PixelRect,
    samples: Range<u32>,
    film: &Film,
) -> (Vec<PixelSum>, Counters) {
    let tracer = Tracer::<R>::new(prepared);
    let mut counters = Counters::default();
    let sums = tile
        .pixels()
        .map(|(x, y)| {
            let mut sum = film.pixels()[film.index(x, y)];
            for sample in samples.clone() {
                let (wavelengths, radiance) = tracer.sample(x, y, sample, &mut counters, &mut ());
                let xyz = wavelengths.to_xyz(radiance);
                counters.paths += 1;
                if xyz.iter().all(|v| v.is_finite()) {
                    (0..3).for_each(|c| sum.xyz[c] += xyz[c]);
                    sum.count += 1;
                } else {
                    counters.record_nonfinite(NonFinite { y, x, sample });
                }
            }
            sum
        })
        .collect();
    (sums, counters)
}

/// One scene in one scalar type.
pub(crate) struct Tracer<'a, R> {
    prepared: &'a Prepared,
    camera: Camera<R>,
    world: World<'a>,
}

impl<'a, R: Real> Tracer<'a, R> {
    pub(crate) fn new(prepared: &'a Prepared) -> Self {
        let integrator = &prepared.scene.integrator;
        let film = &prepared.scene.film;
        Self {
            prepared,
            camera: Camera::new(&prepared.scene.camera, film.width, film.height),
            world: World {
                geometry: &prepared.geometry,
                surfaces: &prepared.surfaces,
                lights: &prepared.lights,
                environments: &prepared.environments,
                light_sampling: integrator.light_sampling,
                max_depth: integrator.max_depth.unwrap_or(MOST_VERTICES).min(MOST_VERTICES),
                roulette: integrator.roulette,
            },
        }
    }

    /// One camera path: a pure function of the scene, its seed, the pixel and the number of the sample.
    pub(crate) fn sample(
        &self,
        x: u32,
        y: u32,
        sample: u32,
        counters: &mut Counters,
        observer: &mut impl Observer<R, LANES>,
    ) -> (Wavelengths<LANES>, Lanes<R, LANES>) {
        let scene = &self.prepared.scene;
        let (width, height) = (f64::from(scene.film.width), f64::from(scene.film.height));
        let pixel = u64::from(y) << 32 | u64::from(x);
        let sampler = Sampler::new(scene.integrator.sampler, scene.integrator.seed, pixel, sample);
        let [film_x, film_y, lens_1, lens_2] = sampler.set::<R>(0);
        let [wavelength, ..] = sampler.set::<R>(1);

        let wavelengths = self.prepared.wavelengths.sample_lanes(wavelength.to_f64());
        let column = f64::from(x) + 0.5 + self.prepared.filter.offset(film_x.to_f64());
        let row = f64::from(y) + 0.5 + self.prepared.filter.offset(film_y.to_f64());
        let film = [R::from_f64(2.0 * column / width - 1.0), R::from_f64(1.0 - 2.0 * row / height)];
        let ray = self.camera.ray(film, [lens_1, lens_2]);
        let radiance = self.world.radiance(ray, &wavelengths.lambda_nm, &sampler, counters, observer);
        (wavelengths, radiance)
    }
}
