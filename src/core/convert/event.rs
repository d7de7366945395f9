//! What one step did: ids and measured values, from which panels, logs, breakpoints and tests make their words.
//!
//! Serialised, an event is one flat object: `kind` as [`Event::kind`] says it, ids as numbers, angles in degrees, a
//! reason as an object of its own with `kind` and, where there is one, `value`.

use serde::{Serialize, Serializer};

use super::last_resort::{Means, Outcome};
use crate::core::front::sector::Side;
use crate::core::mesh::ids::{ElementId, NodeId};

/// Why an attempt to form a quadrilateral was taken back.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", content = "value", rename_all = "snake_case")]
pub enum Why {
    /// No edge can serve as this side.
    NoSide(Side),
    /// The side edge cannot be divided where it must be.
    NoDivision(Side),
    /// A dead edge lies across the top edge.
    TopBlocked([NodeId; 2]),
    /// A node lies on the top edge.
    TopThroughNode(NodeId),
    /// The swaps of the recovery came to no end.
    TopTooLong,
    /// A new side or the top is longer than the gate, in the metric.
    TooLong(f64),
    /// The four sides do not enclose a disc of live triangles.
    NotDisc,
    /// The quadrilateral is not strictly convex.
    NotConvex,
    /// Its quality is below the gate.
    Poor(f64),
    /// A loop would become odd; its number of segments.
    OddLoop(usize),
    /// The field gives no metric at a new node.
    NoMetric,
}

/// Why two nodes of the front were not made one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", content = "value", rename_all = "snake_case")]
pub enum Unmerged {
    /// Both nodes are fixed.
    BothFixed,
    /// The longer segment is too long, and cannot be divided: it is on a boundary, or the front is beyond already.
    Unlike,
    /// A node would be left with two edges.
    Doublet,
    /// The edge between the two nodes cannot be recovered.
    NotRecovered,
    /// Something lies between the two segments.
    NotEmpty,
    /// An element would not be positive, or what is apart be glued.
    NotPositive,
    /// An element would have this quality, too much below what was.
    Poor(f64),
}

/// Why a node was removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Purpose {
    /// It stood in the way of a swap of the top edge's recovery (4.3.4, top edge iii).
    Recovery,
    /// Local structural enhancement (4.3.6, i).
    Enhancement,
}

/// A side edge, its angle, and how good that is. Angles in radians.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SideEdge {
    /// Which side.
    pub side: Side,
    /// Its top node.
    pub node: NodeId,
    /// Its angle with the base.
    #[serde(serialize_with = "degrees")]
    pub angle: f64,
    /// How far that is from the direction aimed at.
    #[serde(serialize_with = "degrees")]
    pub deviation: f64,
}

/// A change of the structure that clean-up kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum Cleaning {
    /// Two opposite corners of a quadrilateral became one.
    DiamondCollapsed {
        /// The one that is no more.
        gone: NodeId,
        /// The other.
        kept: NodeId,
    },
    /// The edge between two quadrilaterals was rotated.
    EdgeRotated {
        /// Its ends before.
        old: [NodeId; 2],
        /// Its ends after.
        new: [NodeId; 2],
    },
    /// A node was opened along two of its edges into a quadrilateral.
    VertexOpened {
        /// The node.
        node: NodeId,
        /// The new node opposite to it.
        new: NodeId,
        /// The other ends of the edges.
        along: [NodeId; 2],
    },
    /// A node between two quadrilaterals was removed.
    DoubletRemoved {
        /// The node.
        node: NodeId,
    },
}

/// How a quadrilateral that folded over its surface was mended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "how", rename_all = "snake_case")]
pub enum Mending {
    /// Its corners were moved.
    Moved,
    /// An edge of it was rotated.
    Rotated {
        /// The ends that the edge has now.
        new: [NodeId; 2],
    },
    /// Two of its corners became one, and it is no more.
    Collapsed {
        /// The node that they are.
        kept: NodeId,
    },
    /// A smaller quadrilateral was inlaid, with four between the two.
    Pillowed {
        /// Its nodes.
        inner: [NodeId; 4],
    },
}

