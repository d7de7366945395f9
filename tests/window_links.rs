//! Promise: a link opens the state that it was copied from, in another window too: run, parameters, edits, step,
//! selection, view and lesson; and what of it is not there is said, what is wrong with it on the terminal.
//!
//! Needs a graphics adapter (see `window_harness`).
#![allow(clippy::unwrap_used)]

mod window_harness;

use std::time::Duration;

use eframe::egui::{Key, Modifiers, OutputCommand};
use egui_kittest::kittest::Queryable;
use quadfront::app::window::{App, Command, Goal, PairCommand, Source, StudyCommand, SurfaceView, Which};
use quadfront::core::mesh::{ElementId, NodeId};
use quadfront::core::record::link::Link;
use quadfront::core::run::shown::fingerprint;
use quadfront::core::run::{Camera, Edit, EditKind};
use quadfront::render::scene::Outlined;
use window_harness::{LAPTOP, Window, apply, has_adapter, settle, start, type_over, until};

/// The window on a case, at step 0.
fn window(name: &str) -> Window {
    let source = Source::BuiltIn(name.to_owned());
    let mut window = start(LAPTOP, |cc| App::new(cc, Some(source)));
    settle(&mut window);
    window
}

/// The link that is copied now.
fn copied(window: &mut Window) -> String {
    window.state_mut().apply(Command::CopyLink);
    for _ in 0..2_000 {
        window.run_steps(1);
        for command in &window.output().platform_output.commands {
            if let OutputCommand::CopyText(text) = command {
                return text.clone();
            }
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("nothing was copied: {:?}", faults(window));
}

fn press_l(window: &mut Window) {
    window.key_press_modifiers(Modifiers::COMMAND, Key::L);
    window.run_steps(2);
}

/// Another window on what a link names.
fn opened(link: &str) -> Window {
    let mut window = start(LAPTOP, |cc| App::new(cc, None));
    apply(&mut window, Command::OpenLink(link.to_owned()));
    window
}

fn step(window: &Window) -> u64 {
    window.state().state.run().moment.as_ref().unwrap().step
}

/// Where the main view looks, if it does not show the whole mesh.
fn view(window: &Window) -> Option<Camera> {
    window.state().state.current_run().unwrap().camera
}

fn faults(window: &Window) -> &[String] {
    &window.state().state.view().faults
}

/// Whether both windows show the same: the state bit for bit, what is selected, and what is seen as far as one sees it.
fn show_the_same(a: &Window, b: &Window) {
    let [one, other] = [a, b].map(|window| {
        let state = &window.state().state;
        let moment = state.run().moment.clone().unwrap();
        let run = state.current_run().unwrap();
        let edits = run.edits().to_vec();
        let print = fingerprint(&moment.mesh, &moment.phase);
        (moment.step, print, state.document().picked, run.parameters, edits, run.bookmarks)
    });
    assert_eq!(one, other);
    let views = [a, b].map(view);
    let [Some(one), Some(other)] = views else { return assert_eq!(views, [None, None]) };
    for (x, y) in one.target.iter().zip(other.target).chain([(&one.height, other.height)]) {
        assert!((x - y).abs() < 1e-4 * one.height, "{views:?}");
    }
    assert!(one.turn.iter().zip(other.turn).all(|(x, y)| (x - y).abs() < 1e-5), "{views:?}");
}

#[test]
fn a_link_opens_the_state_that_it_was_copied_from_in_another_window() {
    if !has_adapter() {
        return;
    }
    let mut window = window("example1");
    apply(&mut window, Command::Go(Goal::Step(220)));
    let segment = window.state().state.run().moment.as_ref().unwrap().front[3];
    let ends = [segment.a, segment.b];
    apply(&mut window, Command::Find(Outlined::Edge(ends)));
    apply(&mut window, Command::ShowDecision);
    press_l(&mut window);
    assert!(window.query_by_label_contains("The link was copied").is_some());
    let link = copied(&mut window);
    let select = format!("&step=220&select={}-{}&view=", ends[0].0, ends[1].0);
    assert!(link.starts_with("#case=example1&step=220") && link.contains(&select), "{link}");
    let other = opened(&link);
    show_the_same(&window, &other);
    assert_eq!(other.state().state.picked_segment(), Some(ends));
    assert!(view(&other).is_some() && faults(&other).is_empty());
    // What is opened by a link cannot be undone to less.
    let mut other = other;
    apply(&mut other, Command::Undo);
    show_the_same(&window, &other);

    // A change at a step and a bookmark go along, and so does the whole view.
    let theta = EditKind::parameter("theta_rect", "120").unwrap();
    apply(&mut window, Command::Set("theta_rect", "120".to_owned()));
    apply(&mut window, Command::NoteHere);
    apply(&mut window, Command::WriteNote(220, "the *sliver* & more".to_owned()));
    apply(&mut window, Command::Go(Goal::Step(300)));
    let node = window.state().state.run().moment.as_ref().unwrap().mesh.nodes().nth(40).unwrap();
    apply(&mut window, Command::Pick(Some(Outlined::Node(node))));
    apply(&mut window, Command::Fit);
    let link = copied(&mut window);
    assert!(link.starts_with("#run=") && link.contains(&format!("&step=300&select=node{}", node.0)), "{link}");
    let mut other = opened(&format!("https://example.org/quadfront/{link}"));
    show_the_same(&window, &other);
    let run = other.state().state.current_run().unwrap();
    assert_eq!(run.edits(), [Edit { step: 220, kind: theta }]);
    assert_eq!(run.bookmarks[0].note, "the *sliver* & more");
    // It is opened again as any run is.
    apply(&mut other, Command::Reopen);
    assert_eq!((step(&other), other.state().state.current_run().unwrap().edits()), (0, run.edits()));
}

#[test]
fn parameters_of_a_link_are_those_of_the_run_from_its_beginning() {
    if !has_adapter() {
        return;
    }
    let mut window = window("example1");
    apply(&mut window, Command::SetForCase("size_scale", "2".to_owned()));
    apply(&mut window, Command::SetForCase("c", "1.8".to_owned()));
    apply(&mut window, Command::Go(Goal::End));
    let e = window.state().state.run().moment.as_ref().unwrap().mesh.elements().nth(5).unwrap();
    apply(&mut window, Command::Pick(Some(Outlined::Element(e))));
    let link = copied(&mut window);
    let last = step(&window);
    assert_eq!(link, format!("#case=example1&size_scale=2&c=1.8&step={last}&select=element{}", e.0));
    let mut other = opened(&link);
    show_the_same(&window, &other);
    assert_eq!(view(&other), None);
    // Through the field for a path.
    other.key_press_modifiers(Modifiers::COMMAND, Key::O);
    other.run_steps(3);
    type_over(&mut other, "Path", "#case=figure-14&step=2&select=segment0-1");
    settle(&mut other);
    assert_eq!((step(&other), &*other.state().state.current_run().unwrap().case.name), (2, "figure-14"));
}

#[test]
fn a_view_of_space_or_of_the_plane_of_surfaces_is_opened_as_it_was() {
    if !has_adapter() {
        return;
    }
    let mut window = window("example5");
    apply(&mut window, Command::Go(Goal::Step(60)));
    apply(&mut window, Command::ShowDecision);
    let link = copied(&mut window);
    assert_eq!(link.split_once("&view=").unwrap().1.split(',').count(), 8, "{link}");
    let other = opened(&link);
    show_the_same(&window, &other);
    apply(&mut window, Command::SurfaceView(SurfaceView::Plane));
    apply(&mut window, Command::ShowDecision);
    let link = copied(&mut window);
    assert_eq!(link.split_once("&view=").unwrap().1.split(',').count(), 3, "{link}");
    let other = opened(&link);
    show_the_same(&window, &other);
    assert_eq!(other.state().state.workspace().surfaces.view, SurfaceView::Plane);
}

#[test]
fn a_lesson_is_opened_at_its_part_or_waits_behind_another_state() {
    if !has_adapter() {
        return;
    }
    let mut window = start(LAPTOP, |cc| App::new(cc, Some(Source::Lesson("figure-14".to_owned()))));
    let is_told = |window: &mut Window, part: usize| {
        until(window, "the part is told", |window| {
            let study = window.state().state.study();
            study.is_some_and(|study| study.taught.is_some() && study.lesson().is_some_and(|at| at.1 == part))
        });
        settle(window);
    };
    is_told(&mut window, 0);
    apply(&mut window, Command::Study(StudyCommand::Part(1)));
    is_told(&mut window, 1);
    let link = copied(&mut window);
    assert_eq!(link, "#lesson=figure-14&part=2");
    let mut other = opened(&link);
    is_told(&mut other, 1);
    assert!(other.state().state.shown_study().is_some());
    assert_eq!(step(&other), step(&window));

    // Left for a while, at another state.
    apply(&mut window, Command::Study(StudyCommand::Explore));
    apply(&mut window, Command::Go(Goal::Step(3)));
    // The camera gets where the lesson sent it.
    window.run_steps(160);
    let link = copied(&mut window);
    assert!(link.starts_with("#step=3") && link.ends_with("&lesson=figure-14&part=2"), "{link}");
    let mut other = opened(&link);
    show_the_same(&window, &other);
    assert!(other.state().state.shown_study().is_none());
    other.get_by_label("Back to the lesson").click();
    is_told(&mut other, 1);
    assert!(other.state().state.shown_study().is_some());

    // Beside another run it waits too, and opens its own.
    let link = "#case=example1&c=1.8&step=90&lesson=figure-14&part=2";
    let mut other = opened(link);
    assert_eq!((step(&other), other.state().state.shown_study().is_some()), (90, false));
    assert_eq!(copied(&mut other), link);
    other.get_by_label("Back to the lesson").click();
    is_told(&mut other, 1);
    assert_eq!(other.state().state.current_run().unwrap().case.name, "figure-14");
    assert!(other.state().state.shown_study().is_some() && faults(&other).is_empty());
    // A second run is closed first.
    apply(&mut other, Command::Study(StudyCommand::Leave));
    apply(&mut other, Command::Pair(PairCommand::Fork));
    apply(&mut other, Command::OpenLink("#lesson=figure-3".to_owned()));
    assert!(other.query_by_label_contains("close the second run first").is_some());
}

#[test]
fn what_of_a_link_is_not_there_is_said_and_what_is_open_stays() {
    if !has_adapter() {
        return;
    }
    let mut window = opened("#case=example1&size_scale=3&step=99999&select=node999999");
    let end = window.state().state.run().track.len() as u64;
    assert_eq!((step(&window), window.state().state.document().picked), (end, None));
    let told = faults(&window).join("\n");
    assert!(told.contains("before step 99\u{2009}999") && told.contains("Node 999999 does not exist"), "{told}");
    for (link, what) in [
        ("#case=example1&stp=3", "The nearest known one is \"step\""),
        ("#case=exampel1", "The nearest is \"example1\""),
        ("#case=example1&faces=nowhere", "nowhere"),
    ] {
        window.state_mut().apply(Command::OpenLink(link.to_owned()));
        until(&mut window, "it is refused", |window| faults(window).iter().any(|fault| fault.contains(what)));
        assert_eq!(step(&window), end);
    }
}

#[test]
fn a_link_is_of_the_run_that_the_panels_show_and_of_the_state_that_is_on_its_way() {
    if !has_adapter() {
        return;
    }
    let mut window = start(LAPTOP, |cc| App::new(cc, None));
    window.run_steps(2);
    press_l(&mut window);
    assert!(window.query_by_label_contains("nothing to link to").is_some());

    let mut window = self::window("example1");
    // The link is of the step that was asked for before.
    window.state_mut().apply(Command::Go(Goal::End));
    let link = copied(&mut window);
    let end = step(&window);
    assert!(link.contains(&format!("&step={end}")), "{link}");
    apply(&mut window, Command::Go(Goal::Step(40)));
    apply(&mut window, Command::Pair(PairCommand::Fork));
    until(&mut window, "both runs are open", |window| {
        window.state().state.of(Which::B).run().moment.as_ref().is_some_and(|moment| moment.step == 40)
    });
    let chosen = Command::Set("theta_rect", "110".to_owned());
    window.state_mut().apply(Command::Pair(PairCommand::In(Which::B, Box::new(chosen))));
    settle(&mut window);
    window.state_mut().apply(Command::Pair(PairCommand::Activate(Which::B)));
    settle(&mut window);
    assert!(copied(&mut window).starts_with("#run="));
    window.state_mut().apply(Command::Pair(PairCommand::Activate(Which::A)));
    settle(&mut window);
    let link = copied(&mut window);
    assert!(link.starts_with("#case=example1&step=40") && Link::parse(&link).is_ok(), "{link}");
}

#[test]
fn what_is_selected_but_gone_is_left_out() {
    if !has_adapter() {
        return;
    }
    let mut window = window("example1");
    let gone = [Outlined::Node(NodeId(999_999)), Outlined::Element(ElementId(999_999))];
    for gone in gone {
        apply(&mut window, Command::Pick(Some(gone)));
        assert_eq!(copied(&mut window), "#case=example1&step=0");
    }
}

#[test]
fn what_is_wrong_with_a_link_is_said_on_the_terminal_before_the_window_opens() {
    let open = |arguments: &[&str]| {
        let program = env!("CARGO_BIN_EXE_quadfront");
        let output = std::process::Command::new(program).arg("open").args(arguments).output().unwrap();
        assert!(output.stdout.is_empty());
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    for (arguments, said) in [
        (
            &["#case=example1&stp=3"][..],
            "error: the link: The word \"stp\" is not known. The nearest known one is \"step\"",
        ),
        (&["https://example.org/#case=example1&c=0"], "error: the link: c = 0 is out of range."),
        (&["#case=example1&select=12"], "names nothing that can be selected."),
        (&["https://example.org/"], "error: the link: Nothing stands after #."),
        (&["#case=example1", "--set", "c=2"], "&c=1.8 for --set c=1.8"),
        (&["#case=example1", "--scale", "2"], "Leave the options out"),
        (&["#lesson=figure-14", "--predict", "seed=1,count=2"], "Leave the options out"),
    ] {
        let (code, err) = open(arguments);
        assert!(code == Some(2) && err.contains(said) && err.lines().count() == 1, "{arguments:?}: {err}");
    }
}
