//! `[[curve]]` and `[[face]]` of a case file.

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use super::table::{Table, Value};
use crate::core::fault::Fault;
use crate::core::geometry::{CurveShape, CurveSpec, FaceSpec};

/// By default, a polyline has a corner where it turns by at least this angle (degrees).
const CORNER_ANGLE: f64 = 5.0;

/// Reads the curves; `geometry` checks them.
pub(super) fn curves(document: &Table<'_>) -> Result<Vec<CurveSpec>, Fault> {
    let corner = corner_angle_of_case(document)?;
    let mut curves = Vec::new();
    for table in document.tables("curve")? {
        let name = name(&table)?;
        let shape = shape_of(&table, corner, &[])?;
        let segments = table.get("segments").map(|v| v.count(1, 100_000_000)).transpose()?;
        curves.push(CurveSpec { name, shape, segments, place: table.place() });
    }
    Ok(curves)
}

/// The names of the curves of a case.
pub(super) struct Names<'a>(BTreeSet<&'a str>);

impl<'a> Names<'a> {
    /// All of these.
    pub fn of(names: impl Iterator<Item = &'a str>) -> Names<'a> {
        Names(names.collect())
    }

    /// Whether it is one of them.
    pub fn has(&self, name: &str) -> bool {
        self.0.contains(name)
    }

    /// All of them, in alphabetical order.
    pub fn all(&self) -> impl Iterator<Item = &'a str> {
        self.0.iter().copied()
    }
}

/// Reads the faces, whose curves must exist.
pub(super) fn faces(document: &Table<'_>, curves: &[CurveSpec]) -> Result<Vec<FaceSpec>, Fault> {
    let names = Names::of(curves.iter().map(|c| c.name.as_str()));
    let mut faces = Vec::new();
    for table in document.tables("face")? {
        table.only(&["name", "outer", "holes", "cracks", "repeated", "groups"])?;
        let outer = known_curves(&table.need("outer", "[\"south\", \"east\", \"north\", \"west\"]")?, &names)?;
        faces.push(face(&table, outer, &names)?);
    }
    Ok(faces)
}

/// Reads the rest of a face, after its outer loop.
pub(super) fn face(table: &Table<'_>, outer: Vec<String>, names: &Names<'_>) -> Result<FaceSpec, Fault> {
    let name = name(table)?;
    let some = |key| table.get(key).map_or(Ok(Vec::new()), |value| known_curves(&value, names));
    let holes = match table.get("holes") {
        None => Vec::new(),
        Some(value) => {
            let wrong = |_| value.wrong("a list of lists of names", "holes = [[\"hole\"]]");
            let list = value.list().map_err(wrong)?;
            list.iter().map(|hole| known_curves(hole, names)).collect::<Result<_, _>>()?
        }
    };
    let (cracks, repeated) = (some("cracks")?, some("repeated")?);
    let groups = table.get("groups").map_or(Ok(Vec::new()), |value| value.texts())?;
    Ok(FaceSpec { name, outer, holes, cracks, repeated, groups, place: table.place() })
}

/// Reads a list of names of existing curves; edges of whole surfaces, such as "ball: v0", are checked later.
pub(super) fn known_curves(value: &Value<'_>, curves: &Names<'_>) -> Result<Vec<String>, Fault> {
    let names = value.texts()?;
    if names.is_empty() {
        return Err(value
            .fault(format!("{} is empty", value.key()))
            .remedy("Name at least one curve, or leave it out"));
    }
    match names.iter().find(|name| !name.contains(": ") && !curves.has(name)) {
        Some(name) => Err(value.unknown("curve", name, curves.all())),
        None => Ok(names),
    }
}

pub(super) fn name(table: &Table<'_>) -> Result<String, Fault> {
    let value = table.need("name", "\"hole\"")?;
    let name = value.text()?;
    if name.is_empty() || name.chars().any(char::is_control) {
        return Err(value.wrong("a name", "name = \"hole\""));
    }
    Ok(name.to_owned())
}

/// Reads `corner_angle` of a case or of a polyline, in radians.
pub(super) fn corner_angle(table: &Table<'_>, default: f64) -> Result<f64, Fault> {
    let Some(value) = table.get("corner_angle") else { return Ok(default) };
    let degrees = value.number()?;
    if (0.0..=90.0).contains(&degrees) {
        return Ok(degrees.to_radians());
    }
    Err(value.wrong("an angle from 0 to 90 degrees", &format!("corner_angle = {CORNER_ANGLE}")))
}

/// The corner angle of a case, in radians.
pub(super) fn corner_angle_of_case(document: &Table<'_>) -> Result<f64, Fault> {
    corner_angle(document, CORNER_ANGLE.to_radians())
}

/// Reads a plane curve; polylines have corners by `corner` (radians) unless they say otherwise, and `besides` are
/// further keys allowed in the table.
pub(super) fn shape_of(table: &Table<'_>, corner: f64, besides: &[&'static str]) -> Result<CurveShape, Fault> {
    let keys = |own: &[&'static str]| table.only(&[&["name", "kind", "segments"], own, besides].concat());
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
                    .fault("The arc spans 0 or more than 360 degrees")
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
            keys(&["points", "closed", "corner_angle"])?;
            let points = table.need("points", "[[0, 0], [1, 0], [1, 1]]")?.points()?;
            let closed = table.get("closed").map_or(Ok(false), |v| v.flag())?;
            Ok(CurveShape::Polyline { points, closed, corner_angle: corner_angle(table, corner)? })
        }
        "nurbs" => {
            keys(&["degree", "knots", "weights", "points"])?;
            Ok(CurveShape::Nurbs {
                degree: table.need("degree", "3")?.count(1, 20)? as usize,
                knots: table.need("knots", "[0, 0, 0, 0, 1, 1, 1, 1]")?.numbers()?,
                weights: table.get("weights").map_or(Ok(Vec::new()), |v| v.numbers())?,
                points: table.need("points", "[[0, 0], [1, 0], [1, 1], [2, 1]]")?.points()?,
            })
        }
        _ => {
            Err(kind
                .wrong("a kind of curve", "\"segment\", \"arc\", \"circle\", \"polyline\" or \"nurbs\" after kind ="))
        }
    }
}
