//! Objects with known keys.

use super::{
    Code, Comment, Decode, Field, FieldSchema, Node, Place, Reader, SchemaBuilder, Span, describe, did_you_mean,
    listed, neighbour,
};

/// Which keys of an object go together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// Exactly one of these keys must be there.
    OneOf(&'static [&'static str]),
    /// Where the first key is, the others must be.
    Needs(&'static str, &'static [&'static str]),
    /// Two keys that exclude each other.
    NotBoth(&'static str, &'static str),
}

/// A type that is an object with known keys; [`record!`](crate::record) declares them.
pub trait Record: Sized {
    /// Its keys.
    const KEYS: &'static [&'static str];
    /// Whether it also takes a `comment`, which is checked and forgotten.
    const COMMENTED: bool;
    /// Which keys go together.
    const RULES: &'static [Rule];

    /// Takes the fields out of an object.
    fn read(object: &mut ObjectReader<'_>, reader: &mut Reader<'_>) -> Self;

    /// What it is, from its documentation.
    fn description() -> String;

    /// Schemas of the fields.
    fn fields(schema: &mut SchemaBuilder) -> Vec<FieldSchema>;
}

impl<T: Record> Record for Box<T> {
    const KEYS: &'static [&'static str] = T::KEYS;
    const COMMENTED: bool = T::COMMENTED;
    const RULES: &'static [Rule] = T::RULES;

    fn read(object: &mut ObjectReader<'_>, reader: &mut Reader<'_>) -> Self {
        Self::new(T::read(object, reader))
    }

    fn description() -> String {
        T::description()
    }

    fn fields(schema: &mut SchemaBuilder) -> Vec<FieldSchema> {
        T::fields(schema)
    }
}

/// An object whose members are being taken out by key.
///
/// Repeated keys and unknown keys are reported when it is made. An unknown key that is a misspelling of an absent one, or
/// another program's word for it, is read as that one: its value is checked too, and nothing is reported missing twice.
#[derive(Debug)]
pub struct ObjectReader<'n> {
    span: Span,
    members: Vec<(&'n str, Span, Node<'n>)>,
}

impl<'n> ObjectReader<'n> {
    /// Takes hold of an object that may have `keys`; `None`, and an error, if it is something else.
    pub fn new(node: Node<'n>, keys: &[&'static str], reader: &mut Reader<'_>) -> Option<Self> {
        let span = reader.span(node);
        let Some(found) = node.members() else {
            reader.error(Code::WrongType, span, format!("expected an object, found {}", node.kind().name()));
            return None;
        };
        let mut members: Vec<(&str, Span, Node<'n>)> = Vec::with_capacity(found.len().min(64));
        let mut unknown = Vec::new();
        // A known key can be met at most once below, and unknown ones are only compared when they are.
        let mut strangers = std::collections::HashMap::new();
        for (key, at, value) in found {
            if keys.contains(&key) {
                match members.iter().find(|m| m.0 == key) {
                    Some(first) => duplicate(key, first.1, at, reader),
                    None => members.push((key, at, value)),
                }
            } else if let Some(&first) = strangers.get(key) {
                duplicate(key, first, at, reader);
            } else {
                strangers.insert(key, at);
                unknown.push((key, at, value));
            }
        }
        for (key, at, value) in unknown {
            if reader.is_full() {
                // Only counted from here on, so no time is spent on guesses.
                reader.error(Code::UnknownKey, at, String::new());
                continue;
            }
            let is_there = |key: &str| members.iter().any(|m| m.0 == key);
            let message = format!("unknown key \"{key}\"");
            if let Some(answer) = neighbour(Place::Key, key, keys) {
                let hint = match answer.word() {
                    Some(meant) if is_there(meant) => format!("\"{meant}\" is there already"),
                    _ => answer.hint(),
                };
                if let Some(meant) = answer.word().filter(|meant| !is_there(meant)) {
                    members.push((meant, at, value));
                }
                reader.error_hint(Code::UnknownKey, at, message, hint);
            } else if let Some(meant) = did_you_mean(key, keys.iter().copied().filter(|key| !is_there(key))) {
                members.push((meant, at, value));
                reader.error_hint(Code::UnknownKey, at, message, format!("did you mean \"{meant}\"?"));
            } else if let Some(meant) = did_you_mean(key, keys.iter().copied()) {
                reader.error_hint(Code::UnknownKey, at, message, format!("\"{meant}\" is there already"));
            } else if keys.is_empty() {
                reader.error_hint(Code::UnknownKey, at, message, "this object takes no keys");
            } else {
                let hint = format!("the keys here are {}", listed(keys.iter().copied()));
                reader.error_hint(Code::UnknownKey, at, message, hint);
            }
        }
        Some(Self { span, members })
    }

