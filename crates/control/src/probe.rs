//! Pixels traced with random numbers that no picture uses: what explorations and pilots are made of. Camera paths alone: light paths would have
//! to be traced for the whole picture.

use etalon_scene::SamplerKind;
use etalon_transport::film::XyzSum;
use etalon_transport::sampler::SOBOL_POINTS;
use etalon_transport::{Counters, Pixel, PixelSamples, Prepared, Splats, ThreadError};
use rayon::prelude::*;
use std::ops::Range;

/// Fewest replicates that an error is estimated from.
const FEWEST_REPLICATES: u32 = 4;

/// What the samples of a probe are for: each has random numbers of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// To tell the error of the picture.
    Pilot,
    /// To tell where the error is.
    Exploration,
}

/// Pixels that a thread takes at once, so that many paths are under way together whatever the samples of each.
const BATCH: usize = 64;

/// The number of purposes.
const PURPOSES: u32 = 2;

/// Some pixels of a picture, and what was gathered in them.
pub(crate) struct Probe<'a> {
    prepared: &'a Prepared,
    pool: rayon::ThreadPool,
    purpose: Purpose,
    pixels: Vec<(u32, u32)>,
    /// Pixel by pixel, copy by copy, replicate by replicate.
    sums: Vec<XyzSum>,
    /// Pixel by pixel: camera paths, and rays of all kinds, which tell what a path costs without a clock.
    paths: Vec<u64>,
    rays: Vec<u64>,
}

/// A pixel of a probe.
pub(crate) struct Seen<'a> {
    /// Column and row.
    pub at: (u32, u32),
    /// The sums of all copies, as this many replicates.
    pub pixel: Pixel<'a>,
    /// Camera paths, and rays of all kinds.
    pub paths: u64,
    /// See `paths`.
    pub rays: u64,
}

impl<'a> Probe<'a> {
    /// A probe of no pixels yet, on this many threads (all cores if `None`).
    pub(crate) fn new(prepared: &'a Prepared, purpose: Purpose, threads: Option<usize>) -> Result<Self, ThreadError> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build()?;
        Ok(Self { prepared, pool, purpose, pixels: Vec::new(), sums: Vec::new(), paths: Vec::new(), rays: Vec::new() })
    }

    /// Takes in pixels that have no samples yet.
    pub(crate) fn add(&mut self, pixels: impl IntoIterator<Item = (u32, u32)>) {
        self.pixels.extend(pixels);
        self.sums.resize(self.pixels.len() * self.stride(), XyzSum::default());
        self.paths.resize(self.pixels.len(), 0);
        self.rays.resize(self.pixels.len(), 0);
    }

    /// Number of pixels.
    pub(crate) fn len(&self) -> usize {
        self.pixels.len()
    }

    /// Replicates of the picture.
    pub(crate) fn replicates(&self) -> u32 {
        self.prepared.scene().integrator.replicates
    }

    /// Number sequence of the picture.
    pub(crate) fn sampler(&self) -> SamplerKind {
        self.prepared.scene().integrator.sampler
    }

    /// Independent copies of the picture's estimate, so that there are replicates enough.
    pub(crate) fn copies(&self) -> u32 {
        FEWEST_REPLICATES.div_ceil(self.replicates())
    }

    fn stride(&self) -> usize {
        (self.copies() * self.replicates()) as usize
    }

