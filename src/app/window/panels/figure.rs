//! The panel for figures: what they show, their look and their size.

mod film;
mod preview;

use std::path::Path;

use eframe::egui::{
    self, Align, Align2, Context, DragValue, Grid, Label, Layout, RichText, ScrollArea, TextEdit, Ui, Vec2, WidgetInfo,
    Window,
};

pub use preview::PreviewState;

use super::{choice, note, on_click};
use crate::app::figure::LINE_SCALES;
use crate::app::window::command::Command;
use crate::app::window::figures::{self, Content, Formats};
use crate::app::window::state::State;
use crate::app::window::theme::ink;
use crate::core::formats::save;
use crate::render::look::{Ink, Layer};
use crate::render::palette::Palette;

/// A window of at least this width has room for the preview beside the form.
const ROOMY: f32 = 760.0;

/// Shows the panel over the view, if it is open. A film belongs to the window, and what is drawn is the run that the
/// panels show.
pub fn show(
    context: &Context,
    window: &State,
    local: &mut PreviewState,
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    let state = window.active();
    if !state.view().figure_panel {
        return;
    }
    let mut open = true;
    Window::new("Figure")
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .default_width(620.0)
        .frame(super::floating(palette))
        // Messages come at the bottom of the views.
        .pivot(Align2::CENTER_TOP)
        .default_pos(context.content_rect().center_top() + Vec2::new(0.0, 44.0))
        .show(context, |ui| {
            let columns = if context.content_rect().width() > ROOMY {
                Layout::left_to_right(Align::Min)
            } else {
                Layout::top_down(Align::Min)
            };
            // As high as its content, where there is room for that.
            let room = context.content_rect().height() - 140.0;
            ScrollArea::vertical().max_height(room).min_scrolled_height(room).show(ui, |ui| {
                ui.with_layout(columns, |ui| {
                    local.show(ui, state, palette);
                    ui.add_space(10.0);
                    ui.vertical(|ui| form(ui, window, commands, palette));
                });
            });
        });
    if !open {
        commands.push(Command::Figures);
    }
}

/// A text field with its name for screen readers.
fn field(ui: &mut Ui, text: &mut String, name: &str, hint: &str) {
    let response = ui.add(TextEdit::singleline(text).hint_text(hint).desired_width(190.0));
    response.widget_info(|| WidgetInfo::labeled(egui::Role::TextInput, true, name));
}

fn radios<T: PartialEq, const N: usize>(ui: &mut Ui, value: &mut T, all: [(T, &str); N]) {
    ui.horizontal(|ui| {
        for (one, text) in all {
            ui.radio_value(value, one, text);
        }
    });
}

fn form(ui: &mut Ui, window: &State, commands: &mut Vec<Command>, palette: &Palette) {
    let state = window.active();
    let mut figure = state.workspace().figure.clone();
    let is_film = figure.content == Content::Film;
    Grid::new("figure").num_columns(2).spacing(Vec2::new(12.0, 6.0)).show(ui, |ui| {
        let mut row = |name: &str, widgets: &mut dyn FnMut(&mut Ui)| {
            ui.label(RichText::new(name).color(ink(palette.weak)));
            widgets(ui);
            ui.end_row();
        };
        let all = Content::ALL.map(|content| (content, content.name()));
        row("shows", &mut |ui| {
            choice(ui, "What the figure shows", 196.0, figure.content.name(), &mut figure.content, all);
        });
        if figure.content == Content::Stops {
            row("NQ", &mut |ui| field(ui, &mut figure.stops, "NQ of the strip", "50,100,150,end"));
        }
        if is_film {
            film::rows(&mut figure.film, &mut row);
        }
        let usual = if figure.is_strip() { "174mm" } else { "84mm" };
        let hint = if is_film { "800, or 1280x720".to_owned() } else { format!("{usual}, or 1920x1080") };
        row("size", &mut |ui| field(ui, &mut figure.size, "Size of the figure", &hint));
        if !is_film {
            row("resolution (dpi)", &mut |ui| {
                let dots = ui.add(DragValue::new(&mut figure.dpi).range(10.0..=2400.0).speed(5.0).max_decimals(0));
                dots.widget_info(|| WidgetInfo::labeled(egui::Role::SpinButton, true, "Resolution (dpi)"));
            });
        }
        row("line weight", &mut |ui| {
            let [least, most] = LINE_SCALES;
            let factor = ui.add(DragValue::new(&mut figure.line_scale).range(least..=most).speed(0.01).max_decimals(2));
            factor.widget_info(|| WidgetInfo::labeled(egui::Role::SpinButton, true, "Factor on the widths of lines"));
        });
        row("text size", &mut |ui| field(ui, &mut figure.font_size, "Size of the text", "6 pt, or 12 pixels"));
        row("ink", &mut |ui| radios(ui, &mut figure.ink, Ink::ALL.map(|ink| (ink, ink.name()))));
        if !is_film {
            let grounds = [(false, "of the ink"), (true, "transparent")];
            row("ground", &mut |ui| radios(ui, &mut figure.transparent, grounds));
        }
        let parts = [(false, "the whole mesh"), (true, "what is in view")];
        if !(is_film && figure.film.follows) {
            row("part", &mut |ui| radios(ui, &mut figure.in_view, parts));
        }
        if save::ON_DISK {
            row("folder", &mut |ui| {
                ui.horizontal(|ui| {
                    field(ui, &mut figure.folder, "Folder of the figure", "the working folder");
                    on_click(&ui.button("Choose…"), Command::ChooseFolder, commands);
                });
            });
        }
        row("name", &mut |ui| field(ui, &mut figure.name, "Name of the figure", "from case and step"));
    });
    if !figure.content.is_plot() {
        ui.add_space(6.0);
        Grid::new("figure layers").num_columns(4).spacing(Vec2::new(10.0, 3.0)).show(ui, |ui| {
            for (k, layer) in Layer::ALL.into_iter().enumerate() {
                let mut on = figure.has(layer);
                // The layers of the views have the same names.
                let name = if layer == Layer::H { "H-values" } else { layer.name() };
                let response = ui.checkbox(&mut on, name);
                response.widget_info(|| {
                    WidgetInfo::selected(egui::Role::CheckBox, true, on, format!("{} in the figure", layer.name()))
                });
                if response.changed() {
                    figure.switch(layer, on);
                }
                if k % 4 == 3 {
                    ui.end_row();
                }
            }
        });
    }
    if figure != state.workspace().figure {
        commands.push(Command::SetFigure(Box::new(figure)));
    }
    ui.add_space(8.0);
    if is_film {
        return film::making(ui, window, commands, palette);
    }
    let names = figures::names(state, Formats::Both);
    let folder = names[0].parent().filter(|folder| !folder.as_os_str().is_empty()).map(Path::to_path_buf);
    let folder = folder.or_else(|| std::env::current_dir().ok()).unwrap_or_default();
    let files = names.iter().filter_map(|name| name.file_name()).map(|name| name.to_string_lossy());
    let mut text = files.collect::<Vec<_>>().join(" and ");
    if save::ON_DISK {
        text += &format!(" in {}", folder.display());
    }
    ui.add(Label::new(note(text, palette)).wrap());
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        for formats in Formats::made() {
            on_click(&ui.button(format!("Save {}", formats.name())), Command::SaveFigure(formats), commands);
        }
        if state.run().is_making_figure() {
            ui.spinner();
        }
    });
}
