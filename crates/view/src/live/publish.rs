//! From sums to a picture that pages can ask for, beside the render.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::Instant;

use etalon::Subject;
use etalon_transport::Film;

use super::Live;
use super::status::CurvePoint;
use crate::picture::{About, Snapshot, of_film};

/// Share of the processor time that looking may take from rendering, and that paths for spectra may take.
const SHARE: f64 = 0.03;
/// Processor time for looking that a picture begins with, s: its first moments are looked at most.
const CREDIT_S: f64 = 0.3;
/// Points that the curve keeps at most.
const MOST_POINTS: usize = 240;

/// What showing a picture takes from rendering it. Other programs may slow down single looks, so each counts as the shortest of its kind.
#[derive(Debug, Default)]
pub(crate) struct Overhead {
    /// How many looks, and the nanoseconds of the shortest, by kind.
    looks: [(AtomicU64, AtomicU64); 2],
    /// Nanoseconds of all threads that rendered.
    rendered: AtomicU64,
    /// Nanoseconds of threads that traced paths for spectra. They have a share of their own: a cursor that rests does not stop pictures.
    probed: AtomicU64,
}

/// A kind of look.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Glance {
    /// From sums to a picture.
    Publish,
    /// From a picture to what a page shows.
    Answer,
}

impl Overhead {
    /// Does something and counts it.
    pub(crate) fn count<T>(&self, glance: Glance, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let done = work();
        let nanoseconds = start.elapsed().as_nanos() as u64;
        let (count, least) = &self.looks[glance as usize];
        if count.fetch_add(1, Ordering::Relaxed) == 0 {
            least.store(nanoseconds, Ordering::Relaxed);
        }
        least.fetch_min(nanoseconds, Ordering::Relaxed);
        done
    }

    /// Traces paths for a spectrum and counts all of the time that this takes.
    pub(crate) fn probe<T>(&self, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let done = work();
        self.probed.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
        done
    }

    /// Counts seconds for which this many threads rendered.
    pub(crate) fn rendered(&self, seconds: f64, threads: usize) {
        self.rendered.fetch_add((1e9 * seconds * threads as f64) as u64, Ordering::Relaxed);
    }

    /// Whether more paths may be traced for a spectrum while the picture is rendered.
    pub(crate) fn may_probe(&self) -> bool {
        let [rendered, probed] = [&self.rendered, &self.probed].map(|time| 1e-9 * time.load(Ordering::Relaxed) as f64);
        may_look(rendered, probed, 1)
    }

    /// Seconds since the last reset.
    pub(crate) fn seconds(&self) -> f64 {
        let of = |(count, least): &(AtomicU64, AtomicU64)| {
            count.load(Ordering::Relaxed) as f64 * least.load(Ordering::Relaxed) as f64
        };
        1e-9 * self.looks.iter().map(of).sum::<f64>()
    }

    /// Begins again, for another picture.
    pub(crate) fn reset(&self) {
        self.looks.iter().for_each(|(count, _)| count.store(0, Ordering::Relaxed));
        [&self.rendered, &self.probed].iter().for_each(|time| time.store(0, Ordering::Relaxed));
    }
}

/// Whether a picture may be looked at again, after this many seconds of rendering and of looking.
pub(crate) fn may_look(rendering_s: f64, looking_s: f64, threads: usize) -> bool {
    looking_s <= CREDIT_S + SHARE * rendering_s * threads as f64
}

/// A film to be shown.
pub(crate) struct Shown {
    pub film: Film,
    pub subject: Arc<Subject>,
    pub samples: u32,
    pub about: About,
}

/// Where films go to be shown.
pub(crate) struct Publisher {
    films: SyncSender<Shown>,
}

