//! The one way in which samples enter a film.

use crate::film::{Counters, NonFinite, Sums};
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::scene::prepare::Prepared;
use crate::wavelength::Wavelengths;
use etalon_optics::Lanes;
use etalon_scene::Bands;

/// One sample of one pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SampleId {
    /// Number of the pixel among those whose sums are kept.
    pub pixel_samples: usize,
    pub x: u32,
    pub y: u32,
    pub sample: u32,
}

/// What a path brings to the camera, beside its colour.
#[derive(Clone, Copy)]
pub(crate) struct Received<const N: usize> {
    pub wavelengths: Wavelengths<N>,
    pub radiance: Lanes<f64, N>,
    /// S₁, S₂ and S₃, where polarisation is followed.
    pub stokes: Option<[Lanes<f64, N>; 3]>,
}

impl<const N: usize> Received<N> {
    /// No light.
    pub(crate) const NOTHING: Self =
        Self { wavelengths: Wavelengths::fixed([0.0; N]), radiance: Lanes::ZERO, stokes: None };

    /// Unpolarised light.
    pub(crate) fn unpolarised(wavelengths: Wavelengths<N>, radiance: Lanes<f64, N>) -> Self {
        Self { wavelengths, radiance, stokes: None }
    }
}

/// Adds samples to sums: of colour, and of Stokes parameters and bands where these are kept.
pub(crate) struct FilmEntry<'a> {
    prepared: &'a Prepared,
    sums: Sums<'a>,
    /// Rays of all kinds that each pixel took; empty if nobody asks.
    rays: &'a mut [u64],
    replicates: usize,
    /// The bands of the film, and how many sums each replicate has for them, if they are kept.
    bands: Option<(&'a Bands, usize)>,
}

impl<'a> FilmEntry<'a> {
    pub(crate) fn new(prepared: &'a Prepared, sums: Sums<'a>, rays: &'a mut [u64]) -> Self {
        let replicates = prepared.scene.integrator.replicates as usize;
        let per_replicate = sums.bands.len() / sums.xyz.len().max(1);
        let bands = prepared.scene.film.bands.as_ref().filter(|_| per_replicate > 0);
        Self { prepared, sums, rays, replicates, bands: bands.map(|bands| (bands, per_replicate)) }
    }

    /// Whether [`FilmEntry::add`] needs what was received beside its colour.
    pub(crate) fn keeps_bands(&self) -> bool {
        self.bands.is_some()
    }

    /// Counts rays of all kinds for a pixel.
    #[inline(always)]
    pub(crate) fn count_rays(&mut self, pixel_samples: usize, rays: u64) {
        if let Some(of_pixel_samples) = self.rays.get_mut(pixel_samples) {
            *of_pixel_samples += rays;
        }
    }

    /// Adds one sample, whose colour in CIE XYZ is `xyz`, to its replicate. A sample that is not finite is counted and located instead.
    #[inline(always)]
    pub(crate) fn add<M: WavelengthModel<N>, const N: usize>(
        &mut self,
        id: SampleId,
        mut xyz: [f64; 3],
        received: &Received<N>,
        counters: &mut Counters,
    ) {
        counters.paths += 1;
        let weight = self.prepared.filter_weight(id.x, id.y, id.sample);
        if let Some(weight) = weight {
            xyz = xyz.map(|v| v * weight);
        }
        // These come with the filter's weight.
        if let Some(of_light_paths) = self.sums.splats.of(id.x, id.y, id.sample) {
            (0..3).for_each(|c| xyz[c] += of_light_paths[c]);
        }
        let stokes_xyz =
            received.stokes.map(|stokes| stokes.map(|s| M::to_xyz(self.prepared, &received.wavelengths, s)));
        let weight = weight.unwrap_or(1.0);
        let finite = |xyz: [f64; 3]| xyz.iter().all(|v| v.is_finite());
        if !(finite(xyz) && stokes_xyz.is_none_or(|stokes| stokes.into_iter().all(finite))) {
            counters.record_nonfinite(NonFinite { y: id.y, x: id.x, sample: id.sample });
            return;
        }
        let replicate = id.pixel_samples * self.replicates + id.sample as usize % self.replicates;
        self.sums.xyz[replicate].add(xyz);
        if let (Some(stokes), Some(sum)) = (stokes_xyz, self.sums.stokes.get_mut(replicate)) {
            (0..3).for_each(|s| (0..3).for_each(|c| sum[s][c] += stokes[s][c] * weight));
        }
        if let Some((bands, per_replicate)) = self.bands {
            let per_parameter = per_replicate / self.prepared.band_parameters() as usize;
            let sums = &mut self.sums.bands[replicate * per_replicate..][..per_replicate];
            let parameters = std::iter::once(received.radiance).chain(received.stokes.into_iter().flatten());
            for (sums, parameter) in sums.chunks_exact_mut(per_parameter).zip(parameters) {
                M::to_bands(bands, &received.wavelengths, parameter * weight, sums);
            }
        }
    }
}
