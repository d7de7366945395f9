//! Operations on quadrilaterals that change their structure (docs/algorithm.md, "Clean-up"): diamond collapse, edge
//! rotation, vertex opening and its inverse, and the removal of doublets.
//!
//! These check only the topology: the result is conforming and manifold, but its elements may be inverted until the
//! nodes around are relaxed. They are for use inside a transaction that ends with an exact check, or is rolled back.

use std::collections::VecDeque;

use glam::DVec2;
use smallvec::SmallVec;

use super::half_edge::{Mesh, NewElement};
use super::ids::{ElementId, HalfEdgeId, NodeId};
use super::refusals::{Operation, Refusal};
use crate::core::kernel::Metric2;

impl Mesh {
    /// Whether the node has more edges than the minimum: three inside, two on a boundary.
    fn can_lose_an_edge(&self, node: NodeId) -> bool {
        self.valence(node) > if self.is_on_boundary(node) { 2 } else { 3 }
    }

    /// Merges the corner a of a quadrilateral into the opposite corner c and removes the quadrilateral.
    ///
    /// ```text
    ///        d                 d
    ///      /   \               |
    ///     a     c      =>      c
    ///      \   /               |
    ///        b                 b
    /// ```
    /// `h_ab` starts at a, which must be free. Node a becomes a tombstone; c does not move.
    ///
    /// # Errors
    /// Refused if a is fixed, if a and c have other connections, or if b or d would keep too few edges.
    pub fn collapse_diamond(&mut self, h_ab: HalfEdgeId) -> Result<(), Refusal> {
        let q = h_ab.element();
        Refusal::NotTriangles.when(!self.is_quad(q))?;
        let (h_bc, h_da) = (self.next(h_ab), self.previous(h_ab));
        let (a, b, c, d) = (self.origin(h_ab), self.origin(h_bc), self.target(h_bc), self.origin(h_da));
        Refusal::FixedNode.when(self.is_fixed(a))?;
        Refusal::Valence.when(!self.can_lose_an_edge(b) || !self.can_lose_an_edge(d))?;
        let around_c: SmallVec<[NodeId; 8]> = self.neighbours(c).collect();
        Refusal::Link
            .when(around_c.contains(&a) || self.neighbours(a).any(|n| n != b && n != d && around_c.contains(&n)))?;
        let old: SmallVec<[ElementId; 8]> = self.elements_at(a).collect();
        Refusal::Link.when(old.iter().any(|&e| e != q && self.corners(e).any(|n| n == c)))?;
        self.permit(Operation::CollapseDiamond, &[a, b, c, d])?;
        let new: SmallVec<[NewElement; 8]> =
            old.iter().filter(|&&e| e != q).map(|&e| self.with_node_replaced(e, a, c)).collect();
        self.replace_quads(&old, &new);
        self.release_node(a);
        Ok(())
    }

    /// The six nodes around an edge between two quadrilaterals, anticlockwise; `h` runs from the fourth to the first.
    ///
    /// ```text
    ///     n2---n1                 n2---n1
    ///     |     |                 |   / |
    ///     n3---n0   rotate(1):    n3 /  n0     rotate(2): n2 to n5
    ///     |     |                 | /   |
    ///     n4---n5                 n4---n5
    /// ```
    ///
    /// # Errors
    /// Refused on a boundary and if an element is not a quadrilateral.
    pub fn hexagon(&self, h: HalfEdgeId) -> Result<[NodeId; 6], Refusal> {
        let t = self.twin(h).ok_or(Refusal::OnBoundary)?;
        Refusal::NotTriangles.when(!self.is_quad(h.element()) || !self.is_quad(t.element()))?;
        // The element left of the edge n3 -> n0 has the nodes n1 and n2.
        let [left, right] = [h, t].map(|h| [self.target(self.next(h)), self.apex(h)]);
        Ok([self.origin(t), left[0], left[1], self.origin(h), right[0], right[1]])
    }

