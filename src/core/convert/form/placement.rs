//! Placement of a new top node (docs/algorithm.md, "Placement of new top nodes").

use glam::DVec2;

use crate::core::convert::front::Front;
use crate::core::convert::phase::Base;
use crate::core::convert::side::choice::BaseSide;
use crate::core::front::Side;
use crate::core::mesh::quality::length_over;
use crate::core::mesh::{ElementId, NodeId};
use crate::core::metric::measure::quad_quality;

/// The parallelogram's corner is all that counts for a base that is too long or too short by this much.
const OFF: f64 = 0.2;

/// Places a new top node between the place at unit metric length along the side's target direction and the
/// parallelogram's corner, as far as everything around stays valid and good.
pub fn place(front: &mut Front<'_>, base: &Base, element: ElementId, side: Side, tops: [NodeId; 2]) {
    let mesh = &*front.mesh;
    let (node, other_top) = (tops[side.index()], tops[side.other().index()]);
    if mesh.is_fixed(node) {
        return;
    }
    let (p, here) = (mesh.uv(base.node(side)), mesh.uv(node));
    let Some(unit) = unit_place(front, base, side) else { return };
    // The top is to have unit length, not the base's: rows that run into larger or smaller sizes would never change the
    // number of their columns, and drift away from the metric. The side leans for it, and the next one more, until a
    // column begins or ends; one that may stand upright would give the top the base's length again.
    let widen = (1.0 / base.length).clamp(0.5, 2.0);
    let parallel = mesh.uv(other_top) + (p - mesh.uv(base.node(side.other()))) * widen;
    let share = (0.5 + 0.5 * (base.length - 1.0).abs() / OFF).min(1.0);
    let there = unit.lerp(parallel, share);
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
        if (quality >= 0.2 || quality >= 0.7 * old) && mesh.can_move(node, place).is_ok() {
            front.mesh.move_node(node, place, metric);
            return;
        }
    }
}

/// The place at unit metric length from the base's node along the side's target direction, by three corrections.
fn unit_place(front: &Front<'_>, base: &Base, side: Side) -> Option<DVec2> {
    let mesh = &*front.mesh;
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
    let target = BaseSide { mesh, parameters: front.parameters, base, side }.target_angle();
    let (sin, cos) = libm::sincos(target);
    let direction = along * cos + normal * sin;
    let mut reach = 1.0;
    for _ in 0..3 {
        let metric = front.source.metric(p + direction * reach).ok()?;
        let length = length_over(m, &metric, direction * reach);
        reach = (reach / length).clamp(0.2 * reach, 5.0 * reach);
    }
    Some(p + direction * reach)
}
