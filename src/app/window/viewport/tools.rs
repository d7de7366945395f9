//! Buttons over a view of surfaces: space, plane or both, standard views, hidden lines, curved elements.

use eframe::egui::{Align, Frame, Layout, Margin, Rect, RichText, Role, Ui, UiBuilder, Vec2, WidgetInfo};

use crate::app::window::command::Command;
use crate::app::window::panels::on_click;
use crate::app::window::session::Moment;
use crate::app::window::state::{State, SurfaceView};
use crate::app::window::theme::{self, ink};
use crate::render::camera::Bearing;
use crate::render::look::HiddenLines;
use crate::render::palette::Palette;

/// Shows the buttons in the upper right corner.
pub(super) fn show(ui: &mut Ui, rect: Rect, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    corner(ui, rect, palette, |ui, width| {
        // From the right.
        let place = state.workspace().surfaces.view;
        for (shown, text) in [(SurfaceView::Plane, "Plane"), (SurfaceView::Both, "Both"), (SurfaceView::Space, "Space")]
        {
            button(ui, place == shown, text, Command::SurfaceView(shown), commands);
        }
        if place == SurfaceView::Plane || width < 380.0 {
            return;
        }
        ui.separator();
        hidden(ui, state, commands);
        button(ui, state.workspace().surfaces.curved, "Curved", Command::ToggleCurved, commands);
        ui.separator();
        sides(ui, commands);
    });
}

/// The buttons for a mesh that is about to be converted.
pub(super) fn show_sides(ui: &mut Ui, rect: Rect, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    corner(ui, rect, palette, |ui, _| {
        hidden(ui, state, commands);
        ui.separator();
        sides(ui, commands);
    });
}

/// Where the buttons may stand in a view of a mesh, if it has any: no label does.
pub fn area(rect: Rect, moment: &Moment) -> Option<Rect> {
    moment.mesh.embedding().map(|_| rect.with_max_y(rect.top() + 38.0))
}

fn corner(ui: &mut Ui, rect: Rect, palette: &Palette, buttons: impl FnOnce(&mut Ui, f32)) {
    let corner = Rect::from_min_max(rect.min + Vec2::new(8.0, 8.0), rect.right_top() + Vec2::new(-8.0, 36.0));
    if corner.width() < 120.0 || rect.height() < 80.0 {
        return;
    }
    ui.scope_builder(UiBuilder::new().max_rect(corner).layout(Layout::right_to_left(Align::Min)), |ui| {
        let plate = Frame::NONE.fill(ink(palette.ground)).corner_radius(4.0).inner_margin(Margin::symmetric(4, 2));
        plate.show(ui, |ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            buttons(ui, corner.width());
        });
    });
}

fn button(ui: &mut Ui, on: bool, text: &str, command: Command, commands: &mut Vec<Command>) {
    let response = ui.selectable_label(on, RichText::new(text).font(theme::regular(theme::HEAD)));
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, on, command.name()));
    on_click(&response.on_hover_text(command.tip()), command, commands);
}

fn hidden(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let hidden = state.workspace().surfaces.hidden;
    let text = format!("Hidden {}", hidden.name());
    button(ui, hidden != HiddenLines::Off, &text, Command::HiddenLines, commands);
}

fn sides(ui: &mut Ui, commands: &mut Vec<Command>) {
    for (side, text) in [(Bearing::Z, "Z"), (Bearing::Y, "Y"), (Bearing::X, "X"), (Bearing::Iso, "Iso")] {
        button(ui, false, text, Command::LookFrom(side), commands);
    }
}
