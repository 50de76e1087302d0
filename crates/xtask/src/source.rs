//! The Rust sources of the crates as tokens, without comments and test code.

use std::fs;
use std::path::{Path, PathBuf};

/// A word or a punctuation mark of a source file, or a string where strings are asked for. Other literals are left out.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Token {
    pub(crate) text: String,
    pub(crate) line: usize,
}

impl Token {
    pub(crate) fn is_word(&self) -> bool {
        !self.is_string() && self.text.starts_with(|c: char| c.is_alphabetic() || c == '_')
    }

    /// Whether it is a string, with its quotes.
    pub(crate) fn is_string(&self) -> bool {
        self.text.len() > 1 && self.text.ends_with(['"', '#'])
    }
}

/// One source file of a crate.
pub(crate) struct Source {
    pub(crate) path: PathBuf,
    /// The module that the file holds, from the crate's root: empty for `lib.rs`.
    pub(crate) module: Vec<String>,
    pub(crate) tokens: Vec<Token>,
}

/// The names of all crates under `crates/`, which are the names of their folders.
pub(crate) fn crates(root: &Path) -> Vec<String> {
    let mut names: Vec<String> = children(&root.join("crates"))
        .into_iter()
        .filter(|path| path.join("Cargo.toml").is_file())
        .map(|path| file_name(&path))
        .collect();
    names.sort();
    names
}

/// All files of a crate that its library or program is made of, from its root module on. Test modules and strings are left out.
pub(crate) fn sources(root: &Path, name: &str) -> Result<Vec<Source>, String> {
    sources_by(root, name, tokens)
}

/// [`sources`] with strings.
pub(crate) fn sources_with_strings(root: &Path, name: &str) -> Result<Vec<Source>, String> {
    sources_by(root, name, tokens_with_strings)
}

fn sources_by(root: &Path, name: &str, split: fn(&str) -> Vec<Token>) -> Result<Vec<Source>, String> {
    let folder = root.join("crates").join(name).join("src");
    let mut found = Vec::new();
    for file in ["lib.rs", "main.rs"].map(|file| folder.join(file)) {
        if file.is_file() {
            visit(&file, &folder, Vec::new(), split, &mut found)?;
        }
    }
    if found.is_empty() { Err(format!("{}: neither lib.rs nor main.rs", folder.display())) } else { Ok(found) }
}

/// Reads `file`, which holds `module`, and the files of its modules, which lie in `folder`.
fn visit(
    file: &Path,
    folder: &Path,
    module: Vec<String>,
    split: fn(&str) -> Vec<Token>,
    found: &mut Vec<Source>,
) -> Result<(), String> {
    let text = fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))?;
    let tokens = without_tests(&split(&text));
    let mut children = Vec::new();
    walk(&tokens, |at, inline| {
        if let [keyword, name, end, ..] = &tokens[at..]
            && keyword.text == "mod"
            && end.text == ";"
        {
            children.push((inline.to_vec(), name.text.clone()));
        }
    });
    found.push(Source { path: file.to_path_buf(), module: module.clone(), tokens });
    for (inline, name) in children {
        let folder = inline.iter().fold(folder.to_path_buf(), |folder, part| folder.join(part));
        let candidates = [folder.join(format!("{name}.rs")), folder.join(&name).join("mod.rs")];
        let Some(file) = candidates.iter().find(|file| file.is_file()) else {
            return Err(format!("{}: no file of `mod {name}`; `#[path]` is not understood", file.display()));
        };
        let module = module.iter().chain(&inline).chain([&name]).cloned().collect();
        visit(file, &folder.join(&name), module, split, found)?;
    }
    Ok(())
}

/// Calls `act` with the index of each token and the modules, opened by `mod name {`, that it stands in.
pub(crate) fn walk(tokens: &[Token], mut act: impl FnMut(usize, &[String])) {
    let (mut inline, mut depths, mut depth) = (Vec::new(), Vec::new(), 0_usize);
    for (at, token) in tokens.iter().enumerate() {
        act(at, &inline);
        match token.text.as_str() {
            "{" => {
                depth += 1;
                if at >= 2 && tokens[at - 2].text == "mod" {
                    inline.push(tokens[at - 1].text.clone());
                    depths.push(depth);
                }
            }
            "}" => {
                if depths.last() == Some(&depth) {
                    inline.pop();
                    depths.pop();
                }
                depth = depth.saturating_sub(1);
            }
            _ => {}
        }
    }
}

/// Splits a source file into tokens, without strings.
pub(crate) fn tokens(text: &str) -> Vec<Token> {
    let mut tokens = tokens_with_strings(text);
    tokens.retain(|token| !token.is_string());
    tokens
}

