//! Every text that the program may print: errors, warnings, hints, notes and reports, from the sources of the crates.

use std::path::Path;
use std::process::ExitCode;

use crate::source::{self, Token, relative};

/// The crates whose texts reach a user, from the program down.
const CRATES: [&str; 9] = ["cli", "etalon", "import", "scene", "picture", "transport", "geometry", "optics", "simd"];

/// Macros and methods whose text only a bug can show.
const OF_BUGS: [&str; 10] = [
    "expect",
    "panic",
    "unreachable",
    "assert",
    "assert_eq",
    "assert_ne",
    "debug_assert",
    "debug_assert_eq",
    "debug_assert_ne",
    "include_str",
];

/// A text, and where it is.
struct Message {
    file: String,
    line: usize,
    text: String,
}

/// Prints all texts.
pub(crate) fn print(root: &Path, arguments: &[String]) -> Result<ExitCode, String> {
    let mut count = 0;
    for name in CRATES.iter().filter(|name| arguments.is_empty() || arguments.iter().any(|a| a == *name)) {
        for Message { file, line, text } in of_crate(root, name)? {
            println!("{file}:{line}: {text}");
            count += 1;
        }
    }
    println!("{count} texts");
    Ok(ExitCode::SUCCESS)
}

fn of_crate(root: &Path, name: &str) -> Result<Vec<Message>, String> {
    let mut found = Vec::new();
    for source in source::sources_with_strings(root, name)? {
        let file = relative(root, &source.path);
        let tokens = &source.tokens;
        let texts = (0..tokens.len()).filter(|&at| tokens[at].is_string() && !is_of_a_bug(&tokens[..at]));
        found.extend(texts.filter_map(|at| {
            let text = content(&tokens[at].text);
            is_sentence(&text).then(|| Message { file: file.clone(), line: tokens[at].line, text })
        }));
    }
    Ok(found)
}

/// Whether what follows these tokens is the text of a panic, or the reason of a lint.
fn is_of_a_bug(before: &[Token]) -> bool {
    let word = |back: usize| before.len().checked_sub(back).map_or("", |at| before[at].text.as_str());
    match word(1) {
        "(" if word(2) == "!" => OF_BUGS.contains(&word(3)),
        "(" => word(2) == "expect",
        "=" => word(2) == "reason",
        // The second text of a macro: `assert!(x, "…")` is rare outside of tests, and is read as a message.
        _ => false,
    }
}

/// What a literal says: without its quotes, and with its lines joined.
fn content(literal: &str) -> String {
    let text = literal.trim_start_matches(['b', 'c', 'r', '#']).trim_end_matches('#');
    let text = text.get(1..text.len().saturating_sub(1)).unwrap_or("");
    let mut lines = text.split("\\\n");
    let first = lines.next().unwrap_or("").to_owned();
    lines.fold(first, |joined, line| joined + line.trim_start())
}

/// Whether it has words with a space between them.
fn is_sentence(text: &str) -> bool {
    text.trim().contains(' ') && text.split(|c: char| !c.is_alphabetic()).any(|word| word.len() > 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Turns that a reader has to read twice, and what to write.
    const RIDDLES: [(&str, &str); 14] = [
        ("honoured", "ignored, or not converted"),
        ("taken for", "becomes, or is treated as"),
        ("stands for it", "is used"),
        ("shines by", "emission"),
        ("counts by", "is used"),
        ("called for by", "needed by"),
        ("foretold", "predicted"),
        ("to go", "remaining"),
        ("go on from", "continue from"),
        ("so many", "the number"),
        ("by itself", "automatically"),
        ("what is more", "more than"),
        ("stands alone", "is independent"),
        ("where there is that", "if"),
    ];

    fn all() -> Vec<Message> {
        CRATES.iter().flat_map(|name| of_crate(&crate::root(), name).unwrap()).collect()
    }

    #[test]
    fn messages_are_found_whatever_makes_them_and_those_of_tests_and_bugs_are_not() {
        let text = r##"
            #[error("no file `{0}`")] enum Error {}
            fn f() { miette!(help = "add \
                one", "it lacks one"); x.expect("a bug is here"); panic!("no way out"); g(r#"a "raw" text"#); h("word"); }
            #[allow(dead_code, reason = "for later use")] fn g() {}
            #[cfg(test)] mod tests { fn h() { i("of a test") } }
        "##;
        let tokens = source::without_tests(&source::tokens_with_strings(text));
        let found: Vec<String> = (0..tokens.len())
            .filter(|&at| tokens[at].is_string() && !is_of_a_bug(&tokens[..at]))
            .map(|at| content(&tokens[at].text))
            .filter(|text| is_sentence(text))
            .collect();
        assert_eq!(found, ["no file `{0}`", "add one", "it lacks one", "a \"raw\" text"]);
    }

    #[test]
    fn the_list_has_messages_of_every_crate() {
        let all = all();
        for name in CRATES {
            assert!(all.iter().any(|message| message.file.starts_with(&format!("crates/{name}/"))), "{name}");
        }
        for known in
            ["unknown key \\\"{key}\\\"", "cannot read the scene `{}`", "no sample found light: the picture is black"]
        {
            assert!(all.iter().any(|message| message.text.contains(known)), "{known}");
        }
    }

    #[test]
    fn messages_have_plain_words() {
        let mut wrong = Vec::new();
        for Message { file, line, text } in all() {
            let said = text.to_lowercase();
            let is_word = |turn: &str| {
                said.split(turn).count() > 1 && {
                    let ends = said.match_indices(turn).map(|(at, _)| (at, at + turn.len()));
                    ends.into_iter().any(|(start, end)| {
                        let letter = |c: Option<char>| c.is_some_and(char::is_alphabetic);
                        !letter(said[..start].chars().next_back()) && !letter(said[end..].chars().next())
                    })
                }
            };
            for (turn, instead) in RIDDLES.iter().filter(|(turn, _)| is_word(turn)) {
                wrong.push(format!("{file}:{line}: \"{turn}\" ({instead}): {text}"));
            }
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }
}
