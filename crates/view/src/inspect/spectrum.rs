//! The spectrum of a pixel with its errors: from the bands of the picture, or from paths of that pixel traced for it alone.

use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use etalon::KeptBands;
use etalon_picture::develop::{BandMean, Rect, spectrum_of};
use etalon_scene::{Bands, Scene};
use etalon_transport::{Film, PixelRect, Prepared, Splats, Study, TileSums, prepare_frame};
use serde::Serialize;

use crate::live::status::Phase;
use crate::live::{Live, Stage};
use crate::picture::Snapshot;

/// Width of a band, nm, and what the eye sees of the wavelengths that are rendered, nm.
const STEP_NM: f64 = 10.0;
/// See [`STEP_NM`].
const SEEN_NM: [f64; 2] = [380.0, 730.0];
/// Samples of a first answer, and at most.
pub(crate) const SAMPLES: [u32; 2] = [256, 1 << 16];
/// Seconds after which no more samples are begun.
const MOST_S: f64 = 0.25;

/// The mean radiance of a band.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct BandInfo {
    /// Centre, nm.
    pub centre_nm: f64,
    /// W·m⁻²·sr⁻¹·nm⁻¹ in our pictures, else the unit of the file.
    pub radiance: f64,
    /// Standard error; `null` where it is unknown.
    pub error: Option<f64>,
}

/// The spectrum of a pixel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Spectrum {
    /// Bands by increasing wavelength.
    pub bands: Vec<BandInfo>,
    /// Paths that were traced for it; `None` if it is that of the picture.
    pub samples: Option<u32>,
    /// Seconds that they took.
    pub seconds: f64,
}

/// The spectrum that a picture holds; `None` if it holds none.
pub(crate) fn of_picture(snapshot: &Snapshot, at: [u32; 2]) -> Option<Spectrum> {
    let index = snapshot.pixel_of(at)?;
    let [width, _] = snapshot.size();
    let rect = Rect { x: index % width, y: index / width, width: 1, height: 1 };
    let bands = spectrum_of(&snapshot.file, rect).ok()?;
    let info = |band: &BandMean| BandInfo {
        centre_nm: band.centre_nm,
        radiance: band.mean,
        error: band.error.filter(|error| error.is_finite()),
    };
    Some(Spectrum { bands: bands.iter().map(info).collect(), samples: None, seconds: 0.0 })
}

/// A second scene that keeps bands, and the pixel that was asked for last.
#[derive(Default)]
pub(crate) struct SpectralProbe {
    kept: Mutex<Option<Kept>>,
}

struct Kept {
    stage: u64,
    prepared: Prepared,
    bands: KeptBands,
    under_way: Option<UnderWay>,
}

/// The sums of one pixel, which further questions add to.
struct UnderWay {
    at: [u32; 2],
    sums: TileSums,
    samples: u32,
    seconds: f64,
}

impl SpectralProbe {
    /// The spectrum of a pixel by this many paths, or as many as there is time for; asked again, it goes on. A render under way pays for
    /// few paths only.
    ///
    /// # Errors
    /// A sentence that says why there is none.
    pub(crate) fn ask(&self, live: &Live, at: [u32; 2], samples: u32) -> Result<Spectrum, String> {
        let mut place = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let origin = not_kept(live, place.as_ref())?;
        live.overhead.probe(|| -> Result<Spectrum, String> {
            if let Some(origin) = origin {
                let earlier = place.take().map(|kept| kept.prepared);
                *place = Some(Kept::new(origin, earlier)?);
            }
            let kept = place.as_mut().ok_or("the scene is not ready")?;
            let most_s = if may_go_on(live) { MOST_S } else { 0.0 };
            Ok(kept.spectrum(at, samples, most_s))
        })
    }
}

/// What a scene with bands of the stage under way is prepared from; `None` if it is kept. The lock of the stage is not held for long: the
/// next stage waits for it.
fn not_kept(live: &Live, kept: Option<&Kept>) -> Result<Option<Origin>, String> {
    let stage = live.stage.read().unwrap_or_else(PoisonError::into_inner);
    let stage = stage.as_ref().ok_or("the scene is not ready")?;
    let is_kept = kept.is_some_and(|kept| kept.stage == stage.number);
    Ok((!is_kept).then(|| Origin::of(stage)))
}

