//! The collector of problems, and the values of a parsed text.

use jsonc_parser::ast::Value;
use jsonc_parser::common::Ranged;

use super::{Code, Decode, MAX_PROBLEMS, Problem, Related, SceneErrors, Severity, Span, path, syntax};
use crate::problem::shortened;

/// A value of the parsed text.
#[derive(Clone, Copy, Debug)]
pub struct Node<'a> {
    pub(super) value: &'a Value<'a>,
}

/// What a value is.
#[derive(Clone, Copy, Debug)]
pub enum Kind<'a> {
    /// `null`.
    Null,
    /// `true` or `false`.
    Bool(bool),
    /// A number, as it is written.
    Number(&'a str),
    /// A string, unescaped.
    String(&'a str),
    /// An array.
    Array(&'a [Value<'a>]),
    /// An object.
    Object,
}

impl Kind<'_> {
    /// The type, for messages: `a number`.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Null => "null",
            Self::Bool(_) => "a boolean",
            Self::Number(_) => "a number",
            Self::String(_) => "a string",
            Self::Array(_) => "a list",
            Self::Object => "an object",
        }
    }
}

impl<'a> Node<'a> {
    /// What it is.
    pub fn kind(self) -> Kind<'a> {
        match self.value {
            Value::NullKeyword(_) => Kind::Null,
            Value::BooleanLit(b) => Kind::Bool(b.value),
            Value::NumberLit(n) => Kind::Number(n.value),
            Value::StringLit(s) => Kind::String(&s.value),
            Value::Array(a) => Kind::Array(&a.elements),
            Value::Object(_) => Kind::Object,
        }
    }

    /// The elements, if it is an array.
    pub fn elements(self) -> Option<impl ExactSizeIterator<Item = Node<'a>>> {
        match self.value {
            Value::Array(array) => Some(array.elements.iter().map(|value| Node { value })),
            _ => None,
        }
    }

    /// The members, if it is an object: key, place of the key, value.
    pub fn members(self) -> Option<impl ExactSizeIterator<Item = (&'a str, Span, Node<'a>)>> {
        match self.value {
            Value::Object(object) => Some(object.properties.iter().map(|p| {
                let name = p.name.range();
                (p.name.as_str(), Span::new(name.start, name.end), Node { value: &p.value })
            })),
            _ => None,
        }
    }

    /// Its place in the text that it was parsed from. For messages use [`Reader::span`].
    pub(super) fn own_span(self) -> Span {
        let range = self.value.range();
        Span::new(range.start, range.end)
    }
}

/// Collects what is wrong with a text while it is decoded.
#[derive(Debug)]
pub struct Reader<'a> {
    root: Option<&'a Value<'a>>,
    problems: Vec<Problem>,
    /// Errors and warnings so far, of which at most [`MAX_PROBLEMS`] each are kept.
    counts: [usize; 2],
    /// While a default is decoded: the object that lacks the key.
    instead: Option<Span>,
}

impl<'a> Reader<'a> {
    fn new(root: Option<&'a Value<'a>>) -> Self {
        Self { root, problems: Vec::new(), counts: [0; 2], instead: None }
    }

    /// The place of a value.
    pub fn span(&self, node: Node<'_>) -> Span {
        self.instead.unwrap_or_else(|| node.own_span())
    }

    /// Reports an error.
    pub fn error(&mut self, code: Code, at: Span, message: impl Into<String>) {
        self.report(Severity::Error, code, at, message.into(), None, None);
    }

    /// Reports an error and what to do about it; an empty hint is none.
    pub fn error_hint(&mut self, code: Code, at: Span, message: impl Into<String>, hint: impl Into<String>) {
        self.report(Severity::Error, code, at, message.into(), Some(hint.into()), None);
    }

    /// Reports an error that has to do with another place as well, which `label` names: `first here`.
    pub fn error_related(
        &mut self,
        code: Code,
        at: Span,
        message: impl Into<String>,
        hint: impl Into<String>,
        (other, label): (Span, &str),
    ) {
        let related = Related { label: label.to_owned(), line: 0, column: 0, span: other };
        self.report(Severity::Error, code, at, message.into(), Some(hint.into()), Some(related));
    }

    /// Reports a warning.
    pub fn warning(&mut self, code: Code, at: Span, message: impl Into<String>, hint: Option<String>) {
        self.report(Severity::Warning, code, at, message.into(), hint, None);
    }

    /// Whether further errors are only counted ([`MAX_PROBLEMS`]).
    pub fn is_full(&self) -> bool {
        self.error_count() >= MAX_PROBLEMS
    }

    /// Errors so far.
    pub fn error_count(&self) -> usize {
        self.counts[0]
    }

