//! A segment of the front: H-value, frontal angles, why it was or was not selected, and the candidates for its sides.

use eframe::egui::Ui;

use super::{ends, formula, heading, length, note, stands_for, table_head, table_row, title, why};
use crate::app::window::command::Command;
use crate::app::window::session::Moment;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::{icons, words};
use crate::core::convert::Candidates;
use crate::core::front::{Segment, Side};
use crate::core::run::Corner;
use crate::render::palette::Palette;
use crate::render::scene::{Decision, Outlined};

pub fn show(ui: &mut Ui, state: &State, moment: &Moment, place: usize, commands: &mut Vec<Command>, palette: &Palette) {
    let s = &moment.front[place];
    let is_base = Decision::of(&moment.phase).base == Some([s.a, s.b]);
    title(ui, format!("Front segment {}", words::segment(s.a, s.b)), palette);
    let row = &moment.rows[place];
    let mut about = format!("class {}  ·  level {}", s.class, s.level);
    if let Some(ring) = moment.loops.get(row.front_loop as usize) {
        let parity = if ring.segments.is_multiple_of(2) { "even" } else { "odd" };
        about += &format!("  ·  loop {} of {}, {parity} ({})", row.front_loop + 1, moment.loops.len(), ring.segments);
    }
    let rank = if row.is_deferred { "deferred".to_owned() } else { format!("rank {}", place + 1) };
    ui.horizontal_wrapped(|ui| {
        if is_base {
            let base = eframe::egui::RichText::new("base").font(theme::semibold(theme::TABLE));
            ui.label(base.color(ink(palette.accent)).background_color(ink(palette.accent_row)));
        } else {
            about = format!("{rank}  ·  {about}");
        }
        ui.label(note(about, palette));
    });
    let what = Outlined::Edge([s.a, s.b]);
    ui.add_space(3.0);
    ui.horizontal_wrapped(|ui| {
        let tip = "Replaces the base that was just selected, or the next base, whatever the rank. This changes the run";
        if !is_base && ui.button("Choose as base").on_hover_text(tip).clicked() {
            commands.push(Command::ChooseBase([s.a, s.b]));
        }
        super::past::actions(ui, state, what, commands);
    });
    h_value(ui, moment, s, palette);
    heading(ui, "Frontal angles", "metric of the node", palette);
    for (side, name) in Side::BOTH.into_iter().zip(["A", "B"]) {
        angle(ui, moment, s, side, name, palette);
    }
    why::show(ui, state, moment, place, commands, palette);
    match moment.candidates.as_ref().filter(|_| is_base) {
        Some(tried) => candidates(ui, moment, tried, s, commands, palette),
        None if is_base => {
            heading(ui, "Side edges", "4.3.4", palette);
            let text = "Step forward by one operation (Ctrl+Right) to see the candidates for a side.";
            ui.add(eframe::egui::Label::new(note(text, palette)).wrap());
        }
        None => {}
    }
    length(ui, s.length_metric, s.length_physical, palette);
    heading(ui, "Ends", "sizes of their metrics", palette);
    ends(ui, moment, &[("A", s.a), ("B", s.b)], commands, palette);
}

fn h_value(ui: &mut Ui, moment: &Moment, s: &Segment, palette: &Palette) {
    heading(ui, "H-value", "eq. 6", palette);
    let h = [s.a, s.b].map(|n| moment.mesh.smallest_size(n));
    let told = ["A", "B"].iter().zip(h).map(|(name, h)| {
        let lambda = 1.0 / (h * h);
        format!("\u{3bb}{name} = {}, \u{221a}\u{3bb}{name} = {}", words::size(lambda), words::size(1.0 / h))
    });
    let tip = told.collect::<Vec<_>>().join("\n");
    formula(ui, "H_{AB} = ½ ( 1/\u{221a}\u{3bb}_{A} + 1/\u{221a}\u{3bb}_{B} )", palette).on_hover_text(&tip);
    let numbers =
        format!("      = ½ ( {} + {} ) = **{}**", words::size(h[0]), words::size(h[1]), words::size(s.h_value));
    formula(ui, &numbers, palette).on_hover_text(tip);
}

