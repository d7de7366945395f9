//! The rows and buttons of a film.

use eframe::egui::{Button, DragValue, Label, ProgressBar, Role, Ui, WidgetInfo};

use super::super::{line, note, on_click, part};
use super::{field, radios};
use crate::app::window::command::Command;
use crate::app::window::film::{self, FilmCommand, FilmForm};
use crate::app::window::state::State;
use crate::app::window::theme::ink;
use crate::render::film::{FASTEST, FilmFormat};
use crate::render::palette::Palette;

/// Shows a row with a name and its widgets.
type ShowRow<'r> = &'r mut dyn FnMut(&str, &mut dyn FnMut(&mut Ui));

/// The rows for what only a film has.
pub fn rows(form: &mut FilmForm, row: ShowRow<'_>) {
    row("from", &mut |ui| field(ui, &mut form.from, "First frame", "nq=0, or step=812"));
    row("to", &mut |ui| field(ui, &mut form.to, "Last frame", "end, nq=100 or step=812"));
    row("every", &mut |ui| field(ui, &mut form.every, "From frame to frame", "quad, event, 5 or step=20"));
    row("frames a second", &mut |ui| {
        let rate = ui.add(DragValue::new(&mut form.rate).range(0.1..=FASTEST).speed(0.2).max_decimals(2));
        rate.widget_info(|| WidgetInfo::labeled(Role::SpinButton, true, "Frames a second"));
    });
    row("camera", &mut |ui| radios(ui, &mut form.follows, [(false, "fixed"), (true, "follows the decision")]));
    row("plays", &mut |ui| radios(ui, &mut form.once, [(false, "forever"), (true, "once")]));
    row("below", &mut |ui| {
        ui.checkbox(&mut form.captions, "what each step does");
    });
}

/// The buttons that make a film and stop it, and how far it is.
pub fn making(ui: &mut Ui, window: &State, commands: &mut Vec<Command>, palette: &Palette) {
    let mut button = |ui: &mut Ui, text: &str, command: FilmCommand| {
        let response = ui.add(Button::new(text));
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, command.name()));
        on_click(&response, Command::Film(command), commands);
    };
    let work = window.film();
    if let Some(work) = work.filter(|work| work.is_running()) {
        ui.horizontal(|ui| {
            button(ui, "Stop", FilmCommand::Stop);
            part(ui, "progress", |ui| {
                let bar = ProgressBar::new(work.share).desired_width(110.0).desired_height(3.0);
                ui.add(bar.fill(ink(palette.base)));
                ui.label(line(&work.told, palette.text));
            });
        });
        return;
    }
    let state = window.active();
    match state.workspace().figure.film.options() {
        Ok(_) => {
            let paths = FilmFormat::ALL.map(|format| film::path(state, format).display().to_string());
            ui.add(Label::new(note(paths.join(" or "), palette)).wrap());
            ui.add_space(4.0);
            ui.horizontal(|ui| {
                for (text, format) in ["Save GIF", "Save animated PNG"].into_iter().zip(FilmFormat::ALL) {
                    button(ui, text, FilmCommand::Save(format));
                }
            });
        }
        Err(fault) => {
            ui.add(Label::new(line(fault.to_string(), palette.broken)).wrap());
        }
    }
    if let Some(work) = work {
        ui.add(Label::new(note(&work.told, palette)).wrap());
    }
}
