//! Promise: everything that a person does in the window works by its label, and the window shows it.
//!
//! Needs a graphics adapter (see `window_harness`).
#![allow(clippy::unwrap_used)]

#[path = "window/messages.rs"]
mod messages;
#[path = "window/more_texts.rs"]
mod more_texts;
#[path = "window/numbers.rs"]
mod numbers;
#[path = "window/steps.rs"]
mod steps;
#[path = "window/texts.rs"]
mod texts;
#[path = "window_harness/pictures.rs"]
mod pictures;
mod window_harness;

use std::time::Duration;

use eframe::egui::{Key, Modifiers, Pos2, Vec2};
use egui_kittest::kittest::Queryable;
use pictures::{difference, picture};
use quadfront::app::window::{App, Command, Direction, Goal, Lost, Source, SurfaceView, ViewLayer};
use quadfront::core::convert::EventKind;
use quadfront::core::mesh::NodeId;
use quadfront::render::camera::Bearing;
use quadfront::render::scene::Outlined;
use window_harness::{LAPTOP, Window, apply, has_adapter, settle, start, type_over, until};

/// The window on example 1, at step 0.
fn window() -> Option<Window> {
    has_adapter().then(|| on(LAPTOP, "example1"))
}

/// The window on a case with surfaces.
fn window_on(name: &str) -> Option<Window> {
    has_adapter().then(|| on(Vec2::new(1600.0, 900.0), name))
}

fn on(size: Vec2, name: &str) -> Window {
    let source = Source::BuiltIn(name.to_owned());
    let mut harness = start(size, |cc| App::new(cc, Some(source)));
    settle(&mut harness);
    harness
}

fn step(harness: &Window) -> u64 {
    harness.state().state.run().moment.as_ref().unwrap().step
}

fn quads(harness: &Window) -> u64 {
    harness.state().state.run().moment.as_ref().unwrap().standing
}

fn press(harness: &mut Window, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    settle(harness);
}

#[test]
fn escape_closes_what_lies_over_the_views_before_it_clears_the_selection() {
    let Some(mut harness) = window() else { return };
    let picked = Outlined::Node(NodeId(3));
    let is_picked = |harness: &Window| harness.state().state.document().picked == Some(picked);
    harness.state_mut().apply(Command::Pick(Some(picked)));
    settle(&mut harness);
    // A menu with a submenu.
    harness.get_by_label("Case").click();
    settle(&mut harness);
    harness.get_by_label_contains("Built-in cases").hover();
    settle(&mut harness);
    assert!(harness.query_by_label_contains("Figures of the paper").is_some());
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.query_by_label_contains("Figures of the paper").is_none());
    assert!(is_picked(&harness));
    // The windows for figures and notes.
    for command in [Command::Figures, Command::Notes] {
        harness.state_mut().apply(command);
        settle(&mut harness);
        press(&mut harness, Modifiers::NONE, Key::Escape);
        let view = harness.state().state.view();
        assert!(!view.figure_panel && !view.notes);
        assert!(is_picked(&harness));
    }
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(!is_picked(&harness));
}

#[test]
fn every_press_of_a_key_counts_however_fast() {
    let Some(mut harness) = window() else { return };
    // Several in a frame, before the step of the first one is known, and over frames without a pause.
    for presses in [20, 1, 3, 1, 1, 4] {
        (0..presses).for_each(|_| harness.key_press_modifiers(Modifiers::NONE, Key::ArrowRight));
        harness.step();
    }
    settle(&mut harness);
    assert_eq!(quads(&harness), 30);
    let after = step(&harness);
    (0..7).for_each(|_| harness.key_press_modifiers(Modifiers::COMMAND, Key::ArrowRight));
    harness.step();
    (0..3).for_each(|_| harness.key_press_modifiers(Modifiers::COMMAND, Key::ArrowLeft));
    settle(&mut harness);
    assert_eq!(step(&harness), after + 4);
}

