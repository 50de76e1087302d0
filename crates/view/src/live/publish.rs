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

/// Share of the processor time that looking may take from rendering.
const SHARE: f64 = 0.03;
/// Processor time for looking that a picture begins with, s: its first moments are looked at most.
const CREDIT_S: f64 = 0.3;
/// Points that the curve keeps at most.
const MOST_POINTS: usize = 240;

/// Counts the time that is spent on showing a picture instead of rendering it.
#[derive(Debug, Default)]
pub(crate) struct Overhead {
    nanoseconds: AtomicU64,
}

impl Overhead {
    /// Does something and counts its time.
    pub(crate) fn count<T>(&self, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let done = work();
        self.nanoseconds.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
        done
    }

    /// Seconds so far.
    pub(crate) fn seconds(&self) -> f64 {
        self.nanoseconds.load(Ordering::Relaxed) as f64 * 1e-9
    }
}

/// Whether a picture may be looked at again, after so many seconds of rendering and of looking.
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

    /// Shows a film, and says whether it will be. Where the one before is not shown yet, it waits if this is the `last`, and else leaves it.
    pub(crate) fn show(&self, shown: Shown, last: bool) -> bool {
        if last { self.films.send(shown).is_ok() } else { self.films.try_send(shown).is_ok() }
    }
}

fn show_all(live: &Live, films: &Receiver<Shown>) {
    for Shown { film, subject, samples, about } in films {
        live.overhead.count(|| match of_film(&film, &subject, samples, about) {
            Ok(snapshot) => put(live, snapshot),
            Err(error) => live.show(|seen| seen.status.notes = vec![error.to_string()]),
        });
    }
}

/// Puts a picture where pages find it, with its point on the curve.
pub(crate) fn put(live: &Live, snapshot: Snapshot) {
    if snapshot.stage != live.wish().stage {
        return;
    }
    live.show(|seen| {
        let status = &mut seen.status;
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
    fn looking_is_paid_by_rendering() {
        assert!(may_look(0.0, 0.0, 2) && !may_look(0.0, 1.0, 2));
        assert!(may_look(100.0, 6.0, 2) && !may_look(100.0, 7.0, 2));
    }
}
