//! How a face's surface is laid out in the plane in which the face is meshed (paper 3.1; docs/algorithm.md, "Charts and
//! the atlas"): the chart.
//!
//! Away from singular points a chart is the parametric plane, scaled so that lengths are about those in space. Around a
//! singular point (a pole, an apex: an edge of the parametric rectangle that is one point) the secondary mapping takes its
//! place: distance and angle about the point, in its true angles, so that the derivatives stay bounded and the chart is smooth
//! there. A whole turn of nearly 360 true degrees (a pole) becomes a disc without a seam, anything less (an apex, a
//! three-sided patch) a sector.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::surface::{EDGES, Edge, NurbsSurface, SurfacePoint};
use crate::core::kernel::tensor::Metric2;

/// A whole turn that misses 360 true degrees by less than this (radians) is a disc.
const ROUND: f64 = 1e-6;

/// Nearer to a singular point than this part of the surface's size its limit is taken.
const AT_POINT: f64 = 1e-9;

/// Pieces of the table of angles between two knots.
const PIECES: usize = 24;

/// A surface and its layout in a plane.
#[derive(Clone, Debug)]
pub struct Chart {
    surface: Arc<NurbsSurface>,
    map: Map,
}

#[derive(Clone, Debug)]
enum Map {
    /// The parametric plane from a corner, u and v scaled.
    Sheet { from: DVec2, scale: DVec2 },
    /// Distance and angle about a singular edge.
    Polar(Box<Polar>),
}

/// The secondary mapping about a singular edge.
#[derive(Clone, Debug)]
struct Polar {
    edge: Edge,
    /// The parameter's value on the edge.
    apex: f64,
    /// Length for a unit of that parameter.
    scale: f64,
    /// The parameter along the edge by the true angle about the point.
    turn: Turn,
    /// Whether it is a disc.
    disc: bool,
    /// Whether angles run clockwise, so that orientation is kept.
    clockwise: bool,
}

/// What a chart says of a place: the point, and its derivatives by the coordinates of the chart.
#[derive(Clone, Copy, Debug)]
pub struct ChartPoint {
    /// The point in space.
    pub xyz: DVec3,
    /// u and v of the surface.
    pub uv: DVec2,
    /// Derivatives by the chart's coordinates: J of eq. (3).
    pub j: [DVec3; 2],
}

impl ChartPoint {
    /// The first fundamental form `J^T J`.
    #[inline]
    pub fn first_form(&self) -> Metric2 {
        let [a, b] = self.j;
        Metric2 { uu: a.dot(a), uv: a.dot(b), vv: b.dot(b) }
    }

    /// The unit normal, on the side of `r_u x r_v`.
    #[inline]
    pub fn normal(&self) -> DVec3 {
        self.j[0].cross(self.j[1]).normalize_or_zero()
    }
}

impl Chart {
    /// The parametric plane of a surface, scaled to about its lengths.
    pub fn sheet(surface: Arc<NurbsSurface>) -> Chart {
        let [[u0, u1], [v0, v1]] = surface.domain();
        const N: usize = 12;
        let mut sums = [0.0; 2];
        for i in 0..N {
            for j in 0..N {
                let at = |k: usize| (k as f64 + 0.5) / N as f64;
                let p = surface.at(DVec2::new(u0 + at(i) * (u1 - u0), v0 + at(j) * (v1 - v0)), 1);
                sums[0] += p.d[0].length();
                sums[1] += p.d[1].length();
            }
        }
        let count = (N * N) as f64;
        let scale = DVec2::new(sums[0] / count, sums[1] / count).max(DVec2::splat(f64::MIN_POSITIVE));
        Chart { surface, map: Map::Sheet { from: DVec2::new(u0, v0), scale } }
    }

