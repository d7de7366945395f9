//! The live sector between two front segments at a node, traversed from a front segment (docs/algorithm.md, "Front,
//! loops and frontal angles"). Frontal angles belong to the ends of segments and not to nodes, since a pinched node has
//! several sectors.

use serde::Serialize;
use smallvec::SmallVec;

use crate::core::mesh::{HalfEdgeId, Mesh, NodeId};
use crate::core::metric::measure::angle;

/// The left or right end of a front segment AB: A or B.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// At A, on the left seen from the base into the live region.
    Left,
    /// At B.
    Right,
}

impl Side {
    /// Both, left first.
    pub const BOTH: [Side; 2] = [Side::Left, Side::Right];

    /// 0 for the left, 1 for the right.
    pub fn index(self) -> usize {
        self as usize
    }

    /// The other one.
    #[must_use]
    pub fn other(self) -> Side {
        match self {
            Side::Left => Side::Right,
            Side::Right => Side::Left,
        }
    }
}

/// An edge from one end of a base segment into its live sector; the last one is the next front segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spoke {
    /// Its far end.
    pub node: NodeId,
    /// Its half-edge in a live triangle of the sector.
    pub h: HalfEdgeId,
    /// Whether it is the front segment that ends the sector.
    pub is_front: bool,
}

/// The spokes of a sector, in order from the base segment.
pub type Spokes = SmallVec<[Spoke; 10]>;

impl Mesh {
    /// Whether the half-edge is a front segment: a side of a live triangle without a live triangle beyond.
    #[inline]
    pub fn is_front(&self, h: HalfEdgeId) -> bool {
        self.is_triangle(h.element()) && self.live_twin(h).is_none()
    }

    /// Whether a node lies on the front (or on the boundary).
    #[inline]
    pub fn is_on_front(&self, node: NodeId) -> bool {
        self.is_on_boundary(node) || self.elements_at(node).any(|e| !self.is_triangle(e))
    }

    /// Whether the elements around a node are all quadrilaterals.
    #[inline]
    pub fn is_buried(&self, node: NodeId) -> bool {
        self.elements_at(node).all(|e| self.is_quad(e))
    }

    /// Whether two nodes are joined by an edge between two live triangles.
    pub fn is_live_edge(&self, a: NodeId, b: NodeId) -> bool {
        self.half_edge_between(a, b).is_some_and(|h| self.is_triangle(h.element()) && self.live_twin(h).is_some())
    }

    /// Whether the edge between two nodes is a front segment, in either direction.
    pub fn is_front_edge(&self, a: NodeId, b: NodeId) -> bool {
        self.front_between(a, b).is_some() || self.front_between(b, a).is_some()
    }

    /// The segments of the merging front, in the order of their triangles.
    pub fn front(&self) -> impl Iterator<Item = HalfEdgeId> + '_ {
        self.elements().flat_map(|e| self.half_edges(e)).filter(|h| self.is_front(*h))
    }

    /// The front segment before `h` on its loop: it ends at the origin of `h`, in the same live sector.
    #[inline]
    pub fn front_before(&self, h: HalfEdgeId) -> HalfEdgeId {
        let mut p = self.previous(h);
        while let Some(t) = self.live_twin(p) {
            p = self.previous(t);
        }
        p
    }

    /// The front segment after `h` on its loop.
    #[inline]
    pub fn front_after(&self, h: HalfEdgeId) -> HalfEdgeId {
        let mut n = self.next(h);
        while let Some(t) = self.live_twin(n) {
            n = self.next(t);
        }
        n
    }

    /// The front segments of the loop of one, from it on.
    pub fn front_loop(&self, start: HalfEdgeId) -> impl Iterator<Item = HalfEdgeId> + '_ {
        std::iter::successors(Some(start), move |&h| Some(self.front_after(h)).filter(|&h| h != start))
    }

    /// The front segment from one node to another, if there is one.
    pub fn front_between(&self, from: NodeId, to: NodeId) -> Option<HalfEdgeId> {
        self.half_edge_between(from, to).filter(|&h| self.is_front(h))
    }

    /// The edges of the live sector at one end of a front segment, in order from the segment; the last is the next
    /// segment.
    pub fn spokes(&self, base: HalfEdgeId, side: Side) -> Spokes {
        let mut spokes = Spokes::new();
        let step = |h| match side {
            Side::Left => self.previous(h),
            Side::Right => self.next(h),
        };
        let mut h = step(base);
        loop {
            let node = match side {
                Side::Left => self.origin(h),
                Side::Right => self.target(h),
            };
            let beyond = self.live_twin(h);
            spokes.push(Spoke { node, h, is_front: beyond.is_none() });
            match beyond {
                Some(t) => h = step(t),
                None => return spokes,
            }
        }
    }

    /// Whether the frontal angle at A is between 90 and 270 degrees, which takes no arc tangent to see.
    #[inline]
    pub fn opens_wide(&self, h: HalfEdgeId) -> bool {
        let (p, metric) = self.place(self.origin(h));
        metric.inner(self.uv(self.target(h)) - p, self.uv(self.origin(self.front_before(h))) - p) < 0.0
    }

    /// The frontal angle at one end of a front segment, in (0, 2 pi], in the metric of the node (fig. 9).
    #[inline]
    pub fn frontal_angle(&self, h: HalfEdgeId, side: Side) -> f64 {
        let (at, from, to) = match side {
            Side::Left => (self.origin(h), self.target(h), self.origin(self.front_before(h))),
            Side::Right => (self.target(h), self.target(self.front_after(h)), self.origin(h)),
        };
        let p = self.uv(at);
        let theta = angle(self.metric_ref(at), self.uv(from) - p, self.uv(to) - p);
        // Equal directions: the tip of a crack, where the sector is a full turn. (Positive triangles cannot form a
        // sector of zero angle, and only needles form a thinner one than this.)
        if theta < 1e-9 || from == to { std::f64::consts::TAU } else { theta }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::kernel::Metric2;
    use crate::core::mesh::{PointId, TriangleSet};
    use glam::DVec2;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn an_end_opens_wide_where_its_angle_is_obtuse_or_reflex() {
        // An arrowhead with angles of about 10, 140, 10 and 200 degrees, fanned from the reflex corner.
        let uv = [(0.0, 0.0), (2.0, -0.4), (4.0, 0.0), (2.0, 0.4)].map(|(x, y)| DVec2::new(x, y)).to_vec();
        for dent in [0.4, -0.2] {
            let mut uv = uv.clone();
            uv[3].y = dent;
            let set = TriangleSet {
                uv,
                point: [0, 1, 2, 3].map(PointId).to_vec(),
                triangles: vec![[0, 1, 3], [1, 2, 3]],
                region: vec![0; 2],
                ..TriangleSet::default()
            };
            for metric in [Metric2::isotropic(1.0), Metric2 { uu: 1.0, uv: 0.0, vv: 100.0 }] {
                let mesh = Mesh::from_triangles(&set, vec![metric; 4]);
                for h in mesh.front() {
                    let angle = mesh.frontal_angle(h, Side::Left);
                    assert_eq!(mesh.opens_wide(h), angle > FRAC_PI_2 && angle < 3.0 * FRAC_PI_2, "{angle}");
                }
            }
        }
    }
}
