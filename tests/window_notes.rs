//! Promise: a bookmark takes a note while one types, the note is kept in the run and undone as one change, and all of
//! them are exported as one page.
//!
//! Needs a graphics adapter (see `window_harness`).
#![allow(clippy::unwrap_used)]

mod window_harness;

use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use quadfront::app::window::{App, Command, Goal, Source};
use window_harness::{LAPTOP, apply, has_adapter, settle, start, until};

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
    let notes = |harness: &window_harness::Window| -> Vec<(u64, String)> {
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
