//! Many paths at once: the path loop of [`path`](crate::path) for [`W`](rows::W) paths side by side.
//!
//! The plain loop is the specification; this one gives its film and its counts bit for bit, for the scenes that it covers
//! ([`hindrance`]). What is geometry is kept as rows, one number a path, and each step of it is a loop over the paths that the compiler
//! turns into vector instructions ([`level`]); what wavelengths carry is kept path by path, whose lanes are vectors already. Spectra
//! are evaluated once for each path ([`tables`]). A path that ends makes room for the next sample ([`stream`]).
//! Whatever has no row form, such as rough metals or lights other than flat ones, is asked path by path of the very functions
//! of the plain loop.

mod blocks;
mod casters;
mod direct;
mod lamps;
mod level;
mod paths;
mod rows;
mod scatter;
mod starts;
mod stream;
mod surface;
mod tables;
#[cfg(test)]
mod tests;

use crate::film::{Counters, Sums};
use crate::film_entry::{FilmEntry, Received};
use crate::kernel::{Spot, Tracer};
use crate::model::WavelengthModel;
use crate::path::World;
use crate::plan::EffectName;
use crate::prepare::Prepared;
use crate::reuse::Blocks;
use crate::wavelength::Wavelengths;
use blocks::Dealing;
use casters::Casting;
use direct::Sight;
use etalon_optics::Lanes;
use level::{Level, stages};
use paths::Paths;
use rows::{Mask, W, lanes};
use starts::Starts;
use stream::{Cursor, Window};
pub(crate) use tables::Tables;

/// Why the engine does not cover a scene with these effects; `None` if it does.
pub(crate) fn hindrance(runs: impl Fn(EffectName) -> bool) -> Option<&'static str> {
    match () {
        () if runs(EffectName::Polarisation) => Some("light is followed with its polarisation"),
        () if runs(EffectName::NestedDielectrics) => Some("dielectrics are nested"),
        () if runs(EffectName::Absorption) => Some("media absorb"),
        () if runs(EffectName::Motion) => Some("something moves while the shutter is open"),
        () if runs(EffectName::Masks) => Some("surfaces let paths pass"),
        () => None,
    }
}

/// The samples of spots, added to `sums` spot by spot in the order of their numbers, and the rays that each spot took to `rays`,
/// unless that is empty.
pub(crate) fn render_spots_lanes<M: WavelengthModel<N>, const N: usize>(
    prepared: &Prepared,
    spots: &[Spot],
    sums: Sums<'_>,
    rays: &mut [u64],
) -> Counters {
    render_on::<M, N>(Level::best(), prepared, spots, sums, rays)
}

fn render_on<M: WavelengthModel<N>, const N: usize>(
    level: Level,
    prepared: &Prepared,
    spots: &[Spot],
    sums: Sums<'_>,
    rays: &mut [u64],
) -> Counters {
    let tracer = Tracer::new(prepared);
    let film = &prepared.scene.film;
    let blocks = prepared.path_reuse().map(|block| Blocks::of(spots, block, [film.width, film.height]));
    let cursor = match &blocks {
        None => Cursor::new(spots, &[]),
        Some(blocks) => Cursor::new(&blocks.spots, &blocks.mates),
    };
    // Where paths are shared, others than those that end there add to the sums.
    let nothing = Sums { xyz: &mut [], stokes: &mut [], bands: &mut [] };
    let (dealing, finished) = match &blocks {
        None => (None, Finished::new(cursor.clone(), prepared, sums, rays)),
        Some(blocks) => (
            Some(Dealing::new(blocks, cursor.window(), prepared, sums, rays)),
            Finished::new(cursor.clone(), prepared, nothing, &mut []),
        ),
    };
    let mut engine = Engine::<M, N> {
        prepared,
        world: &tracer.world,
        tables: &prepared.tables,
        level,
        counters: Counters::default(),
        paths: Paths::new(tracer.sampler(0, 0, 0), blocks.is_some()),
        sight: Sight::new(),
        casting: Casting::new(),
        seen: [[Lanes::ZERO; 3]; W],
        finished,
        dealing,
    };
    let mut starts = Starts::new(&tracer, cursor);
    trace::<M, N>(level, &mut engine, &mut starts);
    engine.counters
}

