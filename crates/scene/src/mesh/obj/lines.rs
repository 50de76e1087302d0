//! The statements of an OBJ file, and what is known of all of them before one is read.

use std::borrow::Cow;
use std::cell::Cell;
use std::collections::HashSet;
use std::io::{self, BufRead, Read};

use crate::mesh::MeshError;

/// Statements of a text file, each with the number of its last line. A line that ends in a backslash goes on in the next. Empty lines
/// and comments are skipped.
pub(super) struct Statements<'a> {
    bytes: &'a [u8],
    line: usize,
}

impl<'a> Statements<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, line: 0 }
    }

    /// The next line, without its end.
    fn line(&mut self) -> Option<Cow<'a, str>> {
        if self.bytes.is_empty() {
            return None;
        }
        let end = self.bytes.iter().position(|&b| b == b'\n').unwrap_or(self.bytes.len());
        let (line, rest) = self.bytes.split_at(end);
        self.bytes = rest.get(1..).unwrap_or_default();
        self.line += 1;
        Some(String::from_utf8_lossy(line))
    }
}

impl<'a> Iterator for Statements<'a> {
    type Item = (usize, Cow<'a, str>);

    fn next(&mut self) -> Option<Self::Item> {
        let trimmed = |line: Cow<'a, str>| match line {
            Cow::Borrowed(text) => Cow::Borrowed(text.trim()),
            Cow::Owned(text) => Cow::Owned(text.trim().to_owned()),
        };
        loop {
            let mut text = trimmed(self.line()?);
            if text.is_empty() || text.starts_with('#') {
                continue;
            }
            if text.ends_with('\\') {
                let mut whole = text.into_owned();
                while whole.ends_with('\\') {
                    whole.pop();
                    let Some(next) = self.line() else { break };
                    whole.push(' ');
                    whole.push_str(next.trim());
                }
                text = Cow::Owned(whole);
            }
            return Some((self.line, text));
        }
    }
}

/// The part of a statement before a comment, for statements that hold no names.
fn before_comment(text: &str) -> &str {
    text.split('#').next().unwrap_or_default()
}

/// What is known of a file before it is read.
#[derive(Debug, Default)]
pub(super) struct Survey {
    /// Whether some corners of faces have texture coordinates and some have none; the same of normals.
    pub mixed_uvs: bool,
    pub mixed_normals: bool,
    /// Whether a vertex has a colour.
    pub colours: bool,
    /// The smoothing group of each face with three corners or more, in their order; none if there is no group.
    pub smoothing: Vec<u32>,
    /// The materials that the file names, each once.
    pub used: Vec<String>,
    /// What is left out, each in a sentence without a full stop.
    pub left_out: Vec<String>,
}

/// Statements that are left out, and what they are.
const LEFT_OUT: [(&str, &str); 8] = [
    ("l", "lines have no surface"),
    ("p", "points have no surface"),
    ("curv", "curves have no surface"),
    ("curv2", "curves have no surface"),
    ("surf", "free-form surfaces are not read"),
    ("call", "other files are not read"),
    ("csh", "commands are not run"),
    ("usemap", "texture maps beside those of materials are not read"),
];

