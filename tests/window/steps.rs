//! What the timeline and the legend say of steps, and what a stop selects.

use eframe::egui::accesskit::Live;
use eframe::egui::{Event as Input, Key, Modifiers, PointerButton, Pos2, Role, Vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use glam::DVec2;
use quadfront::app::window::{Command, Direction, Goal, ViewLayer};
use quadfront::core::convert::{Event, EventKind};
use quadfront::core::kernel::number::grouped;
use quadfront::core::progress::Nobody;
use quadfront::core::run::History;
use quadfront::core::run::explain::plain;
use quadfront::render::scene::Outlined;

use super::window_harness::{Window, apply, settle, until};
use super::{press, step, window};

/// The height of the ruler of the timeline, and of a row with its gap.
const RULER: f32 = 24.0;
const ROW: f32 = 14.0;

fn click_at(harness: &mut Window, pos: Pos2) {
    harness.event(Input::PointerMoved(pos));
    harness.run_steps(2);
    for pressed in [true, false] {
        harness.event(Input::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        });
        harness.run_steps(1);
    }
    settle(harness);
}

#[test]
fn a_click_in_a_row_of_the_timeline_leads_to_an_event_of_the_row() {
    let Some(mut harness) = window() else { return };
    let plot = harness.get_by_label_contains("Timeline: step").rect().shrink2(Vec2::new(6.0, 4.0));
    let track = harness.state().state.run().track.clone();
    let rows: [(usize, &[EventKind]); 3] = [
        (0, &[EventKind::Formed]),
        (2, &[EventKind::SideDivided, EventKind::NodeRemoved]),
        (4, &[EventKind::RolledBack, EventKind::Deferred]),
    ];
    for (row, kinds) in rows {
        let steps: Vec<usize> = (1..=track.len()).filter(|step| kinds.contains(&track[step - 1].kind)).collect();
        for wanted in [steps[0], steps[steps.len() / 2], steps[steps.len() - 1]] {
            let x = plot.left() + plot.width() * wanted as f32 / track.len() as f32;
            let y = plot.top() + RULER + ROW * row as f32 + 6.0;
            click_at(&mut harness, Pos2::new(x + 1.5, y));
            let kind = track[step(&harness) as usize - 1].kind;
            assert!(kinds.contains(&kind), "row {row}, step {wanted}: {kind:?} at {}", step(&harness));
        }
    }
}

#[test]
fn a_stop_at_a_breakpoint_selects_what_it_stopped_for() {
    let Some(mut harness) = window() else { return };
    let picked = |harness: &Window| harness.state().state.document().picked;
    apply(&mut harness, Command::AddBreakpoint("kind == formed && quad.min_angle < 60".to_owned()));
    press(&mut harness, Modifiers::NONE, Key::F5);
    // The session says what it stopped for after the state.
    until(&mut harness, "it is selected", |harness| picked(harness).is_some());
    let hits = harness.state().state.run().hits[0].clone();
    assert_eq!(hits.first(), Some(&step(&harness)), "the marks of the timeline are where the run stops");
    let formed = harness.state().state.run().track[step(&harness) as usize - 1].formed.unwrap();
    assert_eq!(picked(&harness), Some(Outlined::Element(formed.0)));
    apply(&mut harness, Command::RemoveBreakpoint(0));
    apply(&mut harness, Command::AddBreakpoint("kind == base_selected".to_owned()));
    press(&mut harness, Modifiers::NONE, Key::F5);
    until(&mut harness, "the base is selected", |harness| matches!(picked(harness), Some(Outlined::Edge(_))));
    let moment = harness.state().state.run().moment.clone().unwrap();
    let Some(Event::BaseSelected { a, b, .. }) = moment.event else { panic!("{:?}", moment.event) };
    assert_eq!(picked(&harness), Some(Outlined::Edge([a, b])));
}

