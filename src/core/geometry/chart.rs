//! How a face's surface is laid out in the plane in which the face is meshed (paper 3.1; docs/algorithm.md, "Charts and
//! the atlas"): the chart.
//!
//! Away from singular points a chart is the parametric plane, scaled so that its lengths approximate those in space.
//! Around a singular point (a pole or an apex: an edge of the parametric rectangle that degenerates to a point), the
//! secondary mapping replaces it: polar coordinates about the point, in its true angles, so that the derivatives are
//! bounded and the chart is smooth there. A whole turn of nearly 360 true degrees (a pole) becomes a disc without a
//! seam, a smaller one (an apex, a three-sided patch) a sector.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::curve::divided;
use super::surface::{EDGES, Edge, NurbsSurface, SurfacePoint};
use crate::core::kernel::Metric2;
use polar_map::PolarMap;

mod polar_map;

/// Places closer than this fraction of the surface's size coincide.
const MEET: f64 = 1e-6;
/// Places that are farther apart than this fraction of the surface's size do not meet within any tolerance.
const NEAR: f64 = 0.01;
/// Ends of two curves are at most so many tolerances apart: each may be off its vertex and off its surface.
const APART: f64 = 4.0;

/// A surface and its map to a plane.
#[derive(Clone, Debug)]
pub struct Chart {
    surface: Arc<NurbsSurface>,
    map: Map,
}

#[derive(Clone, Debug)]
enum Map {
    /// The parametric plane, with its origin at a corner and u and v scaled; u by a negative factor if it is mirrored.
    Sheet { from: DVec2, scale: DVec2 },
    /// Polar coordinates about a singular edge.
    Polar(Box<PolarMap>),
}

/// A point of a chart: the point in space and its derivatives by the coordinates of the chart.
#[derive(Clone, Copy, Debug)]
pub struct ChartPoint {
    /// The point in space.
    pub xyz: DVec3,
    /// The parameters u and v of the surface.
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

    /// The unit normal, on the side of `r_u x r_v` of the surface unless the chart is reversed.
    #[inline]
    pub fn normal(&self) -> DVec3 {
        self.j[0].cross(self.j[1]).normalize_or_zero()
    }

    /// The vector in the chart whose image is the tangential part of `d`, by the normal equations; zero where J is
    /// singular.
    pub fn pulled_back(&self, d: DVec3) -> DVec2 {
        let g = self.first_form();
        let b = DVec2::new(self.j[0].dot(d), self.j[1].dot(d));
        let det = g.det();
        if det > 0.0 { DVec2::new(g.vv * b.x - g.uv * b.y, g.uu * b.y - g.uv * b.x) / det } else { DVec2::ZERO }
    }
}

impl Chart {
    /// The parametric plane of a surface, scaled by the mean lengths of its derivatives; its mirror image if
    /// `reversed`, so that the normal is on the other side.
    pub fn sheet(surface: Arc<NurbsSurface>, reversed: bool) -> Chart {
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
        let mut scale = DVec2::new(sums[0] / count, sums[1] / count).max(DVec2::splat(f64::MIN_POSITIVE));
        if reversed {
            scale.x = -scale.x;
        }
        Chart { surface, map: Map::Sheet { from: DVec2::new(u0, v0), scale } }
    }

    /// The secondary mapping about a singular edge of the surface; its mirror image if `reversed`.
    pub fn about(surface: Arc<NurbsSurface>, edge: Edge, reversed: bool) -> Chart {
        let polar = PolarMap::new(&surface, edge, reversed);
        Chart { surface, map: Map::Polar(Box::new(polar)) }
    }

    /// The surface.
    pub fn surface(&self) -> &Arc<NurbsSurface> {
        &self.surface
    }

    /// The singular edge at the centre of the chart.
    pub fn centre(&self) -> Option<Edge> {
        match &self.map {
            Map::Sheet { .. } => None,
            Map::Polar(polar) => Some(polar.edge),
        }
    }

    /// Whether the chart covers the full angle around the singular point, so that there is no seam.
    pub fn is_disc(&self) -> bool {
        matches!(&self.map, Map::Polar(polar) if polar.disc)
    }

    /// Whether the map from u and v is affine, so that it preserves straight lines.
    pub fn keeps_lines(&self) -> bool {
        matches!(self.map, Map::Sheet { .. })
    }

