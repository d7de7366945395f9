//! Area-weighted smoothing with guards (paper 4.3.6, eqs. 9 and 10; docs/algorithm.md, "Local smoothing").

use glam::DVec2;
use smallvec::SmallVec;

use crate::core::convert::front::Front;
use crate::core::convert::relax::energy;
use crate::core::mesh::{ElementId, Mesh, NodeId};

/// A smoothed node must not let the worst quality around fall below this share of what it was.
const KEPT_QUALITY: f64 = 0.9;

/// Smooths around the quadrilateral in the paper's order: nodes of the triangles around it, then its own. With
/// placement on, nodes of the front stay, and nodes that the quadrilateral buried are relaxed by the energy. Returns
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
    let placement = front.parameters.placement;
    let mut moved = 0;
    for node in around {
        if !front.mesh.is_on_front(node) || (!placement && !front.mesh.is_fixed(node)) {
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

/// Moves a node to the weighted centroid of its elements (eq. 9), in steps 1, 1/2, 1/4, 1/8 until the guard holds.
fn by_area(front: &mut Front<'_>, node: NodeId) -> bool {
    let mesh = &*front.mesh;
    let (mut sum, mut weight, mut before) = (DVec2::ZERO, 0.0, f64::INFINITY);
    for e in mesh.elements_at(node) {
        let (mut centroid, mut root) = (DVec2::ZERO, 0.0);
        let sides = mesh.sides(e) as f64;
        for n in mesh.corners(e) {
            centroid += mesh.uv(n);
            root += mesh.metric_ref(n).det().sqrt();
        }
        let area = root / sides * element_area(mesh, e);
        sum += centroid / sides * area;
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

/// Area of an element in the parametric plane.
fn element_area(mesh: &Mesh, e: ElementId) -> f64 {
    if mesh.is_triangle(e) {
        let [a, b, c] = mesh.triangle(e).map(|n| mesh.uv(n));
        0.5 * (b - a).perp_dot(c - a)
    } else {
        let [a, b, c, d] = mesh.quad(e).map(|n| mesh.uv(n));
        0.5 * (c - a).perp_dot(d - b)
    }
}