/// Whether there is time for more than the first paths of a pixel.
fn may_go_on(live: &Live) -> bool {
    let is_idle = matches!(live.seen().status.phase, Phase::Done | Phase::Paused);
    is_idle || live.overhead.may_probe()
}

/// What a scene with bands is prepared from.
struct Origin {
    stage: u64,
    scene: Scene,
    study: Study,
    scene_sha256: String,
}

impl Origin {
    fn of(stage: &Stage) -> Self {
        let Stage { number, scene, study, scene_sha256, .. } = stage;
        Self { stage: *number, scene: scene.clone(), study: study.clone(), scene_sha256: scene_sha256.clone() }
    }
}

impl Kept {
    /// The spectrum of a pixel by this many paths, or by those that this many seconds allow.
    fn spectrum(&mut self, at: [u32; 2], samples: u32, most_s: f64) -> Spectrum {
        let Self { prepared, bands, under_way, .. } = self;
        let mut film = film_of_a_pixel(prepared);
        let corner = rect_of([0, 0]);
        let under_way = match under_way {
            Some(under_way) if under_way.at == at => under_way,
            place => place.insert(UnderWay { at, sums: film.tile(corner), samples: 0, seconds: 0.0 }),
        };
        let replicates = prepared.scene().integrator.replicates;
        let goal = samples.clamp(SAMPLES[0], SAMPLES[1]).next_multiple_of(replicates);
        let start = Instant::now();
        while under_way.samples < goal && (under_way.samples == 0 || start.elapsed().as_secs_f64() < most_s) {
            let next = (2 * under_way.samples).max(64).next_multiple_of(replicates).min(goal);
            let numbers = under_way.samples..next;
            // Where bands are kept no light paths are traced.
            prepared.render_tile(rect_of(at), numbers, &Splats::NONE, &mut under_way.sums);
            under_way.samples = next;
        }
        under_way.seconds += start.elapsed().as_secs_f64();
        film.put(corner, &under_way.sums);
        let info = |index| {
            let band = bands.of_pixel(&film, 0, 0, 0, index);
            BandInfo {
                centre_nm: bands.centre_nm(index),
                radiance: band.radiance,
                error: Some(band.error).filter(|error| error.is_finite()),
            }
        };
        Spectrum {
            bands: (0..bands.count).map(info).collect(),
            samples: Some(under_way.samples),
            seconds: under_way.seconds,
        }
    }
}

fn rect_of([x, y]: [u32; 2]) -> PixelRect {
    PixelRect { x0: x, y0: y, x1: x + 1, y1: y + 1 }
}

/// A film of one pixel that keeps what the scene's own film keeps.
fn film_of_a_pixel(prepared: &Prepared) -> Film {
    let film = Film::with_bands(1, 1, prepared.scene().integrator.replicates, prepared.band_sums());
    if prepared.records_stokes() { film.recording_stokes() } else { film }
}

impl Kept {
    /// The scene of a stage with bands; nothing is traced yet.
    fn new(origin: Origin, earlier: Option<Prepared>) -> Result<Self, String> {
        let Origin { stage, mut scene, study, scene_sha256 } = origin;
        if scene.film.bands.is_none() {
            let range_nm = scene.integrator.wavelength_range_nm;
            let seen = [range_nm[0].max(SEEN_NM[0]), range_nm[1].min(SEEN_NM[1])];
            let [low, high] = if seen[1] - seen[0] >= STEP_NM { seen } else { range_nm };
            let step_nm = STEP_NM.min(high - low);
            let count = ((high - low) / step_nm).floor();
            let centres = [low + 0.5 * step_nm, low + (count - 0.5) * step_nm, step_nm];
            scene.film.bands = Some(Bands::new(centres, range_nm).map_err(|error| error.to_string())?);
        }
        let prepared = prepare_frame(&scene, &study, earlier).map_err(|error| error.to_string())?;
        if prepared.path_reuse().is_some() {
            return Err("neighbouring pixels share paths, so no pixel has a spectrum of its own".to_owned());
        }
        let subject = etalon::Subject::new(&prepared, &scene_sha256, rect_of([0, 0]));
        let bands = subject.bands.ok_or("paths carry channels here, no wavelengths")?;
        Ok(Self { stage, prepared, bands, under_way: None })
    }
}
