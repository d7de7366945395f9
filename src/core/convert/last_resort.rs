//! The last resort (docs/algorithm.md, "The guarantee"): any component with an even number of positive triangles
//! becomes strictly convex quadrilaterals, its boundary untouched.
//!
//! 1. A maximum matching of neighbouring triangles whose union is strictly convex and not close to a triangle
//!    ([`super::matching`]).
//! 2. What it leaves over is matched over other inner edges, searches using as few of them as they can.
//! 3. What is left over even then is linked by paths, so that every triangle has one or three edges in a T-join
//!    (module `t_join`).
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
//! All is planned first, in a [`Plan`], corner by corner verified exactly; only then is the mesh changed, patch by patch.

use std::fmt;

use glam::DVec2;
use serde::Serialize;
use smallvec::SmallVec;

use super::component::{Dual, NONE};
use super::matching::Matching;
use super::t_join::t_join;
use crate::core::kernel::predicates::{convex, firm, orient};
use crate::core::kernel::tensor::Metric2;
use crate::core::mesh::half_edge::{Mesh, NewElement};
use crate::core::mesh::ids::{ElementId, NodeId};
use crate::core::mesh::refusals::Operation;
use crate::core::metric::field::{BadMetric, MetricSource};
use crate::core::metric::measure::quad_quality;

/// What the last resort did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[non_exhaustive]
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

impl Outcome {
    /// The sums of two outcomes.
    #[must_use]
    pub fn plus(&self, other: &Outcome) -> Outcome {
        Outcome {
            triangles: self.triangles + other.triangles,
            merged: self.merged + other.merged,
            recut: self.recut + other.recut,
            template_quads: self.template_quads + other.template_quads,
            divided: self.divided + other.divided,
            unmatched: self.unmatched + other.unmatched,
            unmatched_at_all: self.unmatched_at_all + other.unmatched_at_all,
        }
    }

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
    /// Sides that the triangles do not share among themselves stay as they are. New nodes get their metric from `source`.
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

/// A pair of triangles that have only each other in the join.
#[derive(Clone, Copy, Debug)]
struct Pair {
    /// Corners of the union, anticlockwise.
    nodes: [u32; 4],
    /// The sides of the triangles that lie on the outline: `outline[k]` from `nodes[k]` to the next.
    outline: [u32; 4],
    /// Whether the two can be merged: see [`firm_quad`].
    firm: bool,
}

/// Least share of a quadrilateral that the triangle at a corner must have, in halves of the whole.
///
/// A corner that is straight but for rounding (three points of an arc or of a straight side with a middle) makes a
/// quadrilateral that is strictly convex by the letter, and that nothing can mend where its nodes are fixed. The share
/// is 1 for a parallelogram, and affine maps keep it: the measure knows nothing of the metric, which may fit badly.
const FLAT: f64 = 0.05;

/// Whether a quadrilateral is strictly convex, exactly, and not close to a triangle.
#[inline]
fn firm_quad([a, b, c, d]: [DVec2; 4]) -> bool {
    let (at_a, at_b, at_c, at_d) = (orient(d, a, b), orient(a, b, c), orient(b, c, d), orient(c, d, a));
    let least = at_a.min(at_b).min(at_c).min(at_d);
    // Four nodes in a row may have shares of what rounding makes of nothing.
    let solid = || firm(d, a, b) && firm(a, b, c) && firm(b, c, d) && firm(c, d, a);
    least > 0.0 && 2.0 * least >= FLAT * (at_a + at_c) && solid()
}

struct Planner<'a> {
    dual: Dual<'a>,
    source: &'a dyn MetricSource,
    /// Of each triangle the sides in the join, as bits.
    join: Vec<u8>,
    /// Triangles that a patch holds already.
    done: Vec<bool>,
    plan: Plan,
}

impl<'a> Planner<'a> {
    /// `allowed` may forbid a merge, a match over another edge (`Templates`) or a recut (given one triangle on each
    /// side of the edge in question): the result must be right whatever is forbidden, and tests forbid at random.
    fn plan(
        mesh: &'a Mesh,
        component: &'a [ElementId],
        source: &'a dyn MetricSource,
        allowed: &dyn Fn(Means, [ElementId; 2]) -> bool,
    ) -> Result<Plan, Stuck> {
        let dual = Dual::new(mesh, component);
        let n = component.len();
        let plan = Plan {
            outcome: Outcome { triangles: n, ..Outcome::default() },
            first_new: mesh.node_slots() as u32,
            nodes: Vec::new(),
            triangles: Vec::with_capacity(n),
            quads: Vec::with_capacity(n / 2),
            patches: Vec::with_capacity(n / 2),
        };
        let mut planner = Planner { dual, source, join: Vec::new(), done: vec![false; n], plan };
        planner.join(allowed)?;
        planner.merge_and_recut(allowed)?;
        planner.fill_with_templates()?;
        Ok(planner.plan)
    }

