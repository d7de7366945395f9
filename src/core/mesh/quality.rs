//! Lengths and qualities of edges and elements from the metrics of their nodes: for ranking, not for decisions about
//! validity.

use glam::DVec2;

use super::half_edge::Mesh;
use super::ids::{ElementId, HalfEdgeId, NodeId};
use crate::core::kernel::Metric2;
use crate::core::metric::measure::{quad_quality, triangle_quality};

/// Length of `d` over two metrics: the logarithmic mean of the lengths in each (docs/algorithm.md, "Lengths and
/// angles"), by the approximation (4 sqrt(la lb) + la + lb) / 6, which needs no logarithm and is within 0.2 % of it if
/// the lengths differ by a factor of at most four.
#[inline]
pub fn length_over(m_a: &Metric2, m_b: &Metric2, d: DVec2) -> f64 {
    let (l2_a, l2_b) = (m_a.norm2(d), m_b.norm2(d));
    let (l_a, l_b) = (l2_a.sqrt(), l2_b.sqrt());
    (4.0 * (l_a * l_b).sqrt() + l_a + l_b) / 6.0
}

/// Quality of a triangle in the mean of the metrics of its nodes (the quality does not depend on the scale of the
/// metric, so that the sum suffices).
#[inline]
pub fn quality_over(p: [DVec2; 3], m: [&Metric2; 3]) -> f64 {
    let sum =
        Metric2 { uu: m[0].uu + m[1].uu + m[2].uu, uv: m[0].uv + m[1].uv + m[2].uv, vv: m[0].vv + m[1].vv + m[2].vv };
    triangle_quality(&sum, p[0], p[1], p[2])
}

/// How far lengths of sides may be from 1, and the inner product of two from 0, where a triangle is half a unit square:
/// at a node, and at its neighbours, whose squares may be sheared at the edge of a grid. With 0.35 at both, nodes of
/// ordinary meshes pass by chance.
const OFF_SQUARE: [f64; 2] = [0.2, 0.3];

/// The turn around a regular node inside a face, in twelfths.
pub const FULL_TURN: u32 = 12;

/// The part of a regular node's turn that an element takes, in twelfths: a quarter where it is a quadrilateral, a sixth
/// where it is a triangle.
#[inline]
pub fn twelfths(is_quad: bool) -> u32 {
    if is_quad { 3 } else { 2 }
}

impl Mesh {
    /// Whether a node inside a face is regular: four quadrilaterals, six triangles, or an equivalent mixture around it.
    pub fn is_regular(&self, node: NodeId) -> bool {
        self.elements_at(node).map(|e| twelfths(self.is_quad(e))).sum::<u32>() == FULL_TURN
    }

    /// Metric length of an edge over the metrics of its ends.
    #[inline]
    pub fn length(&self, h: HalfEdgeId) -> f64 {
        self.distance(self.origin(h), self.target(h))
    }

    /// Metric length of the straight line between two nodes, over the metrics of both.
    #[inline]
    pub fn distance(&self, a: NodeId, b: NodeId) -> f64 {
        let ((p, m_a), (q, m_b)) = (self.place(a), self.place(b));
        length_over(m_a, m_b, q - p)
    }

    /// The place between two nodes that halves the metric length.
    pub fn metric_middle(&self, a: NodeId, b: NodeId) -> DVec2 {
        let (p, q) = (self.uv(a), self.uv(b));
        let [l_p, l_q] = [a, b].map(|n| self.metric_ref(n).norm2(q - p).sqrt());
        p + (q - p) * (l_q.sqrt() / (l_p.sqrt() + l_q.sqrt()))
    }

    /// The mean of an element's nodes in the parametric plane.
    #[inline]
    pub fn centroid(&self, e: ElementId) -> DVec2 {
        if self.is_triangle(e) {
            let [a, b, c] = self.triangle(e).map(|n| self.uv(n));
            (a + b + c) / 3.0
        } else {
            let [a, b, c, d] = self.quad(e).map(|n| self.uv(n));
            (a + b + c + d) / 4.0
        }
    }

    /// The worst quality of the elements around a node.
    pub fn worst_quality_at(&self, node: NodeId) -> f64 {
        self.elements_at(node).map(|e| self.quality(e)).fold(f64::INFINITY, f64::min)
    }

    /// Whether the elements around a node are a grid of unit squares cut along diagonals: all are triangles, and these
    /// and all other triangles at their nodes are half a unit square in the metric of the node. There, places need no
    /// smoothing, and no node is one too many even if it has four triangles only. One ring would not do: some nodes of
    /// ordinary meshes have four such triangles by chance.
    pub fn is_in_cut_grid(&self, node: NodeId) -> bool {
        let are_halves = |n: NodeId, off: f64| {
            let metric = self.metric_ref(n);
            self.elements_at(n).filter(|&e| self.is_triangle(e)).all(|e| self.is_half_square(e, metric, off))
        };
        let [near, beside] = OFF_SQUARE;
        self.elements_at(node).all(|e| self.is_triangle(e))
            && are_halves(node, near)
            && self.neighbours(node).all(|n| are_halves(n, beside))
    }

    /// Whether a triangle is half a unit square in a metric, cut along a diagonal.
    fn is_half_square(&self, e: ElementId, metric: &Metric2, off: f64) -> bool {
        let p = self.triangle(e).map(|n| self.uv(n));
        (0..3).any(|k| {
            let legs = [1, 2].map(|i| p[(k + i) % 3] - p[k]);
            legs.iter().all(|&leg| (metric.norm2(leg).sqrt() - 1.0).abs() < off)
                && metric.inner(legs[0], legs[1]).abs() < off
        })
    }

