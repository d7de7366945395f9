//! The last step: what it did and looked at; what is done of the quadrilateral under way; what comes next.

use eframe::egui::Ui;

use super::past::step_link;
use super::{note, section, sentence};
use crate::app::window::command::Command;
use crate::app::window::session::Moment;
use crate::app::window::words;
use crate::render::palette::Palette;

/// How many steps of the quadrilateral under way are listed, at most.
const LISTED: usize = 12;

/// The last step, and why it did what it did.
pub fn show(ui: &mut Ui, moment: &Moment, palette: &Palette) {
    let Some(event) = &moment.event else { return };
    if !section(ui, "Last step", &format!("step {}", words::grouped(moment.step)), palette) {
        return;
    }
    sentence(ui, &format!("{}.", words::capital(&words::event(event))), palette.text, palette);
    for text in &moment.about {
        sentence(ui, text, palette.weak, palette);
    }
}

/// The steps since the selection of the base under way, the latest first.
pub fn so_far(ui: &mut Ui, moment: &Moment, commands: &mut Vec<Command>, palette: &Palette) {
    if !section(ui, "This quadrilateral so far", "4.3.4", palette) {
        return;
    }
    for (step, event) in moment.so_far.iter().rev().take(LISTED) {
        step_link(ui, *step, &words::event(event), commands, palette);
    }
    if moment.so_far.len() > LISTED {
        let more = words::counted((moment.so_far.len() - LISTED) as u64, "step");
        ui.label(note(format!("and {more} before these"), palette));
    }
}

/// What comes next.
pub fn next(ui: &mut Ui, moment: &Moment, palette: &Palette) {
    if section(ui, "Next step", "Ctrl+Right", palette) {
        sentence(ui, &moment.next, palette.text, palette);
    }
}
