//! The base where one cannot see it: an arrow at the rim points at a base outside of the view, and a dashed line
//! through the mesh shows one on the far side.

use eframe::egui::{Align2, Pos2, Rect, Shape, Stroke, Vec2};

use super::Labels;
use crate::app::window::theme::{self, ink};
use crate::render::scene::Decision;

/// How far from the rim arrows are.
const RIM: f32 = 22.0;

impl Labels<'_> {
    /// Points at the base if it is outside of the view or on the far side.
    pub(super) fn far_base(&mut self, decision: &Decision) {
        let Some([a, b]) = decision.base else { return };
        let Some([p, q]) = self.scene.spot(a).zip(self.scene.spot(b)).map(|(a, b)| [a.at, b.at]) else { return };
        let is_hidden = self.place(a).is_none() && self.place(b).is_none();
        let [p, q] = [p, q].map(|at| self.frame.place(at));
        let middle = p + 0.5 * (q - p);
        if !self.frame.rect.contains(middle) {
            self.arrow(middle);
        } else if is_hidden {
            for (colour, width) in [(self.palette.label_plate, 7.0), (self.palette.base, 3.0)] {
                let stroke = Stroke::new(width, ink(colour));
                self.painter.extend(Shape::dashed_line(&[p, q], stroke, 6.0, 4.0));
            }
            let (font, colour) = (theme::medium(12.0), ink(self.palette.accent));
            let text = "base, on the far side: F turns to it";
            self.label(middle + Vec2::new(0.0, 12.0), Align2::CENTER_TOP, text, font, colour);
        }
    }

    fn arrow(&mut self, to: Pos2) {
        let inner = self.frame.rect.shrink(RIM);
        let (middle, way) = (inner.center(), (to - inner.center()).normalized());
        let at = middle + way * until_rim(inner, way);
        let across = way.rot90();
        let tip = vec![at + 11.0 * way, at - 7.0 * way + 7.0 * across, at - 7.0 * way - 7.0 * across];
        let (fill, casing) = (ink(self.palette.base), Stroke::new(1.5, ink(self.palette.ground)));
        self.painter.add(Shape::convex_polygon(tip, fill, casing));
        let (font, colour) = (theme::medium(12.0), ink(self.palette.accent));
        self.label(at - 26.0 * way, Align2::CENTER_CENTER, "base", font, colour);
    }
}

/// How far it is from the middle of a rectangle to its rim.
fn until_rim(rect: Rect, way: Vec2) -> f32 {
    let half = 0.5 * rect.size();
    let [x, y] = [half.x / way.x.abs(), half.y / way.y.abs()];
    x.min(y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rim_is_as_far_as_the_nearer_side() {
        let rect = Rect::from_min_size(Pos2::ZERO, Vec2::new(200.0, 100.0));
        assert_eq!(until_rim(rect, Vec2::new(1.0, 0.0)), 100.0);
        assert_eq!(until_rim(rect, Vec2::new(0.0, -1.0)), 50.0);
        let way = Vec2::new(2.0, 1.0).normalized();
        assert!((until_rim(rect, way) - Vec2::new(100.0, 50.0).length()).abs() < 1e-3);
    }
}
