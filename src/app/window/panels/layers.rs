//! What is drawn, and what elements are coloured by.

use eframe::egui::{ScrollArea, Ui};

use super::{heading, inset, legend, note, on_click};
use crate::app::window::command::Command;
use crate::app::window::state::State;
use crate::app::window::view_layer::ViewLayer;
use crate::render::palette::Palette;
use crate::render::scene::ColourBy;

/// Shows the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        inset().show(ui, |ui| {
            list(ui, state, commands, palette);
            heading(ui, "Classes of front segments", "table 1", palette);
            legend::table(ui, state, palette);
        });
    });
}

/// Check boxes for layers, buttons for colours.
pub fn list(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    for (digit, layer) in (1..).zip(ViewLayer::ALL) {
        let mut on = layer.is_on(state.document().layers);
        ui.horizontal(|ui| {
            if ui.checkbox(&mut on, layer.name()).changed() {
                commands.push(Command::Layer(layer));
            }
            ui.label(note(format!("{digit}"), palette));
            if layer == ViewLayer::MetricEllipses {
                ui.label(note("at a quarter of their size", palette));
            }
        });
    }
    heading(ui, "Colour by", "", palette);
    for by in ColourBy::ALL {
        on_click(&ui.radio(state.document().colour_by == by, by.name()), Command::ColourBy(by), commands);
    }
}
