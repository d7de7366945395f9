//! Faults, which stay until they are closed, notices, which go by themselves, and the offer to recover an autosaved
//! run. Never modal.

use eframe::egui::{Frame, Margin, Panel, RichText, Ui};

use super::on_click;
use crate::app::window::command::Command;
use crate::app::window::icons;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::render::palette::Palette;

/// Shows the messages above the transport.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    if state.view().faults.is_empty() && state.view().notice().is_none() {
        return;
    }
    let frame = Frame::NONE.fill(ink(palette.panel)).inner_margin(Margin::symmetric(14, 5));
    Panel::bottom("messages").frame(frame).resizable(false).show(ui, |ui| {
        for (k, fault) in state.view().faults.iter().enumerate() {
            ui.horizontal(|ui| {
                ui.label(RichText::new(icons::X_CIRCLE).font(theme::regular(theme::ICON)).color(ink(palette.broken)));
                on_click(&ui.small_button("Close"), Command::CloseFault(k), commands);
                ui.add(eframe::egui::Label::new(RichText::new(fault).color(ink(palette.strong))).wrap());
            });
        }
        if let Some((text, _)) = state.view().notice() {
            ui.label(RichText::new(text).color(ink(palette.text)));
        }
    });
}

/// Shows the offer under the menus.
pub fn offer(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    let Some((offer, more)) = state.run().autosave.as_ref().and_then(|autosave| autosave.offer()) else { return };
    let frame = Frame::NONE.fill(ink(palette.button)).inner_margin(Margin::symmetric(14, 5));
    Panel::top("offer").frame(frame).resizable(false).show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            ui.label(RichText::new(icons::RESET).font(theme::regular(theme::ICON)).color(ink(palette.accent)));
            ui.label(RichText::new(&offer.text).color(ink(palette.strong)));
            if offer.opens && ui.button("Recover").clicked() {
                commands.push(Command::OpenKept);
            }
            on_click(&ui.button("Discard"), Command::DiscardKept, commands);
            if more > 0 {
                ui.label(RichText::new(format!("and {more} more")).color(ink(palette.weak)));
            }
        });
    });
}
