//! Area-weighted smoothing with guards (paper 4.3.6, eqs. 9 and 10; docs/algorithm.md, "Local smoothing").

use glam::DVec2;
use smallvec::SmallVec;

use crate::core::case::SmoothingWeights;
use crate::core::convert::front::Front;
use crate::core::convert::relax::energy;
use crate::core::kernel::Metric2;
use crate::core::mesh::quality::length_over;
use crate::core::mesh::{ElementId, Mesh, NodeId};

/// A smoothed node must not let the worst quality around fall below this share of what it was.
const KEPT_QUALITY: f64 = 0.9;

/// Smooths around the quadrilateral in the paper's order: nodes of the triangles around it, then, where the parameters
/// say so, other nodes that an edge joins to it, then its own. With placement on, nodes of the front and nodes in a cut
/// grid stay, and nodes that the quadrilateral buried are relaxed by the energy. Returns how many nodes moved.
pub fn around(front: &mut Front<'_>, element: ElementId) -> u8 {
    let corners = front.mesh.quad(element);
    let mut around: SmallVec<[NodeId; 24]> = SmallVec::new();
    let mut add = |node: NodeId| {
        if !around.contains(&node) && !corners.contains(&node) {
            around.push(node);
        }
    };
    for corner in corners {
        let mut last = None;
        for h in front.mesh.live_fan(corner) {
            let [_, target, apex] = front.mesh.triangle_from(h);
            if last != Some(target) {
                add(target);
            }
            add(apex);
            last = Some(apex);
        }
    }
    if front.parameters.smooth_joined {
        corners.iter().for_each(|&corner| front.mesh.neighbours(corner).for_each(&mut add));
    }
    let placement = front.parameters.placement;
    let mut moved = 0;
    for node in around {
        let on_front = |n| front.mesh.is_on_front(n) && !front.mesh.is_buried(n);
        let stays = placement && (on_front(node) || front.mesh.is_in_cut_grid(node));
        if !front.mesh.is_fixed(node) && !stays {
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
    let (sum, weight) = match front.parameters.smoothing_weights {
        SmoothingWeights::Determinant => by_determinants(mesh, node),
        SmoothingWeights::Printed => by_printed_areas(mesh, node),
    };
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
        if mesh.can_move(node, place).is_err() {
            continue;
        }
        let Ok(metric) = front.source.metric(place) else { continue };
        if keeps_quality(mesh, node, place, &metric) {
            front.mesh.move_node(node, place, metric);
            return true;
        }
    }
    false
}

/// Whether a node may move to a place with this metric: the worst quality around it keeps its share.
fn keeps_quality(mesh: &Mesh, node: NodeId, place: DVec2, metric: &Metric2) -> bool {
    let (mut worst, mut after) = (None, f64::INFINITY);
    for h in mesh.fan(node) {
        let quality = mesh.quality_with(h, place, metric);
        if quality < after {
            (worst, after) = (Some(h.element()), quality);
        }
    }
    // The worst before is at most that of the element that is the worst after: mostly a look at that one is enough.
    worst.is_some_and(|e| after >= KEPT_QUALITY * mesh.quality(e))
        || after >= KEPT_QUALITY * mesh.worst_quality_at(node)
}

/// The sum of the centroids of the elements at a node, each times its area, and of those areas: in the parametric plane
/// times the mean of `sqrt(det M)` over the nodes of the element.
fn by_determinants(mesh: &Mesh, node: NodeId) -> (DVec2, f64) {
    let (mut sum, mut weight) = (DVec2::ZERO, 0.0);
    for e in mesh.elements_at(node) {
        let roots: f64 = mesh.corners(e).map(|n| mesh.metric_ref(n).det().sqrt()).sum();
        let area = if mesh.is_triangle(e) {
            let [a, b, c] = mesh.triangle(e).map(|n| mesh.uv(n));
            0.5 * (b - a).perp_dot(c - a)
        } else {
            let [a, b, c, d] = mesh.quad(e).map(|n| mesh.uv(n));
            0.5 * (c - a).perp_dot(d - b)
        };
        let area = roots / mesh.sides(e) as f64 * area;
        sum += mesh.centroid(e) * area;
        weight += area;
    }
    (sum, weight)
}

/// As [`by_determinants`], the areas as printed (eqs. 10a, 10b): by the metric lengths of the edges, and of the
/// diagonal, that leave the node, and the angles between them in its metric.
fn by_printed_areas(mesh: &Mesh, node: NodeId) -> (DVec2, f64) {
    let (p, metric) = mesh.place(node);
    let half_root = 0.5 * metric.det().sqrt();
    // An edge or a diagonal to another node: its direction, and its metric length over that in the node's own metric.
    let spoke = |n: NodeId| {
        let (q, m) = mesh.place(n);
        (q - p, length_over(metric, m, q - p) / metric.norm2(q - p).sqrt())
    };
    // l l' sin(theta), the sine by eq. 5: sqrt(det M) x(p, q) over both lengths in the node's metric.
    let sector = |(p, l): (DVec2, f64), (q, l_q): (DVec2, f64)| l * l_q * p.perp_dot(q);
    let (mut sum, mut weight) = (DVec2::ZERO, 0.0);
    let mut last = None;
    for h in mesh.fan(node) {
        let e = h.element();
        // Elements side by side share a spoke.
        let first = last.unwrap_or_else(|| spoke(mesh.target(h)));
        let (sectors, end) = if mesh.is_triangle(e) {
            let end = spoke(mesh.triangle_from(h)[2]);
            (sector(first, end), end)
        } else {
            let [_, _, c, d] = mesh.quad_from(h);
            let (diagonal, end) = (spoke(c), spoke(d));
            (sector(first, diagonal) + sector(diagonal, end), end)
        };
        last = Some(end);
        let area = half_root * sectors;
        sum += mesh.centroid(e) * area;
        weight += area;
    }
    (sum, weight)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::mesh::{NewElement, PointId, TriangleSet};
    use crate::core::metric::measure::angle;
    use std::f64::consts::FRAC_PI_3;

    /// A free node (6) in a hexagon, between a quadrilateral and four triangles, with a metric of its own at each node.
    fn quad_and_triangles_in_a_hexagon() -> Mesh {
        let corner = |k: usize| {
            let (y, x) = libm::sincos(k as f64 * FRAC_PI_3);
            DVec2::new(x, y)
        };
        let set = TriangleSet {
            uv: (0..6).map(corner).chain([DVec2::new(0.2, 0.1)]).collect(),
            point: (0..7).map(PointId).collect(),
            triangles: (0..6).map(|k| [k, (k + 1) % 6, 6]).collect(),
            region: vec![0; 6],
            ..TriangleSet::default()
        };
        let metric = |k: usize| Metric2 { uu: 1.0 + 0.3 * k as f64, uv: 0.1 * k as f64, vv: 2.0 };
        let mut mesh = Mesh::from_triangles(&set, (0..7).map(metric).collect());
        mesh.replace(&[ElementId(0), ElementId(1)], &[NewElement::quad([0, 1, 2, 6].map(NodeId), 0)]);
        mesh
    }

    #[test]
    fn the_printed_areas_are_those_of_eq_10() {
        let mesh = quad_and_triangles_in_a_hexagon();
        let node = NodeId(6);
        let (mut sum, mut weight) = (DVec2::ZERO, 0.0);
        for e in mesh.elements_at(node) {
            let corners: Vec<NodeId> = mesh.corners(e).collect();
            let at = corners.iter().position(|&n| n == node).expect("the element is at the node");
            let others: Vec<NodeId> = (1..corners.len()).map(|k| corners[(at + k) % corners.len()]).collect();
            let to = |n| mesh.uv(n) - mesh.uv(node);
            let sector = |p: NodeId, q: NodeId| {
                let theta = angle(mesh.metric_ref(node), to(p), to(q));
                0.5 * mesh.distance(node, p) * mesh.distance(node, q) * libm::sin(theta)
            };
            let area: f64 = others.windows(2).map(|pair| sector(pair[0], pair[1])).sum();
            sum += corners.iter().map(|&n| mesh.uv(n)).sum::<DVec2>() / corners.len() as f64 * area;
            weight += area;
        }
        let (found, found_weight) = by_printed_areas(&mesh, node);
        assert!((found_weight - weight).abs() < 1e-13 && (found - sum).length() < 1e-13, "{found} {sum}");
    }

    #[test]
    fn a_move_is_judged_by_the_worst_quality_before_and_after() {
        let mesh = quad_and_triangles_in_a_hexagon();
        let (node, metric) = (NodeId(6), Metric2 { uu: 1.5, uv: 0.2, vv: 1.8 });
        let mut answers = [0; 2];
        for k in 0..400 {
            let place = DVec2::new(-0.8 + 0.08 * f64::from(k % 20), -0.8 + 0.08 * f64::from(k / 20));
            let mut moved = mesh.clone();
            moved.move_node(node, place, metric);
            let keeps = moved.worst_quality_at(node) >= KEPT_QUALITY * mesh.worst_quality_at(node);
            assert_eq!(keeps_quality(&mesh, node, place, &metric), keeps, "{place}");
            answers[usize::from(keeps)] += 1;
        }
        assert!(answers.iter().all(|&n| n > 20), "both happen: {answers:?}");
    }
}
