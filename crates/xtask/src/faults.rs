//! The lists of faults keep up with the sources: each fault names a text that its file has once.

use std::fs;

use crate::root;

/// The lists of `tests/faults`, and how many faults each has at least.
const LISTS: [(&str, usize); 3] = [("faults", 180), ("first", 40), ("second", 40)];

/// A fault of a list.
#[derive(Default)]
struct Fault {
    name: String,
    file: String,
    old: String,
}

/// The faults of a list, whose strings stand between single or double quotes, or between three single ones over some lines.
fn faults(text: &str) -> Vec<Fault> {
    let mut faults = Vec::new();
    for block in text.split("[[fault]]\n").skip(1) {
        let value = |key: &str| {
            let rest = &block[block.find(&format!("{key} = "))? + key.len() + 3..];
            let quote = ["'''", "'", "\""].into_iter().find(|quote| rest.starts_with(quote))?;
            let rest = &rest[quote.len()..];
            Some(rest[..rest.find(quote)?].to_owned())
        };
        let [name, file, old] = ["name", "file", "old"].map(|key| value(key).unwrap_or_default());
        faults.push(Fault { name, file, old });
    }
    faults
}

#[test]
fn each_fault_names_a_text_that_its_file_has_once() {
    let root = root();
    let mut wrong = Vec::new();
    for (list, least) in LISTS {
        let path = root.join(format!("tests/faults/{list}.toml"));
        let text = fs::read_to_string(&path).expect("the list is there");
        let faults = faults(&text);
        assert!(faults.len() >= least, "{list}.toml has {} faults", faults.len());
        for Fault { name, file, old } in faults {
            let source = fs::read_to_string(root.join(&file)).unwrap_or_default();
            let marks = old.matches('«').count() + old.matches('»').count();
            let count = source.matches(&old.replace(['«', '»'], "")).count();
            if count != 1 || ![0, 2].contains(&marks) {
                wrong.push(format!("{list}.toml: {name}: its text is {count} times in {file}, with {marks} marks"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
