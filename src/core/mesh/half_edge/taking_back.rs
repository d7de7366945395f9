//! Taking back and doing again: the mesh's side of the journal.

use glam::DVec2;

use super::Mesh;
use crate::core::kernel::tensor::Metric2;
use crate::core::mesh::ids::{ElementId, NodeId};
use crate::core::mesh::journal::{Entry, Journal, Mark};

/// What stands in the slots of an element.
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    pub(super) origin: [u32; 4],
    pub(super) twin: [u32; 4],
    pub(super) deferred: [bool; 4],
    pub(super) sides: u8,
    pub(super) region: u32,
    pub(super) level: u16,
}

/// A change that was taken back, with what is needed to do it again.
#[derive(Clone, Debug, PartialEq)]
pub enum Undone {
    /// A value; the entry holds what stood there before it was put back.
    Changed(Entry),
    /// A node at the end: place, metric, anchor, point.
    NodeAppended((DVec2, Metric2, u32, u32)),
    /// An element at the end.
    ElementAppended(Element),
    /// The last free node was taken into use.
    NodeTaken,
    /// The last free element was taken into use.
    ElementTaken,
    /// A node was freed.
    NodeFreed(NodeId),
    /// An element was freed.
    ElementFreed(ElementId),
}

impl Mesh {
    /// The present place of the journal, to take back to.
    pub fn mark(&self) -> Mark {
        self.journal.mark()
    }

    /// The journal.
    pub fn journal(&self) -> &Journal {
        &self.journal
    }

    /// Starts or stops recording; see [`Journal::set_recording`].
    pub fn set_recording(&mut self, recording: bool) {
        self.journal.set_recording(recording);
    }

    /// Keeps what was done and forgets how it was before.
    pub fn commit(&mut self) {
        self.journal.forget();
    }

    /// Keeps what was done before the mark and forgets how it was before.
    pub(in crate::core) fn forget_before(&mut self, mark: Mark) {
        self.journal.forget_before(mark);
    }

    /// Takes back everything that was done after the mark, exactly: the arrays are the same to the last byte.
    pub fn take_back(&mut self, mark: Mark) {
        while let Some(entry) = self.journal.pop(mark) {
            self.undo(entry);
        }
    }

    /// Takes back everything that was done after the mark, and returns what [`redo`](Mesh::redo) needs to do it again.
    pub fn take_back_to_redo(&mut self, mark: Mark) -> Vec<Undone> {
        let mut undone = Vec::with_capacity(self.journal.len_since(mark));
        while let Some(entry) = self.journal.pop(mark) {
            undone.push(self.undo(entry));
        }
        undone
    }

    /// Does again what was taken back, journal entries included: arrays and journal are the same to the last byte as
    /// before. Nothing may have changed between the two.
    pub fn redo(&mut self, undone: Vec<Undone>) {
        for change in undone.into_iter().rev() {
            match change {
                Undone::Changed(entry) => {
                    let Undone::Changed(old) = self.undo(entry) else {
                        unreachable!("a change of a value is one again")
                    };
                    self.journal.note(old);
                }
                Undone::NodeAppended(node) => self.append_node(node),
                Undone::ElementAppended(element) => self.append_element(&element),
                Undone::NodeTaken => {
                    let node = self.free_nodes.pop().expect("it was put back when it was undone");
                    self.journal.note(Entry::NodeTaken(node));
                }
                Undone::ElementTaken => {
                    let e = self.free_elements.pop().expect("it was put back when it was undone");
                    self.journal.note(Entry::ElementTaken(e));
                }
                Undone::NodeFreed(node) => {
                    self.free_nodes.push(node);
                    self.journal.note(Entry::NodeFreed);
                }
                Undone::ElementFreed(e) => {
                    self.free_elements.push(e);
                    self.journal.note(Entry::ElementFreed);
                }
            }
        }
    }

    /// Puts the old value of an entry back; returns what was there instead.
    #[inline]
    fn undo(&mut self, entry: Entry) -> Undone {
        use std::mem::replace;
        Undone::Changed(match entry {
            Entry::Origin(h, old) => Entry::Origin(h, replace(&mut self.origin[h.index()], old)),
            Entry::Twin(h, old) => Entry::Twin(h, replace(&mut self.twin[h.index()], old)),
            Entry::Sides(e, old) => Entry::Sides(e, replace(&mut self.sides[e.index()], old)),
            Entry::Region(e, old) => Entry::Region(e, replace(&mut self.region[e.index()], old)),
            Entry::Level(e, old) => Entry::Level(e, replace(&mut self.level[e.index()], old)),
            Entry::Deferred(h, old) => Entry::Deferred(h, replace(&mut self.deferred[h.index()], old)),
            Entry::Uv(n, old) => Entry::Uv(n, replace(&mut self.uv[n.index()], old)),
            Entry::Metric(n, old) => Entry::Metric(n, replace(&mut self.metric[n.index()], old)),
            Entry::Closed(old) => Entry::Closed(replace(&mut self.closed, old)),
            Entry::Anchor(n, old) => Entry::Anchor(n, replace(&mut self.anchor[n.index()], old)),
            Entry::NodeAppended => {
                let last = self.uv.len() - 1;
                let node = (self.uv[last], self.metric[last], self.anchor[last], self.point[last]);
                self.uv.truncate(last);
                self.metric.truncate(last);
                self.anchor.truncate(last);
                self.point.truncate(last);
                return Undone::NodeAppended(node);
            }
            Entry::ElementAppended => {
                let last = self.sides.len() - 1;
                let slots = 4 * last..4 * last + 4;
                let four = |array: &[u32]| {
                    [array[slots.start], array[slots.start + 1], array[slots.start + 2], array[slots.start + 3]]
                };
                let element = Element {
                    origin: four(&self.origin),
                    twin: four(&self.twin),
                    deferred: std::array::from_fn(|k| self.deferred[slots.start + k]),
                    sides: self.sides[last],
                    region: self.region[last],
                    level: self.level[last],
                };
                self.origin.truncate(slots.start);
                self.twin.truncate(slots.start);
                self.deferred.truncate(slots.start);
                self.sides.truncate(last);
                self.region.truncate(last);
                self.level.truncate(last);
                return Undone::ElementAppended(element);
            }
            Entry::NodeTaken(n) => {
                self.free_nodes.push(n);
                return Undone::NodeTaken;
            }
            Entry::ElementTaken(e) => {
                self.free_elements.push(e);
                return Undone::ElementTaken;
            }
            Entry::NodeFreed => {
                return Undone::NodeFreed(self.free_nodes.pop().expect("the journal says that a node was freed"));
            }
            Entry::ElementFreed => {
                return Undone::ElementFreed(
                    self.free_elements.pop().expect("the journal says that an element was freed"),
                );
            }
        })
    }

    pub(super) fn append_node(&mut self, (uv, metric, anchor, point): (DVec2, Metric2, u32, u32)) {
        self.uv.push(uv);
        self.metric.push(metric);
        self.anchor.push(anchor);
        self.point.push(point);
        self.journal.note(Entry::NodeAppended);
    }

    pub(super) fn append_element(&mut self, element: &Element) {
        self.origin.extend(element.origin);
        self.twin.extend(element.twin);
        self.deferred.extend(element.deferred);
        self.sides.push(element.sides);
        self.region.push(element.region);
        self.level.push(element.level);
        self.journal.note(Entry::ElementAppended);
    }
}
