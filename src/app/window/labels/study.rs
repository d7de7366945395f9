//! Labels of a lesson: hints at edges, and answers with the sign of their verdict.

use eframe::egui::Align2;

use super::Labels;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::viewport::middle;
use crate::core::question::Verdict;
use crate::render::scene::Outlined;

impl Labels<'_> {
    /// Shows them; what is at hand comes before any other label.
    pub(super) fn study(&mut self, state: &State) {
        let Some(study) = state.shown_study() else { return };
        // Nodes have their numbers, and the text of the question names an edge by those of its ends.
        if let Some(what @ Outlined::Element(e)) = study.about(self.moment.step)
            && let Some(at) = middle(self.moment, what).and_then(|p| self.on_screen(self.lifted(p)))
        {
            let font = theme::semibold(12.5);
            self.label(at, Align2::CENTER_CENTER, &self.about_element(e), font, ink(self.palette.accent));
        }
        for (what, text, verdict) in study.labels(self.moment.step) {
            let Some(place) = middle(self.moment, what).map(|p| self.lifted(p)) else { continue };
            let Some(at) = self.on_screen(place).filter(|at| self.frame.rect.contains(*at)) else { continue };
            let colour = match verdict {
                Verdict::Right => self.palette.holds,
                Verdict::Partly => self.palette.label,
                Verdict::Wrong => self.palette.broken,
            };
            let font = theme::semibold(12.5);
            match what {
                Outlined::Node(_) => self.name(at, &text, font, ink(colour)),
                _ => drop(self.label(at, Align2::CENTER_CENTER, &text, font, ink(colour))),
            }
        }
    }
}
