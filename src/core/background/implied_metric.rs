//! The metric implied by a triangle mesh.

use glam::{DVec2, DVec3};

use crate::core::discrete::right_angled::right_angles;
use crate::core::kernel::predicates::orient;
use crate::core::kernel::{LogMetric2, Metric2};
use crate::core::mesh::TriangleSet;

/// The metric implied by the triangles, for each node. A triangle is equilateral with unit sides in its implied metric,
/// or, in a grid that was cut along diagonals, right-angled with unit legs. At a point it is the log-Euclidean mean
/// over the triangles there with equal weights, since each has the same area in its own metric. Nodes at the same point
/// have the same metric.
pub fn implied_metric(set: &TriangleSet) -> Vec<Metric2> {
    let points = set.point.iter().map(|p| p.index() + 1).max().unwrap_or(0);
    let mut sum = vec![(LogMetric2::ZERO, 0.0_f64); points];
    let in_space: Vec<DVec3> = set.uv.iter().map(|uv| uv.extend(0.0)).collect();
    for (t, right) in set.triangles.iter().zip(right_angles(&in_space, &set.triangles)) {
        let corners = t.map(|n| set.uv[n as usize]);
        let mut ln = equilateral(corners).ln();
        if let Some(right) = right {
            let [a, b, c] = [0, 1, 2].map(|k| corners[(right.corner + k) % 3]);
            ln = LogMetric2::ZERO.plus(1.0 - right.weight, &ln).plus(right.weight, &unit_legs(a, b, c).ln());
        }
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
fn equilateral([a, b, c]: [DVec2; 3]) -> Metric2 {
    let doubled = orient(a, b, c);
    inverse_of_sum([b - a, c - b, a - c], 0.5 / (doubled * doubled))
}

/// The metric in which the sides that meet in `a` are perpendicular and of unit length: the inverse of the sum of `e
/// e^T` over both, whose determinant is the square of the doubled area.
fn unit_legs(a: DVec2, b: DVec2, c: DVec2) -> Metric2 {
    let doubled = orient(a, b, c);
    inverse_of_sum([b - a, c - a], 1.0 / (doubled * doubled))
}

/// `factor` times the adjugate of the sum of `e e^T`.
fn inverse_of_sum<const N: usize>(sides: [DVec2; N], factor: f64) -> Metric2 {
    let sum = |f: fn(DVec2) -> f64| sides.iter().map(|&e| f(e)).sum::<f64>();
    Metric2 { uu: factor * sum(|e| e.y * e.y), uv: -factor * sum(|e| e.x * e.y), vv: factor * sum(|e| e.x * e.x) }
}
