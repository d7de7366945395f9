//! What differs between two states of a mesh, a later one in terms of an earlier one: the whole content of every slot that was
//! touched. Many states near each other are kept so in little memory.
//!
//! Applying a difference is copying a state, as `clone` is, and no change of the mesh: nothing is written down.

use glam::DVec2;

use super::taking_back::Element;
use super::{Mesh, NONE};
use crate::core::kernel::tensor::Metric2;
use crate::core::mesh::half_edge::touched::Touched;
use crate::core::mesh::ids::{ElementId, HalfEdgeId, NodeId};
use crate::core::mesh::journal::{Journal, Mark};

/// The free lists of a state, to find what of them stayed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FreeLists {
    nodes: Vec<NodeId>,
    elements: Vec<ElementId>,
}

/// What stands in the slot of a node.
type Node = (DVec2, Metric2, u32, u32);

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

/// A list of which the beginning stayed.
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

    /// This and then another, in one.
    fn and(&self, later: &Tail<T>) -> Tail<T> {
        let stays = later.kept.saturating_sub(self.kept);
        let then: Vec<T> = self.then[..stays].iter().chain(&later.then).copied().collect();
        Tail { kept: self.kept.min(later.kept), then: then.into() }
    }
}

impl Difference {
    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>()
            + size_of_val(&*self.nodes)
            + size_of_val(&*self.elements)
            + size_of_val(&*self.free_nodes.then)
            + size_of_val(&*self.free_elements.then)
    }

    /// Whether the node was touched on the way; never wrong where it says no.
    pub fn touches_node(&self, node: NodeId) -> bool {
        self.nodes.binary_search_by_key(&node, |slot| slot.0).is_ok()
    }

    /// Whether the element was touched on the way; never wrong where it says no.
    pub fn touches_element(&self, element: ElementId) -> bool {
        self.elements.binary_search_by_key(&element, |slot| slot.0).is_ok()
    }

    /// This difference and then another, in one.
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

