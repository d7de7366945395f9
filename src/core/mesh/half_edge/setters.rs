//! The setters: every change of the arrays of the mesh goes through them, and they record it in the journal.

use glam::DVec2;

use super::slots::Element;
use super::{Mesh, NONE, Place};
use crate::core::kernel::Metric2;
use crate::core::mesh::ids::{ElementId, HalfEdgeId, NodeId};
use crate::core::mesh::journal::Entry;

impl Mesh {
    #[inline]
    pub(in crate::core::mesh) fn set_origin(&mut self, h: HalfEdgeId, node: NodeId) {
        let old = std::mem::replace(&mut self.origin[h.index()], node.0);
        self.journal.note(Entry::Origin(h, old));
    }

    /// Sets the nodes of a triangle.
    pub(in crate::core::mesh) fn set_corners(&mut self, e: ElementId, nodes: [NodeId; 3]) {
        for (corner, node) in (0..).zip(nodes) {
            self.set_origin(e.half_edge(corner), node);
        }
    }

    #[inline]
    pub(super) fn set_twin(&mut self, h: HalfEdgeId, twin: Option<HalfEdgeId>) {
        let old = std::mem::replace(&mut self.twin[h.index()], twin.map_or(NONE, |t| t.0));
        self.journal.note(Entry::Twin(h, old));
    }

    /// Makes two half-edges twins, or makes the first one a boundary and the anchor of its node.
    #[inline]
    pub(in crate::core::mesh) fn hook(&mut self, h: HalfEdgeId, twin: Option<HalfEdgeId>) {
        self.set_twin(h, twin);
        match twin {
            Some(t) => self.set_twin(t, Some(h)),
            None => self.set_anchor(self.origin(h), h),
        }
    }

    #[inline]
    pub(in crate::core::mesh) fn set_sides(&mut self, e: ElementId, sides: u8) {
        let old = std::mem::replace(&mut self.sides[e.index()], sides);
        self.journal.note(Entry::Sides(e, old));
    }

    #[inline]
    fn set_region(&mut self, e: ElementId, region: u32) {
        let old = std::mem::replace(&mut self.region[e.index()], region);
        self.journal.note(Entry::Region(e, old));
    }

    /// Sets the level of a quadrilateral.
    #[inline]
    pub(in crate::core) fn set_level(&mut self, e: ElementId, level: u16) {
        if self.level[e.index()] != level {
            let old = std::mem::replace(&mut self.level[e.index()], level);
            self.journal.note(Entry::Level(e, old));
        }
    }

    /// The level of the boundary segment that starts at a node.
    #[inline]
    pub fn first_level(&self, node: NodeId) -> u16 {
        self.first_level.get(node.index()).copied().unwrap_or(0)
    }

    /// Sets the level of the boundary segment that starts at a node. It belongs to the initial mesh, so the journal
    /// does not record it.
    pub(in crate::core) fn set_first_level(&mut self, node: NodeId, level: u16) {
        if self.first_level.len() <= node.index() {
            self.first_level.resize(self.places.len(), 0);
        }
        self.first_level[node.index()] = level;
    }

    /// Defers a front segment, or reactivates it.
    #[inline]
    pub(in crate::core) fn set_deferred(&mut self, h: HalfEdgeId, deferred: bool) {
        if self.deferred[h.index()] != deferred {
            let old = std::mem::replace(&mut self.deferred[h.index()], deferred);
            self.journal.note(Entry::Deferred(h, old));
        }
    }

    /// Gives a node an output point, or none.
    pub(super) fn set_point(&mut self, node: NodeId, point: u32) {
        let old = std::mem::replace(&mut self.point[node.index()], point);
        self.journal.note(Entry::Point(node, old));
    }

    #[inline]
    pub(super) fn set_anchor(&mut self, node: NodeId, h: HalfEdgeId) {
        let old = std::mem::replace(&mut self.anchor[node.index()], h.0);
        self.journal.note(Entry::Anchor(node, old));
    }

    /// Starts the fan of a node inside at a half-edge that leaves it; one on a boundary keeps its boundary half-edge.
    #[inline]
    pub(in crate::core::mesh) fn reanchor(&mut self, h: HalfEdgeId) {
        let node = self.origin(h);
        if !self.is_on_boundary(node) {
            self.set_anchor(node, h);
        }
    }

    /// Sets the position of a node and its metric there.
    #[inline]
    pub(in crate::core::mesh) fn set_place(&mut self, node: NodeId, uv: DVec2, metric: Metric2) {
        let old = std::mem::replace(&mut self.places[node.index()], Place { uv, metric });
        self.journal.note(Entry::Uv(node, old.uv));
        self.journal.note(Entry::Metric(node, old.metric));
    }

    /// Creates a free node without elements.
    pub(in crate::core::mesh) fn new_node(&mut self, uv: DVec2, metric: Metric2) -> NodeId {
        if self.free_nodes.len() > self.closed[0] as usize
            && let Some(node) = self.free_nodes.pop()
        {
            self.journal.note(Entry::NodeTaken(node));
            self.set_place(node, uv, metric);
            return node;
        }
        self.append_node((uv, metric, NONE, NONE));
        NodeId(self.places.len() as u32 - 1)
    }

    /// Turns a free node without elements into a tombstone.
    pub(in crate::core::mesh) fn free_node(&mut self, node: NodeId) {
        debug_assert!(!self.is_fixed(node));
        let old = std::mem::replace(&mut self.anchor[node.index()], NONE);
        self.journal.note(Entry::Anchor(node, old));
        self.free_nodes.push(node);
        self.journal.note(Entry::NodeFreed);
    }

    /// Creates an element without nodes or twins.
    pub(in crate::core::mesh) fn new_element(&mut self, sides: u8, region: u32) -> ElementId {
        if self.free_elements.len() > self.closed[1] as usize
            && let Some(e) = self.free_elements.pop()
        {
            self.journal.note(Entry::ElementTaken(e));
            self.set_sides(e, sides);
            self.set_region(e, region);
            self.set_level(e, 0);
            return e;
        }
        let empty = Element { origin: [NONE; 4], twin: [NONE; 4], deferred: [false; 4], sides, region, level: 0 };
        self.append_element(&empty);
        ElementId(self.sides.len() as u32 - 1)
    }

    /// Turns an element into a tombstone.
    pub(in crate::core::mesh) fn free_element(&mut self, e: ElementId) {
        self.set_sides(e, 0);
        self.free_elements.push(e);
        self.journal.note(Entry::ElementFreed);
    }

    /// Closes the free lists: slots that are free now are not reused, so that a face converted after another one gets
    /// the same ids in the same order as it would alone.
    pub(in crate::core) fn close_free_lists(&mut self) {
        let closed = [self.free_nodes.len() as u32, self.free_elements.len() as u32];
        let old = std::mem::replace(&mut self.closed, closed);
        self.journal.note(Entry::Closed(old));
    }
}
