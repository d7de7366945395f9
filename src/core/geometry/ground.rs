//! What a face lies on, as it is laid out in the plane: the chart of a NURBS surface, or triangles.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::chart::{Chart, ChartPoint};
use super::facets::Facets;
use super::surface::SurfacePoint;

/// The ground of a face; cheap to copy.
#[derive(Clone, Debug)]
pub enum Ground {
    /// A NURBS surface in its chart.
    Chart(Arc<Chart>),
    /// Triangles.
    Facets(Arc<Facets>),
}

impl Ground {
    /// The place in space with its derivatives by the coordinates of the plane.
    #[inline]
    pub fn at(&self, p: DVec2) -> ChartPoint {
        match self {
            Ground::Chart(chart) => chart.at(p),
            Ground::Facets(facets) => facets.at(p),
        }
    }

    /// The point with second derivatives, a little off a singular point; those of triangles are zero.
    pub fn bent(&self, p: DVec2) -> SurfacePoint {
        match self {
            Ground::Chart(chart) => chart.bent(p),
            Ground::Facets(facets) => {
                let at = facets.at(p);
                SurfacePoint { p: at.xyz, d: at.j, dd: [DVec3::ZERO; 3] }
            }
        }
    }
}
