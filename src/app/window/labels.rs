//! What is laid over a view as text and curves: letters, H-values, frontal angles, node ids, ellipses, scale bar and axes. All of it
//! thins out by its size on the screen; a label that would cover an earlier one is dropped.

use eframe::egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, Ui, Vec2};
use glam::DVec2;

use super::session::Moment;
use super::state::State;
use super::theme::{self, ink};
use super::viewport::{Frame, class_colour};
use super::words;
use crate::core::front::sector::Side;
use crate::core::front::segment::Segment;
use crate::core::mesh::ids::NodeId;
use crate::render::palette::Palette;
use crate::render::scene::{ColourBy, Decision, Outlined, Shading};

/// Labels in a view, and ellipses.
const MOST_LABELS: usize = 150;
/// Ids stand where the nearest neighbour is so many points away.
const LEAST_FOR_IDS: f64 = 44.0;
const MOST_ELLIPSES: usize = 60;
/// Ellipses are drawn at this share of the unit length.
const ELLIPSE: f64 = 0.25;

/// Which view it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    Main,
    Lens,
    Whole,
}

/// Shows everything that is laid over a view.
pub fn show(ui: &Ui, frame: &Frame, state: &State, moment: &Moment, palette: &Palette, which: Which) {
    let painter = ui.painter_at(frame.rect);
    let mut over = Over { painter, frame, moment, palette, taken: Vec::new() };
    let decision = Decision::of(&moment.phase);
    if which == Which::Lens {
        over.unit_grid(state);
    }
    if which == Which::Whole {
        over.main_frame(state);
    }
    let small = over.small_view(which, &decision);
    if state.kept.layers.ellipses && which == Which::Main {
        over.ellipses();
    }
    if state.kept.layers.arcs && !small {
        over.wedges_and_arcs(&decision, which);
    }
    if !small {
        over.letters(&decision);
    }
    if state.kept.layers.labels && which != Which::Whole {
        over.base(&decision, which);
        if which == Which::Main {
            over.pointed(state);
            over.front_labels();
            over.node_ids(&decision);
        }
    }
    if which == Which::Main {
        over.scale_bar();
        over.axes();
    }
}

struct Over<'a> {
    painter: Painter,
    frame: &'a Frame,
    moment: &'a Moment,
    palette: &'a Palette,
    taken: Vec<Rect>,
}

