//! The metric implied by a triangle mesh.

use glam::DVec2;

use crate::core::kernel::predicates::orient;
use crate::core::kernel::{LogMetric2, Metric2};
use crate::core::mesh::TriangleSet;

/// The metric implied by the triangles, for each node. A triangle is equilateral with unit sides in its implied metric;
/// at a point it is the log-Euclidean mean over the triangles there with equal weights, since each has the same area in
/// its own metric. Nodes at the same point have the same metric.
pub fn implied_metric(set: &TriangleSet) -> Vec<Metric2> {
    let points = set.point.iter().map(|p| p.index() + 1).max().unwrap_or(0);
    let mut sum = vec![(LogMetric2::ZERO, 0.0_f64); points];
    for t in &set.triangles {
        let ln = implied_by(t.map(|n| set.uv[n as usize])).ln();
        for n in t {
            let (total, count) = &mut sum[set.point[*n as usize].index()];
            *total = total.plus(1.0, &ln);
            *count += 1.0;
        }
    }
    let mean: Vec<Metric2> =
        sum.iter().map(|(total, count)| LogMetric2::ZERO.plus(1.0 / count.max(1.0), total).exp()).collect();
    set.point.iter().map(|p| mean[p.index()]).collect()
}

/// The metric in which a triangle is equilateral with unit sides: 3/2 of the inverse of the sum of `e e^T` over its
/// sides `e`, whose determinant is three times the square of the doubled area.
fn implied_by([a, b, c]: [DVec2; 3]) -> Metric2 {
    let sides = [b - a, c - b, a - c];
    let doubled = orient(a, b, c);
    let factor = 0.5 / (doubled * doubled);
    let sum = |f: fn(DVec2) -> f64| sides.iter().map(|&e| f(e)).sum::<f64>();
    Metric2 { uu: factor * sum(|e| e.y * e.y), uv: -factor * sum(|e| e.x * e.y), vv: factor * sum(|e| e.x * e.x) }
}
