//! The words of a pbrt file, each with its line; included files in their place.

/// Most words of files that are read at a time, one within the other. Each 16 bytes of a long word count as one more.
pub(super) const MOST_WORDS: usize = 1 << 26;

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

impl Word {
    /// What it counts for.
    fn size(&self) -> usize {
        match self {
            Self::Name(text) | Self::Quoted(text) => 1 + text.len() / 16,
            Self::Number(_) | Self::Open | Self::Close => 1,
        }
    }
}

/// A word and where it stands.
#[derive(Clone, Debug)]
pub(super) struct Token {
    pub word: Word,
    pub line: usize,
}

/// Splits a text into words, and gives how many they count for.
///
/// # Errors
/// A sentence with the line; also if they count for more than `most`, which is what is left of [`MOST_WORDS`].
pub(super) fn tokens(text: &str, most: usize) -> Result<(Vec<Token>, usize), String> {
    let mut tokens = Vec::new();
    let mut count = 0;
    let mut line = 1;
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let known = tokens.len();
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
        if tokens.len() > known {
            count += tokens.last().map_or(0, |token: &Token| token.word.size());
            if count > most {
                return Err(format!("line {line}: files that include one another have more than {MOST_WORDS} words"));
            }
        }
    }
    Ok((tokens, count))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_count_and_long_ones_more() {
        assert_eq!(tokens("Scale 1 [ 2 ] # 3\n", 5).map(|(tokens, count)| (tokens.len(), count)), Ok((5, 5)));
        let why = tokens("a\nb c", 2).unwrap_err();
        assert_eq!(why, "line 2: files that include one another have more than 67108864 words");
        let long = format!("\"{}\"", "a".repeat(32));
        assert_eq!((tokens(&long, 3).unwrap().1, tokens(&long, 2).is_err()), (3, true));
    }
}
