//! What the front leaves over: small loops are closed (docs/algorithm.md, "Small loops"), and what cannot be closed is
//! converted by the last resort (docs/algorithm.md, "The last resort"), component by component and patch by patch.

mod ways;

use std::sync::Arc;

use super::event::Event;
use super::front::{Done, Front};
use super::last_resort::component::{Component, small_component};
use super::last_resort::{Outcome, Plan};
use super::phase::{Base, FinishPart, Phase};
use crate::core::fault::Fault;
use crate::core::mesh::{HalfEdgeId, Mesh};

/// Longer loops are left to the last resort.
pub(in crate::core) const MOST_SEGMENTS: usize = 10;

/// So are those with more triangles.
pub(in crate::core) const MOST_TRIANGLES: usize = 64;

/// Closes the loop of a segment from which no quadrilateral can be formed, where it is a small one; else puts the
/// segment off until something near it changes.
pub(super) fn close_or_defer(front: &mut Front<'_>, base: Base) -> Done {
    let segment = base.half_edge(front.mesh);
    let mark = front.mesh.mark();
    let component = segment.and_then(|h| component_beside(front.mesh, h));
    if let Some(event) = component.and_then(|component| ways::close(front.mesh, front.source, &component)) {
        front.refresh(mark);
        return (Phase::Select, Some(event));
    }
    if let Some(h) = segment {
        let (queue, mesh) = front.queue();
        queue.defer(mesh, h);
    }
    (Phase::Select, Some(Event::Deferred { a: base.a, b: base.b }))
}

/// The live component beside a front segment, where it has few triangles and the segment's loop is short.
fn component_beside(mesh: &Mesh, h: HalfEdgeId) -> Option<Component> {
    // The walk is short; collecting the triangles is more expensive.
    let is_short = mesh.front_loop(h).nth(MOST_SEGMENTS).is_none();
    is_short.then(|| small_component(mesh, h.element(), MOST_TRIANGLES)).flatten()
}

/// Closes the next small loop that is left over; what cannot be closed goes to the last resort together.
pub(super) fn close_next(front: &mut Front<'_>, mut waiting: Vec<Component>, mut left: Vec<Component>) -> Done {
    while let Some(component) = waiting.pop() {
        if let Some(event) = ways::close(front.mesh, front.source, &component) {
            return (Phase::Close { waiting, left }, Some(event));
        }
        left.push(component);
    }
    (Phase::Match { left: left.into(), at: 0 }, None)
}

/// Matches the triangles of the next component that is left over; past the last one all are converted.
pub(super) fn match_next(
    front: &mut Front<'_>,
    left: Arc<[Component]>,
    at: usize,
    so_far: Outcome,
) -> Result<Done, Fault> {
    let Some(component) = left.get(at) else {
        let next = if front.parameters.post_processing {
            Phase::PostProcess { part: FinishPart::FirstSmoothing }
        } else if front.face.is_some() {
            Phase::NextFace
        } else {
            Phase::Done
        };
        return Ok((next, Some(Event::LastResort(so_far))));
    };
    let plan = Plan::new(front.mesh, &component.triangles, front.source)
        .map_err(|stuck| Fault::new(format!("A part of the mesh cannot be converted: {stuck}")))?;
    let Outcome { triangles, unmatched, unmatched_at_all, .. } = plan.outcome();
    let event = Event::Matched { triangles, unmatched, unmatched_at_all, patches: plan.patches() };
    Ok((Phase::Patch { left, at, plan: Arc::new(plan), patch: 0 }, Some(event)))
}

/// Makes quadrilaterals of the next patch of the component at hand; `so_far` is what the last resort has done.
pub(super) fn patch(
    front: &mut Front<'_>,
    left: Arc<[Component]>,
    at: usize,
    plan: Arc<Plan>,
    patch: usize,
    so_far: &mut Outcome,
) -> Done {
    let made = plan.carry_out(front.mesh, patch);
    let (means, triangles) = (plan.means(patch), plan.triangles(patch).len());
    let event = Some(Event::Patched { means, triangles, quads: made.len(), element: made[0] });
    front.commit();
    if patch + 1 < plan.patches() {
        return (Phase::Patch { left, at, plan, patch: patch + 1 }, event);
    }
    *so_far += plan.outcome();
    (Phase::Match { left, at: at + 1 }, event)
}
