//! The contents of the slots of nodes and elements, for copies of states and for undo.

use glam::DVec2;

use super::{Mesh, NONE, Place};
use crate::core::kernel::Metric2;
use crate::core::mesh::ids::{ElementId, NodeId};

/// The contents of the slot of a node: position, metric, anchor, point.
pub type Node = (DVec2, Metric2, u32, u32);

/// The contents of the slots of an element.
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    pub(super) origin: [u32; 4],
    pub(super) twin: [u32; 4],
    pub(super) deferred: [bool; 4],
    pub(super) sides: u8,
    pub(super) region: u32,
    pub(super) level: u16,
}

impl Mesh {
    pub(super) fn node_slot(&self, n: NodeId) -> Node {
        let n = n.index();
        let Place { uv, metric } = self.places[n];
        (uv, metric, self.anchor[n], self.point[n])
    }

    pub(super) fn element_slot(&self, e: ElementId) -> Element {
        let (e, first) = (e.index(), 4 * e.index());
        Element {
            origin: std::array::from_fn(|k| self.origin[first + k]),
            twin: std::array::from_fn(|k| self.twin[first + k]),
            deferred: std::array::from_fn(|k| self.deferred[first + k]),
            sides: self.sides[e],
            region: self.region[e],
            level: self.level[e],
        }
    }

    /// Sets the contents of a slot; the journal does not record it.
    pub(super) fn put_node(&mut self, n: usize, (uv, metric, anchor, point): Node) {
        self.places[n] = Place { uv, metric };
        (self.anchor[n], self.point[n]) = (anchor, point);
    }

    /// Sets the contents of a slot; the journal does not record it.
    pub(super) fn put_element(&mut self, e: usize, element: &Element) {
        let slots = 4 * e..4 * e + 4;
        self.origin[slots.clone()].copy_from_slice(&element.origin);
        self.twin[slots.clone()].copy_from_slice(&element.twin);
        self.deferred[slots].copy_from_slice(&element.deferred);
        (self.sides[e], self.region[e], self.level[e]) = (element.sides, element.region, element.level);
    }

    /// Resizes all arrays, except the first levels, to these numbers of slots; the journal does not record it.
    pub(super) fn resize(&mut self, nodes: usize, elements: usize) {
        self.places.resize(nodes, Place { uv: DVec2::ZERO, metric: Metric2::isotropic(1.0) });
        self.anchor.resize(nodes, NONE);
        self.point.resize(nodes, NONE);
        self.origin.resize(4 * elements, NONE);
        self.twin.resize(4 * elements, NONE);
        self.deferred.resize(4 * elements, false);
        self.sides.resize(elements, 0);
        self.region.resize(elements, 0);
        self.level.resize(elements, 0);
    }
}
