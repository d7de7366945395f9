//! What all tests of the window share: a window on a graphics adapter, and frames until it has done what was asked.
//!
//! Mesa's lavapipe is adapter enough. Without any, the tests are skipped with the reason; where
//! `QUADFRONT_NEEDS_ADAPTER` is set, its absence is a failure.

use std::time::{Duration, Instant};

use eframe::CreationContext;
use eframe::egui::{Key, Modifiers, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use quadfront::app::window::{App, Command};

/// The size of a small laptop's screen, in points.
pub const LAPTOP: Vec2 = Vec2::new(1280.0, 800.0);
/// How long a test waits for anything.
const PATIENCE: Duration = Duration::from_secs(60);

/// A window under test.
pub type Window = Harness<'static, App>;

pub fn has_adapter() -> bool {
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

/// A window of a size in points, after its first frames.
pub fn start(size: Vec2, make: impl FnOnce(&CreationContext<'_>) -> App) -> Window {
    let mut window = Harness::builder().with_size(size).wgpu().build_eframe(|cc| make(cc));
    window.run_steps(2);
    window
}

/// Runs frames until something holds.
pub fn until(window: &mut Window, what: &str, holds: impl Fn(&Window) -> bool) {
    let begin = Instant::now();
    while !holds(window) {
        window.run_steps(1);
        let faults = &window.state().state.view().faults;
        assert!(begin.elapsed() < PATIENCE, "waited in vain until {what}: {faults:?}");
        std::thread::sleep(Duration::from_millis(5));
    }
    window.run_steps(2);
}

/// Runs frames until there is a run, the session has answered everything and all of the run is recorded.
pub fn settle(window: &mut Window) {
    window.run_steps(2);
    until(window, "the run is recorded", |window| {
        let state = &window.state().state;
        state.run().import.is_none() && state.run().moment.is_some() && !state.run().is_busy() && state.run().recorded
    });
}

/// Does what a person asks for, and waits for all that comes of it.
pub fn apply(window: &mut Window, command: Command) {
    window.state_mut().apply(command);
    settle(window);
}

/// Types a text into a field in place of what is there, and Enter.
pub fn type_over(window: &mut Window, field: &str, text: &str) {
    window.get_by_label(field).focus();
    window.run_steps(2);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.run_steps(1);
    window.get_by_label(field).type_text(text);
    window.run_steps(1);
    window.key_press(Key::Enter);
    window.run_steps(2);
}
