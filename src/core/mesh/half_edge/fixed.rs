//! Nodes that neither move nor go: those on boundaries, and hard points inside.

use super::{Mesh, NONE};
use crate::core::mesh::ids::{NodeId, PointId};

/// The bit that marks the output point of a hard point, a fixed node inside.
pub(super) const HARD: u32 = 1 << 31;

impl Mesh {
    /// Whether the node lies on a boundary or is a hard point: it must not be moved or removed.
    #[inline]
    pub fn is_fixed(&self, node: NodeId) -> bool {
        self.point[node.index()] != NONE
    }

    /// Whether the node is a hard point: fixed, but not on a boundary.
    #[inline]
    pub fn is_hard(&self, node: NodeId) -> bool {
        let p = self.point[node.index()];
        p != NONE && p & HARD != 0
    }

    /// Whether the node lies on a boundary.
    #[inline]
    pub fn is_on_boundary(&self, node: NodeId) -> bool {
        self.point[node.index()] & HARD == 0
    }

    /// The output point of a fixed node.
    #[inline]
    pub fn point(&self, node: NodeId) -> Option<PointId> {
        let p = self.point[node.index()];
        (p != NONE).then_some(PointId(p & !HARD))
    }
}
