//! The mesh: triangles and quadrilaterals in one half-edge structure of plain arrays (spec 6).
//!
//! A half-edge is slot `4 * element + corner`; `next` and `previous` are arithmetic, only `origin` and `twin` are stored.
//! Every node has one fan of elements (pinched nodes come in copies that share a `PointId`), and the fan of a node on a
//! boundary is walked from its boundary half-edge, so that one turn anticlockwise sees all of it.
//!
//! All changes go through the private setters at the end, which write the old value into the journal. Public ways to
//! change are the operators only (`operators.rs`).

mod difference;

use glam::DVec2;

pub use self::difference::{Difference, FreeLists};

use super::ids::{ElementId, HalfEdgeId, NodeId, PointId};
use super::order::{grouped, hilbert_order};
use super::triangle_set::TriangleSet;
use crate::core::journal::{Entry, Journal, Mark};
use crate::core::metric::tensor::Metric2;

/// Absence in the arrays; outside of them absence is `Option`.
const NONE: u32 = u32::MAX;

/// Triangles and quadrilaterals with their nodes.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    uv: Vec<DVec2>,
    metric: Vec<Metric2>,
    /// Where the walk around a node starts; `NONE` for a tombstone.
    anchor: Vec<u32>,
    /// Output point of a node that may not move; `NONE` for a free one.
    point: Vec<u32>,
    origin: Vec<u32>,
    twin: Vec<u32>,
    /// 3, 4, or 0 for a tombstone.
    sides: Vec<u8>,
    region: Vec<u32>,
    /// Row of a quadrilateral, counted from the boundary (0 for a triangle).
    level: Vec<u16>,
    /// Whether the front segment in this slot is put off.
    deferred: Vec<bool>,
    free_nodes: Vec<NodeId>,
    free_elements: Vec<ElementId>,
    journal: Journal,
}

/// What stands in the slots of an element.
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    origin: [u32; 4],
    twin: [u32; 4],
    deferred: [bool; 4],
    sides: u8,
    region: u32,
    level: u16,
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

/// An element to be made: its nodes anticlockwise (three or four) and its region.
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

