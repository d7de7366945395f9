//! `[[curve]]` and `[[face]]` of a case file.

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use super::case_table::{Table, Value};
use crate::core::convert::parameters::nearest;
use crate::core::fault::Fault;
use crate::core::geometry::domain::{CurveShape, CurveSpec, FaceSpec};

/// Reads the curves, whose names must differ.
pub(super) fn curves(document: &Table<'_>) -> Result<Vec<CurveSpec>, Fault> {
    let mut names = BTreeSet::new();
    let mut curves = Vec::new();
    for table in document.tables("curve")? {
        let name = new_name(&table, &mut names, "curve")?;
        let shape = shape(&table)?;
        let segments = table.get("segments").map(|v| v.count(1, 100_000_000)).transpose()?;
        curves.push(CurveSpec { name, shape, segments, place: table.place() });
    }
    Ok(curves)
}

/// Reads the faces, whose names must differ and whose curves must be there.
pub(super) fn faces(document: &Table<'_>, curves: &[CurveSpec]) -> Result<Vec<FaceSpec>, Fault> {
    let mut names = BTreeSet::new();
    let mut faces = Vec::new();
    for table in document.tables("face")? {
        table.only(&["name", "outer", "holes", "cracks", "repeated"])?;
        let name = new_name(&table, &mut names, "face")?;
        let outer = known_curves(&table.need("outer", "[\"south\", \"east\", \"north\", \"west\"]")?, curves)?;
        let some = |key| table.get(key).map_or(Ok(Vec::new()), |value| known_curves(&value, curves));
        let holes = match table.get("holes") {
            None => Vec::new(),
            Some(value) => {
                let wrong = |_| value.wrong("a list of lists of names", "holes = [[\"hole\"]]");
                let list = value.list().map_err(wrong)?;
                list.iter().map(|hole| known_curves(hole, curves)).collect::<Result<_, _>>()?
            }
        };
        let (cracks, repeated) = (some("cracks")?, some("repeated")?);
        faces.push(FaceSpec { name, outer, holes, cracks, repeated, place: table.place() });
    }
    Ok(faces)
}

/// Reads a list of names of curves that must be there.
pub(super) fn known_curves(value: &Value<'_>, curves: &[CurveSpec]) -> Result<Vec<String>, Fault> {
    let names = value.texts()?;
    if names.is_empty() {
        return Err(value
            .fault(format!("{} is empty", value.key()))
            .remedy("Name at least one curve, or leave it out"));
    }
    for name in &names {
        if !curves.iter().any(|c| c.name == *name) {
            let nearest = nearest(name, curves.iter().map(|c| c.name.as_str()));
            let fault = value.fault(format!("there is no curve \"{}\"", name.escape_debug()));
            return Err(match nearest {
                Some(near) => fault.remedy(format!("The nearest name is \"{near}\"")),
                None => fault.remedy("Add it as [[curve]]"),
            });
        }
    }
    Ok(names)
}

fn new_name(table: &Table<'_>, names: &mut BTreeSet<String>, what: &str) -> Result<String, Fault> {
    let value = table.need("name", "\"hole\"")?;
    let name = value.text()?.to_owned();
    if name.is_empty() || name.chars().any(char::is_control) {
        return Err(value.wrong("a name", "name = \"hole\""));
    }
    if !names.insert(name.clone()) {
        return Err(value
            .fault(format!("there are two {what}s of the name \"{name}\""))
            .remedy("Give each a name of its own"));
    }
    Ok(name)
}

