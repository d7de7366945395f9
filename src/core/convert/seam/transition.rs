//! What a transition seam begins with: the division of the longer segment.

use crate::core::convert::event::Unmerged;
use crate::core::convert::front::Front;
use crate::core::kernel::predicates::{convex, firm};
use crate::core::mesh::{HalfEdgeId, NewElement, NodeId};

/// Divides the long front segment PQ of a transition seam, one of whose ends is A, at its metric middle M; what is cut
/// off the quadrilateral beyond is live again. Drawn with A = P:
///
/// ```text
///          X                      X
///        /   \                  / | \
///       /     \                /  |  \
///      P-------Q      =>      P---M---Q        front before: P-Q
///      |       |              |    \  |        front after:  P-M-S-Q
///      |       |              |     \ |
///      R-------S              R-------S
/// ```
/// The quadrilateral keeps its id. Returns M.
pub fn divide_segment(front: &mut Front<'_>, a: NodeId, h_pq: HalfEdgeId) -> Result<NodeId, Unmerged> {
    let mesh = &*front.mesh;
    // Gather.
    let h_qp = mesh.twin(h_pq).ok_or(Unmerged::Unlike)?;
    let (live, quad) = (h_pq.element(), h_qp.element());
    let [p, q] = mesh.ends(h_pq);
    let x = mesh.apex(h_pq);
    let (h_pr, h_sq) = (mesh.next(h_qp), mesh.previous(h_qp));
    let (r, s) = (mesh.target(h_pr), mesh.origin(h_sq));
    // Check: the side that is freed must stay on the front.
    let freed = if a == p { h_sq } else { h_pr };
    if mesh.live_twin(freed).is_some() {
        return Err(Unmerged::Unlike);
    }
    let m_uv = mesh.metric_middle(p, q);
    let metric = front.source.metric(m_uv).map_err(|_| Unmerged::NotPositive)?;
    let [p_uv, q_uv, r_uv, s_uv, x_uv] = [p, q, r, s, x].map(|n| mesh.uv(n));
    let (shape, rest) = if a == p {
        (convex(m_uv, p_uv, r_uv, s_uv), firm(q_uv, m_uv, s_uv))
    } else {
        (convex(q_uv, m_uv, r_uv, s_uv), firm(m_uv, p_uv, r_uv))
    };
    if !(shape && rest && firm(p_uv, m_uv, x_uv) && firm(m_uv, q_uv, x_uv)) {
        return Err(Unmerged::NotPositive);
    }
    // Build: the quadrilateral first, so that it takes the id that is freed last, its own.
    let (region, level) = (mesh.region(quad), mesh.level(quad));
    let m = front.mesh.add_node(m_uv, metric);
    let (shape, rest) = if a == p { ([m, p, r, s], [q, m, s]) } else { ([q, m, r, s], [m, p, r]) };
    let new = [
        NewElement::quad(shape, region),
        NewElement::triangle(rest, region),
        NewElement::triangle([p, m, x], region),
        NewElement::triangle([m, q, x], region),
    ];
    let made = front.mesh.replace(&[live, quad], &new);
    debug_assert_eq!(made[0], quad, "the quadrilateral keeps its id");
    front.mesh.set_level(quad, level);
    let (quality, least) = (front.mesh.quality(quad), front.gates().quality);
    if quality < least { Err(Unmerged::Poor { quality, least }) } else { Ok(m) }
}
