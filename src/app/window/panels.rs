//! The panels. Each reads the state, keeps what is its own (a text that is being typed, a span, a drag), and returns
//! commands.

pub mod top;
pub mod legend;
pub mod time;
pub mod timeline;
pub mod front;
pub mod lists;
pub mod actions;
mod condition_field;
pub mod bookmarks;
pub mod breakpoints;
pub mod inspector;
pub mod history;
pub mod two_runs;
pub mod parameters;
pub mod layers;
pub mod plots;
pub mod messages;
pub mod notes;
pub mod figure;
pub mod import;
pub mod over;
pub mod study;
pub mod sweep;
pub mod presentation;

use std::sync::Arc;

use eframe::egui::{
    self, Align, AsIdSalt, Button, ComboBox, Frame, Galley, Margin, Painter, Response, RichText, Role, Ui, UiBuilder,
    WidgetInfo, WidgetText,
};

use super::command::Command;
use super::theme::{self, ink};
use crate::render::palette::{Palette, Rgba};
use crate::render::scene::Outlined;

/// What the panels keep for themselves.
#[derive(Default)]
pub struct PanelStates {
    pub time: time::TimeState,
    pub front: front::FrontState,
    pub lists: lists::ListStates,
    pub inspector: inspector::InspectorState,
    pub history: history::HistoryState,
    pub breakpoints: breakpoints::BreakpointsState,
    pub bookmarks: bookmarks::BookmarksState,
    pub parameters: parameters::ParametersState,
    pub plots: plots::PlotsState,
    pub figure: figure::PreviewState,
    pub over: over::OverState,
    pub sweep: sweep::SweepPanel,
    pub study: study::StudyPanel,
}

/// A button with an icon, its name for screen readers, and a tooltip with its key.
pub fn icon_button(ui: &mut Ui, icon: &str, size: f32, command: Command, enabled: bool, commands: &mut Vec<Command>) {
    let button = Button::new(RichText::new(icon).font(theme::regular(size))).frame_when_inactive(false);
    let response = ui.add_enabled(enabled, button);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, command.name()));
    on_click(&response.on_hover_text(command.tip()), command, commands);
}

/// A list to choose from, with its name for screen readers and the text that it shows.
pub fn choice<T: PartialEq + Copy, N: Into<WidgetText>>(
    ui: &mut Ui,
    name: &str,
    width: f32,
    shown: impl Into<WidgetText>,
    value: &mut T,
    all: impl IntoIterator<Item = (T, N)>,
) {
    let list = ComboBox::from_id_salt(name).selected_text(shown).width(width).show_ui(ui, |ui| {
        for (one, text) in all {
            ui.selectable_value(value, one, text.into());
        }
    });
    list.response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, name));
}

/// Asks for a command when a widget is clicked.
pub fn on_click(response: &Response, command: Command, commands: &mut Vec<Command>) {
    if response.clicked() {
        commands.push(command);
    }
}

/// A part of a panel with ids of its own, by its name within the panel. An automatic id counts the widgets before it,
/// and only what is pressed and released under one id is clicked: so what follows content that changes by itself, such
/// as the progress of a work, is such a part.
pub fn part<R>(ui: &mut Ui, name: impl AsIdSalt, show: impl FnOnce(&mut Ui) -> R) -> R {
    let id = ui.scope_id().with(("part", name));
    ui.scope_builder(UiBuilder::new().scope_id(id), show).inner
}

/// A widget that stands for something: points at it, and selects it when it is clicked.
pub fn stands_for(response: &Response, what: Outlined, commands: &mut Vec<Command>) {
    if response.hovered() {
        commands.push(Command::Hover(what));
    }
    on_click(response, Command::Pick(Some(what)), commands);
}

/// The heading of a section, with its source at the right.
pub fn heading(ui: &mut Ui, title: &str, source: &str, palette: &Palette) {
    ui.add_space(8.0);
    let width = ui.max_rect().width();
    ui.horizontal(|ui| {
        // What follows may be wider than the panel; headings are not.
        ui.set_max_width(width);
        ui.label(RichText::new(title).font(theme::semibold(theme::BODY)).color(ink(palette.strong)));
        ui.with_layout(egui::Layout::right_to_left(Align::Center), |ui| {
            ui.label(RichText::new(source).font(theme::regular(theme::HEAD)).color(ink(palette.weak)));
        });
    });
}

/// The frame of a small window over the view.
pub fn floating(palette: &Palette) -> Frame {
    Frame::NONE.fill(ink(palette.panel)).stroke((1.0, ink(palette.hint))).corner_radius(4.0).inner_margin(12)
}

/// The inside of a panel.
pub fn inset() -> Frame {
    Frame::NONE.inner_margin(Margin::symmetric(14, 8))
}

/// A sentence in so many lines, in the first of some font sizes in which it fits, and shortened in the last one where
/// it fits in none.
pub fn in_lines(
    painter: &Painter,
    text: &str,
    width: f32,
    lines: usize,
    sizes: &[f32],
    palette: &Palette,
) -> Arc<Galley> {
    let lay = |size: &f32| {
        let mut job = theme::formula(text, *size, ink(palette.text), ink(palette.strong));
        (job.wrap.max_width, job.wrap.max_rows) = (width.max(1.0), lines);
        painter.layout_job(job)
    };
    let [first, rest @ ..] = sizes else { return lay(&theme::TABLE) };
    let mut laid = lay(first);
    for size in rest {
        if laid.elided {
            laid = lay(size);
        }
    }
    laid
}

/// Weak text, for units and notes.
pub fn note(text: impl Into<String>, palette: &Palette) -> RichText {
    line(text, palette.weak)
}

/// Text of a table or a list.
pub fn line(text: impl Into<String>, colour: Rgba) -> RichText {
    RichText::new(text).font(theme::regular(theme::TABLE)).color(ink(colour))
}
