//! Who watches a render: the bar, and the signals that may end it.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use etalon_control::{Prediction, Watch};
use etalon_transport::{Control, Counters, Film, PixelRect, TileSums};

use crate::display::Display;
use crate::interrupt::Interrupt;
use crate::progress::RenderBar;

/// How progress is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum ProgressKind {
    /// A progress bar, on a terminal only.
    Bar,
    /// Lines such as `openjd_progress: 12.5` (per cent) on standard output, for Open Job Description.
    Openjd,
}

/// All watchers of a render.
pub(super) struct Watcher<'a> {
    bar: &'a RenderBar,
    interrupt: &'a Interrupt,
    display: Option<&'a Display>,
    said: AtomicBool,
    /// Per mille that were last told to a farm.
    told: Option<Mutex<u64>>,
    /// How many pictures of how many are done.
    position: [usize; 2],
}

impl<'a> Watcher<'a> {
    /// `openjd` is how many pictures of how many are done, if lines of Open Job Description are wanted.
    pub(super) fn new(
        bar: &'a RenderBar,
        interrupt: &'a Interrupt,
        display: Option<&'a Display>,
        openjd: Option<[usize; 2]>,
    ) -> Self {
        let (told, position) = (openjd.map(|_| Mutex::default()), openjd.unwrap_or([0, 1]));
        Self { bar, interrupt, display, said: AtomicBool::new(false), told, position }
    }

    /// See [`RenderBar::goes_on_from`].
    pub(super) fn goes_on_from(&self, paths: u64) {
        self.bar.goes_on_from(paths);
    }

    fn tell(&self) {
        let (Some(told), Some(share)) = (&self.told, self.bar.share()) else { return };
        let [done, of] = self.position.map(|count| count as f64);
        let permille = (1000.0 * (done + share) / of) as u64;
        // Locked until it is printed, so that the lines come in order.
        let Ok(mut told) = told.lock() else { return };
        if permille > *told {
            *told = permille;
            if !crate::print::line_if_read(&format!("openjd_progress: {:.1}", 0.1 * permille as f64)) {
                // Nobody reads it any more; the render is worth finishing all the same.
                *told = u64::MAX;
            }
        }
    }
}

impl Watch for Watcher<'_> {
    fn work(&self, counters: &Counters) {
        self.bar.work(counters);
        self.tell();
    }

    fn planned(&self, paths: u64, predicted: Option<&Prediction>) {
        self.bar.planned(paths, predicted);
    }

    fn tile(&self, rect: PixelRect, sums: &TileSums) {
        if let Some(display) = self.display {
            display.tile(rect, sums);
        }
    }

    fn pass(&self, film: &Film, samples: u32) {
        self.bar.pass(film, samples);
        if let Some(display) = self.display {
            display.catch_up(film, PixelRect { x0: 0, y0: 0, x1: film.width(), y1: film.height() });
        }
    }

    fn control(&self) -> Control {
        if self.interrupt.signal().is_none() {
            return Control::Continue;
        }
        if !self.said.swap(true, Ordering::Relaxed) {
            self.bar
                .say("stopping after the tiles in progress (the same signal again stops at once and keeps nothing)");
        }
        Control::Stop
    }
}
