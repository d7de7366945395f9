//! Area-weighted smoothing with guards (paper 4.3.6, eqs. 9 and 10; docs/algorithm.md, "Local smoothing").

use glam::DVec2;
use smallvec::SmallVec;

use crate::core::case::SmoothingWeights;
use crate::core::convert::front::Front;
use crate::core::convert::relax::energy;
use crate::core::mesh::{ElementId, Mesh, NodeId};

/// A smoothed node must not let the worst quality around fall below this share of what it was.
const KEPT_QUALITY: f64 = 0.9;

/// Smooths around the quadrilateral in the paper's order: nodes of the triangles around it, then, where the parameters
/// say so, other nodes that an edge joins to it, then its own. With placement on, nodes of the front stay, and nodes
/// that the quadrilateral buried are relaxed by the energy. Nodes in a cut grid stay, unless they are its own. Returns
/// how many nodes moved.
pub fn around(front: &mut Front<'_>, element: ElementId) -> u8 {
    let corners = front.mesh.quad(element);
    let mut around: SmallVec<[NodeId; 24]> = SmallVec::new();
    for corner in corners {
        for h in front.mesh.live_fan(corner) {
            for node in [front.mesh.target(h), front.mesh.apex(h)] {
                if !around.contains(&node) && !corners.contains(&node) {
                    around.push(node);
                }
            }
        }
    }
    if front.parameters.smooth_joined {
        for corner in corners {
            for node in front.mesh.neighbours(corner) {
                if !around.contains(&node) && !corners.contains(&node) {
                    around.push(node);
                }
            }
        }
    }
    let placement = front.parameters.placement;
    let mut moved = 0;
    for node in around {
        let stays = placement && front.mesh.is_on_front(node) && !front.mesh.is_buried(node);
        if !front.mesh.is_fixed(node) && !stays && !front.mesh.is_in_cut_grid(node) {
            moved += u8::from(by_area(front, node));
        }
    }
    for node in corners {
        if front.mesh.is_fixed(node) {
            continue;
        }
        moved += u8::from(if placement {
            front.mesh.is_buried(node) && energy::relax(front.mesh, node, front.source) > 0.0
        } else {
            by_area(front, node)
        });
    }
    moved
}

/// Smooths around the top C of a quadrilateral that is to be formed (4.3.4, top edge v): the nodes that live triangles
/// join to it, but for those of the front and the other top. Returns how many moved.
pub fn around_top(front: &mut Front<'_>, tops: [NodeId; 2]) -> u8 {
    let nodes: SmallVec<[NodeId; 12]> = front.mesh.live_fan(tops[0]).map(|h| front.mesh.target(h)).collect();
    let is_free = |front: &Front<'_>, n| !tops.contains(&n) && !front.mesh.is_on_front(n) && !front.mesh.is_fixed(n);
    nodes.into_iter().map(|node| u8::from(is_free(front, node) && by_area(front, node))).sum()
}

/// Moves a node to the weighted centroid of its elements (eq. 9), in steps 1, 1/2, 1/4, 1/8 until the guard holds.
fn by_area(front: &mut Front<'_>, node: NodeId) -> bool {
    let mesh = &*front.mesh;
    let (mut sum, mut weight, mut before) = (DVec2::ZERO, 0.0, f64::INFINITY);
    let mut last = None;
    for e in mesh.elements_at(node) {
        let centroid = mesh.corners(e).fold(DVec2::ZERO, |sum, n| sum + mesh.uv(n)) / mesh.sides(e) as f64;
        let area = match front.parameters.smoothing_weights {
            SmoothingWeights::Determinant => area_by_determinant(mesh, e),
            SmoothingWeights::Printed => printed_area(mesh, e, node, &mut last),
        };
        sum += centroid * area;
        weight += area;
        before = before.min(mesh.quality(e));
    }
    let here = mesh.uv(node);
    let there = sum / weight;
    // Less than a thousandth of a unit is not worth the journal's memory.
    if mesh.metric_ref(node).norm2(there - here) < 1e-6 {
        return false;
    }
    let mut step = 1.0;
    for _ in 0..4 {
        let place = here + (there - here) * step;
        step *= 0.5;
        let Ok(metric) = front.source.metric(place) else { continue };
        if front.mesh.can_move(node, place).is_err() {
            continue;
        }
        let mark = front.mesh.mark();
        front.mesh.move_node(node, place, metric);
        if front.mesh.worst_quality_at(node) >= KEPT_QUALITY * before {
            return true;
        }
        front.mesh.take_back(mark);
    }
    false
}

/// Area of an element: in the parametric plane, times the mean of `sqrt(det M)` over its nodes.
fn area_by_determinant(mesh: &Mesh, e: ElementId) -> f64 {
    let roots: f64 = mesh.corners(e).map(|n| mesh.metric_ref(n).det().sqrt()).sum();
    let area = if mesh.is_triangle(e) {
        let [a, b, c] = mesh.triangle(e).map(|n| mesh.uv(n));
        0.5 * (b - a).perp_dot(c - a)
    } else {
        let [a, b, c, d] = mesh.quad(e).map(|n| mesh.uv(n));
        0.5 * (c - a).perp_dot(d - b)
    };
    roots / mesh.sides(e) as f64 * area
}

/// An edge or a diagonal that leaves a node: its other end, its direction, and its metric length over that in the
/// node's own metric.
type Spoke = (NodeId, DVec2, f64);

/// Area of an element at a node as printed (eqs. 10a, 10b): by the metric lengths of the edges, and of the diagonal,
/// that leave the node, and the angles between them in its metric. `last` is the last edge of the element before, and
/// becomes that of this one: two elements side by side share an edge.
fn printed_area(mesh: &Mesh, e: ElementId, node: NodeId, last: &mut Option<Spoke>) -> f64 {
    let corners: SmallVec<[NodeId; 4]> = mesh.corners(e).collect();
    let at = corners.iter().position(|&n| n == node).expect("the element is at the node");
    let metric = mesh.metric_ref(node);
    let mut sum = 0.0;
    let mut before: Option<Spoke> = None;
    // The other corners, anticlockwise.
    for n in (1..corners.len()).map(|k| corners[(at + k) % corners.len()]) {
        let spoke = last.take_if(|last| last.0 == n).unwrap_or_else(|| {
            let d = mesh.uv(n) - mesh.uv(node);
            (n, d, mesh.distance(node, n) / metric.norm2(d).sqrt())
        });
        // l l' sin(theta), the sine by eq. 5: sqrt(det M) x(p, q) over both lengths in the node's metric.
        if let Some((_, p, l)) = before {
            sum += l * spoke.2 * p.perp_dot(spoke.1);
        }
        before = Some(spoke);
    }
    *last = before;
    0.5 * metric.det().sqrt() * sum
}
