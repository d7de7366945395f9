//! All charts of a case side by side in one plane, so that each point of the plane belongs to one face: the parametric
//! plane in which everything is meshed and converted. The faces are ordered by name, whatever their order in the case.

use glam::{DVec2, DVec3};

use super::chart::ChartPoint;
use super::face_surface::FaceSurface;
use super::surface::SurfacePoint;

/// Charts with their positions in the plane.
#[derive(Clone, Debug, Default)]
pub struct Atlas {
    charts: Vec<FaceSurface>,
    /// The offset of each chart: it is added to the chart's own coordinates.
    offsets: Vec<DVec2>,
    /// The abscissa at which each chart but the first begins.
    begins: Vec<f64>,
}

impl Atlas {
    /// Places charts side by side; `bounds` are the lowest and highest coordinates of the face in each.
    pub fn new(charts: Vec<FaceSurface>, bounds: &[[DVec2; 2]]) -> Atlas {
        let (mut offsets, mut begins) = (Vec::new(), Vec::new());
        let mut end: Option<f64> = None;
        let widest = bounds.iter().map(|[low, high]| (*high - *low).max_element()).fold(0.0, f64::max);
        let mut gap = 0.2 * widest;
        if gap > 0.0 && charts.iter().all(|chart| matches!(chart, FaceSurface::Facets(_))) {
            // Coordinates of triangulated charts are multiples of a small power of two, and remain exact with this gap.
            gap = libm::ldexp(1.0, libm::ilogb(gap));
        }
        for [low, high] in bounds {
            let offset = match end {
                // The first chart is not moved: a single face is meshed in its own coordinates.
                None => 0.0,
                Some(end) => {
                    begins.push(end + 0.5 * gap);
                    end + gap - low.x
                }
            };
            offsets.push(DVec2::new(offset, 0.0));
            end = Some(high.x + offset);
        }
        Atlas { charts, offsets, begins }
    }

    /// The index of the chart, and of its face, that contains a point of the plane.
    #[inline]
    pub fn chart_of(&self, p: DVec2) -> usize {
        self.begins.partition_point(|begin| *begin <= p.x)
    }

    /// The charts.
    pub fn charts(&self) -> &[FaceSurface] {
        &self.charts
    }

    /// The offset of a chart in the plane.
    pub fn offset(&self, chart: usize) -> DVec2 {
        self.offsets[chart]
    }

    /// The point in space with its derivatives by the coordinates of the plane.
    #[inline]
    pub fn at(&self, p: DVec2) -> ChartPoint {
        let k = self.chart_of(p);
        self.charts[k].at(p - self.offsets[k])
    }

    /// The point of the surface with second derivatives by its own parameters; close to a singular point, that of a
    /// point beside it.
    pub fn bent(&self, p: DVec2) -> SurfacePoint {
        let k = self.chart_of(p);
        self.charts[k].bent(p - self.offsets[k])
    }

    /// The point in space.
    pub fn xyz(&self, p: DVec2) -> DVec3 {
        self.at(p).xyz
    }
}
