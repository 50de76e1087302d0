//! Every kind of error: its code, its path and its place, in a file that is right but for that.

mod form;
mod meaning;
mod places;
mod syntax;

use crate::common::{Parts, RIGHT};
use etalon_scene::{Code, Problem, Severity};

/// Where `«…»` stands in a text: the text without the marks, and line, column and bytes of what is between them.
fn unmarked(marked: &str) -> (String, usize, usize, std::ops::Range<usize>) {
    let start = marked.find('«').expect("a mark");
    let end = marked.find('»').expect("a closing mark") - '«'.len_utf8();
    let before = &marked[..start];
    let line = before.lines().count().max(1) + usize::from(before.ends_with('\n'));
    let column = before.rsplit('\n').next().map_or(0, |line| line.chars().count()) + 1;
    (marked.replace(['«', '»'], ""), line, column, start..end)
}

fn problems(text: &str) -> Vec<Problem> {
    match etalon_scene::parse(text, "test.json") {
        Ok((_, warnings)) => warnings,
        Err(errors) => errors.problems,
    }
}

/// Asserts that a text has exactly one problem, at the marked place.
#[track_caller]
fn one(severity: Severity, code: Code, path: &str, marked: &str) -> Problem {
    let (text, line, column, bytes) = unmarked(marked);
    let found = problems(&text);
    let [problem] = found.as_slice() else { panic!("{} problems, not one: {found:#?}\n{text}", found.len()) };
    assert_eq!((problem.severity, problem.code), (severity, code), "{problem}");
    assert_eq!(problem.json_path, path, "{problem}");
    assert_eq!(problem.span.start..problem.span.end, bytes, "{problem}");
    assert_eq!((problem.line, problem.column), (line, column), "{problem}");
    problem.clone()
}

#[track_caller]
fn error(code: Code, path: &str, parts: Parts<'_>) -> Problem {
    one(Severity::Error, code, path, &parts.text())
}

#[track_caller]
fn hinted(code: Code, path: &str, hint: &str, parts: Parts<'_>) {
    let problem = error(code, path, parts);
    assert!(problem.hint.as_deref().is_some_and(|h| h.contains(hint)), "{problem}");
}

fn objects(objects: &str) -> Parts<'_> {
    Parts { objects, ..RIGHT }
}
fn camera(camera: &str) -> Parts<'_> {
    Parts { camera, ..RIGHT }
}
fn materials(materials: &str) -> Parts<'_> {
    Parts { materials, objects: "[{\"shape\": {\"type\": \"sphere\", \"radius_m\": 1}, \"material\": \"m\"}]", ..RIGHT }
}
fn lights(lights: &str) -> Parts<'_> {
    Parts { lights, ..RIGHT }
}
fn integrator(integrator: &str) -> Parts<'_> {
    Parts { integrator, ..RIGHT }
}

/// An object of a shape, perhaps with a transform.
fn shaped(shape: &str, transform: &str) -> String {
    format!("[{{\"shape\": {shape}, \"material\": \"white\", \"transform\": {transform}}}]")
}

#[test]
fn the_scene_that_the_tests_change_is_right() {
    assert_eq!(problems(&RIGHT.text()), []);
}
