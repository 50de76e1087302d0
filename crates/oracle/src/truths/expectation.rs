//! What a picture of a truth must show, known at once or worked out when it is first asked for, and the same by other means.

use std::{
    fmt,
    sync::{Arc, LazyLock},
};

/// A mistake that a renderer might make, and what the picture would show.
#[derive(Clone, Debug, PartialEq)]
pub struct Mistake {
    /// The mistake.
    pub what: &'static str,
    /// What the picture's mean would be.
    pub value: f64,
}

/// The value once more, by a way that shares no formula with the first.
#[derive(Clone)]
pub struct SecondOpinion {
    /// The way.
    pub how: &'static str,
    /// Largest relative difference from the value that the way's own error explains.
    pub tolerance: f64,
    evaluate: Arc<dyn Fn() -> f64 + Send + Sync>,
}

impl SecondOpinion {
    pub(super) fn new(how: &'static str, tolerance: f64, evaluate: impl Fn() -> f64 + Send + Sync + 'static) -> Self {
        Self { how, tolerance, evaluate: Arc::new(evaluate) }
    }

    /// Evaluates it, which may take a second.
    #[must_use]
    pub fn value(&self) -> f64 {
        (self.evaluate)()
    }
}

impl fmt::Debug for SecondOpinion {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.debug_struct("SecondOpinion")
            .field("how", &self.how)
            .field("tolerance", &self.tolerance)
            .finish_non_exhaustive()
    }
}

/// Relative rounding allowed to an f32 renderer: some thousand roundings of 6e-8 that do not average out.
const SINGLE_PRECISION: f64 = 2e-5;

/// The value of a truth, and what is judged by it.
#[derive(Clone, Debug)]
pub(super) struct Expectation {
    pub(super) value: f64,
    pub(super) mistakes: Vec<Mistake>,
    pub(super) tolerance: f64,
    pub(super) tolerance_reason: &'static str,
}

impl Expectation {
    pub(super) fn new(value: f64) -> Self {
        Self {
            value,
            mistakes: Vec::new(),
            tolerance: SINGLE_PRECISION * value.abs(),
            tolerance_reason: "rounding of a renderer in single precision, 2e-5 relative",
        }
    }

    pub(super) fn or_else(mut self, what: &'static str, value: f64) -> Self {
        self.mistakes.push(Mistake { what, value });
        self
    }

    /// Adds an absolute allowance with its reason to that for single precision.
    pub(super) fn allows(mut self, tolerance: f64, reason: &'static str) -> Self {
        self.tolerance += tolerance;
        self.tolerance_reason = reason;
        self
    }
}

type WorkedOut = LazyLock<Expectation, Box<dyn FnOnce() -> Expectation + Send>>;

/// An [`Expectation`] that is known, or that takes quadrature and so is worked out when it is first asked for.
#[derive(Clone)]
pub(super) enum Expected {
    Known(Expectation),
    Later(Arc<WorkedOut>),
}

impl Expected {
    pub(super) fn later(work_out: impl FnOnce() -> Expectation + Send + 'static) -> Self {
        Self::Later(Arc::new(LazyLock::new(Box::new(work_out))))
    }

    pub(super) fn get(&self) -> &Expectation {
        match self {
            Self::Known(expectation) => expectation,
            Self::Later(expectation) => expectation,
        }
    }

    /// With the change made: at once to what is known, else when it is worked out.
    pub(super) fn changed(self, change: impl FnOnce(Expectation) -> Expectation + Send + 'static) -> Self {
        match self {
            Self::Known(expectation) => Self::Known(change(expectation)),
            Self::Later(before) => Self::later(move || change(Expectation::clone(&before))),
        }
    }
}

impl fmt::Debug for Expected {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.get().fmt(out)
    }
}
