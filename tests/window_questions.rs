//! Promises. Three keys lead to the decision that made the worst quadrilateral, and the list of commands leads where
//! the panels do. A fork shows what would change: where two runs differ first, why, and what both end with; their
//! steps and cameras are linked, and what is changed is the run that the panels show. A bookmark takes a note while
//! one types; the note is kept in the run and undone as one change, and all of them are exported as one page.
//!
//! Needs a graphics adapter (see `window_harness`).
#![allow(clippy::unwrap_used)]

mod window_harness;

use std::path::Path;
use std::process::Command as Process;

use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};
use quadfront::app::window::{App, Arrangement, Command, Direction, Goal, LinkedBy, PairCommand, Source, Which};
use quadfront::core::convert::EventKind;
use quadfront::core::mesh::{Mesh, NodeId};
use quadfront::core::run::compare::Difference;
use quadfront::core::run::explain::{self, plain};
use quadfront::render::scene::Outlined;
use window_harness::{LAPTOP, Window, apply, has_adapter, settle, start, type_over, until};

/// The window on example 1.
fn window() -> Option<Window> {
    if !has_adapter() {
        return None;
    }
    let mut harness = start(LAPTOP, |cc| App::new(cc, None));
    apply(&mut harness, Command::Open(Source::BuiltIn("example1".to_owned())));
    Some(harness)
}

/// Runs frames until both runs have answered everything and are recorded.
fn both_settle(harness: &mut Window) {
    settle(harness);
    until(harness, "both runs are recorded", |harness| {
        Which::ALL.into_iter().all(|which| {
            let run = harness.state().state.of(which).run();
            run.moment.is_some() && !run.is_busy() && run.recorded
        })
    });
}

fn pair(harness: &mut Window, command: PairCommand) {
    apply(harness, Command::Pair(command));
    both_settle(harness);
}

fn fork(harness: &mut Window) {
    harness.key_press_modifiers(Modifiers::COMMAND, Key::K);
    harness.run_steps(2);
    both_settle(harness);
}

fn steps(harness: &Window) -> [u64; 2] {
    Which::ALL.map(|which| harness.state().state.of(which).run().moment.as_ref().unwrap().step)
}

fn go(harness: &mut Window, goal: Goal) {
    harness.state_mut().apply(Command::Go(goal));
    both_settle(harness);
}

fn compared(harness: &mut Window) {
    until(harness, "the runs are compared", |harness| {
        harness
            .state()
            .state
            .pair()
            .is_some_and(|pair| pair.comparison.as_ref().is_some_and(|found| found.differences.is_some()))
    });
}

/// The events of a conversion by the command line, a line each, without what depends on c by itself.
fn events(folder: &Path, set: &str) -> Vec<serde_json::Value> {
    let (events, mesh) = (folder.join("events.jsonl"), folder.join("mesh.vtu"));
    let mut program = Process::new(env!("CARGO_BIN_EXE_quadfront"));
    program.args(["convert", "example1", "--quiet", "--set", set]);
    let done = program.arg("-o").arg(&mesh).arg("--events").arg(&events).output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let lines = std::fs::read_to_string(&events).unwrap();
    let lines = lines.lines().map(|line| {
        let mut event: serde_json::Value = serde_json::from_str(line).unwrap();
        // The reach is c times a number; the text says it too.
        for key in ["reach", "text"] {
            event.as_object_mut().unwrap().remove(key);
        }
        event
    });
    lines.collect()
}