#[test]
fn buttons_and_keys_step_forward_and_back() {
    let Some(mut harness) = window() else { return };
    assert_eq!(step(&harness), 0);
    harness.get_by_label("Step forward (operation)").click();
    settle(&mut harness);
    assert_eq!(step(&harness), 1);
    harness.get_by_label("Step forward (quadrilateral)").click();
    settle(&mut harness);
    assert_eq!(quads(&harness), 1);
    let after_one = step(&harness);
    press(&mut harness, Modifiers::SHIFT, Key::ArrowRight);
    assert_eq!(quads(&harness), 11);
    press(&mut harness, Modifiers::SHIFT, Key::ArrowLeft);
    assert_eq!(step(&harness), after_one);
    press(&mut harness, Modifiers::COMMAND, Key::ArrowRight);
    assert_eq!(step(&harness), after_one + 1);
    press(&mut harness, Modifiers::NONE, Key::End);
    let state = &harness.state().state;
    assert_eq!(step(&harness), state.run().track.len() as u64);
    assert!(state.run().moment.as_ref().unwrap().front.is_empty());
    press(&mut harness, Modifiers::NONE, Key::Home);
    assert_eq!(step(&harness), 0);
}

#[test]
fn a_parameter_changes_what_follows_and_nothing_before_and_undo_takes_it_back() {
    let Some(mut harness) = window() else { return };
    let kinds =
        |harness: &Window| harness.state().state.run().track.iter().map(|t| (t.kind, t.standing)).collect::<Vec<_>>();
    let before = kinds(&harness);
    apply(&mut harness, Command::Go(Goal::Step(100)));
    type_over(&mut harness, "theta_rect", "115");
    settle(&mut harness);
    assert_eq!(harness.state().state.parameter("theta_rect").as_deref(), Some("115"));
    let changed = kinds(&harness);
    assert_eq!(changed[..100], before[..100]);
    assert_ne!(changed, before);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(kinds(&harness), before);
    assert_eq!(harness.state().state.parameter("theta_rect").as_deref(), Some("135"));
}

#[test]
fn breakpoints_stop_forward_and_backward() {
    let Some(mut harness) = window() else { return };
    apply(&mut harness, Command::AddBreakpoint("kind == rolled_back".to_owned()));
    let first =
        harness.state().state.run().track.iter().position(|t| t.kind == EventKind::RolledBack).unwrap() as u64 + 1;
    press(&mut harness, Modifiers::NONE, Key::F5);
    assert_eq!(step(&harness), first);
    press(&mut harness, Modifiers::NONE, Key::F5);
    assert!(step(&harness) > first);
    press(&mut harness, Modifiers::ALT, Key::F5);
    assert_eq!(step(&harness), first);
    apply(&mut harness, Command::AddBreakpoint("kind == rolled_bakc".to_owned()));
    assert!(
        harness.state().state.view().faults[0].contains("rolled_back"),
        "{:?}",
        harness.state().state.view().faults
    );
}

#[test]
fn a_segment_that_is_picked_in_the_table_is_explained_in_the_inspector() {
    let Some(mut harness) = window() else { return };
    apply(&mut harness, Command::Go(Goal::ToQuads(50)));
    let segment = harness.state().state.run().moment.as_ref().unwrap().front[3];
    let name = format!("{} → {}", segment.a.0, segment.b.0);
    harness.get_by_label(&format!("Segment {name}")).click();
    settle(&mut harness);
    std::thread::sleep(Duration::from_millis(100));
    harness.run_steps(3);
    harness.get_by_label(&format!("Front segment {name}"));
    harness.get_by_label("Why not this segment");
    harness.get_by_label("Choose as base").click();
    settle(&mut harness);
    let state = &harness.state().state;
    let base = state.run().moment.as_ref().unwrap().phase.base().copied().unwrap();
    assert_eq!((base.a, base.b), (segment.a, segment.b), "the person's choice holds");
}

