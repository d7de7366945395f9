//! Whether a mesh is its own mirror image, counted at its points.

use std::collections::BTreeSet;

use glam::DVec2;
use serde::Serialize;

use crate::core::geometry::Mirror;
use crate::core::kernel::number::grouped;
use crate::core::record::export::Export;

/// The nodes of a mesh that have a mirror image: another node, or on the line themselves, at exactly its place.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct SymmetryRecord {
    /// The axis to which the mirror line is perpendicular: "x" or "y".
    pub axis: String,
    /// The coordinate of the line along this axis.
    pub at: f64,
    /// Number of nodes that have an image.
    pub mirrored: usize,
    /// Number of all nodes.
    pub nodes: usize,
}

impl SymmetryRecord {
    /// Counts the nodes of a mesh.
    pub fn of(export: &Export, mirror: &Mirror) -> SymmetryRecord {
        // Adding zero turns -0 into 0.
        let bits = |p: DVec2| [p.x, p.y].map(|x| (x + 0.0).to_bits());
        let points = || export.file.points.iter().map(|p| p.truncate());
        let known: BTreeSet<[u64; 2]> = points().map(bits).collect();
        SymmetryRecord {
            axis: mirror.axis().word().to_owned(),
            at: mirror.position(),
            mirrored: points().filter(|&p| known.contains(&bits(mirror.image(p)))).count(),
            nodes: points().count(),
        }
    }

    /// In words: "x, 1 200 of 1 200 nodes have an image".
    pub(super) fn text(&self) -> String {
        let [mirrored, nodes] = [self.mirrored, self.nodes].map(|n| grouped(n as u64));
        format!("{}, {mirrored} of {nodes} nodes have an image", self.axis)
    }
}