fn shape(table: &Table<'_>) -> Result<CurveShape, Fault> {
    let keys = |own: &[&'static str]| table.only(&[&["name", "kind", "segments"], own].concat());
    let kind = table.need("kind", "\"segment\"")?;
    match kind.text()? {
        "segment" => {
            keys(&["from", "to"])?;
            let from = table.need("from", "[0, 0]")?.point()?;
            let to = table.need("to", "[1, 0]")?.point()?;
            Ok(CurveShape::Segment { from, to })
        }
        "arc" => {
            keys(&["centre", "radius", "from_angle", "to_angle"])?;
            let centre = table.need("centre", "[0, 0]")?.point()?;
            let radius = table.need("radius", "0.5")?.positive()?;
            let (from, to) = (table.need("from_angle", "0")?, table.need("to_angle", "90")?);
            let (from_angle, mut to_angle) = (from.degrees()?, to.degrees()?);
            let turn = to.number()? - from.number()?;
            if turn == 0.0 || turn.abs() > 360.0 {
                return Err(to
                    .fault("the arc turns by nothing or by more than 360 degrees")
                    .remedy("Write to_angle greater than from_angle for anticlockwise, less for clockwise"));
            }
            if turn.abs() == 360.0 {
                to_angle = from_angle + TAU.copysign(turn);
            }
            Ok(CurveShape::Arc { centre, radius, from_angle, to_angle })
        }
        "circle" => {
            keys(&["centre", "radius", "start_angle"])?;
            let centre = table.need("centre", "[0, 0]")?.point()?;
            let radius = table.need("radius", "0.5")?.positive()?;
            let from_angle = table.get("start_angle").map_or(Ok(0.0), |v| v.degrees())?;
            Ok(CurveShape::Arc { centre, radius, from_angle, to_angle: from_angle + TAU })
        }
        "polyline" => {
            keys(&["points", "closed"])?;
            let value = table.need("points", "[[0, 0], [1, 0], [1, 1]]")?;
            let points = value.points()?;
            let closed = table.get("closed").map_or(Ok(false), |v| v.flag())?;
            let least = if closed { 3 } else { 2 };
            if points.len() < least {
                return Err(value
                    .fault(format!("the polyline has {} points, and needs at least {least}", points.len()))
                    .remedy("Add points"));
            }
            Ok(CurveShape::Polyline { points, closed })
        }
        "nurbs" => {
            keys(&["degree", "knots", "weights", "points"])?;
            nurbs(table)
        }
        _ => {
            Err(kind
                .wrong("a kind of curve", "\"segment\", \"arc\", \"circle\", \"polyline\" or \"nurbs\" after kind ="))
        }
    }
}

fn nurbs(table: &Table<'_>) -> Result<CurveShape, Fault> {
    let degree = table.need("degree", "3")?.count(1, 20)? as usize;
    let points_value = table.need("points", "[[0, 0], [1, 0], [1, 1], [2, 1]]")?;
    let points = points_value.points()?;
    if points.len() <= degree {
        return Err(points_value
            .fault(format!("a curve of degree {degree} needs {} points, and has {}", degree + 1, points.len()))
            .remedy("Add points, or lower the degree"));
    }
    let knots_value = table.need("knots", "[0, 0, 0, 0, 1, 1, 1, 1]")?;
    let knots = knots_value.numbers()?;
    if knots.len() != points.len() + degree + 1 {
        return Err(knots_value
            .fault(format!("there are {} knots for {} points of degree {degree}", knots.len(), points.len()))
            .remedy(format!("Write points + degree + 1 = {} knots", points.len() + degree + 1)));
    }
    if knots.windows(2).any(|pair| pair[1] < pair[0]) || knots.first() == knots.last() {
        return Err(knots_value.fault("the knots do not rise").remedy("Order them from the least to the greatest"));
    }
    let weights = match table.get("weights") {
        None => Vec::new(),
        Some(value) => {
            let weights = value.list()?.iter().map(Value::positive).collect::<Result<Vec<_>, _>>()?;
            if weights.len() != points.len() {
                return Err(value
                    .fault(format!("there are {} weights for {} points", weights.len(), points.len()))
                    .remedy("Write one a point, or leave them out"));
            }
            weights
        }
    };
    Ok(CurveShape::Nurbs { degree, knots, weights, points })
}
