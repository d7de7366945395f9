//! The secondary mapping of a chart about a singular point: polar coordinates in the true angles at the point.

use std::f64::consts::TAU;

use glam::DVec2;

use super::ChartPoint;
use crate::core::geometry::curve::divided;
use crate::core::geometry::surface::{Edge, NurbsSurface};

/// A whole turn within this many radians of 360 true degrees is a disc.
const ROUND: f64 = 1e-6;

/// Closer to a singular point than this fraction of the surface's size, the limit at the point is used.
const AT_POINT: f64 = 1e-9;

/// The number of pieces of the table of angles between two knots.
const PIECES: usize = 24;

/// Polar coordinates about a singular edge.
#[derive(Clone, Debug)]
pub(super) struct PolarMap {
    pub edge: Edge,
    /// The value of the parameter across the edge, on the edge.
    apex: f64,
    /// Length per unit of that parameter.
    scale: f64,
    /// The parameter along the edge as a function of the true angle about the point.
    pub turn: AngleTable,
    /// Whether it is a disc.
    pub disc: bool,
    /// Whether angles run clockwise, to preserve orientation.
    clockwise: bool,
}

impl PolarMap {
    /// The secondary mapping about a singular edge of the surface; its mirror image if `reversed`.
    pub fn new(surface: &NurbsSurface, edge: Edge, reversed: bool) -> PolarMap {
        let domain = surface.domain();
        let apex = domain[edge.axis][usize::from(edge.last)];
        let [first, last] = domain[1 - edge.axis];
        let across = |t: f64| {
            let at = surface.at(edge.uv(t, apex), 2);
            (at.d[edge.axis], at.dd[1])
        };
        let turn = AngleTable::new(&surface.breaks(1 - edge.axis), &|t| {
            let (d, dd) = across(t);
            d.cross(dd).length() / d.length_squared().max(f64::MIN_POSITIVE)
        });
        let middle = 0.5 * (first + last);
        let fallback = surface.size() / (domain[edge.axis][1] - domain[edge.axis][0]);
        let scale = Some(across(middle).0.length()).filter(|s| *s > 1e-6 * fallback).unwrap_or(fallback);
        let disc = surface.closed()[1 - edge.axis] && (turn.total() - TAU).abs() < ROUND;
        // The distance grows away from the edge, so (angle, distance) reverses orientation where (along, away) is (u,
        // v).
        let away_grows = !edge.last;
        let clockwise = ((edge.axis == 1) == away_grows) != reversed;
        let turn = if disc { turn.stretched_to(TAU) } else { turn };
        PolarMap { edge, apex, scale, turn, disc, clockwise }
    }

    /// The parameter across the edge at a distance in the chart.
    pub fn away(&self, distance: f64) -> f64 {
        let d = distance / self.scale;
        if self.edge.last { self.apex - d } else { self.apex + d }
    }

    /// Distance from the point, and angle; in a sector, the angle may lie beyond its ends.
    pub fn polar(&self, p: DVec2) -> (f64, f64) {
        let y = if self.clockwise { -p.y } else { p.y };
        let angle = libm::atan2(y, p.x);
        // Angles are measured from the middle of a sector, so that their jump is opposite to it.
        let angle =
            if self.disc { if angle < 0.0 { angle + TAU } else { angle } } else { angle + 0.5 * self.turn.total() };
        (p.length(), angle)
    }

    pub fn of_polar(&self, distance: f64, angle: f64) -> DVec2 {
        let angle = if self.disc { angle } else { angle - 0.5 * self.turn.total() };
        let (sin, cos) = libm::sincos(angle);
        DVec2::new(cos, if self.clockwise { -sin } else { sin }) * distance
    }

    pub fn of_uv(&self, uv: DVec2) -> DVec2 {
        let (along, away) = if self.edge.axis == 0 { (uv.y, uv.x) } else { (uv.x, uv.y) };
        let distance = if self.edge.last { self.apex - away } else { away - self.apex } * self.scale;
        let angle = self.turn.angle_of(along, self.disc);
        self.of_polar(distance, angle)
    }

    pub fn at(&self, surface: &NurbsSurface, p: DVec2) -> ChartPoint {
        let (distance, angle) = self.polar(p);
        let near = distance < AT_POINT * surface.size();
        let angle = if near { if self.disc { 0.0 } else { 0.5 * self.turn.total() } } else { angle };
        let (along, slope) = self.turn.at(angle);
        let uv = self.edge.uv(along, self.away(distance));
        let outwards = if self.edge.last { -1.0 } else { 1.0 } / self.scale;
        let s = surface.at(uv, if near { 2 } else { 1 });
        let radial = s.d[self.edge.axis] * outwards;
        let around = if near { s.dd[1] * (outwards * slope) } else { s.d[1 - self.edge.axis] * (slope / distance) };
        let phi = if self.disc { angle } else { angle - 0.5 * self.turn.total() };
        let (sin, cos) = libm::sincos(phi);
        let (j_x, j_y) = (radial * cos - around * sin, radial * sin + around * cos);
        ChartPoint { xyz: s.p, uv, j: [j_x, if self.clockwise { -j_y } else { j_y }] }
    }
}

