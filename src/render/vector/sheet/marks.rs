//! Marks of constant size: each is placed where it fits on the page, or left out.

use glam::DVec2;

use super::Weights;
use super::frame::PageFrame;
use crate::render::look::{Ink, Layer, Look};
use crate::render::palette::{letter, note as note_ink};
use crate::render::picture::Mark;
use crate::render::vector::page::{Anchor, Cap, Coat, Page, Path, Stroke, width};

/// Radius of nodes and wedges, on paper in points as all that follows.
const NODE: f64 = 0.7;
const WEDGE: f64 = 2.2;
/// Radius of arcs, and the length of legs that an arc needs.
const ARC: f64 = 6.0;
const LEGS: f64 = 12.0;
/// Corners with a smaller angle count as narrow.
const NARROW: f64 = std::f64::consts::FRAC_PI_3;
/// An ellipse is drawn where its minor semi-axis is at least this long.
const MINOR: f64 = 0.8;

/// Marks being placed on the page.
pub struct Marks<'a> {
    page: &'a mut Page,
    frame: &'a PageFrame,
    weights: Weights,
    /// What no plate may cover, and boxes already occupied.
    taken: Vec<[DVec2; 2]>,
    has: [bool; 2],
    ink: Ink,
}

impl<'a> Marks<'a> {
    /// Starts without marks.
    pub fn new(page: &'a mut Page, frame: &'a PageFrame, look: &Look) -> Marks<'a> {
        let has = [Layer::Nodes, Layer::Ellipses].map(|layer| look.layers.has(layer));
        let weights = page.weights();
        Marks { page, frame, weights, taken: Vec::new(), has, ink: look.ink }
    }

    /// Draws marks: one path for each kind, then the text.
    pub fn draw(&mut self, marks: &[Mark]) {
        let [nodes, ellipses] = self.has;
        if ellipses {
            self.ellipses(marks);
        }
        self.wedges(marks);
        if nodes {
            self.nodes(marks);
        }
        for mark in marks {
            match mark {
                Mark::Letter { at, from, letter } => self.letter(*at, *from, *letter),
                Mark::Arc { at, legs, text, always } => self.arc(*at, *legs, text, *always),
                Mark::Beside { ends, text } => self.beside(*ends, text),
                Mark::Over { ends, text } => self.over(*ends, text),
                Mark::Wedge { .. } | Mark::Node(_) | Mark::Ellipse { .. } => {}
            }
        }
    }

    /// A width on paper as it is here.
    fn line(&self, width: f64) -> f64 {
        width * self.weights.line
    }

    fn nodes(&mut self, marks: &[Mark]) {
        let mut path = Path::default();
        for mark in marks {
            if let Mark::Node(at) = mark
                && self.frame.sees(&[*at])
            {
                let p = self.frame.place(*at);
                path.walk([p, p].into_iter(), false);
            }
        }
        let dot = Stroke { cap: Some(Cap::Round), ..Stroke::of(letter(self.ink), self.line(2.0 * NODE)) };
        self.page.path(path, Coat::line(dot));
    }

    fn ellipses(&mut self, marks: &[Mark]) {
        let mut path = Path::default();
        for mark in marks {
            let Mark::Ellipse { at, axes } = mark else { continue };
            let (p, axes) = (self.frame.place(*at), axes.map(|axis| self.frame.turned(axis)));
            if self.frame.sees(&[*at]) && axes.iter().all(|axis| axis.length() >= MINOR * self.weights.line) {
                let point = |k: i32| {
                    let t = f64::from(k) * std::f64::consts::TAU / 32.0;
                    p + axes[0] * libm::cos(t) + axes[1] * libm::sin(t)
                };
                path.walk((0..32).map(point), true);
            }
        }
        self.page.path(path, Coat::line(Stroke::of(note_ink(self.ink), self.line(0.35))));
    }

    fn wedges(&mut self, marks: &[Mark]) {
        let mut path = Path::default();
        let radius = WEDGE * self.weights.line;
        for mark in marks {
            let Mark::Wedge { at, legs } = mark else { continue };
            let legs = legs.map(|leg| self.frame.turned(leg));
            if self.frame.sees(&[*at]) && legs.iter().all(|leg| leg.length() >= 2.0 * radius) {
                let p = self.frame.place(*at);
                path.walk(std::iter::once(p).chain(arc(p, legs, radius)), true);
            }
        }
        self.page.path(path, Coat::area(letter(self.ink)));
    }

    /// Places a letter beside its point: opposite the point it avoids, or rotated from there until there is room.
    fn letter(&mut self, at: DVec2, from: DVec2, letter: char) {
        let p = self.frame.place(at);
        if !self.frame.sees(&[at]) {
            return;
        }
        let away = self.frame.turned(at - from).try_normalize().unwrap_or(DVec2::NEG_Y);
        let text = letter.to_string();
        let (label, k) = (self.weights.label(), self.weights.text);
        let half = DVec2::new(0.5 * width(&text, label) + 0.5 * k, 0.4 * label + 0.4 * k);
        for turn in [0, 1, -1, 2, -2, 3, -3, 4] {
            let t = f64::from(turn) * std::f64::consts::FRAC_PI_4;
            let d = away.rotate(DVec2::new(libm::cos(t), libm::sin(t)));
            let middle = p + d * (half.x.max(half.y) + 1.6 * k);
            if self.put(middle, half, &text, label) {
                return;
            }
        }
    }

    fn arc(&mut self, at: DVec2, legs: [DVec2; 2], text: &str, always: bool) {
        let (note, k) = (self.weights.note(), self.weights.text);
        let (p, legs) = (self.frame.place(at), legs.map(|leg| self.frame.turned(leg)));
        let room = legs[0].length().min(legs[1].length());
        if !self.frame.sees(&[at]) || (room < LEGS * k && !always) || room <= 0.0 {
            return;
        }
        let points: Vec<DVec2> = arc(p, legs, (ARC * k).min(0.8 * room)).collect();
        let Some(middle) = points.get(points.len() / 2) else { return };
        let d = (*middle - p).try_normalize().unwrap_or(DVec2::NEG_Y);
        let half = DVec2::new(0.5 * width(text, note) + 0.3 * k, 0.36 * note + 0.2 * k);
        let reach = (half.x * d.x.abs()) + (half.y * d.y.abs());
        // In a narrow corner, place the value where it has room between the legs.
        let across = (half.x * d.y.abs()) + (half.y * d.x.abs());
        // Anticlockwise in the mesh is clockwise on the page.
        let turn = libm::atan2(-legs[0].perp_dot(legs[1]), legs[0].dot(legs[1]));
        let is_narrow = (0.0..NARROW).contains(&turn);
        let narrow = if is_narrow { (across / libm::tan(0.5 * turn).max(1e-3) + reach).min(0.9 * room) } else { 0.0 };
        let away = ((*middle - p).length() + reach + 0.8 * k).max(narrow);
        if self.put(p + d * away, half, text, note) || always {
            let mut path = Path::default();
            path.walk(points.into_iter(), false);
            self.page.path(path, Coat::line(Stroke::of(note_ink(self.ink), self.line(0.4))));
        }
    }

    /// Places a text beside a line longer than the text is high, on its right side (beyond the front) or on its left.
    fn beside(&mut self, ends: [DVec2; 2], text: &str) {
        let (note, k) = (self.weights.note(), self.weights.text);
        let [p, q] = ends.map(|end| self.frame.place(end));
        let half = DVec2::new(0.5 * width(text, note) + 0.4 * k, 0.36 * note + 0.2 * k);
        let along = (q - p).try_normalize().unwrap_or(DVec2::X);
        // The extent of the text along the line.
        let needed = 2.0 * (half.x * along.x.abs()).max(half.y * along.y.abs()).min(half.x);
        if !self.frame.sees(&ends) || (q - p).length() < needed {
            return;
        }
        let right = DVec2::new(-along.y, along.x);
        for d in [right, -right] {
            let reach = half.x * d.x.abs() + half.y * d.y.abs() + k.max(0.5 * self.weights.line);
            if self.put(0.5 * (p + q) + d * reach, half, text, note) {
                return;
            }
        }
    }

    /// Places a text over the far part of a line that is not short.
    fn over(&mut self, ends: [DVec2; 2], text: &str) {
        let (note, k) = (self.weights.note(), self.weights.text);
        let [p, q] = ends.map(|end| self.frame.place(end));
        if !self.frame.sees(&ends) || (q - p).length() < LEGS * k {
            return;
        }
        let half = DVec2::new(0.5 * width(text, note) + 0.4 * k, 0.36 * note + 0.2 * k);
        let along = (q - p).normalize();
        // Beyond the end there is always room for one of several lines from a common point.
        let beyond = q + along * (half.x * along.x.abs() + half.y * along.y.abs() + k);
        for middle in [p + 0.62 * (q - p), p + 0.8 * (q - p), p + 0.45 * (q - p), beyond] {
            if self.put(middle, half, text, note) {
                return;
            }
        }
    }

    /// Draws a text on a plate, unless it would cover another or leave the frame.
    fn put(&mut self, middle: DVec2, half: DVec2, text: &str, size: f64) -> bool {
        let ground = [middle - half, middle + half];
        let covers = |[low, high]: &[DVec2; 2]| low.cmplt(ground[1]).all() && high.cmpgt(ground[0]).all();
        if !self.frame.holds(ground) || self.taken.iter().any(covers) {
            return false;
        }
        self.taken.push(ground);
        self.page.plate(ground);
        self.page.text(middle + DVec2::new(0.0, 0.35 * size), size, Anchor::Middle, text);
        true
    }
}

/// Points of the arc of `radius` from the first leg to the second, anticlockwise in the mesh, which is clockwise on the
/// page.
fn arc(centre: DVec2, legs: [DVec2; 2], radius: f64) -> impl Iterator<Item = DVec2> {
    let angle = |d: DVec2| libm::atan2(d.y, d.x);
    let from = angle(legs[0]);
    let mut turn = from - angle(legs[1]);
    if turn <= 0.0 {
        turn += std::f64::consts::TAU;
    }
    let count = (turn * 5.0).ceil().max(2.0) as i32;
    (0..=count).map(move |k| {
        let t = from - turn * f64::from(k) / f64::from(count);
        centre + radius * DVec2::new(libm::cos(t), libm::sin(t))
    })
}
