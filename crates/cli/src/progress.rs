//! How far a long work has come: a bar on a terminal, nothing elsewhere.

use std::fmt::Write;
use std::io::IsTerminal;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use etalon_control::{Prediction, Watch};
use etalon_transport::{Counters, Film, PixelRect};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

/// A bar that counts samples: how many, what share, how fast, how long still.
pub(crate) struct SampleBar(ProgressBar);

impl SampleBar {
    /// A bar over `samples` samples, hidden if `hidden` or if standard error is not a terminal.
    pub(crate) fn new(samples: u64, hidden: bool) -> Self {
        Self(bar(Some(samples), style(None, None), hidden))
    }

    /// Counts samples that are done.
    pub(crate) fn advance(&self, samples: u64) {
        self.0.inc(samples);
    }

    /// Takes the bar off the screen.
    pub(crate) fn clear(&self) {
        self.0.finish_and_clear();
    }
}

/// A line that says what is being done.
pub(crate) fn spinner(hidden: bool) -> ProgressBar {
    let line = bar(None, style(None, None), hidden);
    line.set_style(ProgressStyle::with_template("{spinner} {elapsed}  {msg}").expect("the template is well formed"));
    line
}

fn bar(samples: Option<u64>, style: ProgressStyle, hidden: bool) -> ProgressBar {
    let target = if hidden || !std::io::stderr().is_terminal() {
        ProgressDrawTarget::hidden()
    } else {
        ProgressDrawTarget::stderr()
    };
    let bar = ProgressBar::with_draw_target(samples, target).with_style(style);
    if !bar.is_hidden() {
        // A tile can take seconds; the clock must not stand still meanwhile.
        bar.enable_steady_tick(Duration::from_millis(200));
    }
    bar
}

/// The bar of a render: with the error so far, and the time left to its target.
pub(crate) struct RenderBar {
    bar: ProgressBar,
    rect: PixelRect,
    target: Option<f64>,
    traced: Arc<Traced>,
    /// Camera paths that there were before.
    before: AtomicU64,
}

impl RenderBar {
    /// A bar for the pixels of `rect`, hidden if `hidden` or if standard error is not a terminal. `seconds` is when the
    /// render is to end, `target` its relative error.
    pub(crate) fn new(rect: PixelRect, seconds: Option<f64>, target: Option<f64>, hidden: bool) -> Self {
        let traced = Arc::new(Traced::default());
        let bar = bar(None, style(seconds, Some(Arc::clone(&traced))), hidden);
        if target.is_some() {
            bar.set_message("pilot");
        }
        Self { bar, rect, target, traced, before: AtomicU64::new(0) }
    }

    /// The picture goes on from this many camera paths.
    pub(crate) fn goes_on_from(&self, paths: u64) {
        self.before.store(paths, Ordering::Relaxed);
    }

    /// Says before the bar which frame of a sequence it is, and counts those after it into the time that is left. `mean_s` is what
    /// a frame took so far, if one is done.
    pub(crate) fn of_frame(self, label: String, after: usize, mean_s: Option<f64>) -> Self {
        self.bar.set_prefix(label + "  ");
        // Nobody else writes it.
        if let Ok(mut sequence) = self.traced.after.lock() {
            *sequence = Some((after, mean_s));
        }
        self
    }

    /// Takes the bar off the screen.
    pub(crate) fn clear(&self) {
        self.bar.finish_and_clear();
    }

    /// What share of the picture is done, once it has begun.
    pub(crate) fn share(&self) -> Option<f64> {
        let length = self.bar.length().filter(|&length| length > 0)?;
        Some((self.bar.position() as f64 / length as f64).min(1.0))
    }

    /// Says something above the bar, on standard error even where there is no bar.
    pub(crate) fn say(&self, text: &str) {
        if self.bar.is_hidden() {
            crate::print::note(text);
        } else {
            self.bar.println(text);
        }
    }
}

impl Watch for RenderBar {
    fn work(&self, counters: &Counters) {
        self.traced.paths.fetch_add(counters.paths, Ordering::Relaxed);
        self.traced.rays.fetch_add(counters.rays + counters.shadow_rays, Ordering::Relaxed);
        self.bar.inc(counters.paths);
    }