#[test]
fn a_fork_with_another_c_differs_first_where_the_event_files_do() {
    let Some(mut harness) = window() else { return };
    fork(&mut harness);
    harness.get_by_label("No difference yet");
    type_over(&mut harness, "c", "1.5");
    both_settle(&mut harness);
    compared(&mut harness);
    let folder = tempfile::tempdir().unwrap();
    let files = [events(folder.path(), "c=2"), events(folder.path(), "c=1.5")];
    let differ = files[0].iter().zip(&files[1]).position(|(a, b)| a != b).unwrap() as u64 + 1;
    assert_eq!(harness.state().state.pair().unwrap().first_difference(), Some(differ));
    harness.get_by_label(&format!("First difference: step {differ}"));
    harness.get_by_label("Go there").click();
    harness.run_steps(3);
    both_settle(&mut harness);
    assert_eq!(steps(&harness), [differ; 2]);
    // Both reasons are there, in full, and the table of ends has what the command line reports.
    for name in ["A: base selected", "B: base selected"] {
        assert!(harness.query_all_by_label_contains(name).count() > 0, "{name}");
    }
    let reports = harness.state().state.pair().unwrap().comparison.as_ref().unwrap().reports.as_ref().unwrap();
    for (report, set) in reports.iter().zip(["c=2", "c=1.5"]) {
        let mut program = Process::new(env!("CARGO_BIN_EXE_quadfront"));
        let file = folder.path().join("report.json");
        let done =
            program.args(["convert", "example1", "--quiet", "--set", set, "--report"]).arg(&file).output().unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let json: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
        assert_eq!(json["mesh"], serde_json::to_value(&report.mesh).unwrap(), "{set}");
    }
    // A has not been changed.
    assert!(harness.state().state.document().edits.is_empty());
    assert_eq!(harness.state().state.of(Which::B).document().edits.len(), 1);
}

#[test]
fn two_runs_are_drawn_anew_only_when_something_changes() {
    let Some(mut harness) = window() else { return };
    fork(&mut harness);
    let view = harness.query_all_by_label_contains("Mesh at step").next().unwrap().rect();
    // Beside the hole in the middle.
    harness.hover_at(view.min + 0.25 * view.size());
    harness.run_steps(8);
    assert!(harness.state().state.frame().hovered.is_some(), "the pointer is on the mesh");
    let wanted = harness.output().viewport_output.values().map(|viewport| viewport.repaint_delay).min();
    assert!(wanted.is_some_and(|delay| delay > std::time::Duration::from_millis(100)), "{wanted:?}");
}

#[test]
fn the_runs_go_together_by_step_by_quadrilateral_and_by_phase() {
    let Some(mut harness) = window() else { return };
    fork(&mut harness);
    type_over(&mut harness, "c", "1.5");
    both_settle(&mut harness);
    for goal in [Goal::Quads(10), Goal::Step(620), Goal::Steps(-3)] {
        go(&mut harness, goal);
        let [a, b] = steps(&harness);
        assert_eq!(a, b, "{goal:?}");
    }
    go(&mut harness, Goal::End);
    let ends = Which::ALL.map(|which| harness.state().state.of(which).run().track.len() as u64);
    assert_eq!(steps(&harness), [ends[0].min(ends[1]), ends[1]], "each run ends where it ends");
    assert_ne!(ends[0], ends[1]);
    pair(&mut harness, PairCommand::Link(LinkedBy::Quad));
    go(&mut harness, Goal::Step(1500));
    let standing = |harness: &Window, which| {
        let state = &harness.state().state;
        state.of(which).run().moment.as_ref().unwrap().standing
    };
    assert_eq!(standing(&harness, Which::A), standing(&harness, Which::B));
    assert_ne!(steps(&harness)[0], steps(&harness)[1]);
    pair(&mut harness, PairCommand::Link(LinkedBy::Event));
    go(&mut harness, Goal::Kind(EventKind::Seamed, Direction::Back));
    let number = |which: Which| {
        let run = harness.state().state.of(which).run();
        let step = run.moment.as_ref().unwrap().step as usize;
        assert_eq!(run.track[step - 1].kind, EventKind::Seamed);
        run.track[..step].iter().filter(|tracked| tracked.kind == EventKind::Seamed).count()
    };
    assert_eq!(number(Which::A), number(Which::B));
    // By themselves: A stays.
    pair(&mut harness, PairCommand::Link(LinkedBy::Free));
    let before = steps(&harness);
    go(&mut harness, Goal::Steps(-40));
    assert_eq!(steps(&harness), [before[0], before[1] - 40]);
    // With A in the panels, A moves.
    harness.get_by_label("Run A").click_accesskit();
    harness.run_steps(2);
    assert_eq!(harness.state().state.active_run(), Which::A);
    go(&mut harness, Goal::Step(9));
    assert_eq!(steps(&harness), [9, before[1] - 40]);
}

/// The decisions in which the two runs differ although their fronts are the same there.
fn differences(harness: &Window) -> Vec<Difference> {
    harness.state().state.pair().unwrap().comparison.clone().unwrap().differences.unwrap()
}

