//! Side edges (paper 4.3.4, definition of left and right side edges, i to vii; docs/algorithm.md, "Side edges"). Left
//! and right are one function.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec2;

use super::converter::Converter;
use super::event::{Event, SideEdge, Why};
use super::phase::{Attempt, Base};
use crate::core::front::sector::{Side, Spoke, Spokes};
use crate::core::kernel::tensor::Metric2;
use crate::core::mesh::ids::{HalfEdgeId, NodeId};
use crate::core::metric::measure::angle;

/// Half a divided side must be at least this long in the metric.
const LEAST_HALF: f64 = 0.5;

/// The widest frontal angle that is bisected: at 225 degrees the bisector lies at 112 and is still near enough to a right angle. A
/// rule of ours and no reading of `theta_revr`, which the paper draws (fig. 12) and never uses: that one only classifies.
const WIDEST_BISECTED: f64 = 1.25 * PI;

/// A side edge that was decided on, before anything is changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Choice {
    /// Its top node, angle with the base, and how far that is from the direction aimed at.
    pub edge: SideEdge,
    /// How it is to be had.
    pub way: Way,
}

/// How a side edge is to be had.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Way {
    /// It is the neighbouring front segment.
    Front,
    /// It is there.
    Edge,
    /// By a swap of this edge, in place of an edge with this deviation, if there is one.
    Swap(HalfEdgeId, Option<f64>),
}

impl Choice {
    /// The edge that has to be swapped for it.
    pub(super) fn swap(&self) -> Option<HalfEdgeId> {
        match self.way {
            Way::Swap(h, _) => Some(h),
            Way::Front | Way::Edge => None,
        }
    }
}

/// A division of a side edge that was judged possible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Division {
    h: HalfEdgeId,
    middle: DVec2,
    metric: Metric2,
    length: f64,
}