#[test]
fn a_run_that_is_saved_opens_with_its_changes() {
    let Some(mut harness) = window() else { return };
    apply(&mut harness, Command::Go(Goal::Step(60)));
    apply(&mut harness, Command::Set("c", "1.5".to_owned()));
    apply(&mut harness, Command::Bookmark);
    let kinds = |harness: &Window| harness.state().state.run().track.iter().map(|t| t.kind).collect::<Vec<_>>();
    let before = kinds(&harness);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.toml");
    quadfront::core::record::run_file::write(&path, &harness.state().state.current_run().unwrap()).unwrap();
    apply(&mut harness, Command::Open(Source::File(path)));
    assert_eq!(kinds(&harness), before);
    let kept = &harness.state().state.document();
    assert_eq!((kept.edits.len(), kept.bookmarks.iter().map(|mark| mark.step).collect::<Vec<_>>()), (1, vec![60]));
}

#[test]
fn the_mesh_at_hand_is_saved_in_the_format_of_its_name_and_nothing_is_written_over() {
    let Some(mut harness) = window() else { return };
    let folder = tempfile::tempdir().unwrap();
    let save = |harness: &mut Window, name: &str| {
        press(harness, Modifiers::COMMAND, Key::M);
        let path = folder.path().join(name);
        type_over(harness, "Path of the mesh", &path.display().to_string());
        until(harness, "something is told", |harness| {
            let view = harness.state().state.view();
            view.notice().is_some_and(|notice| notice.0.contains(name)) || !view.faults.is_empty()
        });
        let faults = harness.state().state.view().faults.clone();
        faults.iter().for_each(|_| harness.state_mut().apply(Command::CloseFault(0)));
        assert!(faults.is_empty() || faults[0].contains(name), "{faults:?}");
        faults.is_empty().then(|| quadfront::core::formats::format::read_mesh(&path, None).unwrap())
    };
    apply(&mut harness, Command::Go(Goal::ToQuads(40)));
    let on_the_way = save(&mut harness, "way.msh").unwrap();
    assert_eq!(on_the_way.quads.len(), 40);
    assert!(!on_the_way.triangles.is_empty());
    apply(&mut harness, Command::Go(Goal::End));
    let end = save(&mut harness, "end.vtu").unwrap();
    assert_eq!((end.quads.len() as u64, end.triangles.len()), (quads(&harness), 0));
    let before = std::fs::read(folder.path().join("end.vtu")).unwrap();
    assert!(save(&mut harness, "end.vtu").is_none(), "there is such a file");
    assert_eq!(std::fs::read(folder.path().join("end.vtu")).unwrap(), before);
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(save(&mut harness, "end.stl").is_none(), "STL has no quadrilaterals");
}

#[test]
fn the_palette_finds_a_command_by_its_name() {
    let Some(mut harness) = window() else { return };
    press(&mut harness, Modifiers::COMMAND, Key::P);
    harness.get_by_label("Name of a command").type_text("ten nonsense");
    harness.run_steps(2);
    harness.get_by_label("No command matches.");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.query_by_label("Name of a command").is_none());
    press(&mut harness, Modifiers::COMMAND, Key::P);
    harness.get_by_label("Name of a command").type_text("10 quadrilaterals forward");
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    settle(&mut harness);
    assert_eq!(quads(&harness), 10);
}

#[test]
fn the_window_looks_the_same_however_one_came_to_a_step_and_other_at_another() {
    let Some(mut harness) = window() else { return };
    apply(&mut harness, Command::Go(Goal::Step(400)));
    let there = picture(&mut harness, "there");
    apply(&mut harness, Command::Go(Goal::End));
    let end = picture(&mut harness, "end");
    apply(&mut harness, Command::Go(Goal::Step(0)));
    apply(&mut harness, Command::Go(Goal::Step(400)));
    let again = picture(&mut harness, "again");
    assert!(difference(&there, &again) < 0.002, "{}", difference(&there, &again));
    assert!(difference(&there, &end) > 0.05, "{}", difference(&there, &end));
    apply(&mut harness, Command::ToggleTheme);
    let light = picture(&mut harness, "light");
    assert!(difference(&light, &again) > 0.5);
}