impl Over<'_> {
    fn place(&self, node: NodeId) -> Option<Pos2> {
        let mesh = &self.moment.mesh;
        mesh.has_node(node).then(|| self.frame.place(mesh.uv(node)))
    }

    /// Whether the decision is too small on the screen to be lettered.
    fn small_view(&self, which: Which, decision: &Decision) -> bool {
        let Some([a, b]) = decision.base else { return false };
        let length = self.place(a).zip(self.place(b)).map_or(0.0, |(a, b)| a.distance(b));
        which == Which::Whole && length < 24.0
    }

    /// Puts a label down, unless it would cover one that is there; its plate is drawn first.
    fn label(&mut self, at: Pos2, anchor: Align2, text: &str, font: FontId, colour: Color32, plate: bool) -> bool {
        if self.taken.len() >= MOST_LABELS {
            return false;
        }
        let galley = self.painter.layout_no_wrap(text.to_owned(), font, colour);
        let rect = anchor.anchor_size(at, galley.size());
        let ground = rect.expand2(Vec2::new(4.0, 0.5));
        if !self.frame.rect.contains_rect(rect) || self.taken.iter().any(|taken| taken.intersects(ground)) {
            return false;
        }
        if plate {
            self.painter.rect_filled(ground, 3.0, ink(self.palette.label_plate));
        }
        self.painter.galley(rect.min, galley, colour);
        self.taken.push(ground);
        true
    }

    /// A, B, C and D, away from the middle of what they stand at.
    fn letters(&mut self, decision: &Decision) {
        let letters: Vec<(Pos2, char)> = decision.letters().filter_map(|(n, c)| Some((self.place(n)?, c))).collect();
        if letters.is_empty() {
            return;
        }
        let sum = letters.iter().fold(Vec2::ZERO, |sum, letter| sum + letter.0.to_vec2());
        let middle = (sum / letters.len() as f32).to_pos2();
        for (at, letter) in letters {
            let away = (at - middle).normalized();
            let away = if away.x.is_nan() || away == Vec2::ZERO { Vec2::new(0.0, -1.0) } else { away };
            let colour = ink(self.palette.accent);
            self.label(
                at + 17.0 * away,
                Align2::CENTER_CENTER,
                &letter.to_string(),
                theme::semibold(13.0),
                colour,
                true,
            );
        }
    }

    fn base(&mut self, decision: &Decision, which: Which) {
        let Some([a, b]) = decision.base else { return };
        let Some(segment) = self.moment.front.iter().find(|s| s.a == a && s.b == b) else { return };
        let Some((p, q)) = self.place(a).zip(self.place(b)) else { return };
        let across = (q - p).rot90().normalized();
        // The dead side lies to the right of A to B: down on the screen, turned by y.
        let at = p + 0.5 * (q - p) + 18.0 * Vec2::new(-across.x, -across.y);
        let text = match which {
            Which::Lens => words::fixed(segment.length_metric, 3),
            _ => format!("H {}", words::size(segment.h_value)),
        };
        if p.distance(q) > 44.0 {
            let anchor = Align2::CENTER_CENTER;
            self.label(at, anchor, &text, theme::semibold(12.5), ink(self.palette.accent), true);
        }
    }

    /// What is picked and hovered, named.
    fn pointed(&mut self, state: &State) {
        for (what, strong) in [(state.kept.picked, true), (state.hovered, false)] {
            let Some(what) = what else { continue };
            let Some(p) = super::viewport::middle(self.moment, what) else { continue };
            let text = match what {
                Outlined::Node(node) => format!("node {}", node.0),
                Outlined::Edge(ends) => match self.segment(ends) {
                    Some(s) => format!("{}  ·  {}  ·  H {}", words::segment(s.a, s.b), s.class, words::size(s.h_value)),
                    None => words::edge(ends),
                },
                Outlined::Element(e) if self.moment.mesh.is_quad(e) => format!("quadrilateral {}", e.0),
                Outlined::Element(e) => format!("triangle {}", e.0),
            };
            let font = if strong { theme::semibold(12.5) } else { theme::regular(12.0) };
            let at = self.frame.place(p) + Vec2::new(0.0, -16.0);
            self.label(at, Align2::CENTER_BOTTOM, &text, font, ink(self.palette.label), true);
        }
    }

    fn segment(&self, ends: [NodeId; 2]) -> Option<&Segment> {
        self.moment.front.iter().find(|s| [s.a, s.b] == ends || [s.b, s.a] == ends)
    }

    fn front_labels(&mut self) {
        let moment = self.moment;
        for segment in &moment.front {
            let Some((p, q)) = self.place(segment.a).zip(self.place(segment.b)) else { continue };
            if p.distance(q) < 70.0 || !self.frame.rect.contains(p + 0.5 * (q - p)) {
                continue;
            }
            let text = format!("{}  {}", segment.class, words::size(segment.h_value));
            let colour = ink(class_colour(self.palette, segment.class));
            self.label(p + 0.5 * (q - p), Align2::CENTER_CENTER, &text, theme::medium(11.5), colour, true);
        }
    }

    fn node_ids(&mut self, decision: &Decision) {
        let mesh = &self.moment.mesh;
        let scale = self.frame.camera.points_per_unit();
        for node in mesh.nodes() {
            let at = self.frame.place(mesh.uv(node));
            let lettered = decision.letters().any(|letter| letter.0 == node);
            if lettered || !self.frame.rect.contains(at) {
                continue;
            }
            let p = mesh.uv(node);
            let nearest = mesh.neighbours(node).map(|n| mesh.uv(n).distance_squared(p)).fold(f64::INFINITY, f64::min);
            if nearest.sqrt() * scale < LEAST_FOR_IDS {
                continue;
            }
            let colour = ink(self.palette.weak);
            if !self.label(
                at + Vec2::new(7.0, -9.0),
                Align2::LEFT_CENTER,
                &node.0.to_string(),
                theme::regular(11.0),
                colour,
                false,
            ) && self.taken.len() >= MOST_LABELS
            {
                break;
            }
        }
    }

    /// Wedges at corners that are sides already, arcs with their values where there is room.
    fn wedges_and_arcs(&mut self, decision: &Decision, which: Which) {
        let moment = self.moment;
        let rect = self.frame.rect.expand(40.0);
        for segment in &moment.front {
            let is_base = decision.base == Some([segment.a, segment.b]);
            let Some((p, q)) = self.place(segment.a).zip(self.place(segment.b)) else { continue };
            if !rect.contains(p) && !rect.contains(q) {
                continue;
            }
            for side in Side::BOTH {
                let at = [segment.a, segment.b][side.index()];
                let has_arc = decision.base.is_some_and(|base| base.contains(&at));
                if is_base && which != Which::Whole {
                    self.arc(segment, side);
                } else if !has_arc && segment.theta[side.index()] < moment.parameters.theta_rect {
                    self.wedge(segment, side);
                }
            }
        }
    }

    /// The place of the corner and the screen directions of its two legs, anticlockwise in the mesh, with their lengths.
    fn corner(&self, segment: &Segment, side: Side) -> Option<(Pos2, [Vec2; 2])> {
        let mesh = &self.moment.mesh;
        let h = mesh.front_between(segment.a, segment.b)?;
        let (at, from, to) = match side {
            Side::Left => (segment.a, segment.b, mesh.origin(mesh.front_before(h))),
            Side::Right => (segment.b, mesh.target(mesh.front_after(h)), segment.a),
        };
        let centre = self.place(at)?;
        Some((centre, [self.place(from)? - centre, self.place(to)? - centre]))
    }

    fn wedge(&self, segment: &Segment, side: Side) {
        let Some((centre, legs)) = self.corner(segment, side) else { return };
        if legs.iter().any(|leg| leg.length() < 40.0) {
            return;
        }
        let colour = ink(self.palette.label.faded(0.8));
        let mut points = vec![centre];
        points.extend(arc(centre, legs, 9.0));
        self.painter.add(Shape::convex_polygon(points, colour, Stroke::NONE));
    }

    fn arc(&mut self, segment: &Segment, side: Side) {
        let Some((centre, legs)) = self.corner(segment, side) else { return };
        if legs.iter().any(|leg| leg.length() < 40.0) {
            return;
        }
        let points = arc(centre, legs, 26.0);
        let middle = points[points.len() / 2];
        self.painter.add(Shape::line(points, Stroke::new(1.25, ink(self.palette.accent))));
        let name = if side == Side::Left { "A" } else { "B" };
        let text = format!("θ{name} {}°", words::degrees(segment.theta[side.index()]));
        let at = middle + 14.0 * (middle - centre).normalized();
        let anchor = if at.x < centre.x { Align2::RIGHT_CENTER } else { Align2::LEFT_CENTER };
        self.label(at, anchor, &text, theme::medium(12.0), ink(self.palette.accent), true);
    }

    fn ellipses(&self) {
        let mesh = &self.moment.mesh;
        let mut shown = 0;
        for node in mesh.nodes() {
            let p = mesh.uv(node);
            if !self.frame.rect.contains(self.frame.place(p)) {
                continue;
            }
            let ([small, large], [along, across]) = mesh.metric(node).eigen();
            let axes = [along * (ELLIPSE / small.sqrt()), across * (ELLIPSE / large.sqrt())];
            let centre = self.frame.place(p);
            if axes.iter().any(|axis| self.frame.place(p + *axis).distance(centre) < 4.0) {
                continue;
            }
            let point = |k: i32| {
                let t = f64::from(k) * std::f64::consts::TAU / 48.0;
                self.frame.place(p + axes[0] * libm::cos(t) + axes[1] * libm::sin(t))
            };
            let stroke = Stroke::new(1.0, ink(self.palette.ellipse));
            self.painter.add(Shape::closed_line((0..48).map(point).collect(), stroke));
            shown += 1;
            if shown == MOST_ELLIPSES {
                break;
            }
        }
    }

    /// The unit circle around the node of the lens, dashed, over a unit grid.
    fn unit_grid(&self, state: &State) {
        let (frame, palette) = (self.frame, self.palette);
        let Some(origin) = super::viewport::lens_node(state, self.moment).and_then(|node| self.place(node.0)) else {
            return;
        };
        let unit = frame.camera.scale as f32;
        let grid = Stroke::new(1.0, ink(palette.line));
        let lines = |from: f32, least: f32, most: f32| {
            let first = ((least - from) / unit).ceil() as i32;
            let last = ((most - from) / unit).floor() as i32;
            (first..=last).map(move |k| from + unit * k as f32)
        };
        for x in lines(origin.x, frame.rect.left(), frame.rect.right()) {
            self.painter.vline(x, frame.rect.y_range(), grid);
        }
        for y in lines(origin.y, frame.rect.top(), frame.rect.bottom()) {
            self.painter.hline(frame.rect.x_range(), y, grid);
        }
        let circle: Vec<Pos2> =
            (0..=96).map(|k| origin + unit * Vec2::angled(k as f32 * std::f32::consts::TAU / 96.0)).collect();
        let stroke = Stroke::new(1.0, ink(palette.weak));
        self.painter.extend(Shape::dashed_line(&circle, stroke, 4.0, 4.0));
    }

    /// What the main view shows, as a frame; only where it is smaller than this view.
    fn main_frame(&self, state: &State) {
        let Some(camera) = state.camera.filter(|_| !state.fitted) else { return };
        let size = state.view_size;
        let corners = [DVec2::ZERO, DVec2::new(size.x, 0.0), size, DVec2::new(0.0, size.y)];
        let corners = corners.map(|at| camera.unproject(at, size).map(|p| self.frame.place(p)));
        if let [Some(a), Some(b), Some(c), Some(d)] = corners {
            let stroke = Stroke::new(1.25, ink(self.palette.selection));
            self.painter.add(Shape::closed_line(vec![a, b, c, d], stroke));
        }
    }

    fn scale_bar(&self) {
        let scale = self.frame.camera.points_per_unit();
        let wanted = 120.0 / scale;
        let power = libm::pow(10.0, libm::floor(libm::log10(wanted)));
        let length = [5.0, 2.0, 1.0].into_iter().map(|k| k * power).find(|l| *l <= wanted).unwrap_or(power);
        let (left, y) = (self.frame.rect.left() + 18.0, self.frame.rect.bottom() - 20.0);
        let right = left + (length * scale) as f32;
        let stroke = Stroke::new(1.0, ink(self.palette.weak));
        self.painter.hline(left..=right, y, stroke);
        for x in [left, right] {
            self.painter.vline(x, y - 3.0..=y + 3.0, stroke);
        }
        let text = if (1e-4..1e5).contains(&length) { format!("{length}") } else { words::size(length) };
        let text = if text.len() > 8 { words::size(length) } else { text };
        let at = Pos2::new(right + 8.0, y);
        self.painter.text(at, Align2::LEFT_CENTER, text, theme::regular(11.5), ink(self.palette.weak));
    }

    fn axes(&self) {
        let origin = self.frame.rect.right_bottom() + Vec2::new(-42.0, -20.0);
        let stroke = Stroke::new(1.0, ink(self.palette.weak));
        let centre = self.frame.camera.centre;
        let at = |p: glam::DVec3| self.frame.camera.project(p, self.frame.size());
        for (axis, name) in [(glam::DVec3::X, "x"), (glam::DVec3::Y, "y")] {
            let d = (at(centre + axis) - at(centre)) / self.frame.camera.scale;
            let d = Vec2::new(d.x as f32, d.y as f32);
            self.painter.line_segment([origin, origin + 24.0 * d], stroke);
            let text = origin + 32.0 * d;
            self.painter.text(text, Align2::CENTER_CENTER, name, theme::regular(11.5), ink(self.palette.weak));
        }
    }
}

