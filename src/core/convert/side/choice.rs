//! Which edge is to be a side: steps i to v of the definition of side edges (paper 4.3.4). Judges, and changes nothing.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec2;

use crate::core::case::Parameters;
use crate::core::convert::event::{SideEdge, Why};
use crate::core::convert::phase::{Attempt, Base};
use crate::core::front::{Side, Spoke, Spokes};
use crate::core::mesh::{HalfEdgeId, Mesh, NodeId};
use crate::core::metric::measure::angle;

/// The widest frontal angle that is bisected: at 225 degrees the bisector, at 112, is still near a right angle. Our
/// rule, not a reading of `theta_revr`, which the paper draws (fig. 12) and only classifies with.
const WIDEST_BISECTED: f64 = 1.25 * PI;

/// A side edge that was decided on, before anything is changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SideChoice {
    /// Its top node, angle with the base, and how far that is from the direction aimed at.
    pub edge: SideEdge,
    /// How it comes to be there.
    pub way: Way,
}

/// How a side edge comes to be there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// It is the neighbouring front segment.
    Front,
    /// It is there.
    Edge,
    /// By a swap of this edge, in place of an edge with this deviation, if there is one.
    Swap(HalfEdgeId, Option<f64>),
}

/// One side of a base segment.
#[derive(Clone, Copy)]
pub struct BaseSide<'a> {
    pub mesh: &'a Mesh,
    pub parameters: &'a Parameters,
    pub base: &'a Base,
    pub side: Side,
}

impl BaseSide<'_> {
    /// Chooses the side: (ii) the neighbouring front segment where the frontal angle is small, else (iii) the best
    /// edge, else (iv, v) the best of the edges and swaps.
    pub fn choose(&self, attempt: &Attempt, left: Option<NodeId>) -> Result<SideChoice, Why> {
        let BaseSide { mesh, parameters, base, side } = *self;
        let none = Why::NoSide(side);
        let spokes = mesh.spokes(base.half_edge(mesh).ok_or(none)?, side);
        let excluded = |n: NodeId| n == base.a || n == base.b || Some(n) == left;
        if let Some(top) = attempt.tops[side.index()] {
            let there = !excluded(top) && spokes.iter().any(|s| s.node == top);
            let choice = SideChoice { edge: self.edge(top), way: Way::Edge };
            return there.then_some(choice).ok_or(none);
        }
        if base.theta[side.index()] < parameters.theta_rect {
            let last = spokes.last().ok_or(none)?.node;
            let choice = SideChoice { edge: self.edge(last), way: Way::Front };
            return (!excluded(last)).then_some(choice).ok_or(none);
        }
        let best = self.best_edge(&spokes, &excluded);
        let there = best.map_or(f64::INFINITY, |b| b.deviation);
        if there > parameters.side_deviation
            && let Some((edge, h)) = self.best_swap(&spokes, &excluded)
            && edge.deviation < there
        {
            return Ok(SideChoice { edge, way: Way::Swap(h, best.map(|b| b.deviation)) });
        }
        Ok(SideChoice { edge: best.ok_or(none)?, way: Way::Edge })
    }

    /// The edge within the sector that is nearest to the direction aimed at (iii).
    fn best_edge(&self, spokes: &Spokes, excluded: &dyn Fn(NodeId) -> bool) -> Option<SideEdge> {
        let mut best: Option<SideEdge> = None;
        for spoke in spokes.iter().filter(|s| !s.is_front && !excluded(s.node)) {
            let edge = self.edge(spoke.node);
            if best.is_none_or(|b| edge.deviation < b.deviation) {
                best = Some(edge);
            }
        }
        best
    }

    /// The best swap of an edge opposite to the side's base node within the sector (iv), and the edge to be swapped.
    fn best_swap(&self, spokes: &Spokes, excluded: &dyn Fn(NodeId) -> bool) -> Option<(SideEdge, HalfEdgeId)> {
        let mut best: Option<(SideEdge, HalfEdgeId)> = None;
        for spoke in spokes {
            let Some((opposite, far)) = self.opposite(spoke) else { continue };
            if excluded(far) {
                continue;
            }
            let edge = self.edge(far);
            if best.is_none_or(|b| edge.deviation < b.0.deviation) && self.mesh.can_swap(opposite).is_ok() {
                best = Some((edge, opposite));
            }
        }
        best
    }

    /// The edge opposite to the side's base node in the triangle of a spoke, if it is live, with the node beyond it.
    pub fn opposite(&self, spoke: &Spoke) -> Option<(HalfEdgeId, NodeId)> {
        // The spoke's half-edge ends (left) or starts (right) at the base node: opposite is the one between the others.
        let opposite = match self.side {
            Side::Left => self.mesh.previous(spoke.h),
            Side::Right => self.mesh.next(spoke.h),
        };
        Some((opposite, self.mesh.apex(self.mesh.live_twin(opposite)?)))
    }

    /// The edge, or the line, from the base node to a node as a side.
    pub fn edge(&self, node: NodeId) -> SideEdge {
        let angle = self.angle(self.mesh.uv(node));
        SideEdge { side: self.side, node, angle, deviation: (angle - self.target_angle()).abs() }
    }

    /// The angle that the side aims at: the bisector of a frontal angle up to 225 degrees (it lies within 67 and 112
    /// there), else the right angle; always the right angle where the bisector is switched off.
    pub fn target_angle(&self) -> f64 {
        let theta = self.base.theta[self.side.index()];
        if self.parameters.bisector && theta <= WIDEST_BISECTED { 0.5 * theta } else { FRAC_PI_2 }
    }

    /// Angle between the base and the line to a place, in the metric of the side's base node, into the live region.
    pub fn angle(&self, to: DVec2) -> f64 {
        let BaseSide { mesh, base, side, .. } = *self;
        let at = base.node(side);
        let p = mesh.uv(at);
        let (along, up) = (mesh.uv(base.node(side.other())) - p, to - p);
        match side {
            Side::Left => angle(mesh.metric_ref(at), along, up),
            Side::Right => angle(mesh.metric_ref(at), up, along),
        }
    }
}