/// Walks the half-edges that leave a node, anticlockwise; see [`Mesh::fan`].
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
    /// The mesh of a set of triangles, with the metric of each node. Nodes on a boundary become fixed.
    ///
    /// # Panics
    /// Where the set breaks its promises (a side used twice in one direction, a node with two fans).
    pub fn from_triangles(set: &TriangleSet, metric: Vec<Metric2>) -> Self {
        assert_eq!(set.uv.len(), metric.len(), "one metric a node");
        assert!(set.triangles.len() < (NONE / 4) as usize, "half-edge ids are 32 bits");
        let elements = set.triangles.len();
        let mut mesh = Mesh {
            uv: set.uv.clone(),
            metric,
            anchor: vec![NONE; set.uv.len()],
            point: vec![NONE; set.uv.len()],
            origin: vec![NONE; 4 * elements],
            twin: vec![NONE; 4 * elements],
            sides: vec![3; elements],
            region: set.region.clone(),
            level: vec![0; elements],
            deferred: vec![false; 4 * elements],
            free_nodes: Vec::new(),
            free_elements: Vec::new(),
            journal: Journal::default(),
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
        mesh
    }

    // ---- counts and walks ----

    /// Number of node slots, tombstones included.
    pub fn node_slots(&self) -> usize {
        self.uv.len()
    }

    /// Number of element slots, tombstones included.
    pub fn element_slots(&self) -> usize {
        self.sides.len()
    }

    /// Number of nodes in use.
    pub fn node_count(&self) -> usize {
        self.uv.len() - self.free_nodes.len()
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

    /// One half-edge of every edge, by id: that of the smaller id, or the only one.
    pub fn edges(&self) -> impl Iterator<Item = HalfEdgeId> + '_ {
        let slots = (0..4 * self.sides.len() as u32).map(HalfEdgeId);
        // Absence is the largest number: one comparison takes sides without twin too.
        slots.filter(|h| h.corner() < u32::from(self.sides[h.element().index()]) && h.0 < self.twin[h.index()])
    }

    /// The half-edges of an element, anticlockwise.
    #[inline]
    pub fn half_edges(&self, e: ElementId) -> impl Iterator<Item = HalfEdgeId> + use<> {
        (0..u32::from(self.sides[e.index()])).map(move |corner| e.half_edge(corner))
    }

    /// The half-edges that leave a node, anticlockwise; of a node on a boundary all of them, from boundary to boundary.
    #[inline]
    pub fn fan(&self, node: NodeId) -> Fan<'_> {
        let start = HalfEdgeId(self.anchor[node.index()]);
        debug_assert_ne!(start.0, NONE, "{node:?} is a tombstone");
        Fan { mesh: self, start, next: Some(start) }
    }

    /// The neighbours of a node along edges, anticlockwise; of a node on a boundary from boundary to boundary.
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

    /// The level of a quadrilateral: its row, counted from the boundary; 0 for a triangle.
    #[inline]
    pub fn level(&self, e: ElementId) -> u16 {
        self.level[e.index()]
    }

    /// Whether the front segment is put off until something near it changes.
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

    /// The same edge seen from the other element; none on a boundary.
    #[inline]
    pub fn twin(&self, h: HalfEdgeId) -> Option<HalfEdgeId> {
        let t = self.twin[h.index()];
        (t != NONE).then_some(HalfEdgeId(t))
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
        let first = 4 * e.index();
        [NodeId(self.origin[first]), NodeId(self.origin[first + 1]), NodeId(self.origin[first + 2])]
    }

    /// The nodes of a quadrilateral.
    #[inline]
    pub fn quad(&self, e: ElementId) -> [NodeId; 4] {
        debug_assert!(self.is_quad(e));
        let first = 4 * e.index();
        [
            NodeId(self.origin[first]),
            NodeId(self.origin[first + 1]),
            NodeId(self.origin[first + 2]),
            NodeId(self.origin[first + 3]),
        ]
    }

    /// The half-edge from one node to another, where they are joined.
    pub fn half_edge_between(&self, from: NodeId, to: NodeId) -> Option<HalfEdgeId> {
        self.fan(from).find(|&h| self.target(h) == to)
    }

    /// Whether the two nodes are joined by an edge (seen from either side).
    pub fn are_joined(&self, a: NodeId, b: NodeId) -> bool {
        self.neighbours(a).any(|n| n == b)
    }

    // ---- nodes ----

    /// Whether the slot holds a node (and not a tombstone).
    pub fn has_node(&self, node: NodeId) -> bool {
        self.anchor.get(node.index()).is_some_and(|&h| h != NONE)
    }

    /// Whether the slot holds an element (and not a tombstone).
    pub fn has_element(&self, e: ElementId) -> bool {
        self.sides.get(e.index()).is_some_and(|&s| s != 0)
    }

    /// Coordinates of a node in the parametric plane.
    #[inline]
    pub fn uv(&self, node: NodeId) -> DVec2 {
        self.uv[node.index()]
    }

    /// Metric of a node (eq. 3).
    #[inline]
    pub fn metric(&self, node: NodeId) -> Metric2 {
        self.metric[node.index()]
    }

    /// Metric of a node (eq. 3), in place.
    #[inline]
    pub fn metric_ref(&self, node: NodeId) -> &Metric2 {
        &self.metric[node.index()]
    }

    /// Whether the node lies on a boundary: it may not move or go.
    #[inline]
    pub fn is_fixed(&self, node: NodeId) -> bool {
        self.point[node.index()] != NONE
    }

    /// The output point of a node on a boundary.
    #[inline]
    pub fn point(&self, node: NodeId) -> Option<PointId> {
        let p = self.point[node.index()];
        (p != NONE).then_some(PointId(p))
    }

    // ---- order ----

    /// The same mesh without tombstones, its nodes and elements along a Hilbert curve: neighbours in the plane become
    /// neighbours in memory, which is most of the speed of large meshes. The journal starts empty, and records where this
    /// mesh's does.
    #[must_use]
    pub fn reordered(&self) -> Mesh {
        let nodes = hilbert_order(&self.nodes().map(|n| (n.0, self.uv(n))).collect::<Vec<_>>());
        let mut new_node = vec![NONE; self.uv.len()];
        for (new, &old) in nodes.iter().enumerate() {
            new_node[old as usize] = new as u32;
        }
        // Elements follow their first node.
        let first_node = |e: ElementId| self.corners(e).map(|n| new_node[n.index()]).min().unwrap_or(NONE);
        let elements: Vec<(u32, u32)> = self.elements().map(|e| (first_node(e), e.0)).collect();
        let elements: Vec<u32> = grouped(nodes.len(), &elements, |e| e.0).into_iter().map(|(_, old)| old).collect();
        let mut new_element = vec![NONE; self.sides.len()];
        for (new, &old) in elements.iter().enumerate() {
            new_element[old as usize] = new as u32;
        }
        let half_edge = |h: u32| if h == NONE { NONE } else { new_element[(h >> 2) as usize] << 2 | (h & 3) };
        let slots = 4 * elements.len();
        let (mut origin, mut twin) = (Vec::with_capacity(slots), Vec::with_capacity(slots));
        let mut deferred = Vec::with_capacity(slots);
        for &old in &elements {
            let first = 4 * old as usize;
            let sides = self.sides[old as usize] as usize;
            for slot in first..first + 4 {
                let used = slot < first + sides;
                origin.push(if used { new_node[self.origin[slot] as usize] } else { NONE });
                twin.push(if used { half_edge(self.twin[slot]) } else { NONE });
            }
            deferred.extend_from_slice(&self.deferred[first..first + 4]);
        }
        let mut journal = Journal::default();
        journal.set_recording(self.journal.is_recording());
        Mesh {
            uv: nodes.iter().map(|&n| self.uv[n as usize]).collect(),
            metric: nodes.iter().map(|&n| self.metric[n as usize]).collect(),
            anchor: nodes.iter().map(|&n| half_edge(self.anchor[n as usize])).collect(),
            point: nodes.iter().map(|&n| self.point[n as usize]).collect(),
            origin,
            twin,
            sides: elements.iter().map(|&e| self.sides[e as usize]).collect(),
            region: elements.iter().map(|&e| self.region[e as usize]).collect(),
            level: elements.iter().map(|&e| self.level[e as usize]).collect(),
            deferred,
            journal,
            ..Mesh::default()
        }
    }

    /// A copy for looking at: without the journal, which may be many times as large.
    #[must_use]
    pub fn without_journal(&self) -> Mesh {
        Mesh {
            uv: self.uv.clone(),
            metric: self.metric.clone(),
            anchor: self.anchor.clone(),
            point: self.point.clone(),
            origin: self.origin.clone(),
            twin: self.twin.clone(),
            sides: self.sides.clone(),
            region: self.region.clone(),
            level: self.level.clone(),
            deferred: self.deferred.clone(),
            free_nodes: self.free_nodes.clone(),
            free_elements: self.free_elements.clone(),
            journal: Journal::default(),
        }
    }

    // ---- journal ----

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

    fn append_node(&mut self, (uv, metric, anchor, point): (DVec2, Metric2, u32, u32)) {
        self.uv.push(uv);
        self.metric.push(metric);
        self.anchor.push(anchor);
        self.point.push(point);
        self.journal.note(Entry::NodeAppended);
    }

    fn append_element(&mut self, element: &Element) {
        self.origin.extend(element.origin);
        self.twin.extend(element.twin);
        self.deferred.extend(element.deferred);
        self.sides.push(element.sides);
        self.region.push(element.region);
        self.level.push(element.level);
        self.journal.note(Entry::ElementAppended);
    }

    /// Appends the canonical serialisation of the state: every array and both free lists, little-endian. Two meshes are
    /// the same state exactly where these bytes are equal. (The journal is history, not state.)
    pub fn write_state(&self, bytes: &mut Vec<u8>) {
        let mut number = |n: u64| bytes.extend_from_slice(&n.to_le_bytes());
        number(self.uv.len() as u64);
        number(self.sides.len() as u64);
        number(self.free_nodes.len() as u64);
        number(self.free_elements.len() as u64);
        for n in 0..self.uv.len() {
            number(self.uv[n].x.to_bits());
            number(self.uv[n].y.to_bits());
            number(self.metric[n].uu.to_bits());
            number(self.metric[n].uv.to_bits());
            number(self.metric[n].vv.to_bits());
            number(u64::from(self.anchor[n]) << 32 | u64::from(self.point[n]));
        }
        for h in 0..self.origin.len() {
            number(u64::from(self.origin[h]) << 32 | u64::from(self.twin[h]));
        }
        for e in 0..self.sides.len() {
            let deferred = (0..4).map(|k| u64::from(self.deferred[4 * e + k]) << k).sum::<u64>();
            number(
                u64::from(self.region[e]) << 28
                    | u64::from(self.level[e]) << 12
                    | deferred << 8
                    | u64::from(self.sides[e]),
            );
        }
        self.free_nodes.iter().for_each(|n| number(u64::from(n.0)));
        self.free_elements.iter().for_each(|e| number(u64::from(e.0)));
    }

    // ---- the setters: every change passes here and is written down ----

    #[inline]
    pub(super) fn set_origin(&mut self, h: HalfEdgeId, node: NodeId) {
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
    pub(super) fn hook(&mut self, h: HalfEdgeId, twin: Option<HalfEdgeId>) {
        self.set_twin(h, twin);
        match twin {
            Some(t) => self.set_twin(t, Some(h)),
            None => self.set_anchor(self.origin(h), h),
        }
    }

    #[inline]
    pub(super) fn set_sides(&mut self, e: ElementId, sides: u8) {
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
    pub(super) fn reanchor(&mut self, h: HalfEdgeId) {
        let node = self.origin(h);
        if !self.is_fixed(node) {
            self.set_anchor(node, h);
        }
    }

    /// Moves a node and gives it the metric of its new place.
    #[inline]
    pub(super) fn set_place(&mut self, node: NodeId, uv: DVec2, metric: Metric2) {
        let old = std::mem::replace(&mut self.uv[node.index()], uv);
        self.journal.note(Entry::Uv(node, old));
        let old = std::mem::replace(&mut self.metric[node.index()], metric);
        self.journal.note(Entry::Metric(node, old));
    }

    /// Makes a free node that no element uses yet.
    pub(super) fn new_node(&mut self, uv: DVec2, metric: Metric2) -> NodeId {
        if let Some(node) = self.free_nodes.pop() {
            self.journal.note(Entry::NodeTaken(node));
            self.set_place(node, uv, metric);
            return node;
        }
        self.append_node((uv, metric, NONE, NONE));
        NodeId(self.uv.len() as u32 - 1)
    }

    /// Makes a tombstone of a free node that no element uses any more.
    pub(super) fn free_node(&mut self, node: NodeId) {
        debug_assert!(!self.is_fixed(node));
        let old = std::mem::replace(&mut self.anchor[node.index()], NONE);
        self.journal.note(Entry::Anchor(node, old));
        self.free_nodes.push(node);
        self.journal.note(Entry::NodeFreed);
    }

    /// Makes an element without nodes or twins yet.
    pub(super) fn new_element(&mut self, sides: u8, region: u32) -> ElementId {
        if let Some(e) = self.free_elements.pop() {
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
    pub(super) fn free_element(&mut self, e: ElementId) {
        self.set_sides(e, 0);
        self.free_elements.push(e);
        self.journal.note(Entry::ElementFreed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_put_in_order_records_where_it_did_before() {
        let set = TriangleSet {
            uv: vec![DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y],
            point: (0..4).map(PointId).collect(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            region: vec![0; 2],
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
