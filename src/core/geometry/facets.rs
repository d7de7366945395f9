//! A triangulated surface in its chart: the surface of faces without CAD geometry (docs/algorithm.md, "Flattening").
//! The map from the plane to space is linear in each triangle, so that the derivatives are constant there.

use glam::{DVec2, DVec3};

use super::chart::ChartPoint;
use crate::core::fault::Fault;
use crate::core::kernel::PlaneTriangles;
use crate::core::kernel::box_tree::extent;

/// A piecewise linear surface: triangles in the plane and in space.
#[derive(Clone, Debug)]
pub struct Facets {
    plane: PlaneTriangles,
    xyz: Vec<DVec3>,
    /// The derivatives in each triangle by the coordinates of the plane.
    j: Vec<[DVec3; 2]>,
    size: f64,
}

impl Facets {
    /// Triangles that are positively oriented in the plane; `uv` and `xyz` are the nodes there and in space.
    ///
    /// # Errors
    /// What `PlaneTriangles::new` refuses.
    pub fn new(uv: &[DVec2], xyz: Vec<DVec3>, triangles: &[[u32; 3]]) -> Result<Facets, Fault> {
        let j = triangles.iter().map(|t| {
            let [a, b, c] = t.map(|k| uv[k as usize]);
            let [p, q, r] = t.map(|k| xyz[k as usize]);
            let (g, h, e, f) = (b - a, c - a, q - p, r - p);
            let det = g.perp_dot(h);
            [(e * h.y - f * g.y) / det, (f * g.x - e * h.x) / det]
        });
        let j = j.collect();
        let (low, high) = extent(xyz.iter().copied());
        Ok(Facets { plane: PlaneTriangles::new(uv, triangles)?, size: (high - low).max_element(), xyz, j })
    }

    /// The largest side of its bounding box.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// The point of the surface at a point of the plane; outside the chart, that at the nearest point of the chart.
    pub fn at(&self, p: DVec2) -> ChartPoint {
        match self.plane.find(p) {
            Some(found) => {
                let terms = found.nodes.into_iter().zip(found.weights);
                let xyz = terms.map(|(node, weight)| self.xyz[node as usize] * weight).sum();
                ChartPoint { xyz, uv: p, j: self.j[found.triangle as usize] }
            }
            None => ChartPoint { xyz: DVec3::NAN, uv: p, j: [DVec3::NAN; 2] },
        }
    }
}
