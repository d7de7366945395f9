//! What the sources say of docs/algorithm.md is true: every heading that they cite is there, and every function and
//! constant that the page names is in `src/core`. The form of a citation stands at the head of the page.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// How a citation begins; names of headings in quotes follow, joined by commas or "and".
const BEGIN: &str = "docs/algorithm.md, \"";
/// Fewer citations than this mean that the test does not see them.
const LEAST_CITATIONS: usize = 70;
/// This file plants wrong ones.
const OWN: &str = "tests/book.rs";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap()
}

fn book() -> String {
    read(&root().join("docs/algorithm.md"))
}

/// The files of a folder and its subfolders with one of these extensions, by name.
fn files(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut entries: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    let wanted = |path: &Path| path.extension().is_some_and(|e| extensions.iter().any(|wanted| e == *wanted));
    entries
        .into_iter()
        .flat_map(|path| match path.is_dir() {
            true => files(&path, extensions),
            false if wanted(&path) => vec![path],
            false => Vec::new(),
        })
        .collect()
}

/// Everything that may cite the page, by its path in the repository.
fn texts() -> Vec<(String, String)> {
    let mut paths: Vec<PathBuf> = ["src", "tests", "benches", "docs", "assets", "examples", "tools"]
        .iter()
        .map(|folder| root().join(folder))
        .filter(|folder| folder.is_dir())
        .flat_map(|folder| files(&folder, &["rs", "md", "toml", "py", "sh", "wgsl"]))
        .collect();
    let at_root = fs::read_dir(root()).unwrap().map(|entry| entry.unwrap().path());
    paths.extend(at_root.filter(|path| path.extension().is_some_and(|e| e == "md")));
    let name = |path: &Path| path.strip_prefix(root()).unwrap().display().to_string().replace('\\', "/");
    let texts = paths.iter().map(|path| (name(path), read(path)));
    texts.filter(|(name, _)| name != OWN).collect()
}

/// A text as one line: without indentation and the slashes of comments, so that what wraps is whole again.
fn unwrapped(text: &str) -> String {
    let mut whole = String::new();
    for line in text.lines() {
        let line = line.trim();
        let comment = ["//!", "///", "//", "#"].iter().find_map(|slashes| line.strip_prefix(slashes));
        let line = comment.unwrap_or(line).trim().trim_end_matches('\\');
        if !whole.is_empty() && !whole.ends_with(' ') {
            whole.push(' ');
        }
        whole.push_str(line);
    }
    whole.replace("\\\"", "\"")
}

/// The names of headings that a text cites.
fn citations(text: &str) -> Vec<String> {
    let text = unwrapped(text);
    let mut found = Vec::new();
    for (at, _) in text.match_indices(BEGIN) {
        let mut rest = &text[at + BEGIN.len()..];
        while let Some((name, after)) = rest.split_once('"') {
            found.push(name.to_owned());
            let next = [", \"", " and \"", ", and \""].iter().find_map(|join| after.strip_prefix(join));
            let Some(next) = next else { break };
            rest = next;
        }
    }
    found
}

/// The headings of a page of Markdown; lines of code blocks are none.
fn headings(page: &str) -> Vec<String> {
    let mut in_code = false;
    let mut found = Vec::new();
    for line in page.lines() {
        in_code ^= line.starts_with("```");
        let name = line.trim_start_matches('#');
        if !in_code && name.len() < line.len() && name.starts_with(' ') {
            found.push(name.trim().to_owned());
        }
    }
    found
}

/// The anchor of a heading, as forges make it.
fn anchor(heading: &str) -> String {
    let kept = heading.to_lowercase();
    kept.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c)).collect::<String>().replace(' ', "-")
}

/// The anchors of the page that a text links to: `algorithm.md#...`, and `(#...)` in the page itself.
fn links(name: &str, text: &str) -> Vec<String> {
    let begin = if name == "docs/algorithm.md" { "(#" } else { "algorithm.md#" };
    let ends = |c: char| !(c.is_alphanumeric() || c == '-' || c == '_');
    let rest = text.match_indices(begin).map(|(at, _)| &text[at + begin.len()..]);
    rest.map(|rest| rest[..rest.find(ends).unwrap_or(rest.len())].to_owned()).collect()
}

/// What a text cites of a page and the page has not.
fn wrong(name: &str, text: &str, page: &str) -> Vec<String> {
    let names: BTreeSet<String> = headings(page).into_iter().collect();
    let anchors: BTreeSet<String> = names.iter().map(|heading| anchor(heading)).collect();
    let cited = citations(text).into_iter().filter(|cited| !names.contains(cited));
    let linked = links(name, text).into_iter().filter(|linked| !anchors.contains(linked));
    cited.chain(linked).map(|what| format!("{name}: there is no \"{what}\"")).collect()
}

