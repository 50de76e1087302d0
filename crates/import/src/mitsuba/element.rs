//! The tree of a Mitsuba file: parameters put in, includes followed, and each element knowing whether it has been used.

use std::cell::{Cell, RefCell};
use std::collections::{HashMap, HashSet};

use roxmltree::{Document, ParsingOptions};

use super::older;
use crate::Builder;

/// Deepest nesting of elements, and of files that include files.
pub(super) const MAX_DEPTH: usize = 64;
/// Most elements of a scene, files that it includes counted as often as they are: those of any scene that people write.
pub(super) const MAX_ELEMENTS: usize = 4_000_000;
/// Most bytes that `$names` are replaced by, in the whole scene.
const MAX_SUBSTITUTED: usize = 16 << 20;
/// Most files that are included, each counted as often as it is.
const MAX_INCLUDES: usize = 1000;

/// Most folders in which files are looked for: each costs a look for each file.
const MAX_FOLDERS: usize = 32;

/// An element, with `$names` replaced by their values.
#[derive(Debug)]
pub(super) struct Element {
    pub tag: String,
    attributes: HashMap<String, String>,
    pub children: Vec<Element>,
    /// The line, and the file if it is not the scene itself.
    pub place: String,
    /// Whether something was made of it.
    used: Cell<bool>,
}

impl Element {
    pub(super) fn attribute(&self, key: &str) -> Option<&str> {
        self.attributes.get(key).map(String::as_str)
    }

    pub(super) fn set(&mut self, key: &str, value: String) {
        self.attributes.insert(key.to_owned(), value);
    }

    /// One that stands for another at its place.
    pub(super) fn made(tag: &str, attributes: &[(&str, String)], children: Vec<Self>, place: &str) -> Self {
        let attributes = attributes.iter().map(|(key, value)| ((*key).to_owned(), value.clone())).collect();
        Self { tag: tag.to_owned(), attributes, children, place: place.to_owned(), used: Cell::new(false) }
    }

    /// The `type`: which plugin it is.
    pub(super) fn plugin(&self) -> &str {
        self.attribute("type").unwrap_or("")
    }

    /// What the root of a file is where the file is included: of a scene what is in it, else itself, with the name that it has there.
    fn included_as(mut self, name: Option<&String>) -> Vec<Self> {
        if self.tag == "scene" {
            return self.children;
        }
        self.attributes.remove("name");
        if let Some(name) = name {
            self.set("name", name.clone());
        }
        vec![self]
    }

    pub(super) fn mark(&self) {
        self.used.set(true);
    }

    /// The property of a name.
    pub(super) fn property(&self, name: &str) -> Option<&Element> {
        // The last one counts, as in the program.
        let found = self.children.iter().rev().find(|child| child.attribute("name") == Some(name))?;
        found.mark();
        Some(found)
    }

    pub(super) fn string(&self, name: &str) -> Option<&str> {
        self.property(name)?.attribute("value")
    }

    pub(super) fn number(&self, name: &str) -> Result<Option<f64>, String> {
        let Some(element) = self.property(name) else { return Ok(None) };
        let text = element.attribute("value").unwrap_or("").trim();
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Some(value)),
            _ => Err(format!("{}: \"{text}\" is not a number", element.place)),
        }
    }

    pub(super) fn flag(&self, name: &str) -> Result<Option<bool>, String> {
        let Some(element) = self.property(name) else { return Ok(None) };
        match element.attribute("value").unwrap_or("").trim().to_ascii_lowercase().as_str() {
            "true" => Ok(Some(true)),
            "false" => Ok(Some(false)),
            other => Err(format!("{}: \"{other}\" is neither true nor false", element.place)),
        }
    }

    /// A point or a vector: as x, y, z or as one value.
    pub(super) fn triple(&self, name: &str) -> Result<Option<[f64; 3]>, String> {
        self.property(name).map(|element| element.own_triple(0.0)).transpose()
    }

    /// What the element itself states as x, y, z or as a list; missing ones are `default`.
    pub(super) fn own_triple(&self, default: f64) -> Result<[f64; 3], String> {
        let parse = |text: &str| match text.trim().parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(format!("{}: \"{text}\" is not a number", self.place)),
        };
        if let Some(list) = self.attribute("value") {
            let values = numbers(list).map_err(|why| format!("{}: {why}", self.place))?;
            return match values[..] {
                [one] => Ok([one; 3]),
                [x, y, z] => Ok([x, y, z]),
                _ => Err(format!("{}: \"{list}\" is not three numbers", self.place)),
            };
        }
        let mut triple = [default; 3];
        for (value, key) in triple.iter_mut().zip(["x", "y", "z"]) {
            if let Some(text) = self.attribute(key) {
                *value = parse(text)?;
            }
        }
        Ok(triple)
    }

    /// Children with a tag, or references to elements with it.
    pub(super) fn nested<'a>(&'a self, tag: &str, ids: &Ids<'a>) -> Result<Vec<&'a Element>, String> {
        let mut found = Vec::new();
        for child in &self.children {
            if child.tag == tag {
                child.mark();
                found.push(child);
            } else if child.tag == "ref" {
                let target = ids.of(child)?;
                if target.tag == tag {
                    child.mark();
                    target.mark();
                    found.push(target);
                }
            }
        }
        Ok(found)
    }

    /// Lists what is in it and was not used, and forgets that it was: a thing that is referred to again is read again.
    pub(super) fn list_unused(&self, builder: &mut Builder<'_>) {
        for child in self.children.iter().filter(|child| !child.used.get()) {
            let words: Vec<String> = ["type", "name", "id", "value"]
                .iter()
                .filter_map(|key| child.attribute(key).map(|value| format!(" {key}=\"{}\"", shortened(value))))
                .collect();
            builder.leave_out(&child.place, format!("<{}{}> is ignored", child.tag, words.concat()));
        }
    }
}