#[test]
fn a_file_that_is_not_there_is_a_message_and_the_window_goes_on() {
    let Some(mut harness) = window() else { return };
    harness.state_mut().apply(Command::Open(Source::named("no-such-case.toml")));
    until(&mut harness, "a fault is shown", |harness| !harness.state().state.view().faults.is_empty());
    assert!(harness.state().state.view().faults[0].contains("no-such-case.toml"));
    harness.run_steps(2);
    harness.get_by_label("Close").click();
    harness.run_steps(2);
    assert!(harness.state().state.view().faults.is_empty());
    apply(&mut harness, Command::Open(Source::named("example1")));
    assert_eq!(step(&harness), 0);
}

/// Runs frames until something is shown by its label.
fn wait_for(harness: &mut Window, label: &str) {
    until(harness, label, |harness| harness.query_by_label(label).is_some());
}

#[test]
fn a_node_that_is_watched_stops_the_run_forward_and_backward_and_tells_who_touched_it() {
    let Some(mut harness) = window() else { return };
    apply(&mut harness, Command::Go(Goal::ToQuads(40)));
    let node = harness.state().state.run().moment.as_ref().unwrap().front[0].a;
    apply(&mut harness, Command::Pick(Some(Outlined::Node(node))));
    harness.get_by_label("Watch").click();
    settle(&mut harness);
    harness.get_by_label(&format!("Watch node {}", node.0));
    let begin = step(&harness);
    press(&mut harness, Modifiers::NONE, Key::F5);
    let first = step(&harness);
    press(&mut harness, Modifiers::NONE, Key::F5);
    let second = step(&harness);
    assert!(begin < first && first < second, "{begin} {first} {second}");
    press(&mut harness, Modifiers::ALT, Key::F5);
    assert_eq!(step(&harness), first);
    apply(&mut harness, Command::Go(Goal::Step(second)));
    wait_for(&mut harness, "Past steps");
    apply(&mut harness, Command::Go(Goal::Step(second + 1)));
    harness.get_by_label("Last change").click();
    settle(&mut harness);
    assert!(step(&harness) <= second);
    harness.get_by_label("Stop watching").click();
    settle(&mut harness);
    assert!(harness.state().state.document().watches.is_empty());
}

#[test]
fn a_quadrilateral_tells_when_it_was_made_and_what_it_ate() {
    let Some(mut harness) = window() else { return };
    let (at, element) = {
        let track = &harness.state().state.run().track;
        let found = track.iter().enumerate().filter_map(|(k, t)| Some((k as u64 + 1, t.formed?.0))).nth(30);
        found.unwrap()
    };
    apply(&mut harness, Command::Go(Goal::Step(at + 3)));
    apply(&mut harness, Command::Pick(Some(Outlined::Element(element))));
    harness.get_by_label(&format!("Quadrilateral {}", element.0));
    wait_for(&mut harness, "Past steps");
    assert!(harness.query_by_label_contains("made of the triangles").is_some());
    harness.get_by_label("Go to creation").click();
    settle(&mut harness);
    assert_eq!(step(&harness), at);
}

#[test]
fn fields_of_conditions_are_offered_and_an_error_stays_where_it_can_be_mended() {
    let Some(mut harness) = window() else { return };
    let field = "Condition of a new breakpoint";
    harness.get_by_label(field).focus();
    harness.run_steps(2);
    harness.get_by_label(field).type_text("quad.mi");
    harness.run_steps(3);
    harness.get_by_label("Use quad.min_angle").click();
    harness.run_steps(3);
    assert_eq!(harness.get_by_label(field).value().as_deref(), Some("quad.min_angle "));
    harness.get_by_label(field).type_text("<");
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    assert!(harness.state().state.document().breakpoints.is_empty());
    assert!(harness.query_by_label_contains("position").is_some(), "the error says where");
    harness.get_by_label(field).focus();
    harness.run_steps(2);
    harness.get_by_label(field).type_text(" 30");
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    settle(&mut harness);
    let breakpoints = &harness.state().state.document().breakpoints;
    assert!(breakpoints.len() == 1 && breakpoints[0].is_on, "{breakpoints:?}");
    assert_eq!(breakpoints[0].condition, "quad.min_angle < 30");
}

