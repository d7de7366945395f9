//! Whether a planar mesh overlaps itself.
//!
//! When all elements are positively oriented, the number of elements that cover a point is the winding number of the
//! mesh's boundary around it, which changes only across the boundary. So the mesh has no overlap exactly when no two
//! boundary edges cross and the winding number is 1 just inside each of them and 0 just outside. Unlike a comparison of
//! areas, this detects a mesh that winds over itself, stacked components, and nodes around which the elements turn
//! twice.
//!
//! The winding number is verified, not computed: each edge claims 1 inside and 0 outside, and casts a ray to the right.
//! The facing side of the first edge hit must make the same claim; a ray that hits nothing must claim 0. As edges do
//! not cross, "hits" is acyclic, and all claims follow by induction from the rightmost edge.

use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::faces::Faces;
use super::sides::Sides;
use super::{Defect, Found};
use crate::core::kernel::predicates::orient;

type Tree = RTree<GeomWithData<Rectangle<[f64; 2]>, usize>>;

/// A boundary edge with the mesh on its left.
#[derive(Clone, Copy)]
struct Edge {
    a: u32,
    b: u32,
    p_a: DVec2,
    p_b: DVec2,
}

/// Notes boundary edges that are crossed or covered. `spot` maps each node to the first one at its position, so that
/// coincident sides in opposite directions (cracks, seams) cancel.
pub fn examine(faces: &Faces, sides: &Sides, spot: &[u32], anticlockwise: bool, found: &mut Found) {
    let edges = boundary(faces, sides, spot, anticlockwise, found);
    let boxes = edges
        .iter()
        .enumerate()
        .map(|(i, edge)| GeomWithData::new(Rectangle::from_corners(edge.p_a.to_array(), edge.p_b.to_array()), i));
    let tree: Tree = RTree::bulk_load(boxes.collect());
    let right = edges.iter().map(|edge| edge.p_a.x.max(edge.p_b.x)).fold(f64::NEG_INFINITY, f64::max);
    for (i, edge) in edges.iter().enumerate() {
        if crossed(&tree, &edges, edge) || !claim_holds(&tree, &edges, i, right) {
            found.note(Defect::Overlap, edge.a as usize, faces.point(edge.a));
        }
    }
}

/// The boundary of the sum of all elements (as a chain), with coincident nodes merged.
fn boundary(faces: &Faces, sides: &Sides, spot: &[u32], anticlockwise: bool, found: &mut Found) -> Vec<Edge> {
    // Lower node, upper node, and 1 if it runs from the lower to the upper one, otherwise -1.
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
        if sum != 0 {
            edges.push(Edge { a, b, p_a: faces.point(a).truncate(), p_b: faces.point(b).truncate() });
        }
    }
    edges
}

/// Whether another edge crosses this one, strictly inside both.
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

/// Whether the claim of the edge on its +x side agrees with the first edge hit by a ray from its midpoint.
fn claim_holds(tree: &Tree, edges: &[Edge], i: usize, right: f64) -> bool {
    let edge = &edges[i];
    let middle = 0.5 * edge.p_a + 0.5 * edge.p_b;
    // The inside is on the right of an edge that runs down; the ray from a horizontal edge passes just above it.
    let claim = match edge.rises_through(middle.y) {
        Some(rises) => !rises,
        None => edge.p_a.x < edge.p_b.x,
    };
    // Search boxes double in length, so that a near hit costs little in a large mesh.
    let mut reach = edge.p_a.distance(edge.p_b);
    loop {
        let end = middle.x + reach;
        // The length may underflow, and the end overflow.
        let all = reach == 0.0 || end.is_nan() || end >= right;
        let ray = AABB::from_corners(middle.to_array(), [if all { right } else { end }, middle.y]);
        let seen = tree.locate_in_envelope_intersecting(ray).filter(|near| near.data != i);
        let seen = seen.map(|near| &edges[near.data]).filter(|other| {
            let (low, high) = other.upwards();
            other.rises_through(middle.y).is_some() && orient(low, high, middle) > 0.0
        });
        let first = seen.reduce(|one, other| if other.is_before(one) { other } else { one });
        match first {
            // Beyond the box, another edge might be hit earlier.
            Some(first) if !all && first.x_at(middle.y) >= end => {}
            // Its facing side is the inside if it rises.
            Some(first) => return claim == (first.rises_through(middle.y) == Some(true)),
            None if all => return !claim,
            None => {}
        }
        reach *= 2.0;
    }
}

impl Edge {
    /// Whether the edge crosses the level just above `y` upwards (or downwards); `None` if it does not cross it.
    fn rises_through(&self, y: f64) -> Option<bool> {
        match (self.p_a.y > y, self.p_b.y > y) {
            (false, true) => Some(true),
            (true, false) => Some(false),
            _ => None,
        }
    }

    /// The lower and the upper end.
    fn upwards(&self) -> (DVec2, DVec2) {
        if self.p_a.y < self.p_b.y { (self.p_a, self.p_b) } else { (self.p_b, self.p_a) }
    }

    /// Whether this edge lies left of another that crosses the same level but not this edge, exactly.
    fn is_before(&self, other: &Edge) -> bool {
        let ((low, high), (other_low, other_high)) = (self.upwards(), other.upwards());
        // Both edges reach the level of the higher of their lower ends; if that end lies on the other edge, the upper
        // one decides.
        if low.y >= other_low.y {
            let turn = orient(other_low, other_high, low);
            if turn == 0.0 { orient(other_low, other_high, high) > 0.0 } else { turn > 0.0 }
        } else {
            let turn = orient(low, high, other_low);
            if turn == 0.0 { orient(low, high, other_high) < 0.0 } else { turn < 0.0 }
        }
    }

    /// Approximate x where it crosses a level.
    fn x_at(&self, y: f64) -> f64 {
        let (low, high) = self.upwards();
        low.x + (y - low.y) / (high.y - low.y) * (high.x - low.x)
    }
}