    /// What was gathered, pixel by pixel.
    pub(crate) fn seen(&self) -> impl Iterator<Item = Seen<'_>> {
        let sums = self.sums.chunks_exact(self.stride()).map(Pixel::new);
        let work = self.paths.iter().zip(&self.rays);
        self.pixels.iter().zip(sums).zip(work).map(|((&at, pixel), (&paths, &rays))| Seen { at, pixel, paths, rays })
    }

    /// Rays of all kinds.
    pub(crate) fn rays(&self) -> u64 {
        self.rays.iter().sum()
    }

    /// Camera paths traced.
    pub(crate) fn paths(&self) -> u64 {
        self.paths.iter().sum()
    }

    /// Traces the samples `samples(x, y)` of the pixels from number `first` on, in every copy.
    pub(crate) fn trace(
        &mut self,
        first: usize,
        samples: impl Fn(u32, u32) -> Range<u32> + Sync,
        on_work: &(dyn Fn(&Counters) + Sync),
    ) {
        let (replicates, copies, stride) = (self.replicates(), self.copies(), self.stride());
        let prepared = self.prepared;
        // A whole number of point sets beyond every number of samples that a picture can have.
        let set = replicates * SOBOL_POINTS;
        let beyond = (i32::MAX as u32).div_ceil(set) * set;
        // Far enough apart for 2¹⁶ samples and more of each replicate.
        let length = set * (u32::MAX.saturating_sub(beyond) / set / (PURPOSES * copies));
        let own = self.purpose as u32 * copies;
        let Self { pool, pixels, sums, paths, rays, .. } = self;
        pool.install(|| {
            pixels[first..]
                .par_chunks(BATCH)
                .zip(sums[first * stride..].par_chunks_mut(BATCH * stride))
                .zip(paths[first..].par_chunks_mut(BATCH).zip(rays[first..].par_chunks_mut(BATCH)))
                .for_each(|((pixels, sums), (paths, rays))| {
                    let mut all_samples = Vec::with_capacity(pixels.len() * copies as usize);
                    for (&(x, y), paths) in pixels.iter().zip(paths) {
                        let samples = samples(x, y);
                        for copy in 0..copies {
                            let start = beyond + (own + copy) * length;
                            let pixel_samples =
                                PixelSamples { x, y, samples: start + samples.start..start + samples.end };
                            *paths += u64::from(pixel_samples.count());
                            all_samples.push(pixel_samples);
                        }
                    }
                    let mut rays_of_pixels = vec![0; all_samples.len()];
                    on_work(&prepared.render_pixels(&all_samples, &Splats::NONE, sums, &mut rays_of_pixels));
                    for (rays, of_copies) in rays.iter_mut().zip(rays_of_pixels.chunks_exact(copies as usize)) {
                        *rays += of_copies.iter().sum::<u64>();
                    }
                });
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_transport::{Control, Extent};

    /// A floor below a large lamp: what a sample sees varies with its numbers, and is never the same twice.
    fn lit_floor() -> Prepared {
        let json = r#"{"etalon": 1, "film": {"width": 8, "height": 8},
            "camera": {"type": "perspective", "position_m": [3, 3, 0], "look_at_m": [0, 0, 0], "vertical_fov_deg": 5},
            "materials": {"white": {"type": "lambert", "reflectance": 1}, "black": {"type": "black"}},
            "objects": [
                {"material": "white", "shape": {"type": "disk", "center_m": [0, 0, 0], "normal": [0, 1, 0], "radius_m": 1}},
                {"material": "black", "emission": {"radiance": 1},
                  "shape": {"type": "disk", "center_m": [0, 4, 0], "normal": [0, -1, 0], "radius_m": 2}}],
            "integrator": {"light_sampling": "light", "max_depth": 2, "sampler": "independent"}}"#;
        etalon_transport::prepare(&etalon_scene::parse(json, "floor").unwrap_or_else(|e| panic!("{e:?}")).0).unwrap()
    }

    /// None of the first samples of a pilot or an exploration is one of another of them, or one of the picture's first.
    #[test]
    fn probes_have_samples_of_their_own() {
        let prepared = lit_floor();
        let rect = prepared.whole(None).rect;
        let of_probe = |purpose: Purpose, sample: u32| -> Vec<f64> {
            let mut probe = Probe::new(&prepared, purpose, Some(1)).unwrap();
            probe.add(rect.pixels());
            probe.trace(0, |_, _| sample..sample + 1, &|_| ());
            probe.seen().map(|seen| seen.pixel.xyz()[1]).collect()
        };
        let of_picture = |sample: u32| -> Vec<f64> {
            let extent = Extent { rect, samples: sample..sample + 1, threads: Some(1) };
            let film = prepared.render(&extent, &|_| Control::Continue).unwrap();
            film.pixels().map(|pixel| pixel.xyz()[1]).collect()
        };
        let probes = [Purpose::Pilot, Purpose::Exploration].map(|purpose| (0..8).map(move |k| (purpose, k)));
        let probes = probes.into_iter().flatten().map(|(purpose, sample)| of_probe(purpose, sample));
        let all: Vec<Vec<f64>> = probes.chain((0..32).map(of_picture)).collect();
        for pixel in 0..rect.area() as usize {
            let mut seen: Vec<f64> = all.iter().map(|samples| samples[pixel]).collect();
            seen.sort_unstable_by(f64::total_cmp);
            assert!(seen[0] > 0.0 && seen.windows(2).all(|pair| pair[0] < pair[1]), "{pixel}: {seen:?}");
        }
    }
}
