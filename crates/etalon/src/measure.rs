//! Readings of a scene's meters: irradiance, flux and radiance, each with its standard error.

use std::sync::atomic::{AtomicBool, Ordering};

use etalon_optics::colour::{LUMINOUS_EFFICACY, cie_y_integral_nm};
use etalon_scene::{Meter, Receiver, Scene};
use etalon_transport::{Control, Extent, Film, PrepareError, Prepared, Study, prepare_study};

use crate::error::RenderError;

/// Independent replicates of each reading. Their scatter is the standard error: with 32 it is known to 13 %.
pub const METER_REPLICATES: u32 = 32;

/// Most samples of a reading where an error is to be reached.
pub const MOST_METER_SAMPLES: u32 = 1 << 26;

/// A reading below this share of the mean of its meter's readings is held to the error of a reading of that share. A cell of a grid where
/// hardly any light arrives would otherwise decide how long all are measured.
const DARK: f64 = 0.01;

/// Why no meter can be read.
#[derive(Debug, thiserror::Error)]
pub enum MeterError {
    /// There is none.
    #[error("the scene has no meters")]
    NoMeters,
    /// The scene cannot be prepared.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
}

/// How meters are read. The first limit that is reached ends it.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasureSettings {
    /// Most samples of each reading, all replicates together; rounded up to a multiple of [`METER_REPLICATES`].
    pub samples: u32,
    /// The standard error that is enough, relative to the reading, in both units; `None` takes all samples.
    pub error: Option<f64>,
    /// Threads; all cores if not given. The readings are the same for any number.
    pub threads: Option<usize>,
}

/// A number and its standard error, in the same unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured {
    /// The mean over the replicates.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
}

impl Measured {
    fn of(replicates: &[f64]) -> Self {
        let count = replicates.len() as f64;
        let value = replicates.iter().sum::<f64>() / count;
        let scatter: f64 = replicates.iter().map(|r| (r - value) * (r - value)).sum();
        Self { value, error: (scatter / (count * (count - 1.0))).sqrt() }
    }
}

/// One reading of a meter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Number of the meter in the scene.
    pub meter: usize,
    /// Column and row of the cell of a grid, the first edge along its rows; else both 0.
    pub cell: [u32; 2],
    /// Where it is taken, m; of flux the middle of the parallelogram.
    pub position_m: [f64; 3],
    /// Over all wavelengths that are rendered: W·m⁻², W or W·m⁻²·sr⁻¹.
    pub radiometric: Measured,
    /// lx, lm or cd·m⁻².
    pub photometric: Measured,
}

/// The readings of all meters of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// In the order of the meters; cells of a grid row by row.
    pub readings: Vec<Reading>,
    /// Samples that each reading has.
    pub samples: u32,
    /// Whether the error that was asked for is reached; true if none was.
    pub reached: bool,
    /// Whether whoever watched wanted no more.
    pub interrupted: bool,
    /// Samples that were left out because they were not finite.
    pub nonfinite: u64,
}

/// A scene whose meters are ready to be read.
pub struct MeterReader {
    prepared: Prepared,
    meters: Vec<Meter>,
    range_nm: [f64; 2],
}

impl std::fmt::Debug for MeterReader {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MeterReader").field("meters", &self.meters).finish_non_exhaustive()
    }
}

impl MeterReader {
    /// Prepares a scene for its meters.
    ///
    /// # Errors
    /// If the scene has no meters, or cannot be prepared.
    pub fn new(scene: &Scene, study: &Study) -> Result<Self, MeterError> {
        let measured = scene.measured(METER_REPLICATES).ok_or(MeterError::NoMeters)?;
        let prepared = prepare_study(&measured, study)?;
        Ok(Self { prepared, meters: scene.meters.clone(), range_nm: scene.integrator.wavelength_range_nm })
    }

    /// The scene as it is measured, with its plan.
    pub fn prepared(&self) -> &Prepared {
        &self.prepared
    }

