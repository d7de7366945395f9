//! What a step of the front works on, and what it comes to.

use super::event::Event;
use super::phase::Phase;
use crate::core::case::Parameters;
use crate::core::front::Queue;
use crate::core::mesh::{Mark, Mesh};
use crate::core::metric::MetricSource;

/// What a step comes to: the phase after it and what it did. Without an event it found nothing to do, and the next
/// phase has its turn in the same step.
pub(super) type Done = (Phase, Option<Event>);

/// Least quality and largest new edge that a formation may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gates {
    /// The least quality.
    pub quality: f64,
    /// The largest metric length of a side or top that was live and is on the front now.
    pub length: f64,
}

impl Gates {
    /// The gates; wide in the second pass (docs/algorithm.md, "Rescue").
    pub fn of(second_pass: bool) -> Gates {
        if second_pass { Gates { quality: 0.05, length: 4.0 } } else { Gates { quality: 0.15, length: 2.0 } }
    }
}

/// The merging front at work: the mesh that it runs through, what steps look up, and the queue of segments.
pub(super) struct Front<'f> {
    /// The mesh: the front runs between its live triangles and what is converted.
    pub mesh: &'f mut Mesh,
    /// The metric field.
    pub source: &'f dyn MetricSource,
    pub parameters: &'f Parameters,
    /// A cache: rebuilt from the mesh where it is missing, and then chooses the same.
    pub queue: &'f mut Option<Queue>,
    /// The face that is being converted, by its region; none where all is converted together.
    pub face: Option<u32>,
    /// Whether the gates are wide: every segment was deferred and taken up again.
    pub second_pass: &'f mut bool,
    /// Whether the journal is kept, so that steps can be taken back.
    pub keeps_journal: bool,
}

impl Front<'_> {
    /// The queue and the mesh that it orders.
    pub fn queue(&mut self) -> (&mut Queue, &mut Mesh) {
        let queue = self.queue.get_or_insert_with(|| Queue::of(self.mesh, self.face, self.parameters));
        (queue, self.mesh)
    }

    /// Brings the queue up to date with what the journal holds since the mark.
    pub fn refresh(&mut self, mark: Mark) {
        let parameters = self.parameters;
        let (queue, mesh) = self.queue();
        queue.refresh(mesh, mark, parameters);
    }

    /// The gates that a formation must pass.
    pub fn gates(&self) -> Gates {
        Gates::of(*self.second_pass)
    }

    /// Clears the journal where it is not kept.
    pub fn commit(&mut self) {
        if !self.keeps_journal {
            self.mesh.commit();
        }
    }
}
