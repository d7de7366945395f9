//! Promise: a presentation shows the view and the sentence of the step alone, in large type; clickers step it; all but
//! the quadrilateral at hand is dimmed and the camera goes there; and what was there before is there again afterwards.
//!
//! Needs a graphics adapter (see `window_harness`).
#![allow(clippy::unwrap_used)]

#[path = "window_harness/pictures.rs"]
mod pictures;
mod window_harness;

use eframe::egui::{Key, Modifiers, Pos2, Vec2};
use egui_kittest::kittest::Queryable;
use pictures::{difference, picture};
use quadfront::app::window::{App, Chrome, Command, Direction, Goal, PairCommand, PresentationCommand, Source, Which};
use quadfront::core::convert::EventKind;
use quadfront::core::run::explain::plain;
use window_harness::{LAPTOP, Window, apply, has_adapter, settle, start, type_over, until};

const NONE: Modifiers = Modifiers::NONE;

/// The window on a case, at step 0.
fn window(name: &str) -> Option<Window> {
    if !has_adapter() {
        return None;
    }
    let mut window = start(LAPTOP, |cc| App::new(cc, Some(Source::BuiltIn(name.to_owned()))));
    settle(&mut window);
    Some(window)
}

fn press(window: &mut Window, modifiers: Modifiers, key: Key) {
    window.key_press_modifiers(modifiers, key);
    settle(window);
}

fn chrome(window: &Window) -> Chrome {
    window.state().state.chrome()
}

fn step(window: &Window) -> u64 {
    window.state().state.active().run().moment.as_ref().unwrap().step
}

fn quads(window: &Window) -> u64 {
    window.state().state.active().run().moment.as_ref().unwrap().standing
}

/// Waits until the camera has arrived and nothing fades or goes away by itself.
fn rest(window: &mut Window) {
    until(window, "there is no notice", |window| window.state().state.view().notice().is_none());
    // Frames of a camera that is on its way; twice as many as it takes.
    window.run_steps(160);
}

#[test]
fn a_presentation_shows_the_view_and_the_sentence_alone_and_a_clicker_steps_it() {
    let Some(mut window) = window("example1") else { return };
    for label in ["Case", "View", "Front", "Inspector", "Step forward (operation)"] {
        assert!(window.query_all_by_label(label).next().is_some(), "{label}");
    }
    press(&mut window, Modifiers::SHIFT, Key::F5);
    assert_eq!(chrome(&window), Chrome::Presentation);
    for label in ["Case", "View", "Front", "Inspector", "Step forward (operation)"] {
        assert!(window.query_all_by_label(label).next().is_none(), "{label}");
    }
    assert!(window.query_by_label("step 0   0 quads").is_some());
    // Nearly all of the window is the view.
    let view = window.get_by_label_contains("Mesh at step 0").rect();
    assert!(view.width() == LAPTOP.x && view.height() > 0.8 * LAPTOP.y && view.top() == 0.0, "{view:?}");
    // What clickers send.
    press(&mut window, NONE, Key::PageDown);
    press(&mut window, NONE, Key::PageDown);
    assert_eq!(quads(&window), 2);
    press(&mut window, NONE, Key::PageUp);
    assert_eq!(quads(&window), 1);
    // Other keys do what they do elsewhere.
    press(&mut window, Modifiers::COMMAND, Key::ArrowRight);
    let (now, narration) = {
        let moment = window.state().state.run().moment.clone().unwrap();
        (moment.step, plain(&moment.narration))
    };
    assert!(window.query_by_label(&format!("step {now}   1 quad")).is_some());
    let sentence = window.get_by_label(&narration).rect();
    assert!(sentence.top() > view.bottom() && sentence.height() > 22.0, "{sentence:?}");
    assert!((sentence.center().x - 0.5 * LAPTOP.x).abs() < 2.0, "{sentence:?}");
    press(&mut window, NONE, Key::Space);
    assert!(window.state().state.run().playing.is_some());
    press(&mut window, NONE, Key::Space);
    assert!(window.state().state.run().playing.is_none());
    // Fields that open over the window work, and what is typed there is no key of a clicker.
    window.key_press_modifiers(Modifiers::COMMAND, Key::G);
    window.run_steps(3);
    type_over(&mut window, "Step or NQ", "nq=5");
    settle(&mut window);
    assert_eq!(quads(&window), 5);
    // Escape closes what is open first, and then ends it.
    window.key_press_modifiers(Modifiers::COMMAND, Key::P);
    window.run_steps(3);
    window.key_press(Key::Escape);
    window.run_steps(3);
    assert_eq!(chrome(&window), Chrome::Presentation);
    press(&mut window, NONE, Key::Escape);
    assert_eq!(chrome(&window), Chrome::Panels);
    assert!(window.query_by_label("Step forward (operation)").is_some());
    // A clicker that has begun it ends it by the same key.
    press(&mut window, Modifiers::SHIFT, Key::F5);
    press(&mut window, NONE, Key::F5);
    assert_eq!(chrome(&window), Chrome::Panels);
}

