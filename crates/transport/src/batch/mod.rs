//! Many paths at once: the steps of [`integrator`](crate::integrator) for [`W`](rows::W) paths side by side.
//!
//! The steps are those of the scalar driver, so the film and the counts are the same bit for bit. Before each step, what most paths need is
//! computed for all of them with vector instructions: random numbers, closest hits and shadow rays, directions toward flat lights, disks,
//! spheres and images of the sky, directions from Lambertian surfaces, mirrors and smooth interfaces, guided directions, origins of rays. These are functions
//! over rows, one number a path ([`level`]). Whatever has no such function is asked path by path, by the very functions of the scalar
//! driver. A path that ends makes room for the next sample ([`stream`]).

mod arrive;
mod blocks;
mod guided;
mod lamps;
mod level;
mod next_event;
mod paths;
mod rows;
mod scatter;
mod skies;
mod starts;
mod stream;
#[cfg(test)]
mod tests;

use crate::film::{Counters, Splats, Sums};
use crate::integrator::film_entry::{FilmEntry, Received};
use crate::integrator::reuse::Blocks;
use crate::integrator::tracer::{PixelSamples, Tracer};
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::polarisation::Polarisation;
use crate::scene::prepare::Prepared;
use crate::scene::world::World;
use blocks::Redistribution;
use etalon_optics::Lanes;
use guided::GuidedDirections;
use level::{Level, stages};
use next_event::Lights;
use paths::Paths;
use rows::{Mask, W, lanes};
use starts::Starts;
use stream::{Cursor, Window};

/// The samples of some pixels, added to `sums` pixel by pixel in the order of their numbers, and the rays that each pixel took to `rays`,
/// unless that is empty.
pub(crate) fn render_batch<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
    prepared: &Prepared,
    all_samples: &[PixelSamples],
    sums: Sums<'_>,
    rays: &mut [u64],
) -> Counters {
    render_on::<M, P, N>(Level::best(), prepared, all_samples, sums, rays)
}

fn render_on<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
    level: Level,
    prepared: &Prepared,
    all_samples: &[PixelSamples],
    sums: Sums<'_>,
    rays: &mut [u64],
) -> Counters {
    let tracer = Tracer::new(prepared);
    let film = &prepared.scene.film;
    let blocks = prepared.path_reuse().map(|block| Blocks::of(all_samples, block, [film.width, film.height]));
    let cursor = match &blocks {
        None => Cursor::new(all_samples, &[]),
        Some(blocks) => Cursor::new(&blocks.all_samples, &blocks.block_pixels),
    };
    // Where paths are shared, others than those that end there add to the sums.
    let nothing = Sums { xyz: &mut [], stokes: &mut [], bands: &mut [], splats: &Splats::NONE };
    let (redistribution, finished) = match &blocks {
        None => (None, Finished::new::<P>(cursor.clone(), prepared, sums, rays)),
        Some(blocks) => (
            Some(Redistribution::new(blocks, cursor.window(), prepared, sums, rays)),
            Finished::new::<P>(cursor.clone(), prepared, nothing, &mut []),
        ),
    };
    let mut batch = Batch::<M, P, N> {
        prepared,
        world: &tracer.world,
        level,
        counters: Counters::default(),
        paths: Paths::new(tracer.sampler(0, 0, 0), blocks.is_some()),
        lights: Lights::new(),
        guided_directions: GuidedDirections::new(),
        seen: [[Lanes::ZERO; 3]; W],
        finished,
        redistribution,
    };
    let mut starts = Starts::new(&tracer, cursor);
    trace::<M, P, N>(level, &mut batch, &mut starts);
    batch.counters
}

stages! {
    /// All samples.
    fn trace [M: WavelengthModel<N>, P: Polarisation<N>, const N: usize][M, P, N] (
        batch: &mut Batch<'_, M, P, N>,
        starts: &mut Starts<'_, N>,
    ) {
        loop {
            batch.begin(starts);
            if batch.paths.alive == 0 {
                break;
            }
            let before = batch.paths.alive;
            let scatters = batch.arrive();
            batch.add_light(scatters);
            batch.scatter(scatters);
            batch.end(before & !batch.paths.alive);
        }
    }
}