/// Points of the arc of `radius` from the first leg to the second, anticlockwise in the mesh (clockwise on a screen with y down
/// is the other way round).
fn arc(centre: Pos2, legs: [Vec2; 2], radius: f32) -> Vec<Pos2> {
    let from = legs[0].angle();
    let mut turn = from - legs[1].angle();
    if turn <= 0.0 {
        turn += std::f32::consts::TAU;
    }
    let count = (turn * 8.0).ceil().max(2.0) as i32;
    (0..=count).map(|k| centre + radius * Vec2::angled(from - turn * k as f32 / count as f32)).collect()
}

/// The legend of what elements are coloured by.
pub fn shading(ui: &Ui, frame: &Frame, shading: &Shading, palette: &Palette) {
    let Some(map) = shading.by.map() else { return };
    let painter = ui.painter_at(frame.rect);
    let (width, height) = (160.0, 8.0);
    let left = frame.rect.left() + 18.0;
    let top = frame.rect.bottom() - 62.0;
    let plate = Rect::from_min_size(Pos2::new(left - 8.0, top - 22.0), Vec2::new(width + 16.0, height + 44.0));
    painter.rect_filled(plate, 3.0, ink(palette.label_plate));
    for k in 0..32 {
        let x = left + width * k as f32 / 32.0;
        let cell = Rect::from_min_size(Pos2::new(x, top), Vec2::new(width / 32.0 + 0.5, height));
        painter.rect_filled(cell, 0.0, ink(map.at(k as f32 / 31.0)));
    }
    let font = theme::regular(theme::TIMELINE);
    let scale = if shading.logarithmic { ", logarithmic" } else { "" };
    let title = format!("{} ({}{scale})", shading.by.name(), map.name());
    painter.text(Pos2::new(left, top - 5.0), Align2::LEFT_BOTTOM, title, font.clone(), ink(palette.label));
    let number = |x: f64| match shading.by {
        ColourBy::Level | ColourBy::Birth => words::grouped(x.max(0.0) as u64),
        ColourBy::Angle => format!("{}°", words::fixed(x, 0)),
        ColourBy::Quality => words::fixed(x, 1),
        _ => words::size(x),
    };
    let y = top + height + 3.0;
    painter.text(Pos2::new(left, y), Align2::LEFT_TOP, number(shading.range[0]), font.clone(), ink(palette.label));
    painter.text(Pos2::new(left + width, y), Align2::RIGHT_TOP, number(shading.range[1]), font, ink(palette.label));
}
