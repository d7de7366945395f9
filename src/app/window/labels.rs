//! Text and curves over a view: letters, H-values, frontal angles, node ids, ellipses, scale bar and axes. Small
//! details are left out; a label that would cover an earlier one is dropped, but for the name of what is pointed at.

mod corners;
mod far_base;
mod measures;
mod refused;
mod study;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use eframe::egui::{Align2, Color32, FontId, Galley, Painter, Pos2, Rect, Ui, Vec2};

pub use measures::shading;

use super::presentation::Audience;
use super::session::Moment;
use super::state::State;
use super::study::Study;
use super::theme::{self, ink};
use super::viewport::{ViewFrame, class_colour};
use super::words;
use crate::core::front::Segment;
use crate::core::mesh::{ElementId, NodeId};
use crate::core::run::explain;
use crate::render::palette::Palette;
use crate::render::pick::Cover;
use crate::render::scene::{Decision, Outlined, Scene};
use glam::{DVec2, DVec3};

/// The greatest number of labels in a view, and of ellipses.
const MOST_LABELS: usize = 150;
/// A node shows its id if its nearest neighbour is at least this many points away.
const LEAST_FOR_IDS: f64 = 34.0;
const MOST_ELLIPSES: usize = 60;
/// Ellipses are drawn at this fraction of the unit length.
const ELLIPSE: f64 = 0.25;

/// How far the plate of a label reaches beyond its text.
const PLATE: Vec2 = Vec2::new(4.0, 0.5);
/// The sides of a place at which its name may stand, in the order in which they are tried.
const NAME_SIDES: [(Align2, Vec2); 4] = [
    (Align2::CENTER_BOTTOM, Vec2::new(0.0, -16.0)),
    (Align2::CENTER_TOP, Vec2::new(0.0, 16.0)),
    (Align2::RIGHT_CENTER, Vec2::new(-20.0, 0.0)),
    (Align2::LEFT_CENTER, Vec2::new(20.0, 0.0)),
];

/// How long new labels fade in after a zoom, in seconds.
const COMING: f64 = 0.12;

/// The labels of the frame before, so that labels which a zoom adds fade in.
#[derive(Default)]
pub struct Memory {
    scale: f64,
    zoomed: f64,
    labels: BTreeMap<String, f64>,
}

/// What a view is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewRole {
    Main,
    Lens,
    Whole,
}

/// The view of a scene that is labelled, and in space the part of it that hides labels.
#[derive(Clone, Copy)]
pub struct LabelledScene<'a> {
    pub frame: &'a ViewFrame,
    pub scene: &'a Scene,
    pub cover: Option<&'a Cover>,
}

/// Shows all labels of a view.
pub fn show(
    ui: &Ui,
    seen: &LabelledScene<'_>,
    state: &State,
    moment: &Moment,
    palette: &Palette,
    which: ViewRole,
    audience: Option<Audience>,
    memory: &mut Memory,
) {
    let LabelledScene { frame, scene, cover } = *seen;
    let painter = ui.painter_at(frame.rect);
    let now = ui.input(|input| input.time);
    let scale = frame.camera.points_per_unit();
    // The other views have another scale at every step: their labels do not fade in, or they would be dark while
    // playing.
    if scale != memory.scale && which == ViewRole::Main {
        (memory.scale, memory.zoomed) = (scale, now);
    }
    let before = std::mem::take(&mut memory.labels);
    let is_new = (now - memory.zoomed < COMING && !before.is_empty()).then_some(now);
    let mut over = Labels {
        painter,
        frame,
        scene,
        cover,
        moment,
        palette,
        taken: Vec::new(),
        before,
        is_new,
        now,
        labels: BTreeMap::new(),
        type_scale: audience.map_or(1.0, |audience| audience.type_scale),
        numbers_letters: state.shown_study().is_some(),
    };
    let decision = Decision::of(&moment.phase);
    if which == ViewRole::Lens {
        over.unit_grid(state);
    }
    if which == ViewRole::Whole {
        over.main_frame(state);
    }
    if which == ViewRole::Main {
        over.taken.extend(super::viewport::tools_area(frame.rect, moment));
        over.scale_bar();
        over.axes();
    }
    let small = over.small_view(which, &decision);
    if cover.is_some() {
        over.lens_in_space(state);
    }
    if state.document().layers.ellipses && which == ViewRole::Main {
        over.ellipses();
    }
    if !small {
        // An audience and a learner have the letters of what has just been done, too.
        let is_told = audience.is_some() || state.shown_study().is_some();
        over.letters(&if is_told { moment.decision() } else { decision });
    }
    let labels_segments = state.shown_study().is_none_or(Study::labels_segments);
    if state.document().layers.labels && which != ViewRole::Whole && labels_segments {
        over.base(&decision, which);
    }
    let names_things = state.document().layers.labels && which == ViewRole::Main;
    let tells_classes = labels_segments && !state.hides_classes();
    if which == ViewRole::Main {
        over.study(state);
    }
    // What is pointed at has its name, whatever else stands there.
    if names_things {
        over.pointed(state);
    }
    if which != ViewRole::Whole && !state.hides_candidates() {
        over.refused(state.frame().hovered.filter(|_| names_things));
    }
    if state.document().layers.arcs && !small {
        over.wedges_and_arcs(&decision, which);
    }
    if names_things && tells_classes {
        over.front_labels(&decision);
    }
    if names_things {
        over.node_ids(&decision);
    }
    if which == ViewRole::Main {
        over.far_base(&decision);
    }
    memory.labels = over.labels;
    if memory.labels.values().any(|since| now - since < COMING) {
        ui.ctx().request_repaint();
    }
}

