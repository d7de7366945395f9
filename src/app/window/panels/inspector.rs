//! What is picked or pointed at, or else the decision at hand, with the numbers put into the paper's formulas.

use eframe::egui::{RichText, ScrollArea, Ui};

use super::{heading, inset, note};
use crate::app::window::command::Command;
use crate::app::window::session::{Goal, Moment};
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::words;
use crate::core::convert::candidates::Candidates;
use crate::core::front::sector::Side;
use crate::core::front::segment::Segment;
use crate::core::mesh::ids::{ElementId, NodeId};
use crate::core::run::explain::SegmentTold;
use crate::render::palette::Palette;
use crate::render::scene::{Decision, Outlined, angles, metric_area};

/// Shows the panel.
pub fn show(ui: &mut Ui, state: &mut State, commands: &mut Vec<Command>, palette: &Palette) {
    let Some(moment) = state.moment.clone() else { return };
    let decision = Decision::of(&moment.phase).base.map(Outlined::Edge);
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        inset().show(ui, |ui| match state.kept.picked.or(decision).or(state.hovered) {
            None => {
                ui.label(note("Point at anything to see it; click to keep it.", palette));
            }
            Some(Outlined::Edge(ends)) => {
                let found = moment.front.iter().position(|s| [s.a, s.b] == ends || [s.b, s.a] == ends);
                match found {
                    Some(place) => segment(ui, state, &moment, place, commands, palette),
                    None => edge(ui, &moment, ends, palette),
                }
                last_touch(ui, Outlined::Edge(ends), commands);
            }
            Some(Outlined::Node(n)) => {
                node(ui, &moment, n, palette);
                last_touch(ui, Outlined::Node(n), commands);
            }
            Some(Outlined::Element(e)) => {
                element(ui, state, &moment, e, commands, palette);
                last_touch(ui, Outlined::Element(e), commands);
            }
        });
    });
}

fn title(ui: &mut Ui, text: String, palette: &Palette) {
    ui.label(RichText::new(text).font(theme::semibold(theme::TITLE)).color(ink(palette.strong)));
}

fn line(ui: &mut Ui, text: String, palette: &Palette) {
    ui.label(RichText::new(text).font(theme::regular(theme::FORMULA)).color(ink(palette.text)));
}

fn gone(ui: &mut Ui, what: &str, palette: &Palette) {
    ui.label(note(format!("{what} does not exist at this step."), palette));
}

/// The button that goes back to the step that touched something last.
fn last_touch(ui: &mut Ui, what: Outlined, commands: &mut Vec<Command>) {
    ui.add_space(6.0);
    let command = Command::LastTouch(what);
    if ui.button(command.name()).on_hover_text("Goes back to that step").clicked() {
        commands.push(command);
    }
}

/// Why the segment was or was not chosen, and within which bounds the choice would have been the same.
fn why(ui: &mut Ui, told: &SegmentTold, palette: &Palette) {
    heading(ui, if told.is_base { "Why this segment" } else { "Why not this segment" }, "table 1, 4.3.3", palette);
    let mut reason = told.reason();
    if let Some(first) = reason.get(..1).map(str::to_uppercase) {
        reason.replace_range(..1, &first);
    }
    let text = |text: String| RichText::new(text).font(theme::regular(theme::TABLE));
    ui.label(text(format!("{reason}.")).color(ink(palette.text)));
    if told.h_min.is_finite() {
        let reach = format!("Smallest H of those that wait: {}.", words::size(told.h_min));
        ui.label(text(reach).color(ink(palette.weak)));
    }
    let mut margins = Vec::new();
    if let Some([low, high]) = told.margin_of_c {
        margins.push(format!("{} < c < {}", words::fixed(low, 3), bound(high, 3)));
    }
    if let Some([low, high]) = told.margin_of_theta_rect {
        margins.push(format!("{}° < θrect ≤ {}°", words::fixed(low, 1), bound(high, 1)));
    }
    if !margins.is_empty() {
        ui.label(text(format!("Same choice for {}.", margins.join(" and "))).color(ink(palette.weak)));
    }
}

