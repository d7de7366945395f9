//! Promise: everything that a person does in the window works by its label, and the window shows it.
//!
//! Needs a graphics adapter (Mesa's lavapipe is one). Without any, the tests are skipped with the reason; where
//! `QUADFRONT_NEEDS_ADAPTER` is set, its absence is a failure.
#![allow(clippy::unwrap_used)]

use std::time::{Duration, Instant};

use eframe::egui::{Key, Modifiers, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use quadfront::app::window::{App, Command, Goal, Source};

fn has_adapter() -> bool {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    match pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default())) {
        Ok(_) => true,
        Err(error) => {
            assert!(std::env::var_os("QUADFRONT_NEEDS_ADAPTER").is_none(), "no graphics adapter: {error}");
            println!("skipped: there is no graphics adapter ({error})");
            false
        }
    }
}

/// The window on example 1, at step 0; the size is that of a small laptop.
fn window() -> Option<Harness<'static, App>> {
    has_adapter().then(|| {
        let source = Source::BuiltIn("example1".to_owned());
        let builder = Harness::builder().with_size(Vec2::new(1280.0, 800.0)).wgpu();
        let mut harness = builder.build_eframe(|cc| App::new(cc, Some(source)));
        settle(&mut harness);
        harness
    })
}

/// Runs frames until the session has answered everything and the run is recorded.
fn settle(harness: &mut Harness<'static, App>) {
    let begin = Instant::now();
    loop {
        harness.run_steps(2);
        let state = &harness.state().state;
        if state.moment.is_some() && !state.is_busy() && state.recorded {
            break;
        }
        assert!(begin.elapsed() < Duration::from_secs(60), "the session does not answer: {:?}", state.faults);
        std::thread::sleep(Duration::from_millis(5));
    }
    harness.run_steps(2);
}

fn step(harness: &Harness<'static, App>) -> u64 {
    harness.state().state.moment.as_ref().unwrap().step
}

fn quads(harness: &Harness<'static, App>) -> u64 {
    harness.state().state.moment.as_ref().unwrap().standing
}

fn apply(harness: &mut Harness<'static, App>, command: Command) {
    harness.state_mut().apply(command);
    settle(harness);
}

fn press(harness: &mut Harness<'static, App>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    settle(harness);
}

#[test]
fn buttons_and_keys_step_forward_and_back() {
    let Some(mut harness) = window() else { return };
    assert_eq!(step(&harness), 0);
    harness.get_by_label("One operation on").click();
    settle(&mut harness);
    assert_eq!(step(&harness), 1);
    harness.get_by_label("One quadrilateral on").click();
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
    assert_eq!(step(&harness), state.track.len() as u64);
    assert!(state.moment.as_ref().unwrap().front.is_empty());
    press(&mut harness, Modifiers::NONE, Key::Home);
    assert_eq!(step(&harness), 0);
}

#[test]
fn a_parameter_changes_what_follows_and_nothing_before_and_undo_takes_it_back() {
    let Some(mut harness) = window() else { return };
    let kinds = |harness: &Harness<'static, App>| {
        harness.state().state.track.iter().map(|t| (t.kind, t.standing)).collect::<Vec<_>>()
    };
    let before = kinds(&harness);
    apply(&mut harness, Command::Go(Goal::Step(100)));
    harness.get_by_label("theta_rect").focus();
    harness.run_steps(2);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.run_steps(1);
    harness.get_by_label("theta_rect").type_text("115");
    harness.run_steps(1);
    harness.key_press(Key::Enter);
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
    let first = harness.state().state.track.iter().position(|t| t.kind == "rolled_back").unwrap() as u64 + 1;
    press(&mut harness, Modifiers::NONE, Key::F5);
    assert_eq!(step(&harness), first);
    press(&mut harness, Modifiers::NONE, Key::F5);
    assert!(step(&harness) > first);
    press(&mut harness, Modifiers::ALT, Key::F5);
    assert_eq!(step(&harness), first);
    apply(&mut harness, Command::AddBreakpoint("kind == rolled_bakc".to_owned()));
    assert!(harness.state().state.faults[0].contains("rolled_back"), "{:?}", harness.state().state.faults);
}

