//! The mesh: triangles and quadrilaterals in one half-edge structure of plain arrays (docs/algorithm.md, "Half-edge
//! structure").
//!
//! A half-edge is slot `4 * element + corner`; `next` and `previous` are arithmetic, only `origin` and `twin` are
//! stored. Every node has one fan of elements (pinched nodes have copies that share a `PointId`). The fan of a boundary
//! node starts at its boundary half-edge, so that one anticlockwise turn visits all of it.
//!
//! All changes go through the setters (`half_edge/setters.rs`), which record the old value in the journal;
//! `half_edge/taking_back.rs` restores it. The public ways to change a mesh are the operators (`operators.rs`).

mod copies;
mod difference;
mod faces;
mod fixed;
mod embedding;
mod image;
mod setters;
mod slots;
mod permission;
mod taking_back;
pub mod touched;

pub use difference::{Difference, FreeLists};
pub use embedding::Embedding;
pub use faces::FaceMesh;
pub use image::Symmetry;
pub use taking_back::Undone;

use std::sync::Arc;

use glam::DVec2;

use super::ids::{ElementId, HalfEdgeId, NodeId};
use super::refusals::Refusals;
use super::triangle_set::TriangleSet;
use crate::core::kernel::Metric2;
use crate::core::mesh::journal::Journal;

/// Absence in the arrays; elsewhere absence is `Option`.
const NONE: u32 = u32::MAX;

/// Triangles and quadrilaterals with their nodes.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    places: Vec<Place>,
    /// The half-edge at which the fan of a node starts; `NONE` for a tombstone.
    anchor: Vec<u32>,
    /// The output point of a fixed node, with [`fixed::HARD`] inside; `NONE` for a free one.
    point: Vec<u32>,
    origin: Vec<u32>,
    twin: Vec<u32>,
    /// 3, 4, or 0 for a tombstone.
    sides: Vec<u8>,
    region: Vec<u32>,
    /// Row of a quadrilateral, counted from the boundary (0 for a triangle).
    level: Vec<u16>,
    /// Whether the front segment in this slot is deferred.
    deferred: Vec<bool>,
    /// The level of the boundary segment that starts at a node, by default 0. Set before the first change.
    first_level: Vec<u16>,
    free_nodes: Vec<NodeId>,
    free_elements: Vec<ElementId>,
    /// The numbers of the first free nodes and elements that are not reused.
    closed: [u32; 2],
    journal: Journal,
    pub(super) refusals: Option<Refusals>,
    /// The surfaces on which it lies; `None` in the plane.
    embedding: Option<Arc<Embedding>>,
    /// What joins its mirror image to it, if it is one half of a symmetric domain.
    symmetry: Option<Arc<Symmetry>>,
}

/// Where a node is, and its metric there: side by side, since one is seldom read without the other.
#[derive(Clone, Copy, Debug)]
struct Place {
    uv: DVec2,
    metric: Metric2,
}

/// An element to be created: its nodes anticlockwise (three or four) and its region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewElement {
    nodes: [NodeId; 4],
    sides: u8,
    region: u32,
}

impl NewElement {
    /// A triangle.
    pub fn triangle(nodes: [NodeId; 3], region: u32) -> Self {
        NewElement { nodes: [nodes[0], nodes[1], nodes[2], nodes[2]], sides: 3, region }
    }

    /// A quadrilateral.
    pub fn quad(nodes: [NodeId; 4], region: u32) -> Self {
        NewElement { nodes, sides: 4, region }
    }

    /// Its nodes, anticlockwise.
    pub fn nodes(&self) -> &[NodeId] {
        &self.nodes[..self.sides as usize]
    }

    /// Its region.
    pub fn region(&self) -> u32 {
        self.region
    }
}

/// Iterator over the half-edges that leave a node, anticlockwise; see [`Mesh::fan`].
pub struct Fan<'a> {
    mesh: &'a Mesh,
    start: HalfEdgeId,
    next: Option<HalfEdgeId>,
}

impl Iterator for Fan<'_> {
    type Item = HalfEdgeId;

    #[inline]
    fn next(&mut self) -> Option<HalfEdgeId> {
        let h = self.next?;
        self.next = self.mesh.twin(self.mesh.previous(h)).filter(|&n| n != self.start);
        Some(h)
    }
}

