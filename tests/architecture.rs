//! The arrows of ARCHITECTURE.md, read from the sources: app -> render -> core and never back, and what core may not know.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};

/// What no source of a room may mention, with the reason.
const FORBIDDEN: [(&str, &[(&str, &str)]); 2] = [
    (
        "core",
        &[
            ("crate::render", "core knows no picture"),
            ("crate::app", "core knows no application"),
            ("egui", "core knows no screen"),
            ("eframe", "core knows no screen"),
            ("wgpu", "core knows no screen"),
            ("winit", "core knows no screen"),
            ("indicatif", "core knows no terminal"),
            ("clap", "core knows no command line"),
            ("std::time", "core knows no clock"),
            ("Instant", "core knows no clock"),
            ("SystemTime", "core knows no clock"),
            ("std::thread", "core has no state of a thread"),
            ("thread_local", "core has no state of a thread"),
            ("std::env", "a run depends on nothing around it"),
            (
                "HashMap",
                "its order differs from run to run: BTreeMap, or FxHashMap that is only asked and never walked",
            ),
            (
                "HashSet",
                "its order differs from run to run: BTreeSet, or FxHashSet that is only asked and never walked",
            ),
            ("RandomState", "its order differs from run to run"),
            ("println", "core does not print"),
            ("eprintln", "core does not print"),
        ],
    ),
    ("render", &[("crate::app", "render knows no application"), ("std::time", "a picture depends on no clock")]),
];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// The lines that the program is made of: without comments, and without tests, which may know what they like.
fn code(text: &str) -> Vec<(usize, String)> {
    let mut lines = Vec::new();
    for (i, line) in text.lines().enumerate() {
        if line.trim_start().starts_with("#[cfg(test)]") && !line.contains("use ") {
            let next = text.lines().skip(i + 1).find(|l| !l.trim_start().starts_with("#[")).unwrap_or_default();
            // Tests stand last in a file; a test-only item before them is skipped by its one line.
            if next.trim_start().starts_with("mod tests {") {
                break;
            }
        }
        lines.push((i + 1, without_comment(line)));
    }
    lines
}

/// A line without its comment and without its texts: a word within quotes is no use of a thing.
fn without_comment(line: &str) -> String {
    let mut kept = String::new();
    let mut quoted = false;
    let mut characters = line.chars().peekable();
    while let Some(c) = characters.next() {
        match c {
            '\\' if quoted => drop(characters.next()),
            '"' => quoted = !quoted,
            '/' if !quoted && characters.peek() == Some(&'/') => break,
            c if !quoted => kept.push(c),
            _ => {}
        }
    }
    kept
}

/// Whether a line has the word, not as a part of a longer one.
fn mentions(line: &str, word: &str) -> bool {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    line.match_indices(word).any(|(at, _)| {
        !line[..at].chars().next_back().is_some_and(part) && !line[at + word.len()..].chars().next().is_some_and(part)
    })
}

fn offences(room: &str, path: &str, text: &str) -> Vec<String> {
    let (_, forbidden) = FORBIDDEN.iter().find(|(name, _)| *name == room).unwrap();
    let mut found = Vec::new();
    for (number, line) in code(text) {
        // `use crate::{render, core}` names the room without its path.
        let line = if line.contains("crate::{") {
            line.replace("render", "crate::render").replace("app", "crate::app")
        } else {
            line
        };
        for (word, reason) in *forbidden {
            if mentions(&line, word) {
                found.push(format!("{path}:{number}: {word}: {reason}"));
            }
        }
    }
    found
}

#[test]
fn the_rooms_know_only_what_they_may() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    for (room, _) in FORBIDDEN {
        let mut files = Vec::new();
        sources(&root.join(room), &mut files);
        assert!(!files.is_empty(), "{room} has sources");
        for file in files {
            if file.ends_with("tests.rs") {
                continue;
            }
            let path = file.strip_prefix(&root).unwrap().display().to_string();
            found.extend(offences(room, &path, &fs::read_to_string(&file).unwrap()));
        }
    }
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

#[test]
fn an_arrow_that_runs_back_is_seen() {
    for line in [
        "use crate::render::picture::Picture;",
        "use crate::{app, core};",
        "let t = std::time::Instant::now();",
        "use std::collections::{BTreeMap, HashMap};",
    ] {
        assert!(!offences("core", "a.rs", line).is_empty(), "{line}");
    }
    for line in [
        "/// unlike std::time, this ...",
        "let s = \"HashMap\"; // HashMap",
        "use rustc_hash::FxHashMap;",
        "#[cfg(test)]\nmod tests {\n    use std::time::Instant;\n}",
    ] {
        assert!(offences("core", "a.rs", line).is_empty(), "{line}");
    }
}

/// The modules of `src/app/window` that change the window's state.
const CHANGE_THE_STATE: [&str; 2] = ["state/apply", "state/hearing"];

/// Lines that take the window's state to change it: by reference, or in a method of the state.
fn changes_of_the_state(path: &str, text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut is_of_state = false;
    for (number, line) in code(text) {
        match line.as_bytes().first() {
            Some(b'i') => is_of_state = line.starts_with("impl") && mentions(&line, "State"),
            Some(b'}') => is_of_state = false,
            _ => {}
        }
        if mentions(&line, "mut State") || is_of_state && mentions(&line, "mut self") {
            found.push(format!("{path}:{number}: only {} change the state", CHANGE_THE_STATE.join(" and ")));
        }
    }
    found
}

#[test]
fn only_two_modules_change_the_state_of_the_window() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/app/window");
    let mut files = Vec::new();
    sources(&root, &mut files);
    let (mut found, mut permitted) = (Vec::new(), 0);
    for file in files {
        let path = file.strip_prefix(&root).unwrap().with_extension("").display().to_string().replace('\\', "/");
        let changes = changes_of_the_state(&path, &fs::read_to_string(&file).unwrap());
        if CHANGE_THE_STATE.iter().any(|name| path == *name || path.starts_with(&format!("{name}/"))) {
            permitted += changes.len();
        } else {
            found.extend(changes);
        }
    }
    assert!(found.is_empty(), "\n{}", found.join("\n"));
    assert!(permitted > 20, "the two modules have methods that change the state");
}

#[test]
fn a_panel_that_changes_the_state_is_seen() {
    for text in [
        "pub fn show(ui: &mut Ui, state: &mut State) {",
        "struct Docks<'a> {\n    state: &'a mut State,\n}",
        "impl State {\n    pub fn hover(&mut self) {\n    }\n}",
        "impl super::State {\n    fn close(mut self) {\n    }\n}",
    ] {
        assert_eq!(changes_of_the_state("panels/a", text).len(), 1, "{text}");
    }
    for text in [
        "pub fn show(ui: &mut Ui, state: &State, local: &mut FrontState) {",
        "impl State {\n    pub fn run(&self) -> &RunState {\n    }\n}\n\nimpl Views {\n    fn note(&mut self) {\n    }\n}",
        "// State is not taken as &mut State here.",
    ] {
        assert!(changes_of_the_state("panels/a", text).is_empty(), "{text}");
    }
}
