//! What can be done with something: the same entries in the same order in the menus of rows and views, and as buttons
//! in the inspector.

use eframe::egui::Ui;

use super::on_click;
use crate::app::window::command::Command;
use crate::app::window::state::{State, watched};
use crate::app::window::words;
use crate::render::scene::{Decision, Outlined};

/// Something that can be done.
struct Action {
    command: Command,
    name: String,
    tip: &'static str,
}

/// The menu of something.
pub fn menu(ui: &mut Ui, state: &State, what: Outlined, commands: &mut Vec<Command>) {
    ui.label(words::thing(what));
    let seen = [
        (Command::Pick(Some(what)), "Selects it: the inspector explains it"),
        (Command::Show(what), "Moves the view there"),
    ];
    let seen = seen.map(|(command, tip)| Action { name: command.name(), command, tip });
    show(ui, seen.into_iter().chain(offered(state, what)), commands);
}

/// What can be done with the selection, as buttons.
pub fn buttons(ui: &mut Ui, state: &State, what: Outlined, commands: &mut Vec<Command>) {
    // The chain of the selection stands below.
    let others = offered(state, what).into_iter().filter(|action| !matches!(action.command, Command::ShowChain(_)));
    show(ui, others, commands);
}

fn show(ui: &mut Ui, actions: impl IntoIterator<Item = Action>, commands: &mut Vec<Command>) {
    for Action { command, name, tip } in actions {
        on_click(&ui.button(name).on_hover_text(tip), command, commands);
    }
}

/// What fits its kind.
fn offered(state: &State, what: Outlined) -> Vec<Action> {
    let mut offered = Vec::new();
    let mut offer = |command: Command, name: Option<&str>, tip: &'static str| {
        let name = name.map_or_else(|| command.name(), str::to_owned);
        offered.push(Action { command, name, tip });
    };
    let moment = state.run().moment.as_deref();
    match what {
        Outlined::Element(e) if moment.is_some_and(|moment| moment.mesh.has_element(e) && moment.mesh.is_quad(e)) => {
            offer(Command::ShowChain(e), None, "Selects it, and shows every decision that led to it in the inspector");
            offer(Command::Made(what), None, "Goes to the step that made this quadrilateral");
        }
        Outlined::Node(_) => offer(Command::Made(what), None, "Goes to the step that made this node"),
        _ => {}
    }
    offer(Command::LastTouch(what), None, "Goes back to that step");
    if let (Outlined::Edge([a, b]), Some(moment)) = (what, moment) {
        let base = Decision::of(&moment.phase).base;
        let segment = moment.front.iter().map(|s| [s.a, s.b]).find(|ends| *ends == [a, b] || *ends == [b, a]);
        if let Some(ends) = segment.filter(|ends| base != Some(*ends)) {
            let tip =
                "Replaces the base that was just selected, or the next base, whatever the rank. This changes the run";
            offer(Command::ChooseBase(ends), Some("Choose as base"), tip);
        }
    }
    let is_watched = state.document().watches.iter().any(|watch| watch.watched == watched(what));
    let name = if is_watched { "Stop watching" } else { "Watch" };
    offer(Command::Watch(what), Some(name), "F5 and Alt+F5 stop where it is touched");
    offered
}
