//! The steps around the current one, and the changes of the user.

use eframe::egui::{ScrollArea, Ui};

use super::{heading, inset, line, note, on_click};
use crate::app::window::command::Command;
use crate::app::window::session::Goal;
use crate::app::window::state::State;
use crate::app::window::words;
use crate::core::run::EditKind;
use crate::render::palette::Palette;

/// Shows the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    let Some(moment) = &state.run().moment else { return };
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        inset().show(ui, |ui| {
            heading(ui, "Changes of this run", "", palette);
            if state.document().edits.is_empty() {
                ui.label(note("None: the run has the parameters of the case.", palette));
            }
            for edit in &state.document().edits {
                let what = match &edit.kind {
                    EditKind::Parameter { key, value } => format!("{key} = {value}"),
                    EditKind::Base { a, b } => format!("base {}", words::segment([*a, *b])),
                };
                let button = ui.button(format!("from step {}: {what}", words::grouped(edit.step)));
                on_click(&button, Command::Go(Goal::Step(edit.step)), commands);
            }
            heading(ui, "Steps around this one", "", palette);
            let now = moment.step as usize;
            for k in (now.saturating_sub(20)..(now + 8).min(state.run().track.len())).rev() {
                let tracked = &state.run().track[k];
                let text = format!("{}   {}", words::grouped(k as u64 + 1), words::kind(tracked.kind));
                let colour = if k + 1 == now {
                    palette.accent
                } else if k + 1 < now {
                    palette.text
                } else {
                    palette.hint
                };
                on_click(
                    &ui.selectable_label(false, line(text, colour)),
                    Command::Go(Goal::Step(k as u64 + 1)),
                    commands,
                );
            }
        });
    });
}
