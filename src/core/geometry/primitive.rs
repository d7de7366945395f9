//! Exact NURBS of the usual surfaces and curves: planes, surfaces of revolution (A8.1 of "The NURBS Book": cylinder,
//! cone, sphere, torus), extrusions.
//!
//! The parameter of a revolution is the angle in degrees: exact at the ends of its equal arcs of at most 90 degrees,
//! and within 1.1 degrees between them.

use glam::DVec3;

use super::frame::{AxisFrame, sin_cos};
use super::nurbs::NurbsCurve;
use super::surface::NurbsSurface;
use crate::core::fault::Fault;

/// The control points of an arc of several pieces: the ends of the pieces at even indices, the poles between them.
struct Arcs {
    angles: Vec<f64>,
    /// Weight of the poles; their distance from the centre is the radius divided by it.
    weight: f64,
    knots: Vec<f64>,
}

impl Arcs {
    fn new([from, to]: [f64; 2]) -> Result<Arcs, Fault> {
        let turn = to - from;
        if !(turn.is_finite() && turn > 0.0 && turn <= 360.0) {
            return Err(Fault::new(format!("The angles {from} and {to} do not span between 0 and 360 degrees"))
                .remedy("Make to_angle greater than from_angle, by at most 360"));
        }
        let count = (turn / 90.0 - 1e-9).ceil().max(1.0) as usize;
        let joint = |i: usize| if i == count { to } else { from + turn * i as f64 / count as f64 };
        let mut angles = vec![from];
        let mut knots = vec![from; 3];
        for i in 1..=count {
            angles.extend([0.5 * (joint(i - 1) + joint(i)), joint(i)]);
            knots.extend([joint(i); 2]);
        }
        knots.push(to);
        Ok(Arcs { angles, weight: libm::cos((0.5 * turn / count as f64).to_radians()), knots })
    }

    fn weight_at(&self, i: usize) -> f64 {
        if i.is_multiple_of(2) { 1.0 } else { self.weight }
    }

    fn weights(&self) -> Vec<f64> {
        (0..self.angles.len()).map(|i| self.weight_at(i)).collect()
    }

    /// The arc of a radius in the half plane of a frame at angle 0, about a point at a distance from the axis.
    fn profile(self, frame: &AxisFrame, distance: f64, radius: f64) -> Result<NurbsCurve<DVec3>, Fault> {
        let weights = self.weights();
        let mut points: Vec<[f64; 2]> = Vec::new();
        for (&angle, w) in self.angles.iter().zip(&weights) {
            let (sin, cos) = sin_cos(angle);
            points.push([distance + cos * radius / w, sin * radius / w]);
        }
        let last = points.len() - 1;
        if self.angles[last] - self.angles[0] == 360.0 {
            points[last] = points[0];
        }
        profile(frame, 2, self.knots, &weights, &points)
    }
}

/// A circular arc as a rational quadratic; its parameter is about the angle in degrees.
///
/// # Errors
/// A radius that is not positive, angles that do not span between 0 and 360 degrees.
pub fn arc(frame: &AxisFrame, radius: f64, angles: [f64; 2]) -> Result<NurbsCurve<DVec3>, Fault> {
    positive("radius", radius)?;
    let arcs = Arcs::new(angles)?;
    let weights = arcs.weights();
    let mut points: Vec<DVec3> = arcs
        .angles
        .iter()
        .zip(&weights)
        .map(|(&angle, w)| frame.centre + frame.towards(angle) * (radius / w))
        .collect();
    close_full(&mut points, angles, 1);
    NurbsCurve::new(2, arcs.knots, &weights, &points)
}

/// Makes the last points of a full turn equal to the first ones, to the last bit.
fn close_full(points: &mut [DVec3], [from, to]: [f64; 2], columns: usize) {
    if to - from == 360.0 {
        let last = points.len() - columns;
        points.copy_within(..columns, last);
    }
}

fn positive(name: &str, value: f64) -> Result<(), Fault> {
    if value.is_finite() && value > 0.0 && value < 1e100 {
        Ok(())
    } else {
        Err(Fault::new(format!("{name} = {value} is not positive")).remedy("Give a positive finite number"))
    }
}

/// The surface of revolution of a profile (A8.1): u is the angle in degrees, v the profile's parameter.
///
/// # Errors
/// Angles that do not span between 0 and 360 degrees, and what [`NurbsSurface::new`] refuses.
pub fn revolution(profile: &NurbsCurve<DVec3>, frame: &AxisFrame, angles: [f64; 2]) -> Result<NurbsSurface, Fault> {
    let arcs = Arcs::new(angles)?;
    let columns = profile.weighted_points().len();
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for (i, &angle) in arcs.angles.iter().enumerate() {
        let w = arcs.weight_at(i);
        let towards = frame.towards(angle);
        let across = frame.axis.cross(towards);
        for &(p, weight) in profile.weighted_points() {
            // In the frame of the profile: along the axis, and across it in two directions.
            let p = p / weight - frame.centre;
            let (height, x, y) = (p.dot(frame.axis), p.dot(frame.start), p.dot(frame.axis.cross(frame.start)));
            points.push(frame.centre + frame.axis * height + (towards * x + across * y) / w);
            weights.push(w * weight);
        }
    }
    close_full(&mut points, angles, columns);
    let knots = [arcs.knots, profile.basis().knots().to_vec()];
    NurbsSurface::new([2, profile.basis().degree()], knots, &weights, &points, columns)
}

