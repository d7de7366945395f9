//! What one step did: ids and measured values, from which panels, logs, breakpoints and tests derive their text.
//!
//! Serialised, an event is one flat object: `kind` is the name of its [`EventKind`], ids are numbers, angles are in
//! degrees, and a reason is an object of its own with `kind` and, where there is one, `value`.

mod few;
mod kind;
mod reason;

use serde::{Serialize, Serializer};

pub use self::few::FewNodes;
pub use self::kind::{EventKind, WhyKind};
pub use self::reason::{Purpose, SeamCorner, Unmerged, Why};
use super::last_resort::{Means, Outcome};
use crate::core::case::Selection;
use crate::core::front::Side;
use crate::core::mesh::{ElementId, NodeId};

/// A side edge with its angle and deviation, in radians.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SideEdge {
    /// Which side.
    pub side: Side,
    /// Its top node.
    pub node: NodeId,
    /// Its angle with the base.
    #[serde(serialize_with = "degrees")]
    pub angle: f64,
    /// Its deviation from the direction aimed at.
    #[serde(serialize_with = "degrees")]
    pub deviation: f64,
}

/// A change of the topology that clean-up kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum Cleaning {
    /// Two opposite corners of a quadrilateral were merged.
    DiamondCollapsed {
        /// The node removed.
        gone: NodeId,
        /// The node kept.
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
        /// The new node opposite it.
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

/// How a quadrilateral that folded over its surface was repaired.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "how", rename_all = "snake_case")]
pub enum Mending {
    /// Its corners were moved.
    Moved,
    /// An edge of it was rotated.
    Rotated {
        /// The ends of the edge now.
        new: [NodeId; 2],
    },
    /// Two of its corners were merged, which removed it.
    Collapsed {
        /// The merged node.
        kept: NodeId,
    },
    /// A smaller quadrilateral was inserted inside it, with four more between the two.
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
        /// The smallest one on the front (4.3.3, step i).
        h_min: f64,
        /// Number of deferred segments, which cannot be chosen.
        deferred: u32,
        /// Its key: what is held against the reach (docs/algorithm.md, "The selection window").
        key: f64,
        /// The reach, c Hmin.
        reach: f64,
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
        /// The rule that selects; the reach and the classes count for table 1 alone.
        #[serde(serialize_with = "word")]
        selection: Selection,
        /// Whether the user picked it, regardless of its rank.
        picked: bool,
    },
    /// The front segment that the user picked is no longer on the front; the next step selects by the rules.
    PickLost {
        /// Its left node.
        a: NodeId,
        /// Its right node.
        b: NodeId,
    },
    /// The neighbouring front segment serves as the side (side edges ii).
    SideIsFront {
        /// Which side.
        side: Side,
        /// Its top node.
        node: NodeId,
    },
    /// An existing edge was chosen as the side (side edges iii, v).
    SideChosen {
        /// The edge.
        #[serde(flatten)]
        edge: SideEdge,
    },
    /// An edge was swapped to become the side (side edges iv, v).
    SideSwapped {
        /// The edge that the swap made.
        #[serde(flatten)]
        edge: SideEdge,
        /// Deviation of the best existing edge, if there was one.
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
    /// Nodes around the left top were moved, after a swap for the top edge (top edge v).
    TopSmoothed {
        /// Number of nodes.
        nodes: u8,
    },
    /// An edge across the top edge was swapped (top edge iv).
    TopSwapped {
        /// Ends of the edge that lay across.
        across: [NodeId; 2],
        /// Ends of the edge that took its place.
        new: [NodeId; 2],
    },
    /// The top edge exists (top edge vi).
    TopFound {
        /// Its ends.
        ends: [NodeId; 2],
        /// Number of swaps needed.
        swaps: u8,
    },
    /// A node with three or four triangles was removed (fig. 8).
    NodeRemoved {
        /// The node.
        node: NodeId,
        /// Why.
        purpose: Purpose,
    },
    /// A quadrilateral was formed.
    Formed {
        /// Its id.
        element: ElementId,
        /// Its nodes A, B, D, C.
        nodes: [NodeId; 4],
        /// Its quality (docs/algorithm.md, "Quality").
        quality: f64,
        /// Number of triangles merged into it.
        merged: u8,
        /// Its level.
        level: u16,
        /// Which attempt it was, from 0.
        attempt: u8,
        /// The nodes inside it, which were removed with the triangles.
        swallowed: FewNodes,
    },
    /// An attempt was rolled back.
    RolledBack {
        /// Which attempt, from 0.
        attempt: u8,
        /// Why.
        why: Why,
    },
    /// All attempts failed: the segment is deferred until something near it changes.
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
        /// Number of nodes.
        nodes: u8,
    },
    /// Two front segments were seamed (4.3.6, fig. 18).
    Seamed {
        /// The node between them.
        at: NodeId,
        /// The node into which the two other ends were merged.
        node: NodeId,
        /// The one of the two that was removed.
        gone: NodeId,
        /// What was looked at.
        #[serde(flatten)]
        corner: SeamCorner,
    },
    /// Two front segments of unequal length were seamed: the longer one was divided first (4.3.6).
    TransitionSeamed {
        /// The node between them.
        at: NodeId,
        /// The node into which the other end of the shorter one and the midpoint of the longer one were merged.
        node: NodeId,
        /// The one of the two that was removed.
        gone: NodeId,
        /// What was looked at.
        #[serde(flatten)]
        corner: SeamCorner,
    },
    /// Two front segments with a small angle were not seamed.
    SeamRefused {
        /// The node between them.
        at: NodeId,
        /// Their other ends.
        ends: [NodeId; 2],
        /// What was looked at.
        #[serde(flatten)]
        corner: SeamCorner,
        /// Why.
        why: Unmerged,
    },
    /// The front was split at a slender element (4.3.6, fig. 19).
    Split {
        /// The node into which two were merged.
        node: NodeId,
        /// The node of the two that was removed.
        gone: NodeId,
        /// Metric area of the element.
        area: f64,
        /// Its width divided by its height.
        ratio: f64,
        /// Segments of the two loops that the split alone makes of one.
        segments: [u32; 2],
    },
    /// There are slender triangles around the new quadrilateral, and the front was not split at any of them.
    SplitRefused {
        /// The quadrilateral.
        element: ElementId,
        /// Number of triangles around it with all nodes on the front: the paper's T.
        on_front: u8,
        /// Number of slender ones among them: the paper's V.
        slender: u8,
        /// Why the collapse of the first edge that leaves two even loops was refused; none where no edge does.
        why: Option<Unmerged>,
    },
    /// A small loop was closed (docs/algorithm.md, "Small loops").
    Closed {
        /// Number of its segments.
        segments: u8,
        /// Number of quadrilaterals that fill it.
        quads: u8,
        /// The worst quality of the elements around.
        quality: f64,
    },
    /// Every segment is deferred: all are tried again with wider gates.
    SecondPass,
    /// The triangles of a remaining component were matched (docs/algorithm.md, "The last resort", steps 1 to 3).
    Matched {
        /// Number of its triangles.
        triangles: usize,
        /// Triangles without a partner after the matching of convex pairs.
        unmatched: usize,
        /// Triangles without a partner after the matching over all inner edges.
        unmatched_at_all: usize,
        /// Number of steps that convert the component to quadrilaterals.
        patches: usize,
    },
    /// The last resort converted a few triangles to quadrilaterals (docs/algorithm.md, "The last resort", steps 4 and
    /// 5).
    Patched {
        /// How.
        means: Means,
        /// Number of triangles before.
        triangles: usize,
        /// Number of quadrilaterals after.
        quads: usize,
        /// The first of them.
        element: ElementId,
    },
    /// The last resort has converted all remaining triangles.
    LastResort(Outcome),
    /// The topology was cleaned up at one place (4.3.7).
    Cleaned {
        /// How.
        #[serde(flatten)]
        what: Cleaning,
        /// Energy of the neighbourhood, before and after.
        energy: [f64; 2],
    },
    /// The quadrilaterals of a cavity were replaced by others (4.3.7; docs/algorithm.md, "Cavities").
    Refilled {
        /// Edges of the sides of the cavity, anticlockwise.
        #[serde(serialize_with = "present")]
        sides: [u32; 6],
        /// Number of quadrilaterals, before and after.
        quads: [u32; 2],
        /// Number of irregular nodes in it and on its border, before and after.
        irregular: [u32; 2],
        /// Energy of the cavity and its neighbourhood, before and after.
        energy: [f64; 2],
    },
    /// A row at the walls was laid on their normals (docs/algorithm.md, "Rows at walls").
    RowLaid {
        /// Its number, from 1 at the wall.
        row: u32,
        /// Number of its nodes.
        nodes: u32,
        /// Of those, how many stand on the normal at the height asked for.
        laid: u32,
        /// Mean angle between its edges across and the normals, before and after.
        #[serde(serialize_with = "both_degrees")]
        lean: [f64; 2],
    },
    /// Free nodes were smoothed by minimising the energy (4.3.7).
    Swept {
        /// Number of nodes examined.
        looked: u32,
        /// Number of nodes that moved.
        moved: u32,
    },
    /// A quadrilateral that folded over its surface was repaired.
    Unfolded {
        /// Its id.
        element: ElementId,
        /// How.
        #[serde(flatten)]
        how: Mending,
        /// The smallest sine of its corners in space before, and of those around it after.
        sine: [f64; 2],
    },
    /// A face is converted; the next one follows.
    FaceConverted {
        /// Its region.
        region: u32,
    },
    /// The whole mesh, or the current face, is cleaned up and smoothed (4.3.7).
    PostProcessed,
    /// The mirror image of the half that was converted was added and joined to it (docs/algorithm.md, "Symmetry").
    Mirrored {
        /// Number of quadrilaterals added.
        quads: usize,
        /// Number of nodes added.
        nodes: usize,
        /// Number of nodes on the mirror line, which are their own images or have them at the same place.
        on_line: usize,
    },
    /// The conversion is finished.
    Finished,
}

impl Event {
    /// Whether it changed the surroundings of the last quadrilateral (4.3.6).
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

    /// Whether it says what became of slender triangles on the front (4.3.6). The mesh was then judged as it was before
    /// the step: what the step found nothing to do about comes before that in the same step.
    pub fn is_about_a_split(&self) -> bool {
        matches!(self, Event::Split { .. } | Event::SplitRefused { .. })
    }
}

pub(super) fn degrees<S: Serializer>(radians: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    radians.to_degrees().serialize(serializer)
}

/// Writes the sides that are present, as a list.
fn present<S: Serializer>(sides: &[u32; 6], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(sides.iter().filter(|&&edges| edges > 0))
}

fn degrees_if_any<S: Serializer>(radians: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    radians.map(f64::to_degrees).serialize(serializer)
}

fn word<S: Serializer>(selection: &Selection, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(selection.word())
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
        let cleaned = serde_json::to_string(&Event::Cleaned { what, energy: [2.0, 1.5] }).unwrap();
        assert_eq!(cleaned, r#"{"kind":"cleaned","what":"diamond_collapsed","gone":7,"kept":8,"energy":[2.0,1.5]}"#);
    }
}
