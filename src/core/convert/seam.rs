//! Front segment seaming (paper 4.3.6, fig. 18): two adjacent front segments with a small angle become one dead edge. Where one is
//! much longer than the other, it is divided first: a transition seam (after Owen et al. 1999). Deliberately absent: their
//! transition split, for unlike segments at angles that are not small; it can go on for ever (docs/algorithm.md,
//! "Seaming").

use smallvec::SmallVec;

use super::converter::Converter;
use super::event::{Event, Unmerged};
use super::top::{MOST_SWAPS, Recovery, recover_step};
use crate::core::front::sector::Side;
use crate::core::kernel::predicates::{convex, firm};
use crate::core::mesh::half_edge::{Mesh, NewElement};
use crate::core::mesh::ids::{ElementId, HalfEdgeId, NodeId};

/// Segments whose lengths differ by more than this factor need a transition seam.
const MOST_UNLIKE: f64 = 2.5;
/// With this many dead elements at the node, angles up to `WIDE` are seamed too (after Levik; docs/algorithm.md,
/// "Seaming").
const CROWDED: usize = 5;
/// So they are where the segments are shorter than this on average, in the metric: where sizes grow ahead of the front,
/// columns must end, and this is where they do (docs/experiments.md).
const SHORT: f64 = 0.85;
const WIDE: f64 = std::f64::consts::FRAC_PI_4;

