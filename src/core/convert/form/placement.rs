//! Placement of a new top node (docs/algorithm.md, "Placement of new top nodes").

use glam::DVec2;

use crate::core::case::Parameters;
use crate::core::convert::front::Front;
use crate::core::convert::phase::Base;
use crate::core::convert::side::choice::BaseSide;
use crate::core::convert::wall::{Onward, onward};
use crate::core::front::Side;
use crate::core::mesh::quality::length_over;
use crate::core::mesh::{ElementId, Mesh, NodeId};
use crate::core::metric::MetricSource;
use crate::core::metric::measure::quad_quality;

/// The parallelogram's corner is all that counts for a base that is too long or too short by this much.
const OFF: f64 = 0.2;
/// A placed node leaves the quadrilateral at least this quality,
const LEAST_QUALITY: f64 = 0.2;
/// or this share of what it had.
const KEPT_QUALITY: f64 = 0.7;

/// Where a new top node is to go, before anything is moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// The place at unit metric length along the side's target direction.
    pub unit: DVec2,
    /// The angle between the base and that direction, radians.
    pub target: f64,
    /// From the other top to the corner of the parallelogram.
    pub along_base: DVec2,
    /// The share of the parallelogram's corner.
    pub share: f64,
    /// Where the top follows on a stem of a wall (docs/algorithm.md, "Rows at walls"), its row, from 1: it is to go to
    /// the unit place, which is then that of the row, and has no share of the parallelogram's corner.
    pub row: Option<u32>,
}

impl Aim {
    /// The aim of the top of a side; `None` where the field gives no metric on the way.
    pub fn of(mesh: &Mesh, source: &dyn MetricSource, parameters: &Parameters, base: &Base, side: Side) -> Option<Aim> {
        let here = BaseSide { mesh, parameters, base, side };
        if let Some(Onward { place, row }) = onward(mesh, source, base.node(side), base.level) {
            let target = here.angle(place);
            return Some(Aim { unit: place, target, along_base: DVec2::ZERO, share: 0.0, row: Some(row) });
        }
        let target = here.target_angle();
        let unit = unit_place(mesh, source, base, side, target)?;
        // The top is to have unit length, not the base's: rows that run into larger or smaller sizes would never change
        // the number of their columns, and drift away from the metric. The side leans for it, and the next one more,
        // until a column begins or ends; one that may stand upright would give the top the base's length again.
        let widen = (1.0 / base.length).clamp(0.5, 2.0);
        let along_base = (mesh.uv(base.node(side)) - mesh.uv(base.node(side.other()))) * widen;
        let share = (0.5 + 0.5 * (base.length - 1.0).abs() / OFF).min(1.0);
        Some(Aim { unit, target, along_base, share, row: None })
    }

    /// The place, once the other top is at its own.
    pub fn place(&self, other_top: DVec2) -> DVec2 {
        self.unit.lerp(other_top + self.along_base, self.share)
    }
}

/// Why a top node is not placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stays {
    /// It was on the front already.
    OnFront,
    /// It belongs to a grid of the background that was cut into triangles.
    InCutGrid,
    /// Nodes are not placed (`placement`).
    SwitchedOff,
    /// It is fixed.
    Fixed,
    /// The field gives no metric where it would go.
    NoMetric,
}

/// Whether a top node is to be placed: where it is to go, or why it stays. True of the mesh before the quadrilateral is
/// merged, as of that after it, but for what is on the front.
pub fn judge(
    mesh: &Mesh,
    source: &dyn MetricSource,
    parameters: &Parameters,
    base: &Base,
    side: Side,
    top: NodeId,
) -> Result<Aim, Stays> {
    if mesh.is_on_front(top) {
        Err(Stays::OnFront)
    } else if !parameters.placement {
        Err(Stays::SwitchedOff)
    } else if mesh.is_in_cut_grid(top) {
        Err(Stays::InCutGrid)
    } else if mesh.is_fixed(top) {
        Err(Stays::Fixed)
    } else {
        Aim::of(mesh, source, parameters, base, side).ok_or(Stays::NoMetric)
    }
}

/// Places a new top node between the place at unit metric length along the side's target direction and the
/// parallelogram's corner, as far as everything around stays valid and good.
pub fn place(front: &mut Front<'_>, element: ElementId, aim: &Aim, [node, other_top]: [NodeId; 2]) {
    let mesh = &*front.mesh;
    let here = mesh.uv(node);
    let there = aim.place(mesh.uv(other_top));
    let old = mesh.quality(element);
    let nodes = mesh.quad(element);
    let mut step = 1.0;
    for _ in 0..4 {
        let place = here + (there - here) * step;
        step *= 0.5;
        let Ok(metric) = front.source.metric(place) else { continue };
        let quality = quad_quality(
            nodes.map(|n| if n == node { &metric } else { mesh.metric_ref(n) }),
            nodes.map(|n| if n == node { place } else { mesh.uv(n) }),
        );
        if (quality >= LEAST_QUALITY || quality >= KEPT_QUALITY * old) && mesh.can_move(node, place).is_ok() {
            front.mesh.move_node(node, place, metric);
            return;
        }
    }
}

/// The place at unit metric length from the base's node along the side's target direction, by three corrections.
fn unit_place(mesh: &Mesh, source: &dyn MetricSource, base: &Base, side: Side, target: f64) -> Option<DVec2> {
    let (at, other) = (base.node(side), base.node(side.other()));
    let (p, m) = (mesh.uv(at), mesh.metric_ref(at));
    let along = mesh.uv(other) - p;
    let along = along / m.norm2(along).sqrt();
    // The unit vector of the metric perpendicular to the base, on the live side.
    let normal = {
        let t = m.times(along);
        let w = match side {
            Side::Left => DVec2::new(-t.y, t.x),
            Side::Right => DVec2::new(t.y, -t.x),
        };
        w / m.norm2(w).sqrt()
    };
    let (sin, cos) = libm::sincos(target);
    let direction = along * cos + normal * sin;
    let mut reach = 1.0;
    for _ in 0..3 {
        let metric = source.metric(p + direction * reach).ok()?;
        let length = length_over(m, &metric, direction * reach);
        reach = (reach / length).clamp(0.2 * reach, 5.0 * reach);
    }
    Some(p + direction * reach)
}
