//! Nodes of a run, found by places in space: those of a mesh that has no parametric plane of its own.

use std::collections::BTreeMap;

use glam::DVec3;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::places::NEAR;
use crate::core::geometry::ChartPoint;
use crate::core::kernel::Metric2;
use crate::core::mesh::{Mesh, NodeId};

/// The nodes of a run by their places in space; copies on both sides of a curve are one. A place is the same as that of
/// a node where it lies within [`NEAR`] of it in the metric of the node: along the tangent plane as in the parametric
/// plane, across it by the smallest size there.
pub struct NodesInSpace {
    /// Each in the box around all that is near it.
    tree: RTree<GeomWithData<Rectangle<[f64; 3]>, usize>>,
    nodes: Vec<Tangent>,
}

/// A node with the tangent plane there.
struct Tangent {
    here: ChartPoint,
    metric: Metric2,
    smallest_size: f64,
    /// The number of the place: copies have the same.
    number: usize,
}

impl Tangent {
    fn of(mesh: &Mesh, node: NodeId, number: usize) -> Tangent {
        let (xyz, uv) = (mesh.xyz(node), mesh.uv(node));
        let j = mesh.embedding().map_or([DVec3::X, DVec3::Y], |embedding| embedding.atlas.at(uv).j);
        let here = ChartPoint { xyz, uv, j };
        Tangent { here, metric: mesh.metric(node), smallest_size: mesh.smallest_size(node), number }
    }

    /// The square of the distance from here to a place.
    fn distance2(&self, to: DVec3) -> f64 {
        let d = to - self.here.xyz;
        let along = self.here.pulled_back(d);
        let across = d - self.here.j[0] * along.x - self.here.j[1] * along.y;
        self.metric.norm2(along) + across.length_squared() / (self.smallest_size * self.smallest_size)
    }

    /// The box around all that is near.
    fn reach(&self) -> Rectangle<[f64; 3]> {
        let Metric2 { uu, uv, vv } = self.metric;
        let ([p, q], det) = (self.here.j, self.metric.det());
        let along = (p * p * vv - p * q * (2.0 * uv) + q * q * uu) / det;
        let reach = (along + DVec3::splat(self.smallest_size * self.smallest_size)).max(DVec3::ZERO);
        let reach = NEAR * DVec3::new(reach.x.sqrt(), reach.y.sqrt(), reach.z.sqrt());
        Rectangle::from_corners((self.here.xyz - reach).to_array(), (self.here.xyz + reach).to_array())
    }
}

impl NodesInSpace {
    /// All nodes of a mesh.
    pub fn of(mesh: &Mesh) -> NodesInSpace {
        let mut numbers: BTreeMap<[u64; 3], usize> = BTreeMap::new();
        let mut nodes = Vec::new();
        for node in mesh.nodes() {
            let next = numbers.len();
            let number = *numbers.entry(mesh.xyz(node).to_array().map(f64::to_bits)).or_insert(next);
            nodes.push(Tangent::of(mesh, node, number));
        }
        let boxes = nodes.iter().enumerate().map(|(k, node)| GeomWithData::new(node.reach(), k)).collect();
        NodesInSpace { tree: RTree::bulk_load(boxes), nodes }
    }

    /// The number of the nearest node that is at a place.
    fn at(&self, place: DVec3) -> Option<usize> {
        let found = self.tree.locate_in_envelope_intersecting(AABB::from_point(place.to_array()));
        let distances = found.map(|item| (self.nodes[item.data].distance2(place), self.nodes[item.data].number));
        let near = distances.filter(|found| found.0 <= NEAR * NEAR);
        near.min_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1))).map(|found| found.1)
    }

    /// The numbers of the nodes at four corners, sorted; `None` where there is no node at one of them.
    pub fn at_corners(&self, corners: [DVec3; 4]) -> Option<[usize; 4]> {
        let mut found = [0; 4];
        for (number, place) in found.iter_mut().zip(corners) {
            *number = self.at(place)?;
        }
        found.sort_unstable();
        Some(found)
    }
}