    fn planned(&self, paths: u64, _: Option<&Prediction>) {
        self.bar.set_length(paths);
        self.bar.set_position(self.before.load(Ordering::Relaxed));
        // The pilot's pace is not the picture's.
        self.bar.reset_eta();
        self.bar.set_message("");
    }

    fn pass(&self, film: &Film, _: u32) {
        // The error of a large picture takes time to add up.
        if self.bar.is_hidden() {
            return;
        }
        if let Some(error) = film.error(self.rect) {
            let target = self.target.map(|target| format!(" of {}", percent(target))).unwrap_or_default();
            let error = if error.is_known() { percent(error.relative_rmse) } else { "unknown".to_owned() };
            self.bar.set_message(format!("error {error}{target}"));
        }
    }
}

/// What was traced so far, for the bar.
#[derive(Default)]
struct Traced {
    paths: AtomicU64,
    rays: AtomicU64,
    /// Frames of a sequence after this one, and the seconds that one took so far.
    after: Mutex<Option<(usize, Option<f64>)>>,
}

impl Traced {
    fn rays_of_path(&self) -> f64 {
        let load = |count: &AtomicU64| count.load(Ordering::Relaxed) as f64;
        load(&self.rays) / load(&self.paths).max(1.0)
    }

    /// Seconds of the sequence that are left, of which this frame takes `left` and took `elapsed`.
    fn sequence_left(&self, elapsed: f64, left: f64) -> Option<f64> {
        let (after, mean_s) = (*self.after.lock().ok()?)?;
        Some(left + after as f64 * mean_s.unwrap_or(elapsed + left))
    }
}

fn style(seconds: Option<f64>, traced: Option<Arc<Traced>>) -> ProgressStyle {
    let in_sequence = traced.clone();
    let rate = move |state: &ProgressState, out: &mut dyn Write| {
        // Writing to the bar's own buffer cannot fail.
        let _ = match &traced {
            Some(traced) => write!(out, "{} rays/s", si(state.per_sec() * traced.rays_of_path())),
            None => write!(out, "{} samples/s", si(state.per_sec())),
        };
    };
    let left = move |state: &ProgressState, out: &mut dyn Write| {
        let by_samples = state.len().map(|_| state.eta().as_secs_f64());
        let by_time = seconds.map(|seconds| (seconds - state.elapsed().as_secs_f64()).max(0.0));
        let _ = match (by_samples, by_time) {
            (Some(left), Some(most)) => write!(out, ", remaining {}", duration(left.min(most))),
            (Some(left), None) => write!(out, ", remaining {}", duration(left)),
            // It is not known yet how many samples there will be.
            (None, Some(most)) => write!(out, ", remaining at most {}", duration(most)),
            (None, None) => Ok(()),
        };
        let sequence = in_sequence.as_ref().zip(by_samples.into_iter().chain(by_time).reduce(f64::min));
        if let Some(left) =
            sequence.and_then(|(traced, left)| traced.sequence_left(state.elapsed().as_secs_f64(), left))
        {
            let _ = write!(out, ", all frames {}", duration(left));
        }
    };
    let elapsed = |state: &ProgressState, out: &mut dyn Write| {
        let seconds = state.elapsed().as_secs_f64();
        let _ = match seconds {
            s if s < 59.5 => write!(out, "{s:.0} s"),
            s => write!(out, "{}", duration(s)),
        };
    };
    ProgressStyle::with_template(
        "{prefix}{wide_bar:.green/dim} {percent:>3} %  {msg}  {rate:>16}  elapsed {elapsed_time}{left}",
    )
    .expect("the template is well formed")
    .with_key("rate", rate)
    .with_key("elapsed_time", elapsed)
    .with_key("left", left)
    .progress_chars("━╸─")
}

/// A time in words: `0.25 s`, `14 s`, `3 min 20 s`, `5 h 12 min`, `3 d 4 h`.
pub(crate) fn duration(seconds: f64) -> String {
    if !seconds.is_finite() {
        return "?".to_owned();
    }
    if seconds < 59.5 {
        return format!("{} s", two_digits(seconds));
    }
    let whole = |unit: f64, small: f64| {
        let parts = (seconds / small).round();
        ((parts * small / unit).floor(), parts % (unit / small))
    };
    let (large, small, names) = match seconds {
        s if s < 3570.0 => (60.0, 1.0, ["min", "s"]),
        s if s < 86_370.0 => (3600.0, 60.0, ["h", "min"]),
        _ => (86_400.0, 3600.0, ["d", "h"]),
    };
    let (count, rest) = whole(large, small);
    format!("{count:.0} {} {rest:.0} {}", names[0], names[1])
}