#[test]
fn undo_takes_back_what_a_person_changed_and_no_stop_at_a_breakpoint() {
    let Some(mut harness) = window() else { return };
    let document = |harness: &Window| harness.state().state.document().clone();
    apply(&mut harness, Command::AddBreakpoint("kind == formed".to_owned()));
    apply(&mut harness, Command::Layer(ViewLayer::MetricEllipses));
    let mut stopped_at = Vec::new();
    for _ in 0..3 {
        let (before, picked) = (step(&harness), document(&harness).picked);
        press(&mut harness, Modifiers::NONE, Key::F5);
        until(&mut harness, "the next one is selected", |harness| {
            step(harness) > before && document(harness).picked != picked
        });
        stopped_at.push(document(&harness).picked);
    }
    // The first undo is of the layer, and what the last stop selected stays selected.
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    let now = document(&harness);
    assert_eq!((now.layers.ellipses, now.picked, now.breakpoints.len()), (false, stopped_at[2], 1));
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!((document(&harness).picked, document(&harness).breakpoints.len()), (stopped_at[2], 0));
    for _ in 0..2 {
        press(&mut harness, Modifiers::COMMAND, Key::Y);
    }
    let now = document(&harness);
    assert_eq!((now.layers.ellipses, now.picked, now.breakpoints.len()), (true, stopped_at[2], 1));
    // A selection of the person's own is taken back to what was selected before it.
    apply(&mut harness, Command::Pick(None));
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(document(&harness).picked, stopped_at[2]);
}

#[test]
fn the_sentence_of_a_step_stands_below_the_buttons_and_leads_to_the_transcript() {
    let Some(mut harness) = window() else { return };
    let run = harness.state().state.run().opened.as_ref().unwrap().run.clone();
    let mut whole = History::open(run, &mut Nobody).unwrap();
    while whole.end().is_none() {
        whole.extend(whole.log().known() + 1024);
    }
    let end = whole.log().known();
    let told = |step: u64| plain(&whole.transcript(step, step).unwrap()[0]);
    let height = harness.get_by_label_contains("Timeline: step").rect().top();
    for step in [1, end / 2, end] {
        apply(&mut harness, Command::Go(Goal::Step(step)));
        harness.run_steps(2);
        let said = told(step);
        let sentence = harness.get_by_role_and_label(Role::Status, &said);
        // Screen readers say it, and nothing moves, however long it is.
        assert_eq!(sentence.accesskit_node().live(), Live::Polite);
        assert_eq!(harness.get_by_label_contains("Timeline: step").rect().top(), height);
    }
    harness.get_by_role_and_label(Role::Status, &told(end)).click();
    harness.run_steps(3);
    // The sentences around the current step, each leading to its step.
    let row = |step: u64| format!("Step {}: {}", grouped(step), told(step));
    until(&mut harness, "the transcript", |harness| harness.query_by_label(&row(end)).is_some());
    harness.run_steps(20);
    let current = harness.get_by_label(&row(end)).rect();
    let below = harness.get_by_role_and_label(Role::Tab, "Parameters").rect().top();
    assert!(current.bottom() <= below, "the current step is in view: {current:?}, {below}");
    harness.get_by_label(&row(end - 30)).click_accesskit();
    settle(&mut harness);
    assert_eq!(step(&harness), end - 30);
    until(&mut harness, "the steps after it", |harness| harness.query_by_label(&row(end - 25)).is_some());
    // Earlier ones are told without going there.
    let page = end - 130;
    assert!(harness.query_by_label(&row(page)).is_none());
    harness.get_by_label("Earlier steps").click_accesskit();
    until(&mut harness, "earlier steps", |harness| harness.query_by_label(&row(page)).is_some());
    assert_eq!(step(&harness), end - 30);
    // The run goes elsewhere: so does the transcript.
    apply(&mut harness, Command::Go(Goal::Step(3)));
    until(&mut harness, "the first steps", |harness| harness.query_by_label(&row(3)).is_some());
    assert!(harness.query_by_label("Earlier steps").is_none());
    // The steps after a change are told anew.
    apply(&mut harness, Command::Set("placement", "false".to_owned()));
    let run = harness.state().state.current_run().unwrap();
    let mut other = History::open(run, &mut Nobody).unwrap();
    other.extend(80);
    let changed = (4..=80).find(|step| other.event(*step).unwrap() != whole.event(*step).unwrap()).unwrap();
    let text = format!("Step {changed}: {}", plain(&other.transcript(changed, changed).unwrap()[0]));
    until(&mut harness, &text, |harness| harness.query_by_label(&text).is_some());
}