#[test]
fn the_chain_of_a_quadrilateral_of_the_second_run_brings_the_inspector_to_the_front() {
    let Some(mut harness) = window() else { return };
    go(&mut harness, Goal::End);
    fork(&mut harness);
    assert_eq!(harness.state().state.active_run(), Which::B);
    assert!(harness.query_by_label("Decision chain").is_none(), "the inspector is behind another panel");
    let worst = harness.state().state.of(Which::B).run().moment.as_ref().unwrap().worst.unwrap().0;
    apply(&mut harness, Command::ShowChain(worst));
    until(&mut harness, "the chain is told", |harness| {
        harness.query_all_by_label_contains("Chain, step ").next().is_some()
    });
    let picked = Which::ALL.map(|which| harness.state().state.of(which).document().picked);
    assert_eq!(picked, [None, Some(Outlined::Element(worst))]);
}

/// The panel with the two runs at a difference: both stand at its steps, and what each did there is told.
fn stands_at_difference(harness: &mut Window, place: usize) {
    both_settle(harness);
    until(harness, "the difference is told", |harness| {
        let shown = harness.state().state.pair().unwrap().shown.as_ref();
        shown.is_some_and(|shown| shown.place == place && shown.did.is_some())
    });
    let differences = differences(harness);
    let difference = &differences[place];
    assert_eq!(steps(harness), difference.steps);
    let count = differences.len();
    harness.get_by_label(&format!("Difference {} of {count}", place + 1));
    for (k, which) in Which::ALL.into_iter().enumerate() {
        let state = harness.state().state.of(which);
        assert_eq!(state.document().picked, Some(Outlined::Edge(difference.bases[k])), "it is selected in {which:?}");
        let event = state.run().moment.as_ref().unwrap().event.unwrap();
        let told = plain(&explain::event(&event));
        harness.get_by_label(&format!("{}: {told}", which.name()));
    }
}

#[test]
fn further_differences_are_stepped_through_with_both_reasons_and_then_the_runs_are_linked_again() {
    let Some(mut harness) = window() else { return };
    fork(&mut harness);
    apply(&mut harness, Command::Set("placement", "false".to_owned()));
    both_settle(&mut harness);
    compared(&mut harness);
    let all = differences(&harness);
    assert!(all.len() > 5, "{}", all.len());
    harness.get_by_label("Go there").click();
    harness.run_steps(3);
    both_settle(&mut harness);
    let first = steps(&harness)[0];
    let next = all.iter().position(|difference| difference.steps[0] > first).unwrap();
    harness.get_by_label("Next difference").click();
    harness.run_steps(3);
    stands_at_difference(&mut harness, next);
    // The keys do the same; each press counts, whether or not the runs have arrived.
    harness.key_press(Key::F8);
    harness.key_press(Key::F8);
    harness.run_steps(3);
    stands_at_difference(&mut harness, next + 2);
    harness.key_press_modifiers(Modifiers::ALT, Key::F8);
    harness.run_steps(3);
    stands_at_difference(&mut harness, next + 1);
    // Which run the panels show makes no difference; a step moves on from there, linked as before.
    pair(&mut harness, PairCommand::Switch);
    assert_eq!(steps(&harness), all[next + 1].steps);
    pair(&mut harness, PairCommand::Switch);
    go(&mut harness, Goal::Steps(1));
    assert_eq!(steps(&harness), [all[next + 1].steps[1] + 1; 2]);
    // Beyond the last one there is none.
    go(&mut harness, Goal::End);
    harness.state_mut().apply(Command::Pair(PairCommand::SeekDifference(Direction::Forward)));
    assert!(harness.state().state.view().notice().unwrap().0.starts_with("No decision after this one"));
    harness.get_by_label("First difference").click();
    harness.run_steps(3);
    both_settle(&mut harness);
    assert_eq!(steps(&harness), [first; 2]);
    harness.get_by_label(&format!("First difference: step {first}"));
}