fn bound(x: f64, decimals: usize) -> String {
    if x.is_finite() { words::fixed(x, decimals) } else { "∞".to_owned() }
}

/// What the step that led here chose a side from.
fn candidates(ui: &mut Ui, candidates: &Candidates, palette: &Palette) {
    let (side, end) = match candidates.side {
        Side::Left => ("Left", "A"),
        Side::Right => ("Right", "B"),
    };
    let aim = format!("aims at {}°, within {}°", words::degrees(candidates.target), words::degrees(candidates.limit));
    heading(ui, &format!("{side} side at {end}"), &aim, palette);
    eframe::egui::Grid::new("candidates").num_columns(5).min_col_width(20.0).spacing([8.0, 3.0]).striped(true).show(
        ui,
        |ui| {
            for head in ["to", "angle °", "off °", "length", "verdict"] {
                ui.label(RichText::new(head).font(theme::regular(theme::HEAD)).color(ink(palette.weak)));
            }
            ui.end_row();
            for candidate in &candidates.edges {
                let colour = if candidate.passed.is_none() { palette.accent } else { palette.text };
                let to = match candidate.swap {
                    None => candidate.node.0.to_string(),
                    Some(ends) => format!("{} by {}", candidate.node.0, words::edge(ends)),
                };
                let verdict = candidate.passed.map_or("taken", words::passed);
                let (angle, off) = (words::degrees(candidate.angle), words::degrees(candidate.deviation));
                for text in [to, angle, off, words::fixed(candidate.length, 2), verdict.to_owned()] {
                    ui.label(RichText::new(text).font(theme::regular(theme::TABLE)).color(ink(colour)));
                }
                ui.end_row();
            }
        },
    );
}

fn segment(
    ui: &mut Ui,
    state: &mut State,
    moment: &Moment,
    place: usize,
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    let s = &moment.front[place];
    title(ui, format!("Front segment {}", words::segment(s.a, s.b)), palette);
    ui.horizontal_wrapped(|ui| {
        if Decision::of(&moment.phase).base == Some([s.a, s.b]) {
            ui.label(RichText::new("base").font(theme::semibold(theme::TABLE)).color(ink(palette.accent)));
        }
        let row = &moment.rows[place];
        let ring = moment.loops.get(row.front_loop as usize).map_or(String::new(), |ring| {
            let parity = if ring.segments.is_multiple_of(2) { "even" } else { "odd" };
            format!("  ·  loop {} of {}, {parity} ({})", row.front_loop + 1, moment.loops.len(), ring.segments)
        });
        let rank = if row.is_put_off { "put off".to_owned() } else { format!("rank {}", place + 1) };
        ui.label(note(format!("class {}  ·  level {}  ·  {rank}{ring}", s.class, s.level), palette));
    });
    if Decision::of(&moment.phase).base != Some([s.a, s.b]) {
        ui.add_space(4.0);
        let tip = "In place of the base that was just selected, or else at the next selection, whatever its rank: a change of the run";
        if ui.button("Choose as base").on_hover_text(tip).clicked() {
            commands.push(Command::ChooseBase([s.a, s.b]));
        }
    }
    heading(ui, "H-value", "eq. 6", palette);
    let h = [s.a, s.b].map(|n| moment.mesh.metric(n).min_size());
    line(ui, "H = ½ ( 1/√λA + 1/√λB )".to_owned(), palette);
    ui.horizontal(|ui| {
        line(ui, format!("    = ½ ( {} + {} ) =", words::size(h[0]), words::size(h[1])), palette);
        ui.label(
            RichText::new(words::size(s.h_value)).font(theme::semibold(theme::FORMULA)).color(ink(palette.strong)),
        );
    });
    heading(ui, "Frontal angles", "metric of the node", palette);
    for (side, name) in Side::BOTH.into_iter().zip(["θA", "θB"]) {
        angle(ui, moment, s, side, name, palette);
    }
    let ends_of = [s.a, s.b];
    let is_base = moment.base.as_ref().is_some_and(|told| [told.row.a, told.row.b] == ends_of);
    match &moment.base {
        Some(told) if is_base => why(ui, told, palette),
        _ => {
            if let Some(told) = state.explanation(ends_of) {
                why(ui, &told, palette);
            }
        }
    }
    if let Some(tried) = moment.candidates.as_ref().filter(|_| is_base) {
        candidates(ui, tried, palette);
    }
    heading(ui, "Length", "", palette);
    line(
        ui,
        format!("metric {}   ·   in the plane {}", words::fixed(s.length_metric, 3), words::size(s.length_physical)),
        palette,
    );
    heading(ui, "Ends", "h1 ≤ h2 of the metric", palette);
    ends(ui, moment, &[("A", s.a), ("B", s.b)], palette);
}