    /// Rotates the edge between two quadrilaterals by one or two nodes of their hexagon; see
    /// [`hexagon`](Mesh::hexagon).
    ///
    /// # Errors
    /// Refused on a boundary, if the new ends are already connected, if the hexagon has fewer than six nodes, and if an
    /// end of the old edge would keep too few edges.
    pub fn rotate_edge(&mut self, h: HalfEdgeId, by: usize) -> Result<(), Refusal> {
        let n = self.hexagon(h)?;
        Refusal::Link.when((1..6).any(|k| n[..k].contains(&n[k])))?;
        Refusal::Valence.when(!self.can_lose_an_edge(n[0]) || !self.can_lose_an_edge(n[3]))?;
        Refusal::Joined.when(self.are_joined(n[by], n[by + 3]))?;
        self.permit(Operation::RotateEdge, &[n[by], n[by + 3]])?;
        let t = self.twin(h).ok_or(Refusal::OnBoundary)?;
        let region = self.region(h.element());
        let at = |k: usize| n[(by + k) % 6];
        let new =
            [[at(0), at(1), at(2), at(3)], [at(3), at(4), at(5), at(0)]].map(|nodes| NewElement::quad(nodes, region));
        self.replace_quads(&[h.element(), t.element()], &new);
        Ok(())
    }

    /// Opens a node along two of its edges into a new quadrilateral: the elements from `h_vp` anticlockwise to `h_vq`
    /// are connected to a new node w.
    ///
    /// ```text
    ///      \   p   /            \    p    /
    ///       \  |  /              \  / \  /
    ///     --   v   --    =>     --w     v--
    ///       /  |  \              /  \ /  \
    ///      /   q   \            /    q    \
    /// ```
    /// The new quadrilateral is (v, p, w, q). Returns w, which lies at `uv`.
    ///
    /// # Errors
    /// Refused if an edge lies on a boundary, if a fixed v would lose a boundary edge, and if either node would have
    /// fewer than three edges.
    pub fn open_vertex(
        &mut self,
        h_vp: HalfEdgeId,
        h_vq: HalfEdgeId,
        uv: DVec2,
        metric: Metric2,
    ) -> Result<NodeId, Refusal> {
        let v = self.origin(h_vp);
        debug_assert_eq!(v, self.origin(h_vq));
        Refusal::OnBoundary.when(self.twin(h_vp).is_none() || self.twin(h_vq).is_none())?;
        let (p, q) = (self.target(h_vp), self.target(h_vq));
        let mut handed: SmallVec<[ElementId; 8]> = SmallVec::new();
        let mut h = h_vp;
        while h != h_vq {
            handed.push(h.element());
            h = self.twin(self.previous(h)).ok_or(Refusal::OnBoundary)?;
        }
        let kept = self.fan(v).count() - handed.len();
        // An inner node of n elements has n edges, and the new quadrilateral adds one.
        Refusal::Valence.when(p == q || handed.len() < 2 || (!self.is_on_boundary(v) && kept < 2))?;
        self.permit(Operation::OpenVertex, &[v, p, q])?;
        let region = self.region(h_vp.element());
        let w = self.add_node(uv, metric);
        let mut new: SmallVec<[NewElement; 8]> = handed.iter().map(|&e| self.with_node_replaced(e, v, w)).collect();
        new.push(NewElement::quad([v, p, w, q], region));
        // The new quadrilateral fills the gap at the sides v-p and q-v of the sector.
        self.replace_quads(&handed, &new);
        Ok(w)
    }

    /// Merges the two quadrilaterals at a free node that has no other elements.
    ///
    /// ```text
    ///        c                 c
    ///      / | \             /   \
    ///     x  v  y     =>    x     y
    ///      \ | /             \   /
    ///        a                 a
    /// ```
    ///
    /// # Errors
    /// Refused if the node is fixed or not a doublet of two quadrilaterals.
    pub fn remove_doublet(&mut self, v: NodeId) -> Result<ElementId, Refusal> {
        Refusal::FixedNode.when(self.is_fixed(v))?;
        let spokes: SmallVec<[HalfEdgeId; 3]> = self.fan(v).take(3).collect();
        let [h_va, h_vc] = spokes[..] else { return Err(Refusal::Valence) };
        Refusal::NotTriangles.when(!self.is_quad(h_va.element()) || !self.is_quad(h_vc.element()))?;
        let (a, c) = (self.target(h_va), self.target(h_vc));
        let (x, y) = (self.target(self.next(h_va)), self.target(self.next(h_vc)));
        Refusal::Link.when(x == y)?;
        self.permit(Operation::RemoveDoublet, &[v])?;
        let new = NewElement::quad([a, x, c, y], self.region(h_va.element()));
        let made = self.replace_quads(&[h_va.element(), h_vc.element()], &[new]);
        self.release_node(v);
        Ok(made[0])
    }

