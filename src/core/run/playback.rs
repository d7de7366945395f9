//! Where to go next: to the next or previous quadrilateral, to a number of quadrilaterals, to the next or previous
//! event of a kind. These functions find the step; [`History::seek`] goes there. Looking forward, they run ahead as far
//! as necessary, unless the recorder is lent.

use super::history::History;
use super::recorder::SPACING;
use crate::core::convert::event::EventKind;

/// Whether a step of this kind makes quadrilaterals; clean-up does not count.
fn makes_quads(kind: EventKind) -> bool {
    matches!(kind, EventKind::Formed | EventKind::Closed | EventKind::Patched)
}

impl History {
    /// The step that completes the next quadrilateral and its local post-processing (4.3.6), or that of the last
    /// quadrilateral where it is under way. `None` where there is no further one, or where it is not known yet.
    pub fn next_quad(&mut self) -> Option<u64> {
        let from = self.step();
        let made = if self.log().is_at_rest(from) {
            self.ahead(|history| history.log().next_of(from, makes_quads))?
        } else {
            from
        };
        self.ahead(|history| history.rest_after(made))
    }

    /// The last step before the current state that completed a quadrilateral and its local post-processing, or the
    /// beginning; `None` at the beginning.
    pub fn previous_quad(&self) -> Option<u64> {
        let from = self.step();
        let mut until = from.checked_sub(1)?;
        while let Some(made) = self.log().last_of(until, makes_quads) {
            match self.rest_after(made).filter(|&rest| rest < from) {
                Some(rest) => return Some(rest),
                None => until = made - 1,
            }
        }
        Some(0)
    }

    /// The first step that leaves at least this number of quadrilaterals and no local post-processing under way: where
    /// `convert --at nq=N` stops. `None` where the run never has that many, or where it is not known yet.
    pub fn step_with_quads(&mut self, nq: u64) -> Option<u64> {
        if nq <= self.log().nq(0) {
            return Some(0);
        }
        self.ahead(|history| history.log().first_with(nq, 0))
    }

    /// The next step after the current state whose event is of a kind.
    pub fn next_of_kind(&mut self, kind: EventKind) -> Option<u64> {
        let from = self.step();
        self.ahead(|history| history.log().next_of(from, |other| other == kind))
    }

    /// The last step before the one that led to the current state whose event is of a kind.
    pub fn previous_of_kind(&self, kind: EventKind) -> Option<u64> {
        self.log().last_of(self.step().checked_sub(1)?, |other| other == kind)
    }

    /// The first step from this one on after which no local post-processing is under way.
    fn rest_after(&self, step: u64) -> Option<u64> {
        (step..=self.log().known()).find(|&step| self.log().is_at_rest(step))
    }

    /// Searches, and where nothing is found runs further ahead and searches again.
    pub(super) fn ahead<T>(&mut self, look: impl Fn(&History) -> Option<T>) -> Option<T> {
        loop {
            if let Some(found) = look(self) {
                return Some(found);
            }
            let known = self.log().known();
            if self.end().is_some() {
                return None;
            }
            self.extend(known + 4 * SPACING);
            if self.log().known() == known {
                return None;
            }
        }
    }
}
