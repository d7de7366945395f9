//! NURBS surfaces (eq. 1) after Piegl & Tiller, "The NURBS Book": points with first and second derivatives (A3.6 on
//! homogeneous control points, A4.4 for the quotient), the normal, the first fundamental form and the principal
//! curvatures.
//!
//! Every evaluation of the metric evaluates the surface, so that most of the time on surfaces is spent here. For the
//! usual low degrees, the surface therefore keeps the Taylor series of each polynomial piece about its middle, computed
//! once by A3.6: exact up to rounding, and several times as fast.
//!
//! `chart` maps a surface to the plane in which it is meshed; `complex` bounds it by curves.

use glam::{DVec2, DVec3, DVec4};

use super::curve::check_coordinates;
use super::nurbs::{Basis, weighted};
use super::spec::SurfaceShape;
use crate::core::fault::Fault;
use crate::core::kernel::box_tree::extent;

/// Control points closer than this fraction of the surface's size coincide.
const SAME: f64 = 1e-12;

/// The highest degree with Taylor series; those of higher degrees would lose digits.
const SERIES: usize = 5;

/// A point of a surface with its derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfacePoint {
    /// The point.
    pub p: DVec3,
    /// First derivatives by u and v.
    pub d: [DVec3; 2],
    /// Second derivatives by uu, uv, vv; zero if not requested.
    pub dd: [DVec3; 3],
}

/// An edge of the parametric rectangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// The parameter that is constant on it: 0 for u, 1 for v.
    pub axis: usize,
    /// Whether that parameter has its last value there, not its first.
    pub last: bool,
}

impl Edge {
    /// (u, v) of the parameter along the edge and the parameter across it.
    pub fn uv(self, along: f64, across: f64) -> DVec2 {
        if self.axis == 0 { DVec2::new(across, along) } else { DVec2::new(along, across) }
    }
}

/// The four edges of a parametric rectangle.
pub const EDGES: [Edge; 4] = [
    Edge { axis: 1, last: false },
    Edge { axis: 0, last: true },
    Edge { axis: 1, last: true },
    Edge { axis: 0, last: false },
];

/// A rational B-spline surface.
#[derive(Clone, Debug, PartialEq)]
pub struct NurbsSurface {
    bases: [Basis; 2],
    /// Control points times their weights, and the weights, in rows along v: `i * columns + j`.
    weighted: Vec<DVec4>,
    /// Number of control points along v.
    columns: usize,
    /// Whether all weights are equal, so that no division is needed.
    polynomial: bool,
    size: f64,
    domain: [[f64; 2]; 2],
    closed: [bool; 2],
    degenerate: [bool; 4],
    series: Option<Series>,
}

/// The Taylor series of the polynomial pieces about their middles, in local coordinates from -1 to 1.
#[derive(Clone, Debug, PartialEq)]
struct Series {
    /// The parameters between the pieces, along u and v.
    breaks: [Vec<f64>; 2],
    /// Coefficients of `s^k t^l` at `k * (q + 1) + l`, piece by piece in rows along v.
    coefficients: Vec<DVec4>,
    /// Degrees.
    degrees: [usize; 2],
}

impl Series {
    fn of(surface: &NurbsSurface) -> Option<Series> {
        let degrees = [0, 1].map(|axis| surface.bases[axis].degree());
        if degrees.iter().any(|degree| *degree > SERIES) {
            return None;
        }
        let breaks = [0, 1].map(|axis| surface.breaks(axis));
        let [p, q] = degrees;
        let mut coefficients = Vec::new();
        // Derivatives of the basis functions at the middle of a piece, times powers of its half width over factorials.
        let expanded = |axis: usize, w: &[f64]| {
            let (middle, half) = (0.5 * (w[0] + w[1]), 0.5 * (w[1] - w[0]));
            let span = surface.bases[axis].span(middle);
            let mut ders = surface.bases[axis].derivatives(span, middle, degrees[axis]);
            let mut factor = 1.0;
            for (k, values) in ders.iter_mut().enumerate() {
                factor *= if k == 0 { 1.0 } else { half / k as f64 };
                values.iter_mut().for_each(|v| *v *= factor);
            }
            (span - degrees[axis], ders)
        };
        for w_u in breaks[0].windows(2) {
            let (first_i, n_u) = expanded(0, w_u);
            for w_v in breaks[1].windows(2) {
                let (first_j, n_v) = expanded(1, w_v);
                for along_u in &n_u {
                    for along_v in &n_v {
                        let mut sum = DVec4::ZERO;
                        for i in 0..=p {
                            for j in 0..=q {
                                let point = surface.weighted[(first_i + i) * surface.columns + first_j + j];
                                sum += point * (along_u[i] * along_v[j]);
                            }
                        }
                        coefficients.push(sum);
                    }
                }
            }
        }
        Some(Series { breaks, coefficients, degrees })
    }

