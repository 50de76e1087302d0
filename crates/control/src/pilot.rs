//! A pilot: a few pixels of a picture rendered beforehand, to tell what the whole will cost.
//!
//! Its samples are other ones than the picture's, whatever its number of samples, and none of them is kept. What it decides
//! is therefore independent of every value in the picture: a picture whose number of samples a pilot chose is as unbiased
//! as one whose number was given. A rule that looked at the picture itself would prefer those in which rare bright paths
//! have not been found.

use crate::cost_estimate::{CostEstimate, PilotPoint, cost_estimate};
use crate::probe::{Probe, Purpose};
use crate::sample_allocation::SampleAllocation;
use etalon_transport::accuracy::ErrorSum;
use etalon_transport::sampler::mix;
use etalon_transport::{Counters, LIGHT_RAY, LightPathsNoise, PixelRect, Prepared, ThreadError};
use std::ops::Range;
use std::sync::Arc;

/// Pixels that a pilot begins with, if the picture has this many.
const FIRST_PIXELS: u64 = 8192;
/// Relative standard error of the picture's error for which more pixels are taken.
const KNOWN_WELL: f64 = 0.05;
/// Largest share of the picture's pixels that more precision is bought with.
const MOST_OF_PICTURE: f64 = 0.25;
/// Samples a pixel before the error of a pilot's error is believed.
const BELIEVED_FROM: u32 = 16;
/// Camera paths after which a pilot that has found no light looks no further. Light that one path in a million finds would take a
/// million million paths to an error of 1 % in ten thousand pixels.
const PATHS_WITHOUT_LIGHT: u64 = 1 << 22;

/// A pilot under way.
pub struct Pilot<'a> {
    prepared: &'a Prepared,
    rect: PixelRect,
    /// How the picture spreads its samples.
    allocation: Option<Arc<SampleAllocation>>,
    /// Side of the blocks of which each gives one pixel a layer.
    block: u32,
    layers: u32,
    probe: Probe<'a>,
    /// What light paths add to what the probe sees.
    light: Option<LightPathsNoise>,
    samples: u32,
    seconds: f64,
    points: Vec<PilotPoint>,
}

impl<'a> Pilot<'a> {
    /// A pilot for the pixels of `rect`, which take their samples by `allocation` (the same number each if `None`), on this many
    /// threads (all cores if `None`), that has not traced anything yet.
    pub fn new(
        prepared: &'a Prepared,
        rect: PixelRect,
        allocation: Option<Arc<SampleAllocation>>,
        threads: Option<usize>,
    ) -> Result<Self, ThreadError> {
        let block = (rect.area() as f64 / FIRST_PIXELS as f64).sqrt().ceil() as u32;
        let mut pilot = Self {
            prepared,
            rect,
            allocation,
            block: block.max(1),
            layers: 0,
            probe: Probe::new(prepared, Purpose::Pilot, threads)?,
            samples: 0,
            light: prepared.light_paths_noise(rect),
            seconds: 0.0,
            points: Vec::new(),
        };
        while pilot.probe.len() == 0 {
            pilot.add_layer();
        }
        Ok(pilot)
    }

    /// What was seen so far, by the number of samples.
    pub fn points(&self) -> &[PilotPoint] {
        &self.points
    }

    /// Seconds spent so far, by `clock`.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Pixels that it traces, as a part of the picture's: so much of the picture's time a pilot takes that goes on to the
    /// picture's own number of samples.
    pub fn share_of_pixels(&self) -> f64 {
        self.probe.len() as f64 * f64::from(self.probe.copies()) / self.rect.area() as f64
    }

    /// Fewest samples a pixel that give every replicate one.
    pub fn first_step(&self) -> u32 {
        self.probe.replicates()
    }

    /// Whether it has traced this many paths without finding light that it looks no further.
    pub fn found_no_light(&self) -> bool {
        self.gave_up(&self.error())
    }

    fn gave_up(&self, error: &ErrorSum) -> bool {
        error.relative_rmse().is_none() && self.probe.paths() >= PATHS_WITHOUT_LIGHT
    }

    /// Camera paths traced.
    pub fn paths(&self) -> u64 {
        self.probe.paths()
    }

