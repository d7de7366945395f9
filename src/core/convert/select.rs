//! Base segment selection (paper 4.3.3).

use super::event::Event;
use super::front::{Done, Front};
use super::last_resort::component::live_components;
use super::phase::{Attempt, Base, Phase};
use crate::core::front::{BaseChoice, Segment, Side};
use crate::core::mesh::{HalfEdgeId, Mesh, NodeId};

/// Selects the base segment by the rules (4.3.3, steps i to iii), or takes the one that a person picked. Where every
/// segment is deferred, all are taken up once more with wider gates; after that what is left over is closed.
pub(super) fn select(front: &mut Front<'_>, picked: Option<[NodeId; 2]>) -> Done {
    front.commit();
    let parameters = front.parameters;
    let picked = match picked {
        Some([a, b]) => match front_segment(front.mesh, a, b) {
            Some(h) => Some(Segment::measure(front.mesh, h, parameters)),
            None => return (Phase::Select, Some(Event::PickLost { a, b })),
        },
        None => None,
    };
    let (queue, mesh) = front.queue();
    let by_rule = queue.select(mesh, parameters);
    let choice = picked.map_or(by_rule, |segment| Some(BaseChoice::of_person(segment, by_rule, parameters)));
    let Some(BaseChoice { segment, h_min, deferred, within_reach }) = choice else {
        return all_deferred(front);
    };
    let Segment { a, b, h_value, length_metric, length_physical, theta, class, level, .. } = segment;
    let attempt = Attempt { number: 0, divide: [false; 2], tops: [None; 2], mark: front.mesh.mark() };
    let base = Base { a, b, theta, length: length_metric, level };
    let event = Event::BaseSelected {
        a,
        b,
        h_value,
        h_min,
        deferred,
        key: segment.window(parameters.selection_window),
        reach: parameters.c * h_min,
        class,
        theta,
        length_metric,
        length_physical,
        level,
        within_reach,
        selection: parameters.selection,
        picked: picked.is_some(),
    };
    (Phase::PrepareSide { base, attempt, side: Side::Left, left: None }, Some(event))
}

/// The front segment from one node to another, either of which may be gone.
pub(super) fn front_segment(mesh: &Mesh, a: NodeId, b: NodeId) -> Option<HalfEdgeId> {
    if mesh.has_node(a) && mesh.has_node(b) { mesh.front_between(a, b) } else { None }
}

/// Takes every segment up again, once; the second time what is left over is to be closed.
fn all_deferred(front: &mut Front<'_>) -> Done {
    let parameters = front.parameters;
    if !*front.second_pass {
        let (queue, mesh) = front.queue();
        if queue.take_up_all(mesh, parameters) {
            *front.second_pass = true;
            return (Phase::Select, Some(Event::SecondPass));
        }
    }
    let mut waiting = live_components(front.mesh, front.face);
    waiting.reverse();
    (Phase::Close { waiting, left: Vec::new() }, None)
}
