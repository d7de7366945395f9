//! The history of something: the step that made it or ended it, the triangles that it was made of, every step that
//! touched it; and what can be done with it.

use eframe::egui::{Label, Sense, Ui};

use super::{elements, line, note, on_click, part, section};
use crate::app::window::command::Command;
use crate::app::window::session::{Goal, Past};
use crate::app::window::state::{Lookup, State, watched};
use crate::app::window::words;
use crate::render::palette::Palette;
use crate::render::scene::Outlined;

pub fn show(ui: &mut Ui, state: &State, what: Outlined, commands: &mut Vec<Command>, palette: &Palette) {
    let watched = watched(what);
    let past = match state.run().past(watched) {
        Lookup::Known(past) => past,
        Lookup::Pending => return,
        Lookup::Unasked => return commands.push(Command::TellPast(watched)),
    };
    if section(ui, "Past steps", "up to this step", palette) {
        part(ui, "past", |ui| steps(ui, &past, commands, palette));
    }
}

fn steps(ui: &mut Ui, past: &Past, commands: &mut Vec<Command>, palette: &Palette) {
    if let Some((step, merged)) = &past.made {
        step_link(ui, *step, "made", commands, palette);
        elements(ui, "made of the triangles", merged, commands, palette);
    }
    if let Some(step) = past.killed {
        step_link(ui, step, "no longer live on both sides", commands, palette);
    }
    if past.touches.is_empty() {
        ui.label(note("Nothing has touched it.", palette));
    }
    for (step, event) in past.touches.iter().rev() {
        step_link(ui, *step, &words::event(event), commands, palette);
    }
    if past.more {
        ui.label(note("For earlier steps, go back to the first of these.", palette));
    }
}

/// Actions on something, for the inspector and for context menus.
pub fn actions(ui: &mut Ui, state: &State, what: Outlined, commands: &mut Vec<Command>) {
    let mut offered = vec![(Command::LastTouch(what), "Go back to that step")];
    if let Outlined::Element(e) = what
        && state.run().moment.as_ref().is_some_and(|moment| moment.mesh.has_element(e) && moment.mesh.is_quad(e))
    {
        offered.push((Command::Made(e), "Go to the step that made this quadrilateral"));
    }
    for (command, tip) in offered {
        on_click(&ui.button(command.name()).on_hover_text(tip), command, commands);
    }
    let is_watched = state.document().watches.iter().any(|watch| watch.watched == watched(what));
    let name = if is_watched { "Stop watching" } else { "Watch" };
    let tip = "F5 and Alt+F5 stop where it is touched";
    on_click(&ui.button(name).on_hover_text(tip), Command::Watch(what), commands);
}

pub fn step_link(ui: &mut Ui, step: u64, what: &str, commands: &mut Vec<Command>, palette: &Palette) {
    let text = format!("step {}  {what}", words::grouped(step));
    let response = ui.add(Label::new(line(text, palette.text)).sense(Sense::click()).selectable(false).wrap());
    on_click(
        &response.on_hover_cursor(eframe::egui::CursorIcon::PointingHand),
        Command::Go(Goal::Step(step)),
        commands,
    );
}
