//! Measures: metric ellipses, the unit grid of the lens, the frame of the main view, scale bar and axes, and the legend
//! of colours.

use eframe::egui::{Align2, Pos2, Rect, Shape, Stroke, Ui, Vec2};
use glam::DVec2;

use super::{ELLIPSE, Labels, MOST_ELLIPSES};
use crate::app::window::state::{State, SurfaceView, ViewCamera};
use crate::app::window::theme::{self, ink};
use crate::app::window::viewport::{self, ViewFrame};
use crate::app::window::words;
use crate::core::mesh::NodeId;
use crate::render::palette::Palette;
use crate::render::scene::{ColourBy, Shading};

impl Labels<'_> {
    pub(super) fn ellipses(&self) {
        let mesh = &self.moment.mesh;
        let mut shown = 0;
        for node in mesh.nodes() {
            let Some(centre) = self.place(node).filter(|at| self.frame.rect.contains(*at)) else { continue };
            let ellipse = self.ellipse(node, ELLIPSE);
            let quarter = ellipse.len() / 4;
            if [0, quarter].iter().any(|k| ellipse[*k].distance(centre) < 4.0) {
                continue;
            }
            let stroke = Stroke::new(1.0, ink(self.palette.ellipse));
            self.painter.add(Shape::closed_line(ellipse, stroke));
            shown += 1;
            if shown == MOST_ELLIPSES {
                break;
            }
        }
    }

    /// The metric ellipse of a node on the screen, at a fraction of the unit length; in space it lies in the tangent
    /// plane.
    fn ellipse(&self, node: NodeId, share: f64) -> Vec<Pos2> {
        let mesh = &self.moment.mesh;
        let p = mesh.uv(node);
        let ([small, large], [along, across]) = mesh.metric(node).eigen();
        let axes = [along * (share / small.sqrt()), across * (share / large.sqrt())];
        let (centre, axes) = match mesh.embedding() {
            Some(embedding) if self.scene.form().is_in_space() => {
                let at = embedding.atlas.at(p);
                (at.xyz, axes.map(|axis| at.j[0] * axis.x + at.j[1] * axis.y))
            }
            _ => (p.extend(0.0), axes.map(|axis| axis.extend(0.0))),
        };
        let point = |k: i32| {
            let t = f64::from(k) * std::f64::consts::TAU / 48.0;
            self.frame.place(centre + axes[0] * libm::cos(t) + axes[1] * libm::sin(t))
        };
        (0..48).map(point).collect()
    }

    /// The unit circle of the metric lens, at its place on the surface.
    pub(super) fn lens_in_space(&self, state: &State) {
        let Some((node, _)) = viewport::lens_node(state, self.moment).filter(|lens| self.place(lens.0).is_some())
        else {
            return;
        };
        let mut ellipse = self.ellipse(node, 1.0);
        ellipse.push(ellipse[0]);
        let stroke = Stroke::new(1.0, ink(self.palette.accent));
        self.painter.extend(Shape::dashed_line(&ellipse, stroke, 4.0, 4.0));
    }

    /// The unit circle around the node of the lens, dashed, over a unit grid.
    pub(super) fn unit_grid(&self, state: &State) {
        let (frame, palette) = (self.frame, self.palette);
        let Some(origin) = viewport::lens_node(state, self.moment).and_then(|node| self.place(node.0)) else {
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

    /// A frame around the part in the main view, if that is not the whole mesh.
    pub(super) fn main_frame(&self, state: &State) {
        let in_plane = !(state.is_in_space() && state.workspace().surfaces.view == SurfaceView::Space);
        let ViewCamera { camera, is_fitted, size } = state.view().plane;
        let Some(camera) = camera.filter(|_| in_plane && !is_fitted) else { return };
        let corners = [DVec2::ZERO, DVec2::new(size.x, 0.0), size, DVec2::new(0.0, size.y)];
        let corners = corners.map(|at| camera.unproject(at, size).map(|p| self.frame.place(p.extend(0.0))));
        if let [Some(a), Some(b), Some(c), Some(d)] = corners {
            let stroke = Stroke::new(1.25, ink(self.palette.selection));
            self.painter.add(Shape::closed_line(vec![a, b, c, d], stroke));
        }
    }

    pub(super) fn scale_bar(&mut self) {
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
        let rect = self.plated(at, Align2::LEFT_CENTER, &text);
        self.taken.push(rect.union(Rect::from_x_y_ranges(left..=right, y - 3.0..=y + 3.0)));
    }

    pub(super) fn axes(&mut self) {
        let origin = self.frame.rect.right_bottom() + Vec2::new(-42.0, -20.0);
        let stroke = Stroke::new(1.0, ink(self.palette.weak));
        let centre = self.frame.camera.centre;
        let at = |p: glam::DVec3| self.frame.camera.project(p, self.frame.size());
        let axes = [(glam::DVec3::X, "x"), (glam::DVec3::Y, "y"), (glam::DVec3::Z, "z")];
        // The plane has two.
        let count = if self.scene.form().is_in_space() { 3 } else { 2 };
        let mut names: Vec<Rect> = Vec::new();
        for (axis, name) in axes.into_iter().take(count) {
            let d = (at(centre + axis) - at(centre)) / self.frame.camera.scale;
            let d = Vec2::new(d.x as f32, d.y as f32);
            self.painter.line_segment([origin, origin + 24.0 * d], stroke);
            // Axes that lie over one another on the screen have their names one behind the other.
            let places = [32.0, 46.0, 60.0].map(|away| origin + away * d);
            let is_free = |at: &&Pos2| names.iter().all(|name: &Rect| !name.expand(6.0).contains(**at));
            let text = places.iter().find(is_free).copied().unwrap_or(places[2]);
            let rect = self.plated(text, Align2::CENTER_CENTER, name);
            names.push(rect);
            self.taken.push(rect.union(Rect::from_two_pos(origin, text)));
        }
    }

    /// A text on a plate, so that it is read over every colour. Returns where it stands.
    fn plated(&self, at: Pos2, anchor: Align2, text: &str) -> Rect {
        let colour = ink(self.palette.weak);
        let galley = self.painter.layout_no_wrap(text.to_owned(), self.sized(theme::regular(11.5)), colour);
        let rect = anchor.anchor_size(at, galley.size());
        self.painter.rect_filled(rect.expand2(Vec2::new(3.0, 0.0)), 3.0, ink(self.palette.label_plate));
        self.painter.galley(rect.min, galley, colour);
        rect
    }
}

/// The legend of the colours of elements.
pub fn shading(ui: &Ui, frame: &ViewFrame, shading: &Shading, palette: &Palette) {
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
