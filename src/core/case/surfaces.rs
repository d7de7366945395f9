//! `[[surface]]` of a case file, and the curves and faces of a case with surfaces.

use glam::DVec3;

use super::geometry::{self, Names, corner_angle, known_curves, name, shape_of};
use super::table::{Table, Value};
use crate::core::fault::Fault;
use crate::core::geometry::{
    AxisFrame, ComplexSpec, SpaceCurveSpec, SpaceShape, SurfaceFaceSpec, SurfaceShape, SurfaceSpec,
};

/// Reads surfaces, curves and faces; `geometry` checks them.
pub(super) fn complex(document: &Table<'_>) -> Result<ComplexSpec, Fault> {
    let mut surfaces = Vec::new();
    for table in document.tables("surface")? {
        surfaces.push(SurfaceSpec { name: name(&table)?, shape: surface(&table)?, place: table.place() });
    }
    let corner = geometry::corner_angle_of_case(document)?;
    let mut curves = Vec::new();
    for table in document.tables("curve")? {
        let segments = table.get("segments").map(|v| v.count(1, 100_000_000)).transpose()?;
        curves.push(SpaceCurveSpec {
            name: name(&table)?,
            shape: curve(&table, &surfaces, corner)?,
            segments,
            place: table.place(),
        });
    }
    let names = Names::of(curves.iter().map(|c: &SpaceCurveSpec| c.name.as_str()));
    let mut faces = Vec::new();
    for table in document.tables("face")? {
        table.only(&["name", "surface", "outer", "holes", "loops", "reversed", "cracks", "repeated", "groups"])?;
        let surface = known_surface(&table.need("surface", "\"plate\"")?, &surfaces)?;
        let outer = table.get("outer").map_or(Ok(Vec::new()), |value| known_curves(&value, &names))?;
        let loops = table.get("loops").map_or(Ok(Vec::new()), |value| directed_loops(&value, &names))?;
        let beside = ["outer", "holes", "cracks", "repeated"].into_iter().find(|key| table.get(key).is_some());
        if let (false, Some(key)) = (loops.is_empty(), beside) {
            let fault = table.fault(format!("The face has loops and {key}"));
            return Err(fault.remedy("loops has all curves of a face, the outer ones and the holes"));
        }
        let reversed = table.get("reversed").map_or(Ok(false), |value| value.flag())?;
        faces.push(SurfaceFaceSpec { surface, face: geometry::face(&table, outer, &names)?, loops, reversed });
    }
    let tolerance = document.get("tolerance").map(|value| value.positive()).transpose()?;
    Ok(ComplexSpec { surfaces, curves, faces, tolerance })
}

/// Loops of directed curves: a minus before a name means against the curve.
fn directed_loops(value: &Value<'_>, names: &Names<'_>) -> Result<Vec<Vec<(String, bool)>>, Fault> {
    let wrong = |_| value.wrong("a list of lists of names", "loops = [[\"south\", \"-east\"], [\"hole\"]]");
    let directed = |ring: &Value<'_>| -> Result<Vec<(String, bool)>, Fault> {
        let directed = |name: String| match name.strip_prefix('-') {
            Some(own) if !names.has(&name) => (own.to_owned(), false),
            _ => (name, true),
        };
        let ring: Vec<(String, bool)> = ring.texts()?.into_iter().map(directed).collect();
        match ring.iter().find(|step| !names.has(&step.0)) {
            _ if ring.is_empty() => Err(value.fault("A loop has no curves").remedy("Name at least one curve in it")),
            Some((name, _)) => Err(value.unknown("curve", name, names.all())),
            None => Ok(ring),
        }
    };
    value.list().map_err(wrong)?.iter().map(directed).collect()
}

fn known_surface(value: &Value<'_>, surfaces: &[SurfaceSpec]) -> Result<String, Fault> {
    let name = value.text()?;
    let names = surfaces.iter().map(|s| s.name.as_str());
    if surfaces.iter().any(|s| s.name == name) {
        Ok(name.to_owned())
    } else {
        Err(value.unknown("surface", name, names))
    }
}

/// A point or direction in space; two numbers mean z = 0.
fn vector(value: &Value<'_>) -> Result<DVec3, Fault> {
    let wrong = || value.wrong("a point in space", &format!("{} = [0.5, 1.0, 0.0]", value.key()));
    let numbers = value.list().map_err(|_| wrong())?;
    match numbers.as_slice() {
        [x, y] => Ok(DVec3::new(x.number()?, y.number()?, 0.0)),
        [x, y, z] => Ok(DVec3::new(x.number()?, y.number()?, z.number()?)),
        _ => Err(wrong()),
    }
}