fn shortened(text: &str) -> String {
    let mut short: String = text.chars().take(40).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}

/// Numbers with spaces or commas between them.
pub(super) fn numbers(text: &str) -> Result<Vec<f64>, String> {
    text.split([',', ' ', '\t', '\n', '\r'])
        .filter(|word| !word.is_empty())
        .map(|word| match word.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(format!("\"{}\" is not a number", shortened(word))),
        })
        .collect()
}

/// Elements by their `id`.
#[derive(Debug, Default)]
pub(super) struct Ids<'a>(HashMap<&'a str, &'a Element>);

impl<'a> Ids<'a> {
    pub(super) fn new(root: &'a Element) -> Self {
        let mut ids = Self::default();
        ids.add(root);
        for alias in root.children.iter().filter(|child| child.tag == "alias") {
            if let (Some(id), Some(other)) = (alias.attribute("id"), alias.attribute("as"))
                && let Some(target) = ids.0.get(id).copied()
            {
                alias.mark();
                ids.0.insert(other, target);
            }
        }
        ids
    }

    fn add(&mut self, element: &'a Element) {
        if let Some(id) = element.attribute("id")
            && element.tag != "ref"
            && element.tag != "alias"
        {
            self.0.insert(id, element);
        }
        element.children.iter().for_each(|child| self.add(child));
    }

    /// What a `<ref>` stands for.
    pub(super) fn of(&self, reference: &Element) -> Result<&'a Element, String> {
        let id = reference.attribute("id").unwrap_or("");
        self.0.get(id).copied().ok_or_else(|| format!("{}: nothing has the id \"{id}\"", reference.place))
    }
}

/// Reads a file into a tree, with values of some of its parameters.
pub(super) fn read(bytes: &[u8], given: &[(String, String)], builder: &Builder<'_>) -> Result<(Element, bool), String> {
    let mut reading = Reading {
        near: builder.near,
        folders: builder.folders,
        parameters: given.iter().cloned().collect(),
        asked_for: HashSet::new(),
        count: 0,
        includes: 0,
        substituted: 0,
        goes_on: false,
    };
    let mut root = reading.file(bytes, "", 0)?;
    if let Some((name, _)) = given.iter().find(|(name, _)| !reading.asked_for.contains(name)) {
        return Err(format!("the parameter \"{name}\" is given, but nothing in the scene asks for it"));
    }
    match root.len() {
        1 => Ok((root.remove(0), reading.goes_on)),
        _ => Err("it has no <scene>".to_owned()),
    }
}

struct Reading<'a> {
    near: &'a dyn Fn(&str) -> Result<Vec<u8>, String>,
    /// Further folders of files.
    folders: &'a RefCell<Vec<String>>,
    /// What `$name` stands for.
    parameters: HashMap<String, String>,
    /// Names of parameters that the scene has.
    asked_for: HashSet<String>,
    count: usize,
    includes: usize,
    /// Bytes that parameters have been replaced by.
    substituted: usize,
    /// Whether something follows the end of a scene.
    goes_on: bool,
}