#[test]
fn a_segment_that_is_picked_in_the_table_is_explained_in_the_inspector() {
    let Some(mut harness) = window() else { return };
    apply(&mut harness, Command::Go(Goal::ToQuads(50)));
    let segment = harness.state().state.moment.as_ref().unwrap().front[3];
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
    let base = state.moment.as_ref().unwrap().phase.base().copied().unwrap();
    assert_eq!((base.a, base.b), (segment.a, segment.b), "the person's choice holds");
}

#[test]
fn a_run_that_is_saved_opens_with_its_changes() {
    let Some(mut harness) = window() else { return };
    apply(&mut harness, Command::Go(Goal::Step(60)));
    apply(&mut harness, Command::Set("c", "1.5".to_owned()));
    apply(&mut harness, Command::Bookmark);
    let kinds =
        |harness: &Harness<'static, App>| harness.state().state.track.iter().map(|t| t.kind).collect::<Vec<_>>();
    let before = kinds(&harness);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.toml");
    quadfront::core::io::run_file::write(&path, &harness.state().state.run().unwrap()).unwrap();
    apply(&mut harness, Command::Open(Source::File(path)));
    assert_eq!(kinds(&harness), before);
    let kept = &harness.state().state.kept;
    assert_eq!((kept.edits.len(), kept.bookmarks.as_slice()), (1, &[60][..]));
}

#[test]
fn the_palette_finds_a_command_by_its_name() {
    let Some(mut harness) = window() else { return };
    press(&mut harness, Modifiers::COMMAND, Key::P);
    harness.get_by_label("Name of a command").type_text("ten nonsense");
    harness.run_steps(2);
    harness.get_by_label("No command has these words.");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.query_by_label("Name of a command").is_none());
    press(&mut harness, Modifiers::COMMAND, Key::P);
    harness.get_by_label("Name of a command").type_text("10 quadrilaterals on");
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    settle(&mut harness);
    assert_eq!(quads(&harness), 10);
}

/// The share of pixels in which two pictures (four bytes a pixel) differ by more than a little.
fn difference(a: &[u8], b: &[u8]) -> f64 {
    assert_eq!(a.len(), b.len());
    let apart = |(a, b): (&[u8], &[u8])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 24);
    let count = a.chunks(4).zip(b.chunks(4)).filter(|pair| apart(*pair)).count();
    count as f64 / (a.len() / 4) as f64
}

#[test]
fn the_window_looks_the_same_however_one_came_to_a_step_and_other_at_another() {
    let Some(mut harness) = window() else { return };
    apply(&mut harness, Command::Go(Goal::Step(400)));
    let there = harness.render().unwrap().into_raw();
    apply(&mut harness, Command::Go(Goal::End));
    let end = harness.render().unwrap().into_raw();
    apply(&mut harness, Command::Go(Goal::Step(0)));
    apply(&mut harness, Command::Go(Goal::Step(400)));
    let again = harness.render().unwrap().into_raw();
    assert!(difference(&there, &again) < 0.002, "{}", difference(&there, &again));
    assert!(difference(&there, &end) > 0.05, "{}", difference(&there, &end));
    apply(&mut harness, Command::ToggleTheme);
    let light = harness.render().unwrap().into_raw();
    assert!(difference(&light, &again) > 0.5);
}

#[test]
fn a_file_that_is_not_there_is_a_message_and_the_window_goes_on() {
    let Some(mut harness) = window() else { return };
    harness.state_mut().apply(Command::Open(Source::named("no-such-case.toml")));
    let begin = Instant::now();
    while harness.state().state.faults.is_empty() {
        assert!(begin.elapsed() < Duration::from_secs(20));
        harness.run_steps(1);
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(harness.state().state.faults[0].contains("no-such-case.toml"));
    harness.run_steps(2);
    harness.get_by_label("Close").click();
    harness.run_steps(2);
    assert!(harness.state().state.faults.is_empty());
    apply(&mut harness, Command::Open(Source::named("example1")));
    assert_eq!(step(&harness), 0);
}
