//! Faults, which stay until they are closed, and what was done, for a while. Never modal.

use eframe::egui::{Frame, Margin, Panel, RichText, Ui};

use crate::app::window::icons;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::render::palette::Palette;

/// Shows what there is to be said, above the transport.
pub fn show(ui: &mut Ui, state: &mut State, palette: &Palette) {
    if state.faults.is_empty() && state.notice.is_none() {
        return;
    }
    let frame = Frame::NONE.fill(ink(palette.panel)).inner_margin(Margin::symmetric(14, 5));
    Panel::bottom("messages").frame(frame).resizable(false).show(ui, |ui| {
        let mut closed = None;
        for (k, fault) in state.faults.iter().enumerate() {
            ui.horizontal(|ui| {
                ui.label(RichText::new(icons::X_CIRCLE).font(theme::regular(theme::ICON)).color(ink(palette.broken)));
                if ui.small_button("Close").clicked() {
                    closed = Some(k);
                }
                ui.add(eframe::egui::Label::new(RichText::new(fault).color(ink(palette.strong))).wrap());
            });
        }
        if let Some(k) = closed {
            state.faults.remove(k);
        }
        if let Some((text, _)) = &state.notice {
            ui.label(RichText::new(text).color(ink(palette.text)));
        }
    });
}