    /// The piece that contains a parameter, the local coordinate there and its derivative by the parameter.
    #[inline]
    fn piece(&self, axis: usize, t: f64) -> (usize, f64, f64) {
        let breaks = &self.breaks[axis];
        let last = breaks.len() - 2;
        let mut i = 0;
        while i < last && t >= breaks[i + 1] {
            i += 1;
        }
        let (a, b) = (breaks[i], breaks[i + 1]);
        let rate = 2.0 / (b - a);
        (i, (t - 0.5 * (a + b)) * rate, rate)
    }

    /// Homogeneous point and its derivatives: `[k][l]` by u and v, for `k + l` up to `ORDER`.
    #[inline(always)]
    fn at<const ORDER: usize>(&self, [u, v]: [f64; 2]) -> [[DVec4; 3]; 3] {
        let [p, q] = self.degrees;
        let ((i, s, rate_u), (j, t, rate_v)) = (self.piece(0, u), self.piece(1, v));
        let start = (i * (self.breaks[1].len() - 1) + j) * (p + 1) * (q + 1);
        let coefficients = &self.coefficients[start..start + (p + 1) * (q + 1)];
        // Horner's scheme with derivatives, along v inside and along u outside.
        let (mut f, mut f_s, mut f_ss) = (DVec4::ZERO, DVec4::ZERO, DVec4::ZERO);
        let (mut f_t, mut f_st, mut f_tt) = (DVec4::ZERO, DVec4::ZERO, DVec4::ZERO);
        for row in coefficients.rchunks_exact(q + 1) {
            let (mut g, mut g_t, mut g_tt) = (DVec4::ZERO, DVec4::ZERO, DVec4::ZERO);
            for &c in row.iter().rev() {
                if ORDER > 1 {
                    g_tt = g_tt * t + g_t;
                }
                g_t = g_t * t + g;
                g = g * t + c;
            }
            if ORDER > 1 {
                f_ss = f_ss * s + f_s;
                f_st = f_st * s + f_t;
                f_tt = f_tt * s + g_tt * 2.0;
            }
            f_s = f_s * s + f;
            f = f * s + g;
            f_t = f_t * s + g_t;
        }
        let none = DVec4::ZERO;
        [
            [f, f_t * rate_v, f_tt * (rate_v * rate_v)],
            [f_s * rate_u, f_st * (rate_u * rate_v), none],
            [f_ss * (2.0 * rate_u * rate_u), none, none],
        ]
    }
}

