//! Planar curves: segment, circular arc, polyline, NURBS, all with a parameter in [0, 1]. Their names and common
//! vertices are in `domain`.

mod part;

use glam::DVec2;

use super::nurbs::{NurbsCurve, Vector};
use super::nurbs_part::NurbsPart;
use super::spec::CurveShape;
use crate::core::fault::Fault;
use crate::core::kernel::box_tree::extent;
use crate::core::kernel::decimal::{number, point_text};

/// Larger coordinates are refused, so that no square of one overflows.
pub(super) const LARGEST: f64 = 1e100;

/// A valid curve: all its numbers are finite, and no straight piece has zero length.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    path: Path,
    closed: bool,
    corners: Vec<f64>,
}

/// A closed polyline repeats its first point at the end; `corners` are the indices of its inner corners.
#[derive(Clone, Debug, PartialEq)]
enum Path {
    Segment { from: DVec2, to: DVec2 },
    Arc { centre: DVec2, radius: f64, from_angle: f64, turn: f64 },
    Polyline { points: Vec<DVec2>, corners: Vec<u32> },
    Nurbs(NurbsPart),
}

impl Curve {
    /// The curve of a shape.
    ///
    /// # Errors
    /// Numbers that are not finite or beyond 1e100, a radius that is not positive, an arc of no angle or of more than a
    /// full turn, a polyline with fewer than two points or with two equal ones in a row, zero length, and what
    /// [`NurbsCurve::new`] refuses.
    pub fn new(shape: &CurveShape) -> Result<Curve, Fault> {
        let mut closed = false;
        let path = match shape {
            CurveShape::Segment { from, to } => {
                check_coordinates(&[*from, *to])?;
                if from == to {
                    return Err(Fault::new(format!("It has zero length: both its ends are {}", point_text(*from))));
                }
                Path::Segment { from: *from, to: *to }
            }
            CurveShape::Arc { centre, radius, from_angle, to_angle } => {
                check_coordinates(&[*centre])?;
                if !(*radius > 0.0 && *radius <= LARGEST) {
                    return Err(Fault::new(format!("Its radius is {radius}")).remedy("Give a positive radius"));
                }
                let mut turn = to_angle - from_angle;
                let full = std::f64::consts::TAU;
                if !(turn.is_finite() && from_angle.abs() <= 1e6) {
                    return Err(Fault::new(format!("Its angles are {from_angle} and {to_angle} radians")));
                }
                if turn == 0.0 {
                    return Err(Fault::new("It has zero length: the arc begins and ends at the same angle")
                        .remedy("For a circle, make to_angle 360 degrees more than from_angle"));
                }
                if (turn.abs() - full).abs() <= 1e-9 {
                    turn = full * turn.signum();
                    closed = true;
                }
                if turn.abs() > full {
                    return Err(Fault::new(format!(
                        "The arc turns by {} degrees, more than a full turn",
                        number(turn.to_degrees())
                    ))
                    .remedy("Make its angles differ by at most 360 degrees"));
                }
                Path::Arc { centre: *centre, radius: *radius, from_angle: *from_angle, turn }
            }
            CurveShape::Polyline { points, closed: close, corner_angle } => {
                check_coordinates(points)?;
                let points = points_of_polyline(points, *close)?;
                closed = points.first() == points.last();
                Path::Polyline { corners: sharp_points(&points, *corner_angle), points }
            }
            CurveShape::Nurbs { degree, knots, weights, points } => {
                check_coordinates(points)?;
                if points.windows(2).all(|w| w[0] == w[1]) {
                    return Err(Fault::new("It has zero length: all its control points are the same"));
                }
                let whole = NurbsCurve::new(*degree, knots.clone(), weights, points)?;
                Path::Nurbs(NurbsPart::all_of(whole))
            }
        };
        let mut curve = Curve { path, closed, corners: Vec::new() };
        curve.closed |= curve.point(0.0) == curve.point(1.0);
        curve.corners = curve.find_corners();
        Ok(curve)
    }

