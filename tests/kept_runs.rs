//! Promise: a crash or a kill loses nothing of what a person did in the window, a figure that is dropped on it opens
//! what it shows, and a file that goes bad under it is told.
//!
//! Needs a graphics adapter (see `window_harness`).
#![allow(clippy::unwrap_used)]

mod window_harness;

use std::path::Path;
use std::process::{Command as Process, Stdio};
use std::time::{Duration, Instant};

use egui_kittest::kittest::Queryable;
use quadfront::app::window::{App, Command, Goal, Source};
use quadfront::core::mesh::NodeId;
use quadfront::core::run::Watched;
use quadfront::render::scene::Outlined;
use window_harness::{LAPTOP, Window, apply, has_adapter, settle, start, type_over, until};

/// Set for the child that works until it is killed: where runs are kept.
const CHILD: &str = "QUADFRONT_TEST_KEEPS_IN";

/// A window on a source that keeps its run in a folder.
fn window(source: Source, folder: &Path) -> Window {
    let folder = folder.to_path_buf();
    let mut harness = start(LAPTOP, |cc| App::new(cc, Some(source)).keeping(Some(folder)));
    settle(&mut harness);
    harness
}

fn example() -> Source {
    Source::BuiltIn("example1".to_owned())
}

/// Files of runs in a folder.
fn runs(folder: &Path) -> usize {
    let Ok(entries) = std::fs::read_dir(folder) else { return 0 };
    entries.filter(|entry| entry.as_ref().unwrap().path().extension().is_some_and(|e| e == "toml")).count()
}

