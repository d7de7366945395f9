//! Curves in space, all with a parameter in [0, 1]: segment, circular arc, polyline, NURBS, and plane curves in the
//! parametric plane of a surface.

use std::sync::Arc;

use glam::DVec3;

use super::curve::{
    Curve, LARGEST, check_coordinates, inner_parameters, lerp, parameters_of, piece, points_of_polyline, sharp_points,
    with_ends,
};
use super::frame::{AxisFrame, sin_cos};
use super::nurbs::NurbsCurve;
use super::primitive::arc;
use super::spec::SpaceShape;
use super::surface::NurbsSurface;
use crate::core::fault::Fault;

/// A valid curve in space.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceCurve {
    path: Path,
    closed: bool,
}

/// `Sides` are edges of triangles. The `corners` of a polyline and of sides are indices of inner points.
#[derive(Clone, Debug, PartialEq)]
enum Path {
    Segment { from: DVec3, to: DVec3 },
    Arc { frame: AxisFrame, radius: f64, angles: [f64; 2] },
    Polyline { points: Vec<DVec3>, corners: Vec<u32> },
    Sides { points: Vec<DVec3>, corners: Vec<u32> },
    Nurbs(Box<NurbsCurve<DVec3>>),
    On { surface: Arc<NurbsSurface>, trim: Box<Curve> },
}

impl SpaceCurve {
    /// The curve of a shape; `surface` looks up a surface by name.
    ///
    /// # Errors
    /// Numbers that are not finite, zero length, an arc of no angle or of more than a full turn, what
    /// [`NurbsCurve::new`] and [`Curve::new`] refuse, an unknown surface.
    pub fn new(shape: &SpaceShape, surface: &dyn Fn(&str) -> Option<Arc<NurbsSurface>>) -> Result<SpaceCurve, Fault> {
        let zero = || Fault::new("It has zero length");
        let path = match shape {
            SpaceShape::Segment { from, to } => {
                check_coordinates(&[*from, *to])?;
                if from == to {
                    return Err(zero());
                }
                Path::Segment { from: *from, to: *to }
            }
            SpaceShape::Arc { frame, radius, angles } => {
                let turn = (angles[1] - angles[0]).abs();
                if !(turn > 0.0 && turn <= 360.0 && *radius > 0.0 && *radius <= LARGEST) {
                    return Err(Fault::new(format!(
                        "An arc of radius {radius} from {} to {} degrees is invalid",
                        angles[0], angles[1]
                    ))
                    .remedy("Give a positive radius, and angles that differ by at most 360 degrees"));
                }
                check_coordinates(&[frame.centre])?;
                Path::Arc { frame: *frame, radius: *radius, angles: *angles }
            }
            SpaceShape::Polyline { points, closed, corner_angle } => {
                let points = points_of_polyline(points, *closed)?;
                Path::Polyline { corners: sharp_points(&points, *corner_angle), points }
            }
            SpaceShape::Nurbs { degree, knots, weights, points } => {
                check_coordinates(points)?;
                if points.windows(2).all(|w| w[0] == w[1]) {
                    return Err(zero());
                }
                Path::Nurbs(Box::new(NurbsCurve::new(*degree, knots.clone(), weights, points)?))
            }
            SpaceShape::On { surface: name, shape } => {
                let surface = surface(name).ok_or_else(|| {
                    Fault::new(format!("It lies on a surface \"{name}\", which does not exist"))
                        .remedy("Add it as [[surface]]")
                })?;
                Path::On { surface, trim: Box::new(Curve::new(shape)?) }
            }
        };
        let (curve, size) = SpaceCurve::sized(path);
        if size == 0.0 { Err(zero()) } else { Ok(curve) }
    }

    /// The curve of a path, with the largest distance of a point of it from its start.
    fn sized(path: Path) -> (SpaceCurve, f64) {
        let mut curve = SpaceCurve { path, closed: false };
        let first = curve.point(0.0);
        let size = curve.polyline().iter().map(|p| p.distance(first)).fold(0.0, f64::max);
        curve.closed = first.distance(curve.point(1.0)) <= 1e-12 * size;
        (curve, size)
    }

    /// A curve on a surface, given in the parametric plane.
    pub fn on(surface: Arc<NurbsSurface>, trim: Curve) -> SpaceCurve {
        SpaceCurve::sized(Path::On { surface, trim: Box::new(trim) }).0
    }

