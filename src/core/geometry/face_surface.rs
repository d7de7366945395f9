//! The parametrised surface of a face: a NURBS surface in its chart, or triangles.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::chart::{Chart, ChartPoint};
use super::facets::Facets;
use super::surface::SurfacePoint;

/// The parametrised surface of a face; cheap to clone.
#[derive(Clone, Debug)]
pub enum FaceSurface {
    /// A NURBS surface in its chart.
    Chart(Arc<Chart>),
    /// Triangles.
    Facets(Arc<Facets>),
}

impl FaceSurface {
    /// The point in space with its derivatives by the coordinates of the plane.
    #[inline]
    pub fn at(&self, p: DVec2) -> ChartPoint {
        match self {
            FaceSurface::Chart(chart) => chart.at(p),
            FaceSurface::Facets(facets) => facets.at(p),
        }
    }

    /// Whether two places of its plane are the same: within what rounding needs, or within a tolerance in space.
    pub(super) fn same_place(&self, p: DVec2, q: DVec2, tolerance: Option<f64>) -> bool {
        match self {
            FaceSurface::Chart(chart) => chart.same_place(p, q, tolerance),
            FaceSurface::Facets(_) => p == q,
        }
    }

    /// The point with second derivatives by the surface's own parameters; close to a singular point, that of a point
    /// beside it. The second derivatives of triangles are zero.
    pub fn bent(&self, p: DVec2) -> SurfacePoint {
        match self {
            FaceSurface::Chart(chart) => chart.bent(p),
            FaceSurface::Facets(facets) => {
                let at = facets.at(p);
                SurfacePoint { p: at.xyz, d: at.j, dd: [DVec3::ZERO; 3] }
            }
        }
    }
}