#[test]
fn the_camera_follows_the_decision_until_it_is_told_to_stay() {
    let Some(mut harness) = window() else { return };
    let select = |harness: &mut Window| {
        apply(harness, Command::Go(Goal::Kind(EventKind::BaseSelected, Direction::Forward)));
        harness.run_steps(60);
    };
    let camera = |harness: &Window| harness.state().state.view().plane;
    // The ends of the base in the view, in points.
    let base = |harness: &Window| {
        let moment = harness.state().state.run().moment.clone().unwrap();
        let base = moment.phase.base().unwrap();
        let view = camera(harness);
        let at = |n| view.camera.unwrap().project(moment.mesh.uv(n).extend(0.0), view.size);
        ([at(base.a), at(base.b)], view.size)
    };
    let is_seen = |harness: &Window| {
        let ([a, b], size) = base(harness);
        [a, b].iter().all(|p| p.cmpgt(DVec2::ZERO).all() && p.cmplt(size).all()) && a.distance(b) >= 24.0
    };
    select(&mut harness);
    assert!(!is_seen(&harness), "in the whole mesh the base is a dot");
    press(&mut harness, Modifiers::SHIFT, Key::D);
    harness.run_steps(60);
    assert!(is_seen(&harness), "{:?}", base(&harness));
    for step in [400, 900, 1500, 2000] {
        apply(&mut harness, Command::Go(Goal::Step(step)));
        select(&mut harness);
        assert!(is_seen(&harness), "step {step}: {:?}", base(&harness));
    }
    let before = camera(&harness);
    press(&mut harness, Modifiers::SHIFT, Key::D);
    apply(&mut harness, Command::Go(Goal::Step(30)));
    harness.run_steps(60);
    assert_eq!(camera(&harness), before, "it stays");
}

#[test]
fn the_view_describes_the_state_for_screen_readers() {
    let Some(mut harness) = window() else { return };
    apply(&mut harness, Command::Go(Goal::Kind(EventKind::SideSwapped, Direction::Forward)));
    harness.run_steps(2);
    let moment = harness.state().state.run().moment.clone().unwrap();
    let view = harness.get_by_role(Role::Canvas);
    let said = view.accesskit_node().description().unwrap();
    let base = moment.phase.base().unwrap();
    let mesh = &moment.mesh;
    let front = mesh.front().count();
    for part in [
        format!("The front has {front} segments in {} loops.", moment.loops.len()),
        format!("The base is {} \u{2192} {}, of class ", base.a.0, base.b.0),
        plain(&moment.narration),
        plain(&moment.about[0]),
        format!("Next: {}", plain(&moment.next)),
    ] {
        assert!(said.contains(&part), "{part} is not in {said}");
    }
}

#[test]
fn the_legend_lights_the_row_of_table_1_that_selected_the_base() {
    let Some(mut harness) = window() else { return };
    let mut seen = [false; 4];
    for _ in 0..40 {
        apply(&mut harness, Command::Go(Goal::Kind(EventKind::BaseSelected, Direction::Forward)));
        harness.run_steps(2);
        let moment = harness.state().state.run().moment.clone().unwrap();
        let Some(Event::BaseSelected { class, within_reach, .. }) = moment.event else { panic!("{:?}", moment.event) };
        let row = if within_reach { class } else { 4 };
        seen[usize::from(row) - 1] = true;
        for k in 1..=4 {
            let said = if k == row { ": selected the base" } else { "" };
            harness.get_by_label(&format!("Row {k} of table 1{said}"));
        }
    }
    assert!(seen.iter().filter(|seen| **seen).count() >= 2, "{seen:?}");
}
