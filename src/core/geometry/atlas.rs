//! All charts of a case side by side in one plane, so that each place of it belongs to one face: the parametric plane in
//! which everything is meshed and converted. Faces stand in it in the order of their names, whatever order the case gives.

use glam::{DVec2, DVec3};

use super::chart::ChartPoint;
use super::ground::Ground;
use super::surface::SurfacePoint;

/// Charts with their places.
#[derive(Clone, Debug, Default)]
pub struct Atlas {
    charts: Vec<Ground>,
    /// What is added to each chart's own coordinates.
    offsets: Vec<DVec2>,
    /// Where, along x, each chart but the first begins.
    begins: Vec<f64>,
}

impl Atlas {
    /// Sets charts side by side, by the least and greatest coordinates of the face in each.
    pub fn new(charts: Vec<Ground>, bounds: &[[DVec2; 2]]) -> Atlas {
        let (mut offsets, mut begins) = (Vec::new(), Vec::new());
        let mut end: Option<f64> = None;
        let widest = bounds.iter().map(|[low, high]| (*high - *low).max_element()).fold(0.0, f64::max);
        let mut gap = 0.2 * widest;
        if gap > 0.0 && charts.iter().all(|chart| matches!(chart, Ground::Facets(_))) {
            // Coordinates of charts of triangles are multiples of a small power of two, and stay exact side by side.
            gap = libm::ldexp(1.0, libm::ilogb(gap));
        }
        for [low, high] in bounds {
            let offset = match end {
                // The first stays where it is: a single face is meshed in its own coordinates.
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

    /// The chart whose place this is, by number (that of its face).
    #[inline]
    pub fn chart_of(&self, p: DVec2) -> usize {
        self.begins.partition_point(|begin| *begin <= p.x)
    }

    /// Whether the chart there is one of triangles.
    pub fn is_of_facets(&self, p: DVec2) -> bool {
        matches!(self.charts[self.chart_of(p)], Ground::Facets(_))
    }

    /// The charts.
    pub fn charts(&self) -> &[Ground] {
        &self.charts
    }

    /// Where a chart lies.
    pub fn offset(&self, chart: usize) -> DVec2 {
        self.offsets[chart]
    }

    /// The place in space with its derivatives by the coordinates of the plane.
    #[inline]
    pub fn at(&self, p: DVec2) -> ChartPoint {
        let k = self.chart_of(p);
        self.charts[k].at(p - self.offsets[k])
    }

    /// The surface's own point with second derivatives, a little off a singular point.
    pub fn bent(&self, p: DVec2) -> SurfacePoint {
        let k = self.chart_of(p);
        self.charts[k].bent(p - self.offsets[k])
    }

    /// The point in space.
    pub fn xyz(&self, p: DVec2) -> DVec3 {
        self.at(p).xyz
    }
}