stages! {
    /// All samples.
    fn trace [M: WavelengthModel<N>, const N: usize][M, N] (engine: &mut Engine<'_, M, N>, starts: &mut Starts<'_, N>) {
        loop {
            engine.begin(starts);
            if engine.paths.alive == 0 {
                break;
            }
            engine.step();
        }
    }
}

/// Spots under way.
struct Engine<'a, M, const N: usize> {
    prepared: &'a Prepared,
    world: &'a World<'a>,
    tables: &'a Tables,
    level: Level,
    counters: Counters,
    paths: Paths<'a, M, N>,
    sight: Sight<N>,
    /// Directions toward casters of caustics.
    casting: Casting,
    /// What the lanes of paths that ended add to the film.
    seen: [[Lanes<f64, N>; 3]; W],
    finished: Finished<'a, N>,
    /// Where neighbouring pixels share paths.
    dealing: Option<Dealing<'a, N>>,
}

impl<M: WavelengthModel<N>, const N: usize> Engine<'_, M, N> {
    /// Puts the next samples where no path is.
    #[inline(always)]
    fn begin(&mut self, starts: &mut Starts<'_, N>) {
        for lane in lanes(!self.paths.alive & paths::ALL) {
            if !self.finished.window.admits(starts.number()) {
                break;
            }
            if !starts.ready::<M>(self.level, &mut self.counters) {
                break;
            }
            starts.put(lane, &mut self.paths);
        }
    }

    /// Takes every path one vertex further.
    #[inline(always)]
    fn step(&mut self) {
        #[cfg(test)]
        self.spoil();
        let escaped = self.meet();
        let met = self.paths.alive & !escaped;
        self.escape(escaped);
        let (scatters, shared) = self.arrive(met);
        self.direct_light(shared);
        self.scatter(scatters, shared);
        self.end((escaped | met) & !self.paths.alive);
    }

    /// Takes what ended paths have gathered.
    #[inline(always)]
    fn end(&mut self, ended: Mask) {
        if self.paths.shares {
            return self.end_shared(ended);
        }
        // In two loops, of which the first becomes vector instructions.
        for lane in lanes(ended) {
            self.seen[lane] = M::seen(self.prepared, &self.paths.wavelengths[lane], self.paths.radiance[lane]);
        }
        for lane in lanes(ended) {
            let xyz = self.seen[lane].map(Lanes::sum);
            let rays = self.paths.vertex[lane] + 1 + self.paths.shadow_rays[lane];
            let (wavelengths, radiance) = (&self.paths.wavelengths[lane], self.paths.radiance[lane]);
            self.finished.put(self.paths.number[lane], (xyz, rays), wavelengths, radiance);
        }
        if ended != 0 {
            self.finished.add::<M>(&mut self.counters);
        }
    }
}

/// What finished samples came to, on its way into the sums.
struct Finished<'a, const N: usize> {
    cursor: Cursor<'a>,
    /// Colours, and rays of all kinds.
    window: Window<([f64; 3], u32)>,
    /// What the bands of a film ask of the samples that wait; empty without bands.
    spectral: Vec<Received<N>>,
    film: FilmEntry<'a>,
}

impl<'a, const N: usize> Finished<'a, N> {
    fn new(cursor: Cursor<'a>, prepared: &'a Prepared, sums: Sums<'a>, rays: &'a mut [u64]) -> Self {
        let (size, film) = (cursor.window(), FilmEntry::new(prepared, sums, rays));
        let spectral = if film.keeps_bands() { vec![Received::NOTHING; size] } else { Vec::new() };
        Self { cursor, window: Window::new(size), spectral, film }
    }

    #[inline(always)]
    fn put(&mut self, number: u32, came_to: ([f64; 3], u32), wavelengths: &Wavelengths<N>, radiance: Lanes<f64, N>) {
        if let Some(waiting) = self.spectral.get_mut(self.window.place(number)) {
            *waiting = Received::unpolarised(*wavelengths, radiance);
        }
        self.window.put(number, came_to);
    }

    /// Adds those whose turn it is.
    #[inline(always)]
    fn add<M: WavelengthModel<N>>(&mut self, counters: &mut Counters) {
        while let Some((number, (xyz, rays))) = self.window.take() {
            let id = self.cursor.next().expect("as many samples come back as went out");
            self.film.count_rays(id.spot, rays.into());
            let received = self.spectral.get(self.window.place(number)).unwrap_or(&Received::NOTHING);
            self.film.add::<M, N>(id, xyz, received, counters);
        }
    }
}
