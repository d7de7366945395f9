//! Cavities: discs of quadrilaterals that grow around an irregular node, by topology alone, until they are polygons.
//!
//! A node of the border wants k quadrilaterals of the cavity: those that fit it, less those that lie outside. Where k
//! is 1 the polygon has a corner, where it is 2 a side passes; elsewhere what lies outside is added. So the nodes of
//! the border become regular too, whatever they are today.

use std::hash::Hasher;

use rustc_hash::FxHasher;
use smallvec::SmallVec;

use super::filling::{MOST_CORNERS, Sides};
use crate::core::convert::finish::clean_up::candidate::Valences;
use crate::core::convert::finish::clean_up::seen::Seen;
use crate::core::convert::relax::energy::{self, Judged};
use crate::core::mesh::{ElementId, HalfEdgeId, Mesh, NodeId};

/// The border of a cavity as a polygon.
#[derive(Clone, Debug, Default)]
pub(super) struct Polygon {
    /// The nodes of the border, anticlockwise from the first corner.
    pub border: Vec<NodeId>,
    /// The number of edges of each side.
    pub sides: Sides,
    /// How many nodes of the border stay irregular, whatever the filling: reentrant corners of the domain.
    pub misfits: usize,
    /// Irregular nodes inside and on the border today.
    pub irregular: usize,
    /// Those of them that lie on the border.
    pub on_border: usize,
}

/// What a cavity has become.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Growth {
    /// A polygon that may have a filling.
    Polygon,
    /// A disc with too few corners or too many.
    NoPolygon,
    /// It has outgrown the limit, or encloses a part of the boundary.
    Stuck,
}

/// A growing cavity.
#[derive(Clone, Debug, Default)]
pub(super) struct Disc {
    /// Its quadrilaterals.
    pub elements: Vec<ElementId>,
    /// The nodes inside, when it is a polygon.
    pub inner: Vec<NodeId>,
    /// Its border, when it is a polygon.
    pub polygon: Polygon,
    /// Its elements and their nodes.
    has: Seen,
    nodes: Seen,
    /// How many of the nodes are irregular.
    irregular: usize,
    /// The half-edges of the border, with how many elements were looked at for them.
    border: Vec<HalfEdgeId>,
    looked: usize,
    /// Nodes seen on the way.
    seen: Seen,
    /// For each node of the border its excess, and the quadrilaterals that it wants.
    wanted: Vec<(i32, i32)>,
    /// Nodes outside, in the order of their distance, each with the place of the one before it.
    outside: Vec<(NodeId, u32)>,
}

/// The end of a path in [`Disc::outside`].
const NONE: u32 = u32::MAX;

