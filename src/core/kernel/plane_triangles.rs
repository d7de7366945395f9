//! Point location in a triangulation of the plane: a tree of boxes finds a triangle close by, and a walk goes on from
//! there.

use glam::DVec2;

use super::box_tree::{BoxTree, share_along};
use crate::core::fault::Fault;

/// The largest number of boxes that represent a slanting needle in the tree: one box around it would overlap those of
/// all needles beside it.
const MOST_STRIPS: f64 = 64.0;
/// The largest number of triangles on a walk; beyond it, the tree searches.
const LONGEST_WALK: usize = 400;

/// A triangulation with its search tree.
#[derive(Clone, Debug)]
pub struct PlaneTriangles {
    tree: BoxTree<DVec2>,
    /// The triangle of each item of the tree.
    triangle: Vec<u32>,
    /// Corners of the triangles, anticlockwise.
    corners: Vec<[DVec2; 3]>,
    /// Their nodes.
    nodes: Vec<[u32; 3]>,
    /// The neighbours across the sides from each corner to the next; `NONE` on the boundary.
    beyond: Vec<[u32; 3]>,
}

/// The location of a point in the triangulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// The triangle.
    pub triangle: u32,
    /// Its nodes, anticlockwise.
    pub nodes: [u32; 3],
    /// Their barycentric weights.
    pub weights: [f64; 3],
}

/// No triangle.
const NONE: u32 = u32::MAX;

impl PlaneTriangles {
    /// Builds the triangulation; the triangles may have either orientation.
    ///
    /// # Errors
    /// No triangles, an index out of range, a triangle without area, a node that is not finite.
    pub fn new(points: &[DVec2], triangles: &[[u32; 3]]) -> Result<PlaneTriangles, Fault> {
        if triangles.is_empty() {
            return Err(Fault::new("The table of metrics has no triangles to interpolate in"));
        }
        for (i, p) in points.iter().enumerate() {
            if !p.is_finite() {
                return Err(Fault::new(format!("Node {} of the table of metrics is not finite", i + 1)));
            }
        }
        let mut nodes = Vec::with_capacity(triangles.len());
        let (mut boxes, mut owner) = (Vec::with_capacity(triangles.len()), Vec::with_capacity(triangles.len()));
        for (i, &[a, b, c]) in triangles.iter().enumerate() {
            if [a, b, c].iter().any(|&k| k as usize >= points.len()) {
                return Err(Fault::new(format!(
                    "Triangle {} of the table of metrics refers to a node that does not exist",
                    i + 1
                )));
            }
            let [p, q, r] = [a, b, c].map(|k| points[k as usize]);
            let area = (q - p).perp_dot(r - p);
            if area == 0.0 {
                return Err(Fault::new(format!("Triangle {} of the table of metrics has no area", i + 1))
                    .at(format!("({}, {})", p.x, p.y)));
            }
            strips([p, q, r], &mut boxes);
            owner.resize(boxes.len(), i as u32);
            nodes.push(if area > 0.0 { [a, b, c] } else { [a, c, b] });
        }
        let (tree, order) = BoxTree::new(&boxes);
        let triangle = order.into_iter().map(|i| owner[i as usize]).collect();
        let corners = nodes.iter().map(|t| t.map(|k| points[k as usize])).collect();
        let beyond = beyond(&nodes);
        Ok(PlaneTriangles { tree, triangle, corners, nodes, beyond })
    }

    /// The triangle that contains `p`; outside the mesh, the triangle and weights of the nearest point of the mesh.
    /// `None` when `p` is not finite.
    #[inline]
    pub fn find(&self, p: DVec2) -> Option<Found> {
        let near = self.triangle[self.tree.descend(p)? as usize];
        let triangle = match self.walk(near, p) {
            Some(triangle) => triangle,
            None => {
                let distance2 = |item: u32| in_triangle(&self.corners[self.triangle[item as usize] as usize], p).1;
                self.triangle[self.tree.nearest(p, distance2)?.0 as usize]
            }
        };
        let weights = in_triangle(&self.corners[triangle as usize], p).0;
        Some(Found { triangle, nodes: self.nodes[triangle as usize], weights })
    }

    /// The number of boxes in the tree.
    #[cfg(test)]
    pub fn boxes(&self) -> usize {
        self.triangle.len()
    }

