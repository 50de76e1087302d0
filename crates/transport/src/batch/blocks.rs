//! Where neighbouring pixels share paths: what has been gathered waits for the rest of its block, and is dealt out.

use super::Batch;
use super::rows::lanes;
use super::stream::{Cursor, Window};
use crate::film::{Counters, Sums};
use crate::integrator::reuse::{BlockEntry, Blocks, MAX_BLOCK_PIXELS, ReusePath, redistribute};
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::polarisation::Polarisation;
use crate::scene::prepare::Prepared;
use crate::wavelength::Wavelengths;
use etalon_geometry::{Geometry, LANES, Ray, Rays};
use etalon_optics::Lanes;

/// See the module.
pub(super) struct Redistribution<'a, const N: usize> {
    blocks: &'a Blocks,
    adding: BlockEntry<'a>,
    /// By their places in the window.
    waiting: Vec<(ReusePath<N>, Wavelengths<N>)>,
    /// Those of a block whose turn has come, and their rays.
    reuse_path: [ReusePath<N>; MAX_BLOCK_PIXELS],
    rays: [u64; MAX_BLOCK_PIXELS],
    count: usize,
}

impl<'a, const N: usize> Redistribution<'a, N> {
    pub(super) fn new(
        blocks: &'a Blocks,
        size: usize,
        prepared: &'a Prepared,
        sums: Sums<'a>,
        rays: &'a mut [u64],
    ) -> Self {
        let nothing = Wavelengths::fixed([0.0; N]);
        Self {
            blocks,
            adding: BlockEntry::new(prepared, sums, rays),
            waiting: vec![(ReusePath::NOTHING, nothing); size],
            reuse_path: [ReusePath::NOTHING; MAX_BLOCK_PIXELS],
            rays: [0; MAX_BLOCK_PIXELS],
            count: 0,
        }
    }

    /// Deals out the light of each block that is complete.
    #[inline(always)]
    fn add<M: WavelengthModel<N>>(
        &mut self,
        window: &mut Window<([f64; 3], u32)>,
        cursor: &mut Cursor<'_>,
        geometry: &Geometry,
        counters: &mut Counters,
    ) {
        while let Some((number, (_, rays))) = window.take() {
            let place = cursor.next().expect("as many samples come back as went out");
            let (reuse_path, wavelengths) = &self.waiting[window.place(number)];
            self.reuse_path[self.count] = *reuse_path;
            self.rays[self.count] = u64::from(rays);
            self.count += 1;
            let first = place.pixel_samples + 1 - self.count;
            let block_pixels = self.blocks.block_pixels[first];
            if self.count < block_pixels {
                continue;
            }
            self.count = 0;
            let mut radiance = [Lanes::ZERO; MAX_BLOCK_PIXELS];
            let shadow_rays =
                redistribute(&self.reuse_path[..block_pixels], &mut radiance, |rays| occluded(geometry, rays));
            counters.shadow_rays += shadow_rays;
            self.rays[0] += shadow_rays;
            for (mate, pixel) in self.blocks.all_samples[first..][..block_pixels].iter().enumerate() {
                let place = (self.blocks.kept[first + mate], pixel.x, pixel.y, place.sample);
                self.adding.add::<M, N>(place, self.rays[mate], wavelengths, radiance[mate], counters);
            }
        }
    }
}

/// Which of some rays are cut off, eight at a time.
#[inline(always)]
fn occluded(geometry: &Geometry, rays: &[Ray<f64>]) -> u64 {
    let mut hidden = 0;
    for (group, rays) in rays.chunks(LANES).enumerate() {
        // Lanes without a ray repeat the last, and are not asked.
        let of = |lane: usize| &rays[lane.min(rays.len() - 1)];
        let (mut origin, mut direction) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        for lane in 0..LANES {
            let (from, along) = (of(lane).origin.to_array(), of(lane).direction.to_array());
            for axis in 0..3 {
                (origin[axis][lane], direction[axis][lane]) = (from[axis], along[axis]);
            }
        }
        let packed = Rays {
            origin,
            direction,
            t_max: std::array::from_fn(|lane| of(lane).t_max),
            leaves: std::array::from_fn(|lane| of(lane).leaves),
            aims_at: std::array::from_fn(|lane| of(lane).aims_at),
        };
        let active = ((1_u16 << rays.len()) - 1) as u8;
        hidden |= u64::from(geometry.any_hits(&packed, active)) << (group * LANES);
    }
    hidden
}

impl<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Batch<'_, M, P, N> {
    /// Takes what ended paths have gathered.
    #[inline(always)]
    pub(super) fn end_shared(&mut self, ended: super::rows::Mask) {
        let Some(redistribution) = &mut self.redistribution else { return };
        let finished = &mut self.finished;
        for lane in lanes(ended) {
            let number = self.paths.number[lane];
            let path = &self.paths.paths[lane];
            self.paths.reuse_path[lane].end(path.radiance);
            redistribution.waiting[finished.window.place(number)] = (self.paths.reuse_path[lane], path.wavelengths);
            finished.window.put(number, ([0.0; 3], self.paths.ray_count[lane]));
        }
        if ended != 0 {
            redistribution.add::<M>(
                &mut finished.window,
                &mut finished.cursor,
                self.world.geometry,
                &mut self.counters,
            );
        }
    }
}
