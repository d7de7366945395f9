//! Why a segment was or was not selected (paper 4.3.3, table 1), and for which parameters the selection would be the
//! same.

use eframe::egui::Ui;

use super::{section, sentence};
use crate::app::window::command::Command;
use crate::app::window::session::{Explained, Moment};
use crate::app::window::state::{Lookup, State};
use crate::app::window::words;
use crate::core::mesh::NodeId;
use crate::render::palette::Palette;

pub fn show(
    ui: &mut Ui,
    state: &State,
    moment: &Moment,
    ends: [NodeId; 2],
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    let base = moment.base.as_ref().filter(|told| [told.row.a, told.row.b] == ends);
    let (told, deferred) = match base {
        Some(told) => (told.clone(), None),
        None => match state.run().explanation(ends) {
            Lookup::Known(explained) => {
                let Explained { told, deferred } = &*explained;
                (told.clone(), *deferred)
            }
            Lookup::Pending => return,
            Lookup::Unasked => return commands.push(Command::Explain(ends)),
        },
    };
    let is_next = moment.selecting.base.is_none() && told.rank.is_some_and(|rank| rank.0 == 0);
    let title = if told.is_base || is_next { "Why this segment" } else { "Why not this segment" };
    if !section(ui, title, "table 1, 4.3.3", palette) {
        return;
    }
    if let Some((step, why)) = deferred {
        let why = why.map_or(String::new(), |why| format!(" ({})", words::why(why)));
        let text =
            format!("Deferred at step {}{why}; available again when something near it changes.", words::grouped(step));
        sentence(ui, &text, palette.text, palette);
        return;
    }
    told.why.iter().for_each(|text| drop(sentence(ui, text, palette.text, palette)));
}