#[test]
fn the_inspector_says_why_with_the_numbers_of_the_paper() {
    let Some(mut harness) = window() else { return };
    apply(&mut harness, Command::Go(Goal::Kind(EventKind::BaseSelected, Direction::Forward)));
    for label in ["H-value", "Frontal angles", "Why this segment", "Length", "Ends"] {
        harness.get_by_label(label);
    }
    assert!(harness.query_by_label_contains("Same choice for").is_some());
    apply(&mut harness, Command::Go(Goal::Kind(EventKind::SideChosen, Direction::Forward)));
    assert!(harness.query_by_label_contains("tried").is_some(), "what the side was chosen from");
    assert!(harness.query_all_by_label_contains("chosen").next().is_some());
}

#[test]
fn the_base_under_way_is_told_as_it_was_selected_with_what_is_done_and_what_comes_next() {
    let Some(mut harness) = window() else { return };
    apply(&mut harness, Command::Go(Goal::ToQuads(60)));
    apply(&mut harness, Command::Go(Goal::Kind(EventKind::BaseSelected, Direction::Forward)));
    let why =
        |harness: &Window| harness.state().state.run().moment.as_ref().unwrap().base.as_ref().unwrap().why.clone();
    let selected = why(&harness);
    for _ in 0..3 {
        harness.get_by_label("Why this segment");
        harness.get_by_label("This quadrilateral so far");
        harness.get_by_label("Next step");
        assert_eq!(why(&harness), selected);
        press(&mut harness, Modifiers::COMMAND, Key::ArrowRight);
    }
    apply(&mut harness, Command::Set("c", "1.2".to_owned()));
    harness.get_by_label("Why this segment");
    assert!(harness.query_by_label("c was 2 at this selection; 1.2 counts from the next base on.").is_some());
    assert_eq!(why(&harness)[..selected.len()], selected);
    press(&mut harness, Modifiers::COMMAND, Key::ArrowLeft);
    assert_eq!(why(&harness), selected);
}

#[test]
fn the_timeline_gives_each_kind_a_row_of_its_own_and_its_state_is_spoken() {
    let Some(mut harness) = window() else { return };
    assert!(harness.query_by_label_contains("Timeline: step 0 of").is_some());
    assert!(harness.query_by_label("Lane: side swapped").is_none());
    harness.get_by_label("Lane: swap").click();
    harness.run_steps(3);
    harness.get_by_label("Lane: side swapped").click();
    harness.run_steps(3);
    harness.get_by_label("Lane: swap");
}

#[test]
fn a_tab_that_was_opened_is_closed_by_undo() {
    let Some(mut harness) = window() else { return };
    harness.get_by_label("History").click();
    harness.run_steps(4);
    harness.get_by_label("Changes of this run");
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert!(harness.query_by_label("Changes of this run").is_none());
    press(&mut harness, Modifiers::COMMAND, Key::Y);
    harness.get_by_label("Changes of this run");
}

#[test]
fn the_window_is_found_again_as_it_was_left_and_nonsense_is_told() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("window.json");
    let on = |path: std::path::PathBuf| {
        let source = Source::BuiltIn("two-faces".to_owned());
        let mut harness = start(LAPTOP, |cc| App::kept(cc, Some(source), Some(path), Lost::default()));
        settle(&mut harness);
        harness
    };
    let mut harness = on(path.clone());
    harness.get_by_label("Layers").click();
    apply(&mut harness, Command::Layer(ViewLayer::MetricEllipses));
    apply(&mut harness, Command::ToggleTheme);
    until(&mut harness, "something is kept", |_| path.exists());
    let text = std::fs::read_to_string(&path).unwrap();
    let again = on(path.clone());
    assert!(again.state().state.document().layers.ellipses);
    assert!(text.contains("\"dark\": false"), "{text}");
    again.get_by_label("Colour by");
    drop(again);
    std::fs::write(&path, &text[..text.len() / 2]).unwrap();
    let bad = on(path);
    assert!(bad.state().state.view().faults[0].contains("window.json"), "{:?}", bad.state().state.view().faults);
    assert!(!bad.state().state.document().layers.ellipses);
}