/// How many quadrilaterals of a mesh have a partner in another one: each corner within a tenth of a unit length in the
/// metric of the corner, one to one.
fn with_partners(mesh: &Mesh, other: &Mesh) -> usize {
    let quads = |mesh: &Mesh| -> Vec<Vec<NodeId>> {
        mesh.elements().filter(|e| mesh.is_quad(*e)).map(|e| mesh.corners(e).collect()).collect()
    };
    let is_near = |a: NodeId, b: NodeId| {
        let (d, m) = (mesh.uv(a) - other.uv(b), mesh.metric(a));
        m.uu * d.x * d.x + 2.0 * m.uv * d.x * d.y + m.vv * d.y * d.y <= 0.01
    };
    let others = quads(other);
    let has_partner = |quad: &Vec<NodeId>| {
        others.iter().any(|other| {
            other.iter().all(|b| quad.iter().any(|a| is_near(*a, *b)))
                && quad.iter().all(|a| other.iter().any(|b| is_near(*a, *b)))
        })
    };
    quads(mesh).iter().filter(|quad| has_partner(quad)).count()
}

#[test]
fn what_only_one_run_has_is_counted_and_the_cameras_are_one() {
    let Some(mut harness) = window() else { return };
    apply(&mut harness, Command::Go(Goal::Step(100)));
    fork(&mut harness);
    assert_eq!(steps(&harness), [100; 2]);
    type_over(&mut harness, "c", "1.5");
    both_settle(&mut harness);
    go(&mut harness, Goal::Step(900));
    harness.run_steps(3);
    let state = &harness.state().state;
    let [a, b] = Which::ALL.map(|which| state.of(which).run().moment.clone().unwrap());
    let overlap = state.pair().unwrap().overlap.clone().unwrap();
    let both = with_partners(&a.mesh, &b.mesh);
    assert!(both > 30 && both < a.standing as usize, "{both} of {}", a.standing);
    let only = [a.standing, b.standing].map(|standing| standing as usize - both);
    assert_eq!((overlap.both, overlap.only.each_ref().map(Vec::len)), (both, only));
    drop((a, b));
    for arrangement in Arrangement::ALL {
        pair(&mut harness, PairCommand::Show(arrangement));
        harness.state_mut().apply(Command::Show(Outlined::Element(overlap.only[1][0])));
        harness.run_steps(4);
        let cameras = Which::ALL.map(|which| harness.state().state.of(which).view().plane.camera.unwrap());
        assert_eq!(cameras[0], cameras[1], "{arrangement:?}");
    }
}

#[test]
fn a_second_run_that_is_closed_unsaved_is_offered_and_runs_can_be_exchanged() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let runs = folder.path().to_path_buf();
    let mut harness = start(LAPTOP, move |cc| App::new(cc, None).keeping(Some(runs)));
    apply(&mut harness, Command::Open(Source::BuiltIn("figure-19".to_owned())));
    harness.state_mut().apply(Command::Pair(PairCommand::Switch));
    assert!(harness.state().state.view().notice().unwrap().0.contains("needs two runs"));
    fork(&mut harness);
    apply(&mut harness, Command::Set("c", "1.25".to_owned()));
    both_settle(&mut harness);
    pair(&mut harness, PairCommand::Exchange);
    assert_eq!(harness.state().state.document().edits.len(), 1, "what was B is A now");
    assert!(harness.state().state.of(Which::B).document().edits.is_empty());
    assert_eq!(harness.state().state.active_run(), Which::A);
    // What can be undone belongs to each run.
    apply(&mut harness, Command::Undo);
    both_settle(&mut harness);
    let edits = |harness: &Window| Which::ALL.map(|which| harness.state().state.of(which).document().edits.len());
    assert_eq!(edits(&harness), [0, 0]);
    apply(&mut harness, Command::Redo);
    both_settle(&mut harness);
    assert_eq!(edits(&harness), [1, 0]);
    harness.get_by_label("A was forked from B at step 0.");
    pair(&mut harness, PairCommand::Exchange);
    harness.get_by_label("B was forked from A at step 0.");
    assert_eq!(edits(&harness), [0, 1]);
    // What stands above the button changes in between, since the comparison goes on or ends: the click counts all the
    // same.
    harness.get_by_label("Close the second run").click_accesskit();
    harness.run_steps(2);
    assert!(harness.state().state.pair().is_none());
    until(&mut harness, "the run is offered", |harness| {
        harness.query_all_by_label_contains("An unsaved run of figure-19 with 1 edit").count() > 0
    });
    // A case that is opened beside another one is compared with it; one that does not exist changes nothing.
    let beside = |name: &str| PairCommand::OpenBeside(Source::BuiltIn(name.to_owned()), Box::default());
    pair(&mut harness, beside("figure-16"));
    compared(&mut harness);
    harness.get_by_label("First difference: step 0");
    harness.state_mut().apply(Command::Pair(beside("no-such-case")));
    until(&mut harness, "it is refused", |harness| harness.state().state.pair().is_none());
    assert!(harness.state().state.view().faults.iter().any(|fault| fault.contains("no-such-case")));
}