#[test]
fn clickers_make_the_screen_black_and_what_goes_on_shows_the_mesh_again() {
    let Some(mut window) = window("figure-14") else { return };
    let is_black = |window: &Window| window.query_by_label("Black screen").is_some();
    // In the window itself, nothing.
    press(&mut window, NONE, Key::Period);
    assert!(!is_black(&window));
    press(&mut window, Modifiers::SHIFT, Key::F5);
    press(&mut window, NONE, Key::Period);
    assert!(is_black(&window) && window.query_by_label_contains("Mesh at step").is_none());
    rest(&mut window);
    let dark = picture(&mut window, "presentation-black");
    assert!(dark.chunks(4).all(|pixel| pixel[..3] == [0, 0, 0]));
    press(&mut window, NONE, Key::B);
    assert!(!is_black(&window) && window.query_by_label_contains("Mesh at step 0").is_some());
    press(&mut window, NONE, Key::B);
    press(&mut window, Modifiers::COMMAND, Key::ArrowRight);
    assert!(!is_black(&window));
    assert_eq!(step(&window), 1);
    press(&mut window, NONE, Key::B);
    press(&mut window, NONE, Key::Escape);
    assert!(!is_black(&window));
    assert_eq!(chrome(&window), Chrome::Panels);
    press(&mut window, Modifiers::SHIFT, Key::F5);
    assert!(!is_black(&window), "the next one begins with the mesh");
}

#[test]
fn the_window_is_the_same_to_the_pixel_after_a_presentation() {
    let Some(mut window) = window("example1") else { return };
    apply(&mut window, Command::Go(Goal::ToQuads(40)));
    // The timeline is made higher, and a column wider.
    let timeline = window.get_by_label("Step forward (operation)").rect();
    let edge = Pos2::new(0.5 * LAPTOP.x, timeline.top() - 6.0);
    let edge = (0..16).map(|k| edge + Vec2::new(0.0, k as f32 - 8.0)).collect::<Vec<_>>();
    let before = timeline.top();
    for at in edge {
        window.drag_at(at);
        window.run_steps(1);
        window.hover_at(at - Vec2::new(0.0, 60.0));
        window.run_steps(1);
        window.drop_at(at - Vec2::new(0.0, 60.0));
        window.run_steps(2);
        if window.get_by_label("Step forward (operation)").rect().top() < before - 30.0 {
            break;
        }
    }
    assert!(window.get_by_label("Step forward (operation)").rect().top() < before - 30.0, "the timeline is higher");
    window.hover_at(Pos2::new(4.0, 4.0));
    apply(&mut window, Command::Fit);
    rest(&mut window);
    let before = picture(&mut window, "presentation-before");
    press(&mut window, Modifiers::SHIFT, Key::F5);
    // The camera stays.
    press(&mut window, Modifiers::SHIFT, Key::D);
    press(&mut window, NONE, Key::PageDown);
    press(&mut window, NONE, Key::PageUp);
    rest(&mut window);
    let during = picture(&mut window, "presentation-during");
    let apart = difference(&before, &during);
    assert!(apart > 0.1, "the panels are away: {apart}");
    press(&mut window, NONE, Key::Escape);
    apply(&mut window, Command::Fit);
    rest(&mut window);
    let after = picture(&mut window, "presentation-after");
    assert!(difference(&before, &after) < 1e-4, "{}", difference(&before, &after));
}