    /// Whether two places coincide: in the chart, or, close to one another there, within a given tolerance in space.
    pub fn same_place(&self, p: DVec2, q: DVec2, tolerance: Option<f64>) -> bool {
        let (size, apart) = (self.surface.size(), p.distance(q));
        let in_space = || {
            let [a, b] = self.at(p).j;
            (a * (q.x - p.x) + b * (q.y - p.y)).length()
        };
        apart <= MEET * size || tolerance.is_some_and(|most| apart <= NEAR * size && in_space() <= APART * most)
    }

    /// Whether it shows a plane as it is, but for stretches: straight lines of space are straight in it, with the same
    /// ratios of lengths.
    pub fn is_affine(&self) -> bool {
        self.keeps_lines() && self.surface.is_parallelogram()
    }

    /// The coordinates in the chart of the parameters u and v.
    pub fn of_uv(&self, uv: DVec2) -> DVec2 {
        match &self.map {
            Map::Sheet { from, scale } => (uv - *from) * *scale,
            Map::Polar(polar) => polar.of_uv(uv),
        }
    }

    /// The parameters u and v of a point of the chart.
    pub fn uv(&self, p: DVec2) -> DVec2 {
        match &self.map {
            Map::Sheet { from, scale } => *from + p / *scale,
            Map::Polar(polar) => {
                let (_, angle) = polar.polar(p);
                polar.edge.uv(polar.turn.at(angle).0, polar.away(p.length()))
            }
        }
    }

    /// The point in space with the derivatives by the chart's coordinates; at the singular point, the limit along the
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

    /// The point of the surface with second derivatives by u and v; close to a singular point, that of a point beside
    /// it.
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

    /// The point of the chart whose surface point is nearest to `xyz`, by Gauss-Newton from a guess, and the remaining
    /// distance.
    pub fn project(&self, xyz: DVec3, guess: DVec2) -> (DVec2, f64) {
        let size = self.surface.size();
        let mut p = guess;
        let mut at = self.at(p);
        let mut off = at.xyz.distance(xyz);
        for _ in 0..40 {
            let step = at.pulled_back(xyz - at.xyz);
            let mut share = 1.0;
            let mut next = self.at(p + step);
            // Halve a step that increases the distance, except by rounding errors.
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

    /// The point of the chart whose surface point is nearest to `xyz`, and the distance: a search over the whole
    /// surface.
    pub fn locate(&self, xyz: DVec3) -> (DVec2, f64) {
        let [[u0, u1], [v0, v1]] = self.surface.domain();
        let mut starts: Vec<(f64, DVec2)> = Vec::new();
        let line = |axis: usize| {
            let breaks = self.surface.breaks(axis);
            divided(&breaks, (24 / (breaks.len() - 1)).max(4))
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

/// The singular edges of a surface.
pub fn singular_edges(surface: &NurbsSurface) -> Vec<Edge> {
    EDGES.into_iter().zip(surface.degenerate()).filter(|(_, is)| *is).map(|(edge, _)| edge).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::geometry::frame::AxisFrame;
    use crate::core::geometry::primitive::{cone, sphere, torus};
    use crate::core::geometry::surface::NurbsSurface;

    fn frame() -> AxisFrame {
        AxisFrame::new(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.3, -0.2, 1.0), None).unwrap()
    }

    fn charts() -> Vec<(Chart, f64)> {
        let whole = [0.0, 360.0];
        let ball = Arc::new(sphere(&frame(), 2.0, whole, [-90.0, 90.0]).unwrap());
        let cap = Arc::new(sphere(&frame(), 2.0, [0.0, 100.0], [10.0, 90.0]).unwrap());
        let funnel = Arc::new(cone(&frame(), [1.5, 0.0], 2.0, whole).unwrap());
        let ring = Arc::new(torus(&frame(), 3.0, 1.0, whole, whole).unwrap());
        vec![
            (Chart::about(Arc::clone(&ball), EDGES[0], false), 2.0),
            (Chart::about(Arc::clone(&ball), EDGES[2], false), 2.0),
            (Chart::about(cap, EDGES[2], false), 2.0),
            (Chart::about(funnel, EDGES[2], false), 1.5),
            (Chart::sheet(ring, false), 2.0),
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
        let chart = Chart::about(Arc::new(patch), EDGES[3], false);
        for p in [DVec2::new(0.5, 0.1), DVec2::new(1e-13, 0.0), DVec2::new(0.4, -0.2)] {
            let g = chart.at(p).first_form();
            assert!(g.det() > 0.3 && g.uu < 3.0 && g.vv < 3.0, "{g:?}");
        }
    }
}
