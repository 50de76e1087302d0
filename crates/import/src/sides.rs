//! The sides of a surface that reflect.

use serde_json::{Value, json};

/// Changes which sides of a surface reflect, in a material of the format and in its parts.
pub(crate) fn change_sides(value: &mut Value, change: &impl Fn(&str) -> &'static str) {
    let Value::Object(map) = value else { return };
    if let Some(sides) = map.get_mut("sides") {
        *sides = json!(change(sides.as_str().unwrap_or("both")));
    }
    if map.get("type").is_some_and(|kind| kind == "two-sided") && change("front") == "back" {
        let [front, back] = ["front", "back"].map(|side| map.remove(side).unwrap_or_default());
        map.extend([("front".to_owned(), back), ("back".to_owned(), front)]);
    }
    map.values_mut().for_each(|value| change_sides(value, change));
}
