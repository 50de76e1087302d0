//! Import cycles among the top-level modules of each crate.
//!
//! A module depends on another if its code, tests left out, names it by `crate::…`, `super::…` or `self::…`. What `lib.rs` re-exports counts
//! as the module that it comes from. What `lib.rs` itself defines counts as no module.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::ExitCode;

use crate::source::{self, Source, Token};

/// Where one module names another: file and line.
type Places = BTreeSet<(String, usize)>;

/// For each module the modules that it names, with the places.
type Graph = BTreeMap<String, BTreeMap<String, Places>>;

/// One line for each cycle of each crate: `crate: module module …`.
pub(crate) fn lines(root: &Path) -> Result<BTreeSet<String>, String> {
    let mut lines = BTreeSet::new();
    for name in source::crates(root) {
        for cycle in cycles(&graph(root, &source::sources(root, &name)?)) {
            lines.insert(format!("{name}: {}", cycle.join(" ")));
        }
    }
    Ok(lines)
}

/// `cargo xtask import-cycles [CRATE …]`: each cycle, and one place for each of its imports.
pub(crate) fn print(root: &Path, only: &[String]) -> Result<ExitCode, String> {
    for name in source::crates(root) {
        if !only.is_empty() && !only.contains(&name) {
            continue;
        }
        let graph = graph(root, &source::sources(root, &name)?);
        for cycle in cycles(&graph) {
            println!("{name}: {}", cycle.join(" "));
            for from in &cycle {
                for (to, places) in graph[from].iter().filter(|(to, _)| cycle.contains(to)) {
                    let (file, line) = places.first().expect("an import has a place");
                    println!("  {from} → {to}: {} places, first {file}:{line}", places.len());
                }
            }
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn graph(root: &Path, sources: &[Source]) -> Graph {
    let modules: BTreeSet<&str> = sources.iter().filter_map(|s| s.module.first()).map(String::as_str).collect();
    let mut paths = Vec::new();
    for source in sources {
        source::walk(&source.tokens, |at, inline| {
            let module: Vec<String> = source.module.iter().chain(inline).cloned().collect();
            for path in paths_at(&source.tokens, at, &module) {
                paths.push((source, module.clone(), path, source.tokens[at].line));
            }
        });
    }
    // What the root module imports or re-exports, by name.
    let mut exports: BTreeMap<&str, &str> = BTreeMap::new();
    for (_, _, path, _) in paths.iter().filter(|(_, module, ..)| module.is_empty()) {
        if let [module, .., name] = path.names.as_slice()
            && modules.contains(module.as_str())
        {
            exports.insert(path.alias.as_ref().unwrap_or(name), module);
        }
    }
    let mut graph: Graph = modules.iter().map(|&module| (module.to_owned(), BTreeMap::new())).collect();
    for (source, module, path, line) in &paths {
        let (Some(from), Some(first)) = (module.first(), path.names.first()) else { continue };
        let to =
            if modules.contains(first.as_str()) { Some(first.as_str()) } else { exports.get(first.as_str()).copied() };
        if let (Some(to), Some(imports)) = (to, graph.get_mut(from))
            && to != from
        {
            imports.entry(to.to_owned()).or_default().insert((source::relative(root, &source.path), *line));
        }
    }
    graph
}

/// The groups of modules that reach one another.
fn cycles(graph: &Graph) -> Vec<Vec<String>> {
    let reach = |from: &str| {
        let (mut seen, mut next) = (BTreeSet::new(), vec![from.to_owned()]);
        while let Some(module) = next.pop() {
            next.extend(graph[&module].keys().filter(|to| seen.insert((*to).clone())).cloned());
        }
        seen
    };
    let reached: BTreeMap<&String, BTreeSet<String>> = graph.keys().map(|module| (module, reach(module))).collect();
    let mut found = Vec::new();
    for (module, to) in &reached {
        let cycle: Vec<String> = to.iter().filter(|other| reached[other].contains(*module)).cloned().collect();
        // Each cycle once, from the first of its modules; a module alone is none.
        if cycle.first() == Some(*module) {
            found.push(cycle);
        }
    }
    found
}

/// A path from the crate's root.
#[derive(Debug, PartialEq)]
struct PathOf {
    names: Vec<String>,
    /// `as NAME`.
    alias: Option<String>,
}

/// The paths that begin at a token within `module`: by `crate`, `super` or `self`, and in the root module also by `use`.
fn paths_at(tokens: &[Token], at: usize, module: &[String]) -> Vec<PathOf> {
    let text = |at: usize| tokens.get(at).map_or("", |token| token.text.as_str());
    let inside_a_path = at > 0 && text(at - 1) == ":";
    let starts = match text(at) {
        "crate" | "super" | "self" => !inside_a_path && text(at + 1) == ":" && text(at + 2) == ":",
        "use" => module.is_empty(),
        _ => false,
    };
    let mut found = Vec::new();
    if starts {
        let mut next = at + usize::from(text(at) == "use");
        tree(tokens, &mut next, module, &mut found);
    }
    found
}

/// Reads a path or a tree of them: `a::b`, `a::{b, c as d}`, `a::*`.
fn tree(tokens: &[Token], at: &mut usize, from: &[String], found: &mut Vec<PathOf>) {
    let text = |at: usize| tokens.get(at).map_or("", |token| token.text.as_str());
    let mut names = from.to_vec();
    loop {
        match text(*at) {
            "{" => {
                *at += 1;
                while !["}", ""].contains(&text(*at)) {
                    let before = *at;
                    tree(tokens, at, &names, found);
                    *at += usize::from(text(*at) == "," || *at == before);
                }
                *at += 1;
                return;
            }
            "*" => *at += 1,
            "crate" => {
                names.clear();
                *at += 1;
            }
            "super" => {
                names.pop();
                *at += 1;
            }
            "self" => *at += 1,
            _ if tokens.get(*at).is_some_and(Token::is_word) => {
                names.push(text(*at).to_owned());
                *at += 1;
            }
            _ => {}
        }
        if text(*at) == ":" && text(*at + 1) == ":" {
            *at += 2;
        } else {
            break;
        }
    }
    let mut alias = None;
    if text(*at) == "as" {
        alias = Some(text(*at + 1).to_owned());
        *at += 2;
    }
    found.push(PathOf { names, alias });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(module: &str, text: &str) -> Source {
        let module = module.split("::").filter(|part| !part.is_empty()).map(str::to_owned).collect();
        Source { path: "a.rs".into(), module, tokens: source::without_tests(&source::tokens(text)) }
    }

    /// The cycles of `files` beside empty modules a to e.
    fn found(files: &[(&str, &str)]) -> Vec<String> {
        let mut sources: Vec<_> = ["a", "b", "c", "d", "e"].map(|name| file(name, "")).into();
        sources.extend(files.iter().map(|(module, text)| file(module, text)));
        cycles(&graph(Path::new("."), &sources)).iter().map(|cycle| cycle.join(" ")).collect()
    }

    #[test]
    fn cycles_are_found_in_every_way_of_writing_a_path() {
        assert_eq!(found(&[("a", "use crate::b::B;"), ("b", "fn f() { crate::a::g() }")]), ["a b"]);
        assert_eq!(
            found(&[("a", "use crate::{c::C, b::{self, B as D}};"), ("b::x", "use super::super::a::A;")]),
            ["a b"]
        );
        assert_eq!(
            found(&[("a", "use super::b;"), ("b", "mod x { use super::super::c; }"), ("c", "use crate::a;")]),
            ["a b c"]
        );
        assert_eq!(found(&[("a", "use super::{b::B, c};"), ("b", "type T = Vec<crate::a::A>;")]), ["a b"]);
        assert_eq!(
            found(&[
                ("a", "pub(in crate::a) use crate::b::*;"),
                ("b", "use crate::a;"),
                ("d", "use crate::e;"),
                ("e", "use crate::d;")
            ]),
            ["a b", "d e"]
        );
    }

    #[test]
    fn re_exports_count_as_the_module_that_they_come_from() {
        let root = ("", "pub use b::{B, C as D}; pub(crate) use self::c::f;");
        assert_eq!(found(&[root, ("a", "use crate::D;"), ("b", "use crate::a;")]), ["a b"]);
        assert_eq!(found(&[root, ("a", "fn g() { crate::f() }"), ("c", "use crate::a;")]), ["a c"]);
    }

    #[test]
    fn chains_own_children_and_tests_are_no_cycles() {
        assert!(
            found(&[("a", "use crate::b;"), ("b", "use crate::c;"), ("", "use a::A; fn main() { a::g() }")]).is_empty()
        );
        assert!(
            found(&[("a", "use self::x::X; use super::a::Y;"), ("a::x", "use super::Y; use crate::a::Z;")]).is_empty()
        );
        assert!(found(&[("a", "use crate::b;"), ("b", "#[cfg(test)] mod tests { use crate::a; }")]).is_empty());
        assert!(found(&[("a", "use crate::b; // crate::c"), ("c", r#"const C: &str = "crate::a";"#)]).is_empty());
    }

    #[test]
    fn no_crate_has_other_cycles_than_those_listed() {
        let root = crate::root();
        crate::allowed::IMPORT_CYCLES.hold(&root, &lines(&root).unwrap());
    }
}