/// Splits a source file into tokens.
pub(crate) fn tokens_with_strings(text: &str) -> Vec<Token> {
    let bytes = text.as_bytes();
    let (mut found, mut at, mut line) = (Vec::new(), 0, 1);
    let starts = |at: usize, what: &str| bytes[at..].starts_with(what.as_bytes());
    while at < bytes.len() {
        let start = at;
        let byte = bytes[at];
        if starts(at, "//") {
            at = text[at..].find('\n').map_or(bytes.len(), |n| at + n);
        } else if starts(at, "/*") {
            at = after_block_comment(bytes, at);
        } else if let Some(end) = after_string(bytes, at) {
            at = end;
            found.push(Token { text: text[start..at].to_owned(), line });
        } else if byte == b'\'' {
            at = after_quote(text, at);
        } else if byte.is_ascii_alphabetic() || byte == b'_' || byte >= 0x80 {
            at = word_end(bytes, at);
            found.push(Token { text: text[start..at].to_owned(), line });
        } else if byte.is_ascii_digit() {
            at = word_end(bytes, at);
        } else {
            at += 1;
            if !byte.is_ascii_whitespace() {
                found.push(Token { text: char::from(byte).to_string(), line });
            }
        }
        line += bytes[start..at].iter().filter(|&&b| b == b'\n').count();
    }
    found
}

fn word_end(bytes: &[u8], at: usize) -> usize {
    let is_part = |b: &u8| b.is_ascii_alphanumeric() || *b == b'_' || *b >= 0x80;
    bytes[at..].iter().position(|b| !is_part(b)).map_or(bytes.len(), |n| at + n)
}

/// Block comments nest.
fn after_block_comment(bytes: &[u8], mut at: usize) -> usize {
    let mut depth = 0_usize;
    while at < bytes.len() {
        if bytes[at..].starts_with(b"/*") {
            depth += 1;
            at += 2;
        } else if bytes[at..].starts_with(b"*/") {
            depth -= 1;
            at += 2;
            if depth == 0 {
                break;
            }
        } else {
            at += 1;
        }
    }
    at
}

/// The end of the string that begins here, also of `b"…"`, `c"…"`, `r"…"`, `r#"…"#`; `None` if none does.
fn after_string(bytes: &[u8], at: usize) -> Option<usize> {
    let mut quote = at;
    while quote < at + 2 && bytes.get(quote).is_some_and(|b| b"bcr".contains(b)) {
        quote += 1;
    }
    let raw = bytes[at..quote].contains(&b'r');
    let hashes = if raw { bytes[quote..].iter().take_while(|&&b| b == b'#').count() } else { 0 };
    quote += hashes;
    if bytes.get(quote) != Some(&b'"') {
        return None;
    }
    let mut at = quote + 1;
    while at < bytes.len() {
        match bytes[at] {
            b'\\' if !raw => at += 2,
            b'"' if bytes[at + 1..].iter().take_while(|&&b| b == b'#').count() >= hashes => {
                return Some(at + 1 + hashes);
            }
            _ => at += 1,
        }
    }
    Some(bytes.len())
}

/// Behind a character such as `'{'`, or behind the mark of a lifetime.
fn after_quote(text: &str, at: usize) -> usize {
    let mut rest = text[at + 1..].char_indices();
    match rest.next() {
        // An escape: up to the closing mark, which is not the escaped character.
        Some((_, '\\')) => text[at + 3..].find('\'').map_or(text.len(), |n| at + 3 + n + 1),
        Some(_) => match rest.next() {
            Some((n, '\'')) => at + 1 + n + 1,
            _ => at + 1,
        },
        None => at + 1,
    }
}

/// The tokens without items under `#[cfg(test)]`, `#[cfg(all(test, …))]` and `#[test]`.
pub(crate) fn without_tests(tokens: &[Token]) -> Vec<Token> {
    let (mut kept, mut at) = (Vec::new(), 0);
    let text = |at: usize| tokens.get(at).map_or("", |token| token.text.as_str());
    while at < tokens.len() {
        let inner = text(at) == "#" && text(at + 1) == "!";
        let bracket = at + 1 + usize::from(inner);
        if text(at) != "#" || text(bracket) != "[" {
            kept.push(tokens[at].clone());
            at += 1;
            continue;
        }
        let end = closing(tokens, bracket);
        let words: Vec<&str> = (bracket..end).map(text).collect();
        let is_test = match words.get(1) {
            Some(&"cfg") => words.contains(&"test") && !words.contains(&"not") && !words.contains(&"any"),
            Some(&"test") => true,
            _ => false,
        };
        if is_test && inner {
            return Vec::new();
        }
        if is_test {
            at = item_end(tokens, end + 1);
        } else {
            kept.extend_from_slice(&tokens[at..=end.min(tokens.len() - 1)]);
            at = end + 1;
        }
    }
    kept
}