impl Converter<'_> {
    /// Prepares one side as [`Converter::choose_side`] decides. Returns the side's top node and what was decided.
    pub(super) fn prepare_side(
        &mut self,
        base: &Base,
        attempt: &Attempt,
        side: Side,
        left: Option<NodeId>,
    ) -> Result<(NodeId, Event), Why> {
        let Choice { edge, way } = self.choose_side(base, attempt, side, left)?;
        let event = match way {
            Way::Front => Event::SideIsFront { side, node: edge.node },
            Way::Edge => Event::SideChosen { edge },
            Way::Swap(h, instead_of) => {
                self.mesh.swap(h);
                Event::SideSwapped { edge, instead_of }
            }
        };
        Ok((edge.node, event))
    }

    /// Chooses one side: (ii) the neighbouring front segment where the frontal angle is small, else (iii) the best edge,
    /// else (iv, v) the best of the edges and swaps. Changes nothing.
    pub(super) fn choose_side(
        &self,
        base: &Base,
        attempt: &Attempt,
        side: Side,
        left: Option<NodeId>,
    ) -> Result<Choice, Why> {
        let h = self.base_half_edge(base).ok_or(Why::NoSide(side))?;
        let spokes = self.mesh.spokes(h, side);
        let excluded = |n: NodeId| n == base.a || n == base.b || Some(n) == left;
        if let Some(top) = attempt.tops[side.index()] {
            let there = !excluded(top) && spokes.iter().any(|s| s.node == top);
            let choice = Choice { edge: self.side_edge(base, side, top), way: Way::Edge };
            return there.then_some(choice).ok_or(Why::NoSide(side));
        }
        let theta = base.theta[side.index()];
        let last = *spokes.last().ok_or(Why::NoSide(side))?;
        if theta < self.parameters.theta_rect {
            let choice = Choice { edge: self.side_edge(base, side, last.node), way: Way::Front };
            return (!excluded(last.node)).then_some(choice).ok_or(Why::NoSide(side));
        }
        let mut best: Option<SideEdge> = None;
        for spoke in spokes.iter().filter(|s| !s.is_front && !excluded(s.node)) {
            let edge = self.side_edge(base, side, spoke.node);
            if best.is_none_or(|b| edge.deviation < b.deviation) {
                best = Some(edge);
            }
        }
        let there = best.map_or(f64::INFINITY, |b| b.deviation);
        if there > self.parameters.side_deviation
            && let Some((edge, h)) = self.best_swap(base, side, &spokes, &excluded)
            && edge.deviation < there
        {
            return Ok(Choice { edge, way: Way::Swap(h, best.map(|b| b.deviation)) });
        }
        let edge = best.ok_or(Why::NoSide(side))?;
        Ok(Choice { edge, way: Way::Edge })
    }

    /// The edge, or the line, from the side's base node to a node as a side.
    pub(super) fn side_edge(&self, base: &Base, side: Side, node: NodeId) -> SideEdge {
        let angle = self.side_angle(base, side, node);
        SideEdge { side, node, angle, deviation: (angle - self.target_angle(base, side)).abs() }
    }

    /// The edge opposite to a side's base node in the triangle of a spoke, if it is live, with the node beyond it.
    pub(super) fn opposite(&self, side: Side, spoke: &Spoke) -> Option<(HalfEdgeId, NodeId)> {
        let mesh = &self.mesh;
        // The spoke's half-edge ends (left) or starts (right) at the base node: opposite is the one between the others.
        let opposite = match side {
            Side::Left => mesh.previous(spoke.h),
            Side::Right => mesh.next(spoke.h),
        };
        let t = mesh.twin(opposite).filter(|t| mesh.is_triangle(t.element()))?;
        Some((opposite, mesh.origin(mesh.previous(t))))
    }

    /// The best swap of an edge opposite to the side's base node within the sector (iv), and the edge to be swapped.
    fn best_swap(
        &self,
        base: &Base,
        side: Side,
        spokes: &Spokes,
        excluded: &dyn Fn(NodeId) -> bool,
    ) -> Option<(SideEdge, HalfEdgeId)> {
        let mut best: Option<(SideEdge, HalfEdgeId)> = None;
        for spoke in spokes {
            let Some((opposite, far)) = self.opposite(side, spoke) else { continue };
            if excluded(far) {
                continue;
            }
            let edge = self.side_edge(base, side, far);
            if best.is_none_or(|b| edge.deviation < b.0.deviation) && self.mesh.can_swap(opposite).is_ok() {
                best = Some((edge, opposite));
            }
        }
        best
    }

    /// Where a side edge is to be divided (vi): one that is live and longer than `side_split` times the base, or whose
    /// division is forced; `None` where it stays whole. With its length before.
    pub(super) fn division(
        &self,
        base: &Base,
        attempt: &Attempt,
        side: Side,
        top: NodeId,
    ) -> Result<Option<Division>, Why> {
        let mesh = &self.mesh;
        let at = self.base_node(base, side);
        let forced = attempt.divide[side.index()];
        if attempt.tops[side.index()].is_some() && !forced {
            return Ok(None);
        }
        let whole = if forced { Err(Why::NoDivision(side)) } else { Ok(None) };
        let Some(h) = mesh.half_edge_between(at, top).filter(|_| self.is_live_edge(at, top)) else { return whole };
        let length = mesh.length(h);
        if !forced && length <= self.parameters.side_split * base.length {
            return Ok(None);
        }
        if length < 2.0 * LEAST_HALF {
            return whole;
        }
        let middle = self.metric_middle(at, top);
        let metric = self.source.metric(middle).map_err(|_| Why::NoMetric)?;
        if mesh.can_divide(h, middle).is_err() { whole } else { Ok(Some(Division { h, middle, metric, length })) }
    }

    /// Divides a side edge as judged. Returns the new top.
    pub(super) fn divide_side(&mut self, side: Side, division: Division) -> (NodeId, Event) {
        let Division { h, middle, metric, length } = division;
        let node = self.mesh.divide(h, middle, metric).expect("it was judged");
        (node, Event::SideDivided { side, node, length })
    }

    /// The place between two nodes that halves the metric length.
    pub(super) fn metric_middle(&self, a: NodeId, b: NodeId) -> DVec2 {
        let (p, q) = (self.mesh.uv(a), self.mesh.uv(b));
        let [l_p, l_q] = [a, b].map(|n| self.mesh.metric_ref(n).norm2(q - p).sqrt());
        p + (q - p) * (l_q.sqrt() / (l_p.sqrt() + l_q.sqrt()))
    }

    /// The angle that a side aims at: the bisector of a frontal angle up to 225 degrees (it lies within 67 and 112 there),
    /// else the right angle; always the right angle where the bisector is switched off.
    pub(super) fn target_angle(&self, base: &Base, side: Side) -> f64 {
        let theta = base.theta[side.index()];
        if self.parameters.bisector && theta <= WIDEST_BISECTED { 0.5 * theta } else { FRAC_PI_2 }
    }

    /// The base's node at a side.
    pub(super) fn base_node(&self, base: &Base, side: Side) -> NodeId {
        match side {
            Side::Left => base.a,
            Side::Right => base.b,
        }
    }

    /// Angle between the base and the line to a node, in the metric of the side's base node, into the live region.
    pub(super) fn side_angle(&self, base: &Base, side: Side, to: NodeId) -> f64 {
        let mesh = &self.mesh;
        let at = self.base_node(base, side);
        let other = self.base_node(base, side.other());
        let p = mesh.uv(at);
        let (along, up) = (mesh.uv(other) - p, mesh.uv(to) - p);
        match side {
            Side::Left => angle(mesh.metric_ref(at), along, up),
            Side::Right => angle(mesh.metric_ref(at), up, along),
        }
    }

    /// The base's half-edge in its live triangle.
    pub(super) fn base_half_edge(&self, base: &Base) -> Option<HalfEdgeId> {
        self.mesh.front_between(base.a, base.b)
    }
}