impl NurbsSurface {
    /// A surface of control points `points[i * columns + j]`, i along u and j along v; an empty list of weights means
    /// that all are 1.
    ///
    /// # Errors
    /// What [`Basis::new`] refuses in either direction, points that are not finite, beyond 1e100 or all equal, weights
    /// that are not positive and finite or differ in number from the points.
    pub fn new(
        degrees: [usize; 2],
        knots: [Vec<f64>; 2],
        weights: &[f64],
        points: &[DVec3],
        columns: usize,
    ) -> Result<Self, Fault> {
        if columns == 0 || !points.len().is_multiple_of(columns) {
            return Err(Fault::new("The rows of control points are not all of the same length")
                .remedy("Give a list of rows, each with the same number of points"));
        }
        let rows = points.len() / columns;
        let [knots_u, knots_v] = knots;
        let about = |which: &'static str| move |fault: Fault| fault.at(format!("along {which}"));
        let bases = [
            Basis::new(degrees[0], knots_u, rows).map_err(about("u"))?,
            Basis::new(degrees[1], knots_v, columns).map_err(about("v"))?,
        ];
        check_coordinates(points)?;
        let weighted: Vec<DVec4> = weighted(points, weights)?.into_iter().map(|(p, w)| p.extend(w)).collect();
        let (low, high) = extent(points.iter().copied());
        let size = (high - low).max_element();
        if size <= 0.0 {
            return Err(Fault::new("The surface has zero size: all its control points are equal"));
        }
        let polynomial = weighted.iter().all(|p| p.w == 1.0);
        let domain = bases.each_ref().map(|basis| basis.domain().into());
        let mut surface = NurbsSurface {
            bases,
            weighted,
            columns,
            polynomial,
            size,
            domain,
            closed: [false; 2],
            degenerate: [false; 4],
            series: None,
        };
        surface.closed = [0, 1].map(|axis| surface.edges_agree(axis));
        surface.degenerate = EDGES.map(|edge| surface.is_point(edge));
        if surface.degenerate[0] && surface.degenerate[2] && surface.edges_agree(1)
            || surface.degenerate[1] && surface.degenerate[3] && surface.edges_agree(0)
        {
            return Err(Fault::new("Two opposite edges of the surface are the same point")
                .remedy("Divide it, so that the singular points of each part are different"));
        }
        surface.series = Series::of(&surface);
        Ok(surface)
    }

    /// Whether it is a parallelogram whose parameters are lengths along its sides, but for a factor.
    pub fn is_parallelogram(&self) -> bool {
        let degrees = self.bases.each_ref().map(Basis::degree);
        let fourth = || self.control(1, 0) + self.control(0, 1) - self.control(0, 0) - self.control(1, 1);
        degrees == [1, 1] && self.polynomial && self.weighted.len() == 4 && fourth().length() <= SAME * self.size
    }

    /// As a shape of a case.
    pub fn shape(&self) -> SurfaceShape {
        SurfaceShape::Nurbs {
            degrees: self.bases.each_ref().map(Basis::degree),
            knots: self.bases.each_ref().map(|basis| basis.knots().to_vec()),
            weights: if self.polynomial { Vec::new() } else { self.weighted.iter().map(|p| p.w).collect() },
            points: self.weighted.iter().map(|p| p.truncate() / p.w).collect(),
            columns: self.columns,
        }
    }

    /// The largest extent of the control points along an axis.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// First and last u, first and last v.
    #[inline]
    pub fn domain(&self) -> [[f64; 2]; 2] {
        self.domain
    }

    /// Whether it is closed in u, and in v: the last edge is the first.
    pub fn closed(&self) -> [bool; 2] {
        self.closed
    }

    /// The period of u (axis 0) or v (axis 1); `None` if the surface is not closed along it.
    pub fn period(&self, axis: usize) -> Option<f64> {
        let [first, last] = self.domain()[axis];
        self.closed[axis].then_some(last - first)
    }

    /// Which of the edges v = 0, u = 1, v = 1, u = 0 degenerate to a singular point.
    pub fn degenerate(&self) -> [bool; 4] {
        self.degenerate
    }

    /// Parameters along an axis between which the surface is smooth.
    pub fn breaks(&self, axis: usize) -> Vec<f64> {
        let [first, last] = self.domain()[axis];
        let mut breaks = vec![first];
        breaks.extend(self.bases[axis].inner_knots().iter().map(|(knot, _)| *knot));
        breaks.push(last);
        breaks
    }

    /// A control point, divided by its weight.
    fn control(&self, i: usize, j: usize) -> DVec3 {
        let p = self.weighted[i * self.columns + j];
        p.truncate() / p.w
    }