    /// Quality of an element: [`quality_over`] for a triangle, [`quad_quality`] for a quadrilateral.
    pub fn quality(&self, e: ElementId) -> f64 {
        if self.is_triangle(e) {
            let n = self.triangle(e);
            self.triangle_quality(n)
        } else {
            let corners = self.quad(e).map(|n| self.place(n));
            quad_quality(corners.map(|corner| corner.1), corners.map(|corner| corner.0))
        }
    }

    /// Quality of the element of `h` if the node that it leaves moved to `place`, with this metric.
    #[inline]
    pub fn quality_with(&self, h: HalfEdgeId, place: DVec2, metric: &Metric2) -> f64 {
        if self.is_triangle(h.element()) {
            let [_, b, c] = self.triangle_from(h).map(|n| self.place(n));
            quality_over([place, b.0, c.0], [metric, b.1, c.1])
        } else {
            let [_, b, c, d] = self.quad_from(h).map(|n| self.place(n));
            quad_quality([metric, b.1, c.1, d.1], [place, b.0, c.0, d.0])
        }
    }

    /// Area of a quadrilateral in the mean of the metrics of its nodes.
    pub fn metric_area(&self, e: ElementId) -> f64 {
        let n = self.quad(e);
        let [a, b, c, d] = n.map(|n| self.uv(n));
        let root = n.map(|n| self.metric_ref(n).det().max(0.0).sqrt()).iter().sum::<f64>() / 4.0;
        root * 0.5 * (c - a).perp_dot(d - b)
    }

    /// Quality of a triangle of these nodes, whether or not it exists.
    #[inline]
    pub fn triangle_quality(&self, n: [NodeId; 3]) -> f64 {
        let corners = n.map(|n| self.place(n));
        quality_over(corners.map(|corner| corner.0), corners.map(|corner| corner.1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::mesh::{NewElement, PointId, TriangleSet};

    #[test]
    fn length_over_is_the_integral_for_geometric_sizes_within_0_2_percent() {
        // h = h0 exp(a x) from 0 to 1: the integral of 1/h is (1 - exp(-a)) / (a h0).
        for a in [-1.38, -0.5, 0.1, 1.38] {
            let ends = [Metric2::isotropic(0.3), Metric2::isotropic(0.3 * libm::exp(a))];
            let expected = (1.0 - libm::exp(-a)) / (a * 0.3);
            let length = length_over(&ends[0], &ends[1], DVec2::X);
            assert!((length / expected - 1.0).abs() < 2e-3, "{a}: {length} and {expected}");
        }
        assert_eq!(length_over(&Metric2::isotropic(0.3), &Metric2::isotropic(0.5), DVec2::ZERO), 0.0);
    }

    /// A unit square around a free node (4) at (0.4, 0.6), with a quadrilateral below and three triangles, each node
    /// with a metric of its own.
    fn quad_and_triangles_around_a_node() -> Mesh {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        let set = TriangleSet {
            uv: vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0), at(0.4, 0.6), at(1.1, 0.5)],
            point: [0, 1, 2, 3, 4, 5].map(PointId).to_vec(),
            triangles: vec![[0, 1, 4], [1, 5, 4], [5, 2, 4], [2, 3, 4], [3, 0, 4]],
            region: vec![0; 5],
            ..TriangleSet::default()
        };
        let metric = |n: usize| Metric2 { uu: 1.0 + n as f64, uv: 0.1 * n as f64, vv: 6.0 - n as f64 };
        let mut mesh = Mesh::from_triangles(&set, (0..6).map(metric).collect());
        let quad = NewElement::quad([0, 1, 5, 4].map(NodeId), 0);
        mesh.replace(&[ElementId(0), ElementId(1)], &[quad]);
        mesh
    }

    #[test]
    fn qualities_and_moves_are_judged_as_if_the_node_had_moved() {
        let mesh = quad_and_triangles_around_a_node();
        let node = NodeId(4);
        assert_eq!(mesh.elements_at(node).filter(|&e| mesh.is_quad(e)).count(), 1);
        let metric = Metric2 { uu: 2.0, uv: 0.3, vv: 0.7 };
        for place in [DVec2::new(0.5, 0.5), DVec2::new(0.9, 0.9), DVec2::new(0.55, 0.26), DVec2::new(0.5, -0.1)] {
            let stays = mesh.elements_at(node).all(|e| mesh.stays_positive(e, node, place));
            assert_eq!(mesh.can_move(node, place).is_ok(), stays, "{place}");
            let mut moved = mesh.clone();
            moved.move_node(node, place, metric);
            for h in mesh.fan(node) {
                let (judged, found) = (mesh.quality_with(h, place, &metric), moved.quality(h.element()));
                assert!((judged - found).abs() < 1e-14, "{place}: {judged} {found}");
            }
        }
    }

    #[test]
    fn elements_are_read_from_any_of_their_nodes() {
        let mesh = quad_and_triangles_around_a_node();
        for e in mesh.elements() {
            let nodes: Vec<NodeId> = mesh.corners(e).collect();
            let sum = nodes.iter().map(|&n| mesh.uv(n)).sum::<DVec2>();
            assert!((mesh.centroid(e) - sum / nodes.len() as f64).length() < 1e-15);
            for h in mesh.half_edges(e) {
                let from = if mesh.is_quad(e) { mesh.quad_from(h).to_vec() } else { mesh.triangle_from(h).to_vec() };
                assert_eq!(from[0], mesh.origin(h));
                assert_eq!([from[1], from[from.len() - 1]], [mesh.target(h), mesh.apex(h)]);
                assert!(nodes.iter().all(|n| from.contains(n)) && from.len() == nodes.len());
            }
        }
    }
}
