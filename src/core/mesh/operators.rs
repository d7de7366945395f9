//! The elementary operations (paper 4.2, figs. 5-8) and the general replacement on which others are built.
//!
//! Judge, then change: `can_…` decides by exact predicates whether an operation keeps the mesh valid, without changing
//! it; the operation itself does not check the geometry and records what it replaces in the journal. Boundary edges are
//! never changed and fixed nodes never move.

use glam::DVec2;
use smallvec::SmallVec;

use super::half_edge::{Mesh, NewElement};
use super::ids::{ElementId, HalfEdgeId, NodeId};
use super::refusals::{Operation, Refusal};
use crate::core::kernel::Metric2;
use crate::core::kernel::predicates::{convex, firm};

impl Mesh {
    // ---- edge swapping (paper 4.2.1, fig. 5) ----

    /// Whether a [`swap`](Mesh::swap) of the edge gives two positive triangles (exactly, and neither a needle).
    ///
    /// # Errors
    /// The reason of the refusal.
    pub fn can_swap(&self, h_ab: HalfEdgeId) -> Result<(), Refusal> {
        let nodes = self.around_edge(h_ab)?;
        let [a, b, c, d] = nodes.map(|n| self.uv(n));
        if firm(a, d, c) && firm(d, b, c) { self.permit(Operation::Swap, &nodes) } else { Err(Refusal::NotPositive) }
    }

    /// The ends of an edge between two triangles and the nodes opposite to it, left and right: a, b, c, d.
    fn around_edge(&self, h_ab: HalfEdgeId) -> Result<[NodeId; 4], Refusal> {
        let h_ba = self.twin(h_ab).ok_or(Refusal::OnBoundary)?;
        Refusal::NotTriangles.when(!self.is_triangle(h_ab.element()) || !self.is_triangle(h_ba.element()))?;
        Ok([h_ab, h_ba, self.previous(h_ab), self.previous(h_ba)].map(|h| self.origin(h)))
    }

    /// Replaces the common edge of two triangles by the edge between the opposite nodes.
    ///
    /// ```text
    ///          c                     c
    ///        /   \                 / | \
    ///       /  T  \               /  |  \
    ///      a-------b     =>      a T | U b
    ///       \  U  /               \  |  /
    ///        \   /                 \ | /
    ///          d                     d
    /// ```
    /// T keeps a, U keeps b; returns `h_dc`, which lies in T. [`can_swap`](Mesh::can_swap) must hold.
    pub fn swap(&mut self, h_ab: HalfEdgeId) -> HalfEdgeId {
        // Gather.
        let h_ba = self.twin(h_ab).expect("an edge that can be swapped has two sides");
        let (t, u) = (h_ab.element(), h_ba.element());
        let (h_bc, h_ca) = (self.next(h_ab), self.previous(h_ab));
        let (h_ad, h_db) = (self.next(h_ba), self.previous(h_ba));
        let (a, b, c, d) = (self.origin(h_ab), self.origin(h_ba), self.origin(h_ca), self.origin(h_db));
        let (t_bc, t_ca, t_ad, t_db) = (self.twin(h_bc), self.twin(h_ca), self.twin(h_ad), self.twin(h_db));
        // Build: T = (a, d, c), U = (b, c, d).
        self.set_corners(t, [a, d, c]);
        self.set_corners(u, [b, c, d]);
        // Hook up.
        let h_dc = t.half_edge(1);
        self.hook(t.half_edge(0), t_ad);
        self.hook(h_dc, Some(u.half_edge(1)));
        self.hook(t.half_edge(2), t_ca);
        self.hook(u.half_edge(0), t_bc);
        self.hook(u.half_edge(2), t_db);
        [t.half_edge(0), u.half_edge(0), h_dc, u.half_edge(1)].into_iter().for_each(|h| self.reanchor(h));
        h_dc
    }

    // ---- edge collapsing (paper 4.2.2, fig. 6) ----

