//! What happens to the top edge (paper 4.3.4, definition of the top edge).

use super::choice::Choice;
use super::judged::{Hint, Judged};
use super::rule::Rule;
use crate::core::convert::{Event, EventKind};
use crate::core::kernel::number::{counted, degrees};
use crate::core::kernel::predicates::orient;
use crate::core::mesh::{HalfEdgeId, Mesh, NodeId};
use crate::core::metric::measure::angle;
use crate::core::run::explain::edge;

const RULE: Rule = Rule::TopEdge;

/// What became of the top edge.
pub(super) fn right(event: &Event) -> Choice {
    match event.kind() {
        EventKind::TopFound => Choice::There,
        EventKind::TopSwapped => Choice::Swap,
        EventKind::NodeRemoved => Choice::Removal,
        _ => Choice::Failure,
    }
}

/// Why it did, from what lies across the top.
pub(super) fn why(mesh: &Mesh, top: [NodeId; 2], crossings: &[[NodeId; 2]], event: &Event) -> String {
    let name = edge(top);
    let lie = counted(crossings.len() as u64, "edge");
    let cross = if crossings.len() == 1 { "crosses" } else { "cross" };
    match event.kind() {
        EventKind::TopFound => format!("An edge joins the tops {name} already."),
        EventKind::TopSwapped => format!("{lie} {cross} {name}, and one of them can be swapped."),
        EventKind::NodeRemoved => {
            let reflex = crossings.iter().find_map(|ends| not_convex(mesh, *ends));
            let reflex = reflex.map_or(String::new(), |text| format!(" At the first of them, {text}."));
            format!("{lie} {cross} {name}, and none can be swapped so that less lies across.{reflex}")
        }
        _ => format!("What lies across {name} can neither be swapped nor removed."),
    }
}

/// Judges an edge as the one that is swapped for the top edge.
pub(super) fn edge_is_swapped(
    mesh: &Mesh,
    top: [NodeId; 2],
    crossings: &[[NodeId; 2]],
    across: [NodeId; 2],
    answer: [NodeId; 2],
) -> Judged {
    let is = |ends: [NodeId; 2]| ends == answer || [ends[1], ends[0]] == answer;
    let (name, line) = (edge(answer), edge(top));
    if is(across) {
        let why = format!("It crosses {line}, and its two triangles are convex together, so it can be swapped.");
        return Judged::right(RULE, vec![why]);
    }
    let Some(ends) = crossings.iter().copied().find(|ends| is(*ends)) else {
        let there =
            if mesh.are_joined(answer[0], answer[1]) { "does not cross" } else { "is no edge, and does not cross" };
        return Judged::wrong(RULE, vec![format!("{name} {there} the top edge {line}.")]);
    };
    if let Some(reason) = not_convex(mesh, ends) {
        let why = format!("It crosses {line}, but its two triangles are not convex together: {reason}.");
        return Judged::wrong(RULE, vec![why]);
    }
    if let Some(new) = crosses_again(mesh, ends, top).filter(|_| crossings.len() > 1) {
        let why = format!("A swap would make {}, which crosses {line} too, so nothing would be won.", edge(new));
        return Judged::wrong(RULE, vec![why]);
    }
    let why = format!("It crosses {line} and could be swapped, but {} lies nearer to C and comes first.", edge(across));
    Judged::partly(RULE, vec![why])
}

/// At which end of a live edge its two triangles make no convex corner, with the angle there in the metric.
fn not_convex(mesh: &Mesh, ends: [NodeId; 2]) -> Option<String> {
    let h = half_edge(mesh, ends)?;
    if mesh.can_swap(h).is_ok() {
        return None;
    }
    let t = mesh.twin(h)?;
    let [left, right] = [mesh.apex(h), mesh.apex(t)];
    // Seen from the origin, the right apex comes first anticlockwise; from the target, the left one.
    let corners = [(mesh.origin(h), right, left), (mesh.target(h), left, right)];
    let open = corners.into_iter().find(|(at, from, to)| orient(mesh.uv(*from), mesh.uv(*to), mesh.uv(*at)) <= 0.0);
    let Some((at, from, to)) = open else { return Some("a triangle would be too flat".to_owned()) };
    let here = mesh.uv(at);
    let angle = angle(mesh.metric_ref(at), mesh.uv(from) - here, mesh.uv(to) - here);
    Some(format!("the angle at node {} is {}\u{b0}", at.0, degrees(angle)))
}

/// The edge that a swap would make, where it crosses the top too and touches neither of its ends.
fn crosses_again(mesh: &Mesh, ends: [NodeId; 2], [c, d]: [NodeId; 2]) -> Option<[NodeId; 2]> {
    let h = half_edge(mesh, ends)?;
    let new = [mesh.apex(h), mesh.apex(mesh.twin(h)?)];
    if new.contains(&c) || new.contains(&d) {
        return None;
    }
    let [e, f, p, q] = [new[0], new[1], c, d].map(|node| mesh.uv(node));
    let is_between = |p, q, e, f| (orient(p, q, e) > 0.0) != (orient(p, q, f) > 0.0);
    (is_between(p, q, e, f) && is_between(e, f, p, q)).then_some(new)
}

fn half_edge(mesh: &Mesh, [a, b]: [NodeId; 2]) -> Option<HalfEdgeId> {
    mesh.half_edge_between(a, b).or_else(|| mesh.half_edge_between(b, a))
}

/// Hints: what crosses, then which of it makes a convex quadrilateral.
pub(super) fn hints(mesh: &Mesh, top: [NodeId; 2], crossings: &[[NodeId; 2]]) -> Vec<Hint> {
    let names: Vec<String> = crossings.iter().map(|ends| edge(*ends)).collect();
    let line = edge(top);
    if names.is_empty() {
        return vec![Hint::of(format!("Look whether an edge joins the tops {line}."))];
    }
    let across = crossings.iter().zip(1..).map(|(ends, place)| (*ends, format!("{place}")));
    let first =
        Hint { text: format!("From C on, {line} is crossed by {}.", names.join(", ")), labels: across.collect() };
    let verdicts = crossings.iter().map(|ends| {
        let text = match not_convex(mesh, *ends) {
            Some(_) => "not convex",
            None if crossings.len() > 1 && crosses_again(mesh, *ends, top).is_some() => "crosses again",
            None => "convex",
        };
        (*ends, text.to_owned())
    });
    let text = "Only an edge whose two triangles are convex together can be swapped.".to_owned();
    vec![first, Hint { text, labels: verdicts.collect() }]
}
