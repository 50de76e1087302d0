//! How far a long work has come: a bar on a terminal, nothing elsewhere.

use std::fmt::Write;
use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

/// A bar that counts samples: how many, what share, how fast, how long still.
pub(crate) struct SampleBar(ProgressBar);

impl SampleBar {
    /// A bar over `samples` samples, hidden if `hidden` or if standard error is not a terminal.
    pub(crate) fn new(samples: u64, hidden: bool) -> Self {
        let target = if hidden || !std::io::stderr().is_terminal() {
            ProgressDrawTarget::hidden()
        } else {
            ProgressDrawTarget::stderr()
        };
        let bar = ProgressBar::with_draw_target(Some(samples), target).with_style(style());
        if !bar.is_hidden() {
            // A tile can take seconds; the clock must not stand still meanwhile.
            bar.enable_steady_tick(Duration::from_millis(200));
        }
        Self(bar)
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

fn style() -> ProgressStyle {
    let rate = |state: &ProgressState, out: &mut dyn Write| {
        // Writing to the bar's own buffer cannot fail.
        let _ = write!(out, "{} samples/s", si(state.per_sec()));
    };
    ProgressStyle::with_template("{wide_bar:.green/dim} {percent:>3} %  {rate:>16}  {elapsed} gone, {eta} to go")
        .expect("the template is well formed")
        .with_key("rate", rate)
        .progress_chars("━╸─")
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
    let value = 100.0 * share;
    // Two digits after rounding, for which the exponent must be known.
    let decimals = if value > 0.0 { (1.0 - value.log10().floor()).clamp(0.0, 12.0) as usize } else { 0 };
    format!("{value:.decimals$} %")
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
    fn a_hidden_bar_draws_nothing_and_counts() {
        let bar = SampleBar::new(10, true);
        bar.advance(4);
        assert!(bar.0.is_hidden());
        assert_eq!(bar.0.position(), 4);
        bar.clear();
    }

    #[test]
    fn the_template_is_well_formed() {
        let _ = style();
    }
}