/// Two lists by id as one; where both have an id, the later one counts.
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
    /// The node in a slot of an element, also of a tombstone; `None` where there is none.
    pub(in crate::core::mesh) fn slot_origin(&self, h: HalfEdgeId) -> Option<NodeId> {
        self.origin.get(h.index()).filter(|&&n| n != NONE).map(|&n| NodeId(n))
    }

    /// The free lists as they are.
    pub fn free_lists(&self) -> FreeLists {
        FreeLists { nodes: self.free_nodes.clone(), elements: self.free_elements.clone() }
    }

    /// Bytes that the arrays take, without the journal.
    pub fn bytes(&self) -> usize {
        self.uv.capacity() * size_of::<Node>()
            + self.sides.capacity() * size_of::<Element>()
            + 4 * (self.free_nodes.capacity() + self.free_elements.capacity())
    }

    /// This state in terms of an earlier one: with what was touched since, and the free lists of then.
    pub fn difference(&self, touched: &Touched, free: &FreeLists) -> Difference {
        let mut nodes: Vec<_> = touched.nodes().iter().copied().filter(|n| n.index() < self.uv.len()).collect();
        nodes.sort_unstable();
        let mut elements: Vec<_> =
            touched.elements().iter().copied().filter(|e| e.index() < self.sides.len()).collect();
        elements.sort_unstable();
        Difference {
            node_slots: self.uv.len(),
            element_slots: self.sides.len(),
            nodes: nodes.into_iter().map(|n| (n, self.node_slot(n))).collect(),
            elements: elements.into_iter().map(|e| (e, self.element_slot(e))).collect(),
            free_nodes: Tail::between(&free.nodes, &self.free_nodes),
            free_elements: Tail::between(&free.elements, &self.free_elements),
            closed: self.closed,
        }
    }

    /// Becomes the same state as another mesh, with nothing in the journal; memory that is there already is used again, which is
    /// most of the cost of a copy.
    pub(in crate::core) fn become_same(&mut self, other: &Mesh) {
        // Every field is named, so that none can be forgotten.
        let Mesh {
            uv,
            metric,
            anchor,
            point,
            origin,
            twin,
            sides,
            region,
            level,
            deferred,
            first_level,
            free_nodes,
            free_elements,
            closed,
            journal: _,
            refusals,
            ground,
        } = other;
        self.ground.clone_from(ground);
        self.uv.clone_from(uv);
        self.metric.clone_from(metric);
        self.anchor.clone_from(anchor);
        self.point.clone_from(point);
        self.origin.clone_from(origin);
        self.twin.clone_from(twin);
        self.sides.clone_from(sides);
        self.region.clone_from(region);
        self.level.clone_from(level);
        self.deferred.clone_from(deferred);
        self.first_level.clone_from(first_level);
        self.free_nodes.clone_from(free_nodes);
        self.free_elements.clone_from(free_elements);
        self.closed = *closed;
        self.journal = Journal::default();
        self.refusals.clone_from(refusals);
    }

    /// Becomes the same state as another mesh, of which this is an older or newer state: `touched` are the slots that differ.
    /// Costs as much as differs; the journal is left empty.
    pub(in crate::core) fn follow(&mut self, other: &Mesh, touched: &Touched) {
        self.uv.resize(other.uv.len(), DVec2::ZERO);
        self.metric.resize(other.uv.len(), Metric2::isotropic(1.0));
        self.anchor.resize(other.uv.len(), NONE);
        self.point.resize(other.uv.len(), NONE);
        for n in touched.nodes().iter().map(|n| n.index()).filter(|n| *n < other.uv.len()) {
            self.uv[n] = other.uv[n];
            self.metric[n] = other.metric[n];
            self.anchor[n] = other.anchor[n];
            self.point[n] = other.point[n];
        }
        self.origin.resize(other.origin.len(), NONE);
        self.twin.resize(other.origin.len(), NONE);
        self.deferred.resize(other.origin.len(), false);
        self.sides.resize(other.sides.len(), 0);
        self.region.resize(other.sides.len(), 0);
        self.level.resize(other.sides.len(), 0);
        for e in touched.elements().iter().map(|e| e.index()).filter(|e| *e < other.sides.len()) {
            let slots = 4 * e..4 * e + 4;
            self.origin[slots.clone()].copy_from_slice(&other.origin[slots.clone()]);
            self.twin[slots.clone()].copy_from_slice(&other.twin[slots.clone()]);
            self.deferred[slots.clone()].copy_from_slice(&other.deferred[slots]);
            self.sides[e] = other.sides[e];
            self.region[e] = other.region[e];
            self.level[e] = other.level[e];
        }
        self.free_nodes.clone_from(&other.free_nodes);
        self.free_elements.clone_from(&other.free_elements);
        self.closed = other.closed;
        self.journal = Journal::default();
    }

    /// Becomes the later state of a difference whose earlier one this is. The journal must be empty, and stays so.
    pub fn apply(&mut self, difference: &Difference) {
        debug_assert!(self.journal.since(Mark::default()).is_empty(), "a state that is copied has no past");
        self.uv.resize(difference.node_slots, DVec2::ZERO);
        self.metric.resize(difference.node_slots, Metric2::isotropic(1.0));
        self.anchor.resize(difference.node_slots, NONE);
        self.point.resize(difference.node_slots, NONE);
        for &(n, (uv, metric, anchor, point)) in &difference.nodes {
            let n = n.index();
            (self.uv[n], self.metric[n], self.anchor[n], self.point[n]) = (uv, metric, anchor, point);
        }
        self.origin.resize(4 * difference.element_slots, NONE);
        self.twin.resize(4 * difference.element_slots, NONE);
        self.deferred.resize(4 * difference.element_slots, false);
        self.sides.resize(difference.element_slots, 0);
        self.region.resize(difference.element_slots, 0);
        self.level.resize(difference.element_slots, 0);
        for (e, slot) in &difference.elements {
            let (e, slots) = (e.index(), 4 * e.index()..4 * e.index() + 4);
            self.origin[slots.clone()].copy_from_slice(&slot.origin);
            self.twin[slots.clone()].copy_from_slice(&slot.twin);
            self.deferred[slots].copy_from_slice(&slot.deferred);
            (self.sides[e], self.region[e], self.level[e]) = (slot.sides, slot.region, slot.level);
        }
        difference.free_nodes.apply(&mut self.free_nodes);
        difference.free_elements.apply(&mut self.free_elements);
        self.closed = difference.closed;
    }

    fn node_slot(&self, n: NodeId) -> Node {
        let n = n.index();
        (self.uv[n], self.metric[n], self.anchor[n], self.point[n])
    }

    fn element_slot(&self, e: ElementId) -> Element {
        let first = 4 * e.index();
        Element {
            origin: std::array::from_fn(|k| self.origin[first + k]),
            twin: std::array::from_fn(|k| self.twin[first + k]),
            deferred: std::array::from_fn(|k| self.deferred[first + k]),
            sides: self.sides[e.index()],
            region: self.region[e.index()],
            level: self.level[e.index()],
        }
    }
}
