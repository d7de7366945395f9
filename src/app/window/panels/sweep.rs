//! The sweep: two keys with their values, a figure, and the map of what the runs end with.

mod map;

use eframe::egui::{Align, Button, Label, Layout, ProgressBar, Role, TextEdit, Ui, Vec2, WidgetInfo};

use super::{choice, inset, line, note, on_click};
use crate::app::window::command::Command;
use crate::app::window::state::State;
use crate::app::window::sweep::{SweepCommand, SweepForm, SweepWork};
use crate::app::window::theme::ink;
use crate::app::window::words;
use crate::core::case::Parameters;
use crate::core::fault::Fault;
use crate::core::record::report::figures::{FIGURES, Figure};
use crate::core::record::sweep::{Axis, Cell, Sweep};
use crate::render::palette::Palette;
use crate::render::vector::heat_map::{Scale, meaning};

/// The names of the axes, for screen readers and in the panel.
const AXES: [(&str, &str); 2] = [("across", "Key across"), ("upward", "Key upward")];
const VALUES: [&str; 2] = ["Values across", "Values upward"];
/// The widths of the names of rows, and of the lists of keys and figures.
const HEAD: f32 = 52.0;
const WIDTH: f32 = 150.0;

/// What the panel keeps for itself.
#[derive(Default)]
pub struct SweepPanel {
    /// The form that was read last, and the number of its runs.
    read: Option<(SweepForm, Result<usize, Fault>)>,
}

/// Shows the panel. The sweep belongs to the window, and what is swept next is the run that the panels show.
pub fn show(ui: &mut Ui, window: &State, local: &mut SweepPanel, commands: &mut Vec<Command>, palette: &Palette) {
    inset().show(ui, |ui| {
        let mut form = window.workspace().sweep.clone();
        let state = window.active();
        fields(ui, state, &mut form, palette);
        let read = local.read.take().filter(|read| read.0 == form).unwrap_or_else(|| {
            let count = form.axes().map(|axes| axes.iter().map(|axis| axis.values.len()).product());
            (form.clone(), count)
        });
        let work = window.sweep();
        buttons(ui, state, work, &read.1, commands, palette);
        local.read = Some(read);
        if form != window.workspace().sweep {
            commands.push(Command::Sweep(SweepCommand::Set(Box::new(form))));
        }
        let Some(work) = work else {
            let text = "Each combination of values is a run of its own, to its end. They are shown here as they come, \
                        and a click opens one.";
            ui.add(Label::new(note(text, palette)).wrap());
            return;
        };
        if let Some(sweep) = &work.sweep {
            let figure = window.workspace().sweep.figure();
            notes(ui, work, sweep, palette);
            map::show(ui, window, work, sweep, figure, commands, palette);
        }
    });
}

/// The keys with their values, and the figure.
fn fields(ui: &mut Ui, state: &State, form: &mut SweepForm, palette: &Palette) {
    for (k, (text, name)) in AXES.into_iter().enumerate() {
        ui.horizontal(|ui| {
            head(ui, text, palette);
            let (key, values) = &mut form.axes[k];
            let before = *key;
            let none = (k == 1).then_some((None, "none"));
            let keys = none.into_iter().chain(Parameters::KEYS.map(|key| (Some(key), key)));
            choice(ui, name, WIDTH, key.unwrap_or("none"), key, keys);
            if *key != before
                && let Some(key) = *key
            {
                let now = state.parameters_of_case().and_then(|parameters| parameters.text_of(key));
                *values = Axis::suggested(key, &now.unwrap_or_default());
            }
            let field = TextEdit::singleline(values).desired_width(ui.available_width());
            let field = ui.add_enabled(key.is_some(), field);
            field.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, VALUES[k]));
            field.on_hover_text("from:to:step, both ends included, or values with commas; angles in degrees");
        });
    }
    ui.horizontal(|ui| {
        head(ui, "show", palette);
        let all = FIGURES.iter().map(|figure| (figure.name, figure.name));
        choice(ui, "Figure of the sweep", WIDTH, form.figure, &mut form.figure, all);
        ui.add(Label::new(note(meaning(form.figure()), palette)).wrap());
    });
}

/// The name of a row.
fn head(ui: &mut Ui, text: &str, palette: &Palette) {
    let size = Vec2::new(HEAD, ui.spacing().interact_size.y);
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        ui.set_min_width(HEAD);
        ui.label(note(text, palette));
    });
}

/// Run or Stop, how far it is, and Save.
fn buttons(
    ui: &mut Ui,
    state: &State,
    work: Option<&SweepWork>,
    count: &Result<usize, Fault>,
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    let mut button = |ui: &mut Ui, text: &str, command: SweepCommand, enabled: bool| {
        let command = Command::Sweep(command);
        let response = ui.add_enabled(enabled, Button::new(text));
        response.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, command.name()));
        on_click(&response.on_hover_text(command.tip()), command, commands);
    };
    ui.horizontal(|ui| {
        match work.filter(|work| work.is_running()) {
            Some(work) => {
                button(ui, "Stop", SweepCommand::Stop, true);
                let (done, all) = work.sweep.as_ref().map_or((0, 0), |sweep| {
                    let all = sweep.cells().len();
                    (all - sweep.missing().len(), all)
                });
                let threads = words::counted(work.threads as u64, "thread");
                let share = if all == 0 { 0.0 } else { done as f32 / all as f32 };
                ui.add(ProgressBar::new(share).desired_width(90.0).desired_height(3.0).fill(ink(palette.base)));
                let text = format!("{} of {} runs, {threads}", words::grouped(done as u64), words::grouped(all as u64));
                ui.label(line(text, palette.text));
            }
            None => {
                button(ui, "Run", SweepCommand::Run, count.is_ok() && state.run().moment.is_some());
                match count {
                    Ok(count) => {
                        ui.label(note(words::counted(*count as u64, "run"), palette));
                    }
                    Err(fault) => {
                        ui.add(Label::new(line(fault.to_string(), palette.broken)).wrap());
                    }
                }
            }
        }
        if work.is_some_and(|work| work.sweep.is_some()) {
            button(ui, "Save…", SweepCommand::Save, true);
        }
    });
}

/// The best cells, the case's own, and what is missing.
fn notes(ui: &mut Ui, work: &SweepWork, sweep: &Sweep, palette: &Palette) {
    let refused = sweep.cells().iter().filter(|cell| matches!(cell, Some(Cell::Refused(_)))).count();
    let missing = sweep.missing().len();
    let mut parts = vec![sweep.case.name.clone()];
    if refused > 0 {
        parts.push(format!("{} refused", words::counted(refused as u64, "run")));
    }
    if missing > 0 && !work.is_running() {
        parts.push(format!("stopped, {} not computed", words::counted(missing as u64, "run")));
    }
    if work.edits() > 0 {
        parts.push(format!("each run with {} at steps", words::counted(work.edits() as u64, "change")));
    }
    ui.add(Label::new(note(parts.join("; "), palette)).wrap());
}

/// The value of a figure in a cell, or why there is none, in words.
fn cell_text(sweep: &Sweep, cell: usize, scale: Option<&Scale>, figure: &Figure) -> String {
    match (&sweep.cells()[cell], scale.zip(sweep.value(cell, figure))) {
        (_, Some((scale, value))) => scale.text_with_unit(value, figure),
        (Some(Cell::Refused(_)), _) => "refused".to_owned(),
        (Some(Cell::Figures(_)), _) => "none".to_owned(),
        (None, _) => "not computed".to_owned(),
    }
}