/// What a step of the converter did or decided. Angles in radians.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Event {
    /// A base segment was selected (4.3.3).
    BaseSelected {
        /// Its left node.
        a: NodeId,
        /// Its right node.
        b: NodeId,
        /// Its H-value (eq. 6).
        h_value: f64,
        /// The smallest one on the front.
        h_min: f64,
        /// Its class of table 1.
        class: u8,
        /// Frontal angles at A and B.
        #[serde(serialize_with = "both_degrees")]
        theta: [f64; 2],
        /// Metric length.
        length_metric: f64,
        /// Physical length.
        length_physical: f64,
        /// Rows from the boundary.
        level: u16,
        /// Whether it is within c Hmin.
        within_reach: bool,
        /// Whether a person picked it, whatever its rank.
        picked: bool,
    },
    /// The front segment that a person picked is not on the front any more; the next step selects by the rules.
    PickLost {
        /// Its left node.
        a: NodeId,
        /// Its right node.
        b: NodeId,
    },
    /// The neighbouring front segment is the side (side edges ii).
    SideIsFront {
        /// Which side.
        side: Side,
        /// Its top node.
        node: NodeId,
    },
    /// An edge that is there was chosen as side (side edges iii, v).
    SideChosen {
        /// The edge.
        #[serde(flatten)]
        edge: SideEdge,
    },
    /// An edge was swapped to be the side (side edges iv, v).
    SideSwapped {
        /// The edge that the swap has made.
        #[serde(flatten)]
        edge: SideEdge,
        /// Deviation of the best edge that was there, if there was one.
        #[serde(serialize_with = "degrees_if_any")]
        instead_of: Option<f64>,
    },
    /// The side edge was divided (side edges vi).
    SideDivided {
        /// Which side.
        side: Side,
        /// The new top node.
        node: NodeId,
        /// Metric length before.
        length: f64,
    },
    /// An edge across the top edge was swapped (top edge iv).
    TopSwapped {
        /// Ends of the edge that lay across.
        across: [NodeId; 2],
        /// Ends of the edge that took its place.
        new: [NodeId; 2],
    },
    /// The top edge is there (top edge vi).
    TopFound {
        /// Its ends.
        ends: [NodeId; 2],
        /// Swaps that it took.
        swaps: u8,
    },
    /// A node with three or four triangles was removed (fig. 8).
    NodeRemoved {
        /// The node.
        node: NodeId,
        /// Why.
        purpose: Purpose,
    },
    /// A quadrilateral stands.
    Formed {
        /// Its id.
        element: ElementId,
        /// Its nodes A, B, D, C.
        nodes: [NodeId; 4],
        /// Its quality (docs/algorithm.md, "Quality").
        quality: f64,
        /// Triangles that it ate.
        eaten: u8,
        /// Its level.
        level: u16,
        /// Which attempt it was, from 0.
        attempt: u8,
    },
    /// An attempt was taken back.
    RolledBack {
        /// Which attempt, from 0.
        attempt: u8,
        /// Why.
        why: Why,
    },
    /// All attempts failed: the segment is put off until something near it changes.
    Deferred {
        /// Its left node.
        a: NodeId,
        /// Its right node.
        b: NodeId,
    },
    /// An edge near the new quadrilateral was swapped (4.3.6, enhancement ii).
    Enhanced {
        /// Ends of the new edge.
        new: [NodeId; 2],
    },
    /// Nodes around the new quadrilateral were moved (4.3.6, eqs. 9 and 10).
    Smoothed {
        /// How many.
        nodes: u8,
    },
    /// Two front segments were seamed (4.3.6, fig. 18).
    Seamed {
        /// The node between them.
        at: NodeId,
        /// The node that both other ends became.
        node: NodeId,
        /// The frontal angle that was.
        #[serde(serialize_with = "degrees")]
        angle: f64,
    },
    /// Two front segments of unlike length were seamed: the longer one was divided before (4.3.6).
    TransitionSeamed {
        /// The node between them.
        at: NodeId,
        /// The node that the other end of the shorter one and the middle of the longer one became.
        node: NodeId,
        /// The frontal angle that was.
        #[serde(serialize_with = "degrees")]
        angle: f64,
        /// Length of the longer one over that of the shorter.
        ratio: f64,
    },
    /// Two front segments with a small angle were not seamed.
    SeamRefused {
        /// The node between them.
        at: NodeId,
        /// Their other ends.
        ends: [NodeId; 2],
        /// The frontal angle.
        #[serde(serialize_with = "degrees")]
        angle: f64,
        /// Length of the longer one over that of the shorter.
        ratio: f64,
        /// Why.
        why: Unmerged,
    },
    /// The front was split at a slender element (4.3.6, fig. 19).
    Split {
        /// The node that two became.
        node: NodeId,
        /// The one of them that is gone.
        gone: NodeId,
        /// Metric area of the element.
        area: f64,
        /// Its width over its height.
        ratio: f64,
        /// Segments of the two loops, where nothing else had become of the one.
        segments: [u32; 2],
    },
    /// A small loop was closed (docs/algorithm.md, "Small loops").
    Closed {
        /// Its segments.
        segments: u8,
        /// Quadrilaterals over it.
        quads: u8,
        /// The worst quality around.
        quality: f64,
    },
    /// Every segment is put off: all are taken up again with wider gates.
    SecondPass,
    /// The triangles of a component that was left over were matched (docs/algorithm.md, "The last resort", steps 1 to
    /// 3).
    Matched {
        /// Its triangles.
        triangles: usize,
        /// Those without a partner after the matching of convex pairs.
        unmatched: usize,
        /// Those without a partner after that over all inner edges.
        unmatched_at_all: usize,
        /// Steps in which the component becomes quadrilaterals.
        patches: usize,
    },
    /// The last resort made quadrilaterals of a few triangles (docs/algorithm.md, "The last resort", steps 4 and 5).
    Patched {
        /// How.
        means: Means,
        /// Triangles before.
        triangles: usize,
        /// Quadrilaterals after.
        quads: usize,
        /// The first of them.
        element: ElementId,
    },
    /// The last resort has converted all that was left over.
    LastResort(Outcome),
    /// The structure was cleaned up at one place (4.3.7).
    Cleaned {
        /// How.
        #[serde(flatten)]
        what: Cleaning,
        /// What came after it, where the first change is good only together with others.
        #[serde(serialize_with = "those_there")]
        then: [Option<Cleaning>; 3],
        /// Energy of everything around, before and after.
        energy: [f64; 2],
    },
    /// Free nodes were smoothed by the energy (4.3.7).
    Swept {
        /// Nodes that were looked at.
        looked: u32,
        /// Nodes that moved.
        moved: u32,
    },
    /// A quadrilateral that folded over its surface was mended.
    Unfolded {
        /// Its id.
        element: ElementId,
        /// How.
        #[serde(flatten)]
        how: Mending,
        /// The least sine of its corners in space before, and of those around after.
        sine: [f64; 2],
    },
    /// A face is converted: the next one is turned to.
    FaceConverted {
        /// Its region.
        region: u32,
    },
    /// The whole mesh, or the face at hand, is cleaned up and smoothed (4.3.7).
    PostProcessed,
    /// All is done.
    Finished,
}