    /// Takes hold of a record's object; `tag` is a further key, which the caller reads.
    pub fn of<R: Record>(node: Node<'n>, tag: Option<&'static str>, reader: &mut Reader<'_>) -> Option<Self> {
        let comment = R::COMMENTED.then_some("comment");
        let keys: Vec<&str> = tag.into_iter().chain(R::KEYS.iter().copied()).chain(comment).collect();
        let object = Self::new(node, &keys, reader)?;
        if R::COMMENTED
            && let Some((_, value)) = object.get("comment")
        {
            // Only for what is wrong with it.
            let _ = Comment::decode(value, reader);
        }
        for rule in R::RULES {
            object.check(rule, reader);
        }
        Some(object)
    }

    fn check(&self, rule: &Rule, reader: &mut Reader<'_>) {
        match *rule {
            Rule::OneOf(keys) => {
                let mut present = keys.iter().filter_map(|key| Some((key, self.get(key)?.0)));
                match (present.next(), present.next()) {
                    (None, _) => {
                        let hint = format!("add exactly one of {}", listed(keys.iter().copied()));
                        reader.error_hint(Code::MissingKey, self.span.head(), "a required key is missing", hint);
                    }
                    (Some((first, at)), Some((second, other))) => {
                        let message = format!("\"{first}\" and \"{second}\" exclude each other");
                        let label = (at, "the other one");
                        reader.error_related(Code::KeyConflict, other, message, "keep one of them", label);
                    }
                    (Some(_), None) => {}
                }
            }
            Rule::NotBoth(first, second) => {
                if let (Some((first_at, _)), Some((second_at, _))) = (self.get(first), self.get(second)) {
                    let message = format!("\"{first}\" and \"{second}\" exclude each other");
                    let label = (first_at, "the other one");
                    reader.error_related(Code::KeyConflict, second_at, message, "keep one of them", label);
                }
            }
            Rule::Needs(key, others) => {
                let Some((at, _)) = self.get(key) else { return };
                for other in others.iter().filter(|other| self.get(other).is_none()) {
                    reader.error_hint(Code::MissingKey, at, format!("\"{key}\" needs \"{other}\""), "add it");
                }
            }
        }
    }

    /// The place of the object.
    pub fn span(&self) -> Span {
        self.span
    }

    /// Place of the key, and the value, if the key is there.
    pub fn get(&self, key: &str) -> Option<(Span, Node<'n>)> {
        self.members.iter().find(|m| m.0 == key).map(|&(_, at, value)| (at, value))
    }

    /// Takes out a field: its value, else its default (as JSON), else an error if it is required.
    pub fn field<F: Field>(
        &mut self,
        key: &'static str,
        default: Option<&'static str>,
        documentation: &[&str],
        reader: &mut Reader<'_>,
    ) -> F {
        if let Some((_, value)) = self.get(key) {
            return F::of(value, reader);
        }
        if let Some(default) = default {
            return reader.with_default(default, self.span.head(), F::of);
        }
        if F::REQUIRED {
            let hint = format!("\"{key}\": {}", describe(documentation).trim_end_matches('.'));
            reader.error_hint(Code::MissingKey, self.span.head(), format!("missing key \"{key}\""), hint);
        }
        F::absent()
    }
}

fn duplicate(key: &str, first: Span, at: Span, reader: &mut Reader<'_>) {
    let message = format!("the key \"{key}\" appears twice");
    reader.error_related(Code::DuplicateKey, at, message, "remove one of the two", (first, "first here"));
}

/// Decodes an object whose keys are names that the file chooses, in the order of the file.
pub(super) fn named_entries<'n, T>(
    node: Node<'n>,
    reader: &mut Reader<'_>,
    mut decode: impl FnMut(&'n str, Span, Node<'n>, &mut Reader<'_>) -> T,
) -> Option<Vec<T>> {
    let Some(members) = node.members() else {
        let message = format!("expected an object of named entries, found {}", node.kind().name());
        reader.error(Code::WrongType, reader.span(node), message);
        return None;
    };
    let mut seen = std::collections::HashMap::new();
    let mut entries = Vec::with_capacity(members.len());
    for (name, at, value) in members {
        match seen.insert(name, at) {
            Some(first) => {
                duplicate(name, first, at, reader);
                seen.insert(name, first);
            }
            None => entries.push(decode(name, at, value, reader)),
        }
    }
    Some(entries)
}
