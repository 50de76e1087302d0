//! What scenes can say, and the truths of the oracle that would notice if it were rendered wrong: the table of `docs/vocabulary.md`.
//!
//! The rows come from the schema, which is made from the declarations of the reader. A truth stands in a row if its scene says the key, or the
//! word under it, or leaves the key out where the word is its default.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use etalon_oracle::truths::{Truth, truths};
use etalon_scene::{Code, NamedFile};
use serde_json::Value;

/// A key of a kind of object, and perhaps one of the words that may stand under it.
type Row = (String, String);

/// Keys that change no light, or none beyond its noise, with the reason.
const WITHOUT_LIGHT: &[(&str, &str, &str)] = &[
    ("", "comment", "a remark"),
    ("", "name", "for messages"),
    ("scene", "$schema", "for editors"),
    ("scene", "etalon", "the version"),
    ("integrator", "seed", "chooses the noise"),
    ("integrator", "replicates", "divides the samples; `etalon verify` sets it to 1 and takes 64 films of its own"),
    ("spectrum tabulated", "outside: error", "refuses a scene"),
    ("conductor", "outside_fit: error", "refuses a scene"),
    ("film layer", "outside_fit: error", "refuses a scene"),
    ("glass", "outside_fit: error", "refuses a scene"),
    ("sellmeier", "outside_fit: error", "refuses a scene"),
    ("cauchy", "outside_fit: error", "refuses a scene"),
];

/// The reason why a row needs no truth.
fn without_light((record, key): &Row) -> Option<&'static str> {
    let named = |of: &str, name: &str| (of.is_empty() || record.ends_with(of)) && key == name;
    WITHOUT_LIGHT.iter().find(|(of, name, _)| named(of, name)).map(|(_, _, reason)| *reason)
}

/// A name of the schema in words: "`RoughnessImageForm`" is "roughness image".
fn in_words(name: &str) -> String {
    let name = name.trim_end_matches("Form").trim_end_matches("Fields").trim_end_matches("Object");
    let mut words = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !words.is_empty() {
            words.push(' ');
        }
        words.extend(letter.to_lowercase());
    }
    words
}

struct Schema {
    document: Value,
}

impl Schema {
    fn definition(&self, reference: &str) -> (&Value, String) {
        let name = reference.rsplit('/').next().expect("a name");
        (&self.document["$defs"][name], in_words(name))
    }

    /// The word that a case of a kind of objects is for, such as `perspective`.
    fn word(case: &Value) -> Option<&str> {
        case["if"]["properties"].as_object()?.values().find_map(|value| value["const"].as_str())
    }

    /// Parts of a schema that its own conditions do not choose, and those that they do.
    fn parts<'a>(schema: &'a Value, record: &str) -> Vec<(&'a Value, Option<&'a Value>, String)> {
        let mut parts = Vec::new();
        for part in schema["allOf"].as_array().into_iter().flatten() {
            match (part.get("then"), Self::word(part)) {
                (Some(then), Some(word)) => parts.push((then, Some(&part["if"]), format!("{record} {word}"))),
                (Some(then), None) => parts.push((then, Some(&part["if"]), record.to_owned())),
                (None, _) => parts.push((part, None, record.to_owned())),
            }
        }
        for key in ["oneOf", "anyOf"] {
            parts.extend(schema[key].as_array().into_iter().flatten().map(|part| (part, None, record.to_owned())));
        }
        parts
    }

    /// Every key and word of a schema, in its order.
    fn rows(&self, schema: &Value, record: &str, seen: &mut BTreeSet<String>, rows: &mut Vec<Row>) {
        if !schema.is_object() {
            return;
        }
        if let Some(reference) = schema["$ref"].as_str().filter(|reference| seen.insert((*reference).to_owned())) {
            let (definition, name) = self.definition(reference);
            self.rows(definition, &name, seen, rows);
        }
        for (key, value) in schema["properties"].as_object().into_iter().flatten() {
            let words: Vec<&str> = value["enum"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
            // A key with words has a row for each word; the tag of a kind has no further meaning.
            if words.is_empty() && key != "type" {
                rows.push((record.to_owned(), key.clone()));
            }
            rows.extend(words.iter().map(|word| (record.to_owned(), format!("{key}: {word}"))));
            self.rows(value, record, seen, rows);
        }
        for key in ["items", "additionalProperties"] {
            self.rows(&schema[key], record, seen, rows);
        }
        for (part, _, record) in Self::parts(schema, record) {
            self.rows(part, &record, seen, rows);
        }
    }

    /// The keys and words that a value says.
    fn said(&self, schema: &Value, value: &Value, record: &str, said: &mut BTreeSet<Row>) {
        if let Some(reference) = schema["$ref"].as_str() {
            let (definition, name) = self.definition(reference);
            self.said(definition, value, &name, said);
        }
        if value.is_object() {
            for (key, of_key) in schema["properties"].as_object().into_iter().flatten() {
                let word = value.get(key).or_else(|| of_key.get("default")).and_then(Value::as_str);
                if let Some(word) = word.filter(|_| of_key["enum"].is_array()) {
                    said.insert((record.to_owned(), format!("{key}: {word}")));
                }
                if let Some(inner) = value.get(key) {
                    said.insert((record.to_owned(), key.clone()));
                    self.said(of_key, inner, record, said);
                }
            }
            if schema["additionalProperties"].is_object() {
                let own = |key: &String| schema["properties"].get(key).is_none();
                for (_, inner) in value.as_object().into_iter().flatten().filter(|(key, _)| own(key)) {
                    self.said(&schema["additionalProperties"], inner, record, said);
                }
            }
        }
        for inner in value.as_array().into_iter().flatten() {
            self.said(&schema["items"], inner, record, said);
        }
        for (part, condition, record) in Self::parts(schema, record) {
            if condition.is_none_or(|condition| holds(condition, value)) {
                self.said(part, value, &record, said);
            }
        }
    }
}