    /// The secondary mapping about a singular edge of the surface.
    pub fn about(surface: Arc<NurbsSurface>, edge: Edge) -> Chart {
        let domain = surface.domain();
        let apex = domain[edge.axis][usize::from(edge.last)];
        let [first, last] = domain[1 - edge.axis];
        let across = |t: f64| {
            let at = surface.at(place(edge, t, apex), 2);
            (at.d[edge.axis], at.dd[1])
        };
        let turn = Turn::new(&surface.breaks(1 - edge.axis), &|t| {
            let (d, dd) = across(t);
            d.cross(dd).length() / d.length_squared().max(f64::MIN_POSITIVE)
        });
        let middle = 0.5 * (first + last);
        let fallback = surface.size() / (domain[edge.axis][1] - domain[edge.axis][0]);
        let scale = Some(across(middle).0.length()).filter(|s| *s > 1e-6 * fallback).unwrap_or(fallback);
        let disc = surface.closed()[1 - edge.axis] && (turn.total() - TAU).abs() < ROUND;
        // With distance growing away from the edge, (angle, distance) turns over where (along, away) is (u, v).
        let away_grows = !edge.last;
        let clockwise = (edge.axis == 1) == away_grows;
        let turn = if disc { turn.stretched_to(TAU) } else { turn };
        let polar = Polar { edge, apex, scale, turn, disc, clockwise };
        Chart { surface, map: Map::Polar(Box::new(polar)) }
    }

    /// The surface.
    pub fn surface(&self) -> &Arc<NurbsSurface> {
        &self.surface
    }

    /// The singular edge in whose middle the chart is drawn.
    pub fn centre(&self) -> Option<Edge> {
        match &self.map {
            Map::Sheet { .. } => None,
            Map::Polar(polar) => Some(polar.edge),
        }
    }

    /// Whether angles go all the way round the singular point, so that there is no seam.
    pub fn is_disc(&self) -> bool {
        matches!(&self.map, Map::Polar(polar) if polar.disc)
    }

    /// Whether straight lines in u and v are straight here.
    pub fn keeps_lines(&self) -> bool {
        matches!(self.map, Map::Sheet { .. })
    }

    /// How far the chart goes along its axes until the surface repeats itself.
    pub fn periods(&self) -> Vec<DVec2> {
        match &self.map {
            Map::Polar(_) => Vec::new(),
            Map::Sheet { scale, .. } => {
                let axes = [DVec2::new(scale.x, 0.0), DVec2::new(0.0, scale.y)];
                (0..2).filter_map(|axis| self.surface.period(axis).map(|period| axes[axis] * period)).collect()
            }
        }
    }

    /// The coordinates in the chart of u and v.
    pub fn of_uv(&self, uv: DVec2) -> DVec2 {
        match &self.map {
            Map::Sheet { from, scale } => (uv - *from) * *scale,
            Map::Polar(polar) => polar.of_uv(uv),
        }
    }

    /// u and v of coordinates in the chart.
    pub fn uv(&self, p: DVec2) -> DVec2 {
        match &self.map {
            Map::Sheet { from, scale } => *from + p / *scale,
            Map::Polar(polar) => {
                let (_, angle) = polar.polar(p);
                place(polar.edge, polar.turn.at(angle).0, polar.away(p.length()))
            }
        }
    }

    /// The place in space with the derivatives by the chart's coordinates. At the singular point itself the limit along the
    /// middle of the chart.
    #[inline]
    pub fn at(&self, p: DVec2) -> ChartPoint {
        match &self.map {
            Map::Sheet { from, scale } => {
                let uv = *from + p / *scale;
                let s = self.surface.at(uv, 1);
                ChartPoint { xyz: s.p, uv, j: [s.d[0] / scale.x, s.d[1] / scale.y] }
            }
            Map::Polar(polar) => polar.at(&self.surface, p),
        }
    }

    /// The surface's own point with second derivatives, a little off a singular point.
    pub fn bent(&self, p: DVec2) -> SurfacePoint {
        let uv = match &self.map {
            Map::Sheet { .. } => self.uv(p),
            Map::Polar(polar) => {
                let least = 1e-4 * self.surface.size();
                let length = p.length();
                if length < least {
                    let out = if length > 0.0 { p / length } else { polar.of_polar(1.0, 0.5 * polar.turn.total()) };
                    self.uv(out * least)
                } else {
                    self.uv(p)
                }
            }
        };
        self.surface.at(uv, 2)
    }

