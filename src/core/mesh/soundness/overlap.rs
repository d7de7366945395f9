//! Whether a planar mesh covers any place twice.
//!
//! When all elements are positive, the number of elements over a place is the winding number of the mesh's boundary
//! around it. That changes across the boundary only. So nothing overlaps exactly when no two boundary edges cross and
//! the winding number just inside each of them is 1. This sees what areas cannot: a mesh that winds over itself, pieces
//! on top of each other, nodes around which the elements turn twice.

use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::faces::Faces;
use super::sides::Sides;
use super::{Defect, Found};
use crate::core::geometry::predicates::orient;

type Tree = RTree<GeomWithData<Rectangle<[f64; 2]>, usize>>;

/// An edge of the boundary with the mesh on its left.
#[derive(Clone, Copy)]
struct Edge {
    a: u32,
    b: u32,
    p_a: DVec2,
    p_b: DVec2,
}

/// Notes boundary edges that are crossed or covered. `spot` names the first node at the place of each: sides that lie on
/// each other in opposite directions (cracks, seams) are no boundary.
pub fn examine(faces: &Faces, sides: &Sides, spot: &[u32], anticlockwise: bool, found: &mut Found) {
    let edges = boundary(faces, sides, spot, anticlockwise, found);
    let boxes = edges
        .iter()
        .enumerate()
        .map(|(i, edge)| GeomWithData::new(Rectangle::from_corners(edge.p_a.to_array(), edge.p_b.to_array()), i));
    let tree: Tree = RTree::bulk_load(boxes.collect());
    let right = edges.iter().map(|edge| edge.p_a.x.max(edge.p_b.x)).fold(f64::NEG_INFINITY, f64::max);
    for (i, edge) in edges.iter().enumerate() {
        if crossed(&tree, &edges, edge) || winding_inside(&tree, &edges, i, right) != 1 {
            found.note(Defect::Overlap, edge.a as usize, faces.point(edge.a));
        }
    }
}

/// The boundary of the sum of all elements, by place.
fn boundary(faces: &Faces, sides: &Sides, spot: &[u32], anticlockwise: bool, found: &mut Found) -> Vec<Edge> {
    // Lower end, upper end, and whether it runs from the lower to the upper one.
    let mut runs: Vec<(u32, u32, i64)> = Vec::new();
    for &h in sides.boundary.iter().chain(&sides.odd) {
        let (a, b) = faces.ends(h);
        let (a, b) = (spot[a as usize], spot[b as usize]);
        if a != b {
            runs.push((a.min(b), a.max(b), if (a < b) == anticlockwise { 1 } else { -1 }));
        }
    }
    runs.sort_unstable();
    let mut edges = Vec::new();
    for run in runs.chunk_by(|one, other| (one.0, one.1) == (other.0, other.1)) {
        let sum: i64 = run.iter().map(|run| run.2).sum();
        let (lower, upper, _) = run[0];
        let (a, b) = if sum > 0 { (lower, upper) } else { (upper, lower) };
        if sum.abs() > 1 {
            found.note(Defect::Overlap, a as usize, faces.point(a));
        }
        for _ in 0..sum.unsigned_abs().min(2) {
            edges.push(Edge { a, b, p_a: faces.point(a).truncate(), p_b: faces.point(b).truncate() });
        }
    }
    edges
}

/// Whether another edge crosses this one, both strictly within.
fn crossed(tree: &Tree, edges: &[Edge], edge: &Edge) -> bool {
    let around = AABB::from_corners(edge.p_a.to_array(), edge.p_b.to_array());
    tree.locate_in_envelope_intersecting(around).any(|near| {
        let other = &edges[near.data];
        if [other.a, other.b].iter().any(|&end| end == edge.a || end == edge.b) {
            return false;
        }
        let apart = |one: f64, two: f64| (one > 0.0 && two < 0.0) || (one < 0.0 && two > 0.0);
        apart(orient(edge.p_a, edge.p_b, other.p_a), orient(edge.p_a, edge.p_b, other.p_b))
            && apart(orient(other.p_a, other.p_b, edge.p_a), orient(other.p_a, other.p_b, edge.p_b))
    })
}

/// The winding number of all edges around a place just to the left of the middle of edge `i`, by a ray to the right.
fn winding_inside(tree: &Tree, edges: &[Edge], i: usize, right: f64) -> i64 {
    let Edge { p_a, p_b, .. } = edges[i];
    let middle = 0.5 * p_a + 0.5 * p_b;
    // The ray runs just above `middle.y`, so that an end at that height counts as below it.
    let upward = |from: DVec2, to: DVec2| match (from.y > middle.y, to.y > middle.y) {
        (false, true) => 1,
        (true, false) => -1,
        _ => 0,
    };
    // The edge itself is met when its left side is on the near side of it: when it runs up; a level one when its left
    // side is below.
    let own = match upward(p_a, p_b) {
        1 => 1,
        0 if p_b.x < p_a.x => 1,
        _ => 0,
    };
    let ray = AABB::from_corners(middle.to_array(), [right, middle.y]);
    let others = tree.locate_in_envelope_intersecting(ray).filter(|near| near.data != i).map(|near| {
        let other = &edges[near.data];
        let turn = upward(other.p_a, other.p_b);
        let side = orient(other.p_a, other.p_b, middle);
        // It is met when the middle is on its left while it runs up, or on its right while it runs down.
        if (turn > 0 && side > 0.0) || (turn < 0 && side < 0.0) { turn } else { 0 }
    });
    own + others.sum::<i64>()
}