#[test]
fn a_window_of_hardly_any_size_and_back_is_no_trouble() {
    let Some(mut harness) = window() else { return };
    let before = picture(&mut harness, "before");
    for size in [Vec2::new(1.0, 1.0), Vec2::new(3000.0, 2.0), Vec2::new(300.0, 900.0), Vec2::new(1280.0, 800.0)] {
        harness.set_size(size);
        harness.run_steps(4);
        harness.render().unwrap();
    }
    settle(&mut harness);
    let after = picture(&mut harness, "resized");
    assert!(difference(&before, &after) < 0.02, "{}", difference(&before, &after));
}

#[test]
fn a_lost_device_saves_the_run_and_says_where() {
    if !has_adapter() {
        return;
    }
    let lost = Lost::default();
    let (device, heard) = (std::sync::Arc::new(std::sync::Mutex::new(None)), lost.clone());
    let kept = device.clone();
    let mut harness = start(LAPTOP, |cc| {
        *kept.lock().unwrap() = cc.wgpu_render_state.as_ref().map(|render| render.device.clone());
        App::kept(cc, Some(Source::BuiltIn("two-faces".to_owned())), None, heard)
    });
    settle(&mut harness);
    let device = device.lock().unwrap().take().unwrap();
    device.destroy();
    until(&mut harness, "the window has heard of it", |harness| {
        let _ = device.poll(wgpu::PollType::Poll);
        harness.state().is_lost()
    });
    let told = lost.fault().unwrap().to_string();
    let path = std::path::PathBuf::from(told.split_whitespace().last().unwrap().trim_end_matches('.'));
    assert!(told.contains("was lost") && path.exists(), "{told}");
    std::fs::remove_file(path).unwrap();
}

#[test]
fn times_are_shown_and_measured_where_they_are_asked_for() {
    let Some(mut harness) = window() else { return };
    apply(&mut harness, Command::ShowTimes);
    press(&mut harness, Modifiers::NONE, Key::ArrowRight);
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("state ").is_some());
    harness.state_mut().apply(Command::Measure);
    until(&mut harness, "it is measured", |harness| harness.state().state.run().measuring.is_none());
    assert!(harness.query_by_label_contains("60 quads forward and back").is_some());
}

#[test]
fn surfaces_open_in_space_and_a_key_a_button_and_the_palette_lead_to_the_plane_and_back() {
    let Some(mut harness) = window_on("example2") else { return };
    let place = |harness: &Window| harness.state().state.workspace().surfaces.view;
    assert_eq!(place(&harness), SurfaceView::Space);
    let space = picture(&mut harness, "space");
    press(&mut harness, Modifiers::NONE, Key::V);
    assert_eq!(place(&harness), SurfaceView::Plane);
    let plane = picture(&mut harness, "plane");
    assert!(difference(&space, &plane) > 0.02, "{}", difference(&space, &plane));
    harness.get_by_label("Show in space").click();
    settle(&mut harness);
    assert_eq!(place(&harness), SurfaceView::Space);
    let again = picture(&mut harness, "again");
    assert!(difference(&space, &again) < 0.004, "{}", difference(&space, &again));
    press(&mut harness, Modifiers::COMMAND, Key::P);
    harness.get_by_label("Name of a command").type_text("side by side");
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    settle(&mut harness);
    assert_eq!(place(&harness), SurfaceView::Both);
    let both = picture(&mut harness, "both");
    assert!(difference(&both, &space) > 0.02 && difference(&both, &plane) > 0.02);
}

#[test]
fn a_step_in_space_looks_the_same_however_one_came_to_it() {
    let Some(mut harness) = window_on("example2") else { return };
    press(&mut harness, Modifiers::SHIFT, Key::V);
    for curved in [false, true] {
        if curved {
            press(&mut harness, Modifiers::NONE, Key::C);
        }
        apply(&mut harness, Command::Go(Goal::Step(40)));
        let there = picture(&mut harness, "there");
        apply(&mut harness, Command::Go(Goal::End));
        let end = picture(&mut harness, "end");
        apply(&mut harness, Command::Go(Goal::Step(40)));
        let again = picture(&mut harness, "again");
        assert!(difference(&there, &again) < 0.002, "{}", difference(&there, &again));
        assert!(difference(&there, &end) > 0.02, "{}", difference(&there, &end));
    }
}