/// A parameter as a smooth, increasing function of an angle: cubic pieces through a table.
#[derive(Clone, Debug)]
pub struct AngleTable {
    angles: Vec<f64>,
    values: Vec<f64>,
    /// Derivatives of the values by the angle.
    slopes: Vec<f64>,
}

impl AngleTable {
    /// The table of a given derivative of the angle by the parameter.
    fn new(breaks: &[f64], rate: &dyn Fn(f64) -> f64) -> AngleTable {
        let values = divided(breaks, PIECES);
        let last = breaks[breaks.len() - 1];
        let range = last - breaks[0];
        // Five Gauss points per piece; small rates are raised, so that the angle increases everywhere.
        const GAUSS: [(f64, f64); 3] = [
            (0.0, 0.568_888_888_888_888_9),
            (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
            (0.906_179_845_938_664, 0.236_926_885_056_189_1),
        ];
        let integral = |a: f64, b: f64, rate: &dyn Fn(f64) -> f64| {
            let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
            let pairs = GAUSS[1..].iter().map(|(x, w)| w * (rate(middle - x * half) + rate(middle + x * half)));
            half * (GAUSS[0].1 * rate(middle) + pairs.sum::<f64>())
        };
        let whole: f64 = values.windows(2).map(|w| integral(w[0], w[1], rate)).sum();
        // A lower bound of the rate gives every sector a positive angle.
        let least = 0.02 * whole.max(0.1) / range;
        let rate = |t: f64| rate(t).max(least);
        let mut angles = vec![0.0];
        for w in values.windows(2) {
            angles.push(angles[angles.len() - 1] + integral(w[0], w[1], &rate));
        }
        // The rate may jump at a knot: its mean of both sides keeps the table smooth.
        let hair = 1e-9 * range;
        let slope = |t: f64| {
            let (before, after) = ((t - hair).max(values[0]), (t + hair).min(last));
            2.0 / (rate(before) + rate(after))
        };
        let slopes = values.iter().map(|&t| slope(t)).collect();
        let turn = AngleTable { angles, values, slopes };
        // A sector of more than a full turn would overlap itself.
        let most = TAU - 0.05;
        let total = turn.total();
        if total > most && (total - TAU).abs() >= ROUND { turn.stretched_to(most) } else { turn }
    }

    pub fn total(&self) -> f64 {
        self.angles[self.angles.len() - 1]
    }

    fn stretched_to(mut self, total: f64) -> AngleTable {
        let factor = total / self.total();
        self.angles.iter_mut().for_each(|a| *a *= factor);
        self.slopes.iter_mut().for_each(|s| *s /= factor);
        let last = self.angles.len() - 1;
        self.angles[last] = total;
        self
    }

    /// The parameter at an angle and its derivative; linear beyond the ends.
    pub fn at(&self, angle: f64) -> (f64, f64) {
        let n = self.angles.len() - 1;
        if angle <= 0.0 || angle >= self.angles[n] {
            let k = if angle <= 0.0 { 0 } else { n };
            return (self.values[k] + self.slopes[k] * (angle - self.angles[k]), self.slopes[k]);
        }
        let k = (self.angles.partition_point(|a| *a <= angle) - 1).min(n - 1);
        self.in_piece(k, angle)
    }

    /// Cubic Hermite interpolation in a piece.
    fn in_piece(&self, k: usize, angle: f64) -> (f64, f64) {
        let h = self.angles[k + 1] - self.angles[k];
        let t = (angle - self.angles[k]) / h;
        let rise = self.values[k + 1] - self.values[k];
        let (m0, m1) = (self.slopes[k] * h, self.slopes[k + 1] * h);
        // value = v0 + t (m0 + t (3 rise - 2 m0 - m1 + t (m0 + m1 - 2 rise)))
        let (c2, c3) = (3.0 * rise - 2.0 * m0 - m1, m0 + m1 - 2.0 * rise);
        (self.values[k] + t * (m0 + t * (c2 + t * c3)), (m0 + t * (2.0 * c2 + t * 3.0 * c3)) / h)
    }

    /// The angle of a parameter, by Newton's method in its piece. Angles of a periodic parameter continue beyond the
    /// full turn.
    fn angle_of(&self, value: f64, periodic: bool) -> f64 {
        let n = self.values.len() - 1;
        let (first, last) = (self.values[0], self.values[n]);
        let mut value = value;
        let mut turns = 0.0;
        if periodic {
            turns = ((value - first) / (last - first)).floor();
            value -= turns * (last - first);
        }
        let total = self.total();
        if value <= first || value >= last {
            let k = if value <= first { 0 } else { n };
            return turns * total + self.angles[k] + (value - self.values[k]) / self.slopes[k];
        }
        let k = (self.values.partition_point(|v| *v <= value) - 1).min(n - 1);
        let (mut low, mut high) = (self.angles[k], self.angles[k + 1]);
        let mut angle = low + (high - low) * (value - self.values[k]) / (self.values[k + 1] - self.values[k]);
        for _ in 0..60 {
            let (found, slope) = self.in_piece(k, angle);
            let off = found - value;
            if off > 0.0 {
                high = angle
            } else {
                low = angle
            }
            let next = angle - off / slope;
            let next = if next >= low && next <= high { next } else { 0.5 * (low + high) };
            if (next - angle).abs() <= 1e-16 * total {
                break;
            }
            angle = next;
        }
        turns * total + angle
    }
}