impl Publisher {
    /// Starts the thread that makes pictures of films.
    ///
    /// # Errors
    /// If there is no thread to be had.
    pub(crate) fn start(live: &Arc<Live>) -> std::io::Result<Self> {
        let (films, waiting) = sync_channel(1);
        let live = Arc::clone(live);
        std::thread::Builder::new().name("view-picture".to_owned()).spawn(move || show_all(&live, &waiting))?;
        Ok(Self { films })
    }

    /// Shows a film, and says whether it will be: not where the one before is not shown yet.
    pub(crate) fn show(&self, shown: Shown) -> bool {
        self.films.try_send(shown).is_ok()
    }

    /// Shows a film before it returns: the last one for now.
    pub(crate) fn show_now(live: &Live, Shown { film, subject, samples, about }: Shown) {
        show(live, &film, &subject, samples, about);
    }
}

fn show_all(live: &Live, films: &Receiver<Shown>) {
    for Shown { film, subject, samples, about } in films {
        live.overhead.count(Glance::Publish, || show(live, &film, &subject, samples, about));
    }
}

fn show(live: &Live, film: &Film, subject: &Subject, samples: u32, about: About) {
    match of_film(film, subject, samples, about) {
        Ok(snapshot) => put(live, snapshot),
        Err(error) => live.show(|seen| seen.status.notes = vec![error.to_string()]),
    }
}

/// Puts a picture where pages find it, with its point on the curve. One that a later one overtook is left out.
pub(crate) fn put(live: &Live, snapshot: Snapshot) {
    if snapshot.stage != live.wish().stage {
        return;
    }
    live.show(|seen| {
        let status = &mut seen.status;
        if seen.snapshot.as_ref().is_some_and(|shown| shown.number > snapshot.number) {
            return;
        }
        status.picture = snapshot.number;
        status.picture_size = snapshot.size();
        status.block = snapshot.block;
        status.samples = snapshot.samples;
        status.seconds = snapshot.seconds;
        status.error.clone_from(&snapshot.error);
        if let Some(relative_rmse) = snapshot.error.as_ref().and_then(|error| error.relative_rmse) {
            let interval = snapshot.error.as_ref().and_then(|error| error.interval_95);
            let Snapshot { seconds, samples, block, .. } = snapshot;
            status.curve.push(CurvePoint { seconds, samples, relative_rmse, interval, block });
            thin_out(&mut status.curve);
        }
        seen.snapshot = Some(Arc::new(snapshot));
    });
}

/// Leaves out every other of the older points where there are too many.
fn thin_out(curve: &mut Vec<CurvePoint>) {
    if curve.len() <= MOST_POINTS {
        return;
    }
    let recent = curve.len() - MOST_POINTS / 4;
    let mut index = 0;
    curve.retain(|_| {
        index += 1;
        index > recent || index % 2 == 1
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_curves_keep_their_ends() {
        let point = |seconds| CurvePoint { seconds, samples: 4, relative_rmse: 0.1, interval: None, block: 1 };
        let mut curve = Vec::new();
        for i in 0..2000 {
            curve.push(point(f64::from(i)));
            thin_out(&mut curve);
        }
        assert!(curve.len() <= MOST_POINTS && curve[0].seconds == 0.0 && curve.last().unwrap().seconds == 1999.0);
        assert!(curve.windows(2).all(|pair| pair[0].seconds < pair[1].seconds));
    }

    #[test]
    fn spectra_are_paid_by_rendering() {
        let overhead = Overhead::default();
        assert!(overhead.may_probe());
        overhead.probe(|| std::thread::sleep(std::time::Duration::from_secs_f64(1.1 * CREDIT_S)));
        assert!(!overhead.may_probe() && overhead.seconds() == 0.0);
        overhead.rendered(100.0, 2);
        assert!(overhead.may_probe());
    }

    #[test]
    fn looking_is_paid_by_rendering() {
        assert!(may_look(0.0, 0.0, 2) && !may_look(0.0, 1.0, 2));
        assert!(may_look(100.0, 6.0, 2) && !may_look(100.0, 7.0, 2));
    }
}