    /// Whether the [`collapse`](Mesh::collapse) of a into b at the position `at` keeps the mesh valid.
    ///
    /// # Errors
    /// The reason of the refusal.
    pub fn can_collapse(&self, h_ab: HalfEdgeId, at: DVec2) -> Result<(), Refusal> {
        let [a, b] = self.ends(h_ab);
        let h_ba = self.twin(h_ab).ok_or(Refusal::OnBoundary)?;
        let (t, u) = (h_ab.element(), h_ba.element());
        Refusal::FixedNode.when(self.is_fixed(a) || (self.is_fixed(b) && at != self.uv(b)))?;
        Refusal::NotTriangles.when(!self.is_triangle(t) || !self.is_triangle(u))?;
        let (c, d) = (self.apex(h_ab), self.apex(h_ba));
        let around_b: SmallVec<[NodeId; 12]> = self.neighbours(b).collect();
        Refusal::Link.when(self.neighbours(a).any(|n| n != c && n != d && around_b.contains(&n)))?;
        let b_moves = at != self.uv(b);
        for (node, moves) in [(a, true), (b, b_moves)] {
            for h in self.fan(node) {
                let e = h.element();
                if e == t || e == u {
                    continue;
                }
                Refusal::Link.when(node == a && self.corners(e).any(|n| n == b))?;
                Refusal::NotPositive.when(moves && !self.stays_positive(e, node, at))?;
            }
        }
        self.permit(Operation::Collapse, &[a, b])
    }

    /// Merges node a into node b at the position `at` and removes the two triangles at the edge.
    ///
    /// ```text
    ///     \     c     /          \   c   /
    ///      \  / | \  /            \  |  /
    ///       a---|--->b     =>      \ | /
    ///      /  \ | /  \          ---- b ----
    ///     /     d     \            / | \
    ///                             /  d  \
    /// ```
    /// [`can_collapse`](Mesh::can_collapse) must hold. The ids of a, T and U become tombstones; `metric` is that of
    /// `at`.
    pub fn collapse(&mut self, h_ab: HalfEdgeId, at: DVec2, metric: Metric2) {
        // Gather.
        let h_ba = self.twin(h_ab).expect("an edge that can be collapsed has two sides");
        let (a, b) = (self.origin(h_ab), self.origin(h_ba));
        let around_a: SmallVec<[HalfEdgeId; 12]> = self.fan(a).collect();
        let pairs = [(self.next(h_ab), self.previous(h_ab)), (self.previous(h_ba), self.next(h_ba))];
        // Build: everything that started at a starts at b.
        for &h in &around_a {
            self.set_origin(h, b);
        }
        // Hook up: the outer sides of T and U become each other's twins.
        for (b_side, a_side) in pairs {
            let (x, y) = (self.twin(b_side), self.twin(a_side));
            match (x, y) {
                (Some(x), y) => self.hook(x, y),
                (None, Some(y)) => self.hook(y, None),
                (None, None) => unreachable!("the link condition keeps a triangle with two boundary sides at a"),
            }
            for h in [x, y].into_iter().flatten() {
                self.reanchor(h);
                let next = self.next(h);
                self.reanchor(next);
            }
        }
        self.free_element(h_ab.element());
        self.free_element(h_ba.element());
        self.free_node(a);
        // Recorded even if b does not move: a neighbour of all nodes that were connected to a has moved.
        self.set_place(b, at, if at == self.uv(b) { self.metric(b) } else { metric });
    }

    // ---- edge division (paper 4.2.3, fig. 7) ----

    /// Whether [`divide`](Mesh::divide) of the edge at `uv` gives four positive triangles.
    ///
    /// # Errors
    /// The reason of the refusal.
    pub fn can_divide(&self, h_ab: HalfEdgeId, uv: DVec2) -> Result<(), Refusal> {
        let nodes = self.around_edge(h_ab)?;
        let [a, b, c, d] = nodes.map(|n| self.uv(n));
        let positive = firm(a, uv, c) && firm(uv, b, c) && firm(b, uv, d) && firm(uv, a, d);
        if positive { self.permit(Operation::Divide, &nodes) } else { Err(Refusal::NotPositive) }
    }

