//! An element: live or dead, its quality, angles and areas in the metric and in space.

use eframe::egui::Ui;

use super::{InspectorState, chain, ends, formula, gone, note, offered, section, title};
use crate::app::window::command::Command;
use crate::app::window::session::Moment;
use crate::app::window::state::State;
use crate::app::window::words;
use crate::core::mesh::{ElementId, NodeId};
use crate::core::run::ElementFacts;
use crate::render::palette::Palette;
use crate::render::scene::Outlined;

pub fn show(
    ui: &mut Ui,
    state: &State,
    local: &mut InspectorState,
    moment: &Moment,
    e: ElementId,
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    let Some(told) = ElementFacts::of(&moment.mesh, e) else {
        title(ui, format!("Element {}", e.0), palette);
        return gone(ui, "The element", palette);
    };
    title(ui, format!("{} {}", if told.is_live { "Triangle" } else { "Quadrilateral" }, e.0), palette);
    let state_of = if told.is_live { "live".to_owned() } else { format!("dead  ·  level {}", told.level) };
    ui.label(note(format!("{state_of}  ·  region {}", told.region), palette));
    offered(ui, state, Outlined::Element(e), commands);
    if section(ui, "Quality", "0 to 1, in the metric", palette) {
        formula(ui, &format!("**{}**", words::fixed(told.quality, 2)), palette);
    }
    if !told.is_live {
        chain::show(ui, state, local, e, commands, palette);
    }
    let list = |angles: &[f64]| angles.iter().map(|a| words::fixed(*a, 1)).collect::<Vec<_>>().join("   ");
    if section(ui, "Angles", "degrees, at its nodes", palette) {
        formula(ui, &format!("metric   **{}**", list(&told.angles_metric)), palette);
        formula(ui, &format!("space    {}", list(&told.angles_physical)), palette);
    }
    if section(ui, "Area", "1 is a unit square of the metric", palette) {
        let areas = format!("**{}** metric,  {} in space", words::fixed(told.area_metric, 2), words::size(told.area));
        formula(ui, &areas, palette);
    }
    if section(ui, "Nodes", "sizes of their metrics", palette) {
        let nodes: Vec<(&str, NodeId)> = told.nodes.iter().map(|n| ("", *n)).collect();
        ends(ui, moment, &nodes, commands, palette);
    }
}
