//! Frames about an axis of rotation, and angles in degrees that are exact at quarter turns.

use glam::DVec3;

use crate::core::fault::Fault;
use crate::core::kernel::decimal::point_text;

/// A frame about an axis of rotation: angles are measured from `start` towards `axis x start`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisFrame {
    /// A point on the axis.
    pub centre: DVec3,
    /// Unit vector along the axis.
    pub axis: DVec3,
    /// Unit vector perpendicular to the axis, at the angle 0.
    pub start: DVec3,
}

impl AxisFrame {
    /// A frame about an axis; without `start` the angle 0 is towards x, or towards y if the axis is x.
    ///
    /// # Errors
    /// Directions that are zero, not finite, or parallel.
    pub fn new(centre: DVec3, axis: DVec3, start: Option<DVec3>) -> Result<AxisFrame, Fault> {
        let axis_unit = axis.normalize_or_zero();
        if axis_unit == DVec3::ZERO || !centre.is_finite() {
            return Err(Fault::new(format!("The axis {} is not a direction", point_text(axis))));
        }
        let given = start.unwrap_or(if axis_unit.cross(DVec3::X).length() > 1e-6 { DVec3::X } else { DVec3::Y });
        let across = given.normalize_or_zero();
        let across = across - axis_unit * across.dot(axis_unit);
        if across.length() < 1e-6 {
            return Err(Fault::new(format!("start = {} is parallel to the axis, or zero", point_text(given)))
                .remedy("Give a direction that is not along the axis"));
        }
        Ok(AxisFrame { centre, axis: axis_unit, start: across.normalize() })
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
