//! Promise: looking at a run changes nothing, and what the command line can set can be set in the window, with the same
//! bytes.
//!
//! Needs a graphics adapter (see `window_harness`).
#![allow(clippy::unwrap_used)]

mod window_harness;
#[path = "common/random_parameters.rs"]
mod random_parameters;
#[path = "common/xor_shift.rs"]
mod xor_shift;

use std::path::{Path, PathBuf};
use std::process::Command as Process;

use eframe::egui::Key;
use egui_kittest::kittest::Queryable;
use quadfront::app::window::{App, Command, Goal, Overrides, Rules, Source};
use quadfront::core::case::{ParameterKind, Parameters, built_in};
use window_harness::{LAPTOP, Window, apply, has_adapter, settle, start, type_over, until};
use xor_shift::XorShift;

/// The groups of the panel that are closed at first.
const CLOSED: [&str; 5] = ["Sides and top", "Around each quad", "Seams and splits", "End", "Of the case"];

/// The window on a case, with all parameters in sight.
fn window(source: Source, overrides: Overrides) -> Option<Window> {
    if !has_adapter() {
        return None;
    }
    let mut harness = start(LAPTOP, |cc| App::new(cc, None));
    apply(&mut harness, Command::OpenWith(source, Box::new(overrides)));
    for group in CLOSED {
        harness.get_by_label(group).click_accesskit();
        harness.run_steps(12);
    }
    Some(harness)
}

fn built_in_case(name: &str) -> Source {
    Source::BuiltIn(name.to_owned())
}

fn set(set: &[(&str, &str)]) -> Overrides {
    Overrides {
        set: set.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect(),
        ..Overrides::default()
    }
}

fn paper() -> Overrides {
    Overrides { paper: true, ..Overrides::default() }
}

fn now(harness: &Window) -> Parameters {
    harness.state().state.run().moment.as_ref().unwrap().parameters.clone()
}

fn edits(harness: &Window) -> usize {
    harness.state().state.document().edits.len()
}

/// The mesh at the end of the window's run, as a file.
fn saved(harness: &mut Window, path: &Path) -> Vec<u8> {
    apply(harness, Command::Go(Goal::End));
    harness.state_mut().apply(Command::SaveMeshAs(path.display().to_string()));
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    until(harness, "the mesh is saved", |harness| {
        harness.state().state.view().notice().is_some_and(|notice| notice.0.contains(&name))
    });
    std::fs::read(path).unwrap()
}

/// The mesh that the command line makes of a case.
fn converted(name: &str, arguments: &[String], path: &PathBuf) -> Vec<u8> {
    let program = Process::new(env!("CARGO_BIN_EXE_quadfront"))
        .args(["convert", name, "--quiet", "-o"])
        .arg(path)
        .args(arguments)
        .output()
        .unwrap();
    assert!(program.status.success(), "{}", String::from_utf8_lossy(&program.stderr));
    std::fs::read(path).unwrap()
}

/// Parameters of a case by chance; those of its background mesh stay, so that it can be made soon.
fn by_chance(name: &str, random: &mut XorShift) -> (Parameters, Overrides) {
    let mut parameters = built_in::named(name).unwrap().unwrap().parameters;
    let drawn = random_parameters::draw(&mut parameters, &["size_scale", "max_quads"], random);
    let set = drawn.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
    (parameters, Overrides { set, ..Overrides::default() })
}

#[test]
fn nothing_is_edited_by_looking_at_any_case_with_any_parameters() {
    let Some(mut harness) = window(built_in_case("figure-19"), Overrides::default()) else { return };
    let mut random = XorShift::of(15);
    let names = built_in::all().map(|case| case.0).chain(["figure-19", "figure-16", "figure-8"]);
    for (k, name) in names.enumerate() {
        let own = built_in::named(name).unwrap().unwrap().parameters;
        let (parameters, overrides) = match k % 3 {
            2 => (own, Overrides::default()),
            _ => by_chance(name, &mut random),
        };
        let number = harness.state().state.run().number;
        harness.state_mut().apply(Command::OpenWith(built_in_case(name), Box::new(overrides)));
        until(&mut harness, "it is open", |harness| {
            let run = harness.state().state.run();
            run.number > number && run.moment.is_some()
        });
        harness.run_steps(3);
        assert_eq!(edits(&harness), 0, "{name}");
        assert_eq!(now(&harness), parameters, "{name}");
        let run = harness.state().state.current_run().unwrap();
        assert_eq!((&run.parameters, run.edits().len()), (&parameters, 0), "{name}");
    }
}

#[test]
fn a_field_that_is_left_as_it_stands_keeps_its_value() {
    let (parameters, overrides) = by_chance("figure-19", &mut XorShift::of(3));
    let Some(mut harness) = window(built_in_case("figure-19"), overrides) else { return };
    for key in Parameters::KEYS {
        let is_typed = Parameters::kind_of(key).is_some_and(|kind| kind.limits().is_some());
        if !is_typed || key == "size_scale" || key == "max_quads" {
            continue;
        }
        for leave in [Key::Enter, Key::Tab, Key::Escape] {
            harness.get_by_label(key).focus();
            harness.run_steps(2);
            harness.key_press(leave);
            harness.run_steps(2);
        }
        assert_eq!(edits(&harness), 0, "{key}");
    }
    assert_eq!(now(&harness), parameters);
}

