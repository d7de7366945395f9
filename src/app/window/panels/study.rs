//! A lesson or a prediction in the whole window: what is told, what is seen, and what rule is at work; below, a
//! sentence for the step at hand.

mod told;
mod card;
mod rule;
mod strip;

use eframe::egui::{CentralPanel, Frame, Layout, Panel, Rect, RichText, ScrollArea, Ui, UiBuilder, Vec2};

use super::{inset, legend};
use crate::app::window::command::Command;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::viewport::Views;
use crate::render::palette::Palette;

/// The widths of what is told and of the rule at work in points, most and least, and their shares of the window.
const TOLD: [f32; 2] = [420.0, 320.0];
const RULE: [f32; 2] = [400.0, 270.0];
const SHARES: [f32; 2] = [0.2625, 0.25];
/// The height of the bar above the view, and of the strip below everything.
const BAR: f32 = 28.0;
const STRIP: f32 = 92.0;
/// The size of the text of a lesson.
const TEXT: f32 = 15.0;

/// What the panel keeps for itself.
#[derive(Default)]
pub struct StudyPanel {
    /// The answer that is being typed, and the step of its question.
    typed: (u64, String),
    /// The run and the step whose decision was brought into view.
    seen: (u64, u64),
}

/// Shows it.
pub fn show(
    ui: &mut Ui,
    state: &State,
    views: &mut Views,
    local: &mut StudyPanel,
    commands: &mut Vec<Command>,
    palette: &'static Palette,
) {
    let plain = Frame::NONE.fill(ink(palette.panel));
    let all = ui.available_width();
    let width = |share: f32, [most, least]: [f32; 2]| (share * all).clamp(least, most).floor();
    let frame = |name: &'static str| Panel::bottom(name).frame(plain).resizable(false);
    frame("sentence of a lesson").exact_size(STRIP).show(ui, |ui| strip::show(ui, state, commands, palette));
    let side = Panel::left("told in a lesson").frame(plain).resizable(false).exact_size(width(SHARES[0], TOLD));
    side.show(ui, |ui| {
        // What is asked stays at the bottom, however long the text is.
        Panel::bottom("question of a lesson").frame(Frame::NONE).resizable(false).show(ui, |ui| {
            inset().show(ui, |ui| card::show(ui, state, local, commands, palette));
        });
        CentralPanel::default().frame(Frame::NONE).show(ui, |ui| {
            let room = ui.available_height();
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                inset().show(ui, |ui| told::show(ui, room, state, local, commands, palette));
            });
        });
    });
    let side = Panel::right("rule of a lesson").frame(plain).resizable(false).exact_size(width(SHARES[1], RULE));
    side.show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            inset().show(ui, |ui| rule::show(ui, state, commands, palette));
        });
    });
    CentralPanel::default().frame(plain).show(ui, |ui| {
        let rect = ui.max_rect();
        let (bar, view) = rect.split_top_bottom_at_y(rect.top() + BAR);
        ui.painter().hline(rect.x_range(), bar.bottom() - 0.5, (1.0, ink(palette.line)));
        let right = UiBuilder::new().max_rect(bar).layout(Layout::right_to_left(eframe::egui::Align::Center));
        ui.scope_builder(right, |ui| legend::show(ui, 0.0, state, commands, palette));
        ui.scope_builder(UiBuilder::new().max_rect(view), |ui| views.space(ui, state, commands, palette));
        ui.advance_cursor_after_rect(rect);
    });
}

/// A heading of a column, with what it is about at the right.
fn heading(ui: &mut Ui, title: &str, about: &str, palette: &Palette) {
    ui.add_space(12.0);
    let room = Rect::from_min_size(ui.cursor().min, Vec2::new(ui.available_width(), 20.0));
    ui.scope_builder(UiBuilder::new().max_rect(room), |ui| {
        ui.horizontal(|ui| {
            ui.label(RichText::new(title).font(theme::semibold(14.0)).color(ink(palette.strong)));
            ui.with_layout(Layout::right_to_left(eframe::egui::Align::Center), |ui| {
                ui.label(super::note(about, palette));
            });
        });
    });
    ui.add_space(2.0);
}