    fn report(
        &mut self,
        severity: Severity,
        code: Code,
        at: Span,
        message: String,
        hint: Option<String>,
        related: Option<Related>,
    ) {
        let count = &mut self.counts[usize::from(severity == Severity::Warning)];
        *count += 1;
        if *count > MAX_PROBLEMS {
            return;
        }
        let json_path = self.root.map_or_else(|| "$".to_owned(), |root| shortened(path::json_path(root, at)));
        let message = shortened(message);
        let hint = hint.filter(|hint| !hint.is_empty()).map(shortened);
        // Line and column follow when all problems are sorted.
        self.problems.push(Problem { severity, code, message, json_path, line: 0, column: 0, span: at, hint, related });
    }

    /// Runs `decode` on a default, whose problems, if it had any, would belong to `at`.
    pub(super) fn with_default<T>(
        &mut self,
        default: &'static str,
        at: Span,
        decode: impl FnOnce(Node<'_>, &mut Self) -> T,
    ) -> T {
        let parsed = syntax::parse(default);
        let value = parsed.value.unwrap_or_else(|| panic!("the default {default} is not JSON"));
        let before = self.instead.replace(at);
        let result = decode(Node { value: &value }, self);
        self.instead = before;
        result
    }

    /// The problems, sorted by place, with lines and columns.
    fn finish(mut self, text: &str) -> Vec<Problem> {
        self.problems.sort_by_key(|p| (p.span.start, p.span.end));
        let related = self.problems.iter().filter_map(|p| p.related.as_ref()).map(|r| r.span.start);
        let mut offsets: Vec<usize> = self.problems.iter().map(|p| p.span.start).chain(related).collect();
        offsets.sort_unstable();
        let places = lines_and_columns(text, &offsets);
        let place = |span: Span| places[offsets.partition_point(|&o| o < span.start)];
        for problem in &mut self.problems {
            (problem.line, problem.column) = place(problem.span);
            if let Some(related) = &mut problem.related {
                (related.line, related.column) = place(related.span);
            }
        }
        for (count, severity) in self.counts.into_iter().zip([Severity::Error, Severity::Warning]) {
            if let Some(more) = count.checked_sub(MAX_PROBLEMS).filter(|more| *more > 0) {
                self.problems.push(Problem {
                    severity,
                    code: Code::Limit,
                    message: format!("{more} more {severity}{} not shown", if more == 1 { " is" } else { "s are" }),
                    json_path: "$".to_owned(),
                    line: 1,
                    column: 1,
                    span: Span::new(0, 0),
                    hint: None,
                    related: None,
                });
            }
        }
        self.problems
    }
}

/// Line and column, both from 1, of each of the sorted byte offsets.
///
/// One pass over the text for all of them: a hostile file may be one line of many megabytes.
fn lines_and_columns(text: &str, offsets: &[usize]) -> Vec<(usize, usize)> {
    let bytes = text.as_bytes();
    let (mut at, mut line, mut column) = (0, 1, 1);
    let mut places = Vec::with_capacity(offsets.len());
    for &offset in offsets {
        while at < offset.min(bytes.len()) {
            let byte = bytes[at];
            at += 1;
            if byte == b'\n' || byte == b'\r' && bytes.get(at) != Some(&b'\n') {
                line += 1;
                column = 1;
            } else if !matches!(byte, 0x80..=0xBF | b'\r') {
                // Continuation bytes belong to the character before.
                column += 1;
            }
        }
        places.push((line, column));
    }
    places
}

/// Parses a text, decodes it as a `T` and lets `check` turn that into what is wanted.
///
/// `check` reports further problems to the reader; it may return `None` only when it, or the decoder, has reported an
/// error. The result comes with the warnings.
///
/// # Errors
/// Every error of the text, whether of syntax, of decoding or found by `check`, together with the warnings.
pub fn read<T: Decode, R>(
    text: &str,
    file_name: &str,
    check: impl FnOnce(T, &mut Reader<'_>) -> Option<R>,
) -> Result<(R, Vec<Problem>), SceneErrors> {
    // Editors on some systems put a byte order mark before the text.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let parsed = syntax::parse(text);
    let mut reader = Reader::new(parsed.value.as_ref());
    for fault in parsed.faults {
        let code = fault.code;
        reader.report(Severity::Error, code, fault.span, fault.message, fault.hint, None);
    }
    let result = parsed
        .value
        .as_ref()
        .and_then(|value| T::decode(Node { value }, &mut reader))
        .and_then(|file| check(file, &mut reader));
    let errors = reader.error_count();
    let problems = reader.finish(text);
    match result {
        Some(result) if errors == 0 => Ok((result, problems)),
        Some(_) => Err(SceneErrors { file_name: file_name.to_owned(), text: text.to_owned(), problems }),
        None => {
            assert!(errors > 0, "{file_name} was refused without a reason; this is a bug of the program");
            Err(SceneErrors { file_name: file_name.to_owned(), text: text.to_owned(), problems })
        }
    }
}
