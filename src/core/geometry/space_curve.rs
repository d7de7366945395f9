//! Curves in space, all with a parameter in [0, 1]: segment, circular arc, polyline, NURBS, and plane curves in the
//! parametric plane of a surface.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::curve::{Curve, piece};
use super::frame::{Frame, sin_cos};
use super::nurbs::NurbsCurve;
use super::primitive::arc;
use super::spec::SpaceShape;
use super::surface::NurbsSurface;
use crate::core::fault::Fault;
use crate::core::kernel::decimal::number;

/// Coordinates beyond this are refused, so that no square of one overflows.
const LARGEST: f64 = 1e100;

/// A curve that has been checked.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceCurve {
    path: Path,
    closed: bool,
}

#[derive(Clone, Debug, PartialEq)]
enum Path {
    Segment {
        from: DVec3,
        to: DVec3,
    },
    Arc {
        frame: Frame,
        radius: f64,
        angles: [f64; 2],
    },
    Polyline {
        points: Vec<DVec3>,
    },
    /// Sides of triangles, with the places of the corners among them.
    Sides {
        points: Vec<DVec3>,
        corners: Vec<u32>,
    },
    Nurbs(Box<NurbsCurve<DVec3>>),
    On {
        surface: Arc<NurbsSurface>,
        trim: Box<Curve>,
    },
}

impl SpaceCurve {
    /// The curve of a shape; `surface` gives the surface of a name.
    ///
    /// # Errors
    /// Numbers that are not finite, no length, an arc of no or more than a full turn, what [`NurbsCurve::new`] and
    /// [`Curve::new`] refuse, a surface that is not there.
    pub fn new(shape: &SpaceShape, surface: &dyn Fn(&str) -> Option<Arc<NurbsSurface>>) -> Result<SpaceCurve, Fault> {
        let zero = || Fault::new("It has zero length");
        let path = match shape {
            SpaceShape::Segment { from, to } => {
                sound(&[*from, *to])?;
                if from == to {
                    return Err(zero());
                }
                Path::Segment { from: *from, to: *to }
            }
            SpaceShape::Arc { frame, radius, angles } => {
                let turn = (angles[1] - angles[0]).abs();
                if !(turn > 0.0 && turn <= 360.0 && *radius > 0.0 && *radius <= LARGEST) {
                    return Err(Fault::new(format!(
                        "An arc of radius {radius} from {} to {} degrees is no arc",
                        angles[0], angles[1]
                    ))
                    .remedy("Give a positive radius, and angles that differ by up to 360 degrees"));
                }
                sound(&[frame.centre])?;
                Path::Arc { frame: *frame, radius: *radius, angles: *angles }
            }
            SpaceShape::Polyline { points, closed } => {
                sound(points)?;
                let mut points = points.clone();
                if *closed && points.len() > 1 && points.first() != points.last() {
                    points.extend(points.first().copied());
                }
                if points.len() < if *closed { 4 } else { 2 } {
                    return Err(Fault::new("A polyline of so few points is no curve"));
                }
                if let Some(i) = (1..points.len()).find(|&i| points[i] == points[i - 1]) {
                    return Err(Fault::new(format!("Its points {i} and {} are the same", i + 1))
                        .remedy("Leave one of them out"));
                }
                Path::Polyline { points }
            }
            SpaceShape::Nurbs { degree, knots, weights, points } => {
                sound(points)?;
                if points.windows(2).all(|w| w[0] == w[1]) {
                    return Err(zero());
                }
                Path::Nurbs(Box::new(NurbsCurve::new(*degree, knots.clone(), weights, points)?))
            }
            SpaceShape::On { surface: name, shape } => {
                let surface = surface(name).ok_or_else(|| {
                    Fault::new(format!("It lies on a surface \"{name}\", which is not there"))
                        .remedy("Add it as [[surface]]")
                })?;
                Path::On { surface, trim: Box::new(Curve::new(shape)?) }
            }
        };
        let mut curve = SpaceCurve { path, closed: false };
        let (first, last) = (curve.point(0.0), curve.point(1.0));
        let size = curve.polyline().iter().map(|p| p.distance(first)).fold(0.0, f64::max);
        if size == 0.0 {
            return Err(zero());
        }
        curve.closed = first.distance(last) <= 1e-12 * size;
        Ok(curve)
    }

