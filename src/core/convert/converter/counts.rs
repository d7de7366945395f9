//! Counts of what the steps did, taken from their events.

use crate::core::convert::event::{Event, Purpose};
use crate::core::convert::phase::Attempt;
use crate::core::convert::sums::summed;

summed! {
/// What the steps did since the start.
pub struct Counts {
    /// Steps.
    pub steps: u64,
    /// Quadrilaterals formed by the front.
    pub formed: u64,
    /// Of those, how many with another right side (4.3.4).
    pub right_replaced: u64,
    /// Of those, how many with another left side or a Lee-Lo pair (docs/algorithm.md, "Rescue").
    pub rescued: u64,
    /// Attempts taken back.
    pub rolled_back: u64,
    /// Deferred segments.
    pub deferred: u64,
    /// Quadrilaterals over small loops that were closed.
    pub closed: u64,
    /// Seams, those with a transition included.
    pub seamed: u64,
    /// Of those, how many with a transition.
    pub transitions: u64,
    /// Front splits.
    pub split: u64,
    /// Swaps of the enhancement.
    pub enhanced: u64,
    /// Nodes removed.
    pub removed: u64,
}
}

impl Counts {
    /// Counts what a step did; `attempt` is the one that was under way before it.
    pub(super) fn count(&mut self, event: &Event, attempt: Option<Attempt>) {
        match event {
            Event::Formed { .. } => {
                self.formed += 1;
                let [left, right] = attempt.map_or([None; 2], |attempt| attempt.tops);
                self.right_replaced += u64::from(right.is_some() && left.is_none());
                self.rescued += u64::from(left.is_some());
            }
            Event::RolledBack { .. } => self.rolled_back += 1,
            Event::Deferred { .. } => self.deferred += 1,
            Event::Closed { quads, .. } => self.closed += u64::from(*quads),
            Event::Enhanced { .. } => self.enhanced += 1,
            Event::NodeRemoved { purpose: Purpose::Enhancement, .. } => self.removed += 1,
            Event::Seamed { .. } => self.seamed += 1,
            Event::TransitionSeamed { .. } => {
                self.seamed += 1;
                self.transitions += 1;
            }
            Event::Split { .. } => self.split += 1,
            _ => {}
        }
    }
}
