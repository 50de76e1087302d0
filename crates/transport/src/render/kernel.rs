//! The kernels: the integrator instantiated for a model of wavelengths and of polarisation, and the table that names them.

use crate::batch::render_batch;
use crate::film::{Counters, PixelRect, Sums};
use crate::guiding::{NO_TARGETS, SpecularObjects};
use crate::integrator::Path;
use crate::integrator::connection_trial::{ConnectionTrial, try_connections};
use crate::integrator::film_entry::{FilmEntry, SampleId};
use crate::integrator::light_choice_trial::{LightChoiceTrial, try_light_choice};
use crate::integrator::light_tracing::trial::{CameraTrial, try_camera_paths};
use crate::integrator::light_tracing::{Connection, trace_light_path};
use crate::integrator::replay::{Replay, replay};
use crate::integrator::reuse;
use crate::integrator::tracer::{PixelSamples, Tracer};
use crate::integrator::trial::{Trial, try_guided_targets};
use crate::integrator::wavelength_lanes::{Hero, OneLane, Shared, ThreeChannels, WavelengthModel};
use crate::integrator::wavelength_trial::{WavelengthTrial, try_wavelengths};
use crate::plan::kernels::{self, KernelKind, LANES};
use crate::polarisation::{Averaged, Followed, Polarisation};
use crate::scene::prepare::Prepared;
use crate::wavelength::guide::Regions;
use etalon_scene::LightSampling;
use std::ops::Range;

/// Adds samples to the sums of pixels: pixel by pixel, and in each pixel replicate by replicate. Where the last slice is not empty, adds
/// to it the rays that each pixel took.
pub(crate) type RenderPixels = fn(&Prepared, &[PixelSamples], Sums<'_>, &mut [u64]) -> Counters;

/// Follows the light paths of some numbers, of so many, of one sample, with random numbers of a seed. What each brings to the pixels of a rectangle
/// is given to the last.
pub(crate) type TraceLightPaths = fn(
    &Prepared,
    &SpecularObjects,
    u64,
    (Range<u64>, u64),
    (u32, PixelRect),
    &mut Counters,
    &mut dyn FnMut(Connection),
);

/// The path loop for one model of wavelengths.
pub(crate) struct Kernel {
    pub kind: &'static KernelKind,
    /// One path at a time.
    pub render_scalar: RenderPixels,
    /// Many at once: the same, bit for bit.
    pub render_batch: RenderPixels,
    /// One path at a time where neighbouring pixels share paths, if they can.
    pub render_reused: Option<RenderPixels>,
    /// Traces a sample once more and tells what happened. Takes the column and row of its pixel, and its number.
    pub replay: fn(&Prepared, u32, u32, u32) -> Replay,
    /// Tells how often each light is worth a shadow ray. Takes the seed of its random numbers, how light is sampled if not as the scene says, how
    /// many pixels, and the samples of each.
    pub try_light_choice: fn(&Prepared, u64, Option<LightSampling>, (u64, u32)) -> LightChoiceTrial,
    /// Tells what guided targets of caustics would win, by a trial with random numbers of a seed.
    pub try_guided_targets: fn(&Prepared, u64) -> Trial,
    /// Tells what specular connections bring and take, by a trial with random numbers of a seed.
    pub try_connections: fn(&Prepared, u64) -> ConnectionTrial,
    /// Follows some light paths of a sample, with random numbers of a seed.
    pub trace_light_paths: TraceLightPaths,
    /// Tells what camera paths come to, by a trial with random numbers of a seed.
    pub try_camera_paths: fn(&Prepared, u64) -> CameraTrial,
    /// Tells which wavelengths bring light in each region. Takes the seed of its random numbers, and the samples of each region.
    pub try_wavelengths: fn(&Prepared, u64, Regions, u32) -> WavelengthTrial,
}

/// The whole table. Everything else is a run-time branch.
static KERNELS: [Kernel; 8] = [
    with_reuse::<OneLane, 1>(&kernels::ONE_LANE),
    with_reuse::<Shared, LANES>(&kernels::SHARED),
    with_reuse::<Hero<LANES>, LANES>(&kernels::HERO),
    entry::<Shared, Followed<LANES>, LANES>(&kernels::POLARISED_SHARED),
    entry::<Hero<LANES>, Followed<LANES>, LANES>(&kernels::POLARISED_HERO),
    entry::<Hero<1>, Averaged, 1>(&kernels::ONE_WAVELENGTH),
    entry::<Hero<4>, Averaged, 4>(&kernels::FOUR_WAVELENGTHS),
    entry::<ThreeChannels, Averaged, 3>(&kernels::THREE_CHANNELS),
];

const fn entry<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(kind: &'static KernelKind) -> Kernel {
    Kernel {
        kind,
        render_scalar: render_scalar::<M, P, N>,
        render_batch: render_batch::<M, P, N>,
        render_reused: None,
        replay: replay::<M, P, N>,
        try_light_choice: try_light_choice::<M, P, N>,
        try_guided_targets: try_guided_targets::<M, P, N>,
        try_connections: try_connections::<M, P, N>,
        trace_light_paths: trace_light_paths::<M, P, N>,
        try_camera_paths: try_camera_paths::<M, P, N>,
        try_wavelengths: try_wavelengths::<M, P, N>,
    }
}

/// One whose pixels can share paths.
const fn with_reuse<M: WavelengthModel<N>, const N: usize>(kind: &'static KernelKind) -> Kernel {
    Kernel { render_reused: Some(reuse::render_pixels::<M, N>), ..entry::<M, Averaged, N>(kind) }
}

impl Prepared {
    /// The kernel that the plan chose.
    pub(crate) fn kernel(&self) -> &'static Kernel {
        KERNELS.iter().find(|kernel| kernel.kind.name == self.plan().kernel).expect("each kind has a kernel")
    }
}

