//! Rendering: tiles over all cores, the same bytes whatever their number.

pub mod features;
pub(crate) mod kernel;
mod tiles;
pub mod tune;

pub use tiles::{Control, Piece, ThreadError};

use crate::film::{Counters, Film, PixelRect, Splats, Sums, TileSums, XyzSum};
use crate::integrator::replay::Replay;
use crate::integrator::tracer::PixelSamples;
use crate::plan::{LaneModel, PathLoop};
use crate::render::kernel::RenderPixels;
use crate::scene::prepare::Prepared;
use std::ops::Range;

/// Side of a tile, pixels.
pub const TILE: u32 = 16;

/// A stage of a render: which pixels, which samples, on how many threads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Pixels.
    pub rect: PixelRect,
    /// Numbers of the samples.
    pub samples: Range<u32>,
    /// Threads; `None` is one for each core.
    pub threads: Option<usize>,
}

impl Prepared {
    /// The whole film at the scene's own number of samples.
    pub fn whole(&self, threads: Option<usize>) -> Extent {
        Extent { rect: self.whole_rect(), samples: 0..self.scene.integrator.spp, threads }
    }

    /// All pixels of the picture.
    pub fn whole_rect(&self) -> PixelRect {
        let film = &self.scene.film;
        PixelRect { x0: 0, y0: 0, x1: film.width, y1: film.height }
    }

    /// A black film for this scene.
    pub fn film(&self) -> Film {
        let film = &self.scene.film;
        let film = Film::with_bands(film.width, film.height, self.scene.integrator.replicates, self.band_sums())
            .sharing(self.path_reuse().or(self.pixels_of_light_path()));
        if self.records_stokes() { film.recording_stokes() } else { film }
    }

    /// Sums that a film keeps for its bands: one for each, or one for all where one lane stands for all wavelengths; where the film
    /// holds Stokes parameters, those of S₀ band by band, then those of S₁, S₂ and S₃.
    pub fn band_sums(&self) -> u32 {
        match (&self.scene.film.bands, self.plan().lane_model) {
            // Channels have no wavelengths.
            (None, _) | (_, LaneModel::ThreeChannels) => 0,
            (Some(_), LaneModel::One) => 1,
            (Some(bands), LaneModel::Shared | LaneModel::Hero) => bands.count * self.band_parameters(),
        }
    }

    /// Stokes parameters that each band has: four, or S₀ alone.
    pub(crate) fn band_parameters(&self) -> u32 {
        if self.records_stokes() { 4 } else { 1 }
    }

    /// Where one sum stands for all bands: what it is to be multiplied by for each.
    pub fn band_factors(&self) -> Option<Vec<f64>> {
        let bands = self.scene.film.bands.as_ref().filter(|_| self.plan().lane_model == LaneModel::One)?;
        Some(
            (0..bands.count)
                .map(|band| self.one_lane.mean_of_unit([bands.edge_nm(band), bands.edge_nm(band + 1)]))
                .collect(),
        )
    }

    /// Traces sample number `sample` of pixel (`x`, `y`) once more and says what happened; of its light paths, what they bring to the pixel.
    pub fn replay(&self, x: u32, y: u32, sample: u32) -> Replay {
        Replay { light_paths_xyz: self.light_paths_xyz(x, y, sample), ..self.replay_camera_path(x, y, sample) }
    }

    /// The same of its camera path alone.
    pub fn replay_camera_path(&self, x: u32, y: u32, sample: u32) -> Replay {
        (self.kernel().replay)(self, x, y, sample)
    }

    fn light_paths_xyz(&self, x: u32, y: u32, sample: u32) -> Option<[f64; 3]> {
        self.specular_objects.as_ref()?;
        let rect = PixelRect { x0: x, y0: y, x1: x + 1, y1: y + 1 };
        let splats = self.splats(sample..sample.saturating_add(1), rect);
        Some(splats.of(x, y, sample).unwrap_or([0.0; 3]))
    }

    /// Adds samples to the sums of a tile, by the loop that the plan chose. `splats` holds what the light paths of these samples bring to it:
    /// see [`Prepared::splats`].
    pub fn render_tile(&self, tile: PixelRect, samples: Range<u32>, splats: &Splats, sums: &mut TileSums) -> Counters {
        self.renderer()(self, &PixelSamples::of_tile(tile, &samples), sums.borrow(splats), &mut [])
    }

    /// Adds samples to the colours of pixels, pixel by pixel, in each replicate by replicate; and to `rays` the rays of all kinds that
    /// each entry of `all_samples` took. `splats` is as for [`Prepared::render_tile`].
    pub fn render_pixels(
        &self,
        all_samples: &[PixelSamples],
        splats: &Splats,
        xyz: &mut [XyzSum],
        rays: &mut [u64],
    ) -> Counters {
        self.renderer()(self, all_samples, Sums { xyz, stokes: &mut [], bands: &mut [], splats }, rays)
    }

    /// The loop that the plan chose.
    fn renderer(&self) -> RenderPixels {
        let kernel = self.kernel();
        match (self.plan().path_loop.name, self.path_reuse()) {
            (PathLoop::Batch, _) => kernel.render_batch,
            (PathLoop::Scalar, None) => kernel.render_scalar,
            (PathLoop::Scalar, Some(_)) => kernel.render_reused.expect("the plan knows which kernels share paths"),
        }
    }
}