impl Survey {
    /// Refuses faces whose numbers count from nothing, or reach back before the first: the library that reads them computes with
    /// such numbers modulo 2⁶⁴ and may find others in their place.
    pub(super) fn of(bytes: &[u8]) -> Result<Self, MeshError> {
        let mut survey = Self::default();
        let mut counts = [0_i64; 3];
        // Corners without and with texture coordinates, and normals.
        let mut corners = [[0_usize; 2]; 2];
        let (mut group, mut any_group) = (0, false);
        let mut known = HashSet::new();
        let mut dropped = [(0_usize, 0_usize); LEFT_OUT.len()];
        for (line, text) in Statements::new(bytes) {
            let mut words = before_comment(&text).split_whitespace();
            let Some(key) = words.next() else { continue };
            match key {
                "v" => {
                    counts[0] += 1;
                    let words: Vec<&str> = words.collect();
                    if let [_, _, _, r, g, b, ..] = words[..] {
                        if ![r, g, b].iter().all(|word| word.parse::<f32>().is_ok()) {
                            return Err(MeshError::at_line(line, "the colour of a vertex is not three numbers"));
                        }
                        survey.colours = true;
                    }
                }
                "vt" => counts[1] += 1,
                "vn" => counts[2] += 1,
                "f" => {
                    let mut each = 0;
                    for corner in words {
                        check_corner(corner, &counts).map_err(|why| MeshError::at_line(line, why))?;
                        let [_, uv, normal] = parts(corner);
                        corners[0][usize::from(uv.is_some())] += 1;
                        corners[1][usize::from(normal.is_some())] += 1;
                        each += 1;
                    }
                    if !matches!(each, 1 | 2) {
                        survey.smoothing.push(group);
                    }
                }
                "s" => {
                    group = match words.next() {
                        Some("on") => 1,
                        word => word.and_then(|word| word.parse().ok()).unwrap_or(0),
                    };
                    any_group |= group > 0;
                }
                "usemtl" => {
                    let name = name(&text);
                    if !known.contains(name) {
                        known.insert(name.to_owned());
                        survey.used.push(name.to_owned());
                    }
                }
                _ => {
                    if let Some(i) = LEFT_OUT.iter().position(|(known, _)| *known == key) {
                        let (first, count) = dropped[i];
                        dropped[i] = (if count == 0 { line } else { first }, count + 1);
                    }
                }
            }
        }
        let mixed = |[without, with]: [usize; 2]| without > 0 && with > 0;
        (survey.mixed_uvs, survey.mixed_normals) = (mixed(corners[0]), mixed(corners[1]));
        if !any_group {
            survey.smoothing = Vec::new();
        }
        for ((key, what), (line, count)) in LEFT_OUT.iter().zip(dropped).filter(|(_, (_, count))| *count > 0) {
            let more = if count > 1 { format!(", and {} more of its kind", count - 1) } else { String::new() };
            survey.left_out.push(format!("line {line}: \"{key}\"{more}: {what}"));
        }
        Ok(survey)
    }

    /// Lines before the first: what stands for texture coordinates and normals that are missing.
    fn head(&self) -> String {
        let uv = if self.mixed_uvs { "vt nan nan\n" } else { "" };
        let normal = if self.mixed_normals { "vn 0 0 0\n" } else { "" };
        format!("{uv}{normal}")
    }

    /// A statement as the library that reads it expects it.
    fn rewritten<'t>(&self, text: &'t str) -> Cow<'t, str> {
        let key = text.split_whitespace().next().unwrap_or_default();
        match key {
            _ if LEFT_OUT.iter().any(|(known, _)| *known == key) => Cow::Borrowed(""),
            "mtllib" | "usemtl" => Cow::Owned(format!("{key} {}", name(text))),
            "v" if self.colours => Cow::Owned(vertex(before_comment(text))),
            "f" if self.mixed_uvs || self.mixed_normals => {
                let corners = before_comment(text).split_whitespace().skip(1).map(|corner| self.corner(corner));
                Cow::Owned(format!("f {}", corners.collect::<Vec<_>>().join(" ")))
            }
            "v" | "vt" | "vn" | "f" => Cow::Borrowed(before_comment(text)),
            _ => Cow::Borrowed(text),
        }
    }

    /// A corner of a face, in whose numbers those of the head are counted.
    fn corner(&self, corner: &str) -> String {
        let [vertex, uv, normal] = parts(corner);
        let number = |stated: Option<&str>, mixed: bool| match (stated, mixed) {
            (None, true) => "1".to_owned(),
            (None, false) => String::new(),
            (Some(word), mixed) => match word.parse::<i64>() {
                Ok(n) if mixed && n > 0 => (n + 1).to_string(),
                _ => word.to_owned(),
            },
        };
        let (uv, normal) = (number(uv, self.mixed_uvs), number(normal, self.mixed_normals));
        format!("{}/{uv}/{normal}", vertex.unwrap_or_default())
    }
}

/// What follows the first word.
fn name(text: &str) -> &str {
    text.split_once(char::is_whitespace).map_or("", |(_, name)| name.trim())
}

/// The numbers of a corner: of its vertex, texture coordinates and normal.
fn parts(corner: &str) -> [Option<&str>; 3] {
    let mut parts = corner.split('/');
    std::array::from_fn(|_| parts.next().filter(|part| !part.is_empty()))
}

