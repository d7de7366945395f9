//! A place where a metric is asked for.

use glam::{DVec2, DVec3};

use crate::core::geometry::surface::Bend;

/// A place where a metric is asked for: its point in space and its parametric coordinates (equal in the plane).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetricPlace {
    /// Point in space.
    pub xyz: DVec3,
    /// Parametric coordinates of its surface.
    pub uv: DVec2,
    /// Where it lies in the plane in which it is meshed (in planar domains the same as `uv`).
    pub chart: DVec2,
    /// The curvature of the surface, where a field asks for it.
    pub bend: Option<Bend>,
}

impl MetricPlace {
    /// A place in a planar domain, where the parametric coordinates are x and y.
    #[inline]
    pub fn in_plane(uv: DVec2) -> MetricPlace {
        MetricPlace { xyz: uv.extend(0.0), uv, chart: uv, bend: None }
    }
}
