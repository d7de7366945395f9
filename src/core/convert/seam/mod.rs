//! Front segment seaming (paper 4.3.6, fig. 18): two adjacent front segments with a small angle become one dead edge.
//! Where one is much longer than the other, it is divided first: a transition seam (after Owen et al. 1999).
//! Deliberately absent: their transition split, for unlike segments at angles that are not small; it may never end
//! (docs/algorithm.md, "Seaming").

pub(super) mod merge;
mod transition;

use std::f64::consts::FRAC_PI_2;

use smallvec::SmallVec;

use super::event::{Event, SeamCorner, Unmerged};
use super::front::{Done, Front};
use super::phase::Phase;
use super::top::{MOST_SWAPS, Recovery, recover_step};
use crate::core::case::Parameters;
use crate::core::front::Side;
use crate::core::mesh::{ElementId, HalfEdgeId, NodeId};

/// Segments whose lengths differ by more than this factor need a transition seam.
pub(in crate::core) const MOST_UNLIKE: f64 = 2.5;
/// Seams are widened where the segments around are shorter than this on average, in the metric, the more the shorter:
/// where sizes grow ahead of the front, columns must end, and this is where they do (docs/algorithm.md, "Seaming").
pub(in crate::core) const SHORT: f64 = 0.97;
/// Of this length and below, they are widened as far as they may be.
const SHORTEST: f64 = 0.82;
/// Segments on each side of the node whose lengths count for that: two alone may be short by chance.
pub(in crate::core) const AROUND: usize = 3;

/// One seam (4.3.6) at a node of the new quadrilateral, or why one is refused.
pub(super) fn step(front: &mut Front<'_>, element: ElementId, mut nodes: SmallVec<[NodeId; 8]>) -> Done {
    while front.parameters.seaming
        && let Some(at) = nodes.pop()
    {
        let mark = front.mesh.mark();
        let Some(event) = seam_at(front, at) else { continue };
        if let Event::Seamed { node, .. } | Event::TransitionSeamed { node, .. } = event {
            front.refresh(mark);
            nodes.push(node);
        }
        let next = if nodes.is_empty() { Phase::Split { element } } else { Phase::Seam { element, nodes } };
        return (next, Some(event));
    }
    (Phase::Split { element }, None)
}

/// Seams at a node of the front where the frontal angle is small enough and the guards hold (docs/algorithm.md,
/// "Seaming"); says why it refuses where they do not. A failed try is taken back.
fn seam_at(front: &mut Front<'_>, at: NodeId) -> Option<Event> {
    if !front.mesh.has_node(at) {
        return None;
    }
    let mut refused = None;
    let segments: SmallVec<[HalfEdgeId; 4]> = front.mesh.fan(at).filter(|&h| front.mesh.is_front(h)).collect();
    for h in segments {
        let mesh = &*front.mesh;
        // None of the angles below is wider than this; most ends of segments are settled here.
        if front.parameters.theta_seam <= FRAC_PI_2 && mesh.opens_wide(h) {
            continue;
        }
        let before = mesh.front_before(h);
        let [l_b, l_c] = [h, before].map(|h| mesh.length(h));
        let corner = corner(front, h, [l_b, l_c]);
        if corner.angle > corner.widest {
            continue;
        }
        let (b, c) = (mesh.target(h), mesh.origin(before));
        let mark = mesh.mark();
        let seamed = if corner.ratio > MOST_UNLIKE {
            let long = if l_b > l_c { h } else { before };
            transition::divide_segment(front, at, long).and_then(|middle| {
                let (b, c) = if l_b > l_c { (middle, c) } else { (b, middle) };
                let [node, gone] = seam(front, at, b, c)?;
                Ok(Event::TransitionSeamed { at, node, gone, corner })
            })
        } else {
            seam(front, at, b, c).map(|[node, gone]| Event::Seamed { at, node, gone, corner })
        };
        match seamed {
            Ok(event) => return Some(event),
            Err(why) => {
                front.mesh.take_back(mark);
                refused = refused.or(Some(Event::SeamRefused { at, ends: [b, c], corner, why }));
            }
        }
    }
    refused
}

/// Looks at the corner between a front segment, whose half-edge leaves the node, and the one before it, with these
/// metric lengths.
fn corner(front: &Front<'_>, h: HalfEdgeId, [l_b, l_c]: [f64; 2]) -> SeamCorner {
    let mesh = &*front.mesh;
    let Parameters { theta_seam, seam_widening, .. } = *front.parameters;
    let (mut after, mut before, mut sum) = (h, mesh.front_before(h), l_b + l_c);
    for _ in 1..AROUND {
        (after, before) = (mesh.front_after(after), mesh.front_before(before));
        sum += mesh.length(after) + mesh.length(before);
    }
    let length = sum / (2 * AROUND) as f64;
    let short = ((SHORT - length) / (SHORT - SHORTEST)).clamp(0.0, 1.0);
    // A right angle is a corner of a row.
    let widest = (theta_seam * (1.0 + (seam_widening - 1.0) * short)).min(FRAC_PI_2.max(theta_seam));
    SeamCorner {
        angle: mesh.frontal_angle(h, Side::Left),
        theta_seam,
        widest,
        length,
        ratio: l_b.max(l_c) / l_b.min(l_c),
    }
}

/// Recovers the edge between the far ends, empties the triangle, and merges the ends. Returns the merged node and the
/// one removed.
fn seam(front: &mut Front<'_>, a: NodeId, b: NodeId, c: NodeId) -> Result<[NodeId; 2], Unmerged> {
    let mesh = &*front.mesh;
    if mesh.is_fixed(b) && mesh.is_fixed(c) {
        return Err(Unmerged::BothFixed);
    }
    // A keeps at least three edges (or two on a boundary): else it would be a doublet.
    if mesh.valence(a) < if mesh.is_on_boundary(a) { 3 } else { 4 } {
        return Err(Unmerged::Doublet);
    }
    // The edge B-C (fig. 18b).
    for _ in 0..MOST_SWAPS {
        match recover_step(front.mesh, c, b, &[a, b, c]).map_err(|_| Unmerged::NotRecovered)? {
            Recovery::Found => break,
            Recovery::Changed(_) => {}
        }
    }
    // The triangle A-B-C is one live triangle.
    let h_ab = front.mesh.front_between(a, b).ok_or(Unmerged::NotRecovered)?;
    let h_bc = front.mesh.next(h_ab);
    if front.mesh.target(h_bc) != c || front.mesh.front_between(c, a) != Some(front.mesh.previous(h_ab)) {
        return Err(Unmerged::NotEmpty);
    }
    // The merge (fig. 18c).
    let node = merge::merge(front, h_bc, &|_, _| true)?;
    Ok([node, if node == b { c } else { b }])
}
