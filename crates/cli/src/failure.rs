//! How a command ends when it does not succeed.

use miette::Report;

/// What every command returns.
pub(crate) type Outcome = Result<(), Failure>;

/// Whose mistake it was; this decides the exit status.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Blame {
    /// Nobody's: a signal ended the work, and what there was is kept. Exit status 128 and the signal's number.
    Signal(u8),
    /// Nobody's: a question could not be decided. Exit status 3.
    Undecided,
    /// The machine's, or ours: files that cannot be written, a result that is wrong. Exit status 1.
    Run,
    /// The input's: arguments that make no sense, a scene with errors. Exit status 2.
    Input,
}

/// A failed command: everything that is wrong, so that one run shows it all.
#[derive(Default)]
pub(crate) struct Failure {
    problems: Vec<(Blame, Report)>,
}

impl Failure {
    /// A failure of the run itself.
    pub(crate) fn run(report: impl Into<Report>) -> Self {
        Self { problems: vec![(Blame::Run, report.into())] }
    }

    /// Bad usage or a bad input file.
    pub(crate) fn input(report: impl Into<Report>) -> Self {
        Self { problems: vec![(Blame::Input, report.into())] }
    }

    /// A question that could not be decided.
    pub(crate) fn undecided(report: impl Into<Report>) -> Self {
        Self { problems: vec![(Blame::Undecided, report.into())] }
    }

    /// An end by a signal.
    pub(crate) fn signal(number: u8, report: impl Into<Report>) -> Self {
        Self { problems: vec![(Blame::Signal(number), report.into())] }
    }

    /// Another problem found in the same run.
    pub(crate) fn add(&mut self, other: Self) {
        self.problems.extend(other.problems);
    }

    /// Whether there was no problem.
    pub(crate) fn is_empty(&self) -> bool {
        self.problems.is_empty()
    }

    /// Success if there was no problem.
    pub(crate) fn into_outcome(self) -> Outcome {
        if self.problems.is_empty() { Ok(()) } else { Err(self) }
    }

    /// The problems.
    pub(crate) fn reports(&self) -> impl Iterator<Item = &Report> {
        self.problems.iter().map(|(_, report)| report)
    }

    /// Prints the problems on standard error and gives the exit status: 2 if any of them is the input's, 1 if the machine's.
    pub(crate) fn report(self) -> u8 {
        crate::print::warnings(self.reports());
        match self.problems.iter().map(|(blame, _)| *blame).max() {
            None => 0,
            Some(Blame::Signal(number)) => 128 | number,
            Some(Blame::Undecided) => 3,
            Some(Blame::Run) => 1,
            Some(Blame::Input) => 2,
        }
    }
}
