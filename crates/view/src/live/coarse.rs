//! The first pictures: one pixel out of each block, so that something is seen at once.

use std::sync::atomic::{AtomicBool, Ordering};

use etalon_transport::film::XyzSum;
use etalon_transport::{PixelSamples, Prepared, Splats};
use rayon::prelude::*;

use crate::picture::CoarsePixels;

/// Pixels that a thread takes at once.
const BATCH: usize = 64;

/// A coarse picture: how large its blocks are, and how many samples each of its pixels takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Level {
    /// Side of a block, pixels of the film.
    pub block: u32,
    /// Samples of the pixel that stands for it.
    pub samples: u32,
}

/// Camera paths of each coarse picture, and the smallest side of its blocks.
const PATHS: [(u64, u32); 2] = [(1 << 15, 8), (1 << 17, 4)];

/// The coarse pictures of a film of this size, each with more paths than the one before: each with smaller blocks or more samples. Films
/// that are hardly larger than their blocks have fewer.
pub(crate) fn levels([width, height]: [u32; 2], replicates: u32) -> Vec<Level> {
    let mut levels: Vec<Level> = Vec::new();
    let pixels = u64::from(width) * u64::from(height);
    for (paths, least) in PATHS {
        // A power of two, so that each coarse picture refines the one before.
        let blocks = (paths / u64::from(replicates)).max(1);
        let block = ((pixels as f64 / blocks as f64).sqrt().log2().ceil().max(0.0).exp2() as u32).max(least);
        let area = u64::from(width.div_ceil(block)) * u64::from(height.div_ceil(block));
        let rounds = (paths / (area * u64::from(replicates))).clamp(1, 16) as u32;
        let level = Level { block, samples: rounds * replicates };
        if pixels > 4 * area && !levels.contains(&level) {
            levels.push(level);
        }
    }
    levels
}

/// Traces a coarse picture; `None` as soon as `stop` says that nobody wants it any more.
pub(crate) fn trace(
    prepared: &Prepared,
    pool: &rayon::ThreadPool,
    level: Level,
    stop: &(dyn Fn() -> bool + Sync),
) -> Option<CoarsePixels> {
    let film = &prepared.scene().film;
    let replicates = prepared.scene().integrator.replicates;
    let Level { block, samples } = level;
    let [width, height] = [film.width, film.height].map(|side| side.div_ceil(block));
    // The middle of each block that is within the film.
    let middle = |index: u32, side: u32| (index * block + block / 2).min(side - 1);
    let pixels: Vec<(u32, u32)> =
        (0..height).flat_map(|y| (0..width).map(move |x| (middle(x, film.width), middle(y, film.height)))).collect();
    let mut sums = vec![XyzSum::default(); pixels.len() * replicates as usize];
    let stopped = AtomicBool::new(false);
    pool.install(|| {
        pixels.par_chunks(BATCH).zip(sums.par_chunks_mut(BATCH * replicates as usize)).for_each(|(pixels, sums)| {
            if stopped.load(Ordering::Relaxed) || stop() {
                stopped.store(true, Ordering::Relaxed);
                return;
            }
            let of_pixel = |&(x, y): &(u32, u32)| PixelSamples { x, y, samples: 0..samples };
            let all: Vec<PixelSamples> = pixels.iter().map(of_pixel).collect();
            // What light paths bring comes with the first whole pass: they would take as long as that.
            prepared.render_pixels(&all, &Splats::NONE, sums, &mut vec![0; all.len()]);
        });
    });
    (!stopped.into_inner()).then_some(CoarsePixels {
        width,
        height,
        film: [film.width, film.height],
        block,
        replicates,
        samples,
        sums,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_pictures_grow_finer_and_stay_cheap() {
        for size in [[512, 512], [320, 200], [1920, 1080], [4096, 4096]] {
            let levels = levels(size, 4);
            assert!(levels.len() >= 2, "{size:?}: {levels:?}");
            let paths = |level: &Level| {
                u64::from(size[0].div_ceil(level.block) * size[1].div_ceil(level.block) * level.samples)
            };
            assert!(levels.windows(2).all(|pair| paths(&pair[0]) < paths(&pair[1])), "{size:?}: {levels:?}");
            assert!(
                levels.iter().zip(PATHS).all(|(level, (most, _))| paths(level) <= 2 * most),
                "{size:?}: {levels:?}"
            );
        }
        assert_eq!(levels([2, 2], 4), []);
    }
}
