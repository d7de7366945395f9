//! The legend of the view's lines, in the bar above it.

use eframe::egui::{Align2, Rect, Sense, Ui, Vec2};

use super::icon_button;
use crate::app::window::command::Command;
use crate::app::window::icons;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::render::palette::{Palette, Rgba};

/// Shows the legend, from the right: buttons first; `kept` points are left free for the tabs.
pub fn show(ui: &mut Ui, kept: f32, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    ui.spacing_mut().item_spacing.x = 4.0;
    for (icon, command) in [(icons::CORNERS_OUT, Command::Fit), (icons::CROSSHAIR, Command::ShowDecision)] {
        icon_button(ui, icon, theme::ICON, command, state.run().moment.is_some(), commands);
    }
    layers(ui, state, commands, palette);
    ui.add_space(4.0);
    let entries: [(Rgba, f32, &str); 7] = [
        (palette.base, 5.0, "base"),
        (palette.side, 3.2, "sides, top"),
        (palette.front[0], 3.2, "class 1"),
        (palette.front[1], 3.0, "2"),
        (palette.front[2], 3.0, "3"),
        (palette.front[3], 2.4, "4"),
        (palette.changed_edge, 2.5, "last change"),
    ];
    let font = theme::regular(theme::HEAD);
    let texts = entries.map(|entry| ui.painter().layout_no_wrap(entry.2.to_owned(), font.clone(), ink(palette.weak)));
    // As many as there is room for; they are laid out from the right.
    let mut room = ui.available_width() - kept;
    let count = texts
        .iter()
        .take_while(|text| {
            room -= text.size().x + 32.0;
            room >= 0.0
        })
        .count();
    for ((colour, width, _), text) in entries.into_iter().zip(texts).take(count).collect::<Vec<_>>().into_iter().rev() {
        let wanted = Vec2::new(text.size().x + 28.0, ui.available_height());
        let (rect, _) = ui.allocate_exact_size(wanted, Sense::hover());
        let swatch = Rect::from_center_size(rect.left_center() + Vec2::new(9.0, 0.0), Vec2::new(14.0, width));
        ui.painter().rect_filled(swatch, 0.5 * width, ink(colour));
        let at = Align2::LEFT_CENTER.anchor_size(rect.left_center() + Vec2::new(20.0, 0.0), text.size()).min;
        ui.painter().galley(at, text, ink(palette.weak));
    }
}

fn layers(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    let button = eframe::egui::RichText::new(icons::STACK).font(theme::regular(theme::ICON));
    let shown = ui.menu_button(button, |ui| super::layers::list(ui, state, commands, palette));
    let response = shown.response.on_hover_text("Layers and colours");
    response.widget_info(|| eframe::egui::WidgetInfo::labeled(eframe::egui::Role::Button, true, "Layers and colours"));
}
