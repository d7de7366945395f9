//! Local post-processing around a new quadrilateral (paper 4.3.6): structural enhancement, then smoothing. Seaming and
//! splitting follow, in modules of their own.

pub(super) mod smooth;

use smallvec::SmallVec;

use super::event::{Event, Purpose};
use super::front::{Done, Front};
use super::phase::Phase;
use crate::core::case::EnhancementOrder;
use crate::core::mesh::{ElementId, HalfEdgeId, Mark, Mesh, NodeId};

/// Looks at edges for one enhancement: four times a ring's size (docs/algorithm.md, "Structural enhancement").
const ENHANCEMENTS: u8 = 48;

/// The first phase of the local post-processing around a new quadrilateral; the queue has not seen what the journal
/// holds since the mark.
pub(super) fn begin(front: &Front<'_>, element: ElementId, mark: Mark) -> Phase {
    if front.parameters.enhancement {
        Phase::Enhance { element, mark, edges: edges_around(front.mesh, element), budget: ENHANCEMENTS }
    } else {
        Phase::Smooth { element, mark }
    }
}

/// One structural enhancement (4.3.6): the removal of a node (i), or a swap (ii). Which is tried first, the parameters
/// say.
pub(super) fn enhance(
    front: &mut Front<'_>,
    element: ElementId,
    mark: Mark,
    mut edges: SmallVec<[HalfEdgeId; 24]>,
    budget: u8,
) -> Done {
    let next = |edges| match budget - 1 {
        0 => Phase::Smooth { element, mark },
        budget => Phase::Enhance { element, mark, edges, budget },
    };
    if front.parameters.enhancement {
        let deletes_first = front.parameters.enhancement_order == EnhancementOrder::DeleteFirst;
        if deletes_first && let Some(event) = remove_a_node(front, element) {
            return (next(edges_around(front.mesh, element)), Some(event));
        }
        // Several of them are one edge: a second look, before anything has changed, finds the same.
        let mut seen: SmallVec<[HalfEdgeId; 24]> = SmallVec::new();
        while let Some(h) = edges.pop() {
            let Some(t) = live_pair(front.mesh, h).filter(|&t| !seen.contains(&h.min(t))) else { continue };
            seen.push(h.min(t));
            if let Some((event, around)) = enhance_edge(front.mesh, [h, t]) {
                edges.extend(around);
                return (next(edges), Some(event));
            }
        }
        if !deletes_first && let Some(event) = remove_a_node(front, element) {
            return (next(edges_around(front.mesh, element)), Some(event));
        }
    }
    (Phase::Smooth { element, mark }, None)
}

/// Smoothing (4.3.6): one sweep over the nodes around. The queue then sees everything since the base was selected.
pub(super) fn smooth(front: &mut Front<'_>, element: ElementId, mark: Mark) -> Done {
    let event = front.parameters.smoothing.then(|| Event::Smoothed { nodes: smooth::around(front, element) });
    front.refresh(mark);
    (Phase::Seam { element, nodes: SmallVec::from_slice(&front.mesh.quad(element)) }, event)
}

/// Live edges around a quadrilateral: those at its nodes and those opposite to them.
fn edges_around(mesh: &Mesh, element: ElementId) -> SmallVec<[HalfEdgeId; 24]> {
    let mut edges = SmallVec::new();
    for node in mesh.quad(element) {
        for h in mesh.live_fan(node) {
            edges.extend([h, mesh.next(h)].into_iter().filter(|&h| mesh.live_twin(h).is_some()));
        }
    }
    edges
}

/// Removes one live node beside the quadrilateral that has three or four triangles (i); with placement on, not where
/// they are a cut grid.
fn remove_a_node(front: &mut Front<'_>, element: ElementId) -> Option<Event> {
    let (mesh, placement) = (&mut *front.mesh, front.parameters.placement);
    let stays = |n: NodeId| mesh.is_fixed(n) || (placement && mesh.is_in_cut_grid(n));
    let removable = |&n: &NodeId| mesh.can_delete_node(n).is_ok() && !stays(n);
    // Only triangles are around such a node, so both at its edge are live.
    let live = |h: &HalfEdgeId| mesh.live_twin(*h).is_some();
    let beside = |corner| mesh.live_fan(corner).filter(live).map(|h| mesh.target(h)).find(removable);
    let node = mesh.quad(element).into_iter().find_map(beside)?;
    mesh.delete_node(node).ok()?;
    Some(Event::NodeRemoved { node, purpose: Purpose::Enhancement })
}

/// The other half of an edge between two live triangles; none where an earlier change removed it.
fn live_pair(mesh: &Mesh, h: HalfEdgeId) -> Option<HalfEdgeId> {
    if mesh.has_element(h.element()) && mesh.is_triangle(h.element()) { mesh.live_twin(h) } else { None }
}

/// Swaps the edge if that lowers the largest angle of its two triangles (ii). Returns the edges around it too.
fn enhance_edge(mesh: &mut Mesh, [h, t]: [HalfEdgeId; 2]) -> Option<(Event, [HalfEdgeId; 4])> {
    let (a, b) = (mesh.origin(h), mesh.origin(t));
    let (c, d) = (mesh.apex(h), mesh.apex(t));
    // A largest angle below 90 degrees is no reason to change anything.
    if is_acute(mesh, [a, b, c]) && is_acute(mesh, [b, a, d]) {
        return None;
    }
    let before = least_cosine(mesh, [a, b, c]).min(least_cosine(mesh, [b, a, d]));
    let stays = |n| least_cosine(mesh, n) <= before + 1e-6;
    if stays([a, d, c]) || stays([d, b, c]) || mesh.can_swap(h).is_err() {
        return None;
    }
    let h = mesh.swap(h);
    let t = mesh.twin(h)?;
    let around = [mesh.next(h), mesh.previous(h), mesh.next(t), mesh.previous(t)];
    Some((Event::Enhanced { new: mesh.ends(h) }, around))
}

/// Whether the angles of a triangle, each in the metric of its node, are all below 90 degrees.
fn is_acute(mesh: &Mesh, n: [NodeId; 3]) -> bool {
    let [(a, m_a), (b, m_b), (c, m_c)] = n.map(|n| mesh.place(n));
    m_a.inner(b - a, c - a) > 0.0 && m_b.inner(c - b, a - b) > 0.0 && m_c.inner(a - c, b - c) > 0.0
}

/// Least cosine of a triangle's angles (that of its largest angle), each in the metric of its node.
fn least_cosine(mesh: &Mesh, n: [NodeId; 3]) -> f64 {
    let corners = n.map(|n| mesh.place(n));
    let mut least = f64::INFINITY;
    for k in 0..3 {
        let ((p, m), (q, _), (r, _)) = (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
        let (a, b) = (q - p, r - p);
        let inner = m.inner(a, b);
        // A positive cosine is not the least beside one that is not.
        if inner <= 0.0 || least > 0.0 {
            least = least.min(inner / (m.norm2(a) * m.norm2(b)).sqrt());
        }
    }
    least
}
