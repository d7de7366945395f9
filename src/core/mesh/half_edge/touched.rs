//! The touched nodes and elements: the ids in entries of the journal, each once.

use super::{Mesh, Undone};
use crate::core::mesh::ids::{ElementId, HalfEdgeId, NodeId};
use crate::core::mesh::journal::{Entry, Mark};

/// Nodes and elements that may have changed: nodes with another position, metric or fan, elements with other sides or
/// neighbours. They include new and removed ones, but not slots removed from the end.
#[derive(Clone, Debug, Default)]
pub struct Touched {
    nodes: Vec<NodeId>,
    elements: Vec<ElementId>,
    node_seen: Vec<bool>,
    element_seen: Vec<bool>,
}

impl Touched {
    /// The nodes, in the order in which they were first touched.
    pub fn nodes(&self) -> &[NodeId] {
        &self.nodes
    }

    /// The elements, in the order in which they were first touched.
    pub fn elements(&self) -> &[ElementId] {
        &self.elements
    }

    /// Whether nothing was touched.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty() && self.elements.is_empty()
    }

    /// Removes all ids.
    pub fn clear(&mut self) {
        for node in self.nodes.drain(..) {
            self.node_seen[node.index()] = false;
        }
        for element in self.elements.drain(..) {
            self.element_seen[element.index()] = false;
        }
    }

    /// Adds nodes and elements.
    pub fn note_ids(&mut self, nodes: &[NodeId], elements: &[ElementId]) {
        nodes.iter().for_each(|node| self.node(*node));
        elements.iter().for_each(|element| self.element(*element));
    }

    /// Adds what the entries of the mesh's journal after a mark touch.
    pub fn note_since(&mut self, mesh: &Mesh, mark: Mark) {
        for entry in mesh.journal().since(mark) {
            self.note(mesh, entry);
        }
    }

    /// Adds what undone changes touch.
    pub fn note_undone(&mut self, mesh: &Mesh, undone: &[Undone]) {
        for change in undone {
            if let Undone::Changed(entry) = change {
                self.note(mesh, entry);
            }
        }
    }

    /// Adds what one change touches. If the sides of an element change, its nodes before and after the change are
    /// touched too.
    fn note(&mut self, mesh: &Mesh, entry: &Entry) {
        match *entry {
            Entry::Origin(h, old) => {
                self.element(h.element());
                if old != u32::MAX {
                    self.node(NodeId(old));
                }
                self.origin(mesh, h);
            }
            Entry::Sides(e, _) => {
                self.element(e);
                for corner in 0..4 {
                    self.origin(mesh, e.half_edge(corner));
                }
            }
            Entry::Twin(h, _) | Entry::Deferred(h, _) => self.element(h.element()),
            Entry::Region(e, _) | Entry::Level(e, _) | Entry::ElementTaken(e) => self.element(e),
            Entry::Uv(n, _) | Entry::Metric(n, _) | Entry::Anchor(n, _) | Entry::Point(n, _) | Entry::NodeTaken(n) => {
                self.node(n)
            }
            // Other entries fill or empty the slots that are appended or freed.
            Entry::NodeAppended
            | Entry::ElementAppended
            | Entry::NodeFreed
            | Entry::ElementFreed
            | Entry::Closed(_) => {}
        }
    }

    fn origin(&mut self, mesh: &Mesh, h: HalfEdgeId) {
        if let Some(node) = mesh.slot_origin(h) {
            self.node(node);
        }
    }

    fn node(&mut self, node: NodeId) {
        if mark(&mut self.node_seen, node.index()) {
            self.nodes.push(node);
        }
    }

    fn element(&mut self, element: ElementId) {
        if mark(&mut self.element_seen, element.index()) {
            self.elements.push(element);
        }
    }
}

/// Marks an index; returns whether it was unmarked.
fn mark(seen: &mut Vec<bool>, index: usize) -> bool {
    if seen.len() <= index {
        seen.resize((index + 1).next_power_of_two(), false);
    }
    !std::mem::replace(&mut seen[index], true)
}
