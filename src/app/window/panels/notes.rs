//! The notes of a case: open from the start for the small cases that show a figure of the paper.

use eframe::egui::text::LayoutJob;
use eframe::egui::{Align2, Context, Grid, Label, Rect, RichText, ScrollArea, Ui, Vec2, Window};

use crate::app::window::command::Command;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::words;
use crate::render::palette::Palette;

/// Shows the notes, if they are open; they start over the bottom of `place`.
pub fn show(context: &Context, place: Rect, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    let opened = state.run().opened.as_ref().filter(|_| state.view().notes);
    let Some(case) = opened.map(|opened| &opened.run.case) else { return };
    let mut open = true;
    Window::new("Notes")
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .default_width(304.0)
        .frame(super::floating(palette))
        .pivot(Align2::LEFT_BOTTOM)
        .default_pos(place.left_bottom() + Vec2::new(8.0, -8.0))
        .show(context, |ui| {
            ui.set_width(304.0);
            ui.label(RichText::new(&case.title).font(theme::semibold(theme::BODY)).color(ink(palette.strong)));
            ui.add_space(4.0);
            ScrollArea::vertical().max_height(220.0).show(ui, |ui| {
                for (number, paragraph) in case.notes.split("\n\n").enumerate() {
                    if paragraph.starts_with('|') {
                        table(ui, number, paragraph, palette);
                        continue;
                    }
                    // Lines are broken anew.
                    let text = paragraph.split_whitespace().collect::<Vec<_>>().join(" ");
                    let text = if text.is_empty() { "This case has no notes." } else { &text };
                    ui.add(Label::new(written(text, palette)).wrap());
                }
            });
        });
    if !open {
        commands.push(Command::Notes);
    }
}

/// A text of the notes, with symbols as the paper writes them.
fn written(text: &str, palette: &Palette) -> LayoutJob {
    theme::formula(&words::symbols(text), theme::BODY, ink(palette.text), ink(palette.strong))
}

/// A table, whose cells stand between bars.
fn table(ui: &mut Ui, number: usize, text: &str, palette: &Palette) {
    Grid::new(("table of the notes", number)).num_columns(4).striped(true).show(ui, |ui| {
        for line in text.lines() {
            for cell in line.trim_matches('|').split('|') {
                ui.label(written(cell.trim(), palette));
            }
            ui.end_row();
        }
    });
}
