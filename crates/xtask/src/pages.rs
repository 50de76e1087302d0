//! The Markdown pages of the repository: whether their links lead somewhere, and the book that is made of them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};
use std::process::{Command, ExitCode};

use crate::source::{children, file_name, files, relative};

/// `cargo xtask links`: names every link that leads to no file or to no heading.
pub(crate) fn check_links(root: &Path, arguments: &[String]) -> Result<ExitCode, String> {
    if !arguments.is_empty() {
        return Err("no options".into());
    }
    let broken = broken_links(root)?;
    for link in &broken {
        println!("{link}");
    }
    println!("{} links lead nowhere", broken.len());
    Ok(if broken.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// `cargo xtask book`: copies the pages of SUMMARY.md, and the files that they link to, to `target/book/pages`, and runs mdbook on them.
pub(crate) fn book(root: &Path, arguments: &[String]) -> Result<ExitCode, String> {
    let folder = root.join("target/book/pages");
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    let copy = |name: &str| {
        let to = folder.join(name);
        let made = to.parent().map_or(Ok(()), fs::create_dir_all);
        made.and_then(|()| fs::copy(root.join(name), &to)).map_err(|error| format!("{name}: {error}"))
    };
    copy("SUMMARY.md")?;
    for page in summary(root)? {
        copy(&page)?;
        let text = read(&root.join(&page))?;
        for link in links(&text) {
            let file = target(&page, &link.target).0;
            let is_page = file.ends_with(".md");
            if root.join(&file).is_file() && !is_page {
                copy(&file)?;
            }
        }
    }
    let status = Command::new("mdbook").arg("build").arg(root).args(arguments).status().map_err(|error| {
        format!("mdbook: {error}\nIt is not a part of this repository. Install it with: cargo install mdbook --locked")
    })?;
    if status.success() {
        println!("{}", root.join("target/book/html/index.html").display());
    }
    Ok(if status.success() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// The pages of SUMMARY.md, in its order.
fn summary(root: &Path) -> Result<Vec<String>, String> {
    let text = read(&root.join("SUMMARY.md"))?;
    Ok(links(&text).into_iter().map(|link| target("SUMMARY.md", &link.target).0).collect())
}

/// All links of all pages that lead to no file or to no heading, as `page:line: target: reason`.
fn broken_links(root: &Path) -> Result<Vec<String>, String> {
    let texts: BTreeMap<String, String> = pages(root)
        .into_iter()
        .map(|page| Ok((page.clone(), read(&root.join(&page))?)))
        .collect::<Result<_, String>>()?;
    let mut broken = Vec::new();
    for (page, text) in &texts {
        for link in links(text) {
            let (file, anchor) = target(page, &link.target);
            let reason = match (texts.get(&file), anchor) {
                _ if !root.join(&file).exists() => "no such file",
                (Some(text), Some(anchor)) if !anchors(text).contains(&anchor) => "no such heading",
                (None, Some(_)) => "an anchor of a file without headings",
                _ => continue,
            };
            broken.push(format!("{page}:{}: {}: {reason}", link.line, link.target));
        }
    }
    Ok(broken)
}

/// The Markdown files of the repository.
fn pages(root: &Path) -> Vec<String> {
    let roots =
        children(root).into_iter().filter(|path| ![".git", "target", "out"].contains(&file_name(path).as_str()));
    let found = roots.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] });
    let mut pages: Vec<String> = found
        .filter(|path| path.extension().is_some_and(|end| end == "md"))
        .map(|path| relative(root, &path))
        .collect();
    pages.sort();
    pages
}

struct Link {
    line: usize,
    target: String,
}

/// The links and images of a page that lead to a file of the repository. Code is left out.
fn links(text: &str) -> Vec<Link> {
    let mut found = Vec::new();
    for (line, content) in prose(text) {
        // A link's text may hold code; its target follows `](`.
        let mut rest = without_code(&content);
        while let Some(at) = rest.find("](") {
            rest = rest.split_off(at + 2);
            // Between < and > a target may have spaces and brackets.
            let target = match rest.strip_prefix('<') {
                Some(within) => {
                    let Some((target, _)) = within.split_once('>') else { break };
                    target
                }
                None => {
                    let Some((target, _)) = rest.split_once(')') else { break };
                    target.split_whitespace().next().unwrap_or_default()
                }
            };
            let elsewhere = target.contains("://") || target.starts_with("mailto:") || target.is_empty();
            if !elsewhere {
                found.push(Link { line, target: target.to_owned() });
            }
        }
    }
    found
}

/// The anchors of a page's headings, as GitHub and mdBook make them.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (_, line) in prose(text) {
        let level = line.chars().take_while(|&c| c == '#').count();
        let Some(title) = line[level..].strip_prefix(' ').filter(|_| (1..=6).contains(&level)) else { continue };
        let mut slug = String::new();
        for c in title.trim().chars() {
            match c {
                ' ' | '-' => slug.push('-'),
                '_' => slug.push('_'),
                _ if c.is_alphanumeric() => slug.extend(c.to_lowercase()),
                _ => {}
            }
        }
        let unique = (0..).map(|n| if n == 0 { slug.clone() } else { format!("{slug}-{n}") });
        found.extend(unique.into_iter().find(|slug| !found.contains(slug)));
    }
    found
}

