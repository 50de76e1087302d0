//! What a law or a truth says about a subject.

use std::fmt;

/// The outcome of holding a subject to a law: the measurement, what it was held against, and what it could have seen.
///
/// Deterministic laws compare an error with a bound (`p` is `None`); statistical laws compare a p-value with the
/// significance of one test. Verdicts are made by the constructors only, so `pass` always follows from the numbers.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[must_use = "a verdict that nobody reads judges nothing: call `assert` or look at `pass`"]
pub struct Verdict {
    /// The law or truth, as a sentence or a name.
    pub law: String,
    /// What was measured: an error in the units of `threshold`, or a test statistic (z, t, χ²).
    pub statistic: f64,
    /// Probability of a statistic at least this extreme if the law holds; `None` for a deterministic law.
    pub p: Option<f64>,
    /// Largest error allowed (deterministic) or smallest p-value accepted (statistical).
    pub threshold: f64,
    /// The smallest departure from the law that this very test would have caught, in the units of the quantity judged
    /// (the evidence names them); for a statistical law, with the power that the evidence states. Infinite where nothing
    /// was measured.
    pub resolvable_bias: f64,
    /// The worst instance, with its inputs, and how many were tried.
    pub evidence: String,
    /// Whether the subject obeys.
    pub pass: bool,
}

impl Verdict {
    /// A deterministic verdict: `error` must not exceed `bound`. An error that is NaN fails.
    pub fn bounded(law: impl Into<String>, error: f64, bound: f64, evidence: impl Into<String>) -> Self {
        Self {
            law: law.into(),
            statistic: error,
            p: None,
            threshold: bound,
            resolvable_bias: bound,
            evidence: evidence.into(),
            pass: error <= bound,
        }
    }

    /// A statistical verdict: the p-value must not fall below `significance`. A p-value that is NaN fails.
    pub fn tested(
        law: impl Into<String>,
        statistic: f64,
        p: f64,
        significance: f64,
        resolvable_bias: f64,
        evidence: impl Into<String>,
    ) -> Self {
        Self {
            law: law.into(),
            statistic,
            p: Some(p),
            threshold: significance,
            resolvable_bias,
            evidence: evidence.into(),
            pass: p >= significance,
        }
    }

    /// A verdict of failure that no number expresses, such as a direction that is NaN.
    pub fn broken(law: impl Into<String>, evidence: impl Into<String>) -> Self {
        Self {
            law: law.into(),
            statistic: f64::INFINITY,
            p: None,
            threshold: 0.0,
            resolvable_bias: f64::INFINITY,
            evidence: evidence.into(),
            pass: false,
        }
    }

    /// The same measurement, failed: the test was too weak for what it had to see. Says so in the evidence.
    pub(crate) fn without_power(mut self, reason: &str) -> Self {
        self.pass = false;
        self.evidence = format!("{reason}; {}", self.evidence);
        self
    }

    /// How much of its allowance a verdict used: above 1 it failed.
    #[must_use]
    pub fn severity(&self) -> f64 {
        let used = match self.p {
            None if self.threshold == 0.0 && self.statistic == 0.0 => 0.0,
            None => self.statistic / self.threshold,
            Some(p) => self.threshold.ln() / p.ln(),
        };
        match (self.pass, used.is_nan()) {
            (_, true) => f64::INFINITY,
            (true, _) => used,
            // In a statistical test the ratio of logarithms falls as the failure grows; what fails ranks above 1.
            (false, _) if self.p.is_some() => 1.0 + 1.0 / used,
            (false, _) => used.max(1.0 + f64::EPSILON),
        }
    }

    /// Passes silently or panics with the whole verdict.
    ///
    /// # Panics
    /// When the subject broke the law.
    #[track_caller]
    pub fn assert(&self) {
        assert!(self.pass, "{self}");
    }

    /// `Ok` with the verdict when the subject obeys, `Err` with it when not.
    ///
    /// # Errors
    /// The verdict itself, when it failed.
    pub fn into_result(self) -> Result<Self, Box<Self>> {
        if self.pass { Ok(self) } else { Err(Box::new(self)) }
    }

    /// One verdict for many instances of a law: the worst of them, with the count.
    ///
    /// # Panics
    /// When there are no instances: a law that was tried on nothing has no verdict.
    pub fn worst_of(law: impl Into<String>, verdicts: impl IntoIterator<Item = Self>) -> Self {
        let mut count = 0_usize;
        let mut failures = 0_usize;
        let mut worst: Option<Self> = None;
        for verdict in verdicts {
            count += 1;
            failures += usize::from(!verdict.pass);
            let replaces =
                worst.as_ref().is_none_or(|held| (!verdict.pass, verdict.severity()) > (!held.pass, held.severity()));
            if replaces {
                worst = Some(verdict);
            }
        }
        let mut worst = worst.expect("a law needs at least one instance");
        worst.law = law.into();
        worst.evidence = format!("{count} instances, {failures} failed; worst: {}", worst.evidence);
        worst
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let word = if self.pass { "holds" } else { "BROKEN" };
        write!(out, "{word}: {} — ", self.law)?;
        match self.p {
            None => write!(out, "error {:e}, bound {:e}", self.statistic, self.threshold)?,
            Some(p) => write!(
                out,
                "statistic {:.6}, p {p:e}, significance {:e}, would see {:e}",
                self.statistic, self.threshold, self.resolvable_bias
            )?,
        }
        write!(out, "; {}", self.evidence)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nan_never_passes() {
        assert!(!Verdict::bounded("x", f64::NAN, 1.0, "").pass);
        assert!(!Verdict::tested("x", 0.0, f64::NAN, 1e-6, 0.0, "").pass);
    }

    #[test]
    fn the_worst_instance_is_kept_and_counted() {
        let worst = Verdict::worst_of(
            "law",
            [0.5, 3.0, 2.0].map(|error| Verdict::bounded("instance", error, 1.0, format!("error {error}"))),
        );
        assert!(!worst.pass);
        assert_eq!(worst.statistic, 3.0);
        assert!(worst.evidence.contains("3 instances, 2 failed"));
        let nan = Verdict::worst_of("law", [2.0, f64::NAN].map(|e| Verdict::bounded("instance", e, 1.0, "")));
        assert!(nan.statistic.is_nan());
        let tests = [1e-9, 1e-30, 0.5].map(|p| Verdict::tested("instance", 0.0, p, 1e-6, 0.0, ""));
        assert_eq!(Verdict::worst_of("law", tests).p, Some(1e-30));
    }
}