    /// Goes on to `samples` a pixel, and takes more pixels where the error is not known well. `clock` tells seconds.
    pub fn advance(&mut self, samples: u32, clock: &(dyn Fn() -> f64 + Sync), on_work: &(dyn Fn(&Counters) + Sync)) {
        let start = clock();
        self.trace(0, self.samples..samples, on_work);
        self.samples = samples;
        let mut error = self.error();
        let most = MOST_OF_PICTURE * self.rect.area() as f64;
        while samples >= BELIEVED_FROM
            && self.uncertainty(&error) > KNOWN_WELL
            && 2.0 * self.probe.len() as f64 <= most
            && !self.gave_up(&error)
        {
            let first = self.probe.len();
            // Twice the pixels: what they cost is bounded by what was spent already.
            for _ in 0..self.layers {
                self.add_layer();
            }
            self.trace(first, 0..samples, on_work);
            error = self.error();
        }
        self.seconds += clock() - start;
        let copies = f64::from(self.probe.copies());
        let rate = self.seconds / self.probe.paths() as f64;
        let ray = self.seconds / self.probe.rays() as f64;
        let replicates = self.probe.replicates();
        let (paths, most) = match &self.allocation {
            None => (u64::from(samples) * self.rect.area(), samples),
            Some(allocation) => {
                (allocation.paths(samples, replicates), allocation.least_and_most(samples, replicates)[1])
            }
        };
        // Light paths are traced for the tile that takes the most samples.
        let of_light = self.light.map_or(0.0, |light| ray * LIGHT_RAY * light.rays * f64::from(most));
        self.points.push(PilotPoint {
            samples,
            relative_rmse: error.relative_rmse().unwrap_or(f64::INFINITY) * copies.sqrt(),
            uncertainty: self.uncertainty(&error),
            seconds: rate * paths as f64 + of_light,
        });
    }

    /// Relative standard error of the picture's error: the scatter of replicates, and what the pixels left out may hide.
    fn uncertainty(&self, error: &ErrorSum) -> f64 {
        let (chance, both) = (error.uncertainty().powi(2), error.uncertainty_of_choice().powi(2));
        if !chance.is_finite() {
            return f64::INFINITY;
        }
        let left_out = 1.0 - (self.probe.len() as f64 / self.rect.area() as f64).min(1.0);
        (chance + (both - chance).max(0.0) * left_out).sqrt()
    }

    /// One pixel more of each block: every pixel of the picture is as likely as any other.
    fn add_layer(&mut self) {
        let (block, area) = (u64::from(self.block), u64::from(self.block) * u64::from(self.block));
        // Odd and near the golden section of the block; layers that meet a cell again only cost time.
        let stride = (area as f64 * 0.618) as u64 | 1;
        let rect = self.rect;
        let (seed, layer) = (mix(self.prepared.scene().integrator.seed), u64::from(self.layers));
        let corners = (rect.y0..rect.y1)
            .step_by(self.block as usize)
            .flat_map(|y0| (rect.x0..rect.x1).step_by(block as usize).map(move |x0| (x0, y0)));
        self.probe.add(corners.filter_map(|(x0, y0)| {
            let at = mix(seed ^ (u64::from(y0) << 32 | u64::from(x0)));
            let cell = (at % area + stride * layer) % area;
            let (x, y) = (x0 + (cell % block) as u32, y0 + (cell / block) as u32);
            (x < rect.x1 && y < rect.y1).then_some((x, y))
        }));
        self.layers += 1;
    }

    /// Traces the samples `samples` of the pixels from number `first` on.
    fn trace(&mut self, first: usize, samples: Range<u32>, on_work: &(dyn Fn(&Counters) + Sync)) {
        let Self { probe, allocation, .. } = self;
        let replicates = probe.replicates();
        match allocation {
            None => probe.trace(first, |_, _| samples.clone(), on_work),
            Some(allocation) => {
                let up_to = |x, y, mean| allocation.samples(x, y, mean, replicates);
                probe.trace(first, |x, y| up_to(x, y, samples.start)..up_to(x, y, samples.end), on_work);
            }
        }
    }

    fn error(&self) -> ErrorSum {
        let mut error = ErrorSum::default();
        self.probe.seen().for_each(|seen| error.push(seen.pixel));
        match self.light {
            None => error,
            Some(light) => error.with(light.y, light.variance / f64::from(self.samples.max(1) * self.probe.copies())),
        }
    }

    /// The price of a relative error, from what was seen so far.
    pub fn cost_estimate(&self, relative_rmse: f64) -> CostEstimate {
        cost_estimate(&self.points, relative_rmse, self.prepared.scene().integrator.sampler, self.first_step())
    }
}
