//! Reasons that events carry.

use serde::Serialize;

use super::degrees;
use crate::core::front::Side;
use crate::core::mesh::NodeId;

/// Why an attempt to form a quadrilateral was rolled back.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", content = "value", rename_all = "snake_case")]
pub enum Why {
    /// No edge can serve as this side.
    NoSide(Side),
    /// The side edge cannot be divided: it is dead or too short, or the place of division is not valid.
    NoDivision(Side),
    /// A dead edge lies across the top edge.
    TopBlocked([NodeId; 2]),
    /// A node lies on the top edge.
    TopThroughNode(NodeId),
    /// No swap and no removal of a node recovers the top edge, or too many would be needed.
    TopTooLong,
    /// None of the edges across the top edge can be swapped, and no node there removed.
    TopStuck,
    /// A new side or the top is longer than the gate allows, in the metric.
    TooLong(f64),
    /// The four sides do not enclose a disc of live triangles.
    NotDisc,
    /// The quadrilateral is not strictly convex.
    NotConvex,
    /// Its quality is below the gate.
    Poor(f64),
    /// A loop would become odd; its number of segments.
    OddLoop(usize),
    /// The metric field has no value at a new node.
    NoMetric,
}

/// Why two nodes of the front were not merged.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", content = "value", rename_all = "snake_case")]
pub enum Unmerged {
    /// Both nodes are fixed.
    BothFixed,
    /// The longer segment is too long and cannot be divided: it is on a boundary, or the front is already beyond it.
    Unlike,
    /// A node would be left with two edges.
    Doublet,
    /// The edge between the two nodes cannot be recovered.
    NotRecovered,
    /// Something lies between the two segments.
    NotEmpty,
    /// An element would not be positive, or separate parts would be glued together.
    NotPositive,
    /// An element would be too poor.
    Poor {
        /// Its quality.
        quality: f64,
        /// The least quality that is allowed there.
        least: f64,
    },
}

/// Two adjacent front segments as seaming looks at them (4.3.6; docs/algorithm.md, "Seaming").
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SeamCorner {
    /// The frontal angle between them, radians.
    #[serde(serialize_with = "degrees")]
    pub angle: f64,
    /// The bound `theta_seam`.
    #[serde(serialize_with = "degrees")]
    pub theta_seam: f64,
    /// The widest angle that is seamed there: `theta_seam`, or up to `seam_widening` times that.
    #[serde(serialize_with = "degrees")]
    pub widest: f64,
    /// The mean length in the metric of three segments on each side of the node, these two and the next ones.
    pub length: f64,
    /// Length of the longer one divided by that of the shorter one.
    pub ratio: f64,
}

/// Why a node was removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Purpose {
    /// It blocked a swap in the recovery of the top edge (4.3.4, top edge iii).
    Recovery,
    /// Local structural enhancement (4.3.6, i).
    Enhancement,
}