fn angle(ui: &mut Ui, moment: &Moment, s: &Segment, side: Side, name: &str, palette: &Palette) {
    let theta = s.theta[side.index()];
    let parameters = &moment.parameters;
    let mesh = &moment.mesh;
    let which = words::side(side);
    let degrees = |angle: f64| words::fixed(angle.to_degrees(), 0);
    let neighbour = mesh.front_between(s.a, s.b).map(|h| match side {
        Side::Left => words::edge([mesh.origin(mesh.front_before(h)), s.a]),
        Side::Right => words::edge([s.b, mesh.target(mesh.front_after(h))]),
    });
    let front = neighbour.map_or(String::new(), |edge| format!(", {edge}"));
    let rect = degrees(parameters.theta_rect);
    let verdict = match Corner::of(theta, parameters) {
        Corner::Seam => format!(
            "\u{2264} {}° = \u{3b8}_{{seam}}: a seam; {which} side is the front{front}",
            degrees(parameters.theta_seam)
        ),
        Corner::Rectangle => format!("< {rect}°: {which} side is the front{front}"),
        Corner::Flat => format!("\u{2265} {rect}°: {which} side must be found"),
        Corner::Reversal => {
            format!("> {}° = \u{3b8}_{{revr}}: {which} side must be found", degrees(parameters.theta_revr))
        }
    };
    formula(ui, &format!("\u{3b8}_{{{name}}}  **{}°**  {verdict}", words::degrees(theta)), palette);
}

/// The candidates for a side in the last step.
fn candidates(
    ui: &mut Ui,
    moment: &Moment,
    tried: &Candidates,
    s: &Segment,
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    let (side, end, from) = match tried.side {
        Side::Left => ("Left", "A", s.a),
        Side::Right => ("Right", "B", s.b),
    };
    let swaps = tried.edges.iter().filter(|edge| edge.swap.is_some()).count();
    let count = |n: usize, one: &str| match n {
        0 => format!("no {one}"),
        1 => format!("1 {one}"),
        _ => format!("{n} {one}s"),
    };
    let edges = tried.edges.len() - swaps;
    let told = format!("{} tried, {}", count(edges, "edge"), count(swaps, "swap"));
    heading(ui, &format!("{side} side at {end}"), &told, palette);
    let aim = format!(
        "The target is {}° from the base; edges within {}° of it are accepted.",
        words::degrees(tried.target),
        words::degrees(tried.limit)
    );
    ui.add(eframe::egui::Label::new(note(aim, palette)).wrap());
    let widths = [60.0, 40.0, 34.0, 36.0];
    table_head(ui, &widths, &["edge", "angle °", "off °", "length", "verdict"], palette);
    for (k, candidate) in tried.edges.iter().enumerate() {
        let ends = [from, candidate.node];
        let verdict = match candidate.passed {
            None => format!("{} chosen", icons::CHECK),
            Some(passed) => words::passed(passed, candidate, tried),
        };
        let texts = [
            words::edge(ends),
            words::degrees(candidate.angle),
            words::degrees(candidate.deviation),
            words::fixed(candidate.length, 2),
            match candidate.swap {
                None => verdict,
                Some(across) => format!("swap {}: {verdict}", words::edge(across)),
            },
        ];
        let (colour, ground) = match candidate.passed {
            None => (palette.strong, Some(palette.accent_row)),
            Some(_) => (palette.text, (k % 2 == 1).then_some(palette.stripe)),
        };
        let response = table_row(ui, &widths, &texts, colour, ground);
        let there = moment.mesh.has_node(candidate.node) && moment.mesh.are_joined(from, candidate.node);
        let what = if there { Outlined::Edge(ends) } else { Outlined::Node(candidate.node) };
        stands_for(&response.on_hover_text(&texts[4]), what, commands);
    }
}
