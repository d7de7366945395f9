//! Recovery of the top edge (paper 4.3.4, definition of the top edge, i to vi; docs/algorithm.md, "Top edge"): swaps
//! along the line, one a step, with node removal where no swap is possible. Crossings are found exactly.

use super::event::{Event, Purpose, Why};
use super::front::{Done, Front};
use super::local::smooth::around_top as smooth_around;
use super::phase::{Attempt, Base, Phase};
use crate::core::kernel::predicates::orient;
use crate::core::mesh::{HalfEdgeId, Mesh, NodeId};

/// More edges across the top edge than this are not worth swapping.
pub(in crate::core) const MOST_CROSSINGS: usize = 24;
/// Swaps and removals of one recovery.
pub(in crate::core) const MOST_SWAPS: u8 = 48;

/// What a step of the recovery came to.
pub(super) enum Recovery {
    /// The edge is there.
    Found,
    /// Something was changed on the way.
    Changed(Event),
}

/// One step of the recovery of the top edge (top edge i to iv and vi).
pub(super) fn recover(
    front: &mut Front<'_>,
    base: Base,
    attempt: Attempt,
    tops: [NodeId; 2],
    swaps: u8,
) -> Result<Done, Why> {
    let [c, d] = tops;
    match recover_step(front.mesh, c, d, &[base.a, base.b, c, d])? {
        Recovery::Found => Ok((Phase::Form { base, attempt, tops }, Some(Event::TopFound { ends: tops, swaps }))),
        Recovery::Changed(_) if swaps == MOST_SWAPS => Err(Why::TopTooLong),
        Recovery::Changed(event) => {
            let smooths = front.parameters.top_smoothing && matches!(event, Event::TopSwapped { .. });
            Ok((Phase::RecoverTop { base, attempt, tops, swaps: swaps + 1, smooths }, Some(event)))
        }
    }
}

/// Local smoothing around C after a swap (top edge v): of the nodes that live triangles join to it.
pub(super) fn smooth(front: &mut Front<'_>, base: Base, attempt: Attempt, tops: [NodeId; 2], swaps: u8) -> Done {
    let nodes = smooth_around(front, tops);
    let event = (nodes > 0).then_some(Event::TopSmoothed { nodes });
    (Phase::RecoverTop { base, attempt, tops, swaps, smooths: false }, event)
}

/// One step of the recovery of the edge from C to D; nodes in `keep` are not removed.
pub(super) fn recover_step(mesh: &mut Mesh, c: NodeId, d: NodeId, keep: &[NodeId]) -> Result<Recovery, Why> {
    if mesh.are_joined(c, d) {
        return Ok(Recovery::Found);
    }
    let crossings = crossings(mesh, c, d)?;
    for &h in &crossings {
        if mesh.can_swap(h).is_ok() {
            // A swap that still crosses is only worth it where it brings an end of the new edge to C or D.
            let t = mesh.twin(h).ok_or(Why::NotDisc)?;
            let new = [mesh.apex(h), mesh.apex(t)];
            if crosses(mesh, new, c, d) && crossings.len() > 1 && !new.contains(&c) && !new.contains(&d) {
                continue;
            }
            let across = mesh.ends(h);
            mesh.swap(h);
            return Ok(Recovery::Changed(Event::TopSwapped { across, new }));
        }
    }
    // No swap is possible: remove a node that keeps one from being valid (iii).
    for &h in &crossings {
        for node in mesh.ends(h) {
            if !keep.contains(&node) && mesh.delete_node(node).is_ok() {
                return Ok(Recovery::Changed(Event::NodeRemoved { node, purpose: Purpose::Recovery }));
            }
        }
    }
    Err(Why::TopStuck)
}

/// Whether the line between two nodes crosses the line from C to D properly.
fn crosses(mesh: &Mesh, [e, f]: [NodeId; 2], c: NodeId, d: NodeId) -> bool {
    if [e, f].iter().any(|n| *n == c || *n == d) {
        return false;
    }
    let (e, f, c, d) = (mesh.uv(e), mesh.uv(f), mesh.uv(c), mesh.uv(d));
    (orient(c, d, e) > 0.0) != (orient(c, d, f) > 0.0) && (orient(e, f, c) > 0.0) != (orient(e, f, d) > 0.0)
}

/// The edges that the line from C to D crosses, from C on, all of them live.
pub(super) fn crossings(mesh: &Mesh, c: NodeId, d: NodeId) -> Result<Vec<HalfEdgeId>, Why> {
    let (p, q) = (mesh.uv(c), mesh.uv(d));
    // The triangle at C that holds the direction to D (ii).
    let mut start = None;
    for h in mesh.fan(c) {
        if !mesh.is_triangle(h.element()) {
            continue;
        }
        let (e, f) = (mesh.target(h), mesh.apex(h));
        let (at_e, at_f) = (orient(p, q, mesh.uv(e)), orient(p, q, mesh.uv(f)));
        if at_e < 0.0 && at_f > 0.0 {
            start = Some(mesh.next(h));
            break;
        }
        for (node, side) in [(e, at_e), (f, at_f)] {
            if side == 0.0 && (mesh.uv(node) - p).dot(q - p) > 0.0 {
                return Err(Why::TopThroughNode(node));
            }
        }
    }
    let Some(mut h) = start else { return Err(Why::NotDisc) };
    let mut found = Vec::new();
    loop {
        let ends = mesh.ends(h);
        let Some(t) = mesh.live_twin(h) else { return Err(Why::TopBlocked(ends)) };
        found.push(h);
        if found.len() > MOST_CROSSINGS {
            return Err(Why::TopTooLong);
        }
        let apex = mesh.apex(t);
        if apex == d {
            return Ok(found);
        }
        let side = orient(p, q, mesh.uv(apex));
        if side == 0.0 {
            return Err(Why::TopThroughNode(apex));
        }
        // t runs from the left end to the right one: leave between the apex and the end on its other side.
        h = if side > 0.0 { mesh.next(t) } else { mesh.previous(t) };
    }
}
