//! Breakpoints and watchpoints.

use eframe::egui::{self, Align, Label, Layout, RichText, Role, ScrollArea, Sense, Ui, WidgetInfo};

use super::condition_field::ConditionField;
use super::{icon_button, inset, note, on_click, part};
use crate::app::window::command::Command;
use crate::app::window::session::Source;
use crate::app::window::state::{State, outlined};
use crate::app::window::theme;
use crate::app::window::{icons, words};
use crate::core::run::breakpoint::FIELDS;
use crate::render::palette::Palette;

/// What the panel keeps for itself.
#[derive(Default)]
pub struct BreakpointsState {
    /// The condition that is being typed.
    field: String,
}

/// Shows the breakpoints and watchpoints.
pub fn show(ui: &mut Ui, state: &State, local: &mut BreakpointsState, commands: &mut Vec<Command>, palette: &Palette) {
    inset().show(ui, |ui| {
        let field = ConditionField {
            name: "Condition of a new breakpoint",
            hint: "a condition, e.g. kind == seamed",
            fields: FIELDS,
        };
        let room = (ui.available_height() - field.height(&local.field)).max(30.0);
        ScrollArea::vertical().max_height(room).auto_shrink([false, true]).show(ui, |ui| {
            if state.document().breakpoints.is_empty() && state.document().watches.is_empty() {
                ui.add(Label::new(note("None yet. Try quad.min_angle < 30.", palette)).wrap());
                let text = "Or select a node, an edge or an element and press Watch in the inspector.";
                ui.add(Label::new(note(text, palette)).wrap());
            }
            conditions(ui, state, commands, palette);
            part(ui, "reduction", |ui| reduction(ui, state, commands, palette));
            part(ui, "watches", |ui| watches(ui, state, commands, palette));
        });
        if field.show(ui, &mut local.field, palette).is_entered() {
            commands.push(Command::AddBreakpoint(std::mem::take(&mut local.field)));
        }
    });
}

fn conditions(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    for (k, breakpoint) in state.document().breakpoints.iter().enumerate() {
        ui.horizontal(|ui| {
            let mut on = breakpoint.is_on;
            if ui.checkbox(&mut on, &breakpoint.condition).on_hover_text("Switch it on or off").changed() {
                commands.push(Command::SwitchBreakpoint(k));
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                icon_button(ui, icons::X, 13.0, Command::RemoveBreakpoint(k), true, commands);
            });
        });
        ui.horizontal(|ui| {
            ui.add_space(ui.spacing().icon_width + ui.spacing().icon_spacing);
            if let Some(hits) = state.run().hits.get(k) {
                let text = format!("{} in this run", words::grouped(hits.len() as u64));
                ui.label(note(text, palette)).on_hover_text("How often it holds in the recorded part of the run");
            }
            let response = ui.small_button("Reduce");
            let name = format!("Reduce this: {}", breakpoint.condition);
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name.clone()));
            let tip = "Find the smallest case in which it is still met, and write it as a case file";
            on_click(&response.on_hover_text(tip), Command::Reduce(k), commands);
        });
    }
}

/// How far a reduction is, or what came of it.
fn reduction(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    let Some(reducing) = state.reducing() else { return };
    ui.add_space(4.0);
    let text = format!("{} · {}", reducing.condition, reducing.told);
    ui.add(Label::new(note(text, palette)).wrap());
    ui.horizontal_wrapped(|ui| {
        if reducing.is_running() {
            on_click(&ui.button(Command::StopReducing.name()), Command::StopReducing, commands);
        } else if reducing.is_done {
            let open = Command::Open(Source::File(reducing.path.clone()));
            on_click(&ui.button(open.name()), open, commands);
        }
    });
    ui.add_space(4.0);
}

fn watches(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    for (k, watch) in state.document().watches.iter().enumerate() {
        let what = outlined(watch.watched);
        ui.horizontal(|ui| {
            let mut on = watch.is_on;
            let name = format!("{}  {}", icons::EYE, words::thing(what));
            let response = ui.checkbox(&mut on, name);
            response.widget_info(|| {
                WidgetInfo::selected(Role::CheckBox, true, on, format!("Watch {}", words::thing(what)))
            });
            if response.hovered() {
                commands.push(Command::Hover(what));
            }
            if response.on_hover_text("Stop where it is touched, forward and back").changed() {
                commands.push(Command::SwitchWatch(k));
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let button = egui::Button::new(RichText::new(icons::X).font(theme::regular(13.0)));
                let response = ui.add(button.frame_when_inactive(false));
                let label = format!("Stop watching {}", words::thing(what));
                response.widget_info(|| WidgetInfo::labeled(Role::Button, true, label.clone()));
                on_click(&response.on_hover_text(&label), Command::Watch(what), commands);
                let touched = ui.add(Label::new(note("last touch", palette)).sense(Sense::click()).selectable(false));
                let touched = touched.on_hover_text("Go back to the step that touched it last");
                on_click(&touched, Command::LastTouch(what), commands);
            });
        });
    }
}