    /// Steps 1 to 3.
    fn join(&mut self, allowed: &dyn Fn(Means, [ElementId; 2]) -> bool) -> Result<(), Stuck> {
        let dual = &self.dual;
        let (mut firm, mut rank, mut other) = (Vec::new(), Vec::new(), Vec::new());
        for side in 0..dual.across.len() as u32 {
            let across = dual.across[side as usize];
            if across == NONE || across < side {
                continue;
            }
            let edge = [side / 3, across / 3];
            let pair = self.pair(side);
            if pair.firm && allowed(Means::Merge, self.elements(edge)) {
                firm.push(edge);
                rank.push(self.quality(pair.nodes) as f32);
            } else if allowed(Means::Templates, self.elements(edge)) {
                other.push(edge);
            }
        }
        let mut matching = Matching::new(dual.triangles.len(), &firm, &other);
        matching.start(&firm, &rank);
        matching.augment(false);
        self.plan.outcome.unmatched = matching.unmatched();
        if self.plan.outcome.unmatched > 0 {
            matching.augment(true);
        }
        self.plan.outcome.unmatched_at_all = matching.unmatched();
        self.join = t_join(dual, &matching).map_err(|t| Stuck::Odd(dual.triangles[t as usize]))?;
        Ok(())
    }

    /// Step 4 and the merges of step 5.
    fn merge_and_recut(&mut self, allowed: &dyn Fn(Means, [ElementId; 2]) -> bool) -> Result<(), Stuck> {
        let mut crooked = Vec::new();
        let mut straight = Vec::new();
        for t in 0..self.dual.triangles.len() as u32 {
            let Some(side) = self.partner_side(t).filter(|&side| side < self.dual.across[side as usize]) else {
                continue;
            };
            let pair = self.pair(side);
            let edge = [t, self.dual.across[side as usize] / 3];
            if pair.firm && allowed(Means::Merge, self.elements(edge)) {
                straight.push(side);
            } else {
                crooked.push(side);
            }
        }
        for side in crooked {
            if !self.done[(side / 3) as usize] {
                self.recut(side, allowed)?;
            }
        }
        for side in straight {
            let t = side / 3;
            if !self.done[t as usize] {
                let pair = self.pair(side);
                self.plan.outcome.merged += 1;
                self.plan.quads.push(pair.nodes);
                self.close_patch(Means::Merge, &[t, self.dual.across[side as usize] / 3]);
            }
        }
        Ok(())
    }

    /// The templates of step 5, a patch for each part of the join that hangs together.
    fn fill_with_templates(&mut self) -> Result<(), Stuck> {
        for first in 0..self.dual.triangles.len() as u32 {
            if self.done[first as usize] {
                continue;
            }
            let mut patch = vec![first];
            self.done[first as usize] = true;
            // Middles of divided edges that the triangles still to come share, by their side of the edge.
            let mut middles: Vec<(u32, u32)> = Vec::new();
            let mut next = 0;
            while let Some(&t) = patch.get(next) {
                next += 1;
                let mut divided = [NONE; 3];
                for k in 0..3 {
                    let side = 3 * t + k;
                    if self.join[t as usize] >> k & 1 == 0 {
                        continue;
                    }
                    divided[k as usize] = if let Some(at) = middles.iter().position(|&(s, _)| s == side) {
                        middles.swap_remove(at).1
                    } else {
                        let across = self.dual.across[side as usize];
                        let [a, b] = self.ends(side);
                        let middle = self.add_node(0.5 * (self.uv(a) + self.uv(b)))?;
                        middles.push((across, middle));
                        self.plan.outcome.divided += 1;
                        // The join may have cycles: a triangle can be reached over several sides.
                        if !std::mem::replace(&mut self.done[(across / 3) as usize], true) {
                            patch.push(across / 3);
                        }
                        middle
                    };
                }
                self.fill(t, divided)?;
            }
            debug_assert!(middles.is_empty());
            self.close_patch(Means::Templates, &patch);
        }
        Ok(())
    }