impl Mesh {
    /// The mesh of a set of triangles, with the metric of each node. Nodes on a boundary and hard points become fixed.
    ///
    /// # Panics
    /// If the set is invalid (a side is used twice in one direction, a node has two fans).
    pub fn from_triangles(set: &TriangleSet, metric: Vec<Metric2>) -> Self {
        assert_eq!(set.uv.len(), metric.len(), "one metric a node");
        assert!(set.triangles.len() < (NONE / 4) as usize, "half-edge ids are 32 bits");
        let elements = set.triangles.len();
        let mut mesh = Mesh {
            places: set.uv.iter().zip(metric).map(|(&uv, metric)| Place { uv, metric }).collect(),
            anchor: vec![NONE; set.uv.len()],
            point: vec![NONE; set.uv.len()],
            origin: vec![NONE; 4 * elements],
            twin: vec![NONE; 4 * elements],
            sides: vec![3; elements],
            region: set.region.clone(),
            level: vec![0; elements],
            deferred: vec![false; 4 * elements],
            ..Mesh::default()
        };
        let mut by_side: Vec<(u64, u32)> = Vec::with_capacity(3 * elements);
        for (element, nodes) in set.triangles.iter().enumerate() {
            for corner in 0..3 {
                let half_edge = (4 * element + corner) as u32;
                let (a, b) = (nodes[corner], nodes[(corner + 1) % 3]);
                mesh.origin[half_edge as usize] = a;
                if mesh.anchor[a as usize] == NONE {
                    mesh.anchor[a as usize] = half_edge;
                }
                by_side.push((u64::from(a.min(b)) << 32 | u64::from(a.max(b)), half_edge));
            }
        }
        by_side.sort_unstable();
        let mut rest = by_side.as_slice();
        while let [(side, h), tail @ ..] = rest {
            let h = *h;
            if let Some(&(_, t)) = tail.first().filter(|(other, _)| other == side) {
                assert_ne!(mesh.origin[h as usize], mesh.origin[t as usize], "a side is used twice in one direction");
                mesh.twin[h as usize] = t;
                mesh.twin[t as usize] = h;
                rest = &tail[1..];
            } else {
                let node = mesh.origin[h as usize] as usize;
                assert_eq!(mesh.point[node], NONE, "node {node} has two fans");
                mesh.anchor[node] = h;
                mesh.point[node] = set.point[node].0;
                rest = tail;
            }
        }
        for &(node, _) in &set.hard {
            let point = &mut mesh.point[node as usize];
            if *point == NONE {
                *point = set.point[node as usize].0 | fixed::HARD;
            }
        }
        mesh
    }

    // ---- counts and walks ----

    /// Number of node slots, tombstones included.
    pub fn node_slots(&self) -> usize {
        self.places.len()
    }

