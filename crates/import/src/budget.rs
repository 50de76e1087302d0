//! Bounds on what a few lines of a file can ask for by naming things again and again.

use std::collections::HashMap;

use etalon_scene::MOST_BLEND_PARTS;
use etalon_scene::json::{MAX_BYTES, MAX_VALUES};
use serde_json::{Map, Value};

/// Deepest nesting of blends: the levels that a scene may have leave room for no more.
const MAX_BLENDS: usize = 32;

/// What has been copied into a scene so far. No more is made of a file than a scene can hold.
#[derive(Debug, Default)]
pub(crate) struct Budget {
    values: usize,
    /// Of texts.
    bytes: usize,
}

impl Budget {
    /// Counts a value and all that is in it.
    ///
    /// # Errors
    /// If a scene cannot hold that much.
    pub(crate) fn spend(&mut self, value: &Value, place: &str) -> Result<(), String> {
        self.count(value);
        if self.values > MAX_VALUES || self.bytes > MAX_BYTES {
            return Err(format!(
                "{place}: up to here the file becomes more than {MAX_VALUES} values or {MAX_BYTES} bytes of text, \
                 more than a scene can hold"
            ));
        }
        Ok(())
    }

    fn count(&mut self, value: &Value) {
        self.values += 1;
        match value {
            Value::String(text) => self.bytes += text.len(),
            Value::Array(elements) => elements.iter().for_each(|element| self.count(element)),
            Value::Object(members) => {
                for (key, member) in members {
                    self.bytes += key.len();
                    self.count(member);
                }
            }
            Value::Null | Value::Bool(_) | Value::Number(_) => {}
        }
    }
}

/// How large a material is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BlendSize {
    /// Materials in it that are no blends.
    parts: usize,
    /// Blends within each other.
    depth: usize,
}

impl BlendSize {
    /// That of a material that is no blend.
    pub(crate) const ONE: Self = Self { parts: 1, depth: 0 };

    /// That of a material of the format.
    pub(crate) fn of(material: &Value) -> Self {
        if material["type"] != "blend" {
            return Self::ONE;
        }
        let [first, second] = ["first", "second"].map(|part| Self::of(&material[part]));
        first.beside(second)
    }

    fn beside(self, other: Self) -> Self {
        Self { parts: self.parts + other.parts, depth: 1 + self.depth.max(other.depth) }
    }

    /// That of a blend of two materials.
    ///
    /// # Errors
    /// If a scene cannot hold it.
    pub(crate) fn blend(self, other: Self, place: &str) -> Result<Self, String> {
        let size = self.beside(other);
        if size.parts > MOST_BLEND_PARTS || size.depth > MAX_BLENDS {
            let Self { parts, depth } = size;
            return Err(format!(
                "{place}: a blend of {parts} materials and {depth} levels, counting blends inside blends; at most \
                 {MOST_BLEND_PARTS} materials and {MAX_BLENDS} levels"
            ));
        }
        Ok(size)
    }
}

/// Names that differ, each found without trying all that were made before.
#[derive(Debug, Default)]
pub(crate) struct FreshNames {
    /// The number to try next, by the name that was wanted.
    next: HashMap<String, usize>,
}

impl FreshNames {
    /// A name that is not taken: `wanted`, or that and a number.
    pub(crate) fn name(&mut self, wanted: &str, taken: &Map<String, Value>) -> String {
        if !taken.contains_key(wanted) {
            return wanted.to_owned();
        }
        let next = self.next.entry(wanted.to_owned()).or_insert(2);
        loop {
            let name = format!("{wanted} {next}");
            *next += 1;
            if !taken.contains_key(&name) {
                return name;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn copies_are_made_until_a_scene_can_hold_no_more() {
        let copies = |value: &Value| {
            let mut budget = Budget::default();
            (0_usize..).find(|_| budget.spend(value, "line 7").is_err_and(|why| why.starts_with("line 7: ")))
        };
        // Two arrays, an object and a million numbers; a key and a text of 2²⁰ bytes.
        let numbers = json!({ "a": [vec![1.0; 1_000_000]] });
        assert_eq!(copies(&numbers), Some(MAX_VALUES / 1_000_003));
        assert_eq!(copies(&json!({ "key": "x".repeat((1 << 20) - 3) })), Some(MAX_BYTES >> 20));
    }

    #[test]
    fn fresh_names_pass_by_those_that_are_taken() {
        let mut names = FreshNames::default();
        let mut taken = Map::new();
        taken.insert("a 3".to_owned(), Value::Null);
        for expected in ["a", "a 2", "a 4", "a 5"] {
            let name = names.name("a", &taken);
            assert_eq!(name, expected);
            taken.insert(name, Value::Null);
        }
    }
}
