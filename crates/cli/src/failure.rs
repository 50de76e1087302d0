//! How a command ends when it does not succeed.

use std::process::ExitCode;

use miette::Report;

/// What every command returns.
pub(crate) type Outcome = Result<(), Failure>;

/// Whose mistake it was; this decides the exit status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Blame {
    /// The machine's, or ours: files that cannot be written, a result that is wrong. Exit status 1.
    Run,
    /// The input's: arguments that make no sense, a scene with errors. Exit status 2.
    Input,
}

/// A failed command: what to print on standard error, and the exit status.
pub(crate) struct Failure {
    blame: Blame,
    reports: Vec<Report>,
}

impl Failure {
    /// A failure of the run itself.
    pub(crate) fn run(report: impl Into<Report>) -> Self {
        Self { blame: Blame::Run, reports: vec![report.into()] }
    }

    /// Bad usage or a bad input file.
    pub(crate) fn input(report: impl Into<Report>) -> Self {
        Self { blame: Blame::Input, reports: vec![report.into()] }
    }

    /// Bad input with any number of errors, all of which are printed.
    pub(crate) fn inputs(reports: Vec<Report>) -> Self {
        Self { blame: Blame::Input, reports }
    }

    /// A command that has already said on standard output what went wrong.
    pub(crate) fn told(blame: Blame) -> Self {
        Self { blame, reports: Vec::new() }
    }

    /// Prints the reports on standard error and gives the exit status.
    #[allow(clippy::print_stderr, reason = "the program is the one place that prints")]
    pub(crate) fn report(self) -> ExitCode {
        for report in &self.reports {
            eprintln!("{report:?}");
        }
        match self.blame {
            Blame::Run => ExitCode::from(1),
            Blame::Input => ExitCode::from(2),
        }
    }
}
