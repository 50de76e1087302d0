//! Words that the sources no longer use, because the field has others.
//!
//! Looked at are the names of modules, files, types, functions, constants and statics outside of tests. An alias of a `use` and what is
//! local to a function are not.

use std::collections::BTreeSet;
use std::path::Path;

use crate::source;

/// How a retired word is found.
enum Form {
    /// One of the words that the name is made of: `census` in `census_of`, `CensusTable` and `CENSUS`.
    Part,
    /// The whole name of a type, function or constant.
    Whole,
    /// The name of a module or a file. These words are fine elsewhere.
    Module,
}

use Form::{Module, Part, Whole};

struct Retired {
    words: &'static [&'static str],
    form: Form,
    /// The crates that it is retired from; none stands for all.
    crates: &'static [&'static str],
    instead: &'static str,
}

const fn retired(
    words: &'static [&'static str],
    form: Form,
    crates: &'static [&'static str],
    instead: &'static str,
) -> Retired {
    Retired { words, form, crates, instead }
}

const GEOMETRY: &[&str] = &["geometry"];
const TRANSPORT: &[&str] = &["transport"];
/// What `transport` is and what is to be split off.
const RENDERER: &[&str] = &["transport", "control"];
const CLI: &[&str] = &["cli"];

const RETIRED: &[Retired] = &[
    retired(&["census"], Part, GEOMETRY, "primitive statistics"),
    retired(&["measure"], Part, GEOMETRY, "SAH cost"),
    retired(&["crown", "crowns"], Part, GEOMETRY, "top-level treelet"),
    retired(&["improve"], Part, GEOMETRY, "optimize"),
    retired(&["cluster", "clusters", "clustering"], Part, GEOMETRY, "agglomerate"),
    retired(&["choice", "choices"], Part, GEOMETRY, "wide collapse"),
    retired(&["portal", "portals"], Part, GEOMETRY, "instance node"),
    retired(&["lone"], Part, GEOMETRY, "instance leaf"),
    retired(&["within"], Part, GEOMETRY, "instance traversal"),
    retired(&["Met"], Whole, &["geometry", "transport"], "node hits (tree), SurfaceInteraction (path)"),
    retired(&["Entered"], Whole, GEOMETRY, "hit mask and t_near"),
    retired(&["Chords"], Whole, GEOMETRY, "sphere filter"),
    retired(&["BALLS", "MESH", "MIXED"], Whole, GEOMETRY, "TreeKind"),
    retired(&["caster", "casters"], Part, TRANSPORT, "guided sampling targets"),
    retired(&["aims"], Part, TRANSPORT, "guided sampling targets"),
    retired(&["images", "Images"], Whole, TRANSPORT, "specular light images"),
    retired(&["mates"], Part, TRANSPORT, "block pixels"),
    retired(&["deal", "dealing"], Part, TRANSPORT, "redistribute"),
    retired(&["Gathered"], Whole, TRANSPORT, "reuse path"),
    retired(&["Spot"], Whole, TRANSPORT, "pixel samples"),
    retired(&["spots"], Part, TRANSPORT, "pixel samples"),
    retired(&["hindrance"], Part, &[], "unsupported reason"),
    retired(&["foretold"], Part, &[], "predicted"),
    retired(&["price", "prices"], Part, RENDERER, "cost estimate"),
    retired(&["price", "prices"], Part, CLI, "cost estimate"),
    retired(&["Shares"], Whole, RENDERER, "sample allocation"),
    retired(&["shares"], Module, RENDERER, "sample allocation"),
    retired(&["Sight"], Whole, TRANSPORT, "next-event state"),
    retired(&["Flats"], Whole, TRANSPORT, "planar lights"),
    retired(&["Rounds"], Whole, TRANSPORT, "sphere lights"),
    retired(&["Known"], Whole, TRANSPORT, "spectrum cache"),
    retired(&["Form"], Whole, TRANSPORT, "BsdfKind"),
    retired(&["Tables"], Whole, TRANSPORT, "shading tables"),
    retired(&["Around", "Body", "Inside", "Beyond"], Whole, TRANSPORT, "SurfaceInteraction, MediumStack"),
    retired(&["round"], Module, TRANSPORT, "quadric uv"),
    retired(&["relief"], Module, TRANSPORT, "bump mapping"),
    retired(&["coordinates"], Module, TRANSPORT, "shading geometry"),
    retired(&["model"], Module, TRANSPORT, "wavelength lanes"),
    retired(&["compiled"], Module, TRANSPORT, "nothing: it is deleted"),
    retired(&["room"], Module, CLI, "preflight"),
    retired(&["keep"], Module, CLI, "checkpoint"),
    retired(&["deliver"], Module, CLI, "write outputs"),
    retired(&["job"], Module, CLI, "setup"),
];

