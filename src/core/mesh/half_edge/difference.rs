//! Differences between two states of a mesh: the later contents of every touched slot. They store many similar states
//! in little memory.
//!
//! Applying a difference copies a state, as `clone` does; the journal does not record it.

use super::slots::{Element, Node};
use super::{Mesh, NONE};
use crate::core::mesh::half_edge::touched::Touched;
use crate::core::mesh::ids::{ElementId, HalfEdgeId, NodeId};
use crate::core::mesh::journal::{Journal, Mark};

/// The free lists of a state, to find their common beginning with later ones.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FreeLists {
    nodes: Vec<NodeId>,
    elements: Vec<ElementId>,
}

/// A later state of a mesh in terms of an earlier one.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    node_slots: usize,
    element_slots: usize,
    /// By id.
    nodes: Box<[(NodeId, Node)]>,
    /// By id.
    elements: Box<[(ElementId, Element)]>,
    free_nodes: Tail<NodeId>,
    free_elements: Tail<ElementId>,
    closed: [u32; 2],
}

/// A list given by the length of the beginning that it shares with an earlier list, and the rest.
#[derive(Clone, Debug, PartialEq)]
struct Tail<T> {
    kept: usize,
    then: Box<[T]>,
}

impl<T: Copy + PartialEq> Tail<T> {
    fn between(before: &[T], after: &[T]) -> Self {
        let kept = before.iter().zip(after).take_while(|(a, b)| a == b).count();
        Tail { kept, then: after[kept..].into() }
    }

    fn apply(&self, list: &mut Vec<T>) {
        list.truncate(self.kept);
        list.extend_from_slice(&self.then);
    }

    /// The composition of this change and a later one.
    fn and(&self, later: &Tail<T>) -> Tail<T> {
        let stays = later.kept.saturating_sub(self.kept);
        let then: Vec<T> = self.then[..stays].iter().chain(&later.then).copied().collect();
        Tail { kept: self.kept.min(later.kept), then: then.into() }
    }
}

impl Difference {
    /// Its memory, bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>()
            + size_of_val(&*self.nodes)
            + size_of_val(&*self.elements)
            + size_of_val(&*self.free_nodes.then)
            + size_of_val(&*self.free_elements.then)
    }

    /// Whether the node was touched between the two states; there are no false negatives.
    pub fn touches_node(&self, node: NodeId) -> bool {
        self.nodes.binary_search_by_key(&node, |slot| slot.0).is_ok()
    }

    /// Whether the element was touched between the two states; there are no false negatives.
    pub fn touches_element(&self, element: ElementId) -> bool {
        self.elements.binary_search_by_key(&element, |slot| slot.0).is_ok()
    }

    /// The composition of this difference and a later one.
    #[must_use]
    pub fn and(&self, later: &Difference) -> Difference {
        Difference {
            node_slots: later.node_slots,
            element_slots: later.element_slots,
            nodes: newest(&self.nodes, &later.nodes),
            elements: newest(&self.elements, &later.elements),
            free_nodes: self.free_nodes.and(&later.free_nodes),
            free_elements: self.free_elements.and(&later.free_elements),
            closed: later.closed,
        }
    }
}

/// The merge of two lists sorted by id; the later one takes precedence.
fn newest<I: Copy + Ord, T: Clone>(before: &[(I, T)], later: &[(I, T)]) -> Box<[(I, T)]> {
    let mut merged = Vec::with_capacity(before.len() + later.len());
    let mut rest = before;
    for slot in later {
        let count = rest.partition_point(|old| old.0 < slot.0);
        merged.extend_from_slice(&rest[..count]);
        rest = &rest[count..];
        if rest.first().is_some_and(|old| old.0 == slot.0) {
            rest = &rest[1..];
        }
        merged.push(slot.clone());
    }
    merged.extend_from_slice(rest);
    merged.into()
}

impl Mesh {
    /// The node in a slot of an element, even of a tombstone, if there is one.
    pub(in crate::core::mesh) fn slot_origin(&self, h: HalfEdgeId) -> Option<NodeId> {
        self.origin.get(h.index()).filter(|&&n| n != NONE).map(|&n| NodeId(n))
    }

    /// The current free lists.
    pub fn free_lists(&self) -> FreeLists {
        FreeLists { nodes: self.free_nodes.clone(), elements: self.free_elements.clone() }
    }

    /// The memory of the arrays, without the journal, bytes.
    pub fn bytes(&self) -> usize {
        self.places.capacity() * size_of::<Node>()
            + self.sides.capacity() * size_of::<Element>()
            + 4 * (self.free_nodes.capacity() + self.free_elements.capacity())
    }

    /// The difference from an earlier state, given the slots touched since and the free lists of that state.
    pub fn difference(&self, touched: &Touched, free: &FreeLists) -> Difference {
        let mut nodes: Vec<_> = touched.nodes().iter().copied().filter(|n| n.index() < self.places.len()).collect();
        nodes.sort_unstable();
        let mut elements: Vec<_> =
            touched.elements().iter().copied().filter(|e| e.index() < self.sides.len()).collect();
        elements.sort_unstable();
        Difference {
            node_slots: self.places.len(),
            element_slots: self.sides.len(),
            nodes: nodes.into_iter().map(|n| (n, self.node_slot(n))).collect(),
            elements: elements.into_iter().map(|e| (e, self.element_slot(e))).collect(),
            free_nodes: Tail::between(&free.nodes, &self.free_nodes),
            free_elements: Tail::between(&free.elements, &self.free_elements),
            closed: self.closed,
        }
    }

    /// Copies the state of another mesh, with an empty journal. It reuses allocated memory, which saves most of the
    /// cost of a copy.
    pub(in crate::core) fn become_same(&mut self, other: &Mesh) {
        // It names every field, so that none can be forgotten.
        macro_rules! copy {
            ($($field:ident)+) => {
                let Mesh { $($field,)+ journal: _ } = other;
                $(self.$field.clone_from($field);)+
            };
        }
        copy! {
            places anchor point origin twin sides region level deferred first_level
            free_nodes free_elements closed refusals embedding symmetry
        }
        self.journal = Journal::default();
    }

    /// Copies the state of another mesh, of which this is an older or newer state: `touched` are the slots that differ.
    /// The cost is proportional to those; the journal is empty afterwards.
    pub(in crate::core) fn follow(&mut self, other: &Mesh, touched: &Touched) {
        self.resize(other.places.len(), other.sides.len());
        for &n in touched.nodes().iter().filter(|n| n.index() < other.places.len()) {
            self.put_node(n.index(), other.node_slot(n));
        }
        for &e in touched.elements().iter().filter(|e| e.index() < other.sides.len()) {
            self.put_element(e.index(), &other.element_slot(e));
        }
        self.free_nodes.clone_from(&other.free_nodes);
        self.free_elements.clone_from(&other.free_elements);
        self.closed = other.closed;
        self.journal = Journal::default();
    }

    /// Applies a difference from this state. The journal must be empty, and remains empty.
    pub fn apply(&mut self, difference: &Difference) {
        debug_assert!(self.journal.since(Mark::default()).is_empty(), "a copied state has no history");
        self.resize(difference.node_slots, difference.element_slots);
        for &(n, node) in &difference.nodes {
            self.put_node(n.index(), node);
        }
        for (e, element) in &difference.elements {
            self.put_element(e.index(), element);
        }
        difference.free_nodes.apply(&mut self.free_nodes);
        difference.free_elements.apply(&mut self.free_elements);
        self.closed = difference.closed;
    }
}