    /// The control points along an edge, with their weights.
    fn along(&self, edge: Edge) -> Vec<DVec4> {
        let rows = self.weighted.len() / self.columns;
        let at = |k: usize| {
            let (i, j) = match (edge.axis, edge.last) {
                (0, false) => (0, k),
                (0, true) => (rows - 1, k),
                (_, false) => (k, 0),
                (_, true) => (k, self.columns - 1),
            };
            self.control(i, j).extend(self.weighted[i * self.columns + j].w)
        };
        (0..if edge.axis == 0 { self.columns } else { rows }).map(at).collect()
    }

    /// Whether the first and the last edge of an axis are the same curve. The knots must be clamped, since only then do
    /// the outer control points determine the edges.
    fn edges_agree(&self, axis: usize) -> bool {
        let [first, last] = [false, true].map(|last| self.along(Edge { axis, last }));
        let near = |(a, b): (&DVec4, &DVec4)| {
            (a.truncate() - b.truncate()).length() <= SAME * self.size
                && (a.w / b.w - first[0].w / last[0].w).abs() <= SAME
        };
        self.is_clamped(axis) && first.iter().zip(&last).all(near)
    }

    fn is_clamped(&self, axis: usize) -> bool {
        let (knots, degree) = (self.bases[axis].knots(), self.bases[axis].degree());
        let last = knots.len() - 1;
        knots[0] == knots[degree] && knots[last] == knots[last - degree]
    }

    fn is_point(&self, edge: Edge) -> bool {
        let points = self.along(edge);
        self.is_clamped(edge.axis)
            && points.iter().all(|p| (p.truncate() - points[0].truncate()).length() <= SAME * self.size)
    }

    /// Point and derivatives up to `order` (1 or 2). Beyond its edges, the surface continues periodically if it is
    /// closed, and linearly otherwise.
    pub fn at(&self, uv: DVec2, order: usize) -> SurfacePoint {
        let domain = self.domain();
        let mut inside = [uv.x, uv.y];
        let mut beyond = [0.0; 2];
        for axis in 0..2 {
            let [first, last] = domain[axis];
            let t = inside[axis];
            if t < first || t > last {
                if self.closed[axis] {
                    let turns = ((t - first) / (last - first)).floor();
                    inside[axis] = (t - turns * (last - first)).clamp(first, last);
                } else {
                    inside[axis] = t.clamp(first, last);
                    beyond[axis] = t - inside[axis];
                }
            }
        }
        let mut point = self.within(inside, order);
        if beyond != [0.0; 2] {
            point.p += point.d[0] * beyond[0] + point.d[1] * beyond[1];
        }
        point
    }

    /// Point and derivatives inside the parameter range.
    #[inline]
    fn within(&self, uv: [f64; 2], order: usize) -> SurfacePoint {
        match &self.series {
            Some(series) if order == 1 => self.divided::<1>(&series.at::<1>(uv)),
            Some(series) => self.divided::<2>(&series.at::<2>(uv)),
            None if order == 1 => self.divided::<1>(&self.by_basis(uv, 1)),
            None => self.divided::<2>(&self.by_basis(uv, 2)),
        }
    }

    /// Homogeneous point and derivatives from the basis functions.
    fn by_basis(&self, [u, v]: [f64; 2], order: usize) -> [[DVec4; 3]; 3] {
        let spans = [self.bases[0].span(u), self.bases[1].span(v)];
        let n_u = self.bases[0].derivatives(spans[0], u, order);
        let n_v = self.bases[1].derivatives(spans[1], v, order);
        let [p, q] = [self.bases[0].degree(), self.bases[1].degree()];
        let (first_i, first_j) = (spans[0] - p, spans[1] - q);
        // A3.6 on homogeneous points: derivatives along u of each column, then along v of the results.
        let mut sums = [[DVec4::ZERO; 3]; 3];
        for j in 0..=q {
            let mut column = [DVec4::ZERO; 3];
            for i in 0..=p {
                let point = self.weighted[(first_i + i) * self.columns + first_j + j];
                for (sum, n) in column.iter_mut().zip(&n_u) {
                    *sum += point * n[i];
                }
            }
            for k in 0..=order {
                for l in 0..=order - k {
                    sums[k][l] += column[k] * n_v[l][j];
                }
            }
        }
        sums
    }

