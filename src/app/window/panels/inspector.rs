//! The selection, or else the current decision or what is under the pointer, with numbers in the paper's formulas.

mod segment;
mod why;
mod edge;
mod node;
mod element;
mod step;
pub mod past;
mod chain;
mod attempts;

use eframe::egui::{Align, Label, Layout, Rect, Response, RichText, ScrollArea, Sense, Ui, UiBuilder, Vec2};

use super::{heading, inset, line, note, on_click, stands_for};
use crate::app::window::command::Command;
use crate::app::window::session::Moment;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::words;
use crate::core::mesh::{ElementId, NodeId};
use crate::core::run::MetricFacts;
use crate::render::palette::{Palette, Rgba};
use crate::render::scene::{Decision, Outlined};

/// Shows the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    let Some(moment) = state.run().moment.as_deref() else { return };
    let decision = Decision::of(&moment.phase).base.map(Outlined::Edge);
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        inset().show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 3.0;
            let shown = state.document().picked.or(decision).or(state.frame().hovered);
            match shown {
                None => {
                    step::show(ui, moment, palette);
                    step::next(ui, moment, palette);
                    ui.add_space(6.0);
                    ui.label(note("Point at anything to inspect it; click to select it.", palette));
                    if moment.step == 0 {
                        let text = "Right goes forward by one quadrilateral, Ctrl+Right by one operation; Left and \
                                    Ctrl+Left go back. While a quadrilateral is made, this panel says why its base \
                                    was selected.";
                        ui.add_space(6.0);
                        ui.add(Label::new(note(text, palette)).wrap());
                    }
                }
                Some(Outlined::Edge(ends)) => {
                    match moment.front.iter().position(|s| [s.a, s.b] == ends || [s.b, s.a] == ends) {
                        Some(place) => segment::show(ui, state, moment, place, commands, palette),
                        None => edge::show(ui, state, moment, ends, commands, palette),
                    }
                }
                Some(Outlined::Node(n)) => node::show(ui, state, moment, n, commands, palette),
                Some(Outlined::Element(e)) => element::show(ui, state, moment, e, commands, palette),
            }
            if shown.is_some() && moment.base.is_none() {
                step::show(ui, moment, palette);
                step::next(ui, moment, palette);
            }
            if let Some(what) = shown {
                past::show(ui, state, what, commands, palette);
            }
        });
    });
}

fn title(ui: &mut Ui, text: String, palette: &Palette) {
    ui.label(RichText::new(text).font(theme::semibold(theme::TITLE)).color(ink(palette.strong)));
}

/// Actions on what is shown.
fn actions(ui: &mut Ui, state: &State, what: Outlined, commands: &mut Vec<Command>) {
    ui.add_space(3.0);
    ui.horizontal_wrapped(|ui| past::actions(ui, state, what, commands));
}

/// A line of formulas: `_{x}` is a subscript, `**x**` is emphasised.
fn formula(ui: &mut Ui, text: &str, palette: &Palette) -> Response {
    ui.label(theme::formula(text, theme::FORMULA, ink(palette.text), ink(palette.strong)))
}

/// The same for a sentence.
fn sentence(ui: &mut Ui, text: &str, colour: Rgba, palette: &Palette) -> Response {
    ui.add(Label::new(theme::formula(text, theme::TABLE, ink(colour), ink(palette.strong))).wrap())
}

fn gone(ui: &mut Ui, what: &str, palette: &Palette) {
    ui.label(note(format!("{what} does not exist at this step."), palette));
}

/// The gap between columns in points.
const GAP: f32 = 7.0;

/// One row of a table in columns of fixed widths; the last one takes the rest. Long texts are cut and shown on hover.
fn table_row(ui: &mut Ui, widths: &[f32], texts: &[String], colour: Rgba, ground: Option<Rgba>) -> Response {
    // Numbers are aligned to the right, words to the left.
    let left_last = texts.last().is_some_and(|text| text.contains(char::is_alphabetic) && !text.ends_with('°'));
    let full = ui.available_width();
    let (rect, response) = ui.allocate_exact_size(Vec2::new(full, 20.0), Sense::click());
    if let Some(ground) = ground {
        ui.painter().rect_filled(rect.expand2(Vec2::new(4.0, 0.0)), 0.0, ink(ground));
    }
    let mut x = rect.left();
    for (k, text) in texts.iter().enumerate() {
        let is_last = k + 1 == texts.len();
        let width = if is_last { rect.right() - x } else { widths[k] };
        let cell = Rect::from_min_size(rect.min + Vec2::new(x - rect.left(), 0.0), Vec2::new(width.max(0.0), 20.0));
        let first = k == 0 || (is_last && left_last);
        let layout = if first { Layout::left_to_right(Align::Center) } else { Layout::right_to_left(Align::Center) };
        ui.scope_builder(UiBuilder::new().max_rect(cell).layout(layout), |ui| {
            ui.add(Label::new(line(text, colour)).selectable(false).truncate());
        });
        x += width + GAP;
    }
    response
}

