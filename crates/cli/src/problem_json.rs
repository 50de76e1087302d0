//! Problems and warnings, for machines.

use miette::Report;
use serde::Serialize;

use crate::failure::Failure;
use crate::scene_report::{Place, SceneProblem};

/// One problem, for machines.
#[derive(Serialize)]
pub(crate) struct ProblemJson {
    /// The problem and its causes in one line.
    message: String,
    /// A stable name for its kind.
    #[serde(skip_serializing_if = "Option::is_none")]
    code: Option<String>,
    /// What to do about it.
    #[serde(skip_serializing_if = "Option::is_none")]
    hint: Option<String>,
    /// Where in a file, if it is in a file.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    place: Option<Place>,
}

/// The problems of a failure.
pub(crate) fn problems_json(failure: &Failure) -> Vec<ProblemJson> {
    failure.reports().map(problem_json).collect()
}

/// A problem or a warning.
pub(crate) fn problem_json(report: &Report) -> ProblemJson {
    let scene_problem = report.downcast_ref::<SceneProblem>();
    ProblemJson {
        message: match scene_problem {
            Some(problem) => problem.message().to_owned(),
            None => report.chain().map(ToString::to_string).collect::<Vec<_>>().join(": "),
        },
        code: report.code().map(|code| code.to_string()),
        hint: report.help().map(|help| help.to_string()),
        place: scene_problem.map(SceneProblem::place),
    }
}