#[test]
fn the_camera_goes_where_the_decision_is_and_the_spotlight_dims_what_is_far_from_it() {
    let Some(mut window) = window("example1") else { return };
    apply(&mut window, Command::Go(Goal::ToQuads(60)));
    press(&mut window, Modifiers::SHIFT, Key::F5);
    // After a quadrilateral, and within one: a clicker stops where the next base is selected.
    let formed = Command::Go(Goal::Kind(EventKind::Formed, Direction::Forward));
    for (command, expected) in [(formed, 4), (Command::Go(Goal::Quads(1)), 2)] {
        apply(&mut window, command);
        rest(&mut window);
        let state = &window.state().state;
        let moment = state.run().moment.clone().unwrap();
        let decision = moment.decision();
        let nodes: Vec<_> = decision.letters().map(|(node, _)| node).collect();
        assert_eq!(nodes.len(), expected, "step {}, {:?}", moment.step, moment.event);
        let view = state.view().plane;
        let places: Vec<_> =
            nodes.iter().map(|n| view.camera.unwrap().project(moment.mesh.uv(*n).extend(0.0), view.size)).collect();
        // The base is seen, and its tops where the base can be read beside them.
        let is_seen = |at: &glam::DVec2| at.cmpgt(glam::DVec2::ZERO).all() && at.cmplt(view.size).all();
        assert!(places[..2].iter().all(is_seen), "{places:?} of {}", view.size);
        assert!(places[0].distance(places[1]) > 20.0, "the base is seen");
        let lit = picture(&mut window, "presentation-spotlight");
        press(&mut window, NONE, Key::S);
        rest(&mut window);
        let plain = picture(&mut window, "presentation-plain");
        press(&mut window, NONE, Key::S);
        // Much of the picture is ground, which the dark does not change.
        assert!(difference(&lit, &plain) > 0.05, "much is dimmed: {}", difference(&lit, &plain));
        // Nothing is at the corners of the decision.
        let apart = |x: f64, y: f64| {
            let at = 4 * (y as usize * LAPTOP.x as usize + x as usize);
            (0..3).map(|k| lit[at + k].abs_diff(plain[at + k])).max().unwrap()
        };
        for at in places.iter().filter(|at| is_seen(at)) {
            assert!(apart(at.x, at.y) <= 2, "{at}");
        }
    }
}

#[test]
fn a_presentation_of_two_runs_shows_the_one_that_the_panels_show() {
    let Some(mut window) = window("figure-14") else { return };
    apply(&mut window, Command::Go(Goal::Steps(3)));
    window.state_mut().apply(Command::Pair(PairCommand::Fork));
    until(&mut window, "the second run is there", |window| {
        let state = &window.state().state;
        state.pair().is_some() && state.of(Which::B).run().moment.as_ref().is_some_and(|moment| moment.step == 3)
    });
    window.state_mut().apply(Command::Pair(PairCommand::Link(quadfront::app::window::LinkedBy::Free)));
    press(&mut window, Modifiers::SHIFT, Key::F5);
    assert_eq!(window.query_all_by_label_contains("Mesh at step").count(), 1);
    press(&mut window, Modifiers::COMMAND, Key::ArrowRight);
    until(&mut window, "the run at hand is one on", |window| step(window) == 4);
    assert!(window.query_by_label_contains("Mesh at step 4").is_some());
    assert_eq!(window.state().state.of(Which::A).run().moment.as_ref().unwrap().step, 3);
    press(&mut window, NONE, Key::Escape);
    assert_eq!(
        (chrome(&window), window.query_all_by_label_contains("Mesh at step").count() >= 2),
        (Chrome::Panels, true)
    );
}

#[test]
fn the_menu_and_the_list_of_keys_have_presentations() {
    let Some(mut window) = window("figure-3") else { return };
    window.get_by_label("View").click();
    settle(&mut window);
    assert!(window.query_by_label_contains("Spotlight of presentations").is_some());
    window.get_by_label_contains("Presentation ").click();
    settle(&mut window);
    assert_eq!(chrome(&window), Chrome::Presentation);
    window.state_mut().apply(Command::Help);
    window.run_steps(3);
    assert!(window.query_by_label("Presentations").is_some());
    for name in PresentationCommand::ALL.map(PresentationCommand::name) {
        assert!(window.query_all_by_label(name).next().is_some(), "{name}");
    }
}