fn angle(ui: &mut Ui, moment: &Moment, s: &Segment, side: Side, name: &str, palette: &Palette) {
    let theta = s.theta[side.index()];
    let rect = moment.parameters.theta_rect;
    let which = words::side(side);
    let verdict = if theta < rect {
        format!("< {}°: {which} side is the front", words::fixed(rect.to_degrees(), 0))
    } else {
        format!("≥ {}°: {which} side is to be found", words::fixed(rect.to_degrees(), 0))
    };
    ui.horizontal(|ui| {
        line(ui, name.to_owned(), palette);
        let text = format!("{}°", words::degrees(theta));
        ui.label(RichText::new(text).font(theme::semibold(theme::FORMULA)).color(ink(palette.strong)));
        ui.label(RichText::new(verdict).font(theme::regular(theme::TABLE)).color(ink(palette.text)));
    });
}

fn ends(ui: &mut Ui, moment: &Moment, nodes: &[(&str, NodeId)], palette: &Palette) {
    eframe::egui::Grid::new("ends").num_columns(6).min_col_width(20.0).spacing([8.0, 3.0]).striped(true).show(
        ui,
        |ui| {
            for head in ["", "x", "y", "h1", "h2", "h1 axis °"] {
                ui.label(RichText::new(head).font(theme::regular(theme::HEAD)).color(ink(palette.weak)));
            }
            ui.end_row();
            for (name, node) in nodes {
                let (p, metric) = (moment.mesh.uv(*node), moment.mesh.metric(*node));
                let ([small, large], [_, across]) = metric.eigen();
                let mut axis = libm::atan2(across.y, across.x).to_degrees();
                if axis <= -90.0 {
                    axis += 180.0;
                } else if axis > 90.0 {
                    axis -= 180.0;
                }
                let numbers = [1.0 / large.sqrt(), 1.0 / small.sqrt()];
                let texts = [
                    format!("{name} {}", node.0),
                    words::size(p.x),
                    words::size(p.y),
                    words::size(numbers[0]),
                    words::size(numbers[1]),
                    words::fixed(axis, 1),
                ];
                for text in texts {
                    ui.label(RichText::new(text).font(theme::regular(theme::TABLE)).color(ink(palette.text)));
                }
                ui.end_row();
            }
        },
    );
}

fn edge(ui: &mut Ui, moment: &Moment, ends_of: [NodeId; 2], palette: &Palette) {
    title(ui, format!("Edge {}", words::edge(ends_of)), palette);
    let mesh = &moment.mesh;
    let h = ends_of
        .iter()
        .all(|n| mesh.has_node(*n))
        .then(|| {
            mesh.half_edge_between(ends_of[0], ends_of[1]).or_else(|| mesh.half_edge_between(ends_of[1], ends_of[0]))
        })
        .flatten();
    let Some(h) = h else { return gone(ui, "The edge", palette) };
    let around = [Some(h), mesh.twin(h)];
    let dead = around.iter().flatten().all(|h| mesh.is_quad(h.element()));
    let kind = if mesh.twin(h).is_none() {
        "boundary"
    } else if dead {
        "dead"
    } else {
        "live"
    };
    let of: Vec<String> = around.iter().flatten().map(|h| h.element().0.to_string()).collect();
    ui.label(note(format!("{kind}  ·  of elements {}", of.join(" and ")), palette));
    heading(ui, "Length", "eq. 4", palette);
    let plane = mesh.uv(ends_of[0]).distance(mesh.uv(ends_of[1]));
    line(ui, format!("metric {}   ·   in the plane {}", words::fixed(mesh.length(h), 3), words::size(plane)), palette);
    heading(ui, "Ends", "h1 ≤ h2 of the metric", palette);
    ends(ui, moment, &[("", ends_of[0]), ("", ends_of[1])], palette);
}

