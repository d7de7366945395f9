//! Local post-processing around a new quadrilateral (paper 4.3.6): structural enhancement, then smoothing. Seaming and
//! splitting follow, in modules of their own.

pub(super) mod smooth;

use smallvec::SmallVec;

use super::event::{Event, Purpose};
use super::front::{Done, Front};
use super::phase::Phase;
use crate::core::case::EnhancementOrder;
use crate::core::kernel::Metric2;
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
        if deletes_first && let Some(event) = remove_a_node(front.mesh, element) {
            return (next(edges_around(front.mesh, element)), Some(event));
        }
        while let Some(h) = edges.pop() {
            if let Some((event, around)) = enhance_edge(front.mesh, h) {
                edges.extend(around);
                return (next(edges), Some(event));
            }
        }
        if !deletes_first && let Some(event) = remove_a_node(front.mesh, element) {
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

/// Removes one live node beside the quadrilateral that has three or four triangles (i), unless they are a cut grid.
fn remove_a_node(mesh: &mut Mesh, element: ElementId) -> Option<Event> {
    for corner in mesh.quad(element) {
        let around: SmallVec<[NodeId; 12]> = mesh.neighbours(corner).collect();
        for node in around {
            if !mesh.is_fixed(node) && !mesh.is_in_cut_grid(node) && mesh.delete_node(node).is_ok() {
                return Some(Event::NodeRemoved { node, purpose: Purpose::Enhancement });
            }
        }
    }
    None
}

/// Swaps the edge if that lowers the largest angle of its two triangles (ii). Returns the edges around it too.
fn enhance_edge(mesh: &mut Mesh, h: HalfEdgeId) -> Option<(Event, [HalfEdgeId; 4])> {
    if !mesh.has_element(h.element()) || !mesh.is_triangle(h.element()) {
        return None;
    }
    let t = mesh.live_twin(h)?;
    let (a, b) = (mesh.origin(h), mesh.origin(t));
    let (c, d) = (mesh.apex(h), mesh.apex(t));
    let before = least_cosine(mesh, [a, b, c]).min(least_cosine(mesh, [b, a, d]));
    // A largest angle below 90 degrees is no reason to change anything.
    if before > 0.0 {
        return None;
    }
    let after = least_cosine(mesh, [a, d, c]).min(least_cosine(mesh, [d, b, c]));
    if after <= before + 1e-6 || mesh.can_swap(h).is_err() {
        return None;
    }
    let h = mesh.swap(h);
    let t = mesh.twin(h)?;
    let around = [mesh.next(h), mesh.previous(h), mesh.next(t), mesh.previous(t)];
    Some((Event::Enhanced { new: mesh.ends(h) }, around))
}

/// Least cosine of a triangle's angles (that of its largest angle), each in the metric of its node.
fn least_cosine(mesh: &Mesh, n: [NodeId; 3]) -> f64 {
    let mut least = f64::INFINITY;
    for k in 0..3 {
        let m: &Metric2 = mesh.metric_ref(n[k]);
        let p = mesh.uv(n[k]);
        let (a, b) = (mesh.uv(n[(k + 1) % 3]) - p, mesh.uv(n[(k + 2) % 3]) - p);
        least = least.min(m.inner(a, b) / (m.norm2(a) * m.norm2(b)).sqrt());
    }
    least
}