    /// A chain of triangle edges; the points with indices in `corners`, the first and the last become nodes.
    pub fn of_sides(points: Vec<DVec3>, corners: Vec<u32>) -> SpaceCurve {
        let closed = points.first() == points.last();
        SpaceCurve { path: Path::Sides { points, corners }, closed }
    }

    /// The surface in whose parametric plane it is given, and the curve there.
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
                // The end of a full turn equals its start to the last bit.
                let angle = if self.closed && t == 1.0 { *from } else { from + t * (to - from) };
                let (sin, cos) = sin_cos(angle);
                let across = frame.axis.cross(frame.start);
                let derivative = (across * cos - frame.start * sin) * (radius * (to - from).to_radians());
                (frame.centre + (frame.start * cos + across * sin) * *radius, derivative)
            }
            Path::Polyline { points, .. } | Path::Sides { points, .. } => {
                let n = points.len() - 1;
                let (i, s) = piece(n, t);
                (lerp(points[i], points[i + 1], s), (points[i + 1] - points[i]) * n as f64)
            }
            Path::Nurbs(nurbs) => nurbs.at_unit(t),
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

    /// Whether its end is its start, up to 1e-12 of its size.
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

    /// The number of inner points of a polyline that are no corners.
    pub fn smooth_points(&self) -> usize {
        match &self.path {
            Path::Polyline { points, corners } => points.len() - 2 - corners.len(),
            Path::On { trim, .. } => trim.smooth_points(),
            _ => 0,
        }
    }

    /// Whether it is a single straight piece.
    pub fn is_chord(&self) -> bool {
        match &self.path {
            Path::Segment { .. } => true,
            Path::Polyline { points, .. } | Path::Sides { points, .. } => points.len() == 2,
            _ => false,
        }
    }

    /// Whether its ends are given coordinates, not computed ones.
    pub fn ends_given(&self) -> bool {
        matches!(self.path, Path::Segment { .. } | Path::Polyline { .. } | Path::Sides { .. })
    }

    /// Inner parameters at which the direction jumps, ascending: they become nodes.
    pub fn corners(&self) -> Vec<f64> {
        match &self.path {
            Path::Segment { .. } | Path::Arc { .. } => Vec::new(),
            Path::Polyline { points, corners } | Path::Sides { points, corners } => {
                parameters_of(corners, points.len())
            }
            Path::Nurbs(nurbs) => nurbs.sharp_knots(|before, after| {
                before.cross(after).length() > 1e-6 * before.length() * after.length() || before.dot(after) < 0.0
            }),
            Path::On { trim, .. } => trim.corners().to_vec(),
        }
    }

    /// Parameters between which it is smooth, from 0 to 1.
    pub fn breaks(&self) -> Vec<f64> {
        match &self.path {
            Path::Segment { .. } | Path::Arc { .. } => vec![0.0, 1.0],
            Path::Polyline { points, .. } | Path::Sides { points, .. } => {
                with_ends(inner_parameters(points).into_iter())
            }
            Path::Nurbs(nurbs) => with_ends(nurbs.basis().unit_knots()),
            Path::On { trim, .. } => trim.breaks(),
        }
    }

    /// Points along it, from end to end, dense enough for distances and sizes.
    pub fn polyline(&self) -> Vec<DVec3> {
        let parts = if self.straight() || matches!(self.path, Path::Sides { .. }) { 1 } else { 64 };
        let mut points = vec![self.point(0.0)];
        for w in self.breaks().windows(2) {
            points.extend((1..=parts).map(|i| self.point(w[0] + (w[1] - w[0]) * f64::from(i) / f64::from(parts))));
        }
        points
    }

    /// The curve as a NURBS; `None` if it is given on a surface.
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
            Path::Polyline { points, .. } | Path::Sides { points, .. } => line(points),
            Path::Arc { frame, radius, angles: [from, to] } if from < to => arc(frame, *radius, [*from, *to]).ok(),
            Path::Arc { frame, radius, angles: [from, to] } => {
                // Clockwise is anticlockwise about the reversed axis, from the same direction.
                let turned = AxisFrame { axis: -frame.axis, start: frame.towards(*from), ..*frame };
                arc(&turned, *radius, [0.0, from - to]).ok()
            }
            Path::Nurbs(nurbs) => Some((**nurbs).clone()),
            Path::On { .. } => None,
        }
    }
}
