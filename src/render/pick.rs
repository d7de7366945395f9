//! What is under the pointer: a node, an edge or front segment, or an element.

mod space;

use glam::DVec2;

pub use space::{Cover, Hit, hit, pick_in_space};

use super::scene::Outlined;
use crate::core::mesh::{ElementId, HalfEdgeId, Mesh, NodeId};

/// How close the pointer must be, in points: to a node, to an edge, to a front segment.
const NEAR: [f64; 3] = [7.0, 4.0, 7.0];

/// The element that contains `p`, if any. The search starts at `hint` and its surroundings.
pub fn element_at(mesh: &Mesh, p: DVec2, hint: Option<ElementId>) -> Option<ElementId> {
    let contains = |e: ElementId| {
        mesh.half_edges(e).all(|h| {
            let (a, b) = (mesh.uv(mesh.origin(h)), mesh.uv(mesh.target(h)));
            (b - a).perp_dot(p - a) >= 0.0
        })
    };
    let hint = hint.filter(|e| mesh.has_element(*e));
    let around = hint.into_iter().flat_map(|e| {
        let beyond = mesh.half_edges(e).filter_map(|h| mesh.twin(h)).map(HalfEdgeId::element);
        std::iter::once(e).chain(beyond)
    });
    let mut near = around.filter(|e| contains(*e));
    near.next().or_else(|| mesh.elements().find(|e| contains(*e)))
}

/// What is at a position: `p` in the plane, `at` on the screen; `project` maps the plane to the screen. Front segments
/// precede other edges, and small items precede large ones.
pub fn pick(
    mesh: &Mesh,
    p: DVec2,
    at: DVec2,
    project: &dyn Fn(DVec2) -> DVec2,
    hint: Option<ElementId>,
) -> Option<Outlined> {
    let inside = element_at(mesh, p, hint);
    // Outside the mesh, a thick front segment on the boundary can still be hit.
    let sides: Vec<HalfEdgeId> = match inside {
        Some(e) => {
            // The sides of the element, and those that leave its corners: a short one beside it may be closer.
            let corners: Vec<NodeId> = mesh.corners(e).collect();
            let spokes = corners.iter().flat_map(|n| mesh.fan(*n));
            spokes.flat_map(|h| [h, mesh.previous(h)]).chain(mesh.half_edges(e)).collect()
        }
        None => mesh.elements().flat_map(|e| mesh.half_edges(e)).filter(|h| mesh.twin(*h).is_none()).collect(),
    };
    nearest(mesh, &sides, at, &|n| project(mesh.uv(n)), &|_, _| true).or(inside.map(Outlined::Element))
}

/// The node or edge, among these sides, that is close enough to be picked. `place` gives the screen position of a node;
/// `is_seen` says whether the point at a parameter between two nodes is visible.
fn nearest(
    mesh: &Mesh,
    sides: &[HalfEdgeId],
    at: DVec2,
    place: &dyn Fn(NodeId) -> DVec2,
    is_seen: &dyn Fn([NodeId; 2], f64) -> bool,
) -> Option<Outlined> {
    let node_distance = |n: NodeId| place(n).distance(at);
    let nodes = sides.iter().map(|h| mesh.origin(*h)).map(|n| (node_distance(n), n));
    let nearest_node = nodes
        .filter(|n| n.0 <= NEAR[0] && is_seen([n.1; 2], 0.0))
        .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let edges = sides.iter().filter_map(|&h| {
        let ends = mesh.ends(h);
        let on_front = front_side(mesh, h);
        let reach = if on_front.is_some() { NEAR[2] } else { NEAR[1] };
        let [a, b] = ends.map(place);
        let share = share(at, a, b);
        let away = at.distance(a.lerp(b, share));
        // Name a segment in its own direction, from A to B.
        let directed = on_front.map_or(ends, |f| mesh.ends(f));
        (away <= reach && is_seen(ends, share)).then_some((on_front.is_none(), away, a.distance(b), directed))
    });
    let nearest_edge = edges.min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.3.cmp(&b.3)));
    match (nearest_node, nearest_edge) {
        // On an edge that is short on the screen, the nodes would leave nothing to hit.
        (Some((_, node)), edge) if edge.is_none_or(|e| e.2 > 3.0 * NEAR[0]) => Some(Outlined::Node(node)),
        (_, Some((_, _, _, ends))) => Some(Outlined::Edge(ends)),
        (Some((_, node)), _) => Some(Outlined::Node(node)),
        (None, None) => None,
    }
}

/// The half-edge of an edge that is a front segment, if any.
fn front_side(mesh: &Mesh, h: HalfEdgeId) -> Option<HalfEdgeId> {
    if mesh.is_front(h) { Some(h) } else { mesh.twin(h).filter(|t| mesh.is_front(*t)) }
}

/// The parameter (0 to 1) of the point from `a` to `b` closest to `p`.
fn share(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    if along == DVec2::ZERO { 0.0 } else { ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::fixtures::square;

    #[test]
    fn nodes_go_before_edges_and_edges_before_elements() {
        let mesh = square();
        let project = |p: DVec2| p * 100.0;
        let at = |x: f64, y: f64| pick(&mesh, DVec2::new(x, y), DVec2::new(x, y) * 100.0, &project, None);
        assert_eq!(at(0.02, 0.02), Some(Outlined::Node(NodeId(0))));
        assert_eq!(at(0.5, 0.03), Some(Outlined::Edge([NodeId(0), NodeId(1)])));
        assert_eq!(at(0.7, 0.3), Some(Outlined::Element(ElementId(0))));
        assert_eq!(at(0.51, 0.5), Some(Outlined::Edge([NodeId(0), NodeId(2)])));
        assert_eq!(at(0.5, -0.05), Some(Outlined::Edge([NodeId(0), NodeId(1)])), "a thick line from outside");
        assert_eq!(at(0.5, -0.5), None);
    }

    #[test]
    fn a_hint_changes_nothing_of_what_is_found() {
        let mesh = square();
        let p = DVec2::new(0.2, 0.8);
        for hint in [None, Some(ElementId(0)), Some(ElementId(1)), Some(ElementId(99))] {
            assert_eq!(element_at(&mesh, p, hint), Some(ElementId(1)));
        }
    }
}