    /// Divides an inner edge at `uv`, which must lie strictly inside the union of its two triangles.
    ///
    /// ```text
    ///          c                     c
    ///        /   \                 / | \
    ///       /  T  \               / T|T'\
    ///      a-------b     =>      a---m---b
    ///       \  U  /               \ U|U'/
    ///        \   /                 \ | /
    ///          d                     d
    /// ```
    /// T and U keep a; returns m. The edges a-m, m-b, c-m and m-d leave m or end there.
    ///
    /// # Errors
    /// As [`can_divide`](Mesh::can_divide).
    pub fn divide(&mut self, h_ab: HalfEdgeId, uv: DVec2, metric: Metric2) -> Result<NodeId, Refusal> {
        self.can_divide(h_ab, uv)?;
        // Gather.
        let h_ba = self.twin(h_ab).ok_or(Refusal::OnBoundary)?;
        let (t, u) = (h_ab.element(), h_ba.element());
        let (h_bc, h_ca) = (self.next(h_ab), self.previous(h_ab));
        let (h_ad, h_db) = (self.next(h_ba), self.previous(h_ba));
        let (a, b, c, d) = (self.origin(h_ab), self.origin(h_ba), self.origin(h_ca), self.origin(h_db));
        let (t_bc, t_ca, t_ad, t_db) = (self.twin(h_bc), self.twin(h_ca), self.twin(h_ad), self.twin(h_db));
        // Build: T = (a, m, c), T' = (m, b, c), U = (m, a, d), U' = (b, m, d).
        let m = self.new_node(uv, metric);
        let t_new = self.new_element(3, self.region(t));
        let u_new = self.new_element(3, self.region(u));
        for (e, nodes) in [(t, [a, m, c]), (t_new, [m, b, c]), (u, [m, a, d]), (u_new, [b, m, d])] {
            self.set_corners(e, nodes);
        }
        // Hook up.
        self.hook(t.half_edge(0), Some(u.half_edge(0)));
        self.hook(t.half_edge(1), Some(t_new.half_edge(2)));
        self.hook(t.half_edge(2), t_ca);
        self.hook(t_new.half_edge(0), Some(u_new.half_edge(0)));
        self.hook(t_new.half_edge(1), t_bc);
        self.hook(u.half_edge(1), t_ad);
        self.hook(u.half_edge(2), Some(u_new.half_edge(1)));
        self.hook(u_new.half_edge(2), t_db);
        for h in [u.half_edge(0), t.half_edge(0), u_new.half_edge(0), t.half_edge(2), u.half_edge(2)] {
            self.reanchor(h);
        }
        Ok(m)
    }

    // ---- node deletion (paper 4.2.4, fig. 8) ----