impl Disc {
    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        4 * (self.elements.capacity() + self.inner.capacity() + self.polygon.border.capacity())
            + self.has.bytes()
            + self.nodes.bytes()
            + self.seen.bytes()
            + 4 * self.border.capacity()
            + 8 * (self.wanted.capacity() + self.outside.capacity())
    }

    /// Begins with the elements around a node.
    pub fn begin(&mut self, mesh: &Mesh, valences: &Valences, node: NodeId) {
        self.clear(mesh);
        self.add_around(mesh, valences, node);
    }

    /// Begins with all elements of a face, or all.
    pub fn begin_whole(&mut self, mesh: &Mesh, valences: &Valences, face: Option<u32>) {
        self.clear(mesh);
        mesh.elements_of(face).for_each(|e| self.add(mesh, valences, e));
    }

    fn clear(&mut self, mesh: &Mesh) {
        self.elements.clear();
        self.has.clear(mesh.element_slots());
        self.nodes.clear(mesh.node_slots());
        self.irregular = 0;
        self.border.clear();
        self.looked = 0;
    }

    /// The metric area of its elements: the number of unit squares that fit.
    pub fn metric_area(&self, mesh: &Mesh) -> f64 {
        self.elements.iter().map(|&e| mesh.metric_area(e)).sum()
    }

    /// Judges its elements.
    pub fn judge(&self, mesh: &Mesh) -> Judged {
        let mut judged = Judged::NOTHING;
        self.elements.iter().for_each(|&e| judged += energy::judge(mesh, e));
        judged
    }

    /// A fingerprint of its elements with their nodes and places, whatever their order.
    pub fn fingerprint(&self, mesh: &Mesh) -> u64 {
        let of = |&e: &ElementId| {
            let mut hasher = FxHasher::default();
            for node in mesh.quad(e) {
                let place = mesh.uv(node);
                hasher.write_u32(node.0);
                hasher.write_u64(place.x.to_bits());
                hasher.write_u64(place.y.to_bits());
            }
            hasher.finish()
        };
        self.elements.iter().map(of).fold(0, u64::wrapping_add)
    }

    fn add(&mut self, mesh: &Mesh, valences: &Valences, e: ElementId) {
        if self.has.add(e.index()) {
            self.elements.push(e);
            for node in mesh.quad(e) {
                if self.nodes.add(node.index()) {
                    self.irregular += usize::from(valences.excess(mesh, node) != 0);
                }
            }
        }
    }

    fn add_around(&mut self, mesh: &Mesh, valences: &Valences, node: NodeId) {
        for h in mesh.fan(node) {
            self.add(mesh, valences, h.element());
        }
    }

    #[inline]
    fn is_border(&self, mesh: &Mesh, h: HalfEdgeId) -> bool {
        mesh.twin(h).is_none_or(|t| !self.has.has(t.element().index()))
    }

    /// The half-edge of the border after one.
    fn after(&self, mesh: &Mesh, h: HalfEdgeId) -> HalfEdgeId {
        let mut next = mesh.next(h);
        while let Some(t) = mesh.twin(next).filter(|t| self.has.has(t.element().index())) {
            next = mesh.next(t);
        }
        next
    }

    /// Adds quadrilaterals until the cavity is a disc of at most `limit` with a border of corners and sides.
    pub fn become_polygon(&mut self, mesh: &Mesh, valences: &Valences, limit: usize) -> Growth {
        loop {
            let count = self.elements.len();
            if count > limit {
                return Growth::Stuck;
            }
            let mut border = std::mem::take(&mut self.border);
            border.retain(|&h| self.is_border(mesh, h));
            for &e in &self.elements[self.looked..] {
                border.extend(mesh.half_edges(e).filter(|&h| self.is_border(mesh, h)));
            }
            (self.border, self.looked) = (border, count);
            let Some(&first) = self.border.first() else { return Growth::Stuck };
            if !self.walk(mesh, valences, first) {
                // What lies around the place where the border touches itself has been added.
            } else if self.polygon.border.len() < self.border.len() {
                if !self.fill_holes(mesh, valences, limit) {
                    return Growth::Stuck;
                }
            } else if self.fit(mesh, valences) {
                return self.name_sides();
            }
            if self.elements.len() == count {
                // The border touches itself at a boundary of the domain.
                return Growth::Stuck;
            }
        }
    }

    /// Walks along the border; where it touches itself, adds what lies around the place and returns false.
    fn walk(&mut self, mesh: &Mesh, valences: &Valences, first: HalfEdgeId) -> bool {
        self.polygon.border.clear();
        self.seen.clear(mesh.node_slots());
        let mut h = first;
        loop {
            let node = mesh.origin(h);
            if !self.seen.add(node.index()) {
                self.add_around(mesh, valences, node);
                return false;
            }
            self.polygon.border.push(node);
            h = self.after(mesh, h);
            if h == first {
                return true;
            }
        }
    }

    /// Whether every node of the border is a side or a corner; adds what lies outside at those that are not.
    fn fit(&mut self, mesh: &Mesh, valences: &Valences) -> bool {
        let count = self.elements.len();
        let mut wanted = std::mem::take(&mut self.wanted);
        wanted.clear();
        for k in 0..self.polygon.border.len() {
            let node = self.polygon.border[k];
            // Counted before anything is added at a node before it: it is looked at again in the next round.
            let (mut inside, mut all) = (0, 0);
            for h in mesh.fan(node) {
                all += 1;
                inside += usize::from(self.has.has(h.element().index()));
            }
            let excess = valences.excess_of(node, all);
            let wants = inside as i32 - excess;
            wanted.push((excess, wants));
            if !(1..=2).contains(&wants) && all > inside {
                self.add_around(mesh, valences, node);
            }
        }
        self.wanted = wanted;
        self.elements.len() == count
    }

    /// Adds what lies outside and is enclosed; false where that has a boundary of the domain.
    fn fill_holes(&mut self, mesh: &Mesh, valences: &Valences, limit: usize) -> bool {
        let mut loops: SmallVec<[(usize, HalfEdgeId); 4]> = SmallVec::new();
        self.seen.clear(mesh.node_slots());
        for &first in &self.border {
            let (mut h, mut length) = (first, 0);
            while self.seen.add(mesh.origin(h).index()) {
                length += 1;
                h = self.after(mesh, h);
            }
            if length > 0 {
                loops.push((length, first));
            }
        }
        // The longest is taken for the outer one. Where it is not, the flood below meets the limit or a boundary.
        let Some(outer) = (0..loops.len()).max_by_key(|&k| loops[k].0) else { return false };
        for (k, &(_, first)) in loops.iter().enumerate() {
            if k == outer {
                continue;
            }
            let Some(t) = mesh.twin(first) else { return false };
            let mut at = self.elements.len();
            self.add(mesh, valences, t.element());
            while at < self.elements.len() {
                for h in mesh.half_edges(self.elements[at]) {
                    let Some(t) = mesh.twin(h) else { return false };
                    self.add(mesh, valences, t.element());
                }
                at += 1;
                if self.elements.len() > limit {
                    return false;
                }
            }
        }
        true
    }

    /// Says where the corners are, and how many nodes are irregular.
    fn name_sides(&mut self) -> Growth {
        let Polygon { border, sides, misfits, irregular, on_border } = &mut self.polygon;
        sides.clear();
        *misfits = self.wanted.iter().filter(|(_, wants)| !(1..=2).contains(wants)).count();
        *on_border = self.wanted.iter().filter(|(excess, _)| *excess != 0).count();
        *irregular = self.irregular;
        let is_corner = |&k: &usize| self.wanted[k].1 <= 1;
        let corners: SmallVec<[usize; MOST_CORNERS]> =
            (0..border.len()).filter(is_corner).take(MOST_CORNERS + 1).collect();
        if corners.len() == 1 || corners.len() > MOST_CORNERS {
            return Growth::NoPolygon;
        }
        for (i, &corner) in corners.iter().enumerate() {
            let next = corners.get(i + 1).copied().unwrap_or(corners[0] + border.len());
            sides.push((next - corner) as u32);
        }
        if let Some(&first) = corners.first() {
            border.rotate_left(first);
        } else {
            sides.push(border.len() as u32);
        }
        if border.len().is_multiple_of(2) { Growth::Polygon } else { Growth::NoPolygon }
    }

    /// Gathers the nodes inside a polygon. False where it is no disc, or a node inside is fixed and must stay.
    pub fn gather_inner(&mut self, mesh: &Mesh) -> bool {
        // The border is what was seen last.
        self.inner.clear();
        for &e in &self.elements {
            self.inner.extend(mesh.quad(e).into_iter().filter(|node| self.seen.add(node.index())));
        }
        // Euler's formula for a disc of quadrilaterals.
        let is_disc = self.elements.len() + 1 == self.inner.len() + self.polygon.border.len() / 2;
        is_disc && !self.inner.iter().any(|&n| mesh.is_fixed(n))
    }

    /// Adds the elements around the nodes of a shortest path to an irregular node outside, and around that; false where
    /// there is none among the `most` nearest nodes.
    pub fn grow(&mut self, mesh: &Mesh, valences: &Valences, most: usize) -> bool {
        self.seen.clear(mesh.node_slots());
        self.outside.clear();
        self.outside.extend(self.polygon.border.iter().map(|&node| (node, NONE)));
        let mut at = 0;
        while at < self.outside.len() && self.outside.len() <= most {
            for n in mesh.neighbours(self.outside[at].0) {
                if self.nodes.has(n.index()) || !self.seen.add(n.index()) {
                    continue;
                }
                self.outside.push((n, at as u32));
                if valences.excess(mesh, n) != 0 {
                    let mut back = self.outside.len() as u32 - 1;
                    while back != NONE {
                        let (node, before) = self.outside[back as usize];
                        self.add_around(mesh, valences, node);
                        back = before;
                    }
                    return true;
                }
            }
            at += 1;
        }
        false
    }
}
