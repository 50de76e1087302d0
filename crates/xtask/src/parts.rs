//! The lists of CONTRIBUTING.md that say which files a new part touches, against the files that name an existing part.

use std::collections::BTreeSet;
use std::path::Path;

use crate::source;

/// The crates that a scene passes through. The oracle has a form of its own, importers write the text of a scene.
const CRATES: [&str; 5] = ["scene", "geometry", "transport", "etalon", "cli"];

/// The files outside of tests that name a type or a variant `part`, or a type whose name begins with it.
fn named(root: &Path, part: &str) -> BTreeSet<String> {
    let sources = CRATES.iter().flat_map(|name| source::sources(root, name).unwrap());
    let names = |token: &source::Token| token.text.starts_with(part);
    sources
        .filter(|source| source.tokens.iter().any(names))
        .map(|source| source::relative(root, &source.path))
        .collect()
}

/// The files of the table under a heading, each at the start of its row.
fn listed(page: &str, heading: &str) -> BTreeSet<String> {
    let section = page.lines().skip_while(|line| *line != heading).skip(1).take_while(|line| !line.starts_with('#'));
    section.filter_map(|line| Some(line.strip_prefix("| `")?.split_once('`')?.0.to_owned())).collect()
}

#[test]
fn the_lists_of_files_are_those_of_an_existing_light_and_an_existing_shape() {
    let root = crate::root();
    let page = std::fs::read_to_string(root.join("CONTRIBUTING.md")).unwrap();
    for (heading, part, most) in [("### A light", "Spot", 4), ("### A shape", "Cylinder", 9)] {
        let named = named(&root, part);
        let listed: BTreeSet<String> =
            listed(&page, heading).iter().map(|file| file.replace("NAME", &part.to_lowercase())).collect();
        assert_eq!(named, listed, "files that name `{part}`, and the list under \"{heading}\" of CONTRIBUTING.md");
        assert!(named.len() <= most, "{heading} is to touch {most} files at most");
    }
}
