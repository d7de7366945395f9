//! The setters: every change of the mesh's arrays passes here and is written down.

use glam::DVec2;

use super::taking_back::Element;
use super::{Mesh, NONE};
use crate::core::kernel::tensor::Metric2;
use crate::core::mesh::ids::{ElementId, HalfEdgeId, NodeId};
use crate::core::mesh::journal::Entry;

impl Mesh {
    #[inline]
    pub(in crate::core::mesh) fn set_origin(&mut self, h: HalfEdgeId, node: NodeId) {
        let old = std::mem::replace(&mut self.origin[h.index()], node.0);
        self.journal.note(Entry::Origin(h, old));
    }

    #[inline]
    fn set_twin(&mut self, h: HalfEdgeId, twin: Option<HalfEdgeId>) {
        let old = std::mem::replace(&mut self.twin[h.index()], twin.map_or(NONE, |t| t.0));
        self.journal.note(Entry::Twin(h, old));
    }

    /// Makes two half-edges each other's twins, or makes the first a boundary and the anchor of its node.
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

    /// Gives a quadrilateral its level.
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

    /// Gives the boundary segment that starts at a node another level than 0: part of the mesh as it is given, and so not
    /// of the journal.
    pub(in crate::core) fn set_first_level(&mut self, node: NodeId, level: u16) {
        if self.first_level.len() <= node.index() {
            self.first_level.resize(self.uv.len(), 0);
        }
        self.first_level[node.index()] = level;
    }

    /// Puts a front segment off, or takes it up again.
    #[inline]
    pub(in crate::core) fn set_deferred(&mut self, h: HalfEdgeId, deferred: bool) {
        if self.deferred[h.index()] != deferred {
            let old = std::mem::replace(&mut self.deferred[h.index()], deferred);
            self.journal.note(Entry::Deferred(h, old));
        }
    }

    #[inline]
    fn set_anchor(&mut self, node: NodeId, h: HalfEdgeId) {
        let old = std::mem::replace(&mut self.anchor[node.index()], h.0);
        self.journal.note(Entry::Anchor(node, old));
    }

    /// Lets a free node be walked from a half-edge that leaves it; a fixed one keeps its boundary half-edge.
    #[inline]
    pub(in crate::core::mesh) fn reanchor(&mut self, h: HalfEdgeId) {
        let node = self.origin(h);
        if !self.is_fixed(node) {
            self.set_anchor(node, h);
        }
    }

    /// Moves a node and gives it the metric of its new place.
    #[inline]
    pub(in crate::core::mesh) fn set_place(&mut self, node: NodeId, uv: DVec2, metric: Metric2) {
        let old = std::mem::replace(&mut self.uv[node.index()], uv);
        self.journal.note(Entry::Uv(node, old));
        let old = std::mem::replace(&mut self.metric[node.index()], metric);
        self.journal.note(Entry::Metric(node, old));
    }

    /// Makes a free node that no element uses yet.
    pub(in crate::core::mesh) fn new_node(&mut self, uv: DVec2, metric: Metric2) -> NodeId {
        if self.free_nodes.len() > self.closed[0] as usize
            && let Some(node) = self.free_nodes.pop()
        {
            self.journal.note(Entry::NodeTaken(node));
            self.set_place(node, uv, metric);
            return node;
        }
        self.append_node((uv, metric, NONE, NONE));
        NodeId(self.uv.len() as u32 - 1)
    }

    /// Makes a tombstone of a free node that no element uses any more.
    pub(in crate::core::mesh) fn free_node(&mut self, node: NodeId) {
        debug_assert!(!self.is_fixed(node));
        let old = std::mem::replace(&mut self.anchor[node.index()], NONE);
        self.journal.note(Entry::Anchor(node, old));
        self.free_nodes.push(node);
        self.journal.note(Entry::NodeFreed);
    }

    /// Makes an element without nodes or twins yet.
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

    /// Makes a tombstone of an element.
    pub(in crate::core::mesh) fn free_element(&mut self, e: ElementId) {
        self.set_sides(e, 0);
        self.free_elements.push(e);
        self.journal.note(Entry::ElementFreed);
    }

    /// Lets what is free now stay so: what is made from now on gets slots of its own. So a face that is converted after another has
    /// the ids that it would have alone, in their order.
    pub(in crate::core) fn close_free_lists(&mut self) {
        let closed = [self.free_nodes.len() as u32, self.free_elements.len() as u32];
        let old = std::mem::replace(&mut self.closed, closed);
        self.journal.note(Entry::Closed(old));
    }
}