    /// Fills the disc of some quadrilaterals anew. `inner` are the nodes inside it, `border` those around it,
    /// anticlockwise; `quads` are the new quadrilaterals, by numbers of nodes: first those of the border, then the new
    /// ones with these places and metrics. Returns the new nodes and the new elements.
    ///
    /// # Errors
    /// Refused if a node inside is fixed.
    pub fn refill(
        &mut self,
        old: &[ElementId],
        inner: &[NodeId],
        border: &[NodeId],
        new: &[(DVec2, Metric2)],
        quads: &[[u32; 4]],
    ) -> Result<(Vec<NodeId>, Vec<ElementId>), Refusal> {
        Refusal::FixedNode.when(inner.iter().any(|&n| self.is_fixed(n)))?;
        self.permit(Operation::Refill, border)?;
        let region = self.region(old[0]);
        let nodes: Vec<NodeId> = new.iter().map(|&(uv, metric)| self.add_node(uv, metric)).collect();
        let node = |k: u32| *border.get(k as usize).unwrap_or_else(|| &nodes[k as usize - border.len()]);
        let quads: Vec<NewElement> = quads.iter().map(|quad| NewElement::quad(quad.map(node), region)).collect();
        let made = self.replace_quads(old, &quads);
        inner.iter().for_each(|&n| self.release_node(n));
        Ok((nodes, made.into_vec()))
    }

    /// Replaces elements by others that fill the same hole. A quadrilateral of these gets a level from those beside
    /// it: that of the segment at the boundary, else one more than the least.
    fn replace_quads(&mut self, old: &[ElementId], new: &[NewElement]) -> SmallVec<[ElementId; 8]> {
        let made = self.replace(old, new);
        // The new quadrilaterals with their levels, by id.
        let mut rows: SmallVec<[(ElementId, u16); 8]> =
            made.iter().filter(|&&e| self.is_quad(e)).map(|&e| (e, u16::MAX)).collect();
        rows.sort_unstable();
        let place_of = |rows: &[(ElementId, u16)], e| rows.binary_search_by_key(&e, |&(e, _)| e).ok();
        let is_outer = |&k: &usize| {
            let mut sides = self.half_edges(rows[k].0);
            sides.any(|h| self.twin(h).is_none_or(|t| place_of(&rows, t.element()).is_none()))
        };
        let mut waiting: VecDeque<usize> = (0..rows.len()).filter(is_outer).collect();
        while let Some(k) = waiting.pop_front() {
            let (e, level) = rows[k];
            let beside = self.half_edges(e).filter_map(|h| match self.twin(h).map(|t| t.element()) {
                None => Some(self.first_level(self.origin(h))),
                Some(other) if self.is_triangle(other) => None,
                Some(other) => {
                    let level = place_of(&rows, other).map_or_else(|| self.level(other), |k| rows[k].1);
                    Some(level.saturating_add(1))
                }
            });
            let least = beside.min().unwrap_or(0);
            if least < level {
                rows[k].1 = least;
                waiting.extend(self.half_edges(e).filter_map(|h| place_of(&rows, self.twin(h)?.element())));
            }
        }
        for (e, level) in rows {
            self.set_level(e, level);
        }
        made
    }

    /// The element `e` with one corner replaced.
    fn with_node_replaced(&self, e: ElementId, from: NodeId, to: NodeId) -> NewElement {
        let swap = |n: NodeId| if n == from { to } else { n };
        if self.is_triangle(e) {
            NewElement::triangle(self.triangle(e).map(swap), self.region(e))
        } else {
            NewElement::quad(self.quad(e).map(swap), self.region(e))
        }
    }
}
