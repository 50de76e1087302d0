//! A scene's problems, drawn with the lines of the file that they are about.

use std::fmt;
use std::sync::Arc;

use etalon_scene::{Problem, SceneErrors, Severity};
use miette::{Diagnostic, LabeledSpan, NamedSource, Report, SourceCode};

use crate::failure::{Failure, Place};

/// One problem of a scene file.
#[derive(Debug)]
pub(crate) struct SceneProblem {
    problem: Problem,
    file: Arc<NamedSource<String>>,
}

/// All errors of a refused scene, and its warnings with them: they may be why.
pub(crate) fn scene_failure(errors: SceneErrors) -> Failure {
    let file = Arc::new(NamedSource::new(&errors.file_name, errors.text));
    let mut failure = Failure::default();
    for problem in errors.problems {
        failure.add(Failure::input(SceneProblem { problem, file: Arc::clone(&file) }));
    }
    failure
}

/// The warnings of an accepted scene.
pub(crate) fn scene_warnings(file_name: &str, text: String, warnings: Vec<Problem>) -> Vec<Report> {
    let file = Arc::new(NamedSource::new(file_name, text));
    warnings.into_iter().map(|problem| SceneProblem { problem, file: Arc::clone(&file) }.into()).collect()
}

impl SceneProblem {
    /// What is wrong, without where.
    pub(crate) fn message(&self) -> &str {
        &self.problem.message
    }

    /// Where it is.
    pub(crate) fn place(&self) -> Place {
        Place {
            file: self.file.name().to_owned(),
            line: self.problem.line,
            column: self.problem.column,
            json_path: self.problem.json_path.clone(),
        }
    }
}

impl fmt::Display for SceneProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Problem { line, column, json_path, message, .. } = &self.problem;
        write!(f, "{}:{line}:{column}: {json_path}: {message}", self.file.name())
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
        Some(&*self.file)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let span = |span: etalon_scene::Span| (span.start, span.len());
        let main = LabeledSpan::new_primary_with_span(Some("here".to_owned()), span(self.problem.span));
        let related = self
            .problem
            .related
            .as_ref()
            .map(|related| LabeledSpan::new_with_span(Some(related.label.clone()), span(related.span)));
        Some(Box::new(std::iter::once(main).chain(related)))
    }
}