fn vectors(value: &Value<'_>) -> Result<Vec<DVec3>, Fault> {
    value.list()?.iter().map(vector).collect()
}

/// Centre (default: the origin), axis (default: z) and start direction of a shape with an axis.
fn frame(table: &Table<'_>) -> Result<AxisFrame, Fault> {
    let or = |key, default| table.get(key).map_or(Ok(default), |v| vector(&v));
    let start = table.get("start").map(|v| vector(&v)).transpose()?;
    AxisFrame::new(or("centre", DVec3::ZERO)?, or("axis", DVec3::Z)?, start).map_err(|fault| fault.at(table.place()))
}

fn range(table: &Table<'_>, keys: [&str; 2], default: [f64; 2]) -> Result<[f64; 2], Fault> {
    let number = |i: usize| table.get(keys[i]).map_or(Ok(default[i]), |v| v.number());
    Ok([number(0)?, number(1)?])
}

const WHOLE: [f64; 2] = [0.0, 360.0];
const ANGLES: [&str; 2] = ["from_angle", "to_angle"];

fn surface(table: &Table<'_>) -> Result<SurfaceShape, Fault> {
    const TURNS: &[&str] = &["name", "kind", "centre", "axis", "start", "from_angle", "to_angle"];
    let keys = |own: &[&'static str]| table.only(&[&["name", "kind"], own].concat());
    let turning = |own: &[&'static str]| table.only(&[TURNS, own].concat());
    let kind = table.need("kind", "\"cylinder\"")?;
    match kind.text()? {
        "plane" => {
            keys(&["corner", "u", "v"])?;
            let corner = table.get("corner").map_or(Ok(DVec3::ZERO), |v| vector(&v))?;
            let sides = [vector(&table.need("u", "[1, 0, 0]")?)?, vector(&table.need("v", "[0, 1, 0]")?)?];
            Ok(SurfaceShape::Plane { corner, sides })
        }
        shape @ ("cylinder" | "cone") => {
            turning(if shape == "cone" { &["radius", "top_radius", "height"] } else { &["radius", "height"] })?;
            let radius = table.need("radius", "1")?;
            // A cone may have its apex at its foot.
            let radius = if shape == "cone" { radius.number()? } else { radius.positive()? };
            let top = match (shape, table.get("top_radius")) {
                ("cylinder", _) => radius,
                (_, None) => 0.0,
                (_, Some(value)) => value.number()?,
            };
            Ok(SurfaceShape::Cone {
                frame: frame(table)?,
                radii: [radius, top],
                height: table.need("height", "2")?.positive()?,
                angles: range(table, ANGLES, WHOLE)?,
            })
        }
        "sphere" => {
            turning(&["radius", "from_latitude", "to_latitude"])?;
            Ok(SurfaceShape::Sphere {
                frame: frame(table)?,
                radius: table.need("radius", "1")?.positive()?,
                angles: range(table, ANGLES, WHOLE)?,
                latitudes: range(table, ["from_latitude", "to_latitude"], [-90.0, 90.0])?,
            })
        }
        "torus" => {
            turning(&["radius", "tube", "from_tube", "to_tube"])?;
            Ok(SurfaceShape::Torus {
                frame: frame(table)?,
                radius: table.need("radius", "2")?.positive()?,
                tube: table.need("tube", "0.5")?.positive()?,
                angles: range(table, ANGLES, WHOLE)?,
                tube_angles: range(table, ["from_tube", "to_tube"], WHOLE)?,
            })
        }
        "extrusion" => {
            keys(&["curve", "direction"])?;
            let curve = table.need("curve", "\"profile\"")?.text()?.to_owned();
            Ok(SurfaceShape::Extrusion { curve, along: vector(&table.need("direction", "[0, 0, 1]")?)? })
        }
        "revolution" => {
            turning(&["curve"])?;
            let curve = table.need("curve", "\"profile\"")?.text()?.to_owned();
            Ok(SurfaceShape::Revolution { curve, frame: frame(table)?, angles: range(table, ANGLES, WHOLE)? })
        }
        "bezier" => {
            keys(&["points", "weights"])?;
            let (points, columns, weights) = net(table)?;
            let degrees = [points.len() / columns.max(1), columns].map(|n| n.saturating_sub(1));
            let knots = degrees.map(|p| [vec![0.0; p + 1], vec![1.0; p + 1]].concat());
            Ok(SurfaceShape::Nurbs { degrees, knots, weights, points, columns })
        }
        "nurbs" => {
            keys(&["degree_u", "degree_v", "knots_u", "knots_v", "points", "weights"])?;
            let degree = |key| table.need(key, "3")?.count(1, 20);
            let degrees = [degree("degree_u")? as usize, degree("degree_v")? as usize];
            let knots = |key| table.need(key, "[0, 0, 0, 0, 1, 1, 1, 1]")?.numbers();
            let (points, columns, weights) = net(table)?;
            Ok(SurfaceShape::Nurbs { degrees, knots: [knots("knots_u")?, knots("knots_v")?], weights, points, columns })
        }
        _ => Err(kind.wrong(
            "a kind of surface",
            "\"plane\", \"cylinder\", \"cone\", \"sphere\", \"torus\", \"extrusion\", \"revolution\", \"bezier\" or \
             \"nurbs\" after kind =",
        )),
    }
}

/// Rows of control points with their weights.
fn net(table: &Table<'_>) -> Result<(Vec<DVec3>, usize, Vec<f64>), Fault> {
    let value = table.need("points", "[[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0.5]]]")?;
    let rows: Vec<Vec<DVec3>> = value.list()?.iter().map(vectors).collect::<Result<_, _>>()?;
    let columns = rows.first().map_or(0, Vec::len);
    if columns == 0 || rows.iter().any(|row| row.len() != columns) {
        return Err(value
            .fault("The rows of control points have different lengths")
            .remedy("Give a list of rows along u, each with the points along v"));
    }
    let weights = match table.get("weights") {
        None => Vec::new(),
        Some(value) => {
            let rows: Vec<Vec<f64>> = value.list()?.iter().map(Value::numbers).collect::<Result<_, _>>()?;
            if rows.iter().any(|row| row.len() != columns) {
                return Err(value
                    .fault("weights must have a number for each point")
                    .remedy("Give rows like those of points"));
            }
            rows.concat()
        }
    };
    Ok((rows.concat(), columns, weights))
}

fn curve(table: &Table<'_>, surfaces: &[SurfaceSpec], corner: f64) -> Result<SpaceShape, Fault> {
    if let Some(value) = table.get("on") {
        return Ok(SpaceShape::On {
            surface: known_surface(&value, surfaces)?,
            shape: shape_of(table, corner, &["on"])?,
        });
    }
    let keys = |own: &[&'static str]| table.only(&[&["name", "kind", "segments"], own].concat());
    let kind = table.need("kind", "\"segment\"")?;
    match kind.text()? {
        "segment" => {
            keys(&["from", "to"])?;
            let from = vector(&table.need("from", "[0, 0, 0]")?)?;
            Ok(SpaceShape::Segment { from, to: vector(&table.need("to", "[1, 0, 0]")?)? })
        }
        "arc" => {
            keys(&["centre", "axis", "start", "radius", "from_angle", "to_angle"])?;
            let angle = |key, example| table.need(key, example)?.number();
            let angles = [angle("from_angle", "0")?, angle("to_angle", "90")?];
            Ok(SpaceShape::Arc { frame: frame(table)?, radius: table.need("radius", "0.5")?.positive()?, angles })
        }
        "circle" => {
            keys(&["centre", "axis", "start", "radius", "start_angle"])?;
            let from = table.get("start_angle").map_or(Ok(0.0), |v| v.number())?;
            let radius = table.need("radius", "0.5")?.positive()?;
            Ok(SpaceShape::Arc { frame: frame(table)?, radius, angles: [from, from + 360.0] })
        }
        "polyline" => {
            keys(&["points", "closed", "corner_angle"])?;
            let points = vectors(&table.need("points", "[[0, 0, 0], [1, 0, 0], [1, 1, 0]]")?)?;
            let closed = table.get("closed").map_or(Ok(false), |v| v.flag())?;
            Ok(SpaceShape::Polyline { points, closed, corner_angle: corner_angle(table, corner)? })
        }
        "nurbs" => {
            keys(&["degree", "knots", "weights", "points"])?;
            Ok(SpaceShape::Nurbs {
                degree: table.need("degree", "3")?.count(1, 20)? as usize,
                knots: table.need("knots", "[0, 0, 0, 0, 1, 1, 1, 1]")?.numbers()?,
                weights: table.get("weights").map_or(Ok(Vec::new()), |v| v.numbers())?,
                points: vectors(&table.need("points", "[[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 1, 1]]")?)?,
            })
        }
        _ => {
            Err(kind
                .wrong("a kind of curve", "\"segment\", \"arc\", \"circle\", \"polyline\" or \"nurbs\" after kind ="))
        }
    }
}
