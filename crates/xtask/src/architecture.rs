//! The table of crates in ARCHITECTURE.md, whose last column is what the manifests say.

use std::fs;
use std::path::Path;
use std::process::ExitCode;

use crate::{manifest, source};

/// `cargo xtask architecture [--write]`: compares the table with the manifests; `--write` renews it.
pub(crate) fn compare(root: &Path, arguments: &[String]) -> Result<ExitCode, String> {
    let write = match arguments {
        [] => false,
        [option] if option == "--write" => true,
        _ => return Err("the only option is --write".into()),
    };
    let path = root.join("ARCHITECTURE.md");
    let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let renewed = renewed(&text, &rows(root)?)?;
    if renewed == text {
        println!("ARCHITECTURE.md states the dependencies of every crate");
        return Ok(ExitCode::SUCCESS);
    }
    for line in renewed.lines().filter(|line| !text.lines().any(|old| old == *line)) {
        println!("{line}");
    }
    if write {
        fs::write(&path, renewed).map_err(|error| format!("{}: {error}", path.display()))?;
        return Ok(ExitCode::SUCCESS);
    }
    println!("ARCHITECTURE.md does not state these rows: `cargo xtask architecture --write`");
    Ok(ExitCode::FAILURE)
}

/// What the manifest of a crate gives for its row.
struct Row {
    name: String,
    description: String,
    dependencies: String,
}

fn rows(root: &Path) -> Result<Vec<Row>, String> {
    let row = |name: String| {
        let manifest = manifest::read(root, &name)?;
        let dependencies = dependencies(&manifest);
        Ok(Row { name, description: manifest.description, dependencies })
    };
    source::crates(root).into_iter().map(row).collect()
}

/// Our own crates first and in bold, then the others.
fn dependencies(manifest: &manifest::Manifest) -> String {
    let ours =
        manifest.dependencies.iter().filter_map(|d| d.name.strip_prefix("etalon-")).map(|name| format!("**{name}**"));
    let others = manifest.dependencies.iter().filter(|d| !d.name.starts_with("etalon-"));
    let others = others.map(|d| if d.optional { format!("{} (optional)", d.name) } else { d.name.clone() });
    let all: Vec<String> = ours.chain(others).collect();
    if all.is_empty() { "nothing".into() } else { all.join(", ") }
}

/// The text with the last cell of each crate's row as in `rows`, with a row for each new crate and none for crates that are gone.
fn renewed(text: &str, rows: &[Row]) -> Result<String, String> {
    let mut lines: Vec<String> = Vec::new();
    let mut behind = None;
    for line in text.lines() {
        let Some(name) = line.strip_prefix("| `crates/").and_then(|rest| rest.split_once("` |")).map(|(name, _)| name)
        else {
            lines.push(line.to_owned());
            continue;
        };
        if let Some(row) = rows.iter().find(|row| row.name == name) {
            let cell = line.trim_end().strip_suffix('|').and_then(|rest| rest.rfind('|'));
            let cell = cell.ok_or_else(|| format!("ARCHITECTURE.md: the row of `crates/{name}` ends in no cell"))?;
            lines.push(format!("{}| {} |", &line[..cell], row.dependencies));
        }
        behind = Some(lines.len());
    }
    let behind = behind.ok_or("ARCHITECTURE.md has no row of a crate")?;
    let new =
        rows.iter().filter(|row| !lines.iter().any(|line| line.starts_with(&format!("| `crates/{}` |", row.name))));
    let new: Vec<String> =
        new.map(|row| format!("| `crates/{}` | {} | {} |", row.name, row.description, row.dependencies)).collect();
    lines.splice(behind..behind, new);
    Ok(lines.join("\n") + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_renewed_added_and_deleted() {
        let row = |name: &str, dependencies: &str| Row {
            name: name.into(),
            description: format!("what {name} is"),
            dependencies: dependencies.into(),
        };
        let text = "head\n| `crates/a` | words of a | old |\n| `crates/gone` | b | x |\n| `docs/` | c | |\n";
        let expected =
            "head\n| `crates/a` | words of a | **b** |\n| `crates/new` | what new is | nothing |\n| `docs/` | c | |\n";
        assert_eq!(renewed(text, &[row("a", "**b**"), row("new", "nothing")]).unwrap(), expected);
        assert_eq!(renewed(expected, &[row("a", "**b**"), row("new", "nothing")]).unwrap(), expected);
        assert!(renewed("no table", &[row("a", "")]).is_err());
    }

    #[test]
    fn the_table_states_the_dependencies_of_every_crate() {
        let root = crate::root();
        let text = fs::read_to_string(root.join("ARCHITECTURE.md")).unwrap();
        let renewed = renewed(&text, &rows(&root).unwrap()).unwrap();
        let new: Vec<_> = renewed.lines().filter(|line| !text.lines().any(|old| old == *line)).collect();
        assert!(
            renewed == text,
            "`cargo xtask architecture --write` renews the table; its new rows are\n{}",
            new.join("\n")
        );
    }

    /// A film follows from the text of a scene alone, whatever model that text was made of.
    #[test]
    fn only_the_library_and_the_program_depend_on_the_importers() {
        let root = crate::root();
        for name in source::crates(&root).iter().filter(|name| !["etalon", "cli"].contains(&name.as_str())) {
            let manifest = manifest::read(&root, name).unwrap();
            assert!(
                !manifest.dependencies.iter().any(|d| d.name == "etalon-import"),
                "{name} depends on etalon-import"
            );
        }
    }

    /// A judge that shares code with what it judges judges nothing.
    #[test]
    fn the_oracle_and_the_assignment_renderer_depend_on_nothing_of_ours() {
        let root = crate::root();
        for name in ["oracle", "whitted", "xtask"] {
            let manifest = manifest::read(&root, name).unwrap();
            let ours: Vec<_> = manifest.dependencies.iter().filter(|d| d.name.starts_with("etalon-")).collect();
            assert!(ours.is_empty(), "{name} depends on {ours:?}");
        }
    }
}