    /// Reads the meters. `control` is asked after each tile of work whether to go on.
    ///
    /// The number of samples is doubled until every reading has the error that is asked for. So the readings decide when they end; with 32
    /// replicates and a handful of decisions that moves a reading by far less than its error.
    ///
    /// # Errors
    /// If a setting makes no sense, and if there are no threads.
    pub fn read(
        &self,
        settings: &MeasureSettings,
        control: &(dyn Fn() -> Control + Sync),
    ) -> Result<Measurement, RenderError> {
        if settings.samples == 0 {
            return Err(RenderError::Setting("a reading needs at least one sample".to_owned()));
        }
        if settings.error.is_some_and(|error| error <= 0.0 || error.is_nan()) {
            return Err(RenderError::Setting("the error of a reading is above 0".to_owned()));
        }
        let most = settings.samples.div_ceil(METER_REPLICATES);
        let mut film = self.prepared.film();
        let mut done = 0;
        let mut next = if settings.error.is_some() { most.min(16) } else { most };
        let stopped = AtomicBool::new(false);
        loop {
            let extent = Extent { samples: done..next, ..self.prepared.whole(settings.threads) };
            self.prepared.render_onto(&mut film, &extent, &|_| {
                let control = control();
                stopped.fetch_or(control == Control::Stop, Ordering::Relaxed);
                control
            })?;
            let interrupted = stopped.load(Ordering::Relaxed);
            done = next;
            let readings = self.readings(&film);
            let reached = settings.error.is_none_or(|error| self.all_within(&readings, error));
            if reached && settings.error.is_some() || done == most || interrupted {
                let (samples, nonfinite) = (done * METER_REPLICATES, film.counters.nonfinite);
                return Ok(Measurement { readings, samples, reached, interrupted, nonfinite });
            }
            next = done.saturating_mul(2).min(most);
        }
    }

    fn readings(&self, film: &Film) -> Vec<Reading> {
        let band_factor = self.prepared.band_factors().map_or(1.0, |factors| factors[0]);
        let width_nm = self.range_nm[1] - self.range_nm[0];
        let of_y = LUMINOUS_EFFICACY * cie_y_integral_nm();
        let mut column = 0;
        let mut readings = Vec::with_capacity(film.width() as usize);
        for (number, meter) in self.meters.iter().enumerate() {
            let factor = meter.kind.factor();
            let columns = meter.kind.columns();
            for (cell, receiver) in meter.kind.receivers().iter().enumerate() {
                let rows = 0..film.height();
                let of_rows = |of: &dyn Fn(u32) -> f64| Measured::of(&rows.clone().map(of).collect::<Vec<_>>());
                let radiance = |row| film.band(column, row, 0).radiance * (band_factor * width_nm * factor);
                let luminance = |row| film.pixel(column, row).xyz()[1] * (of_y * factor);
                let cell = cell as u32;
                readings.push(Reading {
                    meter: number,
                    cell: [cell % columns, cell / columns],
                    position_m: middle(receiver),
                    radiometric: of_rows(&radiance),
                    photometric: of_rows(&luminance),
                });
                column += 1;
            }
        }
        readings
    }

    fn all_within(&self, readings: &[Reading], error: f64) -> bool {
        let mut sums = vec![([0.0; 2], 0.0); self.meters.len()];
        for reading in readings {
            let (sum, count) = &mut sums[reading.meter];
            sum[0] += reading.radiometric.value;
            sum[1] += reading.photometric.value;
            *count += 1.0;
        }
        readings.iter().all(|reading| {
            let (sum, count) = sums[reading.meter];
            let within =
                |measured: Measured, sum: f64| measured.error <= error * measured.value.abs().max(DARK * sum / count);
            within(reading.radiometric, sum[0]) && within(reading.photometric, sum[1])
        })
    }
}

/// The middle of a receiver, m.
fn middle(receiver: &Receiver) -> [f64; 3] {
    match receiver {
        Receiver::Plane { origin_m, edges_m: [u, v], .. } => {
            std::array::from_fn(|k| origin_m[k] + 0.5 * u[k] + 0.5 * v[k])
        }
        Receiver::Cone { position_m, .. } => *position_m,
    }
}
