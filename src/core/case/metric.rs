//! `[[metric]]` of a case file.

use super::geometry::{Names, known_curves};
use super::table::{Table, Value};
use crate::core::fault::Fault;
use crate::core::metric::FieldSpec;

/// Reads the metric fields; curves named by boundary layers must exist.
pub(super) fn fields(document: &Table<'_>, curves: &Names<'_>) -> Result<Vec<FieldSpec>, Fault> {
    document.tables("metric")?.iter().map(|table| field(table, curves)).collect()
}

fn field(table: &Table<'_>, curves: &Names<'_>) -> Result<FieldSpec, Fault> {
    let kind = table.need("kind", "\"formula\"")?;
    match kind.text()? {
        "uniform" => {
            table.only(&["kind", "h"])?;
            Ok(FieldSpec::Uniform { h: table.need("h", "0.1")?.positive()? })
        }
        "formula" => {
            table.only(&["kind", "let", "h1", "h2", "h3", "g1", "g2", "g3"])?;
            formula(table)
        }
        "boundary_layer" => {
            table.only(&["kind", "curves", "first", "growth", "along", "far"])?;
            let first_value = table.need("first", "0.001")?;
            let first = first_value.positive()?;
            let growth = growth(table)?;
            let far = table.get("far").map(|v| v.positive().map(|far| (v, far))).transpose()?;
            if let Some((value, far)) = &far
                && *far < first
            {
                return Err(value
                    .fault(format!("far = {far} is smaller than first = {first}"))
                    .remedy("Give far at least the value of first, or remove it"));
            }
            Ok(FieldSpec::BoundaryLayer {
                curves: known_curves(&table.need("curves", "[\"wall\"]")?, curves)?,
                first,
                growth,
                along: table.get("along").map(|v| v.positive()).transpose()?,
                far: far.map(|f| f.1),
                place: table.place(),
            })
        }
        "distance" => {
            table.only(&["kind", "curves", "first", "growth", "far"])?;
            Ok(FieldSpec::Distance {
                curves: known_curves(&table.need("curves", "[\"wall\"]")?, curves)?,
                first: table.need("first", "0.01")?.positive()?,
                growth: growth(table)?,
                far: table.need("far", "0.2")?.positive()?,
                place: table.place(),
            })
        }
        "curvature" => {
            table.only(&["kind", "chord", "least", "far"])?;
            Ok(FieldSpec::Curvature {
                chord: table.need("chord", "0.01")?.positive()?,
                least: table.need("least", "0.01")?.positive()?,
                far: table.need("far", "0.5")?.positive()?,
                place: table.place(),
            })
        }
        "gap" => {
            table.only(&["kind", "layers"])?;
            let layers = table.need("layers", "3")?.count(1, 100)?;
            Ok(FieldSpec::Gap { layers, place: table.place() })
        }
        _ => Err(kind.wrong(
            "a kind of metric",
            "\"formula\", \"uniform\", \"boundary_layer\", \"distance\", \"curvature\" or \"gap\" after kind =",
        )),
    }
}

/// Reads the ratio of successive sizes.
pub(super) fn growth(table: &Table<'_>) -> Result<f64, Fault> {
    let value = table.need("growth", "1.2")?;
    let growth = value.number()?;
    if (1.0..=10.0).contains(&growth) { Ok(growth) } else { Err(value.wrong("a growth from 1 to 10", "growth = 1.2")) }
}

fn formula(table: &Table<'_>) -> Result<FieldSpec, Fault> {
    let mut helpers: Vec<(String, String)> = Vec::new();
    if let Some(value) = table.get("let") {
        for entry in value.table()?.entries() {
            helpers.push((entry.key().to_owned(), entry.formula()?));
        }
    }
    table.need("h1", "\"0.1 + 0.05*x\"")?;
    let size = |key| table.get(key).map(|v| v.formula()).transpose();
    let sizes = [size("h1")?, size("h2")?, size("h3")?];
    if sizes[1].is_none() && sizes[2].is_some() {
        return Err(table.fault("h3 is given without h2").remedy("Write h2 too, or h1 alone for an isotropic metric"));
    }
    let direction = |key| table.get(key).map(|v| direction(&v)).transpose();
    let directions = [direction("g1")?, direction("g2")?, direction("g3")?];
    if sizes[1].is_none() && directions.iter().any(Option::is_some) {
        return Err(table.fault("directions are given, but h1 alone").remedy("Write h2 too, or leave g1, g2, g3 out"));
    }
    Ok(FieldSpec::Formula { helpers, sizes, directions, place: table.place() })
}

fn direction(value: &Value<'_>) -> Result<[String; 3], Fault> {
    let wrong = || value.wrong("a direction", &format!("{} = [\"-1\", \"1\"], or three of them", value.key()));
    let parts = value.list().map_err(|_| wrong())?;
    match parts.as_slice() {
        [x, y] => Ok([x.formula()?, y.formula()?, "0".to_owned()]),
        [x, y, z] => Ok([x.formula()?, y.formula()?, z.formula()?]),
        _ => Err(wrong()),
    }
}