    /// Point and derivatives of the quotient (A4.4).
    #[inline(always)]
    fn divided<const ORDER: usize>(&self, sums: &[[DVec4; 3]; 3]) -> SurfacePoint {
        let at = |k: usize, l: usize| (sums[k][l].truncate(), sums[k][l].w);
        let (s, w) = at(0, 0);
        if self.polynomial {
            let dd = if ORDER > 1 { [at(2, 0).0, at(1, 1).0, at(0, 2).0] } else { [DVec3::ZERO; 3] };
            return SurfacePoint { p: s, d: [at(1, 0).0, at(0, 1).0], dd };
        }
        let p = s / w;
        let ((a_u, w_u), (a_v, w_v)) = (at(1, 0), at(0, 1));
        let (d_u, d_v) = ((a_u - p * w_u) / w, (a_v - p * w_v) / w);
        let mut dd = [DVec3::ZERO; 3];
        if ORDER > 1 {
            let ((a_uu, w_uu), (a_uv, w_uv), (a_vv, w_vv)) = (at(2, 0), at(1, 1), at(0, 2));
            dd = [
                (a_uu - d_u * (2.0 * w_u) - p * w_uu) / w,
                (a_uv - d_v * w_u - d_u * w_v - p * w_uv) / w,
                (a_vv - d_v * (2.0 * w_v) - p * w_vv) / w,
            ];
        }
        SurfacePoint { p, d: [d_u, d_v], dd }
    }
}

/// The curvature of a surface at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend {
    /// The normal, on the side of `r_u x r_v`.
    pub normal: DVec3,
    /// Unit tangents in the principal directions.
    pub directions: [DVec3; 2],
    /// The principal curvatures in those directions, the one of larger magnitude first; units 1 / length.
    pub curvatures: [f64; 2],
}

impl SurfacePoint {
    /// The unit normal; zero at a singular point.
    #[inline]
    pub fn normal(&self) -> DVec3 {
        self.d[0].cross(self.d[1]).normalize_or_zero()
    }

    /// Principal curvatures and directions, from derivatives up to the second; `None` at a singular point.
    pub fn bend(&self) -> Option<Bend> {
        let normal = self.normal();
        let [a, b] = self.d;
        if normal == DVec3::ZERO {
            return None;
        }
        // The second form in an orthonormal frame of the tangent plane: e = a / |a|, f = n x e, J = [e f] T.
        let e = a.normalize();
        let f = normal.cross(e);
        let (t_11, t_12, t_22) = (a.length(), b.dot(e), b.dot(f));
        let [l, m, n] = self.dd.map(|d| d.dot(normal));
        // S = T^-T II T^-1 for the upper triangular T = [[t_11, t_12], [0, t_22]].
        let s_11 = l / (t_11 * t_11);
        let s_12 = (m - s_11 * t_11 * t_12) / (t_11 * t_22);
        let s_22 = (n - s_11 * t_12 * t_12 - 2.0 * s_12 * t_12 * t_22) / (t_22 * t_22);
        let (mean, half) = (0.5 * (s_11 + s_22), 0.5 * (s_11 - s_22));
        let radius = libm::hypot(half, s_12);
        let (high, low) = (mean + radius, mean - radius);
        let first = if high.abs() >= low.abs() { high } else { low };
        let second = high + low - first;
        // The direction of the first curvature: the longer of the two rows of S - second I.
        let (x, y) = ((s_11 - second, s_12), (s_12, s_22 - second));
        let along = if libm::hypot(x.0, x.1) >= libm::hypot(y.0, y.1) { x } else { y };
        let length = libm::hypot(along.0, along.1);
        let direction = if length > 0.0 { e * (along.0 / length) + f * (along.1 / length) } else { e };
        Some(Bend { normal, directions: [direction, normal.cross(direction)], curvatures: [first, second] })
    }
}

#[cfg(test)]
mod tests;