    /// All elements of one face (region), or all, by id.
    pub fn elements_of(&self, face: Option<u32>) -> impl Iterator<Item = ElementId> + '_ {
        self.elements().filter(move |&e| face.is_none_or(|face| self.region(e) == face))
    }

    /// All nodes of one face (region), or all, by id.
    pub fn nodes_of(&self, face: Option<u32>) -> impl Iterator<Item = NodeId> + '_ {
        let region = |n: NodeId| self.region[(self.anchor[n.index()] >> 2) as usize];
        self.nodes().filter(move |&n| face.is_none_or(|face| region(n) == face))
    }

    /// Number of element slots, tombstones included.
    pub fn element_slots(&self) -> usize {
        self.sides.len()
    }

    /// Number of nodes in use.
    pub fn node_count(&self) -> usize {
        self.places.len() - self.free_nodes.len()
    }

    /// Number of elements in use.
    pub fn element_count(&self) -> usize {
        self.sides.len() - self.free_elements.len()
    }

    /// All nodes in use, by id.
    pub fn nodes(&self) -> impl Iterator<Item = NodeId> + '_ {
        (0..self.anchor.len() as u32).filter(|&n| self.anchor[n as usize] != NONE).map(NodeId)
    }

    /// All elements in use, by id.
    pub fn elements(&self) -> impl Iterator<Item = ElementId> + '_ {
        (0..self.sides.len() as u32).filter(|&e| self.sides[e as usize] != 0).map(ElementId)
    }

    /// One half-edge of every edge, by id: the one with the smaller id, or the only one.
    pub fn edges(&self) -> impl Iterator<Item = HalfEdgeId> + '_ {
        let slots = (0..4 * self.sides.len() as u32).map(HalfEdgeId);
        // Absence is the largest number, so this comparison also accepts sides without a twin.
        slots.filter(|h| h.corner() < u32::from(self.sides[h.element().index()]) && h.0 < self.twin[h.index()])
    }

    /// The half-edges of an element, anticlockwise.
    #[inline]
    pub fn half_edges(&self, e: ElementId) -> impl Iterator<Item = HalfEdgeId> + use<> {
        (0..u32::from(self.sides[e.index()])).map(move |corner| e.half_edge(corner))
    }

    /// The half-edges that leave a node, anticlockwise; for a boundary node from boundary to boundary.
    #[inline]
    pub fn fan(&self, node: NodeId) -> Fan<'_> {
        let start = HalfEdgeId(self.anchor[node.index()]);
        debug_assert_ne!(start.0, NONE, "{node:?} is a tombstone");
        Fan { mesh: self, start, next: Some(start) }
    }

    /// The elements around a node, in the order of its [`fan`](Mesh::fan).
    #[inline]
    pub fn elements_at(&self, node: NodeId) -> impl Iterator<Item = ElementId> + '_ {
        self.fan(node).map(HalfEdgeId::element)
    }

    /// The half-edges that leave a node in live triangles, anticlockwise.
    #[inline]
    pub fn live_fan(&self, node: NodeId) -> impl Iterator<Item = HalfEdgeId> + '_ {
        self.fan(node).filter(|h| self.is_triangle(h.element()))
    }

    /// The neighbours of a node along edges, anticlockwise; for a boundary node from boundary to boundary.
    #[inline]
    pub fn neighbours(&self, node: NodeId) -> impl Iterator<Item = NodeId> + '_ {
        let mut last = None;
        let mut fan = self.fan(node);
        let mut done = false;
        std::iter::from_fn(move || {
            if let Some(h) = fan.next() {
                last = Some(h);
                return Some(self.target(h));
            }
            if done {
                return None;
            }
            done = true;
            let back = self.previous(last?);
            self.twin(back).is_none().then(|| self.origin(back))
        })
    }

    /// Number of edges at a node.
    pub fn valence(&self, node: NodeId) -> usize {
        self.neighbours(node).count()
    }

    // ---- elements and half-edges ----

    /// Number of sides of an element: 3, 4, or 0 for a tombstone.
    #[inline]
    pub fn sides(&self, e: ElementId) -> usize {
        self.sides[e.index()] as usize
    }

    /// Whether the element is a triangle.
    #[inline]
    pub fn is_triangle(&self, e: ElementId) -> bool {
        self.sides[e.index()] == 3
    }

    /// Whether the element is a quadrilateral.
    #[inline]
    pub fn is_quad(&self, e: ElementId) -> bool {
        self.sides[e.index()] == 4
    }

    /// The region (face of the case) of an element.
    #[inline]
    pub fn region(&self, e: ElementId) -> u32 {
        self.region[e.index()]
    }

    /// The level of a quadrilateral: rows of the front from the boundary; 0 for a triangle.
    #[inline]
    pub fn level(&self, e: ElementId) -> u16 {
        self.level[e.index()]
    }

    /// Whether the front segment is deferred until something near it changes.
    #[inline]
    pub fn is_deferred(&self, h: HalfEdgeId) -> bool {
        self.deferred[h.index()]
    }

    /// The node where a half-edge starts.
    #[inline]
    pub fn origin(&self, h: HalfEdgeId) -> NodeId {
        NodeId(self.origin[h.index()])
    }

    /// The node where a half-edge ends.
    #[inline]
    pub fn target(&self, h: HalfEdgeId) -> NodeId {
        self.origin(self.next(h))
    }

    /// The nodes where a half-edge starts and ends.
    #[inline]
    pub fn ends(&self, h: HalfEdgeId) -> [NodeId; 2] {
        [self.origin(h), self.target(h)]
    }

    /// The node before a half-edge in its element: in a triangle the one opposite to it.
    #[inline]
    pub fn apex(&self, h: HalfEdgeId) -> NodeId {
        self.origin(self.previous(h))
    }

    /// The next half-edge of the same element.
    #[inline]
    pub fn next(&self, h: HalfEdgeId) -> HalfEdgeId {
        if h.corner() + 1 == u32::from(self.sides[h.element().index()]) {
            h.element().half_edge(0)
        } else {
            HalfEdgeId(h.0 + 1)
        }
    }

    /// The previous half-edge of the same element.
    #[inline]
    pub fn previous(&self, h: HalfEdgeId) -> HalfEdgeId {
        if h.corner() == 0 {
            h.element().half_edge(u32::from(self.sides[h.element().index()]) - 1)
        } else {
            HalfEdgeId(h.0 - 1)
        }
    }

    /// The half-edge of the same edge in the other element; `None` on a boundary.
    #[inline]
    pub fn twin(&self, h: HalfEdgeId) -> Option<HalfEdgeId> {
        let t = self.twin[h.index()];
        (t != NONE).then_some(HalfEdgeId(t))
    }

    /// The same edge seen from the live triangle beyond; none on the front.
    #[inline]
    pub fn live_twin(&self, h: HalfEdgeId) -> Option<HalfEdgeId> {
        self.twin(h).filter(|t| self.is_triangle(t.element()))
    }

    /// The nodes of an element, anticlockwise.
    #[inline]
    pub fn corners(&self, e: ElementId) -> impl Iterator<Item = NodeId> + '_ {
        self.half_edges(e).map(|h| self.origin(h))
    }

    /// The nodes of a triangle.
    #[inline]
    pub fn triangle(&self, e: ElementId) -> [NodeId; 3] {
        debug_assert!(self.is_triangle(e));
        let [a, b, c, _] = self.origin.as_chunks().0[e.index()];
        [a, b, c].map(NodeId)
    }

    /// The nodes of a quadrilateral.
    #[inline]
    pub fn quad(&self, e: ElementId) -> [NodeId; 4] {
        debug_assert!(self.is_quad(e));
        self.origin.as_chunks::<4>().0[e.index()].map(NodeId)
    }

    /// The nodes of a triangle, anticlockwise, from the one that a half-edge leaves.
    #[inline]
    pub fn triangle_from(&self, h: HalfEdgeId) -> [NodeId; 3] {
        let [a, b, c] = self.triangle(h.element());
        match h.corner() {
            0 => [a, b, c],
            1 => [b, c, a],
            _ => [c, a, b],
        }
    }

    /// The nodes of a quadrilateral, anticlockwise, from the one that a half-edge leaves.
    #[inline]
    pub fn quad_from(&self, h: HalfEdgeId) -> [NodeId; 4] {
        let (nodes, corner) = (self.quad(h.element()), h.corner() as usize);
        [0, 1, 2, 3].map(|i| nodes[(corner + i) % 4])
    }

    /// The half-edge from one node to another, if there is one.
    pub fn half_edge_between(&self, from: NodeId, to: NodeId) -> Option<HalfEdgeId> {
        self.fan(from).find(|&h| self.target(h) == to)
    }

    /// Whether an edge connects the two nodes.
    pub fn are_joined(&self, a: NodeId, b: NodeId) -> bool {
        self.neighbours(a).any(|n| n == b)
    }

    // ---- nodes ----

    /// Whether the slot contains a node (and not a tombstone).
    pub fn has_node(&self, node: NodeId) -> bool {
        self.anchor.get(node.index()).is_some_and(|&h| h != NONE)
    }

    /// Whether the slot contains an element (and not a tombstone).
    pub fn has_element(&self, e: ElementId) -> bool {
        self.sides.get(e.index()).is_some_and(|&s| s != 0)
    }

    /// Coordinates of a node in the parametric plane.
    #[inline]
    pub fn uv(&self, node: NodeId) -> DVec2 {
        self.places[node.index()].uv
    }

    /// Metric of a node (eq. 3).
    #[inline]
    pub fn metric(&self, node: NodeId) -> Metric2 {
        self.places[node.index()].metric
    }

    /// Metric of a node (eq. 3), by reference.
    #[inline]
    pub fn metric_ref(&self, node: NodeId) -> &Metric2 {
        &self.places[node.index()].metric
    }

    /// Coordinates of a node and its metric.
    #[inline]
    pub fn place(&self, node: NodeId) -> (DVec2, &Metric2) {
        let Place { uv, metric } = &self.places[node.index()];
        (*uv, metric)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::mesh::ids::PointId;
    use crate::core::mesh::journal::Mark;

    #[test]
    fn a_reordered_mesh_records_if_the_original_did() {
        let set = TriangleSet {
            uv: vec![DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y],
            point: (0..4).map(PointId).collect(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            region: vec![0; 2],
            ..TriangleSet::default()
        };
        for recording in [false, true] {
            let mut mesh = Mesh::from_triangles(&set, vec![Metric2::isotropic(1.0); 4]);
            mesh.set_recording(recording);
            let mut mesh = mesh.reordered();
            let inner = mesh.edges().find(|h| mesh.twin(*h).is_some()).unwrap();
            mesh.swap(inner);
            assert_eq!(mesh.journal().len_since(Mark::default()) > 0, recording);
        }
    }
}
