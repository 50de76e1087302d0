//! The light paths of samples, and what they bring to pixels.

use super::{Connection, paths_of_sample};
use crate::film::{Counters, PixelRect, Splats};
use crate::guiding::SpecularObjects;
use crate::scene::prepare::Prepared;
use rayon::prelude::*;
use std::ops::Range;

/// Light paths that a thread follows at once, and how often that is done before what they bring is added up.
const CHUNK: u64 = 1 << 12;
const CHUNKS_AT_ONCE: usize = 64;

/// What one light path brings to one pixel.
#[derive(Clone, Copy, Debug)]
struct Splat {
    /// Number of the pixel within the rectangle, row by row.
    pixel: u32,
    xyz: [f64; 3],
}

/// Follows all light paths of some samples. The sums are the same for every number of threads.
pub(super) fn of_samples(
    prepared: &Prepared,
    specular_objects: &SpecularObjects,
    samples: Range<u32>,
    rect: PixelRect,
) -> Splats {
    let of = paths_of_sample(prepared, specular_objects);
    of_paths(prepared, specular_objects, prepared.scene.integrator.seed, (of, samples), rect)
}

/// The same of as many light paths in each sample, with random numbers of a seed.
pub(super) fn of_paths(
    prepared: &Prepared,
    specular_objects: &SpecularObjects,
    seed: u64,
    (of, samples): (u64, Range<u32>),
    rect: PixelRect,
) -> Splats {
    let trace = prepared.kernel().trace_light_paths;
    let chunks_of =
        |sample: u32| (0..of).step_by(CHUNK as usize).map(move |first| (sample, first..(first + CHUNK).min(of)));
    let chunks: Vec<(u32, Range<u64>)> = samples.clone().flat_map(chunks_of).collect();
    let mut sums = SampleSums::new(rect, samples.start);
    let mut rays = 0;
    for at_once in chunks.chunks(CHUNKS_AT_ONCE) {
        let traced: Vec<(Vec<Splat>, u64)> = at_once
            .par_iter()
            .map(|(sample, numbers)| {
                let (mut counters, mut splats) = (Counters::default(), Vec::new());
                trace(
                    prepared,
                    specular_objects,
                    seed,
                    (numbers.clone(), of),
                    (*sample, rect),
                    &mut counters,
                    &mut |connection| {
                        prepared.spread(&connection, rect, &mut splats);
                    },
                );
                (splats, counters.rays + counters.shadow_rays)
            })
            .collect();
        for ((sample, _), (splats, of_chunk)) in at_once.iter().zip(&traced) {
            sums.add(*sample, splats);
            rays += of_chunk;
        }
    }
    let (starts, entries) = sums.sorted();
    Splats { rect, starts, entries, rays, paths: of * samples.len() as u64 }
}

/// What samples bring, one after the other: as much memory as the picture has pixels, and as the samples that reach them.
struct SampleSums {
    /// Of the sample that is under way: what each pixel has received, and which pixels have.
    under_way: Vec<[f64; 3]>,
    touched: Vec<u32>,
    sample: u32,
    /// Of finished samples: pixel, sample, CIE XYZ.
    finished: Vec<(u32, u32, [f64; 3])>,
}

impl SampleSums {
    fn new(rect: PixelRect, sample: u32) -> Self {
        Self { under_way: vec![[0.0; 3]; rect.area() as usize], touched: Vec::new(), sample, finished: Vec::new() }
    }

    /// Adds a part of a sample, in the order of its light paths.
    fn add(&mut self, sample: u32, splats: &[Splat]) {
        if sample != self.sample {
            self.finish();
            self.sample = sample;
        }
        for splat in splats {
            let sum = &mut self.under_way[splat.pixel as usize];
            if *sum == [0.0; 3] {
                self.touched.push(splat.pixel);
            }
            (0..3).for_each(|c| sum[c] += splat.xyz[c]);
        }
    }

    fn finish(&mut self) {
        for pixel in self.touched.drain(..) {
            let xyz = std::mem::take(&mut self.under_way[pixel as usize]);
            // One that has received nothing but zeros is named several times.
            if xyz != [0.0; 3] {
                self.finished.push((pixel, self.sample, xyz));
            }
        }
    }

    /// By pixel, then by sample: where the entries of each pixel begin, and the entries.
    fn sorted(mut self) -> (Vec<usize>, Vec<(u32, [f64; 3])>) {
        self.finish();
        let mut starts = vec![0; self.under_way.len() + 1];
        self.finished.iter().for_each(|(pixel, ..)| starts[*pixel as usize + 1] += 1);
        for pixel in 0..self.under_way.len() {
            starts[pixel + 1] += starts[pixel];
        }
        let mut next = starts.clone();
        let mut entries = vec![(0, [0.0; 3]); self.finished.len()];
        for (pixel, sample, xyz) in self.finished {
            let place = &mut next[pixel as usize];
            entries[*place] = (sample, xyz);
            *place += 1;
        }
        (starts, entries)
    }
}

impl Prepared {
    /// What each pixel of a rectangle receives of a light path: by its filter.
    fn spread(&self, connection: &Connection, rect: PixelRect, splats: &mut Vec<Splat>) {
        let reach = self.filter_reach_px();
        // The centre of a pixel is half a pixel after its number.
        let near = |place: f64, first: u32, end: u32| {
            let from = (place - 0.5 - reach).ceil().max(f64::from(first));
            let to = (place - 0.5 + reach).floor().min(f64::from(end) - 1.0);
            from as i64..to as i64 + 1
        };
        let film = &self.scene.film;
        let value = |place: f64, pixel: i64, size: u32| {
            let centre = pixel as f64 + 0.5;
            match film.sample_border {
                true => self.filter.value(place - centre),
                false => self.filter.value_on_film(place - centre, centre, f64::from(size)),
            }
        };
        let [column, row] = connection.place_px;
        let is_on_film =
            (0.0..=f64::from(film.width)).contains(&column) && (0.0..=f64::from(film.height)).contains(&row);
        if !film.sample_border && !is_on_film {
            return;
        }
        for y in near(row, rect.y0, rect.y1) {
            let of_row = value(row, y, film.height);
            for x in near(column, rect.x0, rect.x1) {
                let share = of_row * value(column, x, film.width);
                if share != 0.0 {
                    let pixel = (y as u32 - rect.y0) * (rect.x1 - rect.x0) + (x as u32 - rect.x0);
                    splats.push(Splat { pixel, xyz: connection.xyz.map(|v| v * share) });
                }
            }
        }
    }
}
