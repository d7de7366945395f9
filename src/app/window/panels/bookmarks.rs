//! Bookmarked steps with their notes.

use eframe::egui::{Align, Label, Layout, Response, RichText, Role, ScrollArea, TextEdit, Ui, WidgetInfo};

use super::{icon_button, inset, note, on_click};
use crate::app::window::command::Command;
use crate::app::window::icons;
use crate::app::window::session::Goal;
use crate::app::window::state::State;
use crate::app::window::theme;
use crate::app::window::words;
use crate::core::run::Bookmark;
use crate::render::palette::Palette;

/// What the panel keeps for itself.
#[derive(Default)]
pub struct BookmarksState {
    /// The last request to write a note that was carried out.
    asked: u64,
}

/// Shows the bookmarks.
pub fn show(ui: &mut Ui, state: &State, local: &mut BookmarksState, commands: &mut Vec<Command>, palette: &Palette) {
    inset().show(ui, |ui| {
        let marks = &state.document().bookmarks;
        if marks.is_empty() {
            let text = "None yet. Ctrl+B bookmarks the current step, Ctrl+Shift+B writes a note on it, and all of them can be \
                        exported as one page with a figure of each step.";
            ui.add(Label::new(note(text, palette)).wrap());
            return;
        }
        let written = state.view().note.take(&mut local.asked);
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for mark in marks {
                let note = bookmark(ui, state, mark, commands, palette);
                if written == Some(mark.step) {
                    note.request_focus();
                    note.scroll_to_me(Some(Align::Center));
                }
            }
            ui.add_space(4.0);
            on_click(&ui.button(Command::ExportNotes.name()), Command::ExportNotes, commands);
        });
    });
}

/// Shows a bookmark. Returns the field of its note.
fn bookmark(ui: &mut Ui, state: &State, mark: &Bookmark, commands: &mut Vec<Command>, palette: &Palette) -> Response {
    let step = mark.step;
    let tracked = step.checked_sub(1).and_then(|k| state.run().track.get(k as usize));
    let what = tracked.map_or_else(String::new, |tracked| words::kind(tracked.kind));
    ui.horizontal(|ui| {
        let text = RichText::new(format!("{}  step {}", icons::BOOKMARK, words::grouped(step)));
        let response = ui.button(text).on_hover_text("Go to that step");
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Go to step {step}")));
        on_click(&response, Command::Go(Goal::Step(step)), commands);
        ui.label(note(what, palette));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            icon_button(ui, icons::X, 13.0, Command::RemoveBookmark(step), true, commands);
        });
    });
    let mut text = mark.note.clone();
    let field = TextEdit::multiline(&mut text)
        .id_salt(("note", step))
        .hint_text("A note (Markdown)")
        .desired_rows(1)
        .font(theme::regular(theme::TABLE))
        .desired_width(f32::INFINITY);
    let response = ui.add(field);
    response.widget_info(|| WidgetInfo::labeled(Role::MultilineTextInput, true, format!("Note on step {step}")));
    if response.changed() {
        commands.push(Command::WriteNote(step, text));
    }
    ui.add_space(6.0);
    response
}
