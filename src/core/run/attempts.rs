//! The attempts at the quadrilateral under way: what each tried, its steps, and why it was taken back.

use super::history::History;
use crate::core::convert::{Attempt, Event, EventKind, Why};
use crate::core::fault::Fault;

/// An attempt at a quadrilateral.
#[derive(Clone, Debug, PartialEq)]
pub struct Tried {
    /// What it tries.
    pub attempt: Attempt,
    /// Its steps, with what they did; the last one took it back where it failed.
    pub steps: Vec<(u64, Event)>,
}

impl Tried {
    /// Why it was taken back; `None` while it is under way.
    pub fn failed(&self) -> Option<Why> {
        match self.steps.last() {
            Some((_, Event::RolledBack { why, .. })) => Some(*why),
            _ => None,
        }
    }
}

impl History {
    /// The attempts at the quadrilateral under way in the current state, from the first one on; none where no
    /// quadrilateral is under way.
    ///
    /// # Errors
    /// A step of the replay failed.
    pub fn attempts(&self) -> Result<Vec<Tried>, Fault> {
        let Some(selected) = self.log().selection(self.step()) else { return Ok(Vec::new()) };
        let mut tried: Vec<Tried> = Vec::new();
        self.replay(selected, self.step(), &mut |step, state, event| {
            if let (Some(event), Some(last)) = (event, tried.last_mut()) {
                last.steps.push((step, *event));
            }
            let is_new = event.is_none_or(|event| event.kind() == EventKind::RolledBack);
            if let Some(attempt) = state.phase().attempt().filter(|_| is_new) {
                tried.push(Tried { attempt: *attempt, steps: Vec::new() });
            }
        })?;
        Ok(tried)
    }
}
