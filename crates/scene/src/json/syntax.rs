//! Strict JSON with the places of its values, recovering from the errors people make.
//!
//! The strict parse stops at the first error. A text that fails it is parsed again as JSON5 (comments, trailing and
//! missing commas, single quotes, bare keys, other spellings of numbers), and every liberty it takes is a fault; the
//! values are decoded all the same, so that errors of meaning come in the same run.

use jsonc_parser::ast::Value;
use jsonc_parser::errors::{ParseError, ParseErrorKind};
use jsonc_parser::tokens::{Token, TokenAndRange};
use jsonc_parser::{CollectOptions, CommentCollectionStrategy, ParseOptions, parse_to_ast};

use super::{Code, MAX_BYTES, MAX_DEPTH, MAX_PROBLEMS, MAX_VALUES, Span};

/// An error of syntax.
pub(super) struct Fault {
    pub(super) code: Code,
    pub(super) span: Span,
    pub(super) message: String,
    pub(super) hint: Option<String>,
}

impl Fault {
    fn new(code: Code, span: Span, message: impl Into<String>, hint: &str) -> Self {
        Self { code, span, message: message.into(), hint: (!hint.is_empty()).then(|| hint.to_owned()) }
    }

    fn syntax(span: Span, message: impl Into<String>, hint: &str) -> Self {
        Self::new(Code::Syntax, span, message, hint)
    }
}

/// What a text holds: a value if any could be made out, and the errors of syntax.
pub(super) struct Parsed<'a> {
    pub(super) value: Option<Value<'a>>,
    pub(super) faults: Vec<Fault>,
}

const STRICT: ParseOptions = ParseOptions {
    allow_comments: false,
    allow_loose_object_property_names: false,
    allow_trailing_commas: false,
    allow_missing_commas: false,
    allow_single_quoted_strings: false,
    allow_hexadecimal_numbers: false,
    allow_unary_plus_numbers: false,
    allow_bare_decimal_point_numbers: false,
    allow_non_finite_numbers: false,
    allow_extended_string_escapes: false,
};

pub(super) fn parse(text: &str) -> Parsed<'_> {
    if text.len() > MAX_BYTES {
        let message = format!("the file has {} bytes; at most {MAX_BYTES} are read", text.len());
        return Parsed { value: None, faults: vec![Fault::new(Code::Limit, Span::new(0, 0), message, "")] };
    }
    let Scan { mut faults, deep, values } = scan(text);
    let refuse = |fault| Parsed { value: None, faults: vec![fault] };
    if let Some(at) = deep {
        return refuse(Fault::new(Code::Limit, at, format!("nested deeper than {MAX_DEPTH} levels"), ""));
    }
    if values > MAX_VALUES {
        let message = format!("the file holds more than {MAX_VALUES} values");
        return refuse(Fault::new(Code::Limit, Span::new(0, 0), message, ""));
    }
    let strict = match parse_to_ast(text, &CollectOptions::default(), &STRICT) {
        Ok(parsed) => {
            if parsed.value.is_none() {
                faults.push(Fault::syntax(Span::new(0, 0), "the file is empty", ""));
            }
            return Parsed { value: parsed.value, faults };
        }
        Err(error) => fault_of(&error),
    };
    if values > MAX_RECOVERED.0 || text.len() > MAX_RECOVERED.1 {
        return refuse(strict);
    }
    let collect = CollectOptions { comments: CommentCollectionStrategy::AsTokens, tokens: true };
    // The lexical faults were found on the premise that quotes and brackets are where strict JSON has them.
    match parse_to_ast(text, &collect, &ParseOptions::default()) {
        Ok(parsed) => {
            let tokens = parsed.tokens.unwrap_or_default();
            let mut faults = liberties(text, &tokens);
            if tokens.windows(2).any(|pair| is_needless_zero(&pair[0], &pair[1])) {
                // Each such number became two values: whatever they are decoded to would mislead.
                return Parsed { value: None, faults };
            }
            if !faults.iter().any(|f| f.span.start == strict.span.start) {
                faults.push(strict);
            }
            Parsed { value: parsed.value, faults }
        }
        Err(error) => {
            let lenient = fault_of(&error);
            let same = lenient.span.start == strict.span.start;
            Parsed { value: None, faults: if same { vec![lenient] } else { vec![strict, lenient] } }
        }
    }
}

