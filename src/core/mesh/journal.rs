//! The journal: the values that the operators replaced, so that changes can be undone exactly.
//!
//! Rollback inside a step and stepping back in a run are the same mechanism: `let mark = journal.mark(); ...
//! mesh.take_back(mark)`. The journal does not know the mesh: an entry names the array, the id and the old value.

use glam::DVec2;

use crate::core::kernel::Metric2;
use crate::core::mesh::ids::{ElementId, HalfEdgeId, NodeId};

/// One change of an array of the mesh, with the old value. `u32::MAX` means absence, as in the arrays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Entry {
    /// The start of a half-edge.
    Origin(HalfEdgeId, u32),
    /// The twin of a half-edge.
    Twin(HalfEdgeId, u32),
    /// The number of sides of an element (0 for a tombstone).
    Sides(ElementId, u8),
    /// The region of an element.
    Region(ElementId, u32),
    /// The level of an element.
    Level(ElementId, u16),
    /// Whether a front segment is deferred.
    Deferred(HalfEdgeId, bool),
    /// Coordinates of a node.
    Uv(NodeId, DVec2),
    /// Metric of a node.
    Metric(NodeId, Metric2),
    /// The half-edge at which the fan of a node starts.
    Anchor(NodeId, u32),
    /// The output point of a node.
    Point(NodeId, u32),
    /// A node was appended.
    NodeAppended,
    /// An element was appended.
    ElementAppended,
    /// The last free node was reused.
    NodeTaken(NodeId),
    /// The last free element was reused.
    ElementTaken(ElementId),
    /// A node became a tombstone.
    NodeFreed,
    /// An element became a tombstone.
    ElementFreed,
    /// The lengths of the closed parts of the free lists: nodes, elements.
    Closed([u32; 2]),
}

/// A position in the journal to which later changes can be undone, counted from the beginning even if older entries
/// have been forgotten.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Mark(usize);

/// Old values in the order in which they were replaced.
#[derive(Clone, Debug)]
pub struct Journal {
    entries: Vec<Entry>,
    /// Number of older entries that have been forgotten.
    forgotten: usize,
    recording: bool,
}

impl Default for Journal {
    fn default() -> Self {
        Journal { entries: Vec::new(), forgotten: 0, recording: true }
    }
}

impl Journal {
    /// The current position.
    pub fn mark(&self) -> Mark {
        Mark(self.forgotten + self.entries.len())
    }

    /// Number of entries after a mark.
    pub fn len_since(&self, mark: Mark) -> usize {
        self.forgotten + self.entries.len() - mark.0
    }

    /// The memory of the entries, bytes.
    pub fn bytes(&self) -> usize {
        self.entries.capacity() * size_of::<Entry>()
    }

    /// Whether changes are recorded.
    pub fn is_recording(&self) -> bool {
        self.recording
    }

    /// Starts or stops recording; stopping forgets all entries, since changes across a gap cannot be undone.
    pub fn set_recording(&mut self, recording: bool) {
        self.recording = recording;
        if !recording {
            self.forget();
        }
    }

    /// Forgets all entries: the changes become final. Without a history of the run, this is the commit.
    pub fn forget(&mut self) {
        self.forgotten += self.entries.len();
        self.entries.clear();
    }

    /// Forgets all entries before a mark: those changes become final.
    pub(crate) fn forget_before(&mut self, mark: Mark) {
        let count = mark.0.saturating_sub(self.forgotten).min(self.entries.len());
        self.entries.drain(..count);
        self.entries.shrink_to(2 * self.entries.len());
        self.forgotten += count;
    }

    /// The entries after a mark that have not been forgotten, oldest first.
    pub(crate) fn since(&self, mark: Mark) -> &[Entry] {
        self.entries.get(mark.0.saturating_sub(self.forgotten)..).unwrap_or_default()
    }

    /// Records an entry.
    #[inline]
    pub(crate) fn note(&mut self, entry: Entry) {
        if self.recording {
            self.entries.push(entry);
        }
    }

    /// Removes and returns the newest entry after the mark.
    pub(crate) fn pop(&mut self, mark: Mark) -> Option<Entry> {
        if self.forgotten + self.entries.len() > mark.0 { self.entries.pop() } else { None }
    }
}
