//! Promise: the window makes the film that the command line makes, while one goes on working, and stops it at a click.
//!
//! Needs a graphics adapter (see `window_harness`).
#![allow(clippy::unwrap_used)]

mod window_harness;

use std::path::Path;
use std::process::Command as Process;

use egui_kittest::kittest::Queryable;
use quadfront::app::window::{App, Command, Goal, Source};
use window_harness::{LAPTOP, Window, apply, has_adapter, settle, start, type_over, until};

/// The window on a case, with the panel for figures, which shows a film that is saved under `stem`.
fn window(case: &str, stem: &Path) -> Option<Window> {
    if !has_adapter() {
        return None;
    }
    let mut window = start(LAPTOP, |cc| App::new(cc, Some(Source::BuiltIn(case.to_owned()))));
    settle(&mut window);
    apply(&mut window, Command::Figures);
    window.get_by_label("What the figure shows").click();
    window.run_steps(2);
    window.get_by_label("the conversion, as a film").click();
    window.run_steps(2);
    type_over(&mut window, "Name of the figure", &stem.display().to_string());
    Some(window)
}

fn is_running(window: &Window) -> bool {
    window.state().state.film().is_some_and(|film| film.is_running())
}

fn made(words: &[&str], name: &Path) -> Vec<u8> {
    let status = Process::new(env!("CARGO_BIN_EXE_quadfront")).args(words).arg("-o").arg(name).status().unwrap();
    assert!(status.success(), "{words:?}");
    std::fs::read(name).unwrap()
}

#[test]
fn a_film_from_the_window_is_the_one_of_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let Some(mut window) = window("figure-14", &folder.path().join("film")) else { return };
    type_over(&mut window, "First frame", "step=1");
    type_over(&mut window, "Last frame", "step=7");
    type_over(&mut window, "From frame to frame", "step=2");
    type_over(&mut window, "Size of the figure", "420x380");
    window.get_by_label("follows the decision").click();
    window.get_by_label("dark").click();
    window.get_by_label("once").click();
    window.run_steps(2);
    window.get_by_label("Save the film as animated PNG").click();
    window.run_steps(2);
    until(&mut window, "the film is saved", |window| !is_running(window));
    let film = std::fs::read(folder.path().join("film.apng")).unwrap();
    assert!(window.query_all_by_label_contains("4 frames of 420 x 380 pixels").next().is_some());
    let words = ["animate", "figure-14", "-q", "--from", "step=1", "--to", "step=7", "--every", "step=2"];
    let look = ["--size", "420x380", "--camera", "follow", "--ink", "dark", "--captions", "--loop", "once"];
    assert!(film == made(&[&words[..], &look].concat(), &folder.path().join("other.apng")));
    // A GIF of the same, under a name that is free; an APNG is not written over.
    for (button, file) in [("Save the film as GIF", "film.gif"), ("Save the film as animated PNG", "film-2.apng")] {
        window.get_by_label(button).click();
        window.run_steps(2);
        until(&mut window, "the film is saved", |window| !is_running(window));
        assert!(folder.path().join(file).exists(), "{file}");
    }
    assert!(std::fs::read(folder.path().join("film-2.apng")).unwrap() == film);
}

#[test]
fn a_film_is_stopped_at_a_click_and_leaves_nothing_while_one_goes_on_working() {
    let folder = tempfile::tempdir().unwrap();
    let Some(mut window) = window("example1", &folder.path().join("film")) else { return };
    type_over(&mut window, "From frame to frame", "event");
    type_over(&mut window, "Size of the figure", "900x900");
    window.get_by_label("Save the film as GIF").click();
    window.run_steps(2);
    until(&mut window, "frames are drawn", |window| window.query_by_label_contains("Frame ").is_some());
    window.state_mut().apply(Command::Go(Goal::Steps(3)));
    until(&mut window, "the step is there", |window| {
        window.state().state.run().moment.as_ref().is_some_and(|moment| moment.step == 3)
    });
    assert!(is_running(&window));
    window.get_by_label("Stop the film").click();
    window.run_steps(2);
    assert!(!is_running(&window));
    assert!(window.query_by_label_contains("no film was saved").is_some());
    // The thread ends after the frames under way.
    until(&mut window, "nothing is left", |_| std::fs::read_dir(folder.path()).unwrap().count() == 0);
}

#[test]
fn what_cannot_be_a_film_is_said_beside_the_form() {
    let folder = tempfile::tempdir().unwrap();
    let Some(mut window) = window("figure-14", &folder.path().join("film")) else { return };
    type_over(&mut window, "From frame to frame", "often");
    assert!(window.query_by_label_contains("quad or event").is_some());
    assert!(window.query_by_label("Save the film as GIF").is_none());
    type_over(&mut window, "From frame to frame", "quad");
    type_over(&mut window, "First frame", "nq=77");
    window.get_by_label("Save the film as GIF").click();
    window.run_steps(2);
    until(&mut window, "it has failed", |window| !is_running(window));
    let faults = &window.state().state.view().faults;
    assert!(faults.iter().any(|fault| fault.contains("before the stop")), "{faults:?}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
