//! The geometry of a mesh in space: the surfaces of its faces, and the positions, normals and sizes of its nodes.

use std::sync::Arc;

use glam::DVec3;
use smallvec::SmallVec;

use super::Mesh;
use crate::core::geometry::Atlas;
use crate::core::kernel::Metric2;
use crate::core::mesh::ids::{ElementId, NodeId};
use crate::core::metric::measure::angles_in_space;

/// The surfaces on which a mesh lies, and the positions of its boundary points in space, which all faces share.
#[derive(Debug)]
pub struct Embedding {
    /// The charts of all faces.
    pub atlas: Arc<Atlas>,
    /// The position of each output point of a fixed node.
    pub points: Vec<DVec3>,
}

impl Mesh {
    /// Places the mesh on surfaces.
    pub fn set_embedding(&mut self, embedding: Arc<Embedding>) {
        self.embedding = Some(embedding);
    }

    /// The surfaces on which it lies; `None` in the plane.
    pub fn embedding(&self) -> Option<&Arc<Embedding>> {
        self.embedding.as_ref()
    }

    /// The position of a node in space; z is 0 in the plane.
    pub fn xyz(&self, node: NodeId) -> DVec3 {
        match (&self.embedding, self.point(node)) {
            (None, _) => self.uv(node).extend(0.0),
            (Some(embedding), Some(point)) => embedding.points[point.index()],
            (Some(embedding), None) => embedding.atlas.xyz(self.uv(node)),
        }
    }

    /// The angles of an element in space, between straight sides, in radians and in the order of its corners.
    pub fn angles_in_space(&self, element: ElementId) -> SmallVec<[f64; 4]> {
        let corners: SmallVec<[DVec3; 4]> = self.corners(element).map(|n| self.xyz(n)).collect();
        angles_in_space(&corners).collect()
    }

    /// The unit normal of the surface at a node; z in the plane.
    pub fn normal(&self, node: NodeId) -> DVec3 {
        self.embedding.as_ref().map_or(DVec3::Z, |embedding| embedding.atlas.at(self.uv(node)).normal())
    }

    /// The first fundamental form at a node: lengths and angles in space of what lies in its tangent plane.
    pub fn first_form(&self, node: NodeId) -> Metric2 {
        match &self.embedding {
            None => Metric2 { uu: 1.0, uv: 0.0, vv: 1.0 },
            Some(embedding) => embedding.atlas.at(self.uv(node)).first_form(),
        }
    }

    /// The smallest target size at a node, in units of length: on surfaces that of the intrinsic eigenvalues, of M
    /// against `J^T J` (docs/algorithm.md, "The H-value").
    #[inline]
    pub fn smallest_size(&self, node: NodeId) -> f64 {
        match &self.embedding {
            None => self.metric_ref(node).min_size(),
            Some(embedding) => self.metric_ref(node).min_size_against(&embedding.atlas.at(self.uv(node)).first_form()),
        }
    }

    /// [`smallest_size`](Mesh::smallest_size) and [`xyz`](Mesh::xyz), with one look at the surface.
    #[inline]
    pub fn size_and_xyz(&self, node: NodeId) -> (f64, DVec3) {
        let (uv, metric) = self.place(node);
        let Some(embedding) = &self.embedding else { return (metric.min_size(), uv.extend(0.0)) };
        let at = embedding.atlas.at(uv);
        let xyz = self.point(node).map_or(at.xyz, |point| embedding.points[point.index()]);
        (metric.min_size_against(&at.first_form()), xyz)
    }

    /// The distance of two nodes in space.
    pub fn physical_distance(&self, a: NodeId, b: NodeId) -> f64 {
        match &self.embedding {
            None => self.uv(a).distance(self.uv(b)),
            Some(_) => self.xyz(a).distance(self.xyz(b)),
        }
    }
}
