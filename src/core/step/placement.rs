//! Points, directions and frames of a file, in the unit and at the place in which they are wanted.

use glam::{DMat3, DVec3};

use super::exchange::Exchange;
use super::fields::Entity;
use crate::core::fault::Fault;
use crate::core::geometry::AxisFrame;

/// A similarity of space: scaled, rotated, moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placement {
    pub scale: f64,
    pub rotation: DMat3,
    pub origin: DVec3,
}

impl Placement {
    /// A change of unit.
    pub fn scaled(scale: f64) -> Placement {
        Placement { scale, rotation: DMat3::IDENTITY, origin: DVec3::ZERO }
    }

    /// That of a frame in its own unit.
    pub fn of_frame(frame: &AxisFrame) -> Placement {
        let rotation = DMat3::from_cols(frame.start, frame.axis.cross(frame.start), frame.axis);
        Placement { scale: 1.0, rotation, origin: frame.centre }
    }

    /// The image of a point.
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.rotation * (p * self.scale) + self.origin
    }

    /// The image of a direction.
    pub fn direction(&self, d: DVec3) -> DVec3 {
        self.rotation * d
    }

    /// This one after another one.
    pub fn after(&self, first: &Placement) -> Placement {
        Placement {
            scale: self.scale * first.scale,
            rotation: self.rotation * first.rotation,
            origin: self.point(first.origin),
        }
    }

    /// What takes it back.
    pub fn inverse(&self) -> Placement {
        let rotation = self.rotation.transpose();
        Placement { scale: 1.0 / self.scale, rotation, origin: -(rotation * self.origin) / self.scale }
    }
}

/// Reads geometry of a file, placed, with angles in radians.
#[derive(Clone, Copy)]
pub(super) struct Placed<'m, 'a> {
    pub file: &'m Exchange<'a>,
    pub placement: Placement,
    /// Radians of a unit of plane angle.
    pub radians: f64,
}

impl Placed<'_, '_> {
    /// A length in the unit that is wanted.
    pub fn length(&self, given: f64) -> f64 {
        given * self.placement.scale
    }

    /// A CARTESIAN_POINT.
    ///
    /// # Errors
    /// Another instance, or coordinates that are no numbers.
    pub fn point(&self, id: u64) -> Result<DVec3, Fault> {
        Ok(self.placement.point(self.triple(id, "CARTESIAN_POINT")?))
    }

    /// A DIRECTION, of length 1.
    ///
    /// # Errors
    /// As for points, and a direction of length 0.
    pub fn direction(&self, id: u64) -> Result<DVec3, Fault> {
        let given = self.triple(id, "DIRECTION")?;
        let unit = given.normalize_or_zero();
        if unit == DVec3::ZERO {
            return Err(self.file.fault_at(id, format!("The direction #{id} has no length")).remedy(super::DAMAGED));
        }
        Ok(self.placement.direction(unit))
    }

    fn triple(&self, id: u64, keyword: &str) -> Result<DVec3, Fault> {
        let entity = self.file.entity(id)?;
        let numbers = entity.fields(keyword)?.numbers(1)?;
        match numbers[..] {
            [x, y, z] => Ok(DVec3::new(x, y, z)),
            [x, y] => Ok(DVec3::new(x, y, 0.0)),
            _ => Err(entity.fault(format!("#{id} has {} coordinates", numbers.len())).remedy(super::DAMAGED)),
        }
    }

    /// An AXIS2_PLACEMENT_3D: its z is the axis and its x the start. An AXIS1_PLACEMENT has any start.
    ///
    /// # Errors
    /// Another instance, and directions that make no frame.
    pub fn frame(&self, id: u64) -> Result<AxisFrame, Fault> {
        let entity = self.file.entity(id)?;
        let fields = entity.first();
        if !matches!(entity.keyword(), "AXIS2_PLACEMENT_3D" | "AXIS1_PLACEMENT") {
            return Err(entity.unexpected("an AXIS2_PLACEMENT_3D"));
        }
        let centre = self.point(fields.instance(1)?)?;
        let direction = |i: usize| {
            let given = fields.has(i).then(|| fields.instance(i));
            given.map(|id| self.direction(id?)).transpose()
        };
        let axis = direction(2)?.unwrap_or_else(|| self.placement.direction(DVec3::Z));
        let start = direction(3)?.filter(|start| start.cross(axis).length() > 1e-6);
        let any = [DVec3::X, DVec3::Y].map(|d| self.placement.direction(d));
        let start = start.unwrap_or(if any[0].cross(axis).length() > 1e-3 { any[0] } else { any[1] });
        AxisFrame::new(centre, axis, Some(start)).map_err(|fault| fault.at(format!("#{id}")))
    }

    /// A VECTOR: its direction times its length.
    ///
    /// # Errors
    /// Another instance.
    pub fn vector(&self, id: u64) -> Result<DVec3, Fault> {
        let entity = self.file.entity(id)?;
        let fields = entity.fields("VECTOR")?;
        Ok(self.direction(fields.instance(1)?)? * self.length(fields.number(2)?))
    }

    /// What is said about a kind of instance that cannot be read.
    pub fn unsupported(&self, entity: &Entity<'_, '_>, kind: &str) -> Fault {
        let what =
            format!("#{} is a {kind} of a kind that is not supported: {}", entity.id(), entity.instance.keyword());
        entity.fault(what)
    }
}
