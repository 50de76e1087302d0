//! Lists of parameters, `"type name" [values]`, each knowing whether it has been used.

use std::cell::Cell;
use std::rc::Rc;

use super::tokens::{Token, Word};
use crate::Builder;

/// The values of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Values {
    Numbers(Vec<f64>),
    Strings(Vec<String>),
    Flags(Vec<bool>),
}

/// A parameter. Directives that have it by an attribute share it, and so its mark.
#[derive(Debug)]
pub(super) struct Parameter {
    pub kind: String,
    pub name: String,
    pub values: Values,
    pub place: String,
    used: Rc<Cell<bool>>,
}

impl Parameter {
    /// Says that it has been used.
    pub(super) fn mark(&self) {
        self.used.set(true);
    }

    /// The mark of its use, which outlives it.
    pub(super) fn used(&self) -> Rc<Cell<bool>> {
        Rc::clone(&self.used)
    }

    /// How many values it has; a long text counts for more than one.
    pub(super) fn size(&self) -> usize {
        match &self.values {
            Values::Numbers(numbers) => numbers.len(),
            Values::Strings(strings) => strings.iter().map(|text| 1 + text.len() / 16).sum(),
            Values::Flags(flags) => flags.len(),
        }
    }

    pub(super) fn numbers(&self) -> &[f64] {
        match &self.values {
            Values::Numbers(numbers) => numbers,
            _ => &[],
        }
    }

    pub(super) fn strings(&self) -> &[String] {
        match &self.values {
            Values::Strings(strings) => strings,
            _ => &[],
        }
    }
}

/// The parameters of a directive.
#[derive(Clone, Debug, Default)]
pub(super) struct Parameters {
    /// Those that it states itself, then those that it has by attributes.
    pub all: Vec<Rc<Parameter>>,
    /// How many it states itself.
    own: usize,
}

impl Parameters {
    /// Reads parameters as long as there are some; gives how many tokens they took.
    pub(super) fn read(tokens: &[Token], of: &str) -> Result<(Self, usize), String> {
        let mut list = Vec::new();
        let mut at = 0;
        while let Some(Token { word: Word::Quoted(declared), line }) = tokens.get(at) {
            let place = format!("{of}line {line}");
            let mut words = declared.split_whitespace();
            let (Some(kind), Some(name), None) = (words.next(), words.next(), words.next()) else {
                return Err(format!("{place}: \"{declared}\" is not the type and the name of a parameter"));
            };
            at += 1;
            let values = values(tokens, &mut at, &place)?;
            list.push(Rc::new(Parameter {
                kind: kind.to_owned(),
                name: name.to_owned(),
                values,
                place,
                used: Rc::default(),
            }));
        }
        Ok((Self { own: list.len(), all: list }, at))
    }

    pub(super) fn get(&self, name: &str) -> Option<&Parameter> {
        let found = self.all.iter().find(|parameter| parameter.name == name)?;
        found.mark();
        Some(found)
    }

    /// The numbers of a parameter.
    pub(super) fn numbers(&self, name: &str) -> Option<&[f64]> {
        match &self.get(name)?.values {
            Values::Numbers(numbers) => Some(numbers),
            _ => None,
        }
    }

    /// A single number.
    pub(super) fn number(&self, name: &str) -> Result<Option<f64>, String> {
        match self.get(name) {
            None => Ok(None),
            Some(parameter) => match parameter.numbers() {
                [value] => Ok(Some(*value)),
                _ => Err(format!("{}: \"{name}\" is not one number", parameter.place)),
            },
        }
    }

    /// A single number, or one that holds where none is stated.
    pub(super) fn number_or(&self, name: &str, default: f64) -> Result<f64, String> {
        Ok(self.number(name)?.unwrap_or(default))
    }

    pub(super) fn triple(&self, name: &str) -> Result<Option<[f64; 3]>, String> {
        match self.get(name) {
            None => Ok(None),
            Some(parameter) => match parameter.numbers() {
                [x, y, z] => Ok(Some([*x, *y, *z])),
                _ => Err(format!("{}: \"{name}\" is not three numbers", parameter.place)),
            },
        }
    }

    pub(super) fn string(&self, name: &str) -> Option<&str> {
        match &self.get(name)?.values {
            Values::Strings(strings) => strings.first().map(String::as_str),
            _ => None,
        }
    }

    pub(super) fn flag(&self, name: &str) -> Option<bool> {
        match &self.get(name)?.values {
            Values::Flags(flags) => flags.first().copied(),
            // As version 3 wrote them.
            Values::Strings(strings) => strings.first().map(|word| word == "true"),
            Values::Numbers(_) => None,
        }
    }

    pub(super) fn mark_all(&self) {
        self.all.iter().for_each(|parameter| parameter.mark());
    }

    /// Lists what the directive states itself and was not used.
    pub(super) fn list_unused(&self, builder: &mut Builder<'_>) {
        for parameter in self.all[..self.own].iter().filter(|parameter| !parameter.used.get()) {
            let what = format!("\"{} {}\" is ignored", parameter.kind, parameter.name);
            builder.leave_out(&parameter.place, what);
        }
    }
}

/// One value, or a list in brackets.
fn values(tokens: &[Token], at: &mut usize, place: &str) -> Result<Values, String> {
    let listed = matches!(tokens.get(*at), Some(Token { word: Word::Open, .. }));
    let start = *at + usize::from(listed);
    let length = if listed {
        let closing = tokens[start..].iter().position(|token| token.word == Word::Close);
        closing.ok_or_else(|| format!("{place}: its list is not closed"))?
    } else {
        1
    };
    let words = tokens.get(start..start + length).ok_or_else(|| format!("{place}: it has no value"))?;
    *at = start + length + usize::from(listed);
    let mixed = || format!("{place}: its values are of different types");
    match words.first().map(|token| &token.word) {
        None => Ok(Values::Numbers(Vec::new())),
        Some(Word::Number(_)) => words
            .iter()
            .map(|token| match token.word {
                Word::Number(value) => Ok(value),
                _ => Err(mixed()),
            })
            .collect::<Result<_, _>>()
            .map(Values::Numbers),
        Some(Word::Quoted(_)) => words
            .iter()
            .map(|token| match &token.word {
                Word::Quoted(text) => Ok(text.clone()),
                _ => Err(mixed()),
            })
            .collect::<Result<_, _>>()
            .map(Values::Strings),
        Some(_) => words
            .iter()
            .map(|token| match &token.word {
                Word::Name(word) if word == "true" || word == "false" => Ok(word == "true"),
                _ => Err(format!("{place}: it has no value")),
            })
            .collect::<Result<_, _>>()
            .map(Values::Flags),
    }
}