fn trace_light_paths<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
    prepared: &Prepared,
    specular_objects: &SpecularObjects,
    seed: u64,
    (numbers, of): (Range<u64>, u64),
    of_sample: (u32, PixelRect),
    counters: &mut Counters,
    put: &mut dyn FnMut(Connection),
) {
    let mut tracer = Tracer::new(prepared);
    tracer.seed = seed;
    // A direction toward what throws light is of no use to light itself.
    tracer.world.guided_targets = &NO_TARGETS;
    let mut path = Path::<M, P, N>::idle();
    for number in numbers {
        trace_light_path(&tracer, &mut path, specular_objects, (number, of), of_sample, counters, put);
    }
}

/// The samples of some pixels, one path at a time, added to `sums` in the order of their numbers.
fn render_scalar<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
    prepared: &Prepared,
    all_samples: &[PixelSamples],
    sums: Sums<'_>,
    rays: &mut [u64],
) -> Counters {
    let tracer = Tracer::new(prepared);
    let mut counters = Counters::default();
    let mut film = FilmEntry::new(prepared, sums, rays);
    for (number, pixel_samples) in all_samples.iter().enumerate() {
        let before = counters.rays + counters.shadow_rays;
        for sample in pixel_samples.samples.clone() {
            let path = tracer.sample::<M, P, N>(pixel_samples.x, pixel_samples.y, sample, &mut counters, &mut ());
            let received = path.received();
            let xyz = M::to_xyz(prepared, &received.wavelengths, received.radiance);
            film.add::<M, N>(
                SampleId { pixel_samples: number, x: pixel_samples.x, y: pixel_samples.y, sample },
                xyz,
                &received,
                &mut counters,
            );
        }
        film.count_rays(number, counters.rays + counters.shadow_rays - before);
    }
    counters
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_has_one_kernel_with_as_many_lanes() {
        for kind in kernels::ALL {
            let of_kind: Vec<_> = KERNELS.iter().filter(|kernel| kernel.kind.name == kind.name).collect();
            assert_eq!(of_kind.len(), 1, "{}", kind.name);
            assert_eq!(of_kind[0].render_reused.is_some(), kind.shares_paths, "{}", kind.name);
        }
        assert_eq!(KERNELS.len(), kernels::ALL.len());
    }
}
