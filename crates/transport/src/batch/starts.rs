//! Camera rays and wavelengths of the samples to come, a set at a time.

use super::level::{Level, stages};
use super::paths::Paths;
use super::rows::{Row, Rows3, W};
use super::stream::Cursor;
use crate::camera::Camera;
use crate::film::Counters;
use crate::integrator::Start;
use crate::integrator::reuse::ReusePath;
use crate::integrator::tracer::Tracer;
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::polarisation::Polarisation;
use crate::sampler::{Samplers, Wanted, film_and_lens, wavelength_and_time};
use crate::scene::world::World;
use crate::wavelength::Wavelengths;
use etalon_geometry::SurfaceId;

/// See the module.
pub(super) struct Starts<'a, const N: usize> {
    tracer: &'a Tracer<'a>,
    cursor: Cursor<'a>,
    samplers: Samplers<W>,
    origin: Rows3,
    direction: Rows3,
    time: [f64; W],
    wavelengths: [Wavelengths<N>; W],
    /// What a compound lens does to each ray: its weight, and whether it is the hero's alone; `None` if it is blocked.
    passed: [Option<(f64, bool)>; W],
    /// How many of the set there are, and the next of them.
    count: usize,
    next: usize,
    /// Number of the next.
    number: u32,
}

impl<'a, const N: usize> Starts<'a, N> {
    pub(super) fn new(tracer: &'a Tracer<'a>, cursor: Cursor<'a>) -> Self {
        Self {
            tracer,
            cursor,
            samplers: Samplers::new(tracer.sampler(0, 0, 0)),
            origin: Rows3::ZERO,
            direction: Rows3::ZERO,
            time: [0.0; W],
            wavelengths: [Wavelengths::fixed([0.0; N]); W],
            passed: [Some((1.0, false)); W],
            count: 0,
            next: 0,
            number: 0,
        }
    }

    /// Number of the next sample.
    #[inline(always)]
    pub(super) fn number(&self) -> u32 {
        self.number
    }

    /// Sees to it that there is a next sample, unless there is none left.
    #[inline(always)]
    pub(super) fn ready<M: WavelengthModel<N>>(&mut self, level: Level, counters: &mut Counters) -> bool {
        if self.next == self.count {
            self.fill::<M>(level, counters);
        }
        self.next < self.count
    }

    /// Draws what the camera draws for the next samples.
    #[inline(always)]
    fn fill<M: WavelengthModel<N>>(&mut self, level: Level, counters: &mut Counters) {
        (self.count, self.next) = (0, 0);
        let (mut x, mut y, mut samples) = ([0; W], [0; W], [0; W]);
        for (lane, place) in self.cursor.by_ref().take(W).enumerate() {
            self.samplers.put(lane, self.tracer.sampler(place.x, place.y, place.sample));
            (x[lane], y[lane], samples[lane]) = (place.x, place.y, place.sample);
            self.count += 1;
        }
        if self.count == 0 {
            return;
        }
        let moves = self.tracer.world.moves;
        let wanted = [true, moves, false, false];
        let mut numbers = [[0.0; W]; 4];
        if self.tracer.prepared.path_reuse().is_some() {
            let mut of_blocks = self.samplers.clone();
            for lane in 0..self.count {
                of_blocks.put(lane, self.tracer.of_block(x[lane], y[lane], samples[lane]));
            }
            camera_numbers(level, &of_blocks, 1, wanted, &mut numbers);
        } else {
            camera_numbers(level, &self.samplers, 1, wanted, &mut numbers);
        }
        let (of_wavelength, of_time) = wavelength_and_time(numbers);
        for lane in 0..self.count {
            self.wavelengths[lane] = M::wavelengths(self.tracer.prepared, x[lane], y[lane], || of_wavelength[lane]);
        }
        if moves {
            // Blocks share wavelengths alone, and nothing that moves.
            self.time = of_time;
            counters.time_draws += self.count as u64;
        }
        let camera = &self.tracer.camera;
        let lens = camera.has_lens();
        camera_numbers(level, &self.samplers, 0, [true, true, lens, lens], &mut numbers);
        counters.lens_draws += self.count as u64 * u64::from(lens);
        let (on_film, on_lens) = film_and_lens(numbers);
        let mut film = [Row::ZERO; 2];
        for lane in 0..self.count {
            let [column, row] = self.tracer.film_point(x[lane], y[lane], on_film.map(|u| u[lane]));
            (film[0].0[lane], film[1].0[lane]) = (column, row);
        }
        let lens = on_lens.map(Row);
        if camera.is_compound() {
            for lane in 0..self.count {
                let at = |rows: &[Row; 2]| [rows[0].0[lane], rows[1].0[lane]];
                let time = if moves { self.time[lane] } else { 0.0 };
                let hero_nm = self.wavelengths[lane].lambda_nm[0];
                let drawn = camera.ray_of(at(&film), at(&lens), time, hero_nm);
                self.passed[lane] = drawn.map(|drawn| {
                    self.origin.set(lane, drawn.ray.origin);
                    self.direction.set(lane, drawn.ray.direction);
                    (drawn.weight, drawn.hero_only)
                });
            }
        } else if moves {
            for lane in 0..self.count {
                let at = |rows: &[Row; 2]| [rows[0].0[lane], rows[1].0[lane]];
                let ray = camera.ray_at(at(&film), at(&lens), self.time[lane]);
                self.origin.set(lane, ray.origin);
                self.direction.set(lane, ray.direction);
            }
        } else {
            camera_rays(level, camera, &film, &lens, &mut self.origin, &mut self.direction);
        }
    }

