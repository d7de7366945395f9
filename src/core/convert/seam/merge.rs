//! Two nodes of the front made one, for seams (fig. 18c) and splits (fig. 19).

use crate::core::convert::event::Unmerged;
use crate::core::convert::front::Front;
use crate::core::mesh::{ElementId, HalfEdgeId, Mesh, NodeId};

/// Collapses a live edge between two nodes of the front at the fixed end, else in the middle or as near to it as stays
/// valid and, as far as elements are `judged`, good. Returns the merged node.
pub fn merge(
    front: &mut Front<'_>,
    h_bc: HalfEdgeId,
    judged: &dyn Fn(&Mesh, ElementId) -> bool,
) -> Result<NodeId, Unmerged> {
    let [b, c] = front.mesh.ends(h_bc);
    let h_cb = front.mesh.twin(h_bc).ok_or(Unmerged::BothFixed)?;
    let (gone, kept, h) = if front.mesh.is_fixed(b) { (c, b, h_cb) } else { (b, c, h_bc) };
    if front.mesh.is_fixed(gone) {
        return Err(Unmerged::BothFixed);
    }
    // The nodes opposite to the edge lose one edge each: fewer than three (on a boundary, two) would be a doublet.
    for opposite in [h_bc, h_cb].map(|h| front.mesh.apex(h)) {
        if front.mesh.valence(opposite) < if front.mesh.is_on_boundary(opposite) { 3 } else { 4 } {
            return Err(Unmerged::Doublet);
        }
    }
    let (from, to) = (front.mesh.uv(kept), front.mesh.uv(gone));
    let shares: &[f64] = if front.mesh.is_fixed(kept) { &[0.0] } else { &[0.5, 0.35, 0.65, 0.2, 0.8, 0.0, 1.0] };
    let least = 0.7 * worst_quality(front.mesh, [gone, kept]).min(0.3);
    let mut why = Unmerged::NotPositive;
    for &share in shares {
        let place = from + (to - from) * share;
        let Ok(metric) = front.source.metric(place) else { continue };
        if front.mesh.can_collapse(h, place).is_err() {
            continue;
        }
        let mark = front.mesh.mark();
        front.mesh.collapse(h, place, metric);
        let mesh = &*front.mesh;
        let around = mesh.elements_at(kept).filter(|&e| judged(mesh, e));
        let quality = around.map(|e| mesh.quality(e)).fold(f64::INFINITY, f64::min);
        if quality >= least {
            return Ok(kept);
        }
        why = Unmerged::Poor { quality, least };
        front.mesh.take_back(mark);
    }
    Err(why)
}

/// The worst quality of the quadrilaterals at two nodes.
fn worst_quality(mesh: &Mesh, nodes: [NodeId; 2]) -> f64 {
    let quads = nodes.into_iter().flat_map(|n| mesh.elements_at(n)).filter(|&e| mesh.is_quad(e));
    quads.map(|e| mesh.quality(e)).fold(f64::INFINITY, f64::min)
}