impl Event {
    /// All kinds, in the order of the variants.
    pub const KINDS: &[&str] = &[
        "base_selected",
        "pick_lost",
        "side_is_front",
        "side_chosen",
        "side_swapped",
        "side_divided",
        "top_swapped",
        "top_found",
        "node_removed",
        "formed",
        "rolled_back",
        "deferred",
        "enhanced",
        "smoothed",
        "seamed",
        "transition_seamed",
        "seam_refused",
        "split",
        "closed",
        "second_pass",
        "matched",
        "patched",
        "last_resort",
        "cleaned",
        "swept",
        "unfolded",
        "face_converted",
        "post_processed",
        "finished",
    ];

    /// Whether it changed what is around the last quadrilateral (4.3.6).
    pub fn is_local_change(&self) -> bool {
        matches!(
            self,
            Event::NodeRemoved { purpose: Purpose::Enhancement, .. }
                | Event::Enhanced { .. }
                | Event::Smoothed { .. }
                | Event::Seamed { .. }
                | Event::TransitionSeamed { .. }
                | Event::Split { .. }
        )
    }

    /// The kind, as reports and breakpoints name it.
    pub fn kind(&self) -> &'static str {
        match self {
            Event::BaseSelected { .. } => "base_selected",
            Event::PickLost { .. } => "pick_lost",
            Event::SideIsFront { .. } => "side_is_front",
            Event::SideChosen { .. } => "side_chosen",
            Event::SideSwapped { .. } => "side_swapped",
            Event::SideDivided { .. } => "side_divided",
            Event::TopSwapped { .. } => "top_swapped",
            Event::TopFound { .. } => "top_found",
            Event::NodeRemoved { .. } => "node_removed",
            Event::Formed { .. } => "formed",
            Event::RolledBack { .. } => "rolled_back",
            Event::Deferred { .. } => "deferred",
            Event::Enhanced { .. } => "enhanced",
            Event::Smoothed { .. } => "smoothed",
            Event::Seamed { .. } => "seamed",
            Event::TransitionSeamed { .. } => "transition_seamed",
            Event::SeamRefused { .. } => "seam_refused",
            Event::Split { .. } => "split",
            Event::Closed { .. } => "closed",
            Event::SecondPass => "second_pass",
            Event::Matched { .. } => "matched",
            Event::Patched { .. } => "patched",
            Event::LastResort(_) => "last_resort",
            Event::Cleaned { .. } => "cleaned",
            Event::Swept { .. } => "swept",
            Event::Unfolded { .. } => "unfolded",
            Event::FaceConverted { .. } => "face_converted",
            Event::PostProcessed => "post_processed",
            Event::Finished => "finished",
        }
    }
}

