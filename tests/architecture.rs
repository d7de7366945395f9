//! The arrows of ARCHITECTURE.md, read from the sources: app -> render -> core and never back, what core may not know,
//! the floors of core's rooms, and no circle between files that stand side by side.

#![allow(clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The rooms of core, from the lowest floor to the highest: a room imports only from rooms before it in this list.
const FLOORS: [&str; 20] = [
    "fault",
    "progress",
    "kernel",
    "geometry",
    "metric",
    "mesh",
    "soup",
    "formats",
    "discrete",
    "background",
    "step",
    "case",
    "front",
    "prepare",
    "convert",
    "run",
    "question",
    "lesson",
    "record",
    "reduce",
];

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

/// A module by its path below `src` (`core::mesh::half_edge`), with the modules that its code names.
type Arrows = BTreeMap<String, BTreeSet<String>>;

/// The module of a file, by its path below `src`.
fn module(path: &Path) -> String {
    let path = path.with_extension("");
    let names: Vec<_> = path.iter().map(|name| name.to_str().unwrap()).filter(|name| *name != "mod").collect();
    names.join("::")
}

/// The paths that a text names after a start such as `crate::`, groups in braces taken apart.
fn paths(text: &str) -> Vec<String> {
    let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':')).unwrap_or(text.len());
    let (head, rest) = text.split_at(end);
    let Some(group) = rest.strip_prefix('{').filter(|_| head.is_empty() || head.ends_with("::")) else {
        return vec![head.to_owned()];
    };
    let (mut depth, mut starts, mut length) = (0, vec![0], group.len());
    for (i, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => {
                length = i;
                break;
            }
            '}' => depth -= 1,
            ',' if depth == 0 => starts.push(i + 1),
            _ => {}
        }
    }
    let within = |start: &usize| paths(group[*start..length].trim_start());
    starts.iter().flat_map(within).map(|path| format!("{head}{path}")).collect()
}

/// The absolute paths (without `crate`) that the code of a module names by `crate::` and `super::`.
fn named(module: &str, text: &str) -> Vec<String> {
    let text = code(text).into_iter().map(|(_, line)| line + "\n").collect::<String>();
    let starts = |word: &str| {
        let is_path = |at: &usize| !text[..*at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':');
        text.match_indices(word).map(|(at, _)| at).filter(is_path).collect::<Vec<_>>()
    };
    let mut found = Vec::new();
    for at in starts("crate::") {
        found.extend(paths(&text[at + "crate::".len()..]));
    }
    for at in starts("super::") {
        let mut rest = &text[at..];
        let mut folder: Vec<&str> = module.split("::").collect();
        while let Some(after) = rest.strip_prefix("super::") {
            folder.pop();
            rest = after;
        }
        found.extend(paths(rest).into_iter().map(|path| format!("{}::{path}", folder.join("::"))));
    }
    found
}

/// The arrows between modules, given by module and text.
fn arrows(texts: &BTreeMap<String, String>) -> Arrows {
    let known = |path: &str| {
        let mut path = path;
        loop {
            if texts.contains_key(path) {
                return Some(path.to_owned());
            }
            path = path.rsplit_once("::")?.0;
        }
    };
    let of = |(module, text): (&String, &String)| {
        let targets = named(module, text).iter().filter_map(|path| known(path)).filter(|to| to != module).collect();
        (module.clone(), targets)
    };
    texts.iter().map(of).collect()
}

/// The imports of core that lead from a room to one above it.
fn upward(arrows: &Arrows) -> Vec<String> {
    let room = |module: &str| module.split("::").nth(1).map(str::to_owned);
    let floor = |module: &str| FLOORS.iter().position(|name| Some(*name) == room(module).as_deref());
    let mut found = Vec::new();
    for (from, targets) in arrows.iter().filter(|(from, _)| from.starts_with("core::")) {
        let Some(own) = floor(from) else {
            found.push(format!("{from} stands on no floor: name its room in FLOORS"));
            continue;
        };
        let higher = targets.iter().filter(|to| floor(to).is_some_and(|other| other > own));
        found.extend(higher.map(|to| format!("{from} imports {to}, which stands on a higher floor")));
    }
    found
}

