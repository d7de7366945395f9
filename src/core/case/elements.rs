//! `[background]` of a case file: a small mesh, point by point.

use super::DomainSource;
use super::table::{Table, Value};
use crate::core::fault::Fault;

/// Reads points, triangles and quadrilaterals; the conversion checks that they form a mesh.
pub(super) fn elements(table: &Table<'_>) -> Result<DomainSource, Fault> {
    table.only(&["points", "triangles", "quads"])?;
    let points = table.need("points", "[[0, 0], [1, 0], [0, 1]]")?.points()?;
    let count = points.len() as u32;
    let triangles = table.need("triangles", "[[0, 1, 2]]")?.list()?;
    let triangles = triangles.iter().map(|t| corners(t, count, "[0, 1, 2]")).collect::<Result<_, _>>()?;
    let quads = table.get("quads").map_or(Ok(Vec::new()), |value| value.list())?;
    let quads = quads.iter().map(|q| corners(q, count, "[0, 1, 2, 3]")).collect::<Result<_, _>>()?;
    Ok(DomainSource::Elements { points, triangles, quads })
}

/// The corners of an element, by point index.
fn corners<const N: usize>(value: &Value<'_>, points: u32, example: &str) -> Result<[u32; N], Fault> {
    let wrong = || value.wrong(&format!("a list of {N} points by number"), &format!("{} = {example}", value.key()));
    let list = value.list().map_err(|_| wrong())?;
    let numbers: Vec<u32> = list.iter().map(|v| v.count(0, points.saturating_sub(1))).collect::<Result<_, _>>()?;
    numbers.try_into().map_err(|_| wrong())
}