pub(super) fn degrees<S: Serializer>(radians: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    radians.to_degrees().serialize(serializer)
}

/// A list of those that there are.
fn those_there<S: Serializer>(all: &[Option<Cleaning>; 3], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(all.iter().flatten())
}

fn degrees_if_any<S: Serializer>(radians: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    radians.map(f64::to_degrees).serialize(serializer)
}

fn both_degrees<S: Serializer>(radians: &[f64; 2], serializer: S) -> Result<S::Ok, S::Error> {
    radians.map(f64::to_degrees).serialize(serializer)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn an_event_is_one_flat_object_with_its_kind_and_angles_in_degrees() {
        let node = NodeId(7);
        let edge = SideEdge { side: Side::Left, node, angle: FRAC_PI_2, deviation: 0.0 };
        let chosen = Event::SideChosen { edge };
        let json = serde_json::to_string(&chosen).unwrap();
        let expected = r#"{"kind":"side_chosen","side":"left","node":7,"angle":90.0,"deviation":0.0}"#;
        assert_eq!(json, expected);
        let json = |why| serde_json::to_string(&Event::RolledBack { attempt: 1, why }).unwrap();
        assert_eq!(json(Why::NotDisc), r#"{"kind":"rolled_back","attempt":1,"why":{"kind":"not_disc"}}"#);
        let blocked = r#"{"kind":"rolled_back","attempt":1,"why":{"kind":"top_blocked","value":[7,8]}}"#;
        assert_eq!(json(Why::TopBlocked([node, NodeId(8)])), blocked);
        let what = Cleaning::DiamondCollapsed { gone: node, kept: NodeId(8) };
        let cleaned = serde_json::to_string(&Event::Cleaned { what, then: [None; 3], energy: [2.0, 1.5] }).unwrap();
        assert_eq!(
            cleaned,
            r#"{"kind":"cleaned","what":"diamond_collapsed","gone":7,"kept":8,"then":[],"energy":[2.0,1.5]}"#
        );
    }

    #[test]
    fn the_kind_is_the_same_in_a_file_as_in_a_report() {
        let (node, ends, side) = (NodeId(1), [NodeId(1), NodeId(2)], Side::Right);
        let theta = [1.0; 2];
        let edge = SideEdge { side, node, angle: 1.0, deviation: 0.1 };
        let events = [
            Event::BaseSelected {
                a: node,
                b: node,
                h_value: 1.0,
                h_min: 1.0,
                class: 1,
                theta,
                length_metric: 1.0,
                length_physical: 1.0,
                level: 0,
                within_reach: true,
                picked: false,
            },
            Event::PickLost { a: node, b: node },
            Event::SideIsFront { side, node },
            Event::SideChosen { edge },
            Event::SideSwapped { edge, instead_of: Some(0.2) },
            Event::SideDivided { side, node, length: 1.0 },
            Event::TopSwapped { across: ends, new: ends },
            Event::TopFound { ends, swaps: 0 },
            Event::NodeRemoved { node, purpose: Purpose::Recovery },
            Event::Formed { element: ElementId(1), nodes: [node; 4], quality: 1.0, eaten: 2, level: 0, attempt: 0 },
            Event::Deferred { a: node, b: node },
            Event::Enhanced { new: ends },
            Event::Smoothed { nodes: 4 },
            Event::Seamed { at: node, node, angle: 0.5 },
            Event::TransitionSeamed { at: node, node, angle: 0.5, ratio: 3.0 },
            Event::SeamRefused { at: node, ends, angle: 0.5, ratio: 1.0, why: Unmerged::BothFixed },
            Event::Split { node, gone: node, area: 0.1, ratio: 6.0, segments: [4, 6] },
            Event::Closed { segments: 4, quads: 1, quality: 0.5 },
            Event::SecondPass,
            Event::Matched { triangles: 8, unmatched: 2, unmatched_at_all: 0, patches: 4 },
            Event::Patched { means: Means::Merge, triangles: 2, quads: 1, element: ElementId(1) },
            Event::LastResort(Outcome::default()),
            Event::Cleaned { what: Cleaning::DoubletRemoved { node }, then: [None; 3], energy: [2.0, 1.0] },
            Event::Swept { looked: 9, moved: 3 },
            Event::PostProcessed,
            Event::Finished,
        ];
        for event in events {
            assert_eq!(serde_json::to_value(event).unwrap()["kind"], event.kind());
            assert!(Event::KINDS.contains(&event.kind()), "{} is missing in the list of all kinds", event.kind());
        }
    }
}