/// A profile in the half plane of a frame at angle 0; its points are (distance from the axis, height along it).
fn profile(
    frame: &AxisFrame,
    degree: usize,
    knots: Vec<f64>,
    weights: &[f64],
    points: &[[f64; 2]],
) -> Result<NurbsCurve<DVec3>, Fault> {
    let points: Vec<DVec3> = points.iter().map(|[x, z]| frame.centre + frame.start * *x + frame.axis * *z).collect();
    NurbsCurve::new(degree, knots, weights, &points)
}

/// A cone about an axis, with the radii at its foot and at its top (0: the apex); equal radii make a cylinder. v is the
/// distance from the foot along a generator.
///
/// # Errors
/// Radii that are negative or both 0, a height that is not positive, angles that do not span between 0 and 360 degrees.
pub fn cone(frame: &AxisFrame, radii: [f64; 2], height: f64, angles: [f64; 2]) -> Result<NurbsSurface, Fault> {
    positive("height", height)?;
    if let Some(r) = radii.iter().find(|r| !(r.is_finite() && **r >= 0.0)) {
        return Err(Fault::new(format!("The radius {r} is negative or not finite")));
    }
    positive("radius", radii[0].max(radii[1]))?;
    let length = libm::hypot(height, radii[1] - radii[0]);
    let line = profile(frame, 1, vec![0.0, 0.0, length, length], &[], &[[radii[0], 0.0], [radii[1], height]])?;
    revolution(&line, frame, angles)
}

/// A sphere: u is the longitude, v the latitude, both in degrees.
///
/// # Errors
/// A radius that is not positive, angles that do not span between 0 and 360 degrees, latitudes beyond -90 and 90.
pub fn sphere(frame: &AxisFrame, radius: f64, angles: [f64; 2], latitudes: [f64; 2]) -> Result<NurbsSurface, Fault> {
    positive("radius", radius)?;
    if !(-90.0..=90.0).contains(&latitudes[0]) || !(-90.0..=90.0).contains(&latitudes[1]) {
        return Err(Fault::new(format!("The latitudes {} and {} are beyond the poles", latitudes[0], latitudes[1]))
            .remedy("Give latitudes between -90 and 90"));
    }
    revolution(&Arcs::new(latitudes)?.profile(frame, 0.0, radius)?, frame, angles)
}

/// A torus: u is the angle about the axis, v that about the tube from the outermost circle upwards, both in degrees.
///
/// # Errors
/// Radii that are not positive, a tube radius not less than the ring radius, angles that do not span between 0 and 360
/// degrees.
pub fn torus(
    frame: &AxisFrame,
    radius: f64,
    tube: f64,
    angles: [f64; 2],
    tube_angles: [f64; 2],
) -> Result<NurbsSurface, Fault> {
    positive("radius", radius)?;
    positive("tube", tube)?;
    if tube >= radius {
        return Err(Fault::new(format!(
            "The radius of the tube, {tube}, is not less than {radius}: the torus intersects itself"
        ))
        .remedy("Give a thinner tube, or a larger radius"));
    }
    revolution(&Arcs::new(tube_angles)?.profile(frame, radius, tube)?, frame, angles)
}

/// A parallelogram in a plane, given by a corner and two sides. u and v are lengths along the sides.
///
/// # Errors
/// Sides that are zero or parallel.
pub fn plane(corner: DVec3, sides: [DVec3; 2]) -> Result<NurbsSurface, Fault> {
    let lengths = sides.map(DVec3::length);
    let spanned = sides[0].cross(sides[1]).length();
    if spanned <= 1e-9 * lengths[0] * lengths[1] || spanned.is_nan() {
        return Err(Fault::new("The sides u and v of the plane are zero or parallel")
            .remedy("Give two sides that span the plane, with their lengths"));
    }
    let knots = lengths.map(|l| vec![0.0, 0.0, l, l]);
    let points = [corner, corner + sides[1], corner + sides[0], corner + sides[0] + sides[1]];
    NurbsSurface::new([1, 1], knots, &[], &points, 2)
}

/// The surface that a curve sweeps along a straight line: u is the curve's parameter, v the length along the line.
///
/// # Errors
/// A direction of zero length, and what [`NurbsSurface::new`] refuses.
pub fn extrusion(curve: &NurbsCurve<DVec3>, along: DVec3) -> Result<NurbsSurface, Fault> {
    positive("the length of direction", along.length())?;
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for &(p, w) in curve.weighted_points() {
        points.extend([p / w, p / w + along]);
        weights.extend([w, w]);
    }
    let length = along.length();
    let knots = [curve.basis().knots().to_vec(), vec![0.0, 0.0, length, length]];
    NurbsSurface::new([curve.basis().degree(), 1], knots, &weights, &points, 2)
}
