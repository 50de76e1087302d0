//! What can be decoded from a JSON value, and its schema.

use serde_json::json;

use super::object::named_entries;
use super::{
    Answer, Code, Kind, Node, Place, Reader, SchemaBuilder, Span, by_json_type, did_you_mean, listed, neighbour,
};

/// A type that a JSON value can be decoded to.
pub trait Decode: Sized {
    /// The JSON Schema of the values that are accepted.
    fn schema(schema: &mut SchemaBuilder) -> serde_json::Value;

    /// Decodes a value; every error in it goes to the reader. `None` only after an error.
    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self>;
}

/// The type of a field of a [`record!`](crate::record).
pub trait Field: Sized {
    /// Whether a file that lacks it, and for which there is no default, is wrong.
    const REQUIRED: bool;

    /// The JSON Schema of the value.
    fn schema(schema: &mut SchemaBuilder) -> serde_json::Value;

    /// From the value.
    fn of(node: Node<'_>, reader: &mut Reader<'_>) -> Self;

    /// Without one.
    fn absent() -> Self;
}

/// A field that must be there, or has a default; `None` if it was missing or wrong, which has been reported.
pub type Required<T> = Option<T>;

impl<T: Decode> Field for Required<T> {
    const REQUIRED: bool = true;

    fn schema(schema: &mut SchemaBuilder) -> serde_json::Value {
        T::schema(schema)
    }

    fn of(node: Node<'_>, reader: &mut Reader<'_>) -> Self {
        T::decode(node, reader)
    }

    fn absent() -> Self {
        None
    }
}

/// A field that may be left out.
#[derive(Clone, Debug, PartialEq)]
pub enum Optional<T> {
    /// It is not there.
    Absent,
    /// It is there but wrong, which has been reported.
    Invalid,
    /// Its value.
    Given(T),
}

impl<T> Optional<T> {
    /// The value, if there is a right one.
    pub fn given(&self) -> Option<&T> {
        match self {
            Self::Given(value) => Some(value),
            Self::Absent | Self::Invalid => None,
        }
    }

    /// Whether the file has the key, right or wrong.
    pub fn is_present(&self) -> bool {
        !matches!(self, Self::Absent)
    }

    /// Applies `f` to a value that is there and right.
    pub fn map<U>(self, f: impl FnOnce(T) -> U) -> Optional<U> {
        match self {
            Self::Absent => Optional::Absent,
            Self::Invalid => Optional::Invalid,
            Self::Given(value) => Optional::Given(f(value)),
        }
    }

    /// `Some(None)` if it is absent, `Some(Some(value))` if it is right, `None` if it is wrong.
    pub fn checked(self) -> Option<Option<T>> {
        match self {
            Self::Absent => Some(None),
            Self::Invalid => None,
            Self::Given(value) => Some(Some(value)),
        }
    }
}

impl<T: Decode> Field for Optional<T> {
    const REQUIRED: bool = false;

    fn schema(schema: &mut SchemaBuilder) -> serde_json::Value {
        T::schema(schema)
    }

    fn of(node: Node<'_>, reader: &mut Reader<'_>) -> Self {
        T::decode(node, reader).map_or(Self::Invalid, Self::Given)
    }

    fn absent() -> Self {
        Self::Absent
    }
}

/// A value and its place, for what can only be checked later.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spanned<T> {
    /// The value.
    pub value: T,
    /// Its place.
    pub at: Span,
}

impl<T: Decode> Decode for Spanned<T> {
    fn schema(schema: &mut SchemaBuilder) -> serde_json::Value {
        T::schema(schema)
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        let at = reader.span(node);
        Some(Self { value: T::decode(node, reader)?, at })
    }
}

impl<T: Decode> Decode for Box<T> {
    fn schema(schema: &mut SchemaBuilder) -> serde_json::Value {
        T::schema(schema)
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        T::decode(node, reader).map(Self::new)
    }
}