/// Circles between modules side by side in one folder, each with what stands below it. A parent and its own modules may
/// know each other.
fn circles(arrows: &Arrows) -> Vec<String> {
    let mut beside: BTreeMap<String, Arrows> = BTreeMap::new();
    for (from, targets) in arrows {
        for to in targets {
            let (a, b): (Vec<&str>, Vec<&str>) = (from.split("::").collect(), to.split("::").collect());
            let shared = a.iter().zip(&b).take_while(|(a, b)| a == b).count();
            if shared < a.len().min(b.len()) {
                let folder = beside.entry(a[..shared].join("::")).or_default();
                folder.entry(a[..=shared].join("::")).or_default().insert(b[..=shared].join("::"));
            }
        }
    }
    let mut found = Vec::new();
    for (folder, arrows) in &beside {
        let mut reached: Arrows = arrows.clone();
        while let Some((from, to)) = step(&reached) {
            reached.entry(from).or_default().insert(to);
        }
        let closed: Vec<&str> = reached.iter().filter(|(a, to)| to.contains(*a)).map(|(a, _)| a.as_str()).collect();
        if !closed.is_empty() {
            found.push(format!("a circle in {folder}: {}", closed.join(", ")));
        }
    }
    found
}

/// An arrow that follows from two others and is not there yet.
fn step(arrows: &Arrows) -> Option<(String, String)> {
    arrows.iter().find_map(|(a, targets)| {
        let farther = targets.iter().filter_map(|b| arrows.get(b)).flatten();
        farther.filter(|c| !targets.contains(*c)).map(|c| (a.clone(), c.clone())).next()
    })
}

/// All modules of core and their texts; tests and their fixtures may know what they like.
fn core_texts() -> BTreeMap<String, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&root.join("core"), &mut files);
    let is_test = |path: &PathBuf| path.ends_with("tests.rs") || path.ends_with("fixtures.rs");
    let read = |path: PathBuf| (module(path.strip_prefix(&root).unwrap()), fs::read_to_string(&path).unwrap());
    files.into_iter().filter(|path| !is_test(path)).map(read).collect()
}

#[test]
fn rooms_of_core_import_only_from_lower_floors() {
    let found = upward(&arrows(&core_texts()));
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

#[test]
fn no_circle_runs_between_files_side_by_side() {
    let found = circles(&arrows(&core_texts()));
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

#[test]
fn a_planted_import_upward_and_a_planted_circle_are_seen() {
    let mut texts = core_texts();
    let plant = |texts: &mut BTreeMap<String, String>, module: &str, line: &str| {
        let text = texts.get_mut(module).unwrap();
        text.insert_str(0, line);
    };
    plant(&mut texts, "core::mesh::ids", "use crate::core::{fault::Fault, run::run::Run};\n");
    let found = upward(&arrows(&texts));
    assert_eq!(found, ["core::mesh::ids imports core::run::run, which stands on a higher floor"]);
    assert_eq!(circles(&arrows(&texts)).len(), 1, "rooms stand side by side too");
    let mut texts = core_texts();
    plant(&mut texts, "core::mesh::ids", "use super::half_edge::{Mesh, setters};\n");
    let found = circles(&arrows(&texts));
    assert!(found.len() == 1 && found[0].starts_with("a circle in core::mesh:"), "{found:?}");
    let mut texts = core_texts();
    plant(&mut texts, "core::mesh::half_edge::setters", "use super::{Mesh, super::half_edge::copies};\n");
    assert!(circles(&arrows(&texts)).is_empty(), "a module may know its parent");
    texts.insert("core::attic".to_owned(), String::new());
    assert_eq!(upward(&arrows(&texts)), ["core::attic stands on no floor: name its room in FLOORS"]);
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

/// What is too long in a source: the file itself (tests aside), or a comment; tables in Markdown may be wider, and
/// lines of code are rustfmt's.
fn too_long(path: &str, text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let lines = text.lines().count();
    if path.starts_with("src/") && lines > 500 {
        found.push(format!("{path} has {lines} lines: divide it, 500 are the limit"));
    }
    let is_table = |line: &str| line.starts_with("//! |") || line.starts_with("/// |");
    let is_long = |line: &str| line.trim_start().starts_with("//") && !is_table(line) && line.chars().count() > 120;
    let long = text.lines().zip(1..).filter(|(line, _)| is_long(line));
    found.extend(long.map(|(_, number)| format!("{path}:{number}: comments end by column 120")));
    found
}

#[test]
fn files_have_at_most_500_lines_and_comments_end_by_column_120() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    ["src", "tests", "benches", "examples"].iter().for_each(|folder| sources(&root.join(folder), &mut files));
    let name = |file: &Path| file.strip_prefix(root).unwrap().display().to_string().replace('\\', "/");
    let found: Vec<String> =
        files.iter().flat_map(|file| too_long(&name(file), &fs::read_to_string(file).unwrap())).collect();
    assert!(found.is_empty(), "\n{}", found.join("\n"));
    assert_eq!(too_long("src/a.rs", &format!("{}{}", "//\n".repeat(500), "/".repeat(121))).len(), 2);
}
