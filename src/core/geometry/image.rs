//! The image of a space curve in the chart of a face. Both have the same parameter, so that a subdivision of one
//! divides the other at the same points.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::chart::Chart;
use super::curve::{Curve, divided, lerp};
use super::face_surface::FaceSurface;
use super::facets::Facets;
use super::space_curve::SpaceCurve;

/// A curve farther from a surface than this fraction of the surface's size does not lie on it.
pub const ON_SURFACE: f64 = 1e-6;

/// The number of table entries between two breaks.
const TABLE: usize = 48;

/// The image of a curve in a chart.
#[derive(Clone, Debug)]
pub struct Image {
    surface: FaceSurface,
    curve: Arc<SpaceCurve>,
    placing: Placing,
    /// Added to the chart's own coordinates: the offset of the chart in the atlas and the sheet of a closed surface.
    pub shift: DVec2,
    straight: bool,
    /// Parameters and points along it in the chart's own coordinates.
    table: Vec<(f64, DVec2)>,
}

/// How the point at a parameter is found.
#[derive(Clone, Debug)]
enum Placing {
    /// By a given curve in u and v, moved by whole periods.
    Trim { chart: Arc<Chart>, trim: Box<Curve>, move_by: DVec2 },
    /// By projection onto the surface, starting from the table.
    Projected(Arc<Chart>),
    /// By linear interpolation in the table: along the edges of triangles.
    Straight,
}

/// The largest distance of a curve from the surface on which it should lie.
#[derive(Clone, Copy, Debug)]
pub struct Deviation {
    /// The distance.
    pub distance: f64,
    /// The point of the curve.
    pub at: DVec3,
}

impl Image {
    fn new(surface: FaceSurface, curve: &Arc<SpaceCurve>, placing: Placing, table: Vec<(f64, DVec2)>) -> Image {
        Image { surface, curve: Arc::clone(curve), placing, shift: DVec2::ZERO, straight: false, table }
    }

    /// The image of a curve that is given in u and v of the chart's surface, moved by whole periods of it.
    pub fn of_trim(chart: &Arc<Chart>, curve: &Arc<SpaceCurve>, trim: &Curve, move_by: DVec2) -> Image {
        let placing = Placing::Trim { chart: Arc::clone(chart), trim: Box::new(trim.clone()), move_by };
        let mut image = Image::new(FaceSurface::Chart(Arc::clone(chart)), curve, placing, Vec::new());
        image.straight = chart.keeps_lines() && trim.straight();
        image.table = parameters(curve).into_iter().map(|t| (t, image.point(t))).collect();
        image
    }

    /// The image of any curve that lies on the chart's surface; the search for its start begins at `guess`.
    ///
    /// # Errors
    /// The largest distance of the curve from the surface, if that is more than `most`.
    pub fn projected(chart: &Arc<Chart>, curve: &Arc<SpaceCurve>, guess: DVec2, most: f64) -> Result<Image, Deviation> {
        let mut table: Vec<(f64, DVec2)> = Vec::new();
        let mut worst = Deviation { distance: 0.0, at: DVec3::ZERO };
        for t in parameters(curve) {
            let xyz = curve.point(t);
            let from = match table.last() {
                None => guess,
                Some(&(before, p)) => p + chart.at(p).pulled_back(curve.at(before).1) * (t - before),
            };
            let (mut p, mut off) = chart.project(xyz, from);
            if off > most {
                // The extrapolated start may not converge: try again from the previous point.
                let again = chart.project(xyz, table.last().map_or(guess, |last| last.1));
                if again.1 < off {
                    (p, off) = again;
                }
            }
            if off > worst.distance {
                worst = Deviation { distance: off, at: xyz };
            }
            table.push((t, p));
        }
        if worst.distance > most {
            return Err(worst);
        }
        let placing = Placing::Projected(Arc::clone(chart));
        let straight = chart.is_affine() && curve.straight();
        Ok(Image { straight, ..Image::new(FaceSurface::Chart(Arc::clone(chart)), curve, placing, table) })
    }

    /// The image of a chain of triangle edges through `points` of the chart.
    pub fn of_sides(facets: &Arc<Facets>, curve: &Arc<SpaceCurve>, points: &[DVec2]) -> Image {
        let last = (points.len() - 1) as f64;
        let table = points.iter().enumerate().map(|(k, &p)| (k as f64 / last, p)).collect();
        Image::new(FaceSurface::Facets(Arc::clone(facets)), curve, Placing::Straight, table)
    }

    /// The same image, translated in the plane.
    #[must_use]
    pub fn moved(mut self, by: DVec2) -> Image {
        self.shift += by;
        self
    }

    /// The curve in space.
    pub fn curve(&self) -> &Arc<SpaceCurve> {
        &self.curve
    }

    /// The point of the plane at `t`.
    pub fn point(&self, t: f64) -> DVec2 {
        let own = match &self.placing {
            Placing::Trim { chart, trim, move_by } => chart.of_uv(trim.point(t) + *move_by),
            placing => {
                let k = self.table.partition_point(|entry| entry.0 <= t).clamp(1, self.table.len() - 1);
                let (a, b) = (self.table[k - 1], self.table[k]);
                let guess = lerp(a.1, b.1, (t - a.0) / (b.0 - a.0));
                match placing {
                    Placing::Projected(chart) if !self.straight => chart.project(self.curve.point(t), guess).0,
                    _ => guess,
                }
            }
        };
        own + self.shift
    }

    /// Point of the plane and derivative at `t`.
    pub fn at(&self, t: f64) -> (DVec2, DVec2) {
        let p = self.point(t);
        (p, self.surface.at(p - self.shift).pulled_back(self.curve.at(t).1))
    }

    /// Whether it is straight between its corners.
    pub fn straight(&self) -> bool {
        self.straight
    }

    /// Whether it is straight between the points of its table.
    pub fn polygonal(&self) -> bool {
        matches!(self.placing, Placing::Straight)
    }

    /// The points of its table, in the plane.
    pub fn points(&self) -> impl Iterator<Item = DVec2> + '_ {
        self.table.iter().map(|entry| entry.1 + self.shift)
    }

    /// The parameters u and v of its surface at the points of the table.
    pub fn uvs(&self) -> impl Iterator<Item = DVec2> + '_ {
        self.table.iter().map(|entry| match &self.placing {
            Placing::Trim { trim, move_by, .. } => trim.point(entry.0) + *move_by,
            Placing::Projected(chart) => chart.uv(entry.1),
            Placing::Straight => entry.1,
        })
    }
}

/// The parameters of the table; they include all breaks and corners.
fn parameters(curve: &SpaceCurve) -> Vec<f64> {
    let breaks = curve.breaks();
    divided(&breaks, (4 * TABLE / (breaks.len() - 1)).clamp(4, TABLE))
}
