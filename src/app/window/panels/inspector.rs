//! The selection, or else the current decision or what is under the pointer, with numbers in the paper's formulas.

mod segment;
mod rows;
mod why;
mod edge;
mod node;
mod element;
mod step;
mod past;
mod chain;
mod attempts;

use eframe::egui::collapsing_header::CollapsingState;
use eframe::egui::{
    Align, Align2, Id, Label, Layout, Response, RichText, Role, ScrollArea, Sense, Ui, UiBuilder, Vec2, WidgetInfo,
};

use super::{actions, inset, line, note, on_click, part, stands_for};
use crate::app::window::command::Command;
use crate::app::window::session::Moment;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::{icons, words};
use crate::core::mesh::{ElementId, NodeId};
use crate::core::run::MetricFacts;
use crate::render::palette::{Palette, Rgba};
use crate::render::scene::{Decision, Outlined};
use rows::{Last, TableRow};

/// What the panel keeps for itself.
#[derive(Default)]
pub struct InspectorState {
    /// The last request to show a chain that it has followed.
    chained: u64,
    /// The quadrilateral whose chain is still to be shown.
    seeks: Option<ElementId>,
}

/// Shows the panel.
pub fn show(ui: &mut Ui, state: &State, local: &mut InspectorState, commands: &mut Vec<Command>, palette: &Palette) {
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
                Some(Outlined::Element(e)) => element::show(ui, state, local, moment, e, commands, palette),
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

/// The candidates for the side of the last step, where it chose one. Returns whether it did.
pub fn candidates_of_base(
    ui: &mut Ui,
    state: &State,
    moment: &Moment,
    commands: &mut Vec<Command>,
    palette: &Palette,
) -> bool {
    let base = Decision::of(&moment.phase).base;
    let segment = base.and_then(|ends| moment.front.iter().find(|s| [s.a, s.b] == ends));
    let Some((tried, segment)) = moment.candidates.as_ref().zip(segment) else { return false };
    segment::candidates(ui, state, moment, tried, segment, commands, palette);
    true
}

fn title(ui: &mut Ui, text: String, palette: &Palette) {
    ui.label(RichText::new(text).font(theme::semibold(theme::TITLE)).color(ink(palette.strong)));
}

/// What can be done with what is shown.
fn offered(ui: &mut Ui, state: &State, what: Outlined, commands: &mut Vec<Command>) {
    ui.add_space(3.0);
    part(ui, "actions", |ui| ui.horizontal_wrapped(|ui| actions::buttons(ui, state, what, commands)));
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

/// Whether a section is unfolded.
fn folding(ui: &Ui, title: &str) -> CollapsingState {
    CollapsingState::load_with_default_open(ui.ctx(), Id::unique(("section of the inspector", title)), true)
}

/// The head of a section, which a click folds or unfolds; its source stands at the right where there is room. Returns
/// whether the section is unfolded.
fn section(ui: &mut Ui, title: &str, source: &str, palette: &Palette) -> bool {
    ui.add_space(8.0);
    let mut state = folding(ui, title);
    let id = state.id();
    let (rect, _) = ui.allocate_exact_size(Vec2::new(ui.available_width(), 22.0), Sense::hover());
    let response = ui.interact(rect, id.with("head"), Sense::click());
    if response.clicked() {
        state.toggle(ui);
        state.store(ui.ctx());
    }
    let is_open = state.is_open();
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_open, title));
    let colour = ink(if response.hovered() { palette.text } else { palette.weak });
    let icon = if is_open { icons::CARET_DOWN } else { icons::CARET_RIGHT };
    let left = rect.left_center() - Vec2::new(4.0, 0.0);
    ui.painter().text(left, Align2::LEFT_CENTER, icon, theme::regular(theme::HEAD), colour);
    let name = ui.painter().layout_no_wrap(title.to_owned(), theme::semibold(theme::BODY), ink(palette.strong));
    let at = left + Vec2::new(14.0, -0.5 * name.size().y);
    let said = RichText::new(source).font(theme::regular(theme::HEAD)).color(ink(palette.weak));
    let room = ui.painter().layout_no_wrap(source.to_owned(), theme::regular(theme::HEAD), ink(palette.weak)).size().x;
    if at.x + name.size().x + 10.0 + room <= rect.right() {
        let right = UiBuilder::new().max_rect(rect).layout(Layout::right_to_left(Align::Center));
        ui.scope_builder(right, |ui| ui.add(Label::new(said).selectable(false)));
    } else if is_open {
        ui.add(Label::new(said).wrap());
    }
    ui.painter().galley(at, name, ink(palette.strong));
    is_open
}

/// A link that selects something.
fn link(ui: &mut Ui, text: String, what: Outlined, commands: &mut Vec<Command>, palette: &Palette) {
    let response = ui.add(Label::new(line(text, palette.text)).sense(Sense::click()).selectable(false));
    stands_for(&response.on_hover_cursor(eframe::egui::CursorIcon::PointingHand), what, commands);
}

/// The length of an edge, in the metric and in space.
fn length(ui: &mut Ui, metric: f64, physical: f64, palette: &Palette) {
    if !section(ui, "Length", "eq. 4", palette) {
        return;
    }
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
    let axes = if moment.mesh.embedding().is_some() { ["u", "v"] } else { ["x", "y"] };
    let facts: Vec<MetricFacts> = nodes.iter().map(|node| MetricFacts::of(&moment.mesh, node.1)).collect();
    let row = |k: usize| {
        let ((name, node), told) = (nodes[k], &facts[k]);
        let p = moment.mesh.uv(node);
        let texts = vec![
            format!("{name} {}", node.0).trim().to_owned(),
            words::size(p.x),
            words::size(p.y),
            words::size(told.sizes[1]),
            words::size(told.sizes[0]),
            words::fixed(axis(told.directions[1]), 1),
        ];
        TableRow { texts, colour: palette.text, ground: k.is_multiple_of(2).then_some(palette.stripe) }
    };
    let rows: Vec<TableRow> = (0..nodes.len()).map(row).collect();
    let head = ["node", axes[0], axes[1], "h\u{2081}", "h\u{2082}", "axis °"];
    let shown = rows::table(ui, &head, &rows, Last::Numbers, palette);
    for ((response, (_, node)), told) in shown.into_iter().zip(nodes).zip(&facts) {
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
