//! The point at which a metric field is evaluated.

use glam::{DVec2, DVec3};

use crate::core::geometry::Bend;

/// The point at which a metric field is evaluated, in space, on its surface and in the plane that is meshed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetricPlace {
    /// The point in space.
    pub xyz: DVec3,
    /// Its parameters on the surface; in planar domains x and y.
    pub uv: DVec2,
    /// The point of the plane that is meshed; in planar domains equal to `uv`.
    pub chart: DVec2,
    /// The curvature of the surface, if a field needs it.
    pub bend: Option<Bend>,
}

impl MetricPlace {
    /// A point of a planar domain.
    #[inline]
    pub fn in_plane(uv: DVec2) -> MetricPlace {
        MetricPlace { xyz: uv.extend(0.0), uv, chart: uv, bend: None }
    }
}