    /// Point and derivative by `t`, in [0, 1]; at a corner, the derivative after it.
    pub fn at(&self, t: f64) -> (DVec2, DVec2) {
        match &self.path {
            // Both forms are exact at their ends.
            Path::Segment { from, to } => (lerp(*from, *to, t), *to - *from),
            Path::Arc { centre, radius, from_angle, turn } => {
                let (sin, cos) = libm::sincos(from_angle + if self.closed && t == 1.0 { 0.0 } else { t * turn });
                let (slope_sin, slope_cos) = libm::sincos(from_angle + t * turn);
                (*centre + *radius * DVec2::new(cos, sin), radius * turn * DVec2::new(-slope_sin, slope_cos))
            }
            Path::Polyline { points, .. } => {
                let n = points.len() - 1;
                let (i, s) = piece(n, t);
                (lerp(points[i], points[i + 1], s), n as f64 * (points[i + 1] - points[i]))
            }
            Path::Nurbs(nurbs) => nurbs.at(t),
        }
    }

    /// The point at `t` in [0, 1].
    pub fn point(&self, t: f64) -> DVec2 {
        self.at(t).0
    }

    /// Whether its end is exactly its start.
    pub fn closed(&self) -> bool {
        self.closed
    }

    /// Whether all its pieces between breaks are straight.
    pub fn straight(&self) -> bool {
        match &self.path {
            Path::Segment { .. } | Path::Polyline { .. } => true,
            Path::Arc { .. } => false,
            Path::Nurbs(nurbs) => nurbs.degree() == 1,
        }
    }

    /// Whether its ends are given coordinates, not computed ones.
    pub fn ends_given(&self) -> bool {
        matches!(self.path, Path::Segment { .. } | Path::Polyline { .. })
    }

    /// Inner parameters at which the direction jumps, ascending: they become nodes.
    pub fn corners(&self) -> &[f64] {
        &self.corners
    }

    /// The number of inner points of a polyline that are no corners.
    pub fn smooth_points(&self) -> usize {
        match &self.path {
            Path::Polyline { points, corners } => points.len() - 2 - corners.len(),
            _ => 0,
        }
    }

    /// Parameters between which the curve is smooth, from 0 to 1: its corners, all points of a polyline and the knots
    /// of a NURBS.
    pub fn breaks(&self) -> Vec<f64> {
        match &self.path {
            Path::Segment { .. } | Path::Arc { .. } => vec![0.0, 1.0],
            Path::Polyline { points, .. } => with_ends(inner_parameters(points).into_iter()),
            Path::Nurbs(nurbs) => with_ends(nurbs.knots()),
        }
    }

    /// Points of the curve with their parameters, from 0 to 1, so dense that the distance of the chords from the curve
    /// is at most about `tolerance`. They include all corners. There are at most about 65,000 between two breaks,
    /// however small the tolerance.
    pub fn polyline(&self, tolerance: f64) -> Vec<(f64, DVec2)> {
        match &self.path {
            Path::Segment { .. } | Path::Polyline { .. } => {
                self.breaks().into_iter().map(|t| (t, self.point(t))).collect()
            }
            Path::Arc { radius, turn, .. } => {
                // The distance of a chord over the angle 2a from its arc is r (1 - cos a), about r a^2 / 2.
                let step = (2.0 * (2.0 * tolerance.max(0.0) / radius).sqrt()).clamp(1e-4, std::f64::consts::FRAC_PI_6);
                let n = (turn.abs() / step).ceil().max(1.0);
                (0..=n as usize).map(|i| i as f64 / n).map(|t| (t, self.point(t))).collect()
            }
            Path::Nurbs(nurbs) => chords(&|t| self.point(t), &self.breaks(), nurbs.degree(), self.hull(), tolerance),
        }
    }

