//! Front segment seaming (paper 4.3.6, fig. 18): two adjacent front segments with a small angle become one dead edge.

use smallvec::SmallVec;

use super::converter::Converter;
use super::event::Event;
use super::top::{MOST_SWAPS, Recovery};
use crate::core::front::sector::Side;
use crate::core::mesh::ids::{HalfEdgeId, NodeId};

/// Segments whose lengths differ by more than this factor would need a transition seam.
const MOST_UNLIKE: f64 = 2.5;
/// With this many dead elements at the node, angles up to `WIDE` are seamed too (Levik; spec 1).
const CROWDED: usize = 5;
/// So they are where the segments are shorter than this on average, in the metric: where sizes grow ahead of the front,
/// columns must end, and this is where they do (docs/experiments.md).
const SHORT: f64 = 0.85;
const WIDE: f64 = std::f64::consts::FRAC_PI_4;

impl Converter<'_> {
    /// Seams at a node of the front where the frontal angle is small enough and the guards of spec 2.8 hold. All of it
    /// is taken back where it fails.
    pub(super) fn seam_at(&mut self, at: NodeId) -> Option<Event> {
        if !self.mesh.has_node(at) {
            return None;
        }
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
            let mark = self.mesh.mark();
            match self.seam(at, b, c) {
                Some(node) => return Some(Event::Seamed { at, node, angle }),
                None => self.mesh.take_back(mark),
            }
        }
        None
    }

    /// Recovers the edge between the far ends, empties the triangle, and merges the ends. Returns the merged node.
    fn seam(&mut self, a: NodeId, b: NodeId, c: NodeId) -> Option<NodeId> {
        let mesh = &self.mesh;
        if mesh.is_fixed(b) && mesh.is_fixed(c) {
            return None;
        }
        let (l_b, l_c) = (mesh.distance(a, b), mesh.distance(a, c));
        if l_b.max(l_c) > MOST_UNLIKE * l_b.min(l_c) {
            return None;
        }
        // A keeps at least three edges (or two on a boundary): else it would be a doublet.
        if mesh.valence(a) < if mesh.is_fixed(a) { 3 } else { 4 } {
            return None;
        }
        // The edge B-C (fig. 18b).
        for _ in 0..MOST_SWAPS {
            match self.recover_step(c, b, &[a, b, c]).ok()? {
                Recovery::Found => break,
                Recovery::Changed(_) => {}
            }
        }
        // The triangle A-B-C is one live triangle.
        let h_ab = self.mesh.front_between(a, b)?;
        let h_bc = self.mesh.next(h_ab);
        if self.mesh.target(h_bc) != c || self.mesh.front_between(c, a)? != self.mesh.previous(h_ab) {
            return None;
        }
        // Merge (fig. 18c) at the fixed end, else in the middle or as near to it as stays valid and good.
        let h_bc = self.mesh.next(h_ab);
        let (gone, kept, h) = if self.mesh.is_fixed(b) { (c, b, self.mesh.twin(h_bc)?) } else { (b, c, h_bc) };
        debug_assert_eq!((self.mesh.origin(h), self.mesh.target(h)), (gone, kept));
        let (from, to) = (self.mesh.uv(kept), self.mesh.uv(gone));
        let shares: &[f64] = if self.mesh.is_fixed(kept) { &[0.0] } else { &[0.5, 0.35, 0.65, 0.2, 0.8, 0.0, 1.0] };
        let worst = self.worst_quality([gone, kept]).min(0.3);
        for &share in shares {
            let place = from + (to - from) * share;
            let Ok(metric) = self.source.metric(place) else { continue };
            if self.mesh.can_collapse(h, place).is_err() {
                continue;
            }
            let mark = self.mesh.mark();
            self.mesh.collapse(h, place, metric);
            let worst_after = self.mesh.fan(kept).map(|h| self.mesh.quality(h.element())).fold(f64::INFINITY, f64::min);
            if worst_after >= 0.7 * worst {
                return Some(kept);
            }
            self.mesh.take_back(mark);
        }
        None
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