    /// The curve in the parametric plane of a surface, as an edge of it.
    pub fn on(surface: Arc<NurbsSurface>, trim: Curve) -> SpaceCurve {
        let mut curve = SpaceCurve { path: Path::On { surface, trim: Box::new(trim) }, closed: false };
        let first = curve.point(0.0);
        let size = curve.polyline().iter().map(|p| p.distance(first)).fold(0.0, f64::max);
        curve.closed = first.distance(curve.point(1.0)) <= 1e-12 * size;
        curve
    }

    /// A chain of sides of triangles, of which the points of the given places are kept as nodes, besides the first and last.
    pub fn of_sides(points: Vec<DVec3>, corners: Vec<u32>) -> SpaceCurve {
        let closed = points.first() == points.last();
        SpaceCurve { path: Path::Sides { points, corners }, closed }
    }

    /// The surface in whose parametric plane it is given, and its course there.
    pub fn trim(&self) -> Option<(&Arc<NurbsSurface>, &Curve)> {
        match &self.path {
            Path::On { surface, trim } => Some((surface, trim)),
            _ => None,
        }
    }

    /// Point and derivative by `t`.
    pub fn at(&self, t: f64) -> (DVec3, DVec3) {
        match &self.path {
            Path::Segment { from, to } => (lerp(*from, *to, t), *to - *from),
            Path::Arc { frame, radius, angles: [from, to] } => {
                // The end of a full turn is its start, to the last bit.
                let angle = if self.closed && t == 1.0 { *from } else { from + t * (to - from) };
                let (sin, cos) = sin_cos(angle);
                let across = frame.axis.cross(frame.start);
                let derivative = (across * cos - frame.start * sin) * (radius * (to - from).to_radians());
                (frame.centre + (frame.start * cos + across * sin) * *radius, derivative)
            }
            Path::Polyline { points } | Path::Sides { points, .. } => {
                let n = points.len() - 1;
                let (i, s) = piece(n, t);
                (lerp(points[i], points[i + 1], s), (points[i + 1] - points[i]) * n as f64)
            }
            Path::Nurbs(nurbs) => {
                let (first, last) = nurbs.basis().domain();
                let at = if t >= 1.0 { last } else { (first + t * (last - first)).min(last) };
                let (p, d) = nurbs.at(at);
                (p, d * (last - first))
            }
            Path::On { surface, trim } => {
                let (uv, d_uv) = trim.at(t);
                let at = surface.at(uv, 1);
                (at.p, at.d[0] * d_uv.x + at.d[1] * d_uv.y)
            }
        }
    }

    /// The point at `t` in [0, 1].
    pub fn point(&self, t: f64) -> DVec3 {
        self.at(t).0
    }

    /// Whether it ends where it begins.
    pub fn closed(&self) -> bool {
        self.closed
    }

    /// Whether all its pieces are straight.
    pub fn straight(&self) -> bool {
        match &self.path {
            Path::Segment { .. } | Path::Polyline { .. } => true,
            Path::Nurbs(nurbs) => nurbs.basis().degree() == 1,
            Path::Arc { .. } | Path::On { .. } | Path::Sides { .. } => false,
        }
    }

    /// Whether it is one straight piece from end to end.
    pub fn is_chord(&self) -> bool {
        match &self.path {
            Path::Segment { .. } => true,
            Path::Polyline { points, .. } | Path::Sides { points, .. } => points.len() == 2,
            _ => false,
        }
    }

    /// Whether its ends are numbers that were given, and not computed.
    pub fn ends_given(&self) -> bool {
        matches!(self.path, Path::Segment { .. } | Path::Polyline { .. } | Path::Sides { .. })
    }