/// Spots under way.
struct Batch<'a, M, P, const N: usize> {
    prepared: &'a Prepared,
    world: &'a World<'a>,
    level: Level,
    counters: Counters,
    paths: Paths<'a, M, P, N>,
    /// The lights that paths look at.
    lights: Lights,
    /// Directions toward targets of guided sampling.
    guided_directions: GuidedDirections,
    /// What the lanes of paths that ended add to the film.
    seen: [[Lanes<f64, N>; 3]; W],
    finished: Finished<'a, N>,
    /// Where neighbouring pixels share paths.
    redistribution: Option<Redistribution<'a, N>>,
}

impl<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Batch<'_, M, P, N> {
    /// Puts the next samples where no path is.
    #[inline(always)]
    fn begin(&mut self, starts: &mut Starts<'_, N>) {
        'lanes: for lane in lanes(!self.paths.alive & paths::ALL) {
            // Until one is not blocked by the camera's lens.
            loop {
                if !self.finished.window.admits(starts.number()) {
                    break 'lanes;
                }
                if !starts.ready::<M>(self.level, &mut self.counters) {
                    break 'lanes;
                }
                if starts.put(lane, self.world, &mut self.paths, &mut self.counters) {
                    break;
                }
                let path = &self.paths.paths[lane];
                self.finished.put(self.paths.number[lane], ([0.0; 3], 0), || path.received());
                self.finished.add::<M>(&mut self.counters);
            }
        }
    }

    /// Takes what ended paths have gathered.
    #[inline(always)]
    fn end(&mut self, ended: Mask) {
        if self.paths.shares {
            return self.end_shared(ended);
        }
        // In two loops, of which the first becomes vector instructions.
        for lane in lanes(ended) {
            let path = &self.paths.paths[lane];
            self.seen[lane] = M::seen(self.prepared, path.wavelengths_at_camera(), path.radiance);
        }
        for lane in lanes(ended) {
            let xyz = self.seen[lane].map(Lanes::sum);
            let path = &self.paths.paths[lane];
            self.finished.put(self.paths.number[lane], (xyz, self.paths.ray_count[lane]), || path.received());
        }
        if ended != 0 {
            self.finished.add::<M>(&mut self.counters);
        }
    }
}

/// What finished samples came to, on its way into the sums.
struct Finished<'a, const N: usize> {
    cursor: Cursor<'a>,
    /// Colours, and rays of all kinds.
    window: Window<([f64; 3], u32)>,
    /// What samples that wait have brought beside their colour, where the film asks for it.
    received: Vec<Received<N>>,
    film: FilmEntry<'a>,
}

impl<'a, const N: usize> Finished<'a, N> {
    fn new<P: Polarisation<N>>(
        cursor: Cursor<'a>,
        prepared: &'a Prepared,
        sums: Sums<'a>,
        rays: &'a mut [u64],
    ) -> Self {
        let (size, film) = (cursor.window(), FilmEntry::new(prepared, sums, rays));
        let received = if film.keeps_bands() || P::FOLLOWED { vec![Received::NOTHING; size] } else { Vec::new() };
        Self { cursor, window: Window::new(size), received, film }
    }

    #[inline(always)]
    fn put(&mut self, number: u32, came_to: ([f64; 3], u32), received: impl FnOnce() -> Received<N>) {
        if let Some(waiting) = self.received.get_mut(self.window.place(number)) {
            *waiting = received();
        }
        self.window.put(number, came_to);
    }

    /// Adds those whose turn it is.
    #[inline(always)]
    fn add<M: WavelengthModel<N>>(&mut self, counters: &mut Counters) {
        while let Some((number, (xyz, rays))) = self.window.take() {
            let id = self.cursor.next().expect("as many samples come back as went out");
            self.film.count_rays(id.pixel_samples, rays.into());
            let received = self.received.get(self.window.place(number)).unwrap_or(&Received::NOTHING);
            self.film.add::<M, N>(id, xyz, received, counters);
        }
    }
}
