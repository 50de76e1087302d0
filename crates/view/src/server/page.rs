//! The files of the page, in the program itself. No request names a file of the disk.

/// A file of the page: its name in the address, its kind, its contents.
pub(crate) struct PageFile {
    pub name: &'static str,
    pub kind: &'static str,
    pub text: &'static str,
}

macro_rules! page_files {
    ($($name:literal as $kind:expr),+ $(,)?) => {
        /// All of them; the first is the page.
        pub(crate) const FILES: &[PageFile] =
            &[$(PageFile { name: $name, kind: $kind, text: include_str!(concat!("../../page/", $name)) }),+];
    };
}

const MODULE: &str = "text/javascript; charset=utf-8";

page_files! {
    "index.html" as "text/html; charset=utf-8",
    "style.css" as "text/css; charset=utf-8",
    "app.js" as MODULE,
    "server.js" as MODULE,
    "format.js" as MODULE,
    "curve.js" as MODULE,
    "camera.js" as MODULE,
    "stage.js" as MODULE,
    "inspector.js" as MODULE,
    "paths.js" as MODULE,
    "effects.js" as MODULE,
    "look.js" as MODULE,
    "marks.js" as MODULE,
    "compare.js" as MODULE,
    "log.js" as MODULE,
}

/// The file of this name.
pub(crate) fn find(name: &str) -> Option<&'static PageFile> {
    let name = if name.is_empty() { "index.html" } else { name };
    FILES.iter().find(|file| file.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_asks_no_other_server() {
        for file in FILES {
            for foreign in ["http://", "https://", "//cdn"] {
                let found = file.text.match_indices(foreign);
                let own = |at: usize| file.text[at..].starts_with("http://www.w3.org/");
                assert!(found.into_iter().all(|(at, _)| own(at)), "{} names {foreign}", file.name);
            }
        }
        assert_eq!(find("").unwrap().name, "index.html");
        assert!(find("../Cargo.toml").is_none());
    }
}
