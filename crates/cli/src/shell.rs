//! Words of a shell's command line.

/// A text as one word.
pub(crate) fn quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', r"'\''"))
}

/// Words with spaces between them, those in quotes that a shell would not take as they are.
pub(crate) fn words(words: impl IntoIterator<Item = String>) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_=+,.:/@%".contains(c);
    let word = |word: String| if !word.is_empty() && word.chars().all(plain) { word } else { quoted(&word) };
    words.into_iter().map(word).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(unix)]
    fn words_stay_words_whatever_they_hold() {
        let all = ["/a b/c.json", "/it's/$(x)`y`\"z\"\\.json", "--spp=7", "", "*", "~", "#", "a\tb", "é!;&|<>"];
        let echoed = std::process::Command::new("sh")
            .args(["-c", &format!("printf '%s\n' {}", words(all.map(str::to_owned)))])
            .output()
            .expect("a shell");
        let echoed = String::from_utf8(echoed.stdout).unwrap();
        assert_eq!(echoed.lines().collect::<Vec<_>>(), all);
        assert_eq!(words(["--spp", "7", "a.json"].map(str::to_owned)), "--spp 7 a.json");
    }
}