#[test]
fn a_bookmark_takes_a_note_and_the_notes_become_a_page() {
    if !has_adapter() {
        return;
    }
    let mut harness = start(LAPTOP, |cc| App::new(cc, None));
    apply(&mut harness, Command::Open(Source::BuiltIn("figure-19".to_owned())));
    harness.state_mut().apply(Command::ExportNotes);
    assert!(harness.state().state.view().faults[0].contains("There are no bookmarks"));
    for step in [7, 3] {
        apply(&mut harness, Command::Go(Goal::Step(step)));
        harness.key_press_modifiers(Modifiers::COMMAND, Key::B);
        harness.run_steps(3);
    }
    let field = "Note on step 3";
    harness.get_by_label(field).focus();
    harness.run_steps(2);
    for text in ["why **this", " base**?"] {
        harness.get_by_label(field).type_text(text);
        harness.run_steps(2);
    }
    let notes = |harness: &Window| -> Vec<(u64, String)> {
        harness.state().state.current_run().unwrap().bookmarks.iter().map(|m| (m.step, m.note.clone())).collect()
    };
    assert_eq!(notes(&harness), [(3, "why **this base**?".to_owned()), (7, String::new())]);
    // Typing is one change; before it, the bookmark was set.
    harness.state_mut().apply(Command::Undo);
    assert_eq!(notes(&harness), [(3, String::new()), (7, String::new())]);
    harness.state_mut().apply(Command::Redo);
    harness.run_steps(2);
    harness.get_by_label("Export the notes as a page").click_accesskit();
    until(&mut harness, "the page is saved", |harness| {
        harness.state().state.view().notice().is_some_and(|notice| notice.0.contains("notes were saved as"))
    });
    let notice = harness.state().state.view().notice().unwrap().0.to_owned();
    let path = notice.trim_start_matches("The notes were saved as ").trim_end_matches('.').to_owned();
    let page = std::fs::read_to_string(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert!(page.contains("why <strong>this base</strong>?") && page.matches("data:image/svg+xml").count() == 2);
    // A click on a bookmark goes there; its cross removes it, and undo brings it back with its note.
    harness.get_by_label("Go to step 7").click_accesskit();
    harness.run_steps(2);
    settle(&mut harness);
    assert_eq!(harness.state().state.run().moment.as_ref().unwrap().step, 7);
    harness.get_by_label("Remove the bookmark of step 3").click_accesskit();
    harness.run_steps(2);
    assert_eq!(notes(&harness).len(), 1);
    harness.state_mut().apply(Command::Undo);
    assert_eq!(notes(&harness)[0].1, "why **this base**?");
}

#[test]
fn a_breakpoint_is_reduced_to_the_smallest_case_that_meets_it() {
    if !has_adapter() {
        return;
    }
    let mut harness = start(LAPTOP, |cc| App::new(cc, None));
    apply(&mut harness, Command::Open(Source::BuiltIn("gear".to_owned())));
    apply(&mut harness, Command::AddBreakpoint("kind == seamed".to_owned()));
    // A reduction that is stopped leaves the window as it is.
    harness.get_by_label("Reduce this: kind == seamed").click_accesskit();
    harness.run_steps(3);
    assert!(harness.state().state.reducing().unwrap().is_running());
    harness.get_by_label("Stop reducing").click_accesskit();
    harness.run_steps(3);
    let stopped = harness.state().state.reducing().unwrap();
    assert!(!stopped.is_running() && stopped.told.starts_with("Stopped"));
    let first = stopped.path.clone();
    harness.get_by_label("Reduce this: kind == seamed").click_accesskit();
    harness.run_steps(3);
    until(&mut harness, "it is reduced", |harness| harness.state().state.reducing().is_some_and(|done| done.is_done));
    let path = harness.state().state.reducing().unwrap().path.clone();
    let text = std::fs::read_to_string(&path).unwrap();
    let events = Process::new(env!("CARGO_BIN_EXE_quadfront"))
        .arg("convert")
        .arg(&path)
        .args(["--quiet", "--events", "-"])
        .output()
        .unwrap();
    let events = String::from_utf8(events.stdout).unwrap();
    harness.get_by_label_contains("gear-small").click_accesskit();
    harness.run_steps(3);
    settle(&mut harness);
    let name = harness.state().state.run().opened.as_ref().unwrap().run.case.name.clone();
    for path in [first, path] {
        // The first one may have been stopped before there was anything to write.
        let _ = std::fs::remove_file(path);
    }
    assert!(name.starts_with("gear-small"), "{name}");
    assert!(events.contains("\"seamed\""), "{text}");
    let corners = |text: &str| text.matches('[').count();
    let (_, original) = quadfront::core::case::built_in::all().find(|case| case.0 == "gear").unwrap();
    assert!(corners(&text) < corners(original) / 2, "{text}");
}

fn step(harness: &Window) -> u64 {
    harness.state().state.run().moment.as_ref().unwrap().step
}

/// Chooses the first command of the list that has these words.
fn choose(harness: &mut Window, words: &str) {
    harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
    harness.run_steps(2);
    harness.get_by_label("Name of a command").type_text(words);
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    harness.run_steps(2);
    settle(harness);
}

#[test]
fn three_keys_lead_to_the_guilty_step_also_in_one_frame() {
    let Some(mut harness) = window() else { return };
    harness.key_press(Key::End);
    harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::W);
    harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::G);
    let end = harness.state().state.run().track.len() as u64;
    until(&mut harness, "it is at another step than the last one", |harness| {
        let run = harness.state().state.run();
        !run.is_busy() && (1..end).contains(&run.moment.as_ref().unwrap().step)
    });
    let there = step(&harness);
    // The chain at the end says the same.
    apply(&mut harness, Command::Go(Goal::End));
    until(&mut harness, "the chain is known", |harness| {
        harness.query_by_label_contains("Largest loss: step").is_some()
    });
    let told = harness.get_by_label_contains("Largest loss: step").accesskit_node().label().unwrap();
    let digits: String = told.chars().filter(char::is_ascii_digit).collect();
    assert_eq!(digits, there.to_string());
    // Nothing is selected: it is said what to do.
    apply(&mut harness, Command::Pick(None));
    apply(&mut harness, Command::ToLargestLoss);
    assert!(harness.query_by_label_contains("Select a quadrilateral first").is_some());
}