fn node(ui: &mut Ui, moment: &Moment, node: NodeId, palette: &Palette) {
    title(ui, format!("Node {}", node.0), palette);
    let mesh = &moment.mesh;
    if !mesh.has_node(node) {
        return gone(ui, "The node", palette);
    }
    let around: Vec<ElementId> = mesh.fan(node).map(|h| h.element()).collect();
    let dead = around.iter().filter(|e| mesh.is_quad(**e)).count();
    let place = if mesh.is_fixed(node) { "on the boundary" } else { "free" };
    let text = format!("{place}  ·  {} edges  ·  {} live, {dead} dead", mesh.valence(node), around.len() - dead);
    ui.label(note(text, palette));
    heading(ui, "Place and metric", "h1 ≤ h2", palette);
    ends(ui, moment, &[("", node)], palette);
    let sectors: Vec<&Segment> = moment.front.iter().filter(|s| s.a == node).collect();
    if !sectors.is_empty() {
        heading(ui, "Frontal angles", "fig. 9", palette);
    }
    for s in sectors {
        line(ui, format!("{}°  before {}", words::degrees(s.theta[0]), words::segment(s.a, s.b)), palette);
    }
    heading(ui, "Elements", "", palette);
    let ids: Vec<String> = around.iter().map(|e| e.0.to_string()).collect();
    ui.label(RichText::new(ids.join(", ")).font(theme::regular(theme::TABLE)).color(ink(palette.text)));
}

fn element(ui: &mut Ui, state: &State, moment: &Moment, e: ElementId, commands: &mut Vec<Command>, palette: &Palette) {
    let mesh = &moment.mesh;
    if !mesh.has_element(e) {
        title(ui, format!("Element {}", e.0), palette);
        return gone(ui, "The element", palette);
    }
    let quad = mesh.is_quad(e);
    title(ui, format!("{} {}", if quad { "Quadrilateral" } else { "Triangle" }, e.0), palette);
    let level = if quad { format!("  ·  level {}", mesh.level(e)) } else { String::new() };
    ui.label(note(format!("{}{level}", if quad { "dead" } else { "live" }), palette));
    heading(ui, "Quality", "metric", palette);
    line(
        ui,
        format!(
            "quality {}   ·   metric area {}",
            words::fixed(mesh.quality(e), 2),
            words::fixed(metric_area(mesh, e), 2)
        ),
        palette,
    );
    let [low, high] = angles(mesh, e);
    line(ui, format!("angles in the plane {}° to {}°", words::degrees(low), words::degrees(high)), palette);
    heading(ui, "Nodes", "h1 ≤ h2 of the metric", palette);
    let nodes: Vec<(&str, NodeId)> = mesh.corners(e).map(|n| ("", n)).collect();
    ends(ui, moment, &nodes, palette);
    let until = state.track.iter().take(moment.step as usize);
    let made = until.enumerate().rfind(|(_, t)| t.formed.is_some_and(|f| f.0 == e));
    if let Some((k, _)) = made.filter(|_| quad) {
        ui.add_space(6.0);
        let step = k as u64 + 1;
        if ui.button(format!("Made at step {}", words::grouped(step))).clicked() {
            commands.push(Command::Go(Goal::Step(step)));
        }
    }
}