/// A number that is 0 or above with at least two digits and no more decimals than that needs.
pub(crate) fn two_digits(value: f64) -> String {
    if !value.is_finite() {
        return "?".to_owned();
    }
    let decimals = if value > 0.0 { (1.0 - value.log10().floor()).clamp(0.0, 12.0) as usize } else { 0 };
    format!("{value:.decimals$}")
}

/// A number with three digits and a decimal prefix, such as `2.35 M`.
pub(crate) fn si(value: f64) -> String {
    let (scaled, prefix) = [(1e9, " G"), (1e6, " M"), (1e3, " k")]
        .into_iter()
        .find(|(unit, _)| value >= 0.9995 * unit)
        .map_or((value, ""), |(unit, prefix)| (value / unit, prefix));
    let decimals = if scaled >= 99.95 {
        0
    } else if scaled >= 9.995 {
        1
    } else {
        2
    };
    format!("{scaled:.decimals$}{prefix}")
}

/// A share with two or three digits in per cent, such as `2.4 %`.
pub(crate) fn percent(share: f64) -> String {
    format!("{} %", two_digits(100.0 * share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_have_three_digits_and_a_prefix() {
        for (value, text) in [
            (0.0, "0.00"),
            (7.0, "7.00"),
            (42.0, "42.0"),
            (99.96, "100"),
            (999.0, "999"),
            (999.6, "1.00 k"),
            (2_345_678.0, "2.35 M"),
            (1.5e9, "1.50 G"),
        ] {
            assert_eq!(si(value), text);
        }
    }

    #[test]
    fn shares_have_two_digits() {
        for (share, text) in
            [(0.0, "0 %"), (0.024, "2.4 %"), (0.0102, "1.0 %"), (0.235, "24 %"), (1.5, "150 %"), (0.000_12, "0.012 %")]
        {
            assert_eq!(percent(share), text);
        }
    }

    #[test]
    fn times_are_told_in_two_units() {
        for (seconds, text) in [
            (0.254, "0.25 s"),
            (14.2, "14 s"),
            (59.6, "1 min 0 s"),
            (200.0, "3 min 20 s"),
            (3599.0, "1 h 0 min"),
            (18_720.0, "5 h 12 min"),
            (273_600.0, "3 d 4 h"),
            (f64::INFINITY, "?"),
        ] {
            assert_eq!(duration(seconds), text);
        }
    }

    #[test]
    fn a_hidden_bar_draws_nothing_and_counts() {
        let rect = PixelRect { x0: 0, y0: 0, x1: 2, y1: 2 };
        let bar = RenderBar::new(rect, Some(1.0), Some(0.01), true);
        assert_eq!(bar.bar.message(), "pilot");
        bar.work(&Counters { paths: 9, ..Counters::default() });
        bar.planned(32, None);
        bar.work(&Counters { paths: 4, ..Counters::default() });
        assert!(bar.bar.is_hidden());
        assert_eq!((bar.bar.position(), bar.bar.length()), (4, Some(32)));
        bar.clear();
    }

    #[test]
    fn the_time_left_of_a_sequence_is_that_of_this_frame_and_of_those_after_it() {
        let rect = PixelRect { x0: 0, y0: 0, x1: 2, y1: 2 };
        let left = |after, mean_s| {
            let bar = RenderBar::new(rect, None, None, true).of_frame("frame 3".to_owned(), after, mean_s);
            assert_eq!(bar.bar.prefix(), "frame 3  ");
            bar.traced.sequence_left(2.0, 4.0)
        };
        assert_eq!(left(10, None), Some(64.0));
        assert_eq!(left(10, Some(3.0)), Some(34.0));
        assert_eq!(left(0, Some(3.0)), Some(4.0));
        assert_eq!(Traced::default().sequence_left(2.0, 4.0), None);
    }

    #[test]
    fn the_template_is_well_formed() {
        let _ = (style(None, None), style(Some(1.0), Some(Arc::default())));
    }
}