fn check_corner(corner: &str, counts: &[i64; 3]) -> Result<(), String> {
    const NAMES: [&str; 3] = ["vertex", "texture coordinate", "normal"];
    for (k, number) in corner.split('/').enumerate().take(3) {
        let fail = |why: &str| Err(format!("a face names {} {number}, {why}", NAMES[k]));
        // What is no number is left to the reader, which refuses it.
        match number.parse::<i64>() {
            Ok(0) => return fail("but the first has the number 1"),
            Ok(n) if n < -counts[k] => return fail(&format!("where there are only {} so far", counts[k])),
            Ok(n) if n > i64::from(u32::MAX) => return fail("more than a mesh can have"),
            _ => {}
        }
    }
    Ok(())
}

/// A vertex with a colour: white if it has none.
fn vertex(text: &str) -> String {
    let words: Vec<&str> = text.split_whitespace().skip(1).collect();
    match words[..] {
        // Numbers after a colour are its alpha.
        [x, y, z, r, g, b, ..] => format!("v {x} {y} {z} {r} {g} {b}"),
        [x, y, z] => format!("v {x} {y} {z} 1 1 1"),
        // Homogeneous coordinates.
        [_, _, _, w] if w.parse() != Ok(1.0_f32) => {
            let w: f32 = w.parse().unwrap_or(0.0);
            let divided = words[..3].iter().map(|word| word.parse::<f32>().map_or(f32::NAN, |v| v / w).to_string());
            format!("v {} 1 1 1", divided.collect::<Vec<_>>().join(" "))
        }
        [x, y, z, _] => format!("v {x} {y} {z} 1 1 1"),
        _ => text.to_owned(),
    }
}

/// A file, a statement at a time, as the library that reads it expects it. `line` is that of the statement in hand.
pub(super) struct Lines<'a> {
    statements: Statements<'a>,
    survey: &'a Survey,
    line: &'a Cell<usize>,
    current: Vec<u8>,
    taken: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn new(bytes: &'a [u8], survey: &'a Survey, line: &'a Cell<usize>) -> Self {
        Self { statements: Statements::new(bytes), survey, line, current: survey.head().into_bytes(), taken: 0 }
    }
}

impl Read for Lines<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = self.fill_buf()?.read(buffer)?;
        self.consume(n);
        Ok(n)
    }
}

impl BufRead for Lines<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.taken == self.current.len() {
            (self.current, self.taken) = (Vec::new(), 0);
            if let Some((line, text)) = self.statements.next() {
                self.current = self.survey.rewritten(&text).as_bytes().to_vec();
                self.current.push(b'\n');
                self.line.set(line);
            } else {
                self.line.set(self.statements.line);
            }
        }
        Ok(&self.current[self.taken..])
    }

    fn consume(&mut self, amount: usize) {
        self.taken += amount;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_go_on_after_a_backslash_and_comments_are_none() {
        let text = b"# \xff\nv 1 \\\n 2 \\\n3 # x\n\n g a\\";
        let found: Vec<(usize, String)> = Statements::new(text).map(|(line, text)| (line, text.into_owned())).collect();
        assert_eq!(found, [(4, "v 1  2  3 # x".to_owned()), (6, "g a".to_owned())]);
    }

    #[test]
    fn corners_that_lack_something_name_what_stands_for_it() {
        let text = b"v 0 0 0 1 0 0\nv 1 0 0\nv 2 0 0 2\nvt 0 0\nvn 0 0 1\nf 1/1 2//1 3\nf -3/-1/-1 2 3 # c\n";
        let survey = Survey::of(text).unwrap();
        assert!(survey.mixed_uvs && survey.mixed_normals && survey.colours);
        let cell = Cell::new(0);
        let lines: Vec<String> = Lines::new(text, &survey, &cell).lines().map(Result::unwrap).collect();
        let expected = [
            "vt nan nan",
            "vn 0 0 0",
            "v 0 0 0 1 0 0",
            "v 1 0 0 1 1 1",
            "v 1 0 0 1 1 1",
            "vt 0 0",
            "vn 0 0 1",
            "f 1/2/1 2/1/2 3/1/1",
            "f -3/-1/-1 2/1/1 3/1/1",
        ];
        assert_eq!((lines, cell.get()), (expected.map(str::to_owned).to_vec(), 7));
    }
}
