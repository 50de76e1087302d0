//! Reads the arguments of a directive.

use glam::DAffine3;

use super::parameters::Parameters;
use super::tokens::{Token, Word};

/// What follows a directive.
pub(super) struct Arguments<'a> {
    pub tokens: &'a [Token],
    pub at: &'a mut usize,
    pub of: &'a str,
    pub place: &'a str,
}

impl Arguments<'_> {
    pub(super) fn quoted(&mut self) -> Result<String, String> {
        match self.tokens.get(*self.at) {
            Some(Token { word: Word::Quoted(text), .. }) => {
                *self.at += 1;
                Ok(text.clone())
            }
            _ => Err(format!("{}: a word in quotes should follow", self.place)),
        }
    }

    /// Numbers, in brackets or not.
    pub(super) fn numbers<const N: usize>(&mut self) -> Result<[f64; N], String> {
        let fail = || format!("{}: {N} numbers should follow", self.place);
        let brackets = matches!(self.tokens.get(*self.at), Some(Token { word: Word::Open, .. }));
        *self.at += usize::from(brackets);
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            match self.tokens.get(*self.at) {
                Some(Token { word: Word::Number(value), .. }) => *number = *value,
                _ => return Err(fail()),
            }
            *self.at += 1;
        }
        if brackets {
            match self.tokens.get(*self.at) {
                Some(Token { word: Word::Close, .. }) => *self.at += 1,
                _ => return Err(fail()),
            }
        }
        Ok(numbers)
    }

    /// A matrix, which is listed by columns.
    pub(super) fn matrix(&mut self) -> Result<DAffine3, String> {
        let m: [f64; 16] = self.numbers()?;
        if [m[3], m[7], m[11]] != [0.0; 3] || m[15] == 0.0 {
            return Err(format!("{}: the matrix is not affine", self.place));
        }
        let column = |k: usize| [m[4 * k] / m[15], m[4 * k + 1] / m[15], m[4 * k + 2] / m[15]];
        Ok(DAffine3::from_cols_array_2d(&[column(0), column(1), column(2), column(3)]))
    }

    pub(super) fn parameters(&mut self) -> Result<Parameters, String> {
        let (list, taken) = Parameters::read(&self.tokens[*self.at..], self.of)?;
        *self.at += taken;
        Ok(list)
    }

    /// A word without quotes.
    pub(super) fn word(&mut self) -> Option<&str> {
        let Word::Name(word) = &self.tokens.get(*self.at)?.word else { return None };
        *self.at += 1;
        Some(word)
    }

    /// On to the next directive.
    pub(super) fn skip(&mut self) {
        while let Some(token) = self.tokens.get(*self.at) {
            if matches!(&token.word, Word::Name(word) if word != "true" && word != "false") {
                break;
            }
            *self.at += 1;
        }
    }
}
