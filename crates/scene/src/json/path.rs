//! From a place in the text to its JSON path.

use jsonc_parser::ast::Value;
use jsonc_parser::common::Ranged;

use super::Span;

/// The JSON path of the innermost value or key that holds `span`.
///
/// The path is found by descent from the root when a problem is reported, so decoding carries none along.
pub(super) fn json_path(root: &Value<'_>, span: Span) -> String {
    let mut path = String::from("$");
    let mut value = root;
    loop {
        match value {
            Value::Object(object) => {
                // Members stand in the order of the text.
                let i = object.properties.partition_point(|p| p.range.end < span.end);
                let Some(member) = object.properties.get(i) else { return path };
                if !Span::new(member.range.start, member.range.end).contains(span) {
                    return path;
                }
                push_key(&mut path, member.name.as_str());
                value = &member.value;
            }
            Value::Array(array) => {
                let i = array.elements.partition_point(|e| e.range().end < span.end);
                let Some(element) = array.elements.get(i) else { return path };
                if !Span::new(element.range().start, element.range().end).contains(span) {
                    return path;
                }
                path += &format!("[{i}]");
                value = element;
            }
            _ => return path,
        }
    }
}

fn push_key(path: &mut String, key: &str) {
    let simple = key.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if simple {
        path.push('.');
        path.push_str(key);
    } else {
        path.push('[');
        path.push_str(&serde_json::Value::from(key).to_string());
        path.push(']');
    }
}
