//! `[[point]]` of a case file.

use super::geometry::name;
use super::metric::growth;
use super::table::Table;
use crate::core::fault::Fault;
use crate::core::geometry::PointSpec;

/// The growth of sizes away from a hard point, where none is given.
const GROWTH: f64 = 1.2;

/// Reads the hard points; `geometry` checks that they lie in the domain.
pub(super) fn points(document: &Table<'_>) -> Result<Vec<PointSpec>, Fault> {
    let mut points = Vec::new();
    for table in document.tables("point")? {
        table.only(&["name", "at", "size", "growth"])?;
        let size = table.get("size").map(|v| v.positive()).transpose()?;
        if let (None, Some(value)) = (size, table.get("growth")) {
            return Err(value.fault("growth is given without size").remedy("Write size too, or leave growth out"));
        }
        let growth = match table.get("growth") {
            None => GROWTH,
            Some(_) => growth(&table)?,
        };
        let at = table.need("at", "[0.5, 0.5]")?.point()?;
        points.push(PointSpec { name: name(&table)?, at, size, growth, place: table.place() });
    }
    Ok(points)
}