pub(super) fn wrong_type(expected: &str, node: Node<'_>, reader: &mut Reader<'_>) {
    let at = reader.span(node);
    let message = format!("expected {expected}, found {}", node.kind().name());
    match node.kind() {
        Kind::String(text) if expected.ends_with("number") && text.trim().parse::<f64>().is_ok() => {
            reader.error_hint(Code::WrongType, at, message, "remove the quotes");
        }
        Kind::Null => reader.error_hint(Code::WrongType, at, message, "leave the key out, or give a value"),
        _ => reader.error(Code::WrongType, at, message),
    }
}

impl Decode for bool {
    fn schema(_: &mut SchemaBuilder) -> serde_json::Value {
        json!({ "type": "boolean" })
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        match node.kind() {
            Kind::Bool(value) => Some(value),
            _ => {
                wrong_type("true or false", node, reader);
                None
            }
        }
    }
}

impl Decode for String {
    fn schema(_: &mut SchemaBuilder) -> serde_json::Value {
        json!({ "type": "string" })
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        match node.kind() {
            Kind::String(value) => Some(value.to_owned()),
            _ => {
                wrong_type("a string", node, reader);
                None
            }
        }
    }
}

/// `null`, or a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Nullable<T> {
    /// `null`.
    Null,
    /// A value.
    Value(T),
}

impl<T: Decode> Decode for Nullable<T> {
    fn schema(schema: &mut SchemaBuilder) -> serde_json::Value {
        let value = T::schema(schema);
        match value["type"].as_str().map(str::to_owned) {
            Some(name) => by_json_type(vec![("null", json!({ "type": "null" })), (&name, value)]),
            None => json!({ "anyOf": [{ "type": "null" }, value] }),
        }
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        match node.kind() {
            Kind::Null => Some(Self::Null),
            _ => T::decode(node, reader).map(Self::Value),
        }
    }
}

/// A remark: a string or a list of strings (lines). Nothing is made of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Comment;

impl Decode for Comment {
    fn schema(_: &mut SchemaBuilder) -> serde_json::Value {
        json!({ "type": ["string", "array"], "items": { "type": "string" } })
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        match node.kind() {
            Kind::String(_) => Some(Self),
            Kind::Array(_) => List::<String>::decode(node, reader)?.complete().map(|_| Self),
            _ => {
                wrong_type("a string or a list of strings", node, reader);
                None
            }
        }
    }
}

/// A list; elements that are wrong, which has been reported, are `None`.
///
/// Large elements belong in a [`Box`]: a hostile file may hold millions of wrong ones.
#[derive(Clone, Debug, PartialEq)]
pub struct List<T>(pub Vec<Option<T>>);

impl<T> List<T> {
    /// Every element, if all are right.
    pub fn complete(self) -> Option<Vec<T>> {
        self.0.into_iter().collect()
    }
}

impl<T: Decode> Decode for List<T> {
    fn schema(schema: &mut SchemaBuilder) -> serde_json::Value {
        json!({ "type": "array", "items": T::schema(schema) })
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        let Some(elements) = node.elements() else {
            wrong_type("a list", node, reader);
            return None;
        };
        Some(Self(elements.map(|element| T::decode(element, reader)).collect()))
    }
}

impl<T: Decode, const N: usize> Decode for [T; N] {
    fn schema(schema: &mut SchemaBuilder) -> serde_json::Value {
        json!({ "type": "array", "items": T::schema(schema), "minItems": N, "maxItems": N })
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        let Some(elements) = node.elements() else {
            wrong_type(&format!("a list of {N}"), node, reader);
            return None;
        };
        let found = elements.len();
        let mut decoded: [Option<T>; N] = std::array::from_fn(|_| None);
        for (i, element) in elements.enumerate() {
            let value = T::decode(element, reader);
            if let Some(slot) = decoded.get_mut(i) {
                *slot = value;
            }
        }
        if found != N {
            let message = format!("expected a list of {N}, found {found}");
            reader.error(Code::WrongLength, reader.span(node).head(), message);
            return None;
        }
        let mut complete = Vec::with_capacity(N);
        for value in decoded {
            complete.push(value?);
        }
        complete.try_into().ok()
    }
}

