//! Whether and where a side edge is to be divided (paper 4.3.4, side edges vi). Judges, and changes nothing.

use glam::DVec2;

use super::choice::BaseSide;
use crate::core::case::DivisionAt;
use crate::core::convert::event::Why;
use crate::core::convert::phase::Attempt;
use crate::core::kernel::Metric2;
use crate::core::mesh::{HalfEdgeId, NodeId};
use crate::core::metric::MetricSource;

/// No side shorter than this in the metric is divided, so that divisions end (docs/algorithm.md, "When the front
/// ends").
const LEAST: f64 = 0.1;

/// A division of a side edge that was judged possible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Division {
    /// The edge.
    pub h: HalfEdgeId,
    /// The place where it is divided, and the metric there.
    pub middle: DVec2,
    pub metric: Metric2,
    /// Its metric length before.
    pub length: f64,
}

impl BaseSide<'_> {
    /// Where the side edge is to be divided: one that is live and longer than `side_split` times the base, or whose
    /// division is forced; `None` where it stays whole.
    pub fn division(&self, attempt: &Attempt, top: NodeId, source: &dyn MetricSource) -> Result<Option<Division>, Why> {
        let BaseSide { mesh, parameters, base, side } = *self;
        let at = base.node(side);
        let forced = attempt.divide[side.index()];
        if attempt.tops[side.index()].is_some() && !forced {
            return Ok(None);
        }
        let whole = if forced { Err(Why::NoDivision(side)) } else { Ok(None) };
        let Some(h) = mesh.half_edge_between(at, top).filter(|_| mesh.is_live_edge(at, top)) else { return whole };
        let length = mesh.length(h);
        if !forced && length <= parameters.side_split * base.length {
            return Ok(None);
        }
        if length < parameters.whole_below.max(LEAST) {
            return whole;
        }
        let middle = match parameters.division_at {
            DivisionAt::MetricMiddle => mesh.metric_middle(at, top),
            DivisionAt::Midpoint => 0.5 * (mesh.uv(at) + mesh.uv(top)),
        };
        let metric = source.metric(middle).map_err(|_| Why::NoMetric)?;
        if mesh.can_divide(h, middle).is_err() { whole } else { Ok(Some(Division { h, middle, metric, length })) }
    }
}
