//! The last resort (docs/algorithm.md, "The guarantee"): any component with an even number of positive triangles
//! becomes strictly convex quadrilaterals, its boundary untouched.
//!
//! 1. A maximum matching of neighbouring triangles whose union is strictly convex and not close to a triangle
//!    ([`matching`]).
//! 2. What it leaves over is matched over other inner edges, searches using as few of them as they can.
//! 3. What is left over even then is linked by paths, so that every triangle has one or three edges in a T-join
//!    (`t_join`).
//! 4. A pair whose union is not such is cut anew together with up to three pairs around it, where that gives good
//!    quadrilaterals (what swaps of edges and matching again would look for, found directly and at its best), or filled
//!    together with them around one new node (`recut`).
//! 5. Two triangles that have only each other in the join and such a union are merged. Every other edge of the join is
//!    divided at its middle, and its triangles are filled by templates.
//!
//! Why this always succeeds: neighbours agree on which edges are divided; the templates are affine images of strictly
//! convex ones, and affine maps keep that; no edge of the boundary is ever in the join. Step 2 is a matter of quality:
//! it replaces long paths of divided edges by single ones.
//!
//! A [`Plan`] comes first, every corner of it verified exactly; only then the mesh is changed, patch by patch.

pub mod component;
pub mod matching;
mod t_join;
mod planner;
mod recut;
mod templates;
#[cfg(test)]
mod tests;

use std::fmt;

use glam::DVec2;
use serde::Serialize;
use smallvec::SmallVec;

use self::planner::Planner;
use super::sums::summed;
use crate::core::kernel::Metric2;
use crate::core::mesh::{ElementId, Mesh, NewElement, NodeId, Operation};
use crate::core::metric::{BadMetric, MetricSource};

summed! {
/// What the last resort did.
#[derive(Serialize)]
pub struct Outcome {
    /// Triangles it was given.
    pub triangles: usize,
    /// Quadrilaterals that are two merged triangles.
    pub merged: usize,
    /// Quadrilaterals that were cut anew from several pairs, one of which could not be merged.
    pub recut: usize,
    /// Quadrilaterals of the templates.
    pub template_quads: usize,
    /// Edges divided.
    pub divided: usize,
    /// Triangles without a partner after the matching of convex pairs.
    pub unmatched: usize,
    /// Triangles without a partner after that over all inner edges.
    pub unmatched_at_all: usize,
}
}

impl Outcome {
    /// All quadrilaterals made.
    pub fn quads(&self) -> usize {
        self.merged + self.recut + self.template_quads
    }
}

/// Why the last resort could not be done; the mesh is as it was.
#[derive(Clone, Debug, PartialEq)]
pub enum Stuck {
    /// The component of this triangle has an odd number of triangles.
    Odd(ElementId),
    /// A quadrilateral of a template came out not convex: the triangle here is too flat for its coordinates.
    TooFlat {
        /// The triangle.
        element: ElementId,
        /// Its first corner.
        uv: DVec2,
    },
    /// There is no metric at a new node.
    Metric(Box<BadMetric>),
}

impl fmt::Display for Stuck {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Stuck::Odd(e) => write!(f, "the component of triangle {} has an odd number of triangles", e.0),
            Stuck::TooFlat { element, uv } => {
                write!(f, "triangle {} at ({}, {}) is too flat to be divided", element.0, uv.x, uv.y)
            }
            Stuck::Metric(bad) => write!(f, "{} at ({}, {})", bad.what, bad.place.uv.x, bad.place.uv.y),
        }
    }
}

impl std::error::Error for Stuck {}

/// How a patch of triangles becomes quadrilaterals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Means {
    /// Two triangles merge.
    Merge,
    /// A few pairs of triangles become as many quadrilaterals, or one more, cut otherwise than the pairs.
    Recut,
    /// Edges are divided and templates fill the triangles between them.
    Templates,
}

/// What is to be done, patch by patch: first the merges and recuts, then the templates.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    outcome: Outcome,
    /// Nodes with an id from here on are new ones: the rest is their place in `nodes`.
    first_new: u32,
    nodes: Vec<(DVec2, Metric2)>,
    triangles: Vec<ElementId>,
    quads: Vec<[u32; 4]>,
    patches: Vec<Patch>,
}

/// Ends of a patch's stretches in the lists of its plan; it begins where the one before ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Patch {
    means: Means,
    nodes: u32,
    triangles: u32,
    quads: u32,
}

impl Plan {
    /// Plans how the given triangles of a mesh, one or several whole components of even size, become quadrilaterals.
    ///
    /// Sides that no two of the triangles share are left alone. New nodes get their metric from `source`.
    ///
    /// # Errors
    /// [`Stuck`].
    ///
    /// # Panics
    /// Where an element is no triangle, or is given twice.
    pub fn new(mesh: &Mesh, component: &[ElementId], source: &dyn MetricSource) -> Result<Plan, Stuck> {
        let operation = |means| match means {
            Means::Merge => Operation::Merge,
            Means::Recut => Operation::Recut,
            Means::Templates => Operation::Match,
        };
        Planner::plan(mesh, component, source, &|means, pair| mesh.permits_pair(operation(means), pair))
    }

    /// What the whole plan does.
    pub fn outcome(&self) -> Outcome {
        self.outcome
    }

    /// Number of patches.
    pub fn patches(&self) -> usize {
        self.patches.len()
    }

    /// How a patch is made.
    pub fn means(&self, patch: usize) -> Means {
        self.patches[patch].means
    }

    /// The triangles of a patch.
    pub fn triangles(&self, patch: usize) -> &[ElementId] {
        &self.triangles[self.begin(patch).triangles as usize..self.patches[patch].triangles as usize]
    }

    /// Number of quadrilaterals that the patches before this one make.
    pub fn quads_before(&self, patch: usize) -> usize {
        self.begin(patch).quads as usize
    }

    fn begin(&self, patch: usize) -> Patch {
        let none = Patch { means: Means::Merge, nodes: 0, triangles: 0, quads: 0 };
        patch.checked_sub(1).map_or(none, |before| self.patches[before])
    }

    /// Replaces the triangles of one patch by its quadrilaterals, which come back. Patches may be carried out in any
    /// order, each once, with nothing else done to their triangles in between.
    pub fn carry_out(&self, mesh: &mut Mesh, patch: usize) -> SmallVec<[ElementId; 8]> {
        let (begin, end) = (self.begin(patch), self.patches[patch]);
        let new: SmallVec<[NodeId; 16]> = (self.nodes[begin.nodes as usize..end.nodes as usize].iter())
            .map(|&(uv, metric)| mesh.add_node(uv, metric))
            .collect();
        let triangles = self.triangles(patch);
        let region = mesh.region(triangles[0]);
        let node = |id: u32| match id.checked_sub(self.first_new) {
            Some(place) => new[(place - begin.nodes) as usize],
            None => NodeId(id),
        };
        let quads: SmallVec<[NewElement; 8]> = (self.quads[begin.quads as usize..end.quads as usize].iter())
            .map(|quad| NewElement::quad(quad.map(node), region))
            .collect();
        mesh.replace(triangles, &quads)
    }
}