    /// The triangle that contains `p`, by a visibility walk from the triangle `from`. `None` where the walk meets the
    /// boundary or becomes too long: then `p` may still be inside.
    fn walk(&self, from: u32, p: DVec2) -> Option<u32> {
        let (mut at, mut came_from) = (from, NONE);
        for _ in 0..LONGEST_WALK {
            let [a, b, c] = self.corners[at as usize].map(|corner| corner - p);
            let beyond = self.beyond[at as usize];
            // Cross the side that `p` lies farthest beyond, but never straight back.
            let sides = [a.perp_dot(b), b.perp_dot(c), c.perp_dot(a)];
            let mut worst = None;
            for k in 0..3 {
                if sides[k] < 0.0 && beyond[k] != came_from && worst.is_none_or(|w: usize| sides[k] < sides[w]) {
                    worst = Some(k);
                }
            }
            let Some(k) = worst else { return sides.iter().all(|&side| side >= 0.0).then_some(at) };
            (came_from, at) = (at, beyond[k]);
            if at == NONE {
                return None;
            }
        }
        None
    }
}

/// The neighbours across each triangle's sides. A side of three or more triangles counts as a boundary.
fn beyond(nodes: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut sides: Vec<(u32, u32, u32)> = Vec::with_capacity(3 * nodes.len());
    for (t, n) in (0..).zip(nodes) {
        sides.extend((0..3).map(|k| (n[k].min(n[(k + 1) % 3]), n[k].max(n[(k + 1) % 3]), 3 * t + k as u32)));
    }
    sides.sort_unstable();
    let mut beyond = vec![[NONE; 3]; nodes.len()];
    for pair in sides.chunk_by(|one, other| (one.0, one.1) == (other.0, other.1)) {
        if let &[(_, _, one), (_, _, other)] = pair {
            beyond[one as usize / 3][one as usize % 3] = other / 3;
            beyond[other as usize / 3][other as usize % 3] = one / 3;
        }
    }
    beyond
}

/// Cuts a triangle into strips across its longest side and adds their boxes: the less of its own box it fills, the more
/// strips.
fn strips(corners: [DVec2; 3], boxes: &mut Vec<(DVec2, DVec2)>) {
    let [p, q, r] = corners;
    let extent = p.max(q).max(r) - p.min(q).min(r);
    let count = (0.5 * extent.x * extent.y / (q - p).perp_dot(r - p).abs()).clamp(1.0, MOST_STRIPS) as u32;
    let length2 = |k: usize| corners[k].distance_squared(corners[(k + 1) % 3]);
    let longest = (0..3).max_by(|&i, &j| length2(i).total_cmp(&length2(j))).unwrap_or(0);
    let [a, b, c] = [0, 1, 2].map(|k| corners[(longest + k) % 3]);
    let foot = share_along(c, a, b);
    // The ends of a cut across the side a-b: on the side, and on the two others.
    let cut = |t: f64| {
        let other = if t < foot { a.lerp(c, t / foot) } else { c.lerp(b, ((t - foot) / (1.0 - foot)).min(1.0)) };
        [if t < 1.0 { a.lerp(b, t) } else { b }, other]
    };
    for k in 0..count {
        let [from, to] = [k, k + 1].map(|k| f64::from(k) / f64::from(count));
        let ([p, q], [r, s]) = (cut(from), cut(to));
        let (mut low, mut high) = (p.min(q).min(r).min(s), p.max(q).max(r).max(s));
        if (from..=to).contains(&foot) {
            (low, high) = (low.min(c), high.max(c));
        }
        boxes.push((low, high));
    }
}

/// Barycentric weights of the point of a triangle that is nearest to `p`, and its squared distance.
#[inline]
fn in_triangle(corners: &[DVec2; 3], p: DVec2) -> ([f64; 3], f64) {
    let [a, b, c] = corners.map(|corner| corner - p);
    // Twice the areas opposite to the corners.
    let areas = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)];
    if areas.iter().all(|&area| area >= 0.0) {
        let whole = areas[0] + areas[1] + areas[2];
        return (areas.map(|area| area / whole), 0.0);
    }
    let mut nearest = ([0.0; 3], f64::INFINITY);
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let share = share_along(p, corners[i], corners[j]);
        let distance2 = corners[i].lerp(corners[j], share).distance_squared(p);
        if distance2 < nearest.1 {
            let mut weights = [0.0; 3];
            (weights[i], weights[j]) = (1.0 - share, share);
            nearest = (weights, distance2);
        }
    }
    nearest
}
