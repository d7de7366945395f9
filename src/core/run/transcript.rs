//! The transcript of a run: a sentence for each of its steps.

use super::explain::narration;
use super::history::History;
use crate::core::convert::Event;
use crate::core::fault::Fault;

impl History {
    /// What the steps from `from` to `until` (both included) did, a sentence each (see [`narration`]), as far as they
    /// are known; by replay where their events were dropped.
    ///
    /// # Errors
    /// A step of the replay failed.
    pub fn transcript(&self, from: u64, until: u64) -> Result<Vec<String>, Fault> {
        let from = from.max(1);
        let selected = match self.log().selection(from.min(self.log().known())) {
            Some(step) => self.event(step)?,
            None => None,
        };
        let selection = |event: &Event| match *event {
            Event::BaseSelected { a, b, .. } => Some([a, b]),
            _ => None,
        };
        let mut base = selected.as_ref().and_then(selection);
        let told = self.events(from, until)?.into_iter().map(|event| {
            base = selection(&event).or(base);
            narration(&event, base)
        });
        Ok(told.collect())
    }
}
