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

/// The schema of a record.
pub fn record_schema<R: Record>(schema: &mut SchemaBuilder) -> Value {
    let mut record = tagged_record_schema::<R>(None, schema);
    record["type"] = "object".into();
    if let Some(choices) = record.get_mut("allOf") {
        // Of what is no object, only the type is wrong.
        *choices = json!([{ "if": { "type": "object" }, "then": { "allOf": choices } }]);
    }
    record
}

/// What holds of the objects of a record. `tag` is a further key, which the caller requires.
///
/// It says nothing of other values than objects, so that they get one error from the caller, not one from each kind.
pub fn tagged_record_schema<R: Record>(tag: Option<&str>, schema: &mut SchemaBuilder) -> Value {
    let mut properties = Map::new();
    let mut required = Vec::new();
    if let Some(key) = tag {
        properties.insert(key.to_owned(), json!({ "description": R::description() }));
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

/// The schema of an object of several kinds, told apart by the word under a key.
///
/// Only the schema of the object's own kind applies, so that editors offer the keys of that kind and report one error for each
/// mistake.
pub fn one_of(description: &str, tag: &str, kinds: Vec<(&str, Value)>) -> Value {
    let descriptions =
        kinds.iter().map(|(word, kind)| (*word, kind["description"].as_str().unwrap_or_default().to_owned()));
    let mut tag_schema = words(&descriptions.collect::<Vec<_>>());
    tag_schema["description"] = description.into();
    let cases: Vec<Value> = kinds
        .into_iter()
        .map(|(word, kind)| {
            json!({ "if": { "type": "object", "properties": { tag: { "const": word } }, "required": [tag] }, "then": kind })
        })
        .collect();
    json!({
        "description": description,
        "type": "object",
        "properties": { tag: tag_schema },
        "required": [tag],
        "allOf": cases,
    })
}

/// The schema of a value of one of several JSON types, each with a schema of its own.
pub fn by_json_type(kinds: Vec<(&str, Value)>) -> Value {
    let types: Vec<&str> = kinds.iter().map(|(name, _)| *name).collect();
    // Editors offer examples where there is no value yet.
    let examples: Vec<Value> =
        kinds.iter().filter_map(|(_, kind)| kind["enum"].as_array()).flatten().cloned().collect();
    let cases: Vec<Value> = kinds
        .iter()
        .filter(|(name, kind)| *kind != json!({ "type": name }))
        .map(|(name, kind)| json!({ "if": { "type": name }, "then": kind }))
        .collect();
    let mut schema = json!({ "type": types });
    if !cases.is_empty() {
        schema["allOf"] = cases.into();
    }
    if !examples.is_empty() {
        schema["examples"] = examples.into();
    }
    schema
}

/// The schema of a string that is one of some words, each with what it means.
pub fn words(words: &[(&str, String)]) -> Value {
    let (words, meanings): (Vec<&str>, Vec<&String>) = words.iter().map(|(word, meaning)| (*word, meaning)).unzip();
    // The second is a keyword of editors; validators ignore it.
    json!({ "enum": words, "enumDescriptions": meanings })
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
