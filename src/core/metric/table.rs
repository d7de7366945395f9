//! A field given by a table at the nodes of a frozen triangle mesh, between which it is log-Euclidean (spec 2.1.1, 3.6).

use glam::DVec2;

use super::box_tree::{BoxTree, share_along};
use super::spectrum::LogMetric3;
use super::tensor::Metric3;
use crate::core::fault::Fault;

/// A slanting needle is known to the tree by so many boxes at the most: its whole box would overlap with those of all needles
/// beside it.
const MOST_STRIPS: f64 = 64.0;
/// A walk from triangle to triangle is given up after so many; then the tree searches.
const LONGEST_WALK: usize = 400;

/// The mesh, the logarithms at its nodes, and what finds a triangle.
#[derive(Clone, Debug)]
pub(super) struct Table {
    tree: BoxTree<DVec2>,
    /// The triangle of each of the tree's things.
    triangle: Vec<u32>,
    /// Corners of the triangles, anticlockwise.
    corners: Vec<[DVec2; 3]>,
    /// Their nodes.
    nodes: Vec<[u32; 3]>,
    /// The triangles beyond the sides from each corner to the next; `NONE` on the boundary.
    beyond: Vec<[u32; 3]>,
    /// By node.
    logarithms: Vec<LogMetric3>,
}

/// No triangle.
const NONE: u32 = u32::MAX;

impl Table {
    /// # Errors
    /// Lengths that differ, no triangle, an index out of range, a triangle without area, a node that is not finite or whose
    /// metric is not positive definite.
    pub fn new(points: &[DVec2], triangles: &[[u32; 3]], metrics: &[Metric3]) -> Result<Table, Fault> {
        if points.len() != metrics.len() {
            return Err(Fault::new(format!("The table has {} metrics for {} nodes", metrics.len(), points.len()))
                .remedy("Give one metric for each node"));
        }
        if triangles.is_empty() {
            return Err(Fault::new("The table of metrics has no triangles to interpolate in"));
        }
        for (i, (p, m)) in points.iter().zip(metrics).enumerate() {
            if !p.is_finite() {
                return Err(Fault::new(format!("Node {} of the table of metrics is not at a finite place", i + 1)));
            }
            if !m.is_spd() {
                return Err(Fault::new(format!("The metric at node {} is not positive definite and finite", i + 1))
                    .at(format!("({}, {})", p.x, p.y)));
            }
        }
        let mut nodes = Vec::with_capacity(triangles.len());
        let (mut boxes, mut owner) = (Vec::with_capacity(triangles.len()), Vec::with_capacity(triangles.len()));
        for (i, &[a, b, c]) in triangles.iter().enumerate() {
            if [a, b, c].iter().any(|&k| k as usize >= points.len()) {
                return Err(Fault::new(format!(
                    "Triangle {} of the table of metrics names a node that is not there",
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
        Ok(Table { tree, triangle, corners, nodes, beyond, logarithms: metrics.iter().map(Metric3::ln).collect() })
    }

    /// The metric at `p`; outside the mesh, that of the nearest point of the mesh. `None` when `p` is not finite.
    #[inline]
    pub fn metric(&self, p: DVec2) -> Option<Metric3> {
        let near = self.triangle[self.tree.descend(p)? as usize];
        let id = match self.walk(near, p) {
            Some(id) => id,
            None => {
                let distance2 = |thing: u32| in_triangle(&self.corners[self.triangle[thing as usize] as usize], p).1;
                self.triangle[self.tree.nearest(p, distance2)?.0 as usize]
            }
        };
        let weights = in_triangle(&self.corners[id as usize], p).0;
        let mut sum = LogMetric3::ZERO;
        for (weight, node) in weights.into_iter().zip(self.nodes[id as usize]) {
            sum = sum.plus(weight, &self.logarithms[node as usize]);
        }
        Some(sum.exp())
    }

    /// The triangle that holds `p`, by crossing from triangle to triangle the sides that it lies beyond. `None` where the
    /// walk meets the boundary or becomes long: that says nothing of `p`.
    fn walk(&self, from: u32, p: DVec2) -> Option<u32> {
        let (mut at, mut came_from) = (from, NONE);
        for _ in 0..LONGEST_WALK {
            let [a, b, c] = self.corners[at as usize].map(|corner| corner - p);
            let beyond = self.beyond[at as usize];
            // Beyond the side on which `p` lies farthest outside, but never straight back.
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

/// The triangles beyond each triangle's sides. A side of three or more is a boundary.
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

/// Adds the boxes of the strips across its longest side that a triangle is cut into, the more the less of its box it fills.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The unit square in rows of needles along one of its diagonals.
    fn needles(rows: u32) -> Table {
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for k in 0..=rows {
            let t = f64::from(k) / f64::from(rows);
            points.extend([DVec2::new(t, 0.0), DVec2::new(1.0, t), DVec2::new(0.0, t), DVec2::new(t, 1.0)]);
        }
        for k in (0..4 * rows).step_by(4) {
            // Below the diagonal from (k, 0) to (1, 1 - k), above it from (0, k) to (1 - k, 1).
            let far = 4 * rows - k;
            triangles.extend([[k, k + 4, far + 1], [k + 4, far - 3, far + 1]]);
            triangles.extend([[k + 2, far + 3, k + 6], [k + 6, far + 3, far - 1]]);
        }
        triangles.retain(|t| {
            let [a, b, c] = t.map(|n| points[n as usize]);
            (b - a).perp_dot(c - a) != 0.0
        });
        let metrics = points.iter().map(|p| Metric3::isotropic(libm::exp(p.x - p.y))).collect::<Vec<_>>();
        Table::new(&points, &triangles, &metrics).unwrap()
    }

    #[test]
    fn slanting_needles_are_found_though_each_stands_in_several_boxes() {
        let table = needles(40);
        assert!(table.triangle.len() > 4 * 160, "needles stand in several boxes: {}", table.triangle.len());
        for k in 0..3000 {
            let p = DVec2::new((f64::from(k) * 0.618_034).fract(), f64::from(k) / 2999.0) * 1.2 - DVec2::splat(0.1);
            let m = table.metric(p).unwrap();
            let inside = p.clamp(DVec2::ZERO, DVec2::ONE);
            let expected = Metric3::isotropic(libm::exp(inside.x - inside.y));
            assert!((m.xx / expected.xx - 1.0).abs() < 1e-9, "{p} {m:?} {expected:?}");
        }
    }
}