    /// Begins the next sample in the place of a path. False where the camera's lens blocks it: the path has then ended, and brings nothing.
    #[inline(always)]
    pub(super) fn put<'w, M: WavelengthModel<N>, P: Polarisation<N>>(
        &mut self,
        lane: usize,
        world: &World<'w>,
        paths: &mut Paths<'w, M, P, N>,
        counters: &mut Counters,
    ) -> bool {
        let start = self.next % W;
        self.next += 1;
        let Some((weight, hero_only)) = self.passed[start] else {
            paths.number[lane] = self.number;
            self.number = self.number.wrapping_add(1);
            paths.paths[lane].begin(world, &Start::blocked(self.wavelengths[start]));
            return false;
        };
        paths.alive |= 1 << lane;
        paths.number[lane] = self.number;
        self.number = self.number.wrapping_add(1);
        paths.samplers.put(lane, *self.samplers.lane(start));
        paths.vertex[lane] = 0;
        paths.ray_count[lane] = 0;
        paths.origin.set(lane, self.origin.at(start));
        paths.direction.set(lane, self.direction.at(start));
        paths.leaves[lane] = SurfaceId::NONE;
        paths.time[lane] = self.time[start];
        if paths.shares {
            paths.reuse_path[lane] = ReusePath::NOTHING;
        }
        let ray = paths.ray(lane);
        let stack = world.media_around(&ray, counters);
        let polarisation = P::at_camera(ray.direction, self.tracer.camera.right(ray.time));
        let wavelengths = self.wavelengths[start];
        paths.paths[lane].begin(world, &Start { ray, stack, wavelengths, polarisation, weight, hero_only });
        true
    }
}

stages! {
    /// Set number `set` of every path.
    fn camera_numbers(samplers: &Samplers<W>, set: u32, wanted: Wanted, numbers: &mut [[f64; W]; 4]) {
        samplers.sets(&[set; W], wanted, numbers);
    }

    /// Rays through points of the film.
    fn camera_rays(camera: &Camera, film: &[Row; 2], lens: &[Row; 2], origin: &mut Rows3, direction: &mut Rows3) {
        camera.rays([&film[0].0, &film[1].0], [&lens[0].0, &lens[1].0], |lane, ray| {
            origin.set(lane, ray.origin);
            direction.set(lane, ray.direction);
        });
    }
}
