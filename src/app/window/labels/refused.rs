//! The reasons beside candidates for a side edge that were not chosen.

use eframe::egui::{Align2, Pos2, Rect, Vec2};

use super::Labels;
use crate::app::window::theme::{self, ink};
use crate::render::scene::Outlined;

/// An edge that is shorter in points has no reason beside it.
const LEAST: f32 = 44.0;

/// The places along what is seen of a candidate, in the order in which they are tried.
const PLACES: [f32; 5] = [0.62, 0.78, 0.46, 0.9, 0.32];

impl Labels<'_> {
    /// A reason at the far part of each candidate, or of what is seen of it, but for one that has it beside its name.
    pub(super) fn refused(&mut self, named: Option<Outlined>) {
        for candidate in self.moment.refused() {
            if named.is_some_and(|what| candidate.is(what)) {
                continue;
            }
            let [from, top] = candidate.ends.map(|node| self.place(node));
            let Some((from, top)) = from.zip(top).filter(|(from, top)| from.distance(*top) >= LEAST) else { continue };
            let seen = seen_share(from, top, self.frame.rect) * (top - from);
            for share in PLACES {
                let at = from + share * seen + Vec2::new(0.0, -2.0);
                let (font, colour) = (theme::regular(11.0), ink(self.palette.label));
                if self.label(at, Align2::CENTER_CENTER, &candidate.reason, font, colour) {
                    break;
                }
            }
        }
    }
}

/// The share of a line up to where it leaves a rectangle, in which it begins.
fn seen_share(from: Pos2, to: Pos2, rect: Rect) -> f32 {
    let along = |begin: f32, length: f32, [low, high]: [f32; 2]| match length {
        length if length > 0.0 => (high - begin) / length,
        length if length < 0.0 => (low - begin) / length,
        _ => 1.0,
    };
    let (x, y) = (rect.x_range(), rect.y_range());
    let shares = [along(from.x, to.x - from.x, [x.min, x.max]), along(from.y, to.y - from.y, [y.min, y.max])];
    shares.into_iter().fold(1.0, f32::min).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_seen_up_to_the_edge_of_the_view() {
        let rect = Rect::from_min_max(Pos2::ZERO, Pos2::new(100.0, 50.0));
        let from = Pos2::new(50.0, 25.0);
        let share = |x: f32, y: f32| seen_share(from, Pos2::new(x, y), rect);
        assert_eq!(share(90.0, 30.0), 1.0);
        assert_eq!(share(150.0, 25.0), 0.5);
        assert_eq!(share(-150.0, 25.0), 0.25);
        assert_eq!(share(150.0, 225.0), 0.125);
        assert_eq!(share(50.0, 25.0), 1.0);
    }
}
