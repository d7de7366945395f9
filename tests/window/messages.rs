//! Messages, and panels that are opened and closed, move no splitter; a restart finds the splitters where they were.

use std::path::Path;
use std::time::Duration;

use eframe::egui::{Pos2, Role, Vec2};
use egui_kittest::kittest::Queryable;
use quadfront::app::window::{App, Command, Lost, Source};

use super::window_harness::{Window, apply, has_adapter, settle, start};

/// Sizes of windows, in points.
pub const SIZES: [Vec2; 3] = [Vec2::new(1280.0, 800.0), Vec2::new(1600.0, 1000.0), Vec2::new(1920.0, 1080.0)];

/// The first tabs of all docks, and others.
const FIRST: [&str; 5] = ["Front", "Breakpoints", "Space", "Inspector", "Parameters"];
const OTHERS: [&str; 5] = ["Bookmarks", "Quality", "Parametric", "History", "Layers"];

fn window(size: Vec2, settings: &Path) -> Window {
    let path = settings.to_path_buf();
    let source = Source::BuiltIn("example1".to_owned());
    let mut harness = start(size, |cc| App::kept(cc, Some(source), Some(path), Lost::default()));
    settle(&mut harness);
    harness
}

/// Where the docks and the timeline begin.
fn splitters(harness: &Window) -> Vec<Pos2> {
    let tabs = FIRST.iter().map(|tab| harness.get_by_role_and_label(Role::Tab, tab).rect());
    tabs.chain([harness.get_by_label_contains("Timeline: step").rect()]).map(|rect| rect.left_top()).collect()
}

fn click(harness: &mut Window, tabs: &[&str]) {
    for tab in tabs {
        harness.get_by_role_and_label(Role::Tab, tab).click();
        harness.run_steps(2);
    }
}

fn nothing_moves(size: Vec2) {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("window.json");
    let mut harness = window(size, &path);
    let before = splitters(&harness);
    for number in 0..50 {
        harness.state_mut().apply(Command::GoToText(format!("nowhere {number}")));
        harness.run_steps(2);
        assert_eq!(splitters(&harness), before);
        // One message is shown.
        assert_eq!(harness.query_all_by_label_contains("names nothing that can be found").count(), 1);
        if number % 2 == 1 {
            harness.get_by_label("Close").click();
            harness.run_steps(2);
        }
    }
    apply(&mut harness, Command::Messages);
    harness.run_steps(2);
    assert_eq!(harness.query_all_by_label_contains("nowhere").count(), 51, "the log has all of them");
    apply(&mut harness, Command::Messages);
    (0..25).for_each(|_| harness.state_mut().apply(Command::CloseFault(0)));
    click(&mut harness, &OTHERS);
    click(&mut harness, &FIRST);
    for command in [Command::Notes, Command::Figures, Command::Palette, Command::Help, Command::GoTo, Command::OpenPath]
    {
        for _ in 0..2 {
            apply(&mut harness, command.clone());
            assert_eq!(splitters(&harness), before, "{command:?}");
        }
    }
    // A window that was smaller for a while.
    for other in [Vec2::new(1270.0, 700.0), Vec2::new(1111.0, 777.0), size] {
        harness.set_size(other);
        harness.run_steps(3);
    }
    assert_eq!(splitters(&harness), before);
    // The settings are written a moment after the last change.
    std::thread::sleep(Duration::from_millis(1600));
    harness.run_steps(2);
    drop(harness);
    assert!(path.exists());
    assert_eq!(splitters(&window(size, &path)), before, "after a restart");
}

#[test]
fn nothing_moves_the_splitters_of_a_small_window() {
    nothing_moves(SIZES[0]);
}

#[test]
fn nothing_moves_the_splitters_of_a_window() {
    nothing_moves(SIZES[1]);
}

#[test]
fn nothing_moves_the_splitters_of_a_large_window() {
    nothing_moves(SIZES[2]);
}