/// The index of the bracket that closes the one at `at`.
fn closing(tokens: &[Token], at: usize) -> usize {
    let mut depth = 0_usize;
    for (n, token) in tokens.iter().enumerate().skip(at) {
        match token.text.as_str() {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 {
            return n;
        }
    }
    tokens.len()
}

/// The index behind the item, field or variant that begins at `at`, perhaps with more attributes.
fn item_end(tokens: &[Token], mut at: usize) -> usize {
    let mut item = false;
    while at < tokens.len() {
        match tokens[at].text.as_str() {
            "fn" | "impl" | "struct" | "enum" | "trait" | "type" | "const" | "static" | "mod" | "use" => item = true,
            ";" => return at + 1,
            // Behind a field or a variant; within an item it parts its parameters.
            "," if !item => return at + 1,
            "{" => return closing(tokens, at) + 1,
            "(" | "[" => at = closing(tokens, at),
            _ => {}
        }
        at += 1;
    }
    at
}

/// Every file below a folder, in order.
pub(crate) fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for path in children(folder) {
        if path.is_dir() {
            // What interpreters, environments and fuzzers leave behind.
            if !["__pycache__", ".venv", "target"].contains(&file_name(&path).as_str()) {
                found.extend(files(&path));
            }
        } else {
            found.push(path);
        }
    }
    found.sort();
    found
}

pub(crate) fn children(folder: &Path) -> Vec<PathBuf> {
    fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect()
}

pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The path of a file within the repository, with `/` between folders on every system.
pub(crate) fn relative(root: &Path, path: &Path) -> String {
    let path = path.strip_prefix(root).unwrap_or(path);
    path.components().map(|part| part.as_os_str().to_string_lossy()).collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> String {
        without_tests(&tokens(text)).iter().map(|token| token.text.as_str()).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn comments_and_literals_are_no_tokens() {
        assert_eq!(words("a /* b /* c */ d */ e // f\ng"), "a e g");
        assert_eq!(words(r###"a "b \" c" d b"e" f r#"g " h"# i r"\" j"###), "a d f i j");
        assert_eq!(words(r"a '{' b '\'' c '\u{1F}' 'd e 'µ' f"), "a b c d e f");
        assert_eq!(words("a 1.5e3_f64 b 0x1f c[2]"), "a . b c [ ]");
    }

    #[test]
    fn lines_are_counted_through_comments_and_strings() {
        let lines: Vec<_> = tokens("a /*\n*/ b \"\n\n\" c").into_iter().map(|token| token.line).collect();
        assert_eq!(lines, [1, 2, 4]);
    }

    #[test]
    fn test_code_is_left_out() {
        assert_eq!(words("a #[cfg(test)] mod tests { fn b() { {} } } c"), "a c");
        assert_eq!(words("a #[cfg(test)] mod tests; c"), "a c");
        assert_eq!(words("#[cfg(all(test, unix))] #[ignore] fn b(x: [u8; 3]) {} c"), "c");
        assert_eq!(words("#[cfg(test)] pub(crate) fn b<A, B>(a: A, b: B) {} c"), "c");
        assert_eq!(words("{ #[cfg(test)] a: A, b: B }"), "{ b : B }");
        assert_eq!(words("#[test] fn b() {} #[cfg(not(test))] fn c() {}"), "# [ cfg ( not ( test ) ) ] fn c ( ) { }");
        assert_eq!(words("#![cfg(test)] fn b() {}"), "");
    }

    #[test]
    fn modules_inside_of_a_file_are_followed() {
        let tokens = tokens("mod a { mod b { x } y } z");
        let mut seen = Vec::new();
        walk(&tokens, |at, inline| {
            if ["x", "y", "z"].contains(&tokens[at].text.as_str()) {
                seen.push(inline.join("::"));
            }
        });
        assert_eq!(seen, ["a::b", "a", ""]);
    }

    #[test]
    fn every_crate_has_sources() {
        let root = crate::root();
        let names = crates(&root);
        assert!(names.iter().any(|name| name == "transport"), "{names:?}");
        for name in names {
            let sources = sources(&root, &name).unwrap();
            assert!(sources.iter().any(|source| !source.tokens.is_empty()), "{name}");
        }
    }
}
