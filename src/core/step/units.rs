//! Units of a file: of lengths and angles, by the context of a representation (ISO 10303-41, "measure").

use super::exchange::Exchange;
use super::fields::Entity;
use crate::core::fault::Fault;

/// The deepest chain of units of units.
const DEEPEST: usize = 6;

/// The units of a context, and how exact its geometry is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Units {
    /// Metres of a unit of length.
    pub metres: f64,
    /// Radians of a unit of plane angle.
    pub radians: f64,
    /// The uncertainty of lengths that it tells, in metres.
    pub uncertainty: Option<f64>,
}

impl Units {
    /// Where nothing is said: millimetres and radians.
    pub const DEFAULT: Units = Units { metres: 1e-3, radians: 1.0, uncertainty: None };
}

/// The units of a context of representation.
///
/// # Errors
/// Units that cannot be read.
pub(super) fn units(file: &Exchange<'_>, context: u64) -> Result<Units, Fault> {
    let entity = file.entity(context)?;
    let mut units = Units::DEFAULT;
    if let Some(assigned) = entity.record("GLOBAL_UNIT_ASSIGNED_CONTEXT") {
        for id in assigned.instances(0)? {
            let unit = file.entity(id)?;
            if unit.is("LENGTH_UNIT") {
                units.metres = factor(&unit, DEEPEST)?;
            } else if unit.is("PLANE_ANGLE_UNIT") {
                units.radians = factor(&unit, DEEPEST)?;
            }
        }
    }
    if let Some(assigned) = entity.record("GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT") {
        for id in assigned.instances(0)? {
            let measure = file.entity(id)?;
            let Some(fields) = measure.record("UNCERTAINTY_MEASURE_WITH_UNIT") else { continue };
            let unit = file.entity(fields.instance(1)?)?;
            if unit.is("LENGTH_UNIT") {
                units.uncertainty = Some(fields.number(0)? * factor(&unit, DEEPEST)?);
            }
        }
    }
    Ok(units)
}

/// A unit in the unit of the SI: metres, or radians.
fn factor(unit: &Entity<'_, '_>, depth: usize) -> Result<f64, Fault> {
    let refused = || unit.fault(format!("#{} is a unit of an unknown kind", unit.id())).remedy(super::DAMAGED);
    let found = if let Some(si) = unit.record("SI_UNIT") {
        // A simple instance begins with its dimensions.
        let own = si.from(si.len().saturating_sub(2));
        match own.word(0) {
            None => 1.0,
            Some("EXA") => 1e18,
            Some("PETA") => 1e15,
            Some("TERA") => 1e12,
            Some("GIGA") => 1e9,
            Some("MEGA") => 1e6,
            Some("KILO") => 1e3,
            Some("HECTO") => 1e2,
            Some("DECA") => 1e1,
            Some("DECI") => 1e-1,
            Some("CENTI") => 1e-2,
            Some("MILLI") => 1e-3,
            Some("MICRO") => 1e-6,
            Some("NANO") => 1e-9,
            Some("PICO") => 1e-12,
            Some("FEMTO") => 1e-15,
            Some("ATTO") => 1e-18,
            Some(_) => return Err(refused()),
        }
    } else if let Some(based) = unit.record("CONVERSION_BASED_UNIT") {
        let own = based.from(based.len().saturating_sub(2));
        let measure = unit.file.entity(own.instance(1)?)?;
        let fields = measure.record("MEASURE_WITH_UNIT").unwrap_or_else(|| measure.first());
        let base = unit.file.entity(fields.instance(1)?)?;
        fields.number(0)? * factor(&base, depth.checked_sub(1).ok_or_else(refused)?)?
    } else {
        return Err(refused());
    };
    if found.is_finite() && found > 0.0 { Ok(found) } else { Err(refused()) }
}