/// A rectangle moved as little as puts it into another one.
fn within(rect: Rect, view: Rect) -> Rect {
    let least = (view.max - rect.max).min(Vec2::ZERO);
    let moved = rect.translate(least);
    moved.translate((view.min - moved.min).max(Vec2::ZERO))
}

struct Labels<'a> {
    painter: Painter,
    frame: &'a ViewFrame,
    scene: &'a Scene,
    cover: Option<&'a Cover>,
    moment: &'a Moment,
    palette: &'a Palette,
    taken: Vec<Rect>,
    /// Labels of the frame before, with the times at which they came, and those of this one.
    before: BTreeMap<String, f64>,
    labels: BTreeMap<String, f64>,
    /// The time at which new labels start to fade in; none if they do not.
    is_new: Option<f64>,
    now: f64,
    /// How much larger all of them are than in the window.
    type_scale: f32,
    /// Whether the letters have the numbers of their nodes.
    numbers_letters: bool,
}

impl Labels<'_> {
    /// Where a node lies on the screen; none if it does not exist or is hidden.
    fn place(&self, node: NodeId) -> Option<Pos2> {
        let spot = self.scene.spot(node).filter(|_| self.moment.mesh.has_node(node))?;
        self.on_screen(spot.at)
    }

    /// Where a place of the scene lies on the screen; none if it is hidden.
    fn on_screen(&self, place: DVec3) -> Option<Pos2> {
        let seen = self.frame.camera.seen(place, self.frame.size());
        let hidden = self.cover.is_some_and(|cover| cover.hides(seen));
        (!hidden).then(|| self.frame.rect.min + Vec2::new(seen.x as f32, seen.y as f32))
    }

    /// The place in the scene of a point of the plane.
    fn lifted(&self, p: DVec2) -> DVec3 {
        match self.moment.mesh.embedding() {
            Some(embedding) if self.scene.form().is_in_space() => embedding.atlas.xyz(p),
            _ => p.extend(0.0),
        }
    }

    /// Whether the surface is seen from behind at a node, so that anticlockwise in the mesh is clockwise on the screen.
    fn is_behind(&self, node: NodeId) -> bool {
        self.scene.spot(node).is_some_and(|spot| spot.normal.dot(self.frame.camera.towards()) < 0.0)
    }

    /// Whether the decision is too small on the screen for letters.
    fn small_view(&self, which: ViewRole, decision: &Decision) -> bool {
        let Some([a, b]) = decision.base else { return false };
        let length = self.place(a).zip(self.place(b)).map_or(0.0, |(a, b)| a.distance(b));
        which == ViewRole::Whole && length < 24.0
    }

    fn sized(&self, font: FontId) -> FontId {
        FontId { size: self.type_scale * font.size, ..font }
    }

    /// Adds a label, unless it would cover another one; its plate is drawn first.
    fn label(&mut self, at: Pos2, anchor: Align2, text: &str, font: FontId, colour: Color32) -> bool {
        if self.taken.len() >= MOST_LABELS {
            return false;
        }
        let galley = self.painter.layout_no_wrap(text.to_owned(), self.sized(font), colour);
        let rect = anchor.anchor_size(at, galley.size());
        let is_free = self.frame.rect.contains_rect(rect) && self.is_free(rect);
        if is_free {
            self.put(rect, galley, colour);
        }
        is_free
    }

    /// Adds the name of a place in the view: beside it, where it covers no earlier label if there is such a side, and
    /// wholly in the view.
    fn name(&mut self, place: Pos2, text: &str, font: FontId, colour: Color32) {
        let galley = self.painter.layout_no_wrap(text.to_owned(), self.sized(font), colour);
        let view = self.frame.rect.shrink2(PLATE);
        let rects = NAME_SIDES.map(|(anchor, away)| within(anchor.anchor_size(place + away, galley.size()), view));
        let is_clear = |rect: &&Rect| self.is_free(**rect) && !rect.expand2(PLATE).contains(place);
        let rect = rects.iter().find(is_clear).copied().unwrap_or(rects[0]);
        self.put(rect, galley, colour);
    }

    /// Whether a label covers no earlier one.
    fn is_free(&self, rect: Rect) -> bool {
        let ground = rect.expand2(PLATE);
        !self.taken.iter().any(|taken| taken.intersects(ground))
    }

    /// Draws a label and its plate, and takes its place.
    fn put(&mut self, rect: Rect, galley: Arc<Galley>, colour: Color32) {
        let text = galley.text().to_owned();
        let since = self.before.get(&text).copied().or(self.is_new).unwrap_or(f64::NEG_INFINITY);
        self.labels.insert(text, since);
        let share = ((self.now - since) / COMING).clamp(0.05, 1.0) as f32;
        let ground = rect.expand2(PLATE);
        self.painter.rect_filled(ground, 3.0, ink(self.palette.label_plate).gamma_multiply(share));
        self.painter.add(eframe::egui::epaint::TextShape::new(rect.min, galley, colour).with_opacity_factor(share));
        self.taken.push(ground);
    }

    /// The letters A, B, C and D, on the outer side of their nodes.
    fn letters(&mut self, decision: &Decision) {
        let letters: Vec<(Pos2, NodeId, char)> =
            decision.letters().filter_map(|(n, c)| Some((self.place(n)?, n, c))).collect();
        if letters.is_empty() {
            return;
        }
        let sum = letters.iter().fold(Vec2::ZERO, |sum, letter| sum + letter.0.to_vec2());
        let middle = (sum / letters.len() as f32).to_pos2();
        let room = if self.numbers_letters { 24.0 } else { 17.0 };
        for (at, node, letter) in letters {
            let away = (at - middle).normalized();
            let away = if away.x.is_nan() || away == Vec2::ZERO { Vec2::new(0.0, -1.0) } else { away };
            // Answers name nodes by their numbers.
            let text = if self.numbers_letters { format!("{letter} {}", node.0) } else { letter.to_string() };
            let (font, colour) = (theme::semibold(13.0), ink(self.palette.accent));
            self.label(at + room * self.type_scale * away, Align2::CENTER_CENTER, &text, font, colour);
        }
    }

    fn base(&mut self, decision: &Decision, which: ViewRole) {
        let Some([a, b]) = decision.base else { return };
        let Some(segment) = self.moment.front.iter().find(|s| s.a == a && s.b == b) else { return };
        let Some((p, q)) = self.place(a).zip(self.place(b)) else { return };
        let across = (q - p).rot90().normalized();
        // The dead side lies to the right of A to B: down on the screen, turned by y.
        let across = if self.is_behind(a) { -across } else { across };
        let at = p + 0.5 * (q - p) + 18.0 * self.type_scale * Vec2::new(-across.x, -across.y);
        let text = match which {
            ViewRole::Lens => words::fixed(segment.length_metric, 3),
            _ => format!("H {}", words::size(segment.h_value)),
        };
        if p.distance(q) > 44.0 {
            let anchor = Align2::CENTER_CENTER;
            self.label(at, anchor, &text, theme::semibold(12.5), ink(self.palette.accent));
        }
    }

    /// The names of what is selected and of what is under the pointer.
    fn pointed(&mut self, state: &State) {
        for (what, strong) in [(state.document().picked, true), (state.frame().hovered, false)] {
            let Some(what) = what else { continue };
            let Some(p) = super::viewport::middle(self.moment, what) else { continue };
            let text = match what {
                Outlined::Node(node) => format!("node {}", node.0),
                Outlined::Edge(ends) => match self.segment(ends) {
                    Some(s) if !state.hides_classes() => self.about_segment(s),
                    Some(s) => words::segment([s.a, s.b]),
                    None => words::edge(ends),
                },
                Outlined::Element(e) => self.about_element(e),
            };
            let why = self.moment.refused().into_iter().find(|candidate| candidate.is(what));
            let text = why.map_or(text.clone(), |candidate| format!("{text}  ·  {}", candidate.reason));
            let font = if strong { theme::semibold(12.5) } else { theme::regular(12.0) };
            let Some(at) = self.on_screen(self.lifted(p)).filter(|at| self.frame.rect.contains(*at)) else { continue };
            self.name(at, &text, font, ink(self.palette.label));
        }
    }

    fn about_element(&self, e: ElementId) -> String {
        let kind = if self.moment.mesh.is_quad(e) { "quadrilateral" } else { "triangle" };
        format!("{kind} {}", e.0)
    }

    /// A front segment with its class, H, and the key by which it is ordered.
    fn about_segment(&self, s: &Segment) -> String {
        let table = &self.moment.selecting.table;
        let [key, _] = explain::key_name(table.parameters());
        let row = table.rows.iter().find(|row| [row.a, row.b] == [s.a, s.b]);
        let key = row.map_or(String::new(), |row| format!("  ·  {key} {}", explain::key_text(row, table.parameters())));
        format!("{}  ·  class {}  ·  H {}{key}", words::segment([s.a, s.b]), s.class, words::size(s.h_value))
    }

    fn segment(&self, ends: [NodeId; 2]) -> Option<&Segment> {
        self.moment.front.iter().find(|s| [s.a, s.b] == ends || [s.b, s.a] == ends)
    }

    fn front_labels(&mut self, decision: &Decision) {
        let moment = self.moment;
        for segment in moment.front.iter().filter(|s| decision.base != Some([s.a, s.b])) {
            let Some((p, q)) = self.place(segment.a).zip(self.place(segment.b)) else { continue };
            if p.distance(q) < 70.0 * self.type_scale || !self.frame.rect.contains(p + 0.5 * (q - p)) {
                continue;
            }
            let text = format!("{}  {}", segment.class, words::size(segment.h_value));
            let colour = ink(class_colour(self.palette, segment.class));
            self.label(p + 0.5 * (q - p), Align2::CENTER_CENTER, &text, theme::medium(11.5), colour);
        }
    }

    fn node_ids(&mut self, decision: &Decision) {
        let mesh = &self.moment.mesh;
        let scale = self.frame.camera.points_per_unit();
        // Those of the front come first: what is asked and said is about them.
        let on_front: BTreeSet<NodeId> = self.moment.front.iter().map(|segment| segment.a).collect();
        let others = mesh.nodes().filter(|node| !on_front.contains(node));
        for node in on_front.iter().copied().chain(others) {
            let (Some(at), Some(spot)) = (self.place(node), self.scene.spot(node)) else { continue };
            let lettered = decision.letters().any(|letter| letter.0 == node);
            if lettered || !self.frame.rect.contains(at) {
                continue;
            }
            let near = mesh.neighbours(node).filter_map(|n| self.scene.spot(n));
            let nearest = near.map(|s| s.at.distance_squared(spot.at)).fold(f64::INFINITY, f64::min);
            if nearest.sqrt() * scale < LEAST_FOR_IDS * f64::from(self.type_scale) {
                continue;
            }
            let (text, font, colour) = (node.0.to_string(), theme::regular(11.0), ink(self.palette.weak));
            let is_shown =
                self.label(at + self.type_scale * Vec2::new(7.0, -9.0), Align2::LEFT_CENTER, &text, font, colour);
            if !is_shown && self.taken.len() >= MOST_LABELS {
                break;
            }
        }
    }
}
