//! What accuracy will cost, before it is paid for.

use etalon_control::adaptive::{EFFORT, Goal, WORTHWHILE, explore};
use etalon_control::cost_estimate::PilotPoint;
use etalon_control::cost_estimate::next_step;
use etalon_control::{Adaptivity, CostEstimate, Limits, Pilot};
use etalon_transport::{Control, PixelRect, Prepared};

use crate::error::RenderError;

/// What is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct QuoteSettings {
    /// Relative errors to quote, such as 0.01.
    pub errors: Vec<f64>,
    /// Longest time that the pilot may take, seconds.
    pub pilot_seconds: f64,
    /// Whether regions with more error are to take more samples.
    pub adaptivity: Adaptivity,
    /// Threads; all cores if not given.
    pub threads: Option<usize>,
}

impl Default for QuoteSettings {
    /// Errors from 10 % to 0.1 %, after a pilot of 10 seconds at most.
    fn default() -> Self {
        let errors = vec![0.1, 0.05, 0.02, 0.01, 0.005, 0.001];
        Self { errors, pilot_seconds: 10.0, adaptivity: Adaptivity::Auto, threads: None }
    }
}

impl QuoteSettings {
    fn check(&self) -> Result<(), RenderError> {
        let above_0 = |value: f64| value > 0.0 && value.is_finite();
        let refuse = |text: String| Err(RenderError::Setting(text));
        if let Some(error) = self.errors.iter().find(|&&error| !above_0(error)) {
            return refuse(format!("the error is {error}; it must be above 0 and finite"));
        }
        if self.errors.is_empty() {
            return refuse("a quote needs at least one error".to_owned());
        }
        if !above_0(self.pilot_seconds) {
            return refuse(format!("the time of the pilot is {}; it must be above 0 and finite", self.pilot_seconds));
        }
        if self.threads == Some(0) {
            return refuse("a quote needs one thread at least".to_owned());
        }
        Ok(())
    }
}

/// What each error costs, and how that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Quote {
    /// Samples and seconds for each error that was asked for, with intervals, in the same order.
    pub estimates: Vec<CostEstimate>,
    /// The error of the whole picture as the pilot saw it grow smaller.
    pub points: Vec<PilotPoint>,
    /// Seconds that the pilot took.
    pub pilot_seconds: f64,
    /// The exploration of where the error is, if it was wanted.
    pub exploration: Option<QuotedExploration>,
    /// What a render to an error takes beside the seconds of an estimate, as a share of them: its own exploration and pilot.
    pub settling_share: f64,
}

/// What an exploration before a quote found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuotedExploration {
    /// The factor of time that uneven samples are predicted to win.
    pub predicted_gain: f64,
    /// Whether the quote is for such samples.
    pub used: bool,
    /// Seconds that it took.
    pub seconds: f64,
}

/// Part of the pilot's time that the exploration may take before it takes no further step.
const EXPLORING: f64 = 0.25;

impl Quote {
    /// Quotes a scene by a clock that tells seconds.
    ///
    /// # Errors
    /// If no light is found, if neighbouring pixels share paths, and if there are no threads.
    pub fn of(
        prepared: &Prepared,
        settings: &QuoteSettings,
        clock: &(dyn Fn() -> f64 + Sync),
    ) -> Result<Self, RenderError> {
        Self::of_watched(prepared, settings, clock, &|| Control::Continue)
    }

    /// As [`Quote::of`]; `control` is asked after each round of the pilot whether to go on.
    ///
    /// # Errors
    /// As [`Quote::of`], and [`RenderError::Interrupted`] where `control` ended it.
    pub fn of_watched(
        prepared: &Prepared,
        settings: &QuoteSettings,
        clock: &(dyn Fn() -> f64 + Sync),
        control: &(dyn Fn() -> Control + Sync),
    ) -> Result<Self, RenderError> {
        let stopped = || control() == Control::Stop;
        if prepared.path_reuse().is_some() {
            return Err(RenderError::PathReuse("a quote"));
        }
        settings.check()?;
        let film = &prepared.scene().film;
        let whole = PixelRect { x0: 0, y0: 0, x1: film.width, y1: film.height };
        let finest = settings.errors.iter().copied().fold(f64::INFINITY, f64::min);
        let (mut allocation, mut exploration) = (None, None);
        if settings.adaptivity.explores(prepared) {
            let goal = Goal { samples: Limits::ANY_SAMPLES, relative_rmse: Some(finest) };
            let start = clock();
            let enough = || stopped() || clock() - start > EXPLORING * settings.pilot_seconds;
            let found = explore(prepared, whole, &goal, settings.threads, &enough, &|_| ())?;
            let used = settings.adaptivity == Adaptivity::Always || found.gain >= WORTHWHILE;
            let seconds = clock() - start;
            exploration = Some(QuotedExploration { predicted_gain: found.gain, used, seconds });
            allocation = used.then_some(found.allocation);
        }
        let mut pilot = Pilot::new(prepared, whole, allocation, settings.threads)?;
        let mut rounds = 1;
        loop {
            if stopped() {
                return Err(RenderError::Interrupted);
            }
            pilot.advance(rounds * pilot.first_step(), clock, &|_| ());
            let reached = pilot.points().last().is_some_and(|point| point.reaches(finest));
            let next = next_step(rounds);
            let seconds = pilot.seconds() * f64::from(next) / f64::from(rounds);
            if reached || seconds > settings.pilot_seconds || next > Limits::ANY_SAMPLES / pilot.first_step() {
                break;
            }
            rounds = next;
        }
        if pilot.points().iter().all(|point| point.relative_rmse.is_infinite()) {
            return Err(RenderError::NoLight { paths: pilot.paths() });
        }
        Ok(Self {
            estimates: settings.errors.iter().map(|&error| pilot.cost_estimate(error)).collect(),
            points: pilot.points().to_vec(),
            pilot_seconds: pilot.seconds(),
            settling_share: pilot.share_of_pixels() + if exploration.is_some() { EFFORT } else { 0.0 },
            exploration,
        })
    }
}