#[test]
fn a_window_that_is_killed_loses_nothing_and_its_run_is_offered_at_the_next_start() {
    if !has_adapter() {
        return;
    }
    if let Some(folder) = std::env::var_os(CHILD) {
        let mut harness = window(example(), Path::new(&folder));
        apply(&mut harness, Command::Go(Goal::Step(60)));
        apply(&mut harness, Command::Set("c", "1.5".to_owned()));
        apply(&mut harness, Command::Go(Goal::Step(90)));
        apply(&mut harness, Command::Set("theta_rect", "120".to_owned()));
        apply(&mut harness, Command::AddBreakpoint("kind == rolled_back".to_owned()));
        apply(&mut harness, Command::Watch(Outlined::Node(NodeId(3))));
        apply(&mut harness, Command::Bookmark);
        loop {
            harness.run_steps(1);
            std::thread::sleep(Duration::from_millis(5));
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let mut child = Process::new(std::env::current_exe().unwrap())
        .args(["--exact", "a_window_that_is_killed_loses_nothing_and_its_run_is_offered_at_the_next_start"])
        .env(CHILD, folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    // The bookmark is what it does last.
    let begin = Instant::now();
    let has = |what: &str| {
        let mut files = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path());
        files.any(|path| std::fs::read_to_string(path).is_ok_and(|text| text.contains(what)))
    };
    let has_all = || has("[[bookmark]]") && has("\"node\":3");
    while !has_all() {
        assert!(begin.elapsed() < Duration::from_secs(120), "the child keeps nothing");
        std::thread::sleep(Duration::from_millis(5));
    }
    // While it lives, another window neither offers nor touches its run.
    let mut other = window(example(), folder.path());
    std::thread::sleep(Duration::from_millis(200));
    other.run_steps(3);
    assert!(other.query_by_label("Recover").is_none());
    drop(other);
    assert_eq!(runs(folder.path()), 1, "a window without changes keeps nothing");
    // On Unix this is kill -9.
    child.kill().unwrap();
    child.wait().unwrap();

    let mut harness = window(example(), folder.path());
    until(&mut harness, "the run is offered", |harness| harness.query_by_label("Recover").is_some());
    harness.get_by_label("An unsaved run of example1 with 2 edits from a moment ago can be recovered.");
    harness.get_by_label("Recover").click();
    until(&mut harness, "the run is opened", |harness| harness.state().state.document().edits.len() == 2);
    settle(&mut harness);
    let kept = &harness.state().state.document();
    assert_eq!(kept.bookmarks.iter().map(|mark| mark.step).collect::<Vec<_>>(), [90]);
    assert_eq!((kept.breakpoints[0].condition.as_str(), kept.breakpoints[0].is_on), ("kind == rolled_back", true));
    assert_eq!(kept.watches[0].watched, Watched::Node(NodeId(3)));
    assert_eq!(harness.state().state.run().moment.as_ref().unwrap().step, 90);
    assert!(!harness.state().state.run().hits[0].is_empty(), "the breakpoint is counted");
    assert!(harness.query_by_label("Recover").is_none());
    // One sentence says so, and no other one comes, though the file of the run is written again.
    apply(&mut harness, Command::Go(Goal::Steps(1)));
    std::thread::sleep(Duration::from_millis(2500));
    harness.run_steps(5);
    let said: Vec<_> = harness.state().state.view().log.messages.iter().map(|message| message.text.as_str()).collect();
    assert_eq!(said, ["example1 is recovered at step 90, with 2 edits, 1 bookmark, 1 breakpoint, 1 watchpoint."]);
    // It goes on being kept, and is still there when the window is closed without saving.
    apply(&mut harness, Command::Go(Goal::Step(200)));
    apply(&mut harness, Command::Set("c", "1.7".to_owned()));
    harness.run_steps(2);
    drop(harness);
    assert_eq!(runs(folder.path()), 1);
    let mut harness = window(example(), folder.path());
    until(&mut harness, "the run is offered", |harness| harness.query_by_label("Discard").is_some());
    harness.get_by_label("An unsaved run of example1 with 3 edits from a moment ago can be recovered.");
    harness.get_by_label("Discard").click();
    harness.run_steps(3);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing stays behind");
}

#[test]
fn what_is_taken_back_leaves_nothing_to_be_kept() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(example(), folder.path());
    apply(&mut harness, Command::Go(Goal::Step(60)));
    apply(&mut harness, Command::Set("c", "1.5".to_owned()));
    until(&mut harness, "the file is there", |_| runs(folder.path()) == 1);
    apply(&mut harness, Command::Undo);
    until(&mut harness, "the file is gone", |_| runs(folder.path()) == 0);
    apply(&mut harness, Command::Redo);
    until(&mut harness, "the file is there", |_| runs(folder.path()) == 1);
    // Another case takes the place of this one: the run that was not saved is offered at once.
    apply(&mut harness, Command::Open(Source::BuiltIn("uniform".to_owned())));
    until(&mut harness, "the run is offered", |harness| harness.query_by_label("Recover").is_some());
    drop(harness);
    assert_eq!(runs(folder.path()), 1);
}

#[test]
fn a_figure_opens_at_the_state_that_it_shows_and_another_state_is_said() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let figure = folder.path().join("a.svg");
    let kept = folder.path().join("runs");
    let mut harness = window(example(), &kept);
    for name in ["a.pdf", "a.svg"] {
        let figure = folder.path().join(name);
        let status = Process::new(env!("CARGO_BIN_EXE_quadfront"))
            .args(["render", "example1", "--at", "nq=40", "--set", "c=1.9", "-q", "-o"])
            .arg(&figure)
            .status();
        assert!(status.unwrap().success());
        apply(&mut harness, Command::Open(Source::File(figure)));
        let state = &harness.state().state;
        assert_eq!(state.run().moment.as_ref().unwrap().standing, 40, "{name}");
        assert_eq!((state.parameter("c").as_deref(), state.view().faults.len()), (Some("1.9"), 0));
        apply(&mut harness, Command::Open(example()));
    }
    let text = std::fs::read_to_string(&figure).unwrap();
    let at = text.find("fingerprint = \"").unwrap() + 15;
    let old = folder.path().join("old.svg");
    std::fs::write(&old, format!("{}{}{}", &text[..at], "0".repeat(32), &text[at + 32..])).unwrap();
    apply(&mut harness, Command::Open(Source::File(old)));
    let faults = &harness.state().state.view().faults;
    assert!(faults.len() == 1 && faults[0].contains("another state at step"), "{faults:?}");
}