/// Drags from a point to the right and down, over several frames.
fn drag(harness: &mut Window, at: Pos2) {
    harness.drag_at(at);
    harness.run_steps(1);
    for k in 1..=4 {
        harness.hover_at(at + Vec2::new(20.0 * k as f32, 8.0 * k as f32));
        harness.run_steps(1);
    }
    harness.drop_at(at + Vec2::new(80.0, 32.0));
    harness.run_steps(3);
}

#[test]
fn a_click_in_space_selects_what_is_in_front_and_a_drag_turns_the_mesh_about_what_was_grabbed() {
    let Some(mut harness) = window_on("sphere") else { return };
    // The view is the first of the canvases; its middle is the middle of the sphere's near half.
    let rect = harness.query_all_by_label_contains("Mesh at step").map(|node| node.rect()).next().unwrap();
    let at = rect.center();
    harness.hover_at(at);
    harness.run_steps(2);
    let what = harness.state().state.frame().hovered.expect("something is under the pointer");
    harness.drag_at(at);
    harness.run_steps(1);
    harness.drop_at(at);
    harness.run_steps(3);
    let state = &harness.state().state;
    assert_eq!(state.document().picked, Some(what));
    let (mesh, camera) = (state.run().moment.as_ref().unwrap().mesh.clone(), state.view().space.camera.unwrap());
    let towards = camera.towards();
    let nodes = match what {
        Outlined::Node(n) => vec![n],
        Outlined::Edge(ends) => ends.to_vec(),
        Outlined::Element(e) => mesh.corners(e).collect(),
    };
    assert!(nodes.iter().all(|n| (mesh.xyz(*n) - camera.centre).dot(towards) > 0.0), "it is on the near half");
    drag(&mut harness, at);
    let turned = harness.state().state.view().space.camera.unwrap();
    assert!(turned.towards().angle_between(towards) > 0.2, "{}", turned.towards().angle_between(towards));
    assert_eq!(turned.scale, camera.scale);
    press(&mut harness, Modifiers::NONE, Key::X);
    let camera = harness.state().state.view().space.camera.unwrap();
    assert!(camera.towards().distance(glam::DVec3::X) < 1e-9);
}

#[test]
fn a_plane_view_that_is_moved_is_saved_with_the_run() {
    let Some(mut harness) = window_on("example1") else { return };
    let is_kept = |harness: &Window| {
        let state = &harness.state().state;
        assert_eq!(state.current_run().unwrap().camera.is_some(), !state.view().plane.is_fitted);
        !state.view().plane.is_fitted
    };
    assert!(!is_kept(&harness));
    let at = harness.query_all_by_label_contains("Mesh at step").map(|node| node.rect()).next().unwrap().center();
    drag(&mut harness, at);
    assert!(is_kept(&harness));
    press(&mut harness, Modifiers::NONE, Key::F);
    assert!(!is_kept(&harness), "the whole mesh is shown again");
}

#[test]
fn hidden_lines_go_round_and_show_more() {
    let Some(mut harness) = window_on("sphere") else { return };
    let mut pictures = vec![picture(&mut harness, "hidden")];
    for _ in 0..3 {
        press(&mut harness, Modifiers::NONE, Key::H);
        pictures.push(picture(&mut harness, "hidden"));
    }
    let apart: Vec<f64> = pictures[1..].iter().map(|p| difference(&pictures[0], p)).collect();
    assert!(apart[1] > 0.005 && apart[1] > apart[0] && apart[2] < 0.002, "{apart:?}");
}

/// The texts that the last frame has painted over the main view and that say this.
fn painted(harness: &Window, said: &str) -> Vec<eframe::egui::Rect> {
    let view = harness.query_all_by_label_contains("Mesh at step").map(|node| node.rect()).next().unwrap();
    let texts = texts::texts(harness).into_iter().filter(|text| text.said == said).map(|text| text.rect);
    texts.filter(|rect| view.contains_rect(*rect)).collect()
}