#[test]
fn the_list_of_commands_takes_values_and_leads_where_the_panels_do() {
    let Some(mut harness) = window() else { return };
    apply(&mut harness, Command::Go(Goal::Step(40)));
    choose(&mut harness, "c = 1.5");
    assert_eq!(harness.state().state.document().edits.len(), 1);
    assert_eq!(harness.state().state.parameter("c").as_deref(), Some("1.5"));
    choose(&mut harness, "break where quad.min_angle < 40");
    assert_eq!(harness.state().state.document().breakpoints[0].condition, "quad.min_angle < 40");
    choose(&mut harness, "remove the breakpoint: quad.min");
    assert!(harness.state().state.document().breakpoints.is_empty());
    // A note is written where the keys lead, and the list leads back to its step.
    harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::B);
    harness.run_steps(3);
    assert!(harness.get_by_label("Note on step 40").accesskit_node().is_focused());
    harness.get_by_label("Note on step 40").type_text("Here");
    harness.run_steps(2);
    assert_eq!(harness.state().state.document().bookmarks[0].note, "Here");
    apply(&mut harness, Command::Go(Goal::Step(7)));
    choose(&mut harness, "bookmark of step 40");
    assert_eq!(step(&harness), 40);
    choose(&mut harness, "show the panel nodes");
    assert!(harness.query_by_label("Filter of nodes").is_some());
}
