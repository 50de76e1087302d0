//! The lines of a file that a message shows, cropped to a window around the place: a file may be one line of many megabytes.

use std::sync::Arc;

use etalon_scene::Span;
use miette::{MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};

/// Most characters of a line that are shown.
const COLUMNS: usize = 120;

/// A few lines of a file around one place, as they are shown.
#[derive(Debug)]
struct Excerpt {
    text: String,
    lines: Vec<Line>,
    /// Number of its first line in the file, from 0.
    first_line: usize,
    /// Column of the place in the file, from 0.
    column: usize,
}

/// What an excerpt shows of a line.
#[derive(Debug)]
struct Line {
    /// Bytes of the file.
    shown: Span,
    /// Where they begin in the text of the excerpt.
    at: usize,
}

impl Excerpt {
    /// The line of a place, and the lines before and after it. `line` and `column` count from 1.
    fn new(file: &str, place: usize, line: usize, column: usize) -> Self {
        let place = (0..=place.min(file.len())).rev().find(|at| file.is_char_boundary(*at)).unwrap_or(0);
        let start = back(file, place, COLUMNS / 2);
        let end = forth(file, start, COLUMNS);
        let mut excerpt =
            Self { text: String::new(), lines: Vec::new(), first_line: line.max(1) - 1, column: column.max(1) - 1 };
        if begins_line(file, start) && start > 0 {
            let before = line_end_before(file, start);
            let start = back(file, before, COLUMNS);
            if begins_line(file, start) {
                excerpt.push(file, Span::new(start, before));
                excerpt.first_line = excerpt.first_line.saturating_sub(1);
            }
        }
        excerpt.push(file, Span::new(start, end));
        if ends_line(file, end) && end < file.len() {
            let next = end + if file[end..].starts_with("\r\n") { 2 } else { 1 };
            excerpt.push(file, Span::new(next, forth(file, next, COLUMNS)));
        }
        excerpt
    }

    fn push(&mut self, file: &str, shown: Span) {
        if !self.lines.is_empty() {
            self.text.push('\n');
        }
        if !begins_line(file, shown.start) {
            self.text.push('…');
        }
        self.lines.push(Line { shown, at: self.text.len() });
        // A terminal would obey what controls it. Each stands for as many bytes as before.
        self.text.extend(file[shown.start..shown.end].chars().map(|c| match c {
            '\t' => c,
            c if c.is_control() => [' ', '·'][c.len_utf8() - 1],
            c => c,
        }));
        if !ends_line(file, shown.end) {
            self.text.push('…');
        } else if shown.is_empty() {
            // So that there is a column to mark.
            self.text.push(' ');
        }
    }

    /// Where the excerpt shows the beginning of `span`, up to the end of its first line.
    fn mark(&self, span: Span) -> Option<Span> {
        let line = self.lines.iter().find(|line| (line.shown.start..=line.shown.end).contains(&span.start))?;
        let place = |at: usize| {
            let at = line.at + (at - line.shown.start);
            // From the midst of a character to its beginning.
            (0..=at).rev().find(|at| self.text.is_char_boundary(*at)).unwrap_or(0)
        };
        Some(Span::new(place(span.start), place(span.end.clamp(span.start, line.shown.end))))
    }
}

/// Whether a line ends before the byte `at`: at a line feed, or at a carriage return without one.
fn ends_line(text: &str, at: usize) -> bool {
    matches!(text.as_bytes().get(at), None | Some(b'\n' | b'\r'))
}

fn begins_line(text: &str, at: usize) -> bool {
    let bytes = text.as_bytes();
    at == 0 || bytes[at - 1] == b'\n' || bytes[at - 1] == b'\r' && bytes.get(at) != Some(&b'\n')
}

/// The end of the line before the one that begins at `start`.
fn line_end_before(text: &str, start: usize) -> usize {
    if text[..start].ends_with("\r\n") { start - 2 } else { start - 1 }
}

/// At most `columns` characters back, to the beginning of the line at the furthest.
fn back(text: &str, from: usize, columns: usize) -> usize {
    let steps = text[..from].char_indices().rev().map(|(at, _)| at);
    std::iter::once(from).chain(steps).take(columns + 1).find_or_last(|at| begins_line(text, *at))
}

/// At most `columns` characters on, to the end of the line at the furthest.
fn forth(text: &str, from: usize, columns: usize) -> usize {
    let steps = text[from..].char_indices().map(|(at, _)| from + at).chain([text.len()]);
    steps.take(columns + 1).find_or_last(|at| ends_line(text, *at))
}

/// The first that is asked for, or else the last.
trait FindOrLast: Iterator<Item = usize> + Sized {
    fn find_or_last(mut self, found: impl Fn(&usize) -> bool) -> usize {
        let mut last = 0;
        for at in self.by_ref() {
            last = at;
            if found(&at) {
                break;
            }
        }
        last
    }
}

impl<I: Iterator<Item = usize>> FindOrLast for I {}

/// The excerpts of one message, one after another, as the source that is drawn.
#[derive(Debug)]
pub(crate) struct Excerpts {
    file_name: Arc<str>,
    parts: Vec<Excerpt>,
}

