//! The frame of what turns about an axis, and angles in degrees that are exact at quarter turns.

use glam::DVec3;

use crate::core::fault::Fault;

/// The directions of something that turns: angles are measured from `start` towards `axis x start`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// A point on the axis.
    pub centre: DVec3,
    /// Unit vector along the axis.
    pub axis: DVec3,
    /// Unit vector across it, where the angle is 0.
    pub start: DVec3,
}

impl Frame {
    /// A frame about an axis; without `start` the angle 0 is towards x, or y where the axis is x.
    ///
    /// # Errors
    /// Directions that are zero, not finite, or parallel.
    pub fn new(centre: DVec3, axis: DVec3, start: Option<DVec3>) -> Result<Frame, Fault> {
        let told = |p: DVec3| format!("({}, {}, {})", p.x, p.y, p.z);
        let axis_unit = axis.normalize_or_zero();
        if axis_unit == DVec3::ZERO || !centre.is_finite() {
            return Err(Fault::new(format!("The axis {} is no direction", told(axis))));
        }
        let given = start.unwrap_or(if axis_unit.cross(DVec3::X).length() > 1e-6 { DVec3::X } else { DVec3::Y });
        let across = given.normalize_or_zero();
        let across = across - axis_unit * across.dot(axis_unit);
        if across.length() < 1e-6 {
            return Err(Fault::new(format!("start = {} is no direction across the axis", told(given)))
                .remedy("Give a direction that is not along the axis"));
        }
        Ok(Frame { centre, axis: axis_unit, start: across.normalize() })
    }

    /// The unit vector at an angle in degrees, exact at multiples of 90.
    pub fn towards(&self, degrees: f64) -> DVec3 {
        let (sin, cos) = sin_cos(degrees);
        self.start * cos + self.axis.cross(self.start) * sin
    }
}

/// Sine and cosine of an angle in degrees, exact at multiples of 90.
pub fn sin_cos(degrees: f64) -> (f64, f64) {
    let turns = (degrees / 360.0).floor();
    let within = degrees - 360.0 * turns;
    match within {
        0.0 | 360.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        _ => libm::sincos(within.to_radians()),
    }
}
