//! The transcript of a run: a sentence for each of its steps.

use super::explain::Narrator;
use super::history::History;
use crate::core::fault::Fault;

impl History {
    /// What the steps from `from` to `until` (both included) did, a sentence each (see
    /// [`narration`](super::explain::narration)), as far as they are known; by replay where their events were dropped.
    ///
    /// # Errors
    /// A step of the replay failed.
    pub fn transcript(&self, from: u64, until: u64) -> Result<Vec<String>, Fault> {
        let from = from.max(1);
        let mut narrator = Narrator::default();
        if let Some(step) = self.log().selection(from.min(self.log().known()))
            && let Some(event) = self.event(step)?
        {
            narrator.note(&event);
        }
        let told = self.events(from, until)?.into_iter().map(|event| {
            narrator.note(&event);
            narrator.tell(&event)
        });
        Ok(told.collect())
    }
}
