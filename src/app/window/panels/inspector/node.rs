//! A node: its place and metric, the elements around it, its frontal angles.

use eframe::egui::Ui;

use super::{axis, elements, formula, gone, note, offered, section, title};
use crate::app::window::command::Command;
use crate::app::window::session::Moment;
use crate::app::window::state::State;
use crate::app::window::words;
use crate::core::mesh::NodeId;
use crate::core::run::NodeFacts;
use crate::render::palette::Palette;
use crate::render::scene::Outlined;

pub fn show(ui: &mut Ui, state: &State, moment: &Moment, node: NodeId, commands: &mut Vec<Command>, palette: &Palette) {
    title(ui, format!("Node {}", node.0), palette);
    let mesh = &moment.mesh;
    let Some(told) = NodeFacts::of(mesh, node) else { return gone(ui, "The node", palette) };
    let place = match (told.is_hard, told.is_fixed) {
        (true, _) => "a hard point: fixed",
        (false, true) => "on the boundary: fixed",
        (false, false) => "free: may be moved",
    };
    ui.label(note(format!("{place}  ·  {}", words::counted(told.valence as u64, "edge")), palette));
    offered(ui, state, Outlined::Node(node), commands);
    let is_plane = mesh.embedding().is_none();
    if section(ui, "Place", if is_plane { "plane case: u = x, v = y" } else { "in space and in the chart" }, palette) {
        let [x, y, z] = told.xyz.map(words::size);
        formula(ui, &format!("x = **{x}**   y = **{y}**   z = {z}"), palette);
        formula(ui, &format!("u = {}   v = {}", words::size(told.uv[0]), words::size(told.uv[1])), palette);
    }
    if section(ui, "Metric", "eq. 3", palette) {
        let [uu, uv, vv] = told.metric.tensor.map(words::size);
        formula(ui, &format!("M = ( {uu}   {uv} ;  {uv}   {vv} )"), palette);
        for (k, name) in [(1, "1"), (0, "2")] {
            let text = format!(
                "h_{{{name}}} = **{}**  along {}°,   \u{3bb} = {}",
                words::size(told.metric.sizes[k]),
                words::fixed(axis(told.metric.directions[k]), 1),
                words::size(told.metric.lambda[k])
            );
            formula(ui, &text, palette);
        }
    }
    if !told.sectors.is_empty() && section(ui, "Frontal angles", "fig. 9; one for each live sector", palette) {
        for (h, angle) in &told.sectors {
            let ends = [mesh.origin(*h), mesh.target(*h)];
            ui.horizontal_wrapped(|ui| {
                formula(ui, &format!("\u{3b8} = **{}°**  left of", words::fixed(*angle, 1)), palette);
                let name = words::segment(ends);
                super::link(ui, name, Outlined::Edge(ends), commands, palette);
            });
        }
    }
    if section(ui, "Elements around it", "", palette) {
        elements(ui, "live triangles", &told.live, commands, palette);
        elements(ui, "dead quads", &told.dead, commands, palette);
    }
}
