//! Type names that a crate defines more than once as `pub` or `pub(crate)`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::source::{self, Token};

/// One line for each name: `crate Name: module, module …`.
pub(crate) fn lines(root: &Path) -> Result<BTreeSet<String>, String> {
    let mut lines = BTreeSet::new();
    for name in source::crates(root) {
        let mut types: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for source in source::sources(root, &name)? {
            source::walk(&source.tokens, |at, inline| {
                if let Some(defined) = visible_type(&source.tokens[at..]) {
                    let module: Vec<&str> = source.module.iter().chain(inline).map(String::as_str).collect();
                    types.entry(defined.to_owned()).or_default().insert(module.join("::"));
                }
            });
        }
        // Two in one module stand under different `cfg`s: they are one type.
        for (defined, modules) in types.iter().filter(|(_, modules)| modules.len() > 1) {
            lines.insert(format!("{name} {defined}: {}", modules.iter().cloned().collect::<Vec<_>>().join(", ")));
        }
    }
    Ok(lines)
}

/// The name of the type if `pub struct Name` or the like begins here.
fn visible_type(tokens: &[Token]) -> Option<&str> {
    let mut words = tokens.iter().map(|token| token.text.as_str());
    if words.next() != Some("pub") {
        return None;
    }
    let mut word = words.next()?;
    if word == "(" {
        if (words.next(), words.next()) != (Some("crate"), Some(")")) {
            return None;
        }
        word = words.next()?;
    }
    while word == "unsafe" {
        word = words.next()?;
    }
    if ["struct", "enum", "trait", "type", "union"].contains(&word) { words.next() } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_types_that_the_crate_sees_count() {
        let name = |text: &str| visible_type(&source::tokens(text)).map(str::to_owned);
        assert_eq!(name("pub struct A<T>(T);").as_deref(), Some("A"));
        assert_eq!(name("pub(crate) unsafe trait A {}").as_deref(), Some("A"));
        for text in ["pub(super) struct A;", "struct A;", "pub fn a() {}", "pub(in crate::a) enum A {}"] {
            assert_eq!(name(text), None, "{text}");
        }
    }

    #[test]
    fn no_crate_has_other_duplicates_than_those_listed() {
        let root = crate::root();
        crate::allowed::DUPLICATE_TYPES.hold(&root, &lines(&root).unwrap());
    }
}
