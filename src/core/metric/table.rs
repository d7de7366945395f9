//! A field given by a table at the nodes of a fixed triangle mesh, log-Euclidean between them (docs/algorithm.md,
//! "Metric at new places").

use glam::DVec2;

use crate::core::fault::Fault;
use crate::core::kernel::decimal::point_text;
use crate::core::kernel::{LogMetric3, Metric3, PlaneTriangles};

/// The mesh and the logarithms of the metric at its nodes.
#[derive(Clone, Debug)]
pub(super) struct Table {
    triangles: PlaneTriangles,
    /// By node.
    logarithms: Vec<LogMetric3>,
}

impl Table {
    /// # Errors
    /// Different lengths, no triangles, an index out of range, a triangle without area, a node that is not finite or
    /// whose metric is not positive definite.
    pub fn new(points: &[DVec2], triangles: &[[u32; 3]], metrics: &[Metric3]) -> Result<Table, Fault> {
        if points.len() != metrics.len() {
            return Err(Fault::new(format!("The table has {} metrics for {} nodes", metrics.len(), points.len()))
                .remedy("Give one metric for each node"));
        }
        for (i, (p, m)) in points.iter().zip(metrics).enumerate() {
            if !m.is_spd() {
                return Err(Fault::new(format!("The metric at node {} is not positive definite and finite", i + 1))
                    .at(point_text(*p)));
            }
        }
        let triangles = PlaneTriangles::new(points, triangles)?;
        Ok(Table { triangles, logarithms: metrics.iter().map(Metric3::ln).collect() })
    }

    /// The metric at `p`; outside the mesh, that of the nearest point of the mesh. `None` when `p` is not finite.
    #[inline]
    pub fn metric(&self, p: DVec2) -> Option<Metric3> {
        let found = self.triangles.find(p)?;
        let logarithms = found.nodes.map(|node| &self.logarithms[node as usize]);
        Some(LogMetric3::log_euclidean(found.weights.into_iter().zip(logarithms)).exp())
    }
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
    fn slanting_needles_with_several_boxes_are_found() {
        let table = needles(40);
        assert!(table.triangles.boxes() > 4 * 160, "needles have several boxes: {}", table.triangles.boxes());
        for k in 0..3000 {
            let p = DVec2::new((f64::from(k) * 0.618_034).fract(), f64::from(k) / 2999.0) * 1.2 - DVec2::splat(0.1);
            let m = table.metric(p).unwrap();
            let inside = p.clamp(DVec2::ZERO, DVec2::ONE);
            let expected = Metric3::isotropic(libm::exp(inside.x - inside.y));
            assert!((m.xx / expected.xx - 1.0).abs() < 1e-9, "{p} {m:?} {expected:?}");
        }
    }
}