#[test]
fn a_base_on_the_far_side_is_pointed_at_and_a_key_turns_to_it() {
    let Some(mut harness) = window_on("sphere") else { return };
    apply(&mut harness, Command::Go(Goal::ToQuads(40)));
    apply(&mut harness, Command::Go(Goal::Kind(EventKind::BaseSelected, Direction::Forward)));
    let moment = harness.state().state.run().moment.clone().unwrap();
    let base = moment.phase.base().unwrap();
    let normal = (moment.mesh.normal(base.a) + moment.mesh.normal(base.b)).normalize();
    let facing = |harness: &Window| harness.state().state.view().space.camera.unwrap().towards().dot(normal);
    const HINT: &str = "base, on the far side: F turns to it";
    // From the side that is opposite to it.
    for [azimuth, elevation] in (-9..9).flat_map(|a| (-4..=4).map(move |e| [20 * a, 20 * e].map(f64::from))) {
        apply(&mut harness, Command::LookFrom(Bearing::Angles([azimuth, elevation, 0.0])));
        if facing(&harness) < -0.95 {
            break;
        }
    }
    assert!(facing(&harness) < -0.95, "{}", facing(&harness));
    let rect = harness.query_all_by_label_contains("Mesh at step").map(|node| node.rect()).next().unwrap();
    let at = painted(&harness, HINT);
    assert!(at.len() == 1 && rect.contains_rect(at[0]), "{at:?}");
    press(&mut harness, Modifiers::NONE, Key::F);
    harness.run_steps(3);
    assert!(facing(&harness) > 0.2, "{}", facing(&harness));
    assert!(painted(&harness, HINT).is_empty() && painted(&harness, "base").is_empty());
    let view = harness.state().state.view().space;
    for node in [base.a, base.b] {
        let at = view.camera.unwrap().project(moment.mesh.xyz(node), view.size);
        assert!(at.cmpgt(glam::DVec2::ZERO).all() && at.cmplt(view.size).all(), "{at}");
    }
}

#[test]
fn a_base_outside_of_the_view_is_pointed_at_from_its_rim() {
    let Some(mut harness) = window() else { return };
    apply(&mut harness, Command::Go(Goal::Kind(EventKind::BaseSelected, Direction::Forward)));
    let moment = harness.state().state.run().moment.clone().unwrap();
    let (mesh, base) = (&moment.mesh, moment.phase.base().unwrap());
    assert!(painted(&harness, "base").is_empty());
    // What is farthest from the base, from near.
    let far = mesh.nodes().max_by(|a, b| {
        let [a, b] = [a, b].map(|n| mesh.uv(*n).distance(mesh.uv(base.a)));
        a.total_cmp(&b)
    });
    let far = far.unwrap();
    apply(&mut harness, Command::Find(Outlined::Node(far)));
    harness.run_steps(3);
    let rect = harness.query_all_by_label_contains("Mesh at step").map(|node| node.rect()).next().unwrap();
    harness.hover_at(rect.center());
    harness.run_steps(1);
    harness.event(eframe::egui::Event::Zoom(8.0));
    harness.run_steps(3);
    let view = harness.state().state.view().plane;
    let to = view.camera.unwrap().project(mesh.uv(base.a).extend(0.0), view.size);
    let is_inside = to.cmpgt(glam::DVec2::ZERO).all() && to.cmplt(view.size).all();
    let at = painted(&harness, "base");
    assert!(!is_inside && at.len() == 1 && rect.contains_rect(at[0]), "{to} {at:?}");
    // It stands where the way to the base leaves the view.
    let way = Vec2::new(to.x as f32, to.y as f32) - 0.5 * rect.size();
    let from = at[0].center() - rect.center();
    assert!(way.normalized().dot(from.normalized()) > 0.95, "{way:?} {from:?}");
    let gap = (0.5 * rect.size() - from.abs()).min_elem();
    assert!((0.0..80.0).contains(&gap), "{gap}");
    press(&mut harness, Modifiers::NONE, Key::F);
    harness.run_steps(3);
    assert!(painted(&harness, "base").is_empty());
}
