//! The image of a curve in space in the chart of a face: both have the same parameter, so that what divides the one divides
//! the other at the same points.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::chart::Chart;
use super::curve::Curve;
use super::facets::Facets;
use super::ground::Ground;
use super::space_curve::SpaceCurve;

/// A curve that is farther from a surface than this part of its size does not lie on it.
pub const ON_SURFACE: f64 = 1e-6;

/// Points of the table between two breaks.
const TABLE: usize = 48;

/// A curve as it lies in a chart.
#[derive(Clone, Debug)]
pub struct Image {
    ground: Ground,
    curve: Arc<SpaceCurve>,
    placing: Placing,
    /// Added to the chart's own coordinates: where the chart lies in the plane of all, and on which sheet of a closed surface.
    pub shift: DVec2,
    straight: bool,
    /// Parameters and places along it in the chart's own coordinates.
    table: Vec<(f64, DVec2)>,
}

/// How the place of a parameter is found.
#[derive(Clone, Debug)]
enum Placing {
    /// It is given in u and v, which are moved by whole periods.
    Trim { chart: Arc<Chart>, trim: Box<Curve>, move_by: DVec2 },
    /// Each point is sought on the surface, from the table.
    Projected(Arc<Chart>),
    /// It runs straight from one place of the table to the next: along the sides of triangles.
    Straight,
}

/// How far a curve is from the surface that it should lie on.
#[derive(Clone, Copy, Debug)]
pub struct Off {
    /// The distance.
    pub distance: f64,
    /// The point of the curve.
    pub at: DVec3,
}

impl Image {
    /// The image of a curve that is given in u and v of the chart's surface, moved by whole periods of it.
    pub fn of_trim(chart: &Arc<Chart>, curve: &Arc<SpaceCurve>, trim: &Curve, move_by: DVec2) -> Image {
        let mut image = Image {
            ground: Ground::Chart(Arc::clone(chart)),
            curve: Arc::clone(curve),
            straight: chart.keeps_lines() && trim.straight(),
            placing: Placing::Trim { chart: Arc::clone(chart), trim: Box::new(trim.clone()), move_by },
            shift: DVec2::ZERO,
            table: Vec::new(),
        };
        image.table = parameters(curve).into_iter().map(|t| (t, image.point(t))).collect();
        image
    }

    /// The image of any curve that lies on the chart's surface; its start is sought near `guess`.
    ///
    /// # Errors
    /// How far the curve is from the surface, where it is farthest.
    pub fn projected(chart: &Arc<Chart>, curve: &Arc<SpaceCurve>, guess: DVec2) -> Result<Image, Off> {
        let ground = Ground::Chart(Arc::clone(chart));
        let mut table: Vec<(f64, DVec2)> = Vec::new();
        let mut worst = Off { distance: 0.0, at: DVec3::ZERO };
        for t in parameters(curve) {
            let xyz = curve.point(t);
            let from = match table.last() {
                None => guess,
                Some(&(before, p)) => p + pulled_back(&ground, p, curve.at(before).1) * (t - before),
            };
            let (mut p, mut off) = chart.project(xyz, from);
            if off > ON_SURFACE * chart.surface().size() {
                // The step led astray; once more from where the step began.
                let again = chart.project(xyz, table.last().map_or(guess, |last| last.1));
                if again.1 < off {
                    (p, off) = again;
                }
            }
            if off > worst.distance {
                worst = Off { distance: off, at: xyz };
            }
            table.push((t, p));
        }
        if worst.distance > ON_SURFACE * chart.surface().size() {
            return Err(worst);
        }
        Ok(Image {
            ground: Ground::Chart(Arc::clone(chart)),
            curve: Arc::clone(curve),
            placing: Placing::Projected(Arc::clone(chart)),
            shift: DVec2::ZERO,
            straight: false,
            table,
        })
    }

    /// The image of a chain of sides of triangles, by the places of its points.
    pub fn of_sides(facets: &Arc<Facets>, curve: &Arc<SpaceCurve>, places: &[DVec2]) -> Image {
        let last = (places.len() - 1) as f64;
        Image {
            ground: Ground::Facets(Arc::clone(facets)),
            curve: Arc::clone(curve),
            placing: Placing::Straight,
            shift: DVec2::ZERO,
            straight: false,
            table: places.iter().enumerate().map(|(k, &p)| (k as f64 / last, p)).collect(),
        }
    }

    /// The same image elsewhere in the plane.
    #[must_use]
    pub fn moved(mut self, by: DVec2) -> Image {
        self.shift += by;
        self
    }

    /// The curve in space.
    pub fn curve(&self) -> &Arc<SpaceCurve> {
        &self.curve
    }

    /// The place at `t`.
    pub fn point(&self, t: f64) -> DVec2 {
        let own = match &self.placing {
            Placing::Trim { chart, trim, move_by } => chart.of_uv(trim.point(t) + *move_by),
            placing => {
                let k = self.table.partition_point(|entry| entry.0 <= t).clamp(1, self.table.len() - 1);
                let (a, b) = (self.table[k - 1], self.table[k]);
                let guess = lerp(a.1, b.1, (t - a.0) / (b.0 - a.0));
                match placing {
                    Placing::Projected(chart) => chart.project(self.curve.point(t), guess).0,
                    _ => guess,
                }
            }
        };
        own + self.shift
    }

    /// Place and derivative at `t`.
    pub fn at(&self, t: f64) -> (DVec2, DVec2) {
        let p = self.point(t);
        (p, pulled_back(&self.ground, p - self.shift, self.curve.at(t).1))
    }

    /// Whether it is straight between its corners.
    pub fn straight(&self) -> bool {
        self.straight
    }

    /// Whether it runs straight from one place of its table to the next.
    pub fn polygonal(&self) -> bool {
        matches!(self.placing, Placing::Straight)
    }

    /// Its places at the points of the table.
    pub fn places(&self) -> impl Iterator<Item = DVec2> + '_ {
        self.table.iter().map(|entry| entry.1 + self.shift)
    }

    /// u and v of its surface at the points of the table.
    pub fn uvs(&self) -> impl Iterator<Item = DVec2> + '_ {
        self.table.iter().map(|entry| match &self.placing {
            Placing::Trim { trim, move_by, .. } => trim.point(entry.0) + *move_by,
            Placing::Projected(chart) => chart.uv(entry.1),
            Placing::Straight => entry.1,
        })
    }
}

/// Between two places, exact at both.
fn lerp(a: DVec2, b: DVec2, t: f64) -> DVec2 {
    if t <= 0.5 { a + (b - a) * t } else { b - (b - a) * (1.0 - t) }
}

/// The vector in the chart whose image in space is the tangent `d`.
fn pulled_back(ground: &Ground, p: DVec2, d: DVec3) -> DVec2 {
    let at = ground.at(p);
    let g = at.first_form();
    let b = DVec2::new(at.j[0].dot(d), at.j[1].dot(d));
    let det = g.det();
    if det > 0.0 { DVec2::new(g.vv * b.x - g.uv * b.y, g.uu * b.y - g.uv * b.x) / det } else { DVec2::ZERO }
}

/// Parameters at which the table has a place: all breaks and corners are among them.
fn parameters(curve: &SpaceCurve) -> Vec<f64> {
    let breaks = curve.breaks();
    let parts = (4 * TABLE / (breaks.len() - 1)).clamp(4, TABLE);
    let mut at = vec![0.0];
    for w in breaks.windows(2) {
        at.extend((1..=parts).map(|i| if i == parts { w[1] } else { w[0] + (w[1] - w[0]) * i as f64 / parts as f64 }));
    }
    at
}
