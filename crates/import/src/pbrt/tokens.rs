//! The words of a pbrt file, each with its line; included files in their place.

/// A word.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Word {
    /// A directive, or `true` and `false` within a list.
    Name(String),
    /// Text between quotes.
    Quoted(String),
    Number(f64),
    Open,
    Close,
}

/// A word and where it stands.
#[derive(Clone, Debug)]
pub(super) struct Token {
    pub word: Word,
    pub line: usize,
}

/// Splits a text into words.
///
/// # Errors
/// A sentence with the line.
pub(super) fn tokens(text: &str) -> Result<Vec<Token>, String> {
    let mut tokens = Vec::new();
    let mut line = 1;
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        match first {
            '\n' => {
                line += 1;
                rest = &rest[1..];
            }
            c if c.is_whitespace() => rest = &rest[c.len_utf8()..],
            '#' => rest = &rest[rest.find('\n').unwrap_or(rest.len())..],
            '[' | ']' => {
                tokens.push(Token { word: if first == '[' { Word::Open } else { Word::Close }, line });
                rest = &rest[1..];
            }
            '"' => {
                let (quoted, length) = quoted(rest).ok_or_else(|| format!("line {line}: a quote is not closed"))?;
                tokens.push(Token { word: Word::Quoted(quoted), line });
                rest = &rest[length..];
            }
            _ => {
                let end = rest.find(|c: char| c.is_whitespace() || "[]\"#".contains(c)).unwrap_or(rest.len());
                tokens.push(Token { word: bare(&rest[..end], line)?, line });
                rest = &rest[end..];
            }
        }
    }
    Ok(tokens)
}

/// The text between the quotes that `rest` begins with, and the length with both.
fn quoted(rest: &str) -> Option<(String, usize)> {
    let mut text = String::new();
    let mut letters = rest.char_indices().skip(1);
    while let Some((at, c)) = letters.next() {
        match c {
            '"' => return Some((text, at + 1)),
            '\n' => return None,
            '\\' => match letters.next()?.1 {
                'n' => text.push('\n'),
                't' => text.push('\t'),
                other => text.push(other),
            },
            _ => text.push(c),
        }
    }
    None
}

fn bare(word: &str, line: usize) -> Result<Word, String> {
    let begins_a_number = word.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    if !begins_a_number {
        return Ok(Word::Name(word.to_owned()));
    }
    match word.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(Word::Number(value)),
        _ => Err(format!("line {line}: \"{}\" is not a number", word.chars().take(40).collect::<String>())),
    }
}
