//! The JSON Schema of what is decoded.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use super::{Comment, Decode, Field, Record, Rule, syntax};

/// A JSON Schema, or a part of one.
pub type SchemaValue = Value;

/// Collects the named parts of a schema.
#[derive(Debug, Default)]
pub struct SchemaBuilder {
    parts: BTreeMap<&'static str, Value>,
}

impl SchemaBuilder {
    /// Defines a part once and refers to it.
    pub fn define(&mut self, name: &'static str, part: impl FnOnce(&mut Self) -> Value) -> Value {
        if !self.parts.contains_key(name) {
            // Holds the place, so that a part may refer to itself.
            self.parts.insert(name, Value::Null);
            let part = part(self);
            self.parts.insert(name, part);
        }
        json!({ "$ref": format!("#/$defs/{name}") })
    }
}

/// The schema of a field of a record.
#[derive(Clone, Debug)]
pub struct FieldSchema {
    key: &'static str,
    required: bool,
    schema: Value,
}

impl FieldSchema {
    /// From the field's declaration.
    pub fn of<F: Field>(
        key: &'static str,
        documentation: &[&str],
        default: Option<&str>,
        schema: &mut SchemaBuilder,
    ) -> Self {
        let mut value = F::schema(schema);
        value["description"] = describe(documentation).into();
        if let Some(default) = default {
            value["default"] = serde_json::from_str(default)
                .unwrap_or_else(|error| panic!("the default {default} of {key} is not JSON: {error}"));
            debug_assert!(syntax::parse(default).value.is_some());
        }
        Self { key, required: F::REQUIRED && default.is_none(), schema: value }
    }
}

/// A description from the lines of a documentation comment.
pub fn describe(lines: &[&str]) -> String {
    lines.iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ").trim().to_owned()
}

/// The schema of a record; `tag` is a further key and the word that it must be.
pub fn record_schema<R: Record>(tag: Option<(&str, &str)>, schema: &mut SchemaBuilder) -> Value {
    let mut properties = Map::new();
    let mut required = Vec::new();
    if let Some((key, word)) = tag {
        properties.insert(key.to_owned(), json!({ "const": word, "description": R::description() }));
        required.push(key);
    }
    for field in R::fields(schema) {
        properties.insert(field.key.to_owned(), field.schema);
        if field.required {
            required.push(field.key);
        }
    }
    if R::COMMENTED {
        let mut comment = Comment::schema(schema);
        comment["description"] = "A remark, or a list of lines. It changes nothing.".into();
        properties.insert("comment".to_owned(), comment);
    }
    let mut record = json!({
        "type": "object",
        "description": R::description(),
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    });
    let (mut choices, mut needs) = (Vec::new(), Map::new());
    for rule in R::RULES {
        match *rule {
            Rule::OneOf(keys) => {
                let each: Vec<Value> = keys.iter().map(|key| json!({ "required": [key] })).collect();
                choices.push(json!({ "oneOf": each }));
            }
            Rule::NotBoth(first, second) => {
                choices.push(json!({ "not": { "required": [first, second] } }));
            }
            Rule::Needs(key, others) => {
                needs.insert(key.to_owned(), json!(others));
            }
        }
    }
    if !choices.is_empty() {
        record["allOf"] = choices.into();
    }
    if !needs.is_empty() {
        record["dependentRequired"] = needs.into();
    }
    record
}

/// The schema of a value that is of exactly one of several kinds.
pub fn one_of(description: String, kinds: Vec<Value>) -> Value {
    json!({ "description": description, "oneOf": kinds })
}

/// The schema of a string that is one of some words, each with what it means.
pub fn words(words: &[(&str, String)]) -> Value {
    let kinds: Vec<Value> =
        words.iter().map(|(word, meaning)| json!({ "const": word, "description": meaning })).collect();
    json!({ "oneOf": kinds })
}

/// The whole schema (JSON Schema 2020-12) of files that hold a `T`.
pub fn document_schema<T: Decode>(title: &str) -> Value {
    let mut builder = SchemaBuilder::default();
    let root = T::schema(&mut builder);
    let mut document = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": title,
    });
    // A reference may have siblings, so the root can stay one of the definitions.
    if let (Some(document), Value::Object(root)) = (document.as_object_mut(), root) {
        document.extend(root);
        document.insert("$defs".to_owned(), json!(builder.parts));
    }
    document
}