#[test]
fn a_run_of_the_window_has_the_bytes_of_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = XorShift::of(8);
    for (k, name) in ["figure-19", "figure-19", "two-faces", "figure-16"].into_iter().enumerate() {
        let overrides = if k == 0 { Overrides::default() } else { by_chance(name, &mut random).1 };
        let arguments: Vec<String> = overrides.set.iter().map(|(key, value)| format!("--set={key}={value}")).collect();
        let [ours, theirs] = ["window", "line"].map(|who| folder.path().join(format!("{who}-{k}.msh")));
        let Some(mut harness) = window(built_in_case(name), overrides) else { return };
        assert_eq!(saved(&mut harness, &ours), converted(name, &arguments, &theirs), "{name}");
        assert_eq!(edits(&harness), 0);
    }
}

#[test]
fn the_paper_s_parameters_are_an_option_and_a_button() {
    let folder = tempfile::tempdir().unwrap();
    let theirs = converted("example1", &["--paper".to_owned()], &folder.path().join("theirs.msh"));
    let Some(mut harness) = window(built_in_case("example1"), paper()) else { return };
    assert_eq!((edits(&harness), now(&harness)), (0, Parameters::default().read_as_paper()));
    assert_eq!(saved(&mut harness, &folder.path().join("option.msh")), theirs);
    apply(&mut harness, Command::Reopen);
    assert_eq!(now(&harness), Parameters::paper(), "opened again as it was opened");
    apply(&mut harness, Command::Open(built_in_case("example1")));
    assert_eq!(now(&harness), Parameters::default());
    harness.get_by_label("Paper").click();
    settle(&mut harness);
    assert_eq!(now(&harness), Parameters::paper());
    assert_eq!(saved(&mut harness, &folder.path().join("button.msh")), theirs);
    apply(&mut harness, Command::Go(Goal::Step(0)));
    harness.get_by_label("Default").click();
    settle(&mut harness);
    assert_eq!(now(&harness), Parameters::default());
    apply(&mut harness, Command::Undo);
    assert_eq!(now(&harness), Parameters::paper(), "one change");
    apply(&mut harness, Command::SetRules(Rules::Paper));
    assert!(harness.state().state.view().notice().unwrap().0.contains("already"));
}

#[test]
fn every_parameter_has_a_widget() {
    let Some(harness) = window(built_in_case("figure-19"), Overrides::default()) else { return };
    for key in Parameters::KEYS {
        assert!(harness.query_by_label(key).is_some(), "{key}");
    }
}

#[test]
fn what_is_typed_is_set_with_all_its_digits_or_refused_with_the_words_of_the_command_line() {
    let Some(mut harness) = window(built_in_case("figure-19"), Overrides::default()) else { return };
    for (key, value) in [("theta_rect", "123.456789"), ("side_split", "7.125"), ("eps2", "250"), ("eps1", "0.0625")] {
        type_over(&mut harness, key, value);
        settle(&mut harness);
        assert_eq!(now(&harness).text_of(key).as_deref(), Some(value));
    }
    type_over(&mut harness, "c", "1100");
    settle(&mut harness);
    let said = harness.state().state.view().faults.clone();
    assert_eq!(said, [Parameters::default().set("c", "1100").unwrap_err().to_string()]);
    assert_eq!(now(&harness).text_of("c").as_deref(), Some("2"));
    // What is no number is refused in words too.
    type_over(&mut harness, "theta_rect", "abc");
    settle(&mut harness);
    let said = harness.state().state.view().faults.last().cloned();
    assert_eq!(said, Some(Parameters::default().set("theta_rect", "abc").unwrap_err().to_string()));
    assert_eq!(now(&harness).text_of("theta_rect").as_deref(), Some("123.456789"));
    for key in Parameters::KEYS {
        let kind = Parameters::kind_of(key).unwrap();
        let before = now(&harness).text_of(key).unwrap();
        if kind == ParameterKind::Flag {
            harness.get_by_label(key).click_accesskit();
            settle(&mut harness);
            assert_ne!(now(&harness).text_of(key), Some(before), "{key}");
        }
    }
}

#[test]
fn what_belongs_to_the_case_is_set_by_opening_it_again() {
    let folder = tempfile::tempdir().unwrap();
    let Some(mut harness) = window(built_in_case("two-faces"), set(&[("c", "1.75")])) else { return };
    type_over(&mut harness, "size_scale", "2");
    until(&mut harness, "it is opened again", |harness| harness.state().state.run().number == 2);
    settle(&mut harness);
    assert_eq!((edits(&harness), now(&harness).size_scale, now(&harness).c), (0, 2.0, 1.75));
    let ours = saved(&mut harness, &folder.path().join("ours.msh"));
    let arguments = ["--set=size_scale=2", "--set=c=1.75"].map(str::to_owned);
    assert_eq!(ours, converted("two-faces", &arguments, &folder.path().join("theirs.msh")));
    type_over(&mut harness, "max_quads", "0");
    harness.run_steps(2);
    assert!(harness.state().state.view().faults[0].contains("max_quads = 0"));
    assert_eq!(harness.state().state.run().number, 2);
}