/// One line for each name with a retired word: `crate kind name`.
pub(crate) fn lines(root: &Path) -> Result<BTreeSet<String>, String> {
    let mut lines = BTreeSet::new();
    for name in source::crates(root) {
        let words: Vec<&Retired> =
            RETIRED.iter().filter(|word| word.crates.is_empty() || word.crates.contains(&name.as_str())).collect();
        let mut note = |kind: &str, defined: &str| {
            if words.iter().any(|word| word.matches(kind, defined)) {
                lines.insert(format!("{name} {kind} {defined}"));
            }
        };
        for source in source::sources(root, &name)? {
            for pair in source.tokens.windows(2).filter(|pair| pair[1].is_word()) {
                let kind = pair[0].text.as_str();
                if ["struct", "enum", "trait", "type", "union", "fn", "mod", "const", "static"].contains(&kind) {
                    note(kind, &pair[1].text);
                }
            }
        }
        for path in source::files(&root.join("crates").join(&name).join("src")) {
            if let Some(stem) = path.file_stem().filter(|_| path.extension().is_some_and(|end| end == "rs")) {
                note("mod", &stem.to_string_lossy());
            }
        }
    }
    Ok(lines)
}

impl Retired {
    fn matches(&self, kind: &str, name: &str) -> bool {
        match self.form {
            Part => parts(name).iter().any(|part| self.words.contains(&part.as_str())),
            Whole => kind != "mod" && self.words.contains(&name),
            Module => kind == "mod" && self.words.contains(&name),
        }
    }
}

/// `cargo xtask glossary`: the retired words and what stands for them.
pub(crate) fn print(_: &Path, _: &[String]) -> Result<std::process::ExitCode, String> {
    for word in RETIRED {
        let of = if word.crates.is_empty() { "all crates".to_owned() } else { word.crates.join(", ") };
        let form = match word.form {
            Part => "in any name",
            Whole => "as a name",
            Module => "as a module",
        };
        println!("{:<34} {form:<12} {of:<20} → {}", word.words.join(", "), word.instead);
    }
    Ok(std::process::ExitCode::SUCCESS)
}

/// The words of a name in small letters: those of `RenderSpots`, `render_spots` and `RENDER_SPOTS` are `render` and `spots`.
fn parts(name: &str) -> Vec<String> {
    let mut parts = Vec::new();
    for piece in name.split('_').filter(|piece| !piece.is_empty()) {
        let mut after_small = false;
        let mut part = String::new();
        for c in piece.chars() {
            if c.is_uppercase() && after_small {
                parts.push(std::mem::take(&mut part));
            }
            after_small = !c.is_uppercase();
            part.extend(c.to_lowercase());
        }
        parts.push(part);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_split_into_words() {
        for name in ["RenderSpots", "render_spots", "RENDER_SPOTS", "_render_Spots"] {
            assert_eq!(parts(name), ["render", "spots"], "{name}");
        }
    }

    #[test]
    fn words_are_found_in_their_form_alone() {
        assert!(retired(&["spots"], Part, &[], "").matches("type", "RenderSpots"));
        assert!(!retired(&["spots"], Part, &[], "").matches("fn", "spotsy"));
        assert!(!retired(&["Spot"], Whole, &[], "").matches("struct", "SpotLight"));
        assert!(retired(&["model"], Module, &[], "").matches("mod", "model"));
        assert!(!retired(&["model"], Module, &[], "").matches("fn", "model"));
    }

    #[test]
    fn no_crate_has_other_retired_words_than_those_listed() {
        let root = crate::root();
        crate::allowed::GLOSSARY.hold(&root, &lines(&root).unwrap());
    }
}
