//! Lengths and qualities of the mesh's own edges and elements, from the metrics of their nodes: these rank, they never
//! decide about validity.

use glam::DVec2;

use super::half_edge::Mesh;
use super::ids::{ElementId, HalfEdgeId, NodeId};
use crate::core::metric::tensor::Metric2;

/// Length of `d` over two metrics: the logarithmic mean of the lengths in each (spec 2.1), by the approximation
/// (4 sqrt(la lb) + la + lb) / 6, which is within 0.2 % of it where one is up to four times the other and costs no
/// logarithm.
#[inline]
pub fn length_over(m_a: &Metric2, m_b: &Metric2, d: DVec2) -> f64 {
    let (l2_a, l2_b) = (m_a.norm2(d), m_b.norm2(d));
    let (l_a, l_b) = (l2_a.sqrt(), l2_b.sqrt());
    (4.0 * (l_a * l_b).sqrt() + l_a + l_b) / 6.0
}

/// Quality of a triangle, 4 sqrt(3) A / (sum of squared side lengths), in the mean of its nodes' metrics; 1 for an
/// equilateral one, negative for an inverted one. Independent of the size that the metrics ask for.
#[inline]
pub fn triangle_quality(p: [DVec2; 3], m: [&Metric2; 3]) -> f64 {
    let mean = mean3(m);
    let (ab, bc, ca) = (p[1] - p[0], p[2] - p[1], p[0] - p[2]);
    let area = 0.5 * ab.perp_dot(-ca) * mean.det().sqrt();
    6.928_203_230_275_509 * area / (mean.norm2(ab) + mean.norm2(bc) + mean.norm2(ca))
}

#[inline]
fn mean3(m: [&Metric2; 3]) -> Metric2 {
    Metric2 { uu: m[0].uu + m[1].uu + m[2].uu, uv: m[0].uv + m[1].uv + m[2].uv, vv: m[0].vv + m[1].vv + m[2].vv }
}

/// Quality of a quadrilateral (spec 2.1.5): the least over its corners of 2 sqrt(det M) x(a, b) / (a M a + b M b), with
/// the corner's metric M and its two sides a, b; 1 for a square of the metric, not positive for one that is not convex.
#[inline]
pub fn quad_quality(p: [DVec2; 4], m: [&Metric2; 4]) -> f64 {
    let mut least = f64::INFINITY;
    for k in 0..4 {
        let (a, b) = (p[(k + 1) % 4] - p[k], p[(k + 3) % 4] - p[k]);
        let q = 2.0 * m[k].det().sqrt() * a.perp_dot(b) / (m[k].norm2(a) + m[k].norm2(b));
        least = least.min(q);
    }
    least
}

impl Mesh {
    /// Metric length of an edge over the metrics of its two ends.
    #[inline]
    pub fn length(&self, h: HalfEdgeId) -> f64 {
        self.distance(self.origin(h), self.target(h))
    }

    /// Metric length of the straight line between two nodes, over the metrics of both.
    #[inline]
    pub fn distance(&self, a: NodeId, b: NodeId) -> f64 {
        length_over(&self.metric(a), &self.metric(b), self.uv(b) - self.uv(a))
    }

    /// Quality of an element: see [`triangle_quality`] and [`quad_quality`].
    pub fn quality(&self, e: ElementId) -> f64 {
        if self.is_triangle(e) {
            let n = self.triangle(e);
            self.triangle_quality(n)
        } else {
            let n = self.quad(e);
            quad_quality(n.map(|n| self.uv(n)), n.each_ref().map(|&n| self.metric_ref(n)))
        }
    }

    /// Quality that a triangle of these nodes has or would have.
    #[inline]
    pub fn triangle_quality(&self, n: [NodeId; 3]) -> f64 {
        triangle_quality(n.map(|n| self.uv(n)), n.each_ref().map(|&n| self.metric_ref(n)))
    }
}
