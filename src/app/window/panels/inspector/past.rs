//! What became of something: the step that made it or killed it, what it ate, every step that touched it; and what can
//! be done with it.

use eframe::egui::{Label, RichText, Sense, Ui};

use super::{elements, heading, note};
use crate::app::window::apply::watched;
use crate::app::window::command::Command;
use crate::app::window::session::Goal;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::words;
use crate::render::palette::Palette;
use crate::render::scene::Outlined;

pub fn show(ui: &mut Ui, state: &mut State, what: Outlined, commands: &mut Vec<Command>, palette: &Palette) {
    let Some(past) = state.past(watched(what)) else { return };
    heading(ui, "What became of it", "up to this step", palette);
    if let Some((step, eaten)) = &past.made {
        step_link(ui, *step, "made", commands, palette);
        elements(ui, "It ate the triangles", eaten, state, commands, palette);
    }
    if let Some(step) = past.killed {
        step_link(ui, step, "killed: no longer live on both sides", commands, palette);
    }
    if past.touches.is_empty() {
        ui.label(note("Nothing has touched it.", palette));
    }
    for (step, event) in past.touches.iter().rev() {
        step_link(ui, *step, &words::event(event), commands, palette);
    }
    if past.more {
        ui.label(note("Earlier ones: go back to the first of these.", palette));
    }
}

/// What can be done with something; the same in the inspector and in the menu of the view.
pub fn actions(ui: &mut Ui, state: &State, what: Outlined, commands: &mut Vec<Command>) {
    let mut offered = vec![(Command::LastTouch(what), "Goes back to that step")];
    if let Outlined::Element(e) = what
        && state.moment.as_ref().is_some_and(|moment| moment.mesh.has_element(e) && moment.mesh.is_quad(e))
    {
        offered.push((Command::Made(e), "Goes to the step that made this quadrilateral"));
    }
    for (command, tip) in offered {
        if ui.button(command.name()).on_hover_text(tip).clicked() {
            commands.push(command);
        }
    }
    let is_watched = state.kept.watches.iter().any(|watch| watch.0 == watched(what));
    let name = if is_watched { "Stop watching" } else { "Watch" };
    let tip = "F5 and Alt+F5 stop where it is touched, forward and backward";
    if ui.button(name).on_hover_text(tip).clicked() {
        commands.push(Command::Watch(what));
    }
}

fn step_link(ui: &mut Ui, step: u64, what: &str, commands: &mut Vec<Command>, palette: &Palette) {
    let text = format!("step {}  {what}", words::grouped(step));
    let text = RichText::new(text).font(theme::regular(theme::TABLE)).color(ink(palette.text));
    let response = ui.add(Label::new(text).sense(Sense::click()).selectable(false).truncate());
    if response.on_hover_cursor(eframe::egui::CursorIcon::PointingHand).clicked() {
        commands.push(Command::Go(Goal::Step(step)));
    }
}
