//! An edge that is not a front segment: live, dead or boundary, and the elements beside it.

use eframe::egui::Ui;

use super::{elements, ends, gone, length, note, offered, section, title};
use crate::app::window::command::Command;
use crate::app::window::session::Moment;
use crate::app::window::state::State;
use crate::app::window::words;
use crate::core::mesh::{ElementId, NodeId};
use crate::core::run::{EdgeFacts, EdgeKind};
use crate::render::palette::Palette;
use crate::render::scene::Outlined;

pub fn show(
    ui: &mut Ui,
    state: &State,
    moment: &Moment,
    between: [NodeId; 2],
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    title(ui, format!("Edge {}", words::edge(between)), palette);
    let [a, b] = between;
    let mesh = &moment.mesh;
    let Some(told) = EdgeFacts::of(mesh, a, b) else { return gone(ui, "The edge", palette) };
    let kind = match told.kind {
        EdgeKind::Live => "live: between live triangles, it can be changed",
        EdgeKind::Front => "front: live triangles on one side",
        EdgeKind::Dead => "dead: between quadrilaterals",
        EdgeKind::Boundary => "boundary: quadrilaterals only",
    };
    let boundary = if told.is_boundary && told.kind != EdgeKind::Boundary { "  ·  on the boundary" } else { "" };
    ui.label(note(format!("{kind}{boundary}"), palette));
    offered(ui, state, Outlined::Edge(between), commands);
    length(ui, told.length_metric, told.length_physical, palette);
    let sides = [mesh.half_edge_between(a, b), mesh.half_edge_between(b, a)];
    let beside: Vec<ElementId> = sides.into_iter().flatten().map(|h| h.element()).collect();
    let (live, dead): (Vec<ElementId>, Vec<ElementId>) = beside.into_iter().partition(|e| mesh.is_triangle(*e));
    if section(ui, "Elements beside it", "", palette) {
        elements(ui, "live triangles", &live, commands, palette);
        elements(ui, "dead quads", &dead, commands, palette);
    }
    if section(ui, "Ends", "sizes of their metrics", palette) {
        ends(ui, moment, &[("", a), ("", b)], commands, palette);
    }
}
