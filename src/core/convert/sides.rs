//! Side edges (paper 4.3.4, definition of left and right side edges, i to vii; spec 2.3). Left and right are one function.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec2;

use super::converter::Converter;
use super::event::{Event, Why};
use super::phase::{Attempt, Base};
use crate::core::front::sector::{Side, Spokes};
use crate::core::mesh::ids::{HalfEdgeId, NodeId};
use crate::core::metric::measure::angle;

/// Half a divided side must be at least this long in the metric.
const LEAST_HALF: f64 = 0.5;

impl Converter<'_> {
    /// Prepares one side: (ii) the neighbouring front segment where the frontal angle is small, else (iii) the best edge,
    /// else (iv, v) the best of the edges and swaps. Returns the side's top node and what was decided.
    pub(super) fn prepare_side(
        &mut self,
        base: &Base,
        attempt: &Attempt,
        side: Side,
        left: Option<NodeId>,
    ) -> Result<(NodeId, Event), Why> {
        let h = self.base_half_edge(base).ok_or(Why::NoSide(side))?;
        let spokes = self.mesh.spokes(h, side);
        let excluded = |n: NodeId| n == base.a || n == base.b || Some(n) == left;
        if let Some(top) = attempt.tops[side.index()] {
            let spoke = spokes.iter().find(|s| s.node == top && !excluded(top)).ok_or(Why::NoSide(side))?;
            let angle = self.side_angle(base, side, spoke.node);
            let deviation = (angle - self.target_angle(base, side)).abs();
            return Ok((top, Event::SideChosen { side, node: top, angle, deviation, considered: 1 }));
        }
        let theta = base.theta[side.index()];
        let last = *spokes.last().ok_or(Why::NoSide(side))?;
        if theta < self.parameters.theta_rect {
            if excluded(last.node) {
                return Err(Why::NoSide(side));
            }
            return Ok((last.node, Event::SideIsFront { side, node: last.node }));
        }
        let target = self.target_angle(base, side);
        let mut best: Option<(f64, f64, NodeId)> = None;
        let mut considered = 0;
        for spoke in spokes.iter().filter(|s| !s.is_front && !excluded(s.node)) {
            let angle = self.side_angle(base, side, spoke.node);
            let deviation = (angle - target).abs();
            considered += 1;
            if best.is_none_or(|b| deviation < b.0) {
                best = Some((deviation, angle, spoke.node));
            }
        }
        let there = best.map_or(f64::INFINITY, |b| b.0);
        if there > self.parameters.side_deviation
            && let Some((deviation, angle, h)) = self.best_swap(base, side, &spokes, target, &excluded)
            && deviation < there
        {
            let h = self.mesh.swap(h);
            let at = self.base_node(base, side);
            let node = if self.mesh.origin(h) == at { self.mesh.target(h) } else { self.mesh.origin(h) };
            return Ok((node, Event::SideSwapped { side, node, angle, deviation, instead_of: there }));
        }
        let (deviation, angle, node) = best.ok_or(Why::NoSide(side))?;
        Ok((node, Event::SideChosen { side, node, angle, deviation, considered }))
    }

    /// The best swap of an edge opposite to the side's base node within the sector (iv): deviation, angle, the edge.
    fn best_swap(
        &self,
        base: &Base,
        side: Side,
        spokes: &Spokes,
        target: f64,
        excluded: &dyn Fn(NodeId) -> bool,
    ) -> Option<(f64, f64, HalfEdgeId)> {
        let mesh = &self.mesh;
        let mut best: Option<(f64, f64, HalfEdgeId)> = None;
        for spoke in spokes {
            // The spoke's half-edge ends (left) or starts (right) at the base node: opposite is the one between the others.
            let opposite = match side {
                Side::Left => mesh.previous(spoke.h),
                Side::Right => mesh.next(spoke.h),
            };
            let Some(t) = mesh.twin(opposite).filter(|t| mesh.is_triangle(t.element())) else { continue };
            let far = mesh.origin(mesh.previous(t));
            if excluded(far) {
                continue;
            }
            let angle = self.side_angle(base, side, far);
            let deviation = (angle - target).abs();
            if best.is_none_or(|b| deviation < b.0) && mesh.can_swap(opposite).is_ok() {
                best = Some((deviation, angle, opposite));
            }
        }
        best
    }

    /// Divides a side edge (vi) that is live and longer than `side_split` times the base, or whose division is forced;
    /// `None` where it stays whole.
    pub(super) fn divide_side(
        &mut self,
        base: &Base,
        attempt: &Attempt,
        side: Side,
        top: NodeId,
    ) -> Result<Option<(NodeId, Event)>, Why> {
        let mesh = &self.mesh;
        let at = self.base_node(base, side);
        let forced = attempt.divide[side.index()];
        if attempt.tops[side.index()].is_some() && !forced {
            return Ok(None);
        }
        let Some(h) = mesh.half_edge_between(at, top) else {
            return if forced { Err(Why::NoDivision(side)) } else { Ok(None) };
        };
        let live = mesh.is_triangle(h.element()) && mesh.twin(h).is_some_and(|t| mesh.is_triangle(t.element()));
        let length = mesh.length(h);
        if !live {
            return if forced { Err(Why::NoDivision(side)) } else { Ok(None) };
        }
        if !forced && length <= self.parameters.side_split * base.length {
            return Ok(None);
        }
        if length < 2.0 * LEAST_HALF {
            return if forced { Err(Why::NoDivision(side)) } else { Ok(None) };
        }
        let middle = self.metric_middle(at, top);
        let metric = self.source.metric(middle).map_err(|_| Why::NoMetric)?;
        match self.mesh.divide(h, middle, metric) {
            Ok(node) => Ok(Some((node, Event::SideDivided { side, node, length }))),
            Err(_) if forced => Err(Why::NoDivision(side)),
            Err(_) => Ok(None),
        }
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
        if self.parameters.bisector && theta <= 1.25 * PI { 0.5 * theta } else { FRAC_PI_2 }
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