/// The most values and bytes of a text that is parsed again for the sake of further errors: its tokens are kept for
/// that, some 60 bytes each.
const MAX_RECOVERED: (usize, usize) = (1_000_000, 16 << 20);

/// What can be told of a text before it is parsed, if quotes and brackets are where strict JSON has them.
struct Scan {
    /// What strict JSON forbids and the parser lets pass: control characters in strings, blanks other than JSON's four.
    faults: Vec<Fault>,
    /// Where the nesting becomes too deep.
    deep: Option<Span>,
    /// Number of values, or a little more.
    values: usize,
}

fn scan(text: &str) -> Scan {
    let (mut faults, mut deep, mut values) = (Vec::new(), None, 1);
    let (mut in_string, mut escaped, mut depth) = (false, false, 0_usize);
    for (i, &byte) in text.as_bytes().iter().enumerate() {
        if in_string {
            match byte {
                _ if escaped => escaped = false,
                b'\\' => escaped = true,
                b'"' => in_string = false,
                0..0x20 if faults.len() <= MAX_PROBLEMS => faults.push(Fault::syntax(
                    Span::new(i, i + 1),
                    format!("a control character (code {byte}) in a string"),
                    "write it as an escape such as \\n or \\t",
                )),
                _ => {}
            }
            continue;
        }
        match byte {
            b'"' => in_string = true,
            b'[' | b'{' => {
                depth += 1;
                values += 1;
                if depth > MAX_DEPTH && deep.is_none() {
                    deep = Some(Span::new(i, i + 1));
                }
            }
            b']' | b'}' => depth = depth.saturating_sub(1),
            b',' => values += 1,
            // Any other character of several bytes is an error of the grammar as well; the parser says so.
            0xC0.. | 0x0B | 0x0C if faults.len() <= MAX_PROBLEMS => {
                if let Some(c) = text[i..].chars().next().filter(|c| c.is_whitespace()) {
                    faults.push(Fault::syntax(
                        Span::new(i, i + c.len_utf8()),
                        format!("a space character that JSON does not allow (U+{:04X})", u32::from(c)),
                        "use plain spaces",
                    ));
                }
            }
            _ => {}
        }
    }
    Scan { faults, deep, values }
}

