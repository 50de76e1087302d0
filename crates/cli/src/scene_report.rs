//! A scene's problems, drawn with the lines of the file that they are about.

use std::fmt;
use std::sync::Arc;

use etalon_scene::{Problem, SceneErrors, Severity};
use miette::{Diagnostic, LabeledSpan, Report, SourceCode};
use serde::Serialize;

use crate::excerpt::Excerpts;
use crate::failure::Failure;

/// One problem of a scene file.
#[derive(Debug)]
pub(crate) struct SceneProblem {
    problem: Problem,
    excerpts: Excerpts,
    /// The places of the problem and of what has to do with it, in the excerpts.
    marks: Vec<LabeledSpan>,
}

/// A place in a JSON file.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Place {
    /// The file.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1, in characters.
    pub column: usize,
    /// The value in question: `$.objects[3].shape.radius_m`.
    pub json_path: String,
}

/// All errors of a refused scene, and its warnings with them: they may be why.
pub(crate) fn scene_failure(errors: SceneErrors) -> Failure {
    let name: Arc<str> = errors.file_name.into();
    let mut failure = Failure::default();
    for problem in errors.problems {
        failure.add(Failure::input(SceneProblem::new(problem, &name, &errors.text)));
    }
    failure
}

/// The warnings of an accepted scene.
pub(crate) fn scene_warnings(file_name: &str, text: &str, warnings: Vec<Problem>) -> Vec<Report> {
    let name: Arc<str> = file_name.into();
    warnings.into_iter().map(|problem| SceneProblem::new(problem, &name, text).into()).collect()
}

impl SceneProblem {
    fn new(problem: Problem, file_name: &Arc<str>, text: &str) -> Self {
        let mut excerpts = Excerpts::new(Arc::clone(file_name));
        let here = excerpts.show(text, problem.span, problem.line, problem.column);
        let mut marks = vec![LabeledSpan::new_primary_with_span(Some("here".to_owned()), (here.start, here.len()))];
        if let Some(related) = &problem.related {
            let there = excerpts.show(text, related.span, related.line, related.column);
            marks.push(LabeledSpan::new_with_span(Some(related.label.clone()), (there.start, there.len())));
        }
        Self { problem, excerpts, marks }
    }

    /// What is wrong, without where.
    pub(crate) fn message(&self) -> &str {
        &self.problem.message
    }

    /// Where it is.
    pub(crate) fn place(&self) -> Place {
        Place {
            file: self.excerpts.file_name().to_owned(),
            line: self.problem.line,
            column: self.problem.column,
            json_path: self.problem.json_path.clone(),
        }
    }
}

impl fmt::Display for SceneProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Problem { line, column, json_path, message, .. } = &self.problem;
        write!(f, "{}:{line}:{column}: {json_path}: {message}", self.excerpts.file_name())
    }
}

impl std::error::Error for SceneProblem {}

impl Diagnostic for SceneProblem {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(self.problem.code))
    }

    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.problem.severity {
            Severity::Warning => miette::Severity::Warning,
            Severity::Error => miette::Severity::Error,
        })
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.problem.hint.as_ref().map(|hint| Box::new(hint) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.excerpts)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(self.marks.iter().cloned()))
    }
}