    /// A box that contains the curve, not always the smallest.
    pub(super) fn hull(&self) -> (DVec2, DVec2) {
        match &self.path {
            Path::Segment { from, to } => (from.min(*to), from.max(*to)),
            Path::Arc { centre, radius, .. } => (*centre - DVec2::splat(*radius), *centre + DVec2::splat(*radius)),
            Path::Polyline { points, .. } => extent(points.iter().copied()),
            Path::Nurbs(nurbs) => extent(nurbs.control_points()),
        }
    }

    fn find_corners(&self) -> Vec<f64> {
        match &self.path {
            Path::Segment { .. } | Path::Arc { .. } => Vec::new(),
            Path::Polyline { points, corners } => parameters_of(corners, points.len()),
            Path::Nurbs(nurbs) => nurbs.sharp_knots(is_sharp),
        }
    }
}

/// Whether the direction jumps between two derivatives.
fn is_sharp(before: DVec2, after: DVec2) -> bool {
    before.perp_dot(after).abs() > 1e-6 * before.length() * after.length() || before.dot(after) < 0.0
}

/// Points of a curve with their parameters, from 0 to 1, so dense that the distance of the chords from the curve is at
/// most about `tolerance`. They include all breaks; a curve of degree 1 is straight between those. `(low, high)` is a
/// box that contains the curve.
pub(super) fn chords(
    point: &dyn Fn(f64) -> DVec2,
    breaks: &[f64],
    degree: usize,
    (low, high): (DVec2, DVec2),
    tolerance: f64,
) -> Vec<(f64, DVec2)> {
    let tolerance = tolerance.max(1e-9 * (high - low).max_element());
    let mut points = vec![(0.0, point(0.0))];
    let (parts, depth) = if degree == 1 { (1, 0) } else { (2 * degree.min(16), 11) };
    for &t in &divided(breaks, parts)[1..] {
        let before = points[points.len() - 1];
        refine(point, before, (t, point(t)), tolerance, depth, &mut points);
    }
    points
}

/// Parameters from the first to the last break, with `parts` equal parts between two breaks.
pub(super) fn divided(breaks: &[f64], parts: usize) -> Vec<f64> {
    let between = |w: &[f64], i: usize| w[0] + (w[1] - w[0]) * i as f64 / parts as f64;
    let inner = breaks.windows(2).flat_map(|w| (0..parts).map(move |i| between(w, i)));
    inner.chain(breaks.last().copied()).collect()
}

/// Appends the points after `a` up to and including `b`, bisecting while the curve is farther than `tolerance` from the
/// chord.
fn refine(
    point: &dyn Fn(f64) -> DVec2,
    a: (f64, DVec2),
    b: (f64, DVec2),
    tolerance: f64,
    depth: u32,
    points: &mut Vec<(f64, DVec2)>,
) {
    let at = |s: f64| a.0 + (b.0 - a.0) * s;
    let middle = (at(0.5), point(at(0.5)));
    let off =
        [point(at(0.25)), middle.1, point(at(0.75))].iter().any(|p| distance_to_segment(*p, a.1, b.1) > tolerance);
    if depth == 0 || !off || middle.0 <= a.0 || middle.0 >= b.0 {
        points.push(b);
    } else {
        refine(point, a, middle, tolerance, depth - 1, points);
        refine(point, middle, b, tolerance, depth - 1, points);
    }
}

/// The distance of `p` from the straight segment from `a` to `b`.
pub fn distance_to_segment(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let d = b - a;
    let square = d.length_squared();
    let s = if square > 0.0 { ((p - a).dot(d) / square).clamp(0.0, 1.0) } else { 0.0 };
    (p - (a + s * d)).length()
}

/// Linear interpolation that is exact at both ends.
pub(super) fn lerp<P: Vector>(a: P, b: P, t: f64) -> P {
    if t <= 0.5 { a + (b - a) * t } else { b - (b - a) * (1.0 - t) }
}

