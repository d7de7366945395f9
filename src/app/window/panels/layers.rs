//! What is drawn, and what elements are coloured by.

use eframe::egui::{ScrollArea, Ui};

use super::{heading, inset, note};
use crate::app::window::apply::layer;
use crate::app::window::command::{Command, LAYERS};
use crate::app::window::state::State;
use crate::render::palette::Palette;
use crate::render::scene::ColourBy;

/// Shows the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    ScrollArea::vertical().show(ui, |ui| inset().show(ui, |ui| list(ui, state, commands, palette)));
}

/// Check boxes for layers, buttons for colours.
pub fn list(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    for (k, name) in LAYERS.iter().enumerate() {
        let mut layers = state.kept.layers;
        ui.horizontal(|ui| {
            if ui.checkbox(layer(&mut layers, k), *name).changed() {
                commands.push(Command::Layer(k));
            }
            ui.label(note(format!("{}", k + 1), palette));
            if k == 7 {
                ui.label(note("at a quarter of their size", palette));
            }
        });
    }
    heading(ui, "Colour by", "", palette);
    for by in ColourBy::ALL {
        if ui.radio(state.kept.colour_by == by, by.name()).clicked() {
            commands.push(Command::ColourBy(by));
        }
    }
}
