//! Lists of what breaks a rule of the repository today and is to go. They get shorter, never longer.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::ExitCode;

use crate::{duplicate_types, glossary, import_cycles};

/// A list under `crates/xtask/allowed/`. Lines that begin with `#` are comments.
pub(crate) struct List {
    file: &'static str,
    found: fn(&Path) -> Result<BTreeSet<String>, String>,
}

pub(crate) const IMPORT_CYCLES: List = List { file: "import-cycles.txt", found: import_cycles::lines };
pub(crate) const GLOSSARY: List = List { file: "glossary.txt", found: glossary::lines };
pub(crate) const DUPLICATE_TYPES: List = List { file: "duplicate-types.txt", found: duplicate_types::lines };

const ALL: [List; 3] = [IMPORT_CYCLES, GLOSSARY, DUPLICATE_TYPES];

impl List {
    fn read(&self, root: &Path) -> Result<String, String> {
        let path = root.join("crates/xtask/allowed").join(self.file);
        fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))
    }

    fn entries(text: &str) -> BTreeSet<String> {
        let lines = text.lines().map(str::trim);
        lines.filter(|line| !line.is_empty() && !line.starts_with('#')).map(str::to_owned).collect()
    }

    /// What is found and not listed, and what is listed and not found.
    fn difference(&self, root: &Path, found: &BTreeSet<String>) -> Result<(Vec<String>, Vec<String>), String> {
        let listed = Self::entries(&self.read(root)?);
        Ok((found.difference(&listed).cloned().collect(), listed.difference(found).cloned().collect()))
    }

    /// Panics unless exactly what is listed was found.
    #[cfg(test)]
    pub(crate) fn hold(&self, root: &Path, found: &BTreeSet<String>) {
        let (new, gone) = self.difference(root, found).unwrap();
        assert!(
            new.is_empty() && gone.is_empty(),
            "crates/xtask/allowed/{}\nnew, not allowed:\n  {}\ngone, to be deleted from the list (`cargo xtask allowed --write`):\n  {}",
            self.file,
            new.join("\n  "),
            gone.join("\n  "),
        );
    }
}

/// `cargo xtask allowed [--write]`: compares the lists with the sources; `--write` deletes the lines that hold no more. Adds none.
pub(crate) fn compare(root: &Path, arguments: &[String]) -> Result<ExitCode, String> {
    let write = match arguments {
        [] => false,
        [option] if option == "--write" => true,
        _ => return Err("the only option is --write".into()),
    };
    let mut holds = true;
    for list in &ALL {
        let (new, gone) = list.difference(root, &(list.found)(root)?)?;
        for (line, what) in new.iter().map(|line| (line, "new")).chain(gone.iter().map(|line| (line, "gone"))) {
            println!("{}: {what}: {line}", list.file);
        }
        if write && !gone.is_empty() {
            let text = list.read(root)?;
            let kept: String = text
                .lines()
                .filter(|line| !gone.iter().any(|gone| gone == line.trim()))
                .map(|line| format!("{line}\n"))
                .collect();
            let path = root.join("crates/xtask/allowed").join(list.file);
            fs::write(&path, kept).map_err(|error| format!("{}: {error}", path.display()))?;
        }
        holds &= new.is_empty() && (gone.is_empty() || write);
    }
    Ok(if holds { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