/// The piece that contains `t`, of `n` equal pieces of [0, 1], and the parameter in it: exactly 0 or 1 at its ends.
pub(super) fn piece(n: usize, t: f64) -> (usize, f64) {
    let x = t * n as f64;
    let nearest = x.round();
    // The parameter i / n of a corner gives exactly i.
    if nearest / n as f64 == t {
        let i = nearest as usize;
        return if i >= n { (n - 1, 1.0) } else { (i, 0.0) };
    }
    let i = (x.floor().max(0.0) as usize).min(n - 1);
    (i, x - i as f64)
}

/// The parameters of the inner points of a polyline.
pub(super) fn inner_parameters<P>(points: &[P]) -> Vec<f64> {
    let n = points.len() - 1;
    (1..n).map(|i| i as f64 / n as f64).collect()
}

/// The parameters of some of the points of a polyline of `count` points, by index.
pub(super) fn parameters_of(points: &[u32], count: usize) -> Vec<f64> {
    points.iter().map(|&i| f64::from(i) / (count - 1) as f64).collect()
}

/// The indices of the inner points of a polyline at which it turns by at least `angle` (radians).
pub(super) fn sharp_points<const N: usize, P: Vector + Into<[f64; N]>>(points: &[P], angle: f64) -> Vec<u32> {
    let direction = |a: P, b: P| -> [f64; N] {
        let d: [f64; N] = (b - a).into();
        let length = d.iter().map(|x| x * x).sum::<f64>().sqrt();
        d.map(|x| x / length)
    };
    // The distance of two unit vectors is twice the sine of half the angle between them.
    let least = 2.0 * libm::sin(0.5 * angle);
    let is_sharp = |&i: &usize| {
        let [before, after] = [i - 1, i].map(|k| direction(points[k], points[k + 1]));
        let squared: f64 = before.iter().zip(after).map(|(x, y)| (x - y) * (x - y)).sum();
        // Also where a length overflows or vanishes.
        squared >= least * least || squared.is_nan()
    };
    (1..points.len() - 1).filter(is_sharp).map(|i| i as u32).collect()
}

/// Inner parameters, ascending, between 0 and 1: each once, and without those that rounding has made 1.
pub(super) fn with_ends(inner: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut breaks: Vec<f64> = std::iter::once(0.0).chain(inner).filter(|&t| t < 1.0).collect();
    breaks.dedup();
    breaks.push(1.0);
    breaks
}

/// Refuses points that are not finite or have coordinates beyond [`LARGEST`].
pub(super) fn check_coordinates<const N: usize, P: Copy + Into<[f64; N]>>(points: &[P]) -> Result<(), Fault> {
    match points.iter().find(|&&p| !p.into().iter().all(|x| x.abs() <= LARGEST)) {
        Some(&p) => Err(Fault::new(format!("Its point {} is not finite or is beyond 1e100", point_text(p)))),
        None => Ok(()),
    }
}

/// The points of a polyline, with the first one repeated at the end if it is to be closed.
///
/// # Errors
/// Coordinates that [`check_coordinates`] refuses, too few points, two equal points in a row.
pub(super) fn points_of_polyline<const N: usize, P: Vector + Into<[f64; N]>>(
    points: &[P],
    close: bool,
) -> Result<Vec<P>, Fault> {
    check_coordinates(points)?;
    let mut corners = points.to_vec();
    if close && points.len() > 1 && points.first() != points.last() {
        corners.push(points[0]);
    }
    if corners.len() < if close { 4 } else { 2 } {
        let kind = if close { "A closed" } else { "An open" };
        let count = corners.len().saturating_sub(usize::from(close));
        let least = if close { 3 } else { 2 };
        return Err(Fault::new(format!("{kind} polyline needs at least {least} points and has {count}")));
    }
    if let Some(i) = (1..corners.len()).find(|&i| corners[i] == corners[i - 1]) {
        let at = point_text(corners[i]);
        return Err(Fault::new(format!("Its points {i} and {} are the same, {at}: a piece of zero length", i + 1))
            .remedy("Remove one of them, or set tolerance (a key of the case), which merges them"));
    }
    Ok(corners)
}

#[cfg(test)]
mod tests {
    use super::super::course::Course;
    use super::*;
    use std::f64::consts::{PI, TAU};