/// A direction: three numbers, not all 0, of which only the direction counts. Held as a unit vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction(pub [f64; 3]);

impl Decode for Direction {
    fn schema(schema: &mut SchemaBuilder) -> serde_json::Value {
        let mut value = <[f64; 3]>::schema(schema);
        // What is left of "not all 0" for a language without arithmetic.
        value["not"] = json!({ "const": [0, 0, 0] });
        value
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        let vector = <[f64; 3]>::decode(node, reader)?;
        let unit = crate::linear::unit(vector.into());
        if unit.is_none() {
            reader.error(Code::ZeroVector, reader.span(node), "a zero vector has no direction");
        }
        unit.map(|unit| Self(unit.to_array()))
    }
}

/// An entry of [`Named`].
#[derive(Clone, Debug, PartialEq)]
pub struct NamedEntry<T> {
    /// The name.
    pub name: String,
    /// Place of the name.
    pub at: Span,
    /// The value; `None` if it was wrong, which has been reported.
    pub value: Option<T>,
}

/// An object whose keys are names that the file chooses, in the order of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Named<T>(pub Vec<NamedEntry<T>>);

impl<T: Decode> Decode for Named<T> {
    fn schema(schema: &mut SchemaBuilder) -> serde_json::Value {
        json!({ "type": "object", "additionalProperties": T::schema(schema) })
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        named_entries(node, reader, |name, at, value, reader| NamedEntry {
            name: name.to_owned(),
            at,
            value: T::decode(value, reader),
        })
        .map(Self)
    }
}

/// The one of `words` that a string is, or was probably meant to be (which is an error, too).
pub fn keyword(node: Node<'_>, words: &[&'static str], reader: &mut Reader<'_>) -> Option<&'static str> {
    let Kind::String(given) = node.kind() else {
        wrong_type("a string", node, reader);
        return None;
    };
    if let Some(word) = words.iter().find(|w| **w == given) {
        return Some(word);
    }
    let message = format!("unknown word \"{given}\"");
    let answer = neighbour(Place::Keyword, given, words);
    let meant = answer.map_or_else(|| did_you_mean(given, words.iter().copied()), Answer::word);
    let hint = match (answer, meant) {
        (Some(answer), _) => answer.hint(),
        (None, Some(meant)) => format!("did you mean \"{meant}\"?"),
        (None, None) => format!("the words here are {}", listed(words.iter().copied())),
    };
    reader.error_hint(Code::UnknownWord, reader.span(node), message, hint);
    // Back to the static one.
    meant.and_then(|meant| words.iter().copied().find(|w| *w == meant))
}

/// The variant that an object's `key` names, among `words`; an error if it names none.
///
/// A misspelt key or word is read as what was probably meant, so that the rest of the object is checked, too.
pub fn tag(node: Node<'_>, key: &str, words: &[&'static str], reader: &mut Reader<'_>) -> Option<&'static str> {
    let at = reader.span(node);
    let Some(mut members) = node.members() else {
        wrong_type("an object", node, reader);
        return None;
    };
    let exact = members.find(|m| m.0 == key);
    // `ObjectReader` reports the misspelt key.
    let means_key =
        |given: &str| did_you_mean(given, [key]).is_some() || neighbour(Place::Key, given, &[key]).is_some();
    let misspelt = || node.members().and_then(|mut all| all.find(|m| means_key(m.0)));
    match exact.or_else(misspelt) {
        Some((_, _, value)) => keyword(value, words, reader),
        None => {
            let hint = format!("one of {}", listed(words.iter().copied()));
            reader.error_hint(Code::MissingKey, at.head(), format!("missing key \"{key}\""), hint);
            None
        }
    }
}
