//! A segment of the front: H-value, frontal angles, why it was or was not selected, and the candidates for its sides.

use eframe::egui::Ui;

use super::rows::{self, Last, TableRow};
use super::{attempts, ends, formula, length, note, part, section, sentence, stands_for, step, title, why};
use crate::app::window::command::Command;
use crate::app::window::panels;
use crate::app::window::session::Moment;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::{icons, words};
use crate::core::case::{Selection, SelectionWindow};
use crate::core::convert::{Candidates, Event};
use crate::core::front::{Segment, Side};
use crate::core::run::explain::{self, Entry};
use crate::render::palette::Palette;
use crate::render::scene::{Decision, Outlined};

pub fn show(ui: &mut Ui, state: &State, moment: &Moment, place: usize, commands: &mut Vec<Command>, palette: &Palette) {
    let s = &moment.front[place];
    let is_base = Decision::of(&moment.phase).base == Some([s.a, s.b]);
    title(ui, format!("Front segment {}", words::segment([s.a, s.b])), palette);
    let row = &moment.rows[place];
    let mut about = format!("class {}  ·  level {}", s.class, s.level);
    if let Some(ring) = moment.loops.get(row.front_loop as usize) {
        let parity = if ring.segments.is_multiple_of(2) { "even" } else { "odd" };
        about += &format!("  ·  loop {} of {}, {parity} ({})", row.front_loop + 1, moment.loops.len(), ring.segments);
    }
    let rank = match moment.selecting.table.rank(row) {
        None if row.is_deferred => "deferred".to_owned(),
        None => "later face".to_owned(),
        Some(before) => {
            let of = moment.selecting.table.waiting_count() as u64;
            format!("rank {} of {}", words::grouped(before as u64 + 1), words::grouped(of))
        }
    };
    ui.horizontal_wrapped(|ui| {
        if is_base {
            let base = eframe::egui::RichText::new("base").font(theme::semibold(theme::TABLE));
            ui.label(base.color(ink(palette.accent)).background_color(ink(palette.accent_row)));
        } else {
            about = format!("{rank}  ·  {about}");
        }
        ui.label(note(about, palette));
    });
    let what = [s.a, s.b];
    ui.add_space(3.0);
    part(ui, "actions", |ui| {
        ui.horizontal_wrapped(|ui| {
            panels::actions::buttons(ui, state, Outlined::Edge(what), commands);
        })
    });
    // What the last step decided comes first: the choice of a side among candidates, or of the base.
    let tried = moment.candidates.as_ref().filter(|_| is_base);
    if let Some(tried) = tried {
        candidates(ui, state, moment, tried, s, commands, palette);
    }
    let is_selected = !is_base || matches!(moment.event, Some(Event::BaseSelected { .. }));
    if is_selected {
        why::show(ui, state, moment, what, commands, palette);
    } else if tried.is_none() {
        step::show(ui, moment, palette);
    }
    if is_base {
        step::next(ui, moment, palette);
    }
    if is_base {
        if moment.attempts.is_empty() {
            step::so_far(ui, moment, commands, palette);
        } else {
            attempts::show(ui, moment, commands, palette);
        }
    }
    if section(ui, "Frontal angles", "metric of the node", palette) {
        for (side, name) in Side::BOTH.into_iter().zip(["A", "B"]) {
            angle(ui, moment, s, side, name, palette);
        }
    }
    if !is_selected {
        why::show(ui, state, moment, what, commands, palette);
    }
    h_value(ui, moment, s, palette);
    key(ui, moment, place, palette);
    length(ui, s.length_metric, s.length_physical, palette);
    if section(ui, "Ends", "sizes of their metrics", palette) {
        ends(ui, moment, &[("A", s.a), ("B", s.b)], commands, palette);
    }
}

fn h_value(ui: &mut Ui, moment: &Moment, s: &Segment, palette: &Palette) {
    if !section(ui, "H-value", "eq. 6", palette) {
        return;
    }
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

/// The key by which the segment is ordered, where that is not its H alone, against what is within reach.
fn key(ui: &mut Ui, moment: &Moment, place: usize, palette: &Palette) {
    let (row, table) = (&moment.rows[place], &moment.selecting.table);
    let parameters = table.parameters();
    let [_, name] = explain::key_name(parameters);
    let own = explain::key_text(row, parameters);
    let text = match (parameters.selection, parameters.selection_window) {
        (Selection::Table1, SelectionWindow::MetricLengthTimesH) => {
            let [length, h] = [row.length_metric, row.h_value].map(words::size);
            format!("{name} = {length} \u{d7} {h} = **{own}**")
        }
        _ => format!("{name} = **{own}**"),
    };
    let reach = match parameters.selection {
        Selection::Table1 => format!(",   c\u{b7}H_{{min}} = {}", words::size(table.reach())),
        _ => String::new(),
    };
    if section(ui, "Key of the selection", "4.3.3", palette) {
        sentence(ui, &format!("{text}{reach}"), palette.text, palette);
    }
}

fn angle(ui: &mut Ui, moment: &Moment, s: &Segment, side: Side, name: &str, palette: &Palette) {
    let theta = s.theta[side.index()];
    let told = explain::corner(&moment.mesh, &moment.phase, &moment.parameters, [s.a, s.b], theta, side);
    sentence(ui, &format!("\u{3b8}_{{{name}}}  **{}\u{b0}**  {told}", words::degrees(theta)), palette.text, palette);
}

/// The candidates for a side in the last step.
pub(super) fn candidates(
    ui: &mut Ui,
    state: &State,
    moment: &Moment,
    tried: &Candidates,
    s: &Segment,
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    let from = [s.a, s.b][tried.side.index()];
    let told = explain::candidates(tried, from);
    if !section(ui, &told.title, &told.counts, palette) {
        return;
    }
    sentence(ui, &explain::side_rule(tried), palette.text, palette);
    if let Some(margins) = explain::side_margins(tried) {
        sentence(ui, &margins, palette.weak, palette);
    }
    let row = |(k, entry): (usize, &Entry)| {
        let mut texts = entry.texts.clone();
        let (colour, ground) = if entry.is_chosen {
            texts.iter_mut().last().into_iter().for_each(|verdict| *verdict = format!("{} {verdict}", icons::CHECK));
            (palette.strong, Some(palette.accent_row))
        } else {
            (palette.text, (k % 2 == 1).then_some(palette.stripe))
        };
        TableRow { texts, colour, ground }
    };
    let rows: Vec<TableRow> = told.entries.iter().enumerate().map(row).collect();
    let head: Vec<&str> = told.head.iter().map(String::as_str).collect();
    let shown = rows::table(ui, &head, &rows, Last::Words, palette);
    for (response, candidate) in shown.into_iter().zip(&told.entries).map(|(r, entry)| (r, &tried.edges[entry.place])) {
        let there = moment.mesh.has_node(candidate.node) && moment.mesh.are_joined(from, candidate.node);
        let what = if there { Outlined::Edge([from, candidate.node]) } else { Outlined::Node(candidate.node) };
        stands_for(&response, what, commands);
        response.context_menu(|ui| panels::actions::menu(ui, state, what, commands));
    }
}
