//! The planner of the last resort: the join (steps 1 to 3), merges and recuts (step 4), and what every step asks.

use glam::DVec2;

use super::component::{Dual, NONE};
use super::matching::Matching;
use super::t_join::t_join;
use super::{Means, Outcome, Patch, Plan, Stuck};
use crate::core::kernel::predicates::{firm, orient};
use crate::core::mesh::{ElementId, Mesh, NodeId};
use crate::core::metric::MetricSource;
use crate::core::metric::measure::quad_quality;

/// A pair of triangles that have only each other in the join.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    /// Corners of the union, anticlockwise.
    pub nodes: [u32; 4],
    /// The sides of the triangles that lie on the outline: `outline[k]` from `nodes[k]` to the next.
    pub outline: [u32; 4],
    /// Whether the two can be merged: see [`firm_quad`].
    pub firm: bool,
}

/// Least share of a quadrilateral that the triangle at a corner must have, in halves of the whole.
///
/// A corner that is straight but for rounding (three points of an arc or of a straight side with a middle) makes a
/// quadrilateral that is strictly convex by the letter, and that nothing can repair where its nodes are fixed. The
/// share is 1 for a parallelogram, and affine maps keep it: a metric that fits badly does not matter.
const FLAT: f64 = 0.05;

/// Whether a quadrilateral is strictly convex, exactly, and not close to a triangle.
#[inline]
pub fn firm_quad([a, b, c, d]: [DVec2; 4]) -> bool {
    let (at_a, at_b, at_c, at_d) = (orient(d, a, b), orient(a, b, c), orient(b, c, d), orient(c, d, a));
    let least = at_a.min(at_b).min(at_c).min(at_d);
    // Four nodes in a row may have shares of what rounding makes of nothing.
    let solid = || firm(d, a, b) && firm(a, b, c) && firm(b, c, d) && firm(c, d, a);
    least > 0.0 && 2.0 * least >= FLAT * (at_a + at_c) && solid()
}

/// A plan in the making.
pub struct Planner<'a> {
    pub dual: Dual<'a>,
    pub source: &'a dyn MetricSource,
    /// Of each triangle the sides in the join, as bits.
    pub join: Vec<u8>,
    /// Triangles that a patch holds already.
    pub done: Vec<bool>,
    pub plan: Plan,
}

impl<'a> Planner<'a> {
    /// `allowed` may forbid a merge, a match over another edge (`Templates`) or a recut (given one triangle on each
    /// side of the edge in question): the result must be right whatever is forbidden, and tests forbid at random.
    pub fn plan(
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

    pub fn close_patch(&mut self, means: Means, triangles: &[u32]) {
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

    pub fn mesh(&self) -> &'a Mesh {
        self.dual.mesh
    }

    pub fn elements(&self, edge: [u32; 2]) -> [ElementId; 2] {
        edge.map(|t| self.dual.triangles[t as usize])
    }

    /// The ends of a side, in its direction.
    #[inline]
    pub fn ends(&self, side: u32) -> [u32; 2] {
        let h = self.dual.half_edge(side);
        [self.mesh().origin(h).0, self.mesh().target(h).0]
    }

    /// Of a triangle that has one edge in the join, and so has the neighbour over it: that side.
    pub fn partner_side(&self, t: u32) -> Option<u32> {
        let lone =
            |t: u32| (self.join[t as usize].count_ones() == 1).then(|| 3 * t + self.join[t as usize].trailing_zeros());
        lone(t).filter(|&side| lone(self.dual.across[side as usize] / 3).is_some())
    }

    /// The two triangles on both sides of an edge as one quadrilateral, begun at the edge's end.
    #[inline]
    pub fn pair(&self, side: u32) -> Pair {
        let across = self.dual.across[side as usize];
        let after = |side: u32| side / 3 * 3 + (side + 1) % 3;
        let outline = [after(side), after(after(side)), after(across), after(after(across))];
        let nodes = outline.map(|s| self.mesh().origin(self.dual.half_edge(s)).0);
        Pair { nodes, outline, firm: self.is_firm(nodes) }
    }

    #[inline]
    pub fn is_firm(&self, quad: [u32; 4]) -> bool {
        firm_quad(quad.map(|n| self.uv(n)))
    }

    #[inline]
    pub fn quality(&self, quad: [u32; 4]) -> f64 {
        quad_quality(quad.map(|n| self.mesh().metric_ref(NodeId(n))), quad.map(|n| self.uv(n)))
    }

    /// Coordinates of a node, of the mesh or of the plan.
    #[inline]
    pub fn uv(&self, node: u32) -> DVec2 {
        match node.checked_sub(self.plan.first_new) {
            Some(place) => self.plan.nodes[place as usize].0,
            None => self.mesh().uv(NodeId(node)),
        }
    }

    pub fn add_node(&mut self, uv: DVec2) -> Result<u32, Stuck> {
        let metric = self.source.metric(uv).map_err(Stuck::Metric)?;
        self.plan.nodes.push((uv, metric));
        Ok(self.plan.first_new + self.plan.nodes.len() as u32 - 1)
    }
}