    /// The place in the chart of the point on the surface that is nearest to `xyz`, by Gauss-Newton from a guess, with the
    /// distance that is left.
    pub fn project(&self, xyz: DVec3, guess: DVec2) -> (DVec2, f64) {
        let size = self.surface.size();
        let mut p = guess;
        let mut at = self.at(p);
        let mut off = at.xyz.distance(xyz);
        for _ in 0..40 {
            let r = xyz - at.xyz;
            let g = at.first_form();
            let b = DVec2::new(at.j[0].dot(r), at.j[1].dot(r));
            let det = g.det();
            if det <= 0.0 || det.is_nan() {
                break;
            }
            let step = DVec2::new(g.vv * b.x - g.uv * b.y, g.uu * b.y - g.uv * b.x) / det;
            let mut share = 1.0;
            let mut next = self.at(p + step);
            // Halved where it leads away; the last digits may go either way.
            while next.xyz.distance(xyz) > off.max(1e-14 * size) && share > 1e-3 {
                share *= 0.5;
                next = self.at(p + step * share);
            }
            let moved = next.xyz.distance(at.xyz);
            p += step * share;
            at = next;
            off = at.xyz.distance(xyz);
            if moved <= 1e-15 * size {
                break;
            }
        }
        (p, off)
    }

    /// The place in the chart of the point on the surface that is nearest to `xyz`, sought from all over the surface.
    pub fn locate(&self, xyz: DVec3) -> (DVec2, f64) {
        let [[u0, u1], [v0, v1]] = self.surface.domain();
        let mut starts: Vec<(f64, DVec2)> = Vec::new();
        let line = |axis: usize| {
            let breaks = self.surface.breaks(axis);
            let parts = (24 / (breaks.len() - 1)).max(4);
            let mut at: Vec<f64> = Vec::new();
            for w in breaks.windows(2) {
                at.extend((0..parts).map(|i| w[0] + (w[1] - w[0]) * i as f64 / parts as f64));
            }
            at.push(breaks[breaks.len() - 1]);
            at
        };
        let inside = |uv: DVec2| DVec2::new(uv.x.clamp(u0, u1), uv.y.clamp(v0, v1));
        for u in line(0) {
            for v in line(1) {
                let uv = inside(DVec2::new(u, v));
                starts.push((self.surface.at(uv, 1).p.distance(xyz), uv));
            }
        }
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best: Option<(DVec2, f64)> = None;
        for (_, uv) in starts.into_iter().take(8) {
            let found = self.project(xyz, self.of_uv(uv));
            if found.1 <= 1e-11 * self.surface.size() {
                return found;
            }
            if best.is_none_or(|b| found.1 < b.1) {
                best = Some(found);
            }
        }
        best.unwrap_or((DVec2::ZERO, f64::INFINITY))
    }
}

/// u and v from the parameter along an edge and that away from it.
fn place(edge: Edge, along: f64, away: f64) -> DVec2 {
    if edge.axis == 0 { DVec2::new(away, along) } else { DVec2::new(along, away) }
}

impl Polar {
    /// The parameter away from the edge at a distance in the chart.
    fn away(&self, distance: f64) -> f64 {
        let d = distance / self.scale;
        if self.edge.last { self.apex - d } else { self.apex + d }
    }

    /// Distance from the point and the angle of the turn, which for a sector goes a little beyond its ends.
    fn polar(&self, p: DVec2) -> (f64, f64) {
        let y = if self.clockwise { -p.y } else { p.y };
        let angle = libm::atan2(y, p.x);
        // Angles are measured from the middle of a sector, that is where they jump least.
        let angle =
            if self.disc { if angle < 0.0 { angle + TAU } else { angle } } else { angle + 0.5 * self.turn.total() };
        (p.length(), angle)
    }

    fn of_polar(&self, distance: f64, angle: f64) -> DVec2 {
        let angle = if self.disc { angle } else { angle - 0.5 * self.turn.total() };
        let (sin, cos) = libm::sincos(angle);
        DVec2::new(cos, if self.clockwise { -sin } else { sin }) * distance
    }

    fn of_uv(&self, uv: DVec2) -> DVec2 {
        let (along, away) = if self.edge.axis == 0 { (uv.y, uv.x) } else { (uv.x, uv.y) };
        let distance = if self.edge.last { self.apex - away } else { away - self.apex } * self.scale;
        let angle = self.turn.angle_of(along, self.disc);
        self.of_polar(distance, angle)
    }

