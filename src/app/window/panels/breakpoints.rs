//! Conditions to stop at, and steps that a person has marked.

use eframe::egui::{Align, Key, Layout, ScrollArea, TextEdit, Ui};

use super::{icon_button, inset, note};
use crate::app::window::command::Command;
use crate::app::window::icons;
use crate::app::window::session::Goal;
use crate::app::window::state::State;
use crate::app::window::words;
use crate::render::palette::Palette;

/// Shows the breakpoints.
pub fn show(ui: &mut Ui, state: &mut State, commands: &mut Vec<Command>, palette: &Palette) {
    inset().show(ui, |ui| {
        let room = (ui.available_height() - 34.0).max(30.0);
        ScrollArea::vertical().max_height(room).auto_shrink([false, true]).show(ui, |ui| {
            if state.kept.breakpoints.is_empty() {
                ui.label(note("None yet. Try quad.min_angle < 30.", palette));
            }
            for (k, (text, on)) in state.kept.breakpoints.iter().enumerate() {
                ui.horizontal(|ui| {
                    let mut on = *on;
                    if ui.checkbox(&mut on, text).changed() {
                        commands.push(Command::SwitchBreakpoint(k));
                    }
                    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                        let command = Command::RemoveBreakpoint(k);
                        if icon_button(ui, icons::X, 13.0, &command, true).clicked() {
                            commands.push(command);
                        }
                        if let Some(hits) = state.hits.get(k) {
                            ui.label(note(words::grouped(*hits as u64), palette)).on_hover_text("Hits in this run");
                        }
                    });
                });
            }
        });
        let field = TextEdit::singleline(&mut state.breakpoint_field)
            .hint_text("a condition, e.g. kind == seamed")
            .desired_width(f32::INFINITY);
        let response = ui.add(field);
        response.widget_info(|| {
            eframe::egui::WidgetInfo::labeled(eframe::egui::Role::TextInput, true, "Condition of a new breakpoint")
        });
        if response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter)) {
            commands.push(Command::AddBreakpoint(std::mem::take(&mut state.breakpoint_field)));
        }
    });
}

/// Shows the bookmarks.
pub fn bookmarks(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    inset().show(ui, |ui| {
        if state.kept.bookmarks.is_empty() {
            ui.label(note("None yet. Ctrl+B marks the step at hand.", palette));
        }
        for step in &state.kept.bookmarks {
            if ui.button(format!("{}  step {}", icons::BOOKMARK, words::grouped(*step))).clicked() {
                commands.push(Command::Go(Goal::Step(*step)));
            }
        }
    });
}