impl Excerpts {
    /// None so far.
    pub(crate) fn new(file_name: Arc<str>) -> Self {
        Self { file_name, parts: Vec::new() }
    }

    /// The file that they are of.
    pub(crate) fn file_name(&self) -> &str {
        &self.file_name
    }

    /// Sees to it that a place is shown, and gives the mark of it. `line` and `column` count from 1.
    pub(crate) fn show(&mut self, file: &str, span: Span, line: usize, column: usize) -> Span {
        if let Some(mark) = self.mark(span) {
            return mark;
        }
        self.parts.push(Excerpt::new(file, span.start, line, column));
        self.mark(span).unwrap_or(Span::new(0, 0))
    }

    fn mark(&self, span: Span) -> Option<Span> {
        let bases = self.bases();
        let mut marks = bases.zip(&self.parts).filter_map(|(base, part)| Some((base, part.mark(span)?)));
        marks.next().map(|(base, mark)| Span::new(base + mark.start, base + mark.end))
    }

    /// Where each part begins. They do not touch.
    fn bases(&self) -> impl Iterator<Item = usize> {
        self.parts.iter().scan(0, |next, part| {
            let base = *next;
            *next += part.text.len() + 2;
            Some(base)
        })
    }
}

impl SourceCode for Excerpts {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        lines_before: usize,
        lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let holds =
            |base: usize, part: &Excerpt| span.offset() >= base && span.offset() + span.len() <= base + part.text.len();
        let (base, part) =
            self.bases().zip(&self.parts).find(|(base, part)| holds(*base, part)).ok_or(MietteError::OutOfBounds)?;
        let within = SourceSpan::from((span.offset() - base, span.len()));
        let inner = part.text.as_str().read_span(&within, lines_before, lines_after)?;
        // Without lines before it the place itself is asked for.
        let column = if lines_before == 0 { part.column } else { inner.column() };
        Ok(Box::new(MietteSpanContents::new_named(
            self.file_name.to_string(),
            inner.data(),
            SourceSpan::from((base + inner.span().offset(), inner.span().len())),
            part.first_line + inner.line(),
            column,
            inner.line_count(),
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The excerpt of a place and the text that is marked in it.
    fn shown(file: &str, at: usize, length: usize) -> (String, String) {
        let mut excerpts = Excerpts::new("f".into());
        let mark = excerpts.show(file, Span::new(at, at + length), 1, at + 1);
        let text = &excerpts.parts[0].text;
        (text.clone(), text[mark.start..mark.end].to_owned())
    }

    #[test]
    fn a_place_in_a_long_line_is_shown_in_a_window_of_it() {
        let file = format!("{}here{}", "ä".repeat(100_000), "ö".repeat(100_000));
        let (text, mark) = shown(&file, 200_000, 4);
        assert_eq!((text.chars().count(), mark.as_str()), (COLUMNS + 2, "here"));
        assert!(text.starts_with("…ä") && text.ends_with("ö…"), "{text}");
        // In the midst of a character, at the end, beyond it.
        assert_eq!(shown(&file, 100_001, 1).0.chars().count(), COLUMNS + 2);
        assert_eq!(shown(&file, file.len(), 0).0, format!("…{}", "ö".repeat(COLUMNS / 2)));
        // Marks end where the window does.
        assert_eq!(shown(&file, 200_000, 100_000).1.chars().count(), COLUMNS / 2);
        assert_eq!(shown("", 0, 0), (" ".to_owned(), String::new()));
    }

    #[test]
    fn short_lines_are_shown_whole_with_their_neighbours() {
        for break_ in ["\n", "\r\n", "\r"] {
            let file = ["first", "second", "third\u{1b}[31m", "fourth"].join(break_);
            let at = file.find("sec").unwrap();
            assert_eq!(shown(&file, at, 3), ("first\nsecond\nthird [31m".to_owned(), "sec".to_owned()), "{break_:?}");
            // A mark ends with its line.
            assert_eq!(shown(&file, at, 12).1, "second");
        }
        let long = format!("{}\nhere\n{}", "a".repeat(500), "b".repeat(500));
        assert_eq!(shown(&long, 501, 4).0, format!("here\n{}…", "b".repeat(COLUMNS)));
    }

    #[test]
    fn places_far_apart_have_an_excerpt_each_and_near_ones_share_one() {
        let file = format!("one\ntwo\n{}three", "\n".repeat(1000));
        let mut excerpts = Excerpts::new("f".into());
        let marks = [(4, 2, 1), (0, 1, 1), (file.len() - 5, 1003, 1)]
            .map(|(at, line, column)| excerpts.show(&file, Span::new(at, at + 3), line, column));
        assert_eq!(excerpts.parts.len(), 2);
        for (mark, line, text) in [(marks[0], 1, "two"), (marks[1], 0, "one"), (marks[2], 1002, "thr")] {
            let contents = excerpts.read_span(&(mark.start, mark.len()).into(), 0, 0).unwrap();
            assert_eq!((contents.line(), contents.data()), (line, text.as_bytes()));
        }
        assert!(excerpts.read_span(&(0, marks[2].end).into(), 1, 1).is_err());
    }
}