/// The headings of such a table.
fn table_head(ui: &mut Ui, widths: &[f32], texts: &[&str], palette: &Palette) {
    let texts: Vec<String> = texts.iter().map(|text| (*text).to_owned()).collect();
    table_row(ui, widths, &texts, palette.weak, None);
}

/// A link that selects something.
fn link(ui: &mut Ui, text: String, what: Outlined, commands: &mut Vec<Command>, palette: &Palette) {
    let response = ui.add(Label::new(line(text, palette.text)).sense(Sense::click()).selectable(false));
    stands_for(&response.on_hover_cursor(eframe::egui::CursorIcon::PointingHand), what, commands);
}

/// The length of an edge, in the metric and in space.
fn length(ui: &mut Ui, metric: f64, physical: f64, palette: &Palette) {
    heading(ui, "Length", "eq. 4", palette);
    let text = format!("**{}** metric,  {} in space", words::fixed(metric, 2), words::size(physical));
    formula(ui, &text, palette).on_hover_text("In a plane case the parametric length is the length in space.");
}

/// Elements as links.
fn elements(ui: &mut Ui, name: &str, ids: &[ElementId], commands: &mut Vec<Command>, palette: &Palette) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        ui.label(note(format!("{name} ({})", ids.len()), palette));
        for &e in ids {
            link(ui, e.0.to_string(), Outlined::Element(e), commands, palette);
        }
    });
}

/// Nodes with their places and the sizes of their metrics.
fn ends(ui: &mut Ui, moment: &Moment, nodes: &[(&str, NodeId)], commands: &mut Vec<Command>, palette: &Palette) {
    let widths = [38.0, 44.0, 44.0, 48.0, 44.0];
    let axes = if moment.mesh.embedding().is_some() { ["u", "v"] } else { ["x", "y"] };
    table_head(ui, &widths, &["", axes[0], axes[1], "h\u{2081}", "h\u{2082}", "axis °"], palette);
    for (k, (name, node)) in nodes.iter().enumerate() {
        let p = moment.mesh.uv(*node);
        let told = MetricFacts::of(&moment.mesh, *node);
        let texts = [
            format!("{name} {}", node.0).trim().to_owned(),
            words::size(p.x),
            words::size(p.y),
            words::size(told.sizes[1]),
            words::size(told.sizes[0]),
            words::fixed(axis(told.directions[1]), 1),
        ];
        let ground = (k % 2 == 0).then_some(palette.stripe);
        let response = table_row(ui, &widths, &texts, palette.text, ground);
        let tip = format!(
            "node {}: h\u{2081} runs along the axis; M = ({}, {}, {}), \u{3bb} = {} and {}; click to select it",
            node.0,
            words::size(told.tensor[0]),
            words::size(told.tensor[1]),
            words::size(told.tensor[2]),
            words::size(told.lambda[1]),
            words::size(told.lambda[0]),
        );
        stands_for(&response.on_hover_text(tip), Outlined::Node(*node), commands);
    }
    if moment.mesh.embedding().is_none() {
        ui.label(note("Plane case: u = x, v = y, z = 0.", palette));
        return;
    }
    // On surfaces the columns are coordinates in the chart; those in space follow.
    for (name, node) in nodes {
        let [x, y, z] = moment.mesh.xyz(*node).to_array().map(words::size);
        ui.label(note(format!("{name} {} in space: {x}, {y}, {z}.", node.0), palette));
    }
}

/// The angle of a direction with the x axis, from \u{2212}90 (excluded) to 90 degrees.
fn axis([x, y]: [f64; 2]) -> f64 {
    let angle = libm::atan2(y, x).to_degrees();
    if angle <= -90.0 {
        angle + 180.0
    } else if angle > 90.0 {
        angle - 180.0
    } else {
        angle
    }
}
