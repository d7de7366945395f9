//! Undo and redo of the changes in the journal.

use super::Mesh;
use super::slots::{Element, Node};
use crate::core::mesh::ids::{ElementId, NodeId};
use crate::core::mesh::journal::{Entry, Journal, Mark};

/// An undone change, with what is needed to redo it.
#[derive(Clone, Debug, PartialEq)]
pub enum Undone {
    /// A value; the entry has the value before the undo.
    Changed(Entry),
    /// A node at the end: position, metric, anchor, point.
    NodeAppended(Node),
    /// An element at the end.
    ElementAppended(Element),
    /// The last free node was reused.
    NodeTaken,
    /// The last free element was reused.
    ElementTaken,
    /// A node was freed.
    NodeFreed(NodeId),
    /// An element was freed.
    ElementFreed(ElementId),
}

impl Mesh {
    /// The current position of the journal, for a later [`take_back`](Mesh::take_back).
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

    /// Makes all changes final by forgetting the journal.
    pub fn commit(&mut self) {
        self.journal.forget();
    }

    /// Makes all changes before the mark final.
    pub(in crate::core) fn forget_before(&mut self, mark: Mark) {
        self.journal.forget_before(mark);
    }

    /// Undoes all changes after the mark exactly: the arrays are the same to the last byte.
    pub fn take_back(&mut self, mark: Mark) {
        while let Some(entry) = self.journal.pop(mark) {
            self.undo(entry);
        }
    }

    /// Undoes all changes after the mark, and returns what [`redo`](Mesh::redo) needs.
    pub fn take_back_to_redo(&mut self, mark: Mark) -> Vec<Undone> {
        let mut undone = Vec::with_capacity(self.journal.len_since(mark));
        while let Some(entry) = self.journal.pop(mark) {
            undone.push(self.undo(entry));
        }
        undone
    }

    /// Redoes undone changes, including their journal entries: arrays and journal are the same to the last byte as
    /// before. Nothing may have changed in between.
    pub fn redo(&mut self, undone: Vec<Undone>) {
        for change in undone.into_iter().rev() {
            match change {
                Undone::Changed(entry) => {
                    let Undone::Changed(old) = self.undo(entry) else {
                        unreachable!("undoing a changed value changes a value")
                    };
                    self.journal.note(old);
                }
                Undone::NodeAppended(node) => self.append_node(node),
                Undone::ElementAppended(element) => self.append_element(&element),
                Undone::NodeTaken => {
                    let node = self.free_nodes.pop().expect("the undo put it back");
                    self.journal.note(Entry::NodeTaken(node));
                }
                Undone::ElementTaken => {
                    let e = self.free_elements.pop().expect("the undo put it back");
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

    /// Restores the old value of an entry; returns the value that it replaces.
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
            Entry::Uv(n, old) => Entry::Uv(n, replace(&mut self.places[n.index()].uv, old)),
            Entry::Metric(n, old) => Entry::Metric(n, replace(&mut self.places[n.index()].metric, old)),
            Entry::Closed(old) => Entry::Closed(replace(&mut self.closed, old)),
            Entry::Anchor(n, old) => Entry::Anchor(n, replace(&mut self.anchor[n.index()], old)),
            Entry::Point(n, old) => Entry::Point(n, replace(&mut self.point[n.index()], old)),
            Entry::NodeAppended => {
                let last = self.places.len() - 1;
                let node = self.node_slot(NodeId(last as u32));
                self.resize(last, self.sides.len());
                return Undone::NodeAppended(node);
            }
            Entry::ElementAppended => {
                let last = self.sides.len() - 1;
                let element = self.element_slot(ElementId(last as u32));
                self.resize(self.places.len(), last);
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

    pub(super) fn append_node(&mut self, node: Node) {
        let last = self.places.len();
        self.resize(last + 1, self.sides.len());
        self.put_node(last, node);
        self.journal.note(Entry::NodeAppended);
    }

    pub(super) fn append_element(&mut self, element: &Element) {
        let last = self.sides.len();
        self.resize(self.places.len(), last + 1);
        self.put_element(last, element);
        self.journal.note(Entry::ElementAppended);
    }
}