    /// Parameters strictly inside at which the direction jumps, ascending: they are kept as nodes.
    pub fn corners(&self) -> Vec<f64> {
        match &self.path {
            Path::Segment { .. } | Path::Arc { .. } => Vec::new(),
            Path::Polyline { points } => {
                let n = points.len() - 1;
                (1..n).map(|i| i as f64 / n as f64).collect()
            }
            Path::Sides { points, corners } => {
                corners.iter().map(|&i| f64::from(i) / (points.len() - 1) as f64).collect()
            }
            Path::Nurbs(nurbs) => {
                let (first, last) = nurbs.basis().domain();
                let sharp = |&&(knot, times): &&(f64, usize)| {
                    if times < nurbs.basis().degree() {
                        return false;
                    }
                    let before = nurbs.at_in(nurbs.basis().span(knot.next_down()), knot).1;
                    let after = nurbs.at(knot).1;
                    before.cross(after).length() > 1e-6 * before.length() * after.length() || before.dot(after) < 0.0
                };
                let knots = nurbs.basis().inner_knots();
                knots.iter().filter(sharp).map(|(k, _)| (k - first) / (last - first)).collect()
            }
            Path::On { trim, .. } => trim.corners().to_vec(),
        }
    }

    /// Parameters between which it is smooth, from 0 to 1.
    pub fn breaks(&self) -> Vec<f64> {
        let mut breaks = vec![0.0];
        match &self.path {
            Path::Segment { .. } | Path::Arc { .. } => {}
            Path::Polyline { .. } => breaks.extend(self.corners()),
            Path::Sides { points, .. } => {
                let n = points.len() - 1;
                breaks.extend((1..n).map(|i| i as f64 / n as f64));
            }
            Path::Nurbs(nurbs) => {
                let (first, last) = nurbs.basis().domain();
                breaks.extend(nurbs.basis().inner_knots().iter().map(|(k, _)| (k - first) / (last - first)));
            }
            Path::On { trim, .. } => return trim.breaks(),
        }
        breaks.retain(|&t| t < 1.0);
        breaks.dedup();
        breaks.push(1.0);
        breaks
    }

    /// Points along it, from end to end, so dense that its course is seen: for distances and sizes.
    pub fn polyline(&self) -> Vec<DVec3> {
        let parts = if self.straight() || matches!(self.path, Path::Sides { .. }) { 1 } else { 64 };
        let mut points = vec![self.point(0.0)];
        for w in self.breaks().windows(2) {
            points.extend((1..=parts).map(|i| self.point(w[0] + (w[1] - w[0]) * f64::from(i) / f64::from(parts))));
        }
        points
    }

    /// The curve as a NURBS; `None` where it lies on a surface.
    pub fn nurbs(&self) -> Option<NurbsCurve<DVec3>> {
        let line = |points: &[DVec3]| {
            let n = points.len();
            let mut knots = vec![0.0];
            knots.extend((0..n).map(|i| i as f64 / (n - 1) as f64));
            knots.push(1.0);
            NurbsCurve::new(1, knots, &[], points).ok()
        };
        match &self.path {
            Path::Segment { from, to } => line(&[*from, *to]),
            Path::Polyline { points } | Path::Sides { points, .. } => line(points),
            Path::Arc { frame, radius, angles: [from, to] } if from < to => arc(frame, *radius, [*from, *to]).ok(),
            Path::Arc { frame, radius, angles: [from, to] } => {
                // Clockwise: anticlockwise about the axis turned over, from the same direction.
                let turned = Frame { axis: -frame.axis, start: frame.towards(*from), ..*frame };
                arc(&turned, *radius, [0.0, from - to]).ok()
            }
            Path::Nurbs(nurbs) => Some((**nurbs).clone()),
            Path::On { .. } => None,
        }
    }
}

fn lerp(a: DVec3, b: DVec3, t: f64) -> DVec3 {
    if t <= 0.5 { a + (b - a) * t } else { b - (b - a) * (1.0 - t) }
}

fn sound(points: &[DVec3]) -> Result<(), Fault> {
    match points.iter().find(|p| !(p.is_finite() && p.abs().max_element() <= LARGEST)) {
        Some(p) => Err(Fault::new(format!("Its point ({}, {}, {}) is not finite or beyond 1e100", p.x, p.y, p.z))),
        None => Ok(()),
    }
}

/// A point of the parametric plane as messages show it.
pub fn told_uv(uv: DVec2) -> String {
    format!("u = {}, v = {}", number(uv.x), number(uv.y))
}

/// A point of space as messages show it.
pub fn told_xyz(p: DVec3) -> String {
    let [x, y, z] = [p.x, p.y, p.z].map(number);
    format!("({x}, {y}, {z})")
}
