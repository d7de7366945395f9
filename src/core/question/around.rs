//! What happens around a new quadrilateral (paper 4.3.6): swaps and removals of nodes.

use super::judged::{Hint, Judged};
use super::rule::Rule;
use crate::core::convert::Purpose;
use crate::core::kernel::number::degrees;
use crate::core::mesh::{ElementId, Mesh, NodeId};
use crate::core::run::explain::{angles_apart, angles_of_swap, edge};
use crate::core::run::{EdgeFacts, EdgeKind};

/// The edge that a swap replaces by a new one, found before the swap: both new ends see it.
pub(in crate::core) fn swapped(mesh: &Mesh, [c, d]: [NodeId; 2]) -> Option<[NodeId; 2]> {
    let around = mesh.fan(c).filter(|&h| mesh.is_triangle(h.element())).map(|h| mesh.next(h));
    let across = around.filter(|&h| mesh.live_twin(h).is_some_and(|t| mesh.apex(t) == d));
    across.map(|h| mesh.ends(h)).next()
}

/// Judges an edge as the one that is swapped beside the new quadrilateral.
pub(super) fn edge_is_swapped(mesh: &Mesh, right: [NodeId; 2], answer: [NodeId; 2]) -> Judged {
    let rule = Rule::Enhancement;
    let name = edge(answer);
    let Some([before, after]) = angles_of_swap(mesh, answer).or_else(|| angles_of_swap(mesh, [answer[1], answer[0]]))
    else {
        let dead = match EdgeFacts::of(mesh, answer[0], answer[1]).map(|facts| facts.kind) {
            Some(EdgeKind::Front) => "is on the front, and what is on the front is dead: it cannot be swapped",
            Some(_) => "is dead, so it cannot be swapped",
            None => "is no edge at this step",
        };
        return Judged::wrong(rule, vec![format!("{name} {dead}.")]);
    };
    let is_right = right == answer || [right[1], right[0]] == answer;
    let h = [answer, [answer[1], answer[0]]].into_iter().find_map(|[a, b]| mesh.half_edge_between(a, b));
    if !is_right && h.is_some_and(|h| mesh.can_swap(h).is_err()) {
        return Judged::wrong(rule, vec![format!("The two triangles at {name} are not convex together.")]);
    }
    let [from, to] = angles_apart(before, after);
    let falls = after < before;
    let verb = if falls { "falls" } else { "does not fall" };
    let change =
        format!("With a swap of {name} the largest angle of its two triangles {verb}: {from}\u{b0} to {to}\u{b0}.");
    if is_right {
        Judged::right(rule, vec![change])
    } else if falls {
        Judged::partly(rule, vec![change, format!("{} is looked at before it.", edge(right))])
    } else {
        Judged::wrong(rule, vec![change])
    }
}

/// Hints to the edge: around what, then what each swap does to the largest angle.
pub(super) fn hints_to_swap(mesh: &Mesh, quad: Option<ElementId>) -> Vec<Hint> {
    let Some(quad) = quad else { return Vec::new() };
    let first = format!("Look for a large angle of a triangle beside quadrilateral {}.", quad.0);
    let mut labels = Vec::new();
    for node in mesh.quad(quad) {
        for h in mesh.fan(node).filter(|&h| mesh.live_twin(h).is_some() && mesh.is_triangle(h.element())) {
            let ends = mesh.ends(h);
            let is_new = !labels
                .iter()
                .any(|(known, _): &([NodeId; 2], String)| known.contains(&ends[0]) && known.contains(&ends[1]));
            if let Some([before, after]) = angles_of_swap(mesh, ends).filter(|_| is_new && mesh.can_swap(h).is_ok()) {
                labels.push((ends, format!("{}\u{b0} to {}\u{b0}", degrees(before), degrees(after))));
            }
        }
    }
    vec![Hint::of(first), Hint { text: "A swap is done where the largest angle falls.".to_owned(), labels }]
}

/// Judges a node as the one that is removed.
pub(super) fn node_is_removed(mesh: &Mesh, right: NodeId, purpose: Purpose, answer: NodeId) -> Judged {
    let rule = match purpose {
        Purpose::Recovery => Rule::TopEdge,
        Purpose::Enhancement => Rule::Enhancement,
    };
    let name = answer.0;
    let triangles = mesh.elements_at(answer).filter(|&e| mesh.is_triangle(e)).count();
    let all = mesh.elements_at(answer).count();
    if answer == right {
        let place = match purpose {
            Purpose::Recovery => "It is in the way of the top edge",
            Purpose::Enhancement => "It stands beside the new quadrilateral",
        };
        let why = format!("{place} and has {triangles} triangles around it, and nothing else.");
        return Judged::right(rule, vec![why]);
    }
    let why = if mesh.is_fixed(answer) {
        format!("Node {name} lies on the boundary, so it is fixed.")
    } else if triangles < all {
        format!(
            "Node {name} has a quadrilateral, which is dead: only nodes with live triangles all around are removed."
        )
    } else if !(3..=4).contains(&triangles) {
        format!("Node {name} has {triangles} triangles: only nodes with three or four are removed.")
    } else if mesh.can_delete_node(answer).is_err() {
        format!("Without node {name} a triangle would be turned over.")
    } else {
        let why = format!("Node {name} has {triangles} triangles too, but node {} comes before it.", right.0);
        return Judged::partly(rule, vec![why]);
    };
    Judged::wrong(rule, vec![why])
}

/// A hint to the node.
pub(super) fn hints_to_node() -> Vec<Hint> {
    vec![
        Hint::of("A node is removed where only triangles are around it."),
        Hint::of("Count the triangles: three or four, no more."),
    ]
}