/// The lines of a page outside of fenced code, counted from 1.
fn prose(text: &str) -> Vec<(usize, String)> {
    let mut fenced = false;
    let mut lines = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let fence = line.trim_start().starts_with("```");
        fenced ^= fence;
        if !fenced && !fence {
            lines.push((index + 1, line.to_owned()));
        }
    }
    lines
}

/// The line without what stands between backticks.
fn without_code(line: &str) -> String {
    line.split('`').step_by(2).collect::<Vec<_>>().join("`")
}

/// What a link of a page leads to: a path from the root of the repository, and an anchor.
fn target(page: &str, link: &str) -> (String, Option<String>) {
    let (path, anchor) = link.split_once('#').map_or((link, None), |(path, anchor)| (path, Some(anchor.to_owned())));
    if path.is_empty() {
        return (page.to_owned(), anchor);
    }
    let mut parts = PathBuf::from(page);
    parts.pop();
    for part in Path::new(path).components() {
        match part {
            Component::ParentDir => {
                parts.pop();
            }
            Component::Normal(name) => parts.push(name),
            _ => {}
        }
    }
    (relative(Path::new(""), &parts), anchor)
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_link_of_every_page_leads_somewhere() {
        let broken = broken_links(&crate::root()).unwrap();
        assert!(broken.is_empty(), "{}", broken.join("\n"));
        assert!(pages(&crate::root()).len() > 60);
    }

    #[test]
    fn the_book_has_every_page_of_the_documentation() {
        let root = crate::root();
        let listed: BTreeSet<String> = summary(&root).unwrap().into_iter().collect();
        let missing: Vec<String> =
            pages(&root).into_iter().filter(|page| page.starts_with("docs/") && !listed.contains(page)).collect();
        assert!(missing.is_empty(), "SUMMARY.md leaves out {missing:?}");
    }

    #[test]
    fn links_are_found_outside_of_code_only() {
        let text = "a [b](c.md) ![d](e.png) `[f](g.md)` [`h`](i.md#j)\n```\n[k](l.md)\n```\n[m](https://n.o) [p](#q) ![r](<s (t).svg>)";
        let found: Vec<String> = links(text).into_iter().map(|link| format!("{}:{}", link.line, link.target)).collect();
        assert_eq!(found, ["1:c.md", "1:e.png", "1:i.md#j", "5:#q", "5:s (t).svg"]);
    }

    #[test]
    fn headings_have_the_anchors_that_pages_on_the_web_have() {
        let text = "# A `b` c, d?\n## 1. E – f\n## Twice\n## Twice\n```\n# no\n```\n#no\n## χ² of g_h";
        let expected = ["1-e--f", "a-b-c-d", "twice", "twice-1", "χ²-of-g_h"];
        assert_eq!(anchors(text).into_iter().collect::<Vec<_>>(), expected);
    }

    #[test]
    fn targets_are_paths_from_the_root() {
        assert_eq!(target("docs/how-to/a.md", "../b.md#c"), ("docs/b.md".to_owned(), Some("c".to_owned())));
        assert_eq!(target("docs/a.md", "#c"), ("docs/a.md".to_owned(), Some("c".to_owned())));
        assert_eq!(target("README.md", "docs"), ("docs".to_owned(), None));
    }
}
