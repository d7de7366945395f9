//! The journal: what the operators replaced, so that it can be taken back exactly.
//!
//! Trying and taking back inside a step, and a person stepping back, are the same mechanism: `let mark = journal.mark();
//! ... mesh.take_back(mark)`. Nothing here knows what a mesh is: an entry names the array, the place and the old value.

use glam::DVec2;

use crate::core::kernel::tensor::Metric2;
use crate::core::mesh::ids::{ElementId, HalfEdgeId, NodeId};

/// One change of the mesh's arrays, with what stood there before. `u32::MAX` stands for absence, as in the arrays.
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
    /// Whether a front segment is put off.
    Deferred(HalfEdgeId, bool),
    /// Coordinates of a node.
    Uv(NodeId, DVec2),
    /// Metric of a node.
    Metric(NodeId, Metric2),
    /// The half-edge from which the fan of a node is walked.
    Anchor(NodeId, u32),
    /// A node was appended.
    NodeAppended,
    /// An element was appended.
    ElementAppended,
    /// The last free node was taken into use.
    NodeTaken(NodeId),
    /// The last free element was taken into use.
    ElementTaken(ElementId),
    /// A node became a tombstone.
    NodeFreed,
    /// An element became a tombstone.
    ElementFreed,
    /// How much of the free lists is closed: of the nodes', of the elements'.
    Closed([u32; 2]),
}

/// A place in the journal to which everything later can be taken back. Places are counted from the journal's beginning, also
/// where part of it is forgotten.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Mark(usize);

/// Old values in the order in which they were replaced.
#[derive(Clone, Debug)]
pub struct Journal {
    entries: Vec<Entry>,
    /// Number of entries that stood before those and are forgotten.
    forgotten: usize,
    recording: bool,
}

impl Default for Journal {
    fn default() -> Self {
        Journal { entries: Vec::new(), forgotten: 0, recording: true }
    }
}

impl Journal {
    /// The present place.
    pub fn mark(&self) -> Mark {
        Mark(self.forgotten + self.entries.len())
    }

    /// Number of entries after a mark.
    pub fn len_since(&self, mark: Mark) -> usize {
        self.forgotten + self.entries.len() - mark.0
    }

    /// Bytes that the entries take.
    pub fn bytes(&self) -> usize {
        self.entries.capacity() * size_of::<Entry>()
    }

    /// Whether changes are written down.
    pub fn is_recording(&self) -> bool {
        self.recording
    }

    /// Starts or stops writing changes down; stopping forgets what stands, since gaps cannot be taken back.
    pub fn set_recording(&mut self, recording: bool) {
        self.recording = recording;
        if !recording {
            self.forget();
        }
    }

    /// Forgets everything: what was done stays done. Where nobody keeps a history, this is the commit.
    pub fn forget(&mut self) {
        self.forgotten += self.entries.len();
        self.entries.clear();
    }

    /// Forgets everything before a mark: what was done until then stays done.
    pub(crate) fn forget_before(&mut self, mark: Mark) {
        let count = mark.0.saturating_sub(self.forgotten).min(self.entries.len());
        self.entries.drain(..count);
        self.entries.shrink_to(2 * self.entries.len());
        self.forgotten += count;
    }

    /// The entries after a mark that are not forgotten, oldest first.
    pub(crate) fn since(&self, mark: Mark) -> &[Entry] {
        self.entries.get(mark.0.saturating_sub(self.forgotten)..).unwrap_or_default()
    }

    /// Writes an entry down.
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
