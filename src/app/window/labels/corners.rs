//! Frontal angles: wedges at corners where the front is the side, arcs with their values at the base.

use eframe::egui::{Align2, Pos2, Shape, Stroke, Vec2};

use super::{Labels, ViewRole};
use crate::app::window::theme::{self, ink};
use crate::app::window::words;
use crate::core::front::{Segment, Side};
use crate::render::scene::Decision;

impl Labels<'_> {
    /// Wedges at corners where the front is the side, arcs with their values if there is room.
    pub(super) fn wedges_and_arcs(&mut self, decision: &Decision, which: ViewRole) {
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
                if is_base && which != ViewRole::Whole {
                    self.arc(segment, side);
                } else if !has_arc && segment.theta[side.index()] < moment.parameters.theta_rect {
                    self.wedge(segment, side);
                }
            }
        }
    }

    /// The place of the corner and the screen directions of its two legs, anticlockwise in the mesh, with their
    /// lengths; none if it is too small to be marked.
    fn corner(&self, segment: &Segment, side: Side) -> Option<(Pos2, [Vec2; 2])> {
        let mesh = &self.moment.mesh;
        let h = mesh.front_between(segment.a, segment.b)?;
        let (at, from, to) = match side {
            Side::Left => (segment.a, segment.b, mesh.origin(mesh.front_before(h))),
            Side::Right => (segment.b, mesh.target(mesh.front_after(h)), segment.a),
        };
        let centre = self.place(at)?;
        let legs = [self.place(from)? - centre, self.place(to)? - centre];
        if legs.iter().any(|leg| leg.length() < 40.0) {
            return None;
        }
        // Seen from behind, the mesh turns the other way.
        Some((centre, if self.is_behind(at) { [legs[1], legs[0]] } else { legs }))
    }

    fn wedge(&self, segment: &Segment, side: Side) {
        let Some((centre, legs)) = self.corner(segment, side) else { return };
        let colour = ink(self.palette.label.faded(0.8));
        let mut points = vec![centre];
        points.extend(arc(centre, legs, 14.0));
        self.painter.add(Shape::convex_polygon(points, colour, Stroke::NONE));
    }

    fn arc(&mut self, segment: &Segment, side: Side) {
        let Some((centre, legs)) = self.corner(segment, side) else { return };
        let points = arc(centre, legs, 26.0);
        let middle = points[points.len() / 2];
        self.painter.add(Shape::line(points, Stroke::new(1.25, ink(self.palette.accent))));
        let name = if side == Side::Left { "A" } else { "B" };
        let text = format!("θ{name} {}°", words::degrees(segment.theta[side.index()]));
        let at = middle + 14.0 * self.type_scale * (middle - centre).normalized();
        let anchor = if at.x < centre.x { Align2::RIGHT_CENTER } else { Align2::LEFT_CENTER };
        self.label(at, anchor, &text, theme::medium(12.0), ink(self.palette.accent));
    }
}

/// Points of the arc of `radius` from the first leg to the second, anticlockwise in the mesh (clockwise on a screen
/// with y down is the other way round).
fn arc(centre: Pos2, legs: [Vec2; 2], radius: f32) -> Vec<Pos2> {
    let from = legs[0].angle();
    let mut turn = from - legs[1].angle();
    if turn <= 0.0 {
        turn += std::f32::consts::TAU;
    }
    let count = (turn * 8.0).ceil().max(2.0) as i32;
    (0..=count).map(|k| centre + radius * Vec2::angled(from - turn * k as f32 / count as f32)).collect()
}