    fn at(&self, surface: &NurbsSurface, p: DVec2) -> ChartPoint {
        let (distance, angle) = self.polar(p);
        let near = distance < AT_POINT * surface.size();
        let angle = if near { if self.disc { 0.0 } else { 0.5 * self.turn.total() } } else { angle };
        let (along, slope) = self.turn.at(angle);
        let uv = place(self.edge, along, self.away(distance));
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

/// A parameter as a smooth, growing function of an angle: cubic pieces through a table.
#[derive(Clone, Debug)]
struct Turn {
    angles: Vec<f64>,
    values: Vec<f64>,
    /// Derivatives of the values by the angle.
    slopes: Vec<f64>,
}

impl Turn {
    /// From the rate at which the angle turns with the parameter.
    fn new(breaks: &[f64], rate: &dyn Fn(f64) -> f64) -> Turn {
        let mut values = Vec::new();
        for w in breaks.windows(2) {
            values.extend((0..PIECES).map(|i| w[0] + (w[1] - w[0]) * i as f64 / PIECES as f64));
        }
        let last = breaks[breaks.len() - 1];
        values.push(last);
        let range = last - breaks[0];
        // Five Gauss points a piece; a rate that vanishes somewhere is lifted, so that the angle grows everywhere.
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
        // Whatever the rate says, a sector has an angle that can be drawn.
        let least = 0.02 * whole.max(0.1) / range;
        let rate = |t: f64| rate(t).max(least);
        let mut angles = vec![0.0];
        for w in values.windows(2) {
            angles.push(angles[angles.len() - 1] + integral(w[0], w[1], &rate));
        }
        // At a knot the rate may jump; the slope is taken from both sides' mean so that the table stays smooth.
        let hair = 1e-9 * range;
        let slope = |t: f64| {
            let (before, after) = ((t - hair).max(values[0]), (t + hair).min(last));
            2.0 / (rate(before) + rate(after))
        };
        let slopes = values.iter().map(|&t| slope(t)).collect();
        let turn = Turn { angles, values, slopes };
        // A sector of more than nearly a full turn would cover itself.
        let most = TAU - 0.05;
        let total = turn.total();
        if total > most && (total - TAU).abs() >= ROUND { turn.stretched_to(most) } else { turn }
    }

    fn total(&self) -> f64 {
        self.angles[self.angles.len() - 1]
    }

    fn stretched_to(mut self, total: f64) -> Turn {
        let factor = total / self.total();
        self.angles.iter_mut().for_each(|a| *a *= factor);
        self.slopes.iter_mut().for_each(|s| *s /= factor);
        let last = self.angles.len() - 1;
        self.angles[last] = total;
        self
    }

    /// The parameter at an angle and its derivative; beyond the ends straight ahead.
    fn at(&self, angle: f64) -> (f64, f64) {
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

    /// The angle of a parameter, by Newton within its piece. Where the parameter repeats itself, angles go on round.
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

/// The singular edges of a surface.
pub fn singular_edges(surface: &NurbsSurface) -> Vec<Edge> {
    EDGES.into_iter().zip(surface.degenerate()).filter(|(_, is)| *is).map(|(edge, _)| edge).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::geometry::frame::Frame;
    use crate::core::geometry::primitive::{cone, sphere, torus};
    use crate::core::geometry::surface::NurbsSurface;

    fn frame() -> Frame {
        Frame::new(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.3, -0.2, 1.0), None).unwrap()
    }

    fn charts() -> Vec<(Chart, f64)> {
        let whole = [0.0, 360.0];
        let ball = Arc::new(sphere(&frame(), 2.0, whole, [-90.0, 90.0]).unwrap());
        let cap = Arc::new(sphere(&frame(), 2.0, [0.0, 100.0], [10.0, 90.0]).unwrap());
        let funnel = Arc::new(cone(&frame(), [1.5, 0.0], 2.0, whole).unwrap());
        let ring = Arc::new(torus(&frame(), 3.0, 1.0, whole, whole).unwrap());
        vec![
            (Chart::about(Arc::clone(&ball), EDGES[0]), 2.0),
            (Chart::about(Arc::clone(&ball), EDGES[2]), 2.0),
            (Chart::about(cap, EDGES[2]), 2.0),
            (Chart::about(funnel, EDGES[2]), 1.5),
            (Chart::sheet(ring), 2.0),
        ]
    }

    #[test]
    fn derivatives_by_the_chart_agree_with_differences_and_keep_the_orientation() {
        for (k, (chart, reach)) in charts().into_iter().enumerate() {
            let disc = chart.is_disc();
            assert_eq!(disc, k < 2);
            for i in 0..200 {
                let r = reach * (0.001 + 0.9 * f64::from(i) / 200.0);
                let angle = if disc { 0.7 * f64::from(i) } else { 0.3 * libm::sin(f64::from(i)) };
                let p = DVec2::from_angle(angle) * r;
                let at = chart.at(p);
                let h = 1e-6 * r.max(0.01);
                for (axis, j) in [DVec2::X, DVec2::Y].into_iter().zip(at.j) {
                    let slope = (chart.at(p + axis * h).xyz - chart.at(p - axis * h).xyz) / (2.0 * h);
                    assert!(slope.distance(j) < 1e-5 * (1.0 + j.length()), "{k} {p}: {slope} {j}");
                }
                let own = chart.surface().at(at.uv, 1);
                assert!(at.xyz.distance(own.p) < 1e-14);
                assert!(at.normal().dot(own.normal()) > 1.0 - 1e-9, "{k} {p}");
                assert!(chart.of_uv(at.uv).distance(p) < 1e-12 || !disc && k == 4, "{k} {p}");
            }
        }
    }

    #[test]
    fn at_a_pole_the_chart_is_an_isometry_from_every_side() {
        let (chart, _) = charts().swap_remove(0);
        for i in 0..64 {
            for r in [0.0, 1e-12, 1e-7, 1e-5] {
                let g = chart.at(DVec2::from_angle(0.1 * f64::from(i)) * r).first_form();
                assert!((g.uu - 1.0).abs() < 1e-4 && (g.vv - 1.0).abs() < 1e-4 && g.uv.abs() < 1e-4, "{i} {r} {g:?}");
            }
        }
    }

    #[test]
    fn the_sector_of_a_cone_is_its_development() {
        let (chart, _) = charts().swap_remove(3);
        for i in 0..50 {
            let p = DVec2::from_angle(0.03 * f64::from(i) - 0.7) * (0.01 + 0.02 * f64::from(i));
            let g = chart.at(p).first_form();
            assert!((g.uu - 1.0).abs() < 1e-4 && (g.vv - 1.0).abs() < 1e-4 && g.uv.abs() < 1e-4, "{g:?}");
        }
    }

    #[test]
    fn points_of_a_surface_are_found_in_its_chart_and_others_at_their_distance() {
        for (chart, reach) in charts() {
            for i in 0..40 {
                let p = DVec2::from_angle(0.2 * libm::sin(f64::from(i))) * (reach * f64::from(i) / 40.0);
                let xyz = chart.at(p).xyz;
                let (q, off) = chart.locate(xyz);
                assert!(off < 1e-12 && chart.at(q).xyz.distance(xyz) < 1e-12, "{p} {q} {off}");
                let (_, off) = chart.locate(xyz + chart.at(p).normal() * 0.1);
                assert!((off - 0.1).abs() < 1e-6, "{off}");
            }
        }
    }

    #[test]
    fn a_three_sided_patch_gets_a_sector() {
        let points = [(0.0, 0.0), (0.0, 0.0), (1.0, 0.0), (0.3, 0.9)].map(|(x, y)| DVec3::new(x, y, 0.0));
        let line = vec![0.0, 0.0, 1.0, 1.0];
        let patch = NurbsSurface::new([1, 1], [line.clone(), line], &[], &points, 2).unwrap();
        assert_eq!(singular_edges(&patch), [EDGES[3]]);
        let chart = Chart::about(Arc::new(patch), EDGES[3]);
        for p in [DVec2::new(0.5, 0.1), DVec2::new(1e-13, 0.0), DVec2::new(0.4, -0.2)] {
            let g = chart.at(p).first_form();
            assert!(g.det() > 0.3 && g.uu < 3.0 && g.vv < 3.0, "{g:?}");
        }
    }
}