/// Every liberty that a text takes with JSON, from its tokens.
fn liberties(text: &str, tokens: &[TokenAndRange<'_>]) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut before: Option<&TokenAndRange<'_>> = None;
    for token in tokens {
        if faults.len() > MAX_PROBLEMS {
            break;
        }
        let span = Span::new(token.range.start, token.range.end);
        if matches!(token.token, Token::CommentLine(_) | Token::CommentBlock(_)) {
            faults.push(Fault::syntax(span, "JSON has no comments", "move the text to a \"comment\" key"));
            continue;
        }
        if let Some(before) = before {
            let gap = Span::new(before.range.end, before.range.end);
            match (&before.token, &token.token) {
                (Token::Comma, Token::CloseBrace | Token::CloseBracket) => {
                    let comma = Span::new(before.range.start, before.range.end);
                    faults.push(Fault::syntax(comma, "a comma after the last entry", "remove it"));
                }
                _ if is_needless_zero(before, token) => {
                    let number = Span::new(before.range.start, token.range.end);
                    faults.push(Fault::syntax(number, "a number that starts with a needless 0", "remove the 0"));
                }
                (b, t) if ends_value(b) && starts_value(t) => {
                    faults.push(Fault::syntax(gap, "a comma is missing", "add one here"));
                }
                _ => {}
            }
        }
        let source = &text[token.range.start..token.range.end];
        match &token.token {
            Token::Word(_) => faults.push(Fault::syntax(span, "a key without quotes", "put it in double quotes")),
            Token::String(_) if source.starts_with('\'') => {
                faults.push(Fault::syntax(span, "a string in single quotes", "use double quotes"));
            }
            Token::String(_) => string_liberties(source, span.start, &mut faults),
            Token::Number(number) => {
                let digits = number.trim_start_matches(['+', '-']);
                if digits.starts_with(['I', 'N']) {
                    let message = format!("JSON has no number {number}");
                    faults.push(Fault::new(Code::NotFinite, span, message, "write a finite number"));
                } else if digits.starts_with("0x") || digits.starts_with("0X") {
                    faults.push(Fault::syntax(span, "a hexadecimal number", "write it in decimal"));
                } else if number.starts_with('+') {
                    faults.push(Fault::syntax(span, "a number that starts with +", "remove the +"));
                } else if digits.starts_with('.') || !digits.contains(|c: char| c.is_ascii_digit()) {
                    faults.push(Fault::syntax(
                        span,
                        "a number that starts with the decimal point",
                        "write 0 before it",
                    ));
                } else if digits.split(['e', 'E']).next().is_some_and(|d| d.ends_with('.')) {
                    faults.push(Fault::syntax(
                        span,
                        "a number without a digit after the decimal point",
                        "write 0 after it",
                    ));
                }
            }
            _ => {}
        }
        before = Some(token);
    }
    faults
}

/// Escapes and control characters that JSON does not have, in a string in double quotes that starts at `offset`.
fn string_liberties(source: &str, offset: usize, faults: &mut Vec<Fault>) {
    let mut characters = source.char_indices();
    while let Some((i, c)) = characters.next() {
        let at = offset + i;
        if c < ' ' {
            let message = format!("a control character (code {}) in a string", u32::from(c));
            faults.push(Fault::syntax(Span::new(at, at + 1), message, "write it as an escape such as \\n or \\t"));
        } else if c == '\\'
            && let Some((_, escape)) = characters.next()
            && !"\"\\/bfnrtu".contains(escape)
        {
            let span = Span::new(at, at + 1 + escape.len_utf8());
            faults.push(Fault::syntax(span, "an escape that JSON does not have", "write \\\\ for a backslash"));
        }
    }
}

/// Whether two tokens are what the parser makes of a number such as 042.
fn is_needless_zero(before: &TokenAndRange<'_>, token: &TokenAndRange<'_>) -> bool {
    matches!((&before.token, &token.token), (Token::Number("0" | "-0"), Token::Number(_)))
        && before.range.end == token.range.start
}

fn starts_value(token: &Token<'_>) -> bool {
    !matches!(token, Token::Comma | Token::Colon | Token::CloseBrace | Token::CloseBracket)
}

fn ends_value(token: &Token<'_>) -> bool {
    !matches!(token, Token::Comma | Token::Colon | Token::OpenBrace | Token::OpenBracket)
}

/// The parser's error in this crate's words.
fn fault_of(error: &ParseError) -> Fault {
    use ParseErrorKind as K;
    let range = error.range();
    let span = Span::new(range.start, range.end);
    let fault = |message: &str, hint: &str| Fault::syntax(span, message, hint);
    match error.kind() {
        K::CommentsNotAllowed => fault("JSON has no comments", "move the text to a \"comment\" key"),
        K::TrailingCommasNotAllowed => fault("a comma after the last entry", "remove it"),
        K::ExpectedComma => fault("a comma is missing", "add one here"),
        K::ExpectedColonAfterObjectKey => fault("a colon was expected after the key", ""),
        K::ExpectedObjectValue => fault("the text ends where the key's value was expected", ""),
        K::ExpectedStringObjectProperty => fault("a key without quotes", "put it in double quotes"),
        K::MultipleRootJsonValues => fault("there is more text after the end of the value", "a file holds one value"),
        // The whole rest of the text would be marked.
        K::UnterminatedArray => Fault::syntax(span.head(), "this list is never closed", "add the missing ]"),
        K::UnterminatedObject => Fault::syntax(span.head(), "this object is never closed", "add the missing }"),
        K::UnexpectedCloseBrace => fault("a value was expected, not }", ""),
        K::UnexpectedCloseBracket => fault("a value was expected, not ]", ""),
        K::UnexpectedColon => fault("a value was expected, not a colon", ""),
        K::UnexpectedComma => fault("a value was expected, not a comma", ""),
        K::UnexpectedWord => fault("a word without quotes", "strings stand in double quotes"),
        K::NonFiniteNumbersNotAllowed => Fault::new(Code::NotFinite, span, "JSON has no infinity and no NaN", ""),
        kind => {
            let message = kind.to_string();
            let mut characters = message.chars();
            let lower: String =
                characters.next().map(|c| c.to_lowercase().chain(characters).collect()).unwrap_or_default();
            Fault::syntax(span, lower.trim_end_matches('.'), "")
        }
    }
}