/// Whether a condition of the schema holds: of a type, or of a word.
fn holds(condition: &Value, value: &Value) -> bool {
    let of_type = condition["type"].as_str().is_none_or(|name| match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        _ => true,
    });
    let words = condition["properties"].as_object();
    of_type && words.into_iter().flatten().all(|(key, word)| value.get(key) == word.get("const"))
}

/// The rows, in the order of the schema, with the truths of each.
fn table(list: &[Truth]) -> Vec<(Row, Vec<String>)> {
    let schema = Schema { document: etalon_scene::schema() };
    let mut rows = Vec::new();
    schema.rows(&schema.document, "scene", &mut BTreeSet::new(), &mut rows);
    let mut of_row: BTreeMap<Row, Vec<String>> = BTreeMap::new();
    for truth in list {
        let scene: Value = serde_json::from_str(&truth.scene).expect("a truth's scene is JSON");
        let mut said = BTreeSet::new();
        schema.said(&schema.document, &scene, "scene", &mut said);
        for row in said {
            of_row.entry(row).or_default().push(truth.name.clone());
        }
    }
    let mut known = BTreeSet::new();
    rows.retain(|row| known.insert(row.clone()));
    rows.into_iter().map(|row| (row.clone(), of_row.remove(&row).unwrap_or_default())).collect()
}

const HEAD: &str = "# What scenes can say, and who would notice

Each row is a key of the [scene format](scene-format.md), or a word that may stand under it. The last column lists truths of
[the oracle](../crates/oracle/README.md) whose scenes say it. `etalon verify NAME` renders one. The rows come from `etalon schema`. A word
that is the default counts where the key is left out. A truth in a row has the feature in its picture. It need not be the only one, and it
need not see every mistake.

`cargo xtask vocabulary --write` writes this page. A test fails if it is out of date, or if a key that can change light has fewer than two truths.

| of | key | truths | such as |
|---|---|---|---|
";

fn page(table: &[(Row, Vec<String>)]) -> String {
    let mut page = HEAD.to_owned();
    for (row, truths) in table {
        let (record, key) = row;
        let names = match (without_light(row), &truths[..]) {
            (Some(reason), _) => format!("changes no light: {reason}"),
            (None, truths) => {
                // Those with the fewest other things in their scenes come last in the list, as the newest; three are enough.
                let named: Vec<String> = truths.iter().rev().take(3).map(|name| format!("`{name}`")).collect();
                named.join(", ")
            }
        };
        let count = if without_light(row).is_some() { "–".to_owned() } else { truths.len().to_string() };
        let _ = writeln!(page, "| {record} | `{key}` | {count} | {names} |");
    }
    page
}

#[test]
fn every_key_that_can_change_light_has_two_truths() {
    let table = table(&truths());
    let scarce: Vec<&Row> = table
        .iter()
        .filter(|(row, truths)| truths.len() < 2 && without_light(row).is_none())
        .map(|(row, _)| row)
        .collect();
    assert!(table.len() > 300, "{} rows", table.len());
    assert!(scarce.is_empty(), "fewer than two truths say {} keys: {scarce:#?}", scarce.len());
}

#[test]
fn the_page_is_up_to_date() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/vocabulary.md");
    let page = page(&table(&truths()));
    if std::env::var_os("ETALON_UPDATE_SNAPSHOTS").is_some() {
        std::fs::write(path, &page).expect("the page can be written");
    }
    let held = std::fs::read_to_string(path).expect("the page is there");
    assert!(held == page, "docs/vocabulary.md is out of date: cargo xtask vocabulary --write");
}

#[test]
fn the_scenes_of_all_truths_are_read_without_a_remark_and_keep_to_the_schema() {
    let schema = jsonschema::draft202012::new(&etalon_scene::schema()).expect("a usable schema");
    for truth in truths() {
        let value: Value = serde_json::from_str(&truth.scene).expect("JSON");
        let faults: Vec<String> = schema.iter_errors(&value).map(|e| format!("{}: {e}", e.instance_path())).collect();
        assert!(faults.is_empty(), "{}: {faults:#?}", truth.name);
        let files: Vec<NamedFile> =
            truth.files.iter().map(|file| NamedFile { name: file.name.clone(), bytes: file.bytes.clone() }).collect();
        match etalon_scene::parse_with_files(&truth.scene, &truth.name, &files, None) {
            Ok(loaded) => {
                // Skies have no objects, pictures that must stay black no light, and some files an alpha channel that is not asked for.
                let expected = [Code::NoObjects, Code::NoLight, Code::LeftOut];
                let remarks: Vec<_> =
                    loaded.warnings.iter().filter(|problem| !expected.contains(&problem.code)).collect();
                assert!(remarks.is_empty(), "{}: {remarks:#?}", truth.name);
                assert_eq!(loaded.files.len(), files.len(), "{}: a file that the scene does not name", truth.name);
            }
            Err(errors) => panic!("{}: {errors}", truth.name),
        }
    }
}