#[test]
fn a_file_that_goes_bad_while_it_is_open_is_told_and_the_window_keeps_what_it_has() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plate.toml");
    let (_, text) = quadfront::core::case::built_in::all().find(|case| case.0 == "uniform").unwrap();
    std::fs::write(&path, text).unwrap();
    let mut harness = window(Source::File(path.clone()), &folder.path().join("runs"));
    apply(&mut harness, Command::Go(Goal::Step(30)));
    std::fs::write(&path, "version = 1\ntitel = 3\n").unwrap();
    until(&mut harness, "a fault is shown", |harness| !harness.state().state.view().faults.is_empty());
    let state = &harness.state().state;
    assert!(
        state.view().faults[0].contains("line 2") && state.view().faults[0].contains("keeps the run that is open"),
        "{:?}",
        state.view().faults
    );
    assert_eq!(state.run().moment.as_ref().unwrap().step, 30);
    // Opened again it is refused, and what is open stays.
    harness.state_mut().apply(Command::CloseFault(0));
    harness.state_mut().apply(Command::Reopen);
    until(&mut harness, "a fault is shown", |harness| !harness.state().state.view().faults.is_empty());
    settle(&mut harness);
    apply(&mut harness, Command::Go(Goal::Steps(1)));
    assert_eq!(harness.state().state.run().moment.as_ref().unwrap().step, 31);
    harness.state_mut().apply(Command::CloseFault(0));
    std::fs::remove_file(&path).unwrap();
    until(&mut harness, "a fault is shown", |harness| !harness.state().state.view().faults.is_empty());
    assert!(
        harness.state().state.view().faults[0].contains("No such file"),
        "{:?}",
        harness.state().state.view().faults
    );
}

#[test]
fn a_small_case_shows_its_notes() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(Source::named("figure-13"), folder.path());
    harness.get_by_label("Fig. 13: the H-value against the shortest segment");
    apply(&mut harness, Command::Notes);
    assert!(harness.query_by_label("Fig. 13: the H-value against the shortest segment").is_none());
}

#[test]
fn the_panel_for_figures_saves_what_it_says_and_a_bad_place_is_told() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(example(), &folder.path().join("runs"));
    apply(&mut harness, Command::Go(Goal::Step(100)));
    apply(&mut harness, Command::Figures);
    harness.get_by_label("grey").click();
    harness.get_by_label("nodes in the figure").click();
    harness.run_steps(2);
    let stem = folder.path().join("mine");
    type_over(&mut harness, "Name of the figure", &stem.display().to_string());
    type_over(&mut harness, "Size of the figure", "60mm");
    harness.get_by_label("Save SVG and PNG").click();
    until(&mut harness, "the figure is there", |_| stem.with_extension("png").is_file());
    let render = |from: &Path, to: &Path, options: &[&str]| {
        let mut process = Process::new(env!("CARGO_BIN_EXE_quadfront"));
        assert!(process.arg("render").arg(from).args(options).args(["-q", "-o"]).arg(to).status().unwrap().success());
        std::fs::read(to).unwrap()
    };
    let again = folder.path().join("again.svg");
    let svg = std::fs::read(stem.with_extension("svg")).unwrap();
    assert!(render(&stem.with_extension("png"), &again, &[]) == svg, "the command line draws the same");
    harness.get_by_label("Save PDF").click();
    until(&mut harness, "the PDF is there", |_| stem.with_extension("pdf").is_file());
    assert!(render(&stem.with_extension("pdf"), &again, &[]) == svg, "and of the PDF");
    let options = ["--at", "step=100", "--ink", "grey", "--size", "60mm"];
    let plain = render(Path::new("example1"), &again, &options);
    assert_ne!(plain.len(), svg.len(), "the nodes are missing there");
    type_over(&mut harness, "Name of the figure", &folder.path().join("no/where").display().to_string());
    // The name may take another line, which moves the buttons.
    harness.run_steps(4);
    harness.get_by_label("Save SVG").click();
    until(&mut harness, "a fault is shown", |harness| !harness.state().state.view().faults.is_empty());
    assert!(
        harness.state().state.view().faults[0].contains("does not exist"),
        "{:?}",
        harness.state().state.view().faults
    );
}
