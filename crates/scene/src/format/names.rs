//! Names that a file gives, and references to them.

use std::collections::HashMap;

use crate::json::{Code, NamedEntry, Place, Reader, Spanned, did_you_mean, listed, neighbour};

/// The names of one of the file's collections.
#[derive(Debug)]
pub(crate) struct Names<'f> {
    /// What a name stands for: `material`.
    what: &'static str,
    /// The key of the collection: `materials`.
    collection: &'static str,
    /// Which words of other programs can be meant.
    place: Place,
    order: Vec<&'f str>,
    index: HashMap<&'f str, usize>,
}

impl<'f> Names<'f> {
    pub(crate) fn new<T>(
        what: &'static str,
        collection: &'static str,
        place: Place,
        entries: &'f [NamedEntry<T>],
    ) -> Self {
        let order: Vec<&str> = entries.iter().map(|entry| entry.name.as_str()).collect();
        let index = order.iter().enumerate().map(|(i, name)| (*name, i)).collect();
        Self { what, collection, place, order, index }
    }

    /// Which entry a name is, if any.
    pub(crate) fn position(&self, name: &str) -> Option<usize> {
        self.index.get(name).copied()
    }

    /// Which entry a reference means; an error if none.
    pub(crate) fn find(&self, name: &Spanned<String>, reader: &mut Reader<'_>) -> Option<usize> {
        let found = self.position(&name.value);
        if found.is_none() {
            let message = format!("no {} is named \"{}\"", self.what, name.value);
            // Bounds on the time that a hostile file can take.
            let names = self.order.iter().copied().take(if reader.is_full() { 0 } else { 1000 });
            // A near name of the file itself counts more than a word of another program.
            let hint = match did_you_mean(&name.value, names) {
                Some(meant) => format!("did you mean \"{meant}\"?"),
                None => match neighbour(self.place, &name.value, &[]) {
                    Some(answer) => answer.hint(),
                    None if self.order.is_empty() => {
                        format!("define it in \"{}\" at the top of the file", self.collection)
                    }
                    None => format!("\"{}\" has {}", self.collection, listed(self.order.iter().copied())),
                },
            };
            reader.error_hint(Code::UnknownName, name.at, message, hint);
        }
        found
    }
}