impl Reading<'_> {
    /// The root of a file, as a list of one. The scene itself has no name.
    fn file(&mut self, bytes: &[u8], name: &str, depth: usize) -> Result<Vec<Element>, String> {
        let of = if name.is_empty() { String::new() } else { format!("{name}, ") };
        let text = std::str::from_utf8(bytes).map_err(|_| format!("{of}it is not UTF-8"))?;
        let parse = |text| {
            let options = ParsingOptions { nodes_limit: 2 * MAX_ELEMENTS as u32, ..ParsingOptions::default() };
            Document::parse_with_options(text, options)
        };
        let document = parse(text).or_else(|error| {
            // Mitsuba reads one element, whatever follows it.
            let end = text.find("</scene>").map(|start| start + "</scene>".len());
            let alone = end.and_then(|end| parse(&text[..end]).ok());
            self.goes_on |= alone.is_some();
            alone.ok_or_else(|| format!("{of}{error}"))
        })?;
        let folder = name.rsplit_once('/').map_or("", |(folder, _)| folder);
        let source = Source { of: &of, folder, lines: Lines::new(text) };
        let mut read = self.element(document.root_element(), &source, depth)?;
        let is_old = |root: &&mut Element| root.attribute("version").is_some_and(|version| version.starts_with("0."));
        read.iter_mut().filter(is_old).for_each(older::upgrade);
        Ok(read)
    }

    /// The element, or those of the file that it includes, or nothing for one that only sets a parameter.
    fn element(
        &mut self,
        node: roxmltree::Node<'_, '_>,
        source: &Source<'_>,
        depth: usize,
    ) -> Result<Vec<Element>, String> {
        let place = format!("{}line {}", source.of, source.lines.of(node.range().start));
        self.count += 1;
        if depth > MAX_DEPTH || self.count > MAX_ELEMENTS {
            return Err(format!("{place}: more than {MAX_DEPTH} levels or {MAX_ELEMENTS} elements"));
        }
        let mut attributes = HashMap::new();
        for attribute in node.attributes() {
            let value = self.replaced(attribute.value()).map_err(|why| format!("{place}: {why}"))?;
            attributes.insert(attribute.name().to_owned(), value);
        }
        let tag = node.tag_name().name().to_owned();
        match tag.as_str() {
            "default" => {
                let name = attributes.remove("name").ok_or_else(|| format!("{place}: a <default> without a name"))?;
                self.asked_for.insert(name.clone());
                self.parameters.entry(name).or_insert(attributes.remove("value").unwrap_or_default());
                return Ok(Vec::new());
            }
            "path" => {
                let folder = attributes.remove("value").ok_or_else(|| format!("{place}: a <path> without a value"))?;
                let mut folders = self.folders.borrow_mut();
                if folders.len() == MAX_FOLDERS {
                    return Err(format!("{place}: more than {MAX_FOLDERS} folders to look for files in"));
                }
                // Beside the file that says so, or beside the scene; the last one is looked in first.
                folders.push(folder.clone());
                if !source.folder.is_empty() && folders.len() < MAX_FOLDERS {
                    folders.push(format!("{}/{folder}", source.folder));
                }
                return Ok(Vec::new());
            }
            "include" => {
                self.includes += 1;
                if self.includes > MAX_INCLUDES {
                    return Err(format!("{place}: more than {MAX_INCLUDES} files are included"));
                }
                let name = attributes.get("filename").ok_or_else(|| format!("{place}: no filename"))?;
                let (name, bytes) = self.included(name, source.folder).map_err(|why| format!("{place}: {why}"))?;
                let included = self.file(&bytes, &name, depth + 1)?;
                let named = attributes.get("name");
                return Ok(included.into_iter().flat_map(|root| root.included_as(named)).collect());
            }
            _ => {}
        }
        let mut children = Vec::new();
        for child in node.children().filter(roxmltree::Node::is_element) {
            children.extend(self.element(child, source, depth + 1)?);
        }
        Ok(vec![Element { tag, attributes, children, place, used: Cell::new(false) }])
    }

    /// A file that another names, and its name: beside that one, or where all files are looked for.
    fn included(&self, name: &str, folder: &str) -> Result<(String, Vec<u8>), String> {
        let name = name.replace('\\', "/");
        let beside = (!folder.is_empty()).then(|| format!("{folder}/{name}"));
        if let Some(beside) = beside
            && let Ok(bytes) = (self.near)(&beside)
        {
            return Ok((beside, bytes));
        }
        let bytes = (self.near)(&name).map_err(|why| format!("\"{name}\" cannot be read: {why}"))?;
        Ok((name, bytes))
    }

    /// A text with the values of its parameters in the place of their names.
    fn replaced(&mut self, text: &str) -> Result<String, String> {
        let mut result = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(at) = rest.find('$') {
            result.push_str(&rest[..at]);
            let tail = &rest[at + 1..];
            let end = tail.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(tail.len());
            let name = &tail[..end];
            let value = self.parameters.get(name).ok_or_else(|| format!("no <default> gives ${name} a value"))?;
            self.asked_for.insert(name.to_owned());
            self.substituted += value.len();
            if self.substituted > MAX_SUBSTITUTED {
                return Err(format!("with ${name} the values of parameters are longer than {MAX_SUBSTITUTED} bytes"));
            }
            result.push_str(value);
            rest = &tail[end..];
        }
        result.push_str(rest);
        Ok(result)
    }
}

/// A file that is being read.
struct Source<'a> {
    /// What comes before the number of a line: its name, unless it is the scene itself.
    of: &'a str,
    /// The folder that it lies in, from that of the scene.
    folder: &'a str,
    lines: Lines,
}

/// Where the lines of a text begin.
struct Lines(Vec<usize>);

impl Lines {
    fn new(text: &str) -> Self {
        Self(std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect())
    }

    /// The line, from 1, of a byte.
    fn of(&self, at: usize) -> usize {
        self.0.partition_point(|start| *start <= at)
    }
}
