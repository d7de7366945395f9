//! The reasons beside candidates for a side edge that were not chosen.

use eframe::egui::{Align2, Vec2};

use super::Labels;
use crate::app::window::theme::{self, ink};
use crate::render::scene::Outlined;

/// An edge that is shorter in points has no reason beside it.
const LEAST: f32 = 44.0;

impl Labels<'_> {
    /// A reason at the far part of each candidate but one that has it beside its name.
    pub(super) fn refused(&mut self, named: Option<Outlined>) {
        for candidate in self.moment.refused() {
            if named.is_some_and(|what| candidate.is(what)) {
                continue;
            }
            let [from, top] = candidate.ends.map(|node| self.place(node));
            let Some((from, top)) = from.zip(top).filter(|(from, top)| from.distance(*top) >= LEAST) else { continue };
            let at = from + 0.62 * (top - from) + Vec2::new(0.0, -2.0);
            let (font, colour) = (theme::regular(11.0), ink(self.palette.label));
            self.label(at, Align2::CENTER_CENTER, &candidate.reason, font, colour);
        }
    }
}