    fn polyline(points: &[(f64, f64)], closed: bool) -> Result<Curve, Fault> {
        let points = points.iter().map(|&(x, y)| DVec2::new(x, y)).collect();
        Curve::new(&CurveShape::Polyline { points, closed, corner_angle: 0.0 })
    }

    fn arc(centre: DVec2, radius: f64, from_angle: f64, to_angle: f64) -> Result<Curve, Fault> {
        Curve::new(&CurveShape::Arc { centre, radius, from_angle, to_angle })
    }

    #[test]
    fn a_segment_is_exact_at_its_ends() {
        let (from, to) = (DVec2::new(0.1, 1e9), DVec2::new(0.3, -0.7));
        let curve = Curve::new(&CurveShape::Segment { from, to }).unwrap();
        assert_eq!((curve.point(0.0), curve.point(1.0)), (from, to));
        assert!(!curve.closed() && curve.straight() && curve.corners().is_empty());
    }

    #[test]
    fn a_full_arc_is_closed_and_a_part_is_not() {
        let circle = arc(DVec2::new(3.0, 4.0), 0.5, 1.0, 1.0 + TAU).unwrap();
        assert!(circle.closed());
        assert_eq!(circle.point(0.0), circle.point(1.0));
        let (low, high) = Course::of_curve(circle.clone()).bounds();
        assert!((low - DVec2::new(2.5, 3.5)).length() < 1e-5 && (high - DVec2::new(3.5, 4.5)).length() < 1e-5);
        assert!(!arc(DVec2::ZERO, 1.0, 0.0, PI).unwrap().closed());
    }

    #[test]
    fn chords_keep_to_the_tolerance_at_any_scale() {
        for scale in [1e-90, 1e-9, 1.0, 1e9, 1e90] {
            let nurbs = CurveShape::Nurbs {
                degree: 3,
                knots: vec![0.0, 0.0, 0.0, 0.0, 0.3, 1.0, 1.0, 1.0, 1.0],
                weights: vec![1.0, 2.0, 0.5, 1.0, 1.0],
                points: [(0.0, 0.0), (1.0, 2.0), (3.0, -1.0), (4.0, 0.5), (6.0, 6.0)]
                    .map(|(x, y)| scale * DVec2::new(x, y))
                    .to_vec(),
            };
            let arc = CurveShape::Arc { centre: DVec2::ZERO, radius: scale, from_angle: 0.0, to_angle: -5.0 };
            for shape in [nurbs, arc] {
                let curve = Curve::new(&shape).unwrap();
                let points = curve.polyline(1e-4 * scale);
                assert!(points.len() > 10 && points.len() < 2000, "{}", points.len());
                assert_eq!((points[0].0, points[points.len() - 1].0), (0.0, 1.0));
                for w in points.windows(2) {
                    assert!(w[0].0 < w[1].0);
                    for i in 1..8 {
                        let p = curve.point(w[0].0 + (w[1].0 - w[0].0) * f64::from(i) / 8.0);
                        assert!(distance_to_segment(p, w[0].1, w[1].1) < 1.3e-4 * scale);
                    }
                }
            }
        }
        assert!(arc(DVec2::ZERO, 1.0, 0.0, TAU).unwrap().polyline(0.0).len() < 70_000, "bounded without a tolerance");
    }

    #[test]
    fn corners_of_polylines_come_back_exactly() {
        let points: Vec<(f64, f64)> = (0..50).map(|i| (f64::from(i) * 0.1, f64::from(i % 2) * 0.3)).collect();
        let curve = polyline(&points, false).unwrap();
        assert_eq!(curve.corners().len(), 48);
        for (i, &t) in curve.corners().iter().enumerate() {
            assert_eq!(curve.point(t), DVec2::new(points[i + 1].0, points[i + 1].1));
        }
        let closed = polyline(&[(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)], true).unwrap();
        assert!(closed.closed());
        assert_eq!(closed.corners().len(), 2);
        assert_eq!(closed, polyline(&[(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.0, 0.0)], true).unwrap());
    }

