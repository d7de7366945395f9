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

impl Mesh {
    /// Metric length of an edge over the metrics of its ends.
    #[inline]
    pub fn length(&self, h: HalfEdgeId) -> f64 {
        self.distance(self.origin(h), self.target(h))
    }

    /// Metric length of the straight line between two nodes, over the metrics of both.
    #[inline]
    pub fn distance(&self, a: NodeId, b: NodeId) -> f64 {
        length_over(&self.metric(a), &self.metric(b), self.uv(b) - self.uv(a))
    }

    /// The place between two nodes that halves the metric length.
    pub fn metric_middle(&self, a: NodeId, b: NodeId) -> DVec2 {
        let (p, q) = (self.uv(a), self.uv(b));
        let [l_p, l_q] = [a, b].map(|n| self.metric_ref(n).norm2(q - p).sqrt());
        p + (q - p) * (l_q.sqrt() / (l_p.sqrt() + l_q.sqrt()))
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
            let n = self.quad(e);
            quad_quality(n.map(|n| self.metric_ref(n)), n.map(|n| self.uv(n)))
        }
    }

    /// Quality of a triangle of these nodes, whether or not it exists.
    #[inline]
    pub fn triangle_quality(&self, n: [NodeId; 3]) -> f64 {
        quality_over(n.map(|n| self.uv(n)), n.map(|n| self.metric_ref(n)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