/// Citations by number of a page that is not in the repository.
fn by_number(text: &str) -> Vec<String> {
    let text = unwrapped(text);
    let starts = |at: usize| text[..at].chars().next_back().is_none_or(|c| !c.is_alphanumeric() && c != '_');
    let found = text
        .match_indices("spec ")
        .filter(|(at, word)| starts(*at) && text[at + word.len()..].starts_with(|c: char| c.is_ascii_digit()));
    found.map(|(at, _)| text[at..].chars().take(20).collect()).collect()
}

#[test]
fn every_heading_that_is_cited_is_there() {
    let page = book();
    let texts = texts();
    let wrong: Vec<String> = texts.iter().flat_map(|(name, text)| wrong(name, text, &page)).collect();
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
    let cited: usize = texts.iter().map(|(_, text)| citations(text).len()).sum();
    assert!(cited >= LEAST_CITATIONS, "only {cited} citations are seen");
}

#[test]
fn no_page_is_cited_by_number() {
    for (name, text) in texts() {
        assert!(by_number(&text).is_empty(), "{name}: {:?}", by_number(&text));
    }
}

#[test]
fn headings_are_cited_by_names_that_only_one_of_them_has() {
    let mut names = headings(&book());
    assert!(names.len() > 40, "{names:?}");
    names.sort();
    assert!(names.windows(2).all(|two| two[0] != two[1]), "{names:?}");
}

#[test]
fn every_function_and_constant_that_the_page_names_is_in_core() {
    let sources = files(&root().join("src/core"), &["rs"]);
    let sources: String = sources.iter().map(|path| read(path)).collect();
    let mut named = 0;
    for span in book().split('`').skip(1).step_by(2) {
        let last = span.rsplit("::").next().unwrap();
        let is_word = |word: &str| !word.is_empty() && word.chars().all(|c| c.is_alphanumeric() || c == '_');
        let is_constant = last.len() > 3 && last.contains('_') && last.to_uppercase() == last;
        if let Some(function) = last.strip_suffix("()").filter(|function| is_word(function)) {
            named += 1;
            let there = ["(", "<"].iter().any(|end| sources.contains(&format!("fn {function}{end}")));
            assert!(there, "the page names {span}, and there is no such function");
        } else if is_constant && is_word(last) {
            assert!(
                sources.contains(&format!("const {last}:")),
                "the page names {span}, and there is no such constant"
            );
        }
    }
    assert!(named > 60, "only {named} functions are seen");
}

#[test]
fn a_wrong_citation_is_seen_however_it_wraps() {
    let page = "# Page\n\n## Side edges\n\n```\n# no heading\n```\n### Sides over 1.5 l_AB\n";
    assert_eq!(headings(page), ["Page", "Side edges", "Sides over 1.5 l_AB"]);
    for right in [
        "//! Sides (docs/algorithm.md, \"Side edges\").",
        "    /// Sides (docs/algorithm.md, \"Side\n    /// edges\", \"Sides over 1.5 l_AB\").",
        "// Sides (paper 4.3.4; docs/algorithm.md,\n// \"Side edges\" and \"Sides over 1.5\n// l_AB\"), \"not this\".",
        "asks: \"Sides (docs/algorithm.md, \\\"Side edges\\\")\"",
        "[sides](docs/algorithm.md#sides-over-15-l_ab)",
    ] {
        assert_eq!(wrong("a.rs", right, page), [""; 0], "{right}");
        assert!(!citations(right).is_empty() || !links("a.rs", right).is_empty(), "{right}");
    }
    for planted in [
        "//! Sides (docs/algorithm.md, \"Side edge\").",
        "    /// Sides (docs/algorithm.md, \"Side edges\", \"Sides\n    /// over 1.5\").",
        "// Sides (docs/algorithm.md,\n// \"no heading\").",
        "asks: \"Sides (docs/algorithm.md, \\\"Side  edges\\\")\"",
        "[sides](docs/algorithm.md#sides)",
    ] {
        assert_eq!(wrong("a.rs", planted, page).len(), 1, "{planted}");
    }
    assert_eq!(wrong("docs/algorithm.md", "[a](#side-edges) [b](#top-edge)", page).len(), 1);
}

#[test]
fn a_citation_by_number_is_seen() {
    for planted in ["/// Sides (spec 2.3).", "//! Sides (paper 4.3.4; spec\n//! 2.3)."] {
        assert_eq!(by_number(planted).len(), 1, "{planted}");
    }
    for right in ["let spec = 2;", "// The spec of 2 curves.", "for spec in specs {", "inspec 2.3", "x(spec, face)"] {
        assert!(by_number(right).is_empty(), "{right}");
    }
}
