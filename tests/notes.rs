//! Promise: the notes on the bookmarked steps of a run are kept in its file, and become one page with the figure of
//! each step.
#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::process::{Command, Output};

use base64::Engine;
use quadfront::core::case::built_in;
use quadfront::core::record::run_file;
use quadfront::core::run::{Bookmark, Run};

fn quadfront(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_quadfront")).args(arguments).current_dir(folder).output().unwrap()
}

/// A run of a small case with these bookmarks, saved as a file.
fn saved(folder: &Path, marks: &[(u64, &str)]) {
    let mut run = Run::of(built_in::named("figure-19").unwrap().unwrap());
    run.bookmarks = marks.iter().map(|(step, note)| Bookmark { step: *step, note: (*note).to_owned() }).collect();
    run_file::write(&folder.join("a.toml"), &run).unwrap();
    let again = run_file::read(&folder.join("a.toml")).unwrap();
    assert_eq!(again.bookmarks, run.bookmarks);
}

#[test]
fn each_bookmark_becomes_a_section_with_its_figure_and_its_note() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    saved(folder, &[(0, "The *beginning*: \"θ\" \\ ü\n\n- one\n- two"), (9, ""), (1_000_000, "never")]);
    let done = quadfront(&["notes", "a.toml", "-q", "-o", "a.html"], folder);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let page = std::fs::read_to_string(folder.join("a.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>\n"));
    assert_eq!(page.matches("<section id=\"step-").count(), 3);
    for text in [
        "<p>The <em>beginning</em>: \"θ\" \\ ü</p>",
        "<li>one</li>",
        "<h2>Step 9 · ",
        "The run ends before, at step ",
        "<p>never</p>",
        "<a href=\"#step-9\">step 9</a>",
    ] {
        assert!(page.contains(text), "{text}: {page}");
    }
    // Each image is the figure that `render` draws of that step.
    let images: Vec<&str> = page.split("data:image/svg+xml;base64,").skip(1).collect();
    assert_eq!(images.len(), 2);
    for (image, step) in images.iter().zip([0, 9]) {
        let text = image.split('"').next().unwrap();
        let svg = String::from_utf8(base64::engine::general_purpose::STANDARD.decode(text).unwrap()).unwrap();
        let at = format!("step={step}");
        let drawn = quadfront(&["render", "a.toml", "-q", "--at", &at, "-o", "-"], folder);
        assert!(drawn.status.success(), "{}", String::from_utf8_lossy(&drawn.stderr));
        assert!(svg == String::from_utf8(drawn.stdout).unwrap(), "step {step}");
    }
    let again = quadfront(&["notes", "a.toml", "-q", "-o", "-"], folder);
    assert_eq!(String::from_utf8(again.stdout).unwrap(), page, "the same bytes");
}

#[test]
fn a_run_without_bookmarks_is_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    saved(folder.path(), &[]);
    let done = quadfront(&["notes", "a.toml", "-q", "-o", "a.html"], folder.path());
    let error = String::from_utf8(done.stderr).unwrap();
    assert_eq!(done.status.code(), Some(2));
    assert!(error.starts_with("error: a.toml: This run has no bookmarks, and so no notes. Bookmark steps"), "{error}");
    assert!(!folder.path().join("a.html").exists());
    saved(folder.path(), &[(3, "x")]);
    let done = quadfront(&["notes", "a.toml", "-q", "--plot", "angles", "-o", "a.html"], folder.path());
    assert!(String::from_utf8(done.stderr).unwrap().contains("no histograms"));
}

#[test]
fn a_step_tells_the_candidates_that_it_refused_and_the_attempts_so_far() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let done = quadfront(&["convert", "example1", "-q", "--events", "events.jsonl"], folder);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let text = std::fs::read_to_string(folder.join("events.jsonl")).unwrap();
    let events: Vec<serde_json::Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let at = |kind: &str, from: usize| (from..events.len()).find(|k| events[*k]["kind"] == kind).unwrap();
    // A side that was chosen, and the second attempt at one base that was taken back.
    let chosen = at("side_chosen", 0);
    let mut failed = at("rolled_back", 0);
    while events[failed]["attempt"] != 1 {
        failed = at("rolled_back", failed + 1);
    }
    let mut run = Run::of(built_in::named("example1").unwrap().unwrap());
    run.bookmarks = [chosen, failed].map(|k| Bookmark { step: k as u64 + 1, note: String::new() }).to_vec();
    run_file::write(&folder.join("a.toml"), &run).unwrap();
    let done = quadfront(&["notes", "a.toml", "-q", "-o", "-"], folder);
    let page = String::from_utf8(done.stdout).unwrap();
    let sections: Vec<&str> = page.split("<section ").skip(1).collect();
    let edges = events[chosen]["candidates"]["edges"].as_array().unwrap();
    let (refused, taken): (Vec<_>, Vec<_>) = edges.iter().partition(|edge| edge["passed"].is_string());
    assert!(refused.len() > 1 && taken.len() == 1);
    assert_eq!(sections[0].matches("<li>Candidate to node ").count(), refused.len());
    for edge in refused {
        assert!(sections[0].contains(&format!("<li>Candidate to node {}", edge["node"])), "{edge}");
    }
    assert_eq!(sections[1].matches("<li>Attempt ").count() - sections[1].matches("Taken back: ").count(), 1);
    assert_eq!(sections[1].matches("Taken back: ").count(), 2, "{}", sections[1]);
}