    /// The elements that [`delete_node`](Mesh::delete_node) would insert: one triangle, or two with the diagonal that
    /// is shorter in the metric of the node, or else with the other one.
    ///
    /// # Errors
    /// Refused unless the node is free, has exactly three or four triangles around it, and the new triangles are
    /// positive.
    pub fn can_delete_node(&self, node: NodeId) -> Result<SmallVec<[NewElement; 2]>, Refusal> {
        Refusal::FixedNode.when(self.is_fixed(node))?;
        // Nearly all nodes are refused here.
        let mut around = [HalfEdgeId(0); 4];
        let mut valence = 0;
        for h in self.fan(node) {
            *around.get_mut(valence).ok_or(Refusal::Valence)? = h;
            valence += 1;
        }
        let spokes = &around[..valence];
        Refusal::Valence.when(valence < 3)?;
        Refusal::NotTriangles.when(spokes.iter().any(|h| !self.is_triangle(h.element())))?;
        self.permit(Operation::DeleteNode, &[node])?;
        let region = self.region(spokes[0].element());
        let ring: SmallVec<[NodeId; 4]> = spokes.iter().map(|&h| self.target(h)).collect();
        let is_firm = |n: [NodeId; 3]| firm(self.uv(n[0]), self.uv(n[1]), self.uv(n[2]));
        if let [a, b, c] = ring[..] {
            let whole = [a, b, c];
            Refusal::NotPositive.when(!is_firm(whole))?;
            return Ok(SmallVec::from_iter([NewElement::triangle(whole, region)]));
        }
        let length2 = |i: usize, k: usize| self.metric(node).norm2(self.uv(ring[k]) - self.uv(ring[i]));
        let first = if length2(0, 2) <= length2(1, 3) { 0 } else { 1 };
        for start in [first, 1 - first] {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| ring[(start + k) % 4]);
            if is_firm([a, b, c]) && is_firm([a, c, d]) {
                if self.are_joined(a, c) {
                    continue;
                }
                return Ok(SmallVec::from_iter([[a, b, c], [a, c, d]].map(|n| NewElement::triangle(n, region))));
            }
        }
        Err(Refusal::NotPositive)
    }

    /// Removes a free node that has three or four triangles around it (fig. 8).
    ///
    /// ```text
    ///        c                c             d---c            d---c
    ///       /|\              / \            |\ /|            |  /|
    ///      / x \     =>     /   \           | x |     =>     | / |
    ///     / / \ \          /     \          |/ \|            |/  |
    ///    a-------b        a-------b         a---b            a---b
    /// ```
    /// Returns the new elements.
    ///
    /// # Errors
    /// As [`can_delete_node`](Mesh::can_delete_node).
    pub fn delete_node(&mut self, node: NodeId) -> Result<SmallVec<[ElementId; 2]>, Refusal> {
        let new = self.can_delete_node(node)?;
        let old: SmallVec<[ElementId; 4]> = self.elements_at(node).collect();
        let made = self.replace(&old, &new);
        self.free_node(node);
        Ok(SmallVec::from_slice(&made))
    }

    // ---- the general replacement ----

    /// Replaces elements by others that cover the same part of the plane.
    ///
    /// Every outer side of the old elements must be a side of exactly one new element; inner sides of the new elements
    /// become twins. The ids of the old elements are reused in the order of the free list. The caller must release
    /// nodes without elements by [`release_node`](Mesh::release_node). Returns the new elements in their order.
    ///
    /// # Panics
    /// If the new elements do not fill the hole of the old ones: a bug of the caller.
    pub fn replace(&mut self, old: &[ElementId], new: &[NewElement]) -> SmallVec<[ElementId; 8]> {
        type Side = (NodeId, NodeId, Option<HalfEdgeId>);
        let mut sorted: SmallVec<[ElementId; 16]> = SmallVec::from_slice(old);
        sorted.sort_unstable();
        // Gather the outer sides with their twins.
        let mut outer: SmallVec<[Side; 32]> = SmallVec::new();
        for &e in old {
            for h in self.half_edges(e) {
                let t = self.twin(h);
                if t.is_none_or(|t| sorted.binary_search(&t.element()).is_err()) {
                    outer.push((self.origin(h), self.target(h), t));
                }
            }
        }
        outer.sort_unstable_by_key(|&(a, b, _)| (a, b));
        for &e in old {
            self.free_element(e);
        }
        // Build.
        let mut made = SmallVec::new();
        let mut inner: SmallVec<[Side; 32]> = SmallVec::new();
        for element in new {
            let e = self.new_element(element.nodes().len() as u8, element.region());
            made.push(e);
            let nodes = element.nodes();
            for (corner, &node) in nodes.iter().enumerate() {
                let h = e.half_edge(corner as u32);
                self.set_origin(h, node);
                inner.push((node, nodes[(corner + 1) % nodes.len()], Some(h)));
            }
        }
        inner.sort_unstable_by_key(|&(a, b, _)| (a, b));
        // Hook up.
        let find = |sides: &[Side], a, b| {
            sides.binary_search_by_key(&(a, b), |&(a, b, _)| (a, b)).ok().map(|found| sides[found].2)
        };
        let mut hooked = 0;
        for &(a, b, h) in &inner {
            let h = h.expect("inner sides have half-edges");
            if let Some(beyond) = find(&outer, a, b) {
                hooked += 1;
                self.hook(h, beyond);
            } else {
                let t = find(&inner, b, a).flatten().expect("a side of a new element meets another or the outside");
                if h < t {
                    self.hook(h, Some(t));
                }
            }
            self.reanchor(h);
        }
        assert_eq!(hooked, outer.len(), "the new elements fill the hole of the old ones");
        made
    }

    /// Creates a free node for use in [`replace`](Mesh::replace).
    pub fn add_node(&mut self, uv: DVec2, metric: Metric2) -> NodeId {
        self.new_node(uv, metric)
    }

    /// Turns a free node without elements into a tombstone.
    pub fn release_node(&mut self, node: NodeId) {
        self.free_node(node);
    }

    // ---- moving ----

    /// Whether every element around a free node remains positive and convex when the node moves to `uv`.
    ///
    /// # Errors
    /// The reason of the refusal.
    pub fn can_move(&self, node: NodeId, uv: DVec2) -> Result<(), Refusal> {
        Refusal::FixedNode.when(self.is_fixed(node))?;
        let is_sound = |h| {
            if self.is_triangle(HalfEdgeId::element(h)) {
                let [_, b, c] = self.triangle_from(h).map(|n| self.uv(n));
                firm(uv, b, c)
            } else {
                let [_, b, c, d] = self.quad_from(h).map(|n| self.uv(n));
                convex(uv, b, c, d)
            }
        };
        Refusal::NotPositive.when(!self.fan(node).all(is_sound))?;
        self.permit_move(node, uv)
    }

    /// Moves a free node; [`can_move`](Mesh::can_move) must hold. `metric` is that at `uv`.
    pub fn move_node(&mut self, node: NodeId, uv: DVec2, metric: Metric2) {
        debug_assert!(!self.is_fixed(node));
        self.set_place(node, uv, metric);
    }

    /// Whether an element remains positive (a triangle firm, a quadrilateral strictly convex) when `node` moves to
    /// `uv`.
    pub fn stays_positive(&self, e: ElementId, node: NodeId, uv: DVec2) -> bool {
        let place = |n: NodeId| if n == node { uv } else { self.uv(n) };
        if self.is_triangle(e) {
            let [a, b, c] = self.triangle(e).map(place);
            firm(a, b, c)
        } else {
            let [a, b, c, d] = self.quad(e).map(place);
            convex(a, b, c, d)
        }
    }
}