    /// One triangle with one or three divided sides.
    ///
    /// ```text
    ///              C                             C
    ///             /|\                           / \
    ///            / | \                         /   \
    ///           /  C'  \                      /     \
    ///          / _/ \_  \                   m2       m1
    ///         / /     \  \                  / \_   _/ \
    ///        / A'_   _B'  \                /    \G/    \
    ///       / /   \m'/  \  \              /      |      \
    ///      //      |      \ \            /       |       \
    ///     A--------m---------B          A--------m0-------B
    /// ```
    /// One side: five quadrilaterals, the least there can be; the barycentric places of A', B', C' and m' are the best
    /// found (least scaled Jacobian 0.5 on the equilateral triangle). Three sides: the centroid G.
    fn fill(&mut self, t: u32, middles: [u32; 3]) -> Result<(), Stuck> {
        let first = self.plan.quads.len();
        let corners = self.mesh().triangle(self.dual.triangles[t as usize]).map(|n| n.0);
        if middles.iter().all(|&m| m != NONE) {
            let [a, b, c] = corners;
            let [m0, m1, m2] = middles;
            let centre = self.add_node(self.barycentric(corners, [1.0 / 3.0; 3]))?;
            self.plan.quads.extend([[a, m0, centre, m2], [b, m1, centre, m0], [c, m2, centre, m1]]);
        } else {
            let k = middles.iter().position(|&m| m != NONE).expect("a triangle has one or three edges in the join");
            let m = middles[k];
            let [a, b, c] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
            let mut inner = [0; 4];
            let weights = [[0.5, 0.25, 0.25], [0.25, 0.5, 0.25], [0.25, 0.25, 0.5], [0.4375, 0.4375, 0.125]];
            for (node, weights) in inner.iter_mut().zip(weights) {
                *node = self.add_node(self.barycentric([a, b, c], weights))?;
            }
            let [a_in, b_in, c_in, m_in] = inner;
            self.plan.quads.extend([
                [a, m, m_in, a_in],
                [m, b, b_in, m_in],
                [b, c, c_in, b_in],
                [c, a, a_in, c_in],
                [a_in, m_in, b_in, c_in],
            ]);
        }
        self.plan.outcome.template_quads += self.plan.quads.len() - first;
        let is_convex = |quad: &[u32; 4]| {
            let [a, b, c, d] = quad.map(|n| self.uv(n));
            convex(a, b, c, d)
        };
        if self.plan.quads[first..].iter().all(is_convex) {
            return Ok(());
        }
        let element = self.dual.triangles[t as usize];
        let [p_a, p_b, p_c] = corners.map(|n| self.uv(n));
        debug_assert!(!firm(p_a, p_b, p_c), "a template of {element:?} is inverted though the triangle is firm");
        Err(Stuck::TooFlat { element, uv: self.uv(corners[0]) })
    }

    fn close_patch(&mut self, means: Means, triangles: &[u32]) {
        for &t in triangles {
            self.done[t as usize] = true;
            self.plan.triangles.push(self.dual.triangles[t as usize]);
        }
        let plan = &mut self.plan;
        plan.patches.push(Patch {
            means,
            nodes: plan.nodes.len() as u32,
            triangles: plan.triangles.len() as u32,
            quads: plan.quads.len() as u32,
        });
    }

    // ---- questions ----

    fn mesh(&self) -> &'a Mesh {
        self.dual.mesh
    }

    fn elements(&self, edge: [u32; 2]) -> [ElementId; 2] {
        edge.map(|t| self.dual.triangles[t as usize])
    }

    /// The ends of a side, in its direction.
    #[inline]
    fn ends(&self, side: u32) -> [u32; 2] {
        let h = self.dual.half_edge(side);
        [self.mesh().origin(h).0, self.mesh().target(h).0]
    }

    /// Of a triangle that has one edge in the join, and so has the neighbour over it: that side.
    fn partner_side(&self, t: u32) -> Option<u32> {
        let lone =
            |t: u32| (self.join[t as usize].count_ones() == 1).then(|| 3 * t + self.join[t as usize].trailing_zeros());
        lone(t).filter(|&side| lone(self.dual.across[side as usize] / 3).is_some())
    }

    /// The two triangles on both sides of an edge as one quadrilateral, begun at the edge's end.
    #[inline]
    fn pair(&self, side: u32) -> Pair {
        let across = self.dual.across[side as usize];
        let after = |side: u32| side / 3 * 3 + (side + 1) % 3;
        let outline = [after(side), after(after(side)), after(across), after(after(across))];
        let nodes = outline.map(|s| self.mesh().origin(self.dual.half_edge(s)).0);
        Pair { nodes, outline, firm: self.is_firm(nodes) }
    }

    #[inline]
    fn is_firm(&self, quad: [u32; 4]) -> bool {
        firm_quad(quad.map(|n| self.uv(n)))
    }

    #[inline]
    fn quality(&self, quad: [u32; 4]) -> f64 {
        quad_quality(quad.map(|n| self.mesh().metric_ref(NodeId(n))), quad.map(|n| self.uv(n)))
    }

    /// Coordinates of a node, of the mesh or of the plan.
    #[inline]
    fn uv(&self, node: u32) -> DVec2 {
        match node.checked_sub(self.plan.first_new) {
            Some(place) => self.plan.nodes[place as usize].0,
            None => self.mesh().uv(NodeId(node)),
        }
    }

    fn barycentric(&self, corners: [u32; 3], weights: [f64; 3]) -> DVec2 {
        let [a, b, c] = corners.map(|n| self.uv(n));
        weights[0] * a + weights[1] * b + weights[2] * c
    }

    fn add_node(&mut self, uv: DVec2) -> Result<u32, Stuck> {
        let metric = self.source.metric(uv).map_err(Stuck::Metric)?;
        self.plan.nodes.push((uv, metric));
        Ok(self.plan.first_new + self.plan.nodes.len() as u32 - 1)
    }
}

mod recut;
#[cfg(test)]
mod tests;
