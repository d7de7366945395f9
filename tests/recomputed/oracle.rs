//! The front and its measures, from the triangles of a mesh alone.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use glam::DVec2;
use quadfront::core::mesh::{Mesh, NodeId};

/// A metric as a symmetric matrix [[a, b], [b, c]].
pub type Matrix = [f64; 3];

pub fn norm([a, b, c]: Matrix, d: DVec2) -> f64 {
    (a * d.x * d.x + 2.0 * b * d.x * d.y + c * d.y * d.y).sqrt()
}

/// The angle from one direction to another (eq. 5): by the arc cosine of the inner product, and its complement to a
/// full turn where the second direction lies clockwise of the first one.
pub fn angle(m: Matrix, from: DVec2, to: DVec2) -> f64 {
    let [a, b, c] = m;
    let inner = a * from.x * to.x + b * (from.x * to.y + from.y * to.x) + c * from.y * to.y;
    let theta = libm::acos((inner / (norm(m, from) * norm(m, to))).clamp(-1.0, 1.0));
    if from.perp_dot(to) >= 0.0 { theta } else { TAU - theta }
}

/// A front segment as the oracle sees it.
#[derive(Debug)]
pub struct Measured {
    pub h: f64,
    pub length: f64,
    pub physical: f64,
    pub theta: [f64; 2],
    pub class: u8,
    pub layer: u32,
    pub is_deferred: bool,
    /// Where the next segment of its loop ends.
    pub next: NodeId,
}

pub struct Oracle<'a> {
    pub mesh: &'a Mesh,
}

impl Oracle<'_> {
    pub fn metric(&self, n: NodeId) -> Matrix {
        let m = self.mesh.metric(n);
        [m.uu, m.uv, m.vv]
    }

    /// `1 / sqrt` of the larger eigenvalue; on surfaces of `X M X^T` with `X = L^-1` and the first fundamental form `G
    /// = L L^T`: the metric in an orthonormal frame of the tangent plane.
    pub fn size(&self, n: NodeId) -> f64 {
        let [a, b, c] = self.metric(n);
        let [p, q, r] = match self.mesh.embedding() {
            None => [1.0, 0.0, 1.0],
            Some(embedding) => {
                let [u, v] = embedding.atlas.at(self.mesh.uv(n)).j;
                [u.dot(u), u.dot(v), v.dot(v)]
            }
        };
        let (l, k) = (p.sqrt(), q / p.sqrt());
        let n = (r - k * k).sqrt();
        let (x, y, z) = (1.0 / l, -k / (l * n), 1.0 / n);
        let (uu, uv, vv) = (x * x * a, x * (y * a + z * b), y * y * a + 2.0 * y * z * b + z * z * c);
        let larger = 0.5 * (uu + vv) + (0.25 * (uu - vv) * (uu - vv) + uv * uv).sqrt();
        1.0 / larger.sqrt()
    }

    /// The metric length of an edge: the rational twin of the logarithmic mean of eq. 4 at both ends.
    pub fn length(&self, a: NodeId, b: NodeId) -> f64 {
        let [la, lb] = [a, b].map(|n| norm(self.metric(n), self.mesh.uv(b) - self.mesh.uv(a)));
        (4.0 * (la * lb).sqrt() + la + lb) / 6.0
    }

    /// The front, from the triangles: their sides without a triangle beyond, with the live region to the left.
    pub fn front(&self, face: Option<u32>, parameters: &quadfront::Parameters) -> BTreeMap<[NodeId; 2], Measured> {
        let mesh = self.mesh;
        let mut sides = BTreeSet::new();
        // At each node, from each neighbour to the next one anticlockwise across a live triangle.
        let mut turns: BTreeMap<(NodeId, NodeId), NodeId> = BTreeMap::new();
        let mut regions = BTreeMap::new();
        let mut dead = BTreeMap::new();
        for e in mesh.elements() {
            let corners: Vec<NodeId> = mesh.corners(e).collect();
            let n = corners.len();
            for k in 0..n {
                let side = [corners[k], corners[(k + 1) % n]];
                if n == 3 {
                    sides.insert(side);
                    regions.insert(side, mesh.region(e));
                    turns.insert((corners[k], corners[(k + 1) % 3]), corners[(k + 2) % 3]);
                } else {
                    dead.insert(side, mesh.level(e));
                }
            }
        }
        let mut front = BTreeMap::new();
        for &[a, b] in &sides {
            if sides.contains(&[b, a]) || face.is_some_and(|face| regions[&[a, b]] != face) {
                continue;
            }
            let turn = |at: NodeId, from: NodeId| {
                let mut to = from;
                while let Some(&next) = turns.get(&(at, to)) {
                    to = next;
                }
                to
            };
            // At B the sector ends at A: backwards through the triangles.
            let back = |at: NodeId, to: NodeId| {
                let mut from = to;
                while let Some((&(_, before), _)) =
                    turns.range((at, NodeId(0))..=(at, NodeId(u32::MAX))).find(|(_, next)| **next == from)
                {
                    from = before;
                }
                from
            };
            let way = |at: NodeId, to: NodeId| mesh.uv(to) - mesh.uv(at);
            let (c, d) = (turn(a, b), back(b, a));
            // At the tip of a crack both segments have one direction; the arc cosine finds zero to 2e-8.
            let full = |theta: f64| if theta < 1e-6 { TAU } else { theta };
            let theta =
                [full(angle(self.metric(a), way(a, b), way(a, c))), full(angle(self.metric(b), way(b, d), way(b, a)))];
            let below = theta.map(|t| t < parameters.theta_rect);
            let level = match dead.get(&[b, a]) {
                Some(level) => u32::from(*level) + 1,
                None => u32::from(mesh.first_level(a)),
            };
            front.insert(
                [a, b],
                Measured {
                    h: 0.5 * (self.size(a) + self.size(b)),
                    length: self.length(a, b),
                    physical: mesh.xyz(a).distance(mesh.xyz(b)),
                    theta,
                    class: [[4, 3], [2, 1]][usize::from(below[0])][usize::from(below[1])],
                    layer: level.min(parameters.layers),
                    is_deferred: mesh.is_deferred(mesh.front_between(a, b).unwrap()),
                    next: d,
                },
            );
        }
        front
    }
}
