//! Where the converter stands between two steps: exactly what the next step needs.

use std::sync::Arc;

use smallvec::SmallVec;

use super::last_resort::Plan;
use super::last_resort::component::Component;
use crate::core::front::Side;
use crate::core::mesh::{ElementId, HalfEdgeId, Mark, Mesh, NodeId};

/// The base segment of the quadrilateral at hand. Its half-edge changes with every swap beside it: nodes name it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Base {
    /// Left node.
    pub a: NodeId,
    /// Right node.
    pub b: NodeId,
    /// Frontal angles at both.
    pub theta: [f64; 2],
    /// Metric length.
    pub length: f64,
    /// Level of the segment, and so of the quadrilateral.
    pub level: u16,
}

impl Base {
    /// Its node at a side.
    pub fn node(&self, side: Side) -> NodeId {
        match side {
            Side::Left => self.a,
            Side::Right => self.b,
        }
    }

    /// Its half-edge in its live triangle.
    pub fn half_edge(&self, mesh: &Mesh) -> Option<HalfEdgeId> {
        mesh.front_between(self.a, self.b)
    }
}

/// One way to try to form the quadrilateral of a base segment (docs/algorithm.md, "Rescue").
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attempt {
    /// Its place in the order of attempts, from 0.
    pub number: u8,
    /// Sides to be divided whatever their length.
    pub divide: [bool; 2],
    /// Tops that are laid down.
    pub tops: [Option<NodeId>; 2],
    /// What to take back to when it fails.
    pub mark: Mark,
}

/// A part of the post-processing (4.3.7).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FinishPart {
    /// Smoothing of all that the front has left.
    FirstSmoothing,
    /// Clean-up of the structure.
    CleanUp,
    /// Laying of the rows at walls (docs/algorithm.md, "Rows at walls").
    Rows,
    /// Smoothing of the final structure.
    LastSmoothing,
    /// Mending of what folds over its surface, when every face is converted.
    Unfolding,
}

/// Where the converter stands.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Phase {
    /// A base segment is to be selected.
    Select,
    /// A side is to be prepared; the left one comes first.
    PrepareSide {
        /// The base.
        base: Base,
        /// The attempt.
        attempt: Attempt,
        /// Which side.
        side: Side,
        /// The left top, where it is prepared.
        left: Option<NodeId>,
    },
    /// A side may have to be divided.
    DivideSide {
        /// The base.
        base: Base,
        /// The attempt.
        attempt: Attempt,
        /// Which side.
        side: Side,
        /// Tops, as far as they are known (the side at hand included).
        tops: [Option<NodeId>; 2],
    },
    /// The top edge is to be recovered.
    RecoverTop {
        /// The base.
        base: Base,
        /// The attempt.
        attempt: Attempt,
        /// Tops C and D.
        tops: [NodeId; 2],
        /// Swaps done so far.
        swaps: u8,
        /// Whether the nodes around C are to be smoothed first (top edge v).
        smooths: bool,
    },
    /// The quadrilateral is to be formed.
    Form {
        /// The base.
        base: Base,
        /// The attempt.
        attempt: Attempt,
        /// Tops C and D.
        tops: [NodeId; 2],
    },
    /// Every attempt has failed: the segment is to be deferred.
    Defer {
        /// The base.
        base: Base,
    },
    /// The local mesh is to be enhanced.
    Enhance {
        /// The new quadrilateral.
        element: ElementId,
        /// What the queue has not seen begins here.
        mark: Mark,
        /// Edges still to be looked at.
        edges: SmallVec<[HalfEdgeId; 24]>,
        /// Swaps left.
        budget: u8,
    },
    /// Nodes around the new quadrilateral are to be smoothed.
    Smooth {
        /// The new quadrilateral.
        element: ElementId,
        /// What the queue has not seen begins here.
        mark: Mark,
    },
    /// Small frontal angles at these nodes are to be seamed.
    Seam {
        /// The new quadrilateral.
        element: ElementId,
        /// Nodes to look at.
        nodes: SmallVec<[NodeId; 8]>,
    },
    /// The front may have to be split at a slender triangle.
    Split {
        /// The new quadrilateral.
        element: ElementId,
    },
    /// Small loops that are left over are to be closed.
    Close {
        /// Components to look at, the next one last.
        waiting: Vec<Component>,
        /// Those that could not be closed: they go to the last resort.
        left: Vec<Component>,
    },
    /// The triangles of the next component that is left over are to be matched (docs/algorithm.md, "The last resort").
    Match {
        /// What is left over.
        left: Arc<[Component]>,
        /// The next one of them.
        at: usize,
    },
    /// The component at hand is to be made quadrilaterals, patch by patch.
    Patch {
        /// What is left over.
        left: Arc<[Component]>,
        /// Which one of them is at hand.
        at: usize,
        /// What is to be done with it.
        plan: Arc<Plan>,
        /// The next patch.
        patch: usize,
    },
    /// Clean-up and smoothing of the whole mesh.
    PostProcess {
        /// Which part of it is under way.
        part: FinishPart,
    },
    /// The face at hand is converted; the next one follows.
    NextFace,
    /// The half of a symmetric domain is converted; its mirror image is to be added.
    Mirror,
    /// Nothing is left to do.
    Done,
}

impl Phase {
    /// The base segment of the quadrilateral at hand, from its selection until it stands or is deferred.
    pub fn base(&self) -> Option<&Base> {
        match self {
            Phase::PrepareSide { base, .. }
            | Phase::DivideSide { base, .. }
            | Phase::RecoverTop { base, .. }
            | Phase::Form { base, .. }
            | Phase::Defer { base } => Some(base),
            _ => None,
        }
    }

    /// The last quadrilateral, while its local post-processing (4.3.6) is under way.
    pub fn last_formed(&self) -> Option<ElementId> {
        match self {
            Phase::Enhance { element, .. }
            | Phase::Smooth { element, .. }
            | Phase::Seam { element, .. }
            | Phase::Split { element } => Some(*element),
            _ => None,
        }
    }

    /// Whether the local post-processing of the last quadrilateral (4.3.6) is under way.
    pub fn is_local_post_processing(&self) -> bool {
        self.last_formed().is_some()
    }

    /// The attempt at the quadrilateral at hand.
    pub fn attempt(&self) -> Option<&Attempt> {
        match self {
            Phase::PrepareSide { attempt, .. }
            | Phase::DivideSide { attempt, .. }
            | Phase::RecoverTop { attempt, .. }
            | Phase::Form { attempt, .. } => Some(attempt),
            _ => None,
        }
    }

    /// The mark of the journal to which the work at hand may be taken back; `None` where nothing is under way.
    pub fn mark(&self) -> Option<Mark> {
        match self {
            Phase::Enhance { mark, .. } | Phase::Smooth { mark, .. } => Some(*mark),
            phase => phase.attempt().map(|attempt| attempt.mark),
        }
    }

    /// The phase without the marks of the journal, which are history and not state.
    #[must_use]
    pub fn plain(&self) -> Phase {
        let mut plain = self.clone();
        match &mut plain {
            Phase::PrepareSide { attempt, .. }
            | Phase::DivideSide { attempt, .. }
            | Phase::RecoverTop { attempt, .. }
            | Phase::Form { attempt, .. } => attempt.mark = Mark::default(),
            Phase::Enhance { mark, .. } | Phase::Smooth { mark, .. } => *mark = Mark::default(),
            _ => {}
        }
        plain
    }
}
