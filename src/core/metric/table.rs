//! A field given by a table at the nodes of a frozen triangle mesh, between which it is log-Euclidean (spec 2.1.1, 3.6).

use glam::DVec2;

use super::box_tree::{BoxTree, share_along};
use super::spectrum::LogMetric3;
use super::tensor::Metric3;
use crate::core::fault::Fault;

/// The mesh, the logarithms at its nodes, and what finds a triangle.
#[derive(Clone, Debug)]
pub(super) struct Table {
    tree: BoxTree,
    /// Corners of the triangles, anticlockwise, in the tree's order.
    corners: Vec<[DVec2; 3]>,
    /// Their nodes.
    nodes: Vec<[u32; 3]>,
    /// By node.
    logarithms: Vec<LogMetric3>,
}

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
        let mut anticlockwise = Vec::with_capacity(triangles.len());
        let mut boxes = Vec::with_capacity(triangles.len());
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
            anticlockwise.push(if area > 0.0 { [a, b, c] } else { [a, c, b] });
            boxes.push((p.min(q).min(r), p.max(q).max(r)));
        }
        let (tree, order) = BoxTree::new(&boxes);
        let nodes: Vec<[u32; 3]> = order.into_iter().map(|i| anticlockwise[i as usize]).collect();
        let corners = nodes.iter().map(|t| t.map(|k| points[k as usize])).collect();
        Ok(Table { tree, corners, nodes, logarithms: metrics.iter().map(Metric3::ln).collect() })
    }

    /// The metric at `p`; outside the mesh, that of the nearest point of the mesh. `None` when `p` is not finite.
    #[inline]
    pub fn metric(&self, p: DVec2) -> Option<Metric3> {
        let (id, _) = self.tree.nearest(p, |id| in_triangle(&self.corners[id as usize], p).1)?;
        let weights = in_triangle(&self.corners[id as usize], p).0;
        let mut sum = LogMetric3::ZERO;
        for (weight, node) in weights.into_iter().zip(self.nodes[id as usize]) {
            sum = sum.plus(weight, &self.logarithms[node as usize]);
        }
        Some(sum.exp())
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
