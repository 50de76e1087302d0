//! One scene rendered with many seeds, side by side, and on and on.

use std::sync::Mutex;

use etalon_oracle::truths::Quantity;
use etalon_scene::Scene;
use etalon_transport::{Control, Counters, Extent, Film, PixelRect, Prepared, Study, prepare_study};
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::interrupt::Interrupt;

/// Films of one scene that differ by their seeds alone.
pub(super) struct Series {
    pool: ThreadPool,
    /// The scene, ready to be rendered, once for each thread of the pool.
    prepared: Vec<Prepared>,
    seeds: Vec<u64>,
    films: Vec<Film>,
    /// How many samples the pixels of each film have.
    samples: u32,
}

/// Why a series has no more samples than before.
pub(super) enum Stop {
    /// The program was asked to end.
    Interrupted,
    /// It cannot be rendered.
    Failed(String),
}

impl Series {
    /// Black films, one for each seed.
    pub(super) fn new(scene: &Scene, study: &Study, seeds: Vec<u64>, threads: Option<usize>) -> Result<Self, String> {
        let pool =
            ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build().map_err(|error| error.to_string())?;
        let first = prepare_study(scene, study).map_err(|error| error.to_string())?;
        let prepared = vec![first; pool.current_num_threads()];
        let films = seeds.iter().map(|_| prepared[0].film()).collect();
        Ok(Self { pool, prepared, seeds, films, samples: 0 })
    }

    /// Goes on until each pixel of each film has this many samples: the same films whether at once or in several steps, and on however
    /// many threads.
    pub(super) fn render_to(&mut self, samples: u32, interrupt: &Interrupt) -> Result<(), Stop> {
        let range = self.samples..samples;
        let queue = Mutex::new(self.seeds.iter().zip(&mut self.films));
        let on_tile = |_: &Counters| match interrupt.signal() {
            None => Control::Continue,
            Some(_) => Control::Stop,
        };
        let of_threads: Vec<Mutex<&mut Prepared>> = self.prepared.iter_mut().map(Mutex::new).collect();
        let work = |thread: usize| -> Result<(), Stop> {
            let mut prepared = of_threads[thread].lock().expect("each thread has its own");
            loop {
                let Some((&seed, film)) = queue.lock().expect("nobody panics while taking a film").next() else {
                    return Ok(());
                };
                prepared.reseed(seed);
                // By the threads of this pool: most films are smaller than a tile.
                let extent = Extent { samples: range.clone(), ..prepared.whole(None) };
                prepared.render_onto(film, &extent, &on_tile).map_err(|error| Stop::Failed(error.to_string()))?;
                if interrupt.signal().is_some() {
                    return Err(Stop::Interrupted);
                }
            }
        };
        self.pool.broadcast(|context| work(context.index())).into_iter().collect::<Result<(), Stop>>()?;
        self.samples = samples;
        Ok(())
    }

    /// What a truth reads off each film: the mean of Y, of the Y of a Stokes parameter, or of a band.
    pub(super) fn means(&self, quantity: Quantity, crop_px: Option<[u32; 4]>) -> impl Iterator<Item = f64> {
        let whole = self.prepared[0].whole(None).rect;
        let rect = crop_px.map_or(whole, |[x0, x1, y0, y1]| PixelRect { x0, y0, x1, y1 });
        self.films.iter().map(move |film| match quantity {
            Quantity::Radiance => film.mean_y(rect),
            Quantity::Stokes1 => mean_stokes(film, rect, 0),
            Quantity::Stokes2 => mean_stokes(film, rect, 1),
            Quantity::Stokes3 => mean_stokes(film, rect, 2),
            Quantity::Meters => self.mean_reading(film, rect),
            Quantity::Band(number) => self.mean_of_band(film, rect, number),
        })
    }

    /// Mean radiance over a band of wavelengths, of all that fell into it; not a number where the film keeps no bands.
    fn mean_of_band(&self, film: &Film, rect: PixelRect, number: u32) -> f64 {
        let (band, factor) = match self.prepared[0].band_factors() {
            // One sum stands for all.
            Some(factors) => (0, factors[number as usize]),
            None => (number, 1.0),
        };
        if band >= film.bands() {
            return f64::NAN;
        }
        let (mut sum, mut count) = (0.0, 0.0);
        for (x, y) in rect.pixels() {
            let band = film.band(x, y, band);
            sum += band.radiance * f64::from(band.count);
            count += f64::from(band.count);
        }
        factor * sum / count
    }

    /// Mean over the readings of all meters, in units of the sensor.
    fn mean_reading(&self, film: &Film, rect: PixelRect) -> f64 {
        let meters = &self.prepared[0].scene().meters;
        let factors = meters.iter().flat_map(|meter| (0..meter.kind.reading_count()).map(|_| meter.kind.factor()));
        let factors: Vec<f64> = factors.collect();
        let sum: f64 = rect.pixels().map(|(x, y)| film.pixel(x, y).xyz()[1] * factors[x as usize]).sum();
        sum / rect.area() as f64
    }

    /// The largest throughput of a path that was cut in any film.
    pub(super) fn cut_throughput(&self) -> f64 {
        self.films.iter().map(|film| film.counters.cut_throughput).fold(0.0, f64::max)
    }

    /// A counter in the sum over all films.
    pub(super) fn counted(&self, counter: impl Fn(&Counters) -> u64) -> u64 {
        self.films.iter().map(|film| counter(&film.counters)).sum()
    }
}

/// Mean Y of one of S₁, S₂ and S₃; not a number where the film does not record them.
fn mean_stokes(film: &Film, rect: PixelRect, parameter: usize) -> f64 {
    let y = |(column, row): (u32, u32)| {
        let stokes = film.stokes_rec709(column, row)?;
        let [value, _] = stokes[parameter];
        Some(etalon_optics::colour::rec709_to_xyz(value.map(f64::from))[1])
    };
    let sum: Option<f64> = rect.pixels().map(y).sum();
    sum.map_or(f64::NAN, |sum| sum / rect.area() as f64)
}