    #[test]
    fn only_points_at_which_a_polyline_turns_enough_are_corners() {
        // It turns by 3, 7 and 90 degrees.
        let mut points = vec![DVec2::ZERO];
        for direction in [0.0_f64, 3.0, 10.0, 100.0] {
            points.push(points[points.len() - 1] + DVec2::from_angle(direction.to_radians()));
        }
        let corners = |degrees: f64| {
            let shape =
                CurveShape::Polyline { points: points.clone(), closed: false, corner_angle: degrees.to_radians() };
            let curve = Curve::new(&shape).unwrap();
            assert_eq!(curve.breaks(), &[0.0, 0.25, 0.5, 0.75, 1.0]);
            assert_eq!(curve.polyline(1.0).len(), 5);
            (curve.corners().to_vec(), curve.smooth_points())
        };
        assert_eq!(corners(0.0), (vec![0.25, 0.5, 0.75], 0));
        assert_eq!(corners(5.0), (vec![0.5, 0.75], 1));
        assert_eq!(corners(89.0), (vec![0.75], 2));
        assert_eq!(corners(91.0), (vec![], 3));
    }

    #[test]
    fn only_sharp_knots_of_a_nurbs_are_corners() {
        let curve = |y: f64| {
            let points =
                [(0.0, 0.0), (1.0, 1.0), (2.0, y), (3.0, 1.0), (4.0, 0.0)].map(|(x, y)| DVec2::new(x, y)).to_vec();
            let knots = vec![0.0, 0.0, 0.0, 2.0, 2.0, 4.0, 4.0, 4.0];
            Curve::new(&CurveShape::Nurbs { degree: 2, knots, weights: vec![], points }).unwrap()
        };
        assert_eq!(curve(1.0).corners(), &[] as &[f64]);
        assert_eq!(curve(0.0).corners(), &[0.5]);
        assert_eq!(curve(1.0).breaks(), &[0.0, 0.5, 1.0]);
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let curves = [
            arc(DVec2::new(1.0, 2.0), 3.0, 0.5, -4.0).unwrap(),
            polyline(&[(0.0, 0.0), (1.0, 3.0), (2.0, 1.0)], true).unwrap(),
        ];
        for curve in &curves {
            for t in [0.1, 0.4, 0.9] {
                let slope = (curve.point(t + 1e-6) - curve.point(t - 1e-6)) / 2e-6;
                assert!((slope - curve.at(t).1).length() < 1e-6);
            }
        }
    }

    #[test]
    fn bad_curves_are_refused() {
        let says = |curve: Result<Curve, Fault>| curve.unwrap_err().to_string();
        let p = DVec2::new(1.0, 2.0);
        assert!(says(Curve::new(&CurveShape::Segment { from: p, to: p })).contains("zero length"));
        assert!(says(Curve::new(&CurveShape::Segment { from: p, to: DVec2::NAN })).contains("not finite"));
        assert!(says(Curve::new(&CurveShape::Segment { from: p, to: DVec2::new(1e200, 0.0) })).contains("1e100"));
        assert!(says(arc(p, 0.0, 0.0, 1.0)).contains("radius is 0"));
        assert!(says(arc(p, -1.0, 0.0, 1.0)).contains("radius is -1"));
        assert!(says(arc(p, 1.0, 1.0, 1.0)).contains("zero length"));
        assert!(says(arc(p, 1.0, 0.0, 7.0)).contains("more than a full turn"));
        assert!(says(arc(p, 1.0, f64::NAN, 7.0)).contains("angles"));
        assert!(says(polyline(&[(0.0, 0.0), (1.0, 0.0), (1.0, 0.0)], false)).contains("points 2 and 3"));
        assert!(says(polyline(&[(0.0, 0.0)], false)).contains("has 1"));
        assert!(says(polyline(&[(0.0, 0.0), (1.0, 0.0)], true)).contains("has 2"));
        assert!(says(polyline(&[], true)).contains("has 0"));
    }
}