impl Converter<'_> {
    /// Seams at a node of the front where the frontal angle is small enough and the guards hold (docs/algorithm.md,
    /// "Seaming"); says why it refuses where they do not. What was tried in vain is taken back.
    pub(super) fn seam_at(&mut self, at: NodeId) -> Option<Event> {
        if !self.mesh.has_node(at) {
            return None;
        }
        let mut refused = None;
        let segments: SmallVec<[HalfEdgeId; 4]> = self.mesh.fan(at).filter(|&h| self.mesh.is_front(h)).collect();
        for h in segments {
            let angle = self.mesh.frontal_angle(h, Side::Left);
            let crowded = self.mesh.fan(at).filter(|h| self.mesh.is_quad(h.element())).count() >= CROWDED;
            let bound = self.parameters.theta_seam;
            let before = self.mesh.front_before(h);
            let short = 0.5 * (self.mesh.length(h) + self.mesh.length(before));
            // The wider angle is ours: the paper's own reading has neither it nor placement.
            let wide = self.parameters.placement && (crowded || short < SHORT);
            if angle > if wide { bound.max(WIDE) } else { bound } {
                continue;
            }
            let (b, c) = (self.mesh.target(h), self.mesh.origin(before));
            let (l_b, l_c) = (self.mesh.length(h), self.mesh.length(before));
            let ratio = l_b.max(l_c) / l_b.min(l_c);
            let mark = self.mesh.mark();
            let seamed = if ratio > MOST_UNLIKE {
                let long = if l_b > l_c { h } else { before };
                self.divide_segment(at, long).and_then(|middle| {
                    let (b, c) = if l_b > l_c { (middle, c) } else { (b, middle) };
                    Ok(Event::TransitionSeamed { at, node: self.seam(at, b, c)?, angle, ratio })
                })
            } else {
                self.seam(at, b, c).map(|node| Event::Seamed { at, node, angle })
            };
            match seamed {
                Ok(event) => return Some(event),
                Err(why) => {
                    self.mesh.take_back(mark);
                    refused = refused.or(Some(Event::SeamRefused { at, ends: [b, c], angle, ratio, why }));
                }
            }
        }
        refused
    }

    /// Divides the long front segment PQ of a transition seam, one of whose ends is A, at its metric middle M; what is cut
    /// off the quadrilateral beyond is live again. Drawn with A = P:
    ///
    /// ```text
    ///          X                      X
    ///        /   \                  / | \
    ///       /     \                /  |  \
    ///      P-------Q      =>      P---M---Q        front before: P-Q
    ///      |       |              |    \  |        front after:  P-M-S-Q
    ///      |       |              |     \ |
    ///      R-------S              R-------S
    /// ```
    /// The quadrilateral keeps its id. Returns M.
    fn divide_segment(&mut self, a: NodeId, h_pq: HalfEdgeId) -> Result<NodeId, Unmerged> {
        let mesh = &self.mesh;
        // Gather.
        let h_qp = mesh.twin(h_pq).ok_or(Unmerged::Unlike)?;
        let (live, quad) = (h_pq.element(), h_qp.element());
        let (p, q) = (mesh.origin(h_pq), mesh.target(h_pq));
        let x = mesh.origin(mesh.previous(h_pq));
        let (h_pr, h_sq) = (mesh.next(h_qp), mesh.previous(h_qp));
        let (r, s) = (mesh.target(h_pr), mesh.origin(h_sq));
        // Check: the side that is freed must stay on the front.
        let freed = if a == p { h_sq } else { h_pr };
        if mesh.twin(freed).is_some_and(|t| mesh.is_triangle(t.element())) {
            return Err(Unmerged::Unlike);
        }
        let m_uv = self.metric_middle(p, q);
        let metric = self.source.metric(m_uv).map_err(|_| Unmerged::NotPositive)?;
        let [p_uv, q_uv, r_uv, s_uv, x_uv] = [p, q, r, s, x].map(|n| mesh.uv(n));
        let (shape, rest) = if a == p {
            (convex(m_uv, p_uv, r_uv, s_uv), firm(q_uv, m_uv, s_uv))
        } else {
            (convex(q_uv, m_uv, r_uv, s_uv), firm(m_uv, p_uv, r_uv))
        };
        if !(shape && rest && firm(p_uv, m_uv, x_uv) && firm(m_uv, q_uv, x_uv)) {
            return Err(Unmerged::NotPositive);
        }
        // Build: the quadrilateral first, so that it takes the id that is freed last, its own.
        let (region, level) = (mesh.region(quad), mesh.level(quad));
        let m = self.mesh.add_node(m_uv, metric);
        let (shape, rest) = if a == p { ([m, p, r, s], [q, m, s]) } else { ([q, m, r, s], [m, p, r]) };
        let new = [
            NewElement::quad(shape, region),
            NewElement::triangle(rest, region),
            NewElement::triangle([p, m, x], region),
            NewElement::triangle([m, q, x], region),
        ];
        let made = self.mesh.replace(&[live, quad], &new);
        debug_assert_eq!(made[0], quad, "the quadrilateral keeps its id");
        self.mesh.set_level(quad, level);
        let quality = self.mesh.quality(quad);
        if quality < self.gates().quality { Err(Unmerged::Poor(quality)) } else { Ok(m) }
    }

    /// Recovers the edge between the far ends, empties the triangle, and merges the ends. Returns the merged node.
    fn seam(&mut self, a: NodeId, b: NodeId, c: NodeId) -> Result<NodeId, Unmerged> {
        let mesh = &self.mesh;
        if mesh.is_fixed(b) && mesh.is_fixed(c) {
            return Err(Unmerged::BothFixed);
        }
        // A keeps at least three edges (or two on a boundary): else it would be a doublet.
        if mesh.valence(a) < if mesh.is_fixed(a) { 3 } else { 4 } {
            return Err(Unmerged::Doublet);
        }
        // The edge B-C (fig. 18b).
        for _ in 0..MOST_SWAPS {
            match recover_step(&mut self.mesh, c, b, &[a, b, c]).map_err(|_| Unmerged::NotRecovered)? {
                Recovery::Found => break,
                Recovery::Changed(_) => {}
            }
        }
        // The triangle A-B-C is one live triangle.
        let h_ab = self.mesh.front_between(a, b).ok_or(Unmerged::NotRecovered)?;
        let h_bc = self.mesh.next(h_ab);
        if self.mesh.target(h_bc) != c || self.mesh.front_between(c, a) != Some(self.mesh.previous(h_ab)) {
            return Err(Unmerged::NotEmpty);
        }
        // The merge (fig. 18c).
        self.merge(h_bc, &|_, _| true)
    }

    /// Collapses a live edge between two nodes of the front at the fixed end, else in the middle or as near to it as stays valid
    /// and, as far as elements are `judged`, good. Returns the merged node.
    pub(super) fn merge(
        &mut self,
        h_bc: HalfEdgeId,
        judged: &dyn Fn(&Mesh, ElementId) -> bool,
    ) -> Result<NodeId, Unmerged> {
        let (b, c) = (self.mesh.origin(h_bc), self.mesh.target(h_bc));
        let h_cb = self.mesh.twin(h_bc).ok_or(Unmerged::BothFixed)?;
        let (gone, kept, h) = if self.mesh.is_fixed(b) { (c, b, h_cb) } else { (b, c, h_bc) };
        if self.mesh.is_fixed(gone) {
            return Err(Unmerged::BothFixed);
        }
        // The nodes opposite to the edge lose one edge each: fewer than three (on a boundary, two) would be a doublet.
        for opposite in [h_bc, h_cb].map(|h| self.mesh.origin(self.mesh.previous(h))) {
            if self.mesh.valence(opposite) < if self.mesh.is_fixed(opposite) { 3 } else { 4 } {
                return Err(Unmerged::Doublet);
            }
        }
        let (from, to) = (self.mesh.uv(kept), self.mesh.uv(gone));
        let shares: &[f64] = if self.mesh.is_fixed(kept) { &[0.0] } else { &[0.5, 0.35, 0.65, 0.2, 0.8, 0.0, 1.0] };
        let worst = self.worst_quality([gone, kept]).min(0.3);
        let mut why = Unmerged::NotPositive;
        for &share in shares {
            let place = from + (to - from) * share;
            let Ok(metric) = self.source.metric(place) else { continue };
            if self.mesh.can_collapse(h, place).is_err() {
                continue;
            }
            let mark = self.mesh.mark();
            self.mesh.collapse(h, place, metric);
            let mesh = &self.mesh;
            let around = mesh.fan(kept).map(HalfEdgeId::element).filter(|&e| judged(mesh, e));
            let after = around.map(|e| mesh.quality(e)).fold(f64::INFINITY, f64::min);
            if after >= 0.7 * worst {
                return Ok(kept);
            }
            why = Unmerged::Poor(after);
            self.mesh.take_back(mark);
        }
        Err(why)
    }

    fn worst_quality(&self, nodes: [NodeId; 2]) -> f64 {
        nodes
            .into_iter()
            .flat_map(|n| self.mesh.fan(n))
            .filter(|h| self.mesh.is_quad(h.element()))
            .map(|h| self.mesh.quality(h.element()))
            .fold(f64::INFINITY, f64::min)
    }
}
