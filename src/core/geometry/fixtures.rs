//! Domains by shape, for tests.

use std::f64::consts::TAU;

use glam::DVec2;

use super::domain::Domain;
use super::spec::{CurveShape, CurveSpec, FaceSpec};

/// Curves and faces of a case.
pub type Specs = (Vec<CurveSpec>, Vec<FaceSpec>);

fn named(name: &str, shape: CurveShape) -> CurveSpec {
    CurveSpec { name: name.to_owned(), shape, segments: None, place: String::new() }
}

pub fn segment(name: &str, from: (f64, f64), to: (f64, f64)) -> CurveSpec {
    named(name, CurveShape::Segment { from: from.into(), to: to.into() })
}

pub fn circle(name: &str, centre: (f64, f64), radius: f64) -> CurveSpec {
    arc(name, centre, radius, 0.0, TAU)
}

pub fn arc(name: &str, centre: (f64, f64), radius: f64, from_angle: f64, to_angle: f64) -> CurveSpec {
    named(name, CurveShape::Arc { centre: centre.into(), radius, from_angle, to_angle })
}

pub fn polyline(name: &str, points: &[(f64, f64)], closed: bool) -> CurveSpec {
    let points = points.iter().map(|&p| DVec2::from(p)).collect();
    named(name, CurveShape::Polyline { points, closed, corner_angle: 0.0 })
}

/// `face("f", "a b", &["hole1", "c d"], "crack", "repeated")`: lists are words.
pub fn face(name: &str, outer: &str, holes: &[&str], cracks: &str, repeated: &str) -> FaceSpec {
    let words = |list: &str| list.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    FaceSpec {
        name: name.to_owned(),
        outer: words(outer),
        holes: holes.iter().map(|h| words(h)).collect(),
        cracks: words(cracks),
        repeated: words(repeated),
        groups: Vec::new(),
        place: String::new(),
    }
}

pub fn sides_of_square() -> Vec<CurveSpec> {
    vec![
        segment("south", (0.0, 0.0), (1.0, 0.0)),
        segment("north", (0.0, 1.0), (1.0, 1.0)),
        segment("east", (1.0, 1.0), (1.0, 0.0)),
        segment("west", (0.0, 0.0), (0.0, 1.0)),
    ]
}

pub const SQUARE: &str = "south east north west";

pub fn square() -> Specs {
    (sides_of_square(), vec![face("plate", SQUARE, &[], "", "")])
}

/// The unit square with more curves and another list of outer curves, holes, cracks.
pub fn with(more: Vec<CurveSpec>, outer: &str, holes: &[&str], cracks: &str) -> Specs {
    ([sides_of_square(), more].concat(), vec![face("plate", outer, holes, cracks, "")])
}

pub fn square_with_hole() -> Specs {
    with(vec![circle("hole", (0.5, 0.5), 0.2)], SQUARE, &["hole"], "")
}

/// A disc of three arcs with different directions.
pub fn disc() -> Specs {
    let third = TAU / 3.0;
    let curves = vec![
        arc("a", (0.0, 0.0), 2.0, 0.0, third),
        arc("b", (0.0, 0.0), 2.0, 2.0 * third, third),
        arc("c", (0.0, 0.0), 2.0, 2.0 * third, 3.0 * third),
    ];
    (curves, vec![face("disc", "c a b", &[], "", "")])
}

/// The unit square with a hole that is filled by a second face.
pub fn square_with_inlay() -> Specs {
    let (curves, mut faces) = square_with_hole();
    faces.push(face("inlay", "hole", &[], "", ""));
    (curves, faces)
}

/// Two unit squares side by side that share the curve `east`.
pub fn two_faces() -> Specs {
    let mut curves = sides_of_square();
    curves.push(polyline("far", &[(1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0)], false));
    (curves, vec![face("left", SQUARE, &[], "", ""), face("right", "far east", &[], "", "")])
}

pub fn square_with_crack() -> Specs {
    with(vec![segment("crack", (0.3, 0.5), (0.7, 0.6))], SQUARE, &[], "crack")
}

/// A square whose west side is divided where a crack begins.
pub fn square_with_edge_crack() -> Specs {
    let mut curves = sides_of_square();
    curves[3] = segment("west", (0.0, 0.0), (0.0, 0.5));
    curves.push(segment("west2", (0.0, 1.0), (0.0, 0.5)));
    curves.push(segment("crack", (0.0, 0.5), (0.6, 0.5)));
    (curves, vec![face("plate", "south east north west west2", &[], "crack", "")])
}

/// A square with a hole, the two joined by a repeated line.
pub fn square_with_bridge() -> Specs {
    let mut curves = sides_of_square();
    curves[2] = polyline("east", &[(1.0, 1.0), (1.0, 0.5)], false);
    curves.push(segment("east2", (1.0, 0.0), (1.0, 0.5)));
    curves.push(circle("hole", (0.5, 0.5), 0.2));
    curves.push(segment("bridge", (0.7, 0.5), (1.0, 0.5)));
    (curves, vec![face("plate", "south east east2 north west", &["hole"], "", "bridge")])
}

/// A square with three cracks that meet in its middle.
pub fn square_with_t_of_cracks() -> Specs {
    let mut curves = sides_of_square();
    curves.push(segment("c1", (0.2, 0.5), (0.5, 0.5)));
    curves.push(segment("c2", (0.8, 0.5), (0.5, 0.5)));
    curves.push(segment("c3", (0.5, 0.5), (0.5, 0.8)));
    (curves, vec![face("plate", SQUARE, &[], "c1 c2 c3", "")])
}

/// A square that a crack cuts through from side to side.
pub fn square_cut_in_two() -> Specs {
    let curves = vec![
        polyline("left", &[(0.5, 1.0), (0.0, 1.0), (0.0, 0.0), (0.5, 0.0)], false),
        polyline("right", &[(0.5, 1.0), (1.0, 1.0), (1.0, 0.0), (0.5, 0.0)], false),
        segment("cut", (0.5, 0.0), (0.5, 1.0)),
    ];
    (curves, vec![face("plate", "left right", &[], "cut", "")])
}

/// All of the domains above, with names.
pub fn all() -> Vec<(&'static str, Specs)> {
    vec![
        ("square", square()),
        ("square_with_hole", square_with_hole()),
        ("disc", disc()),
        ("square_with_inlay", square_with_inlay()),
        ("two_faces", two_faces()),
        ("square_with_crack", square_with_crack()),
        ("square_with_edge_crack", square_with_edge_crack()),
        ("square_with_bridge", square_with_bridge()),
        ("square_with_t_of_cracks", square_with_t_of_cracks()),
        ("square_cut_in_two", square_cut_in_two()),
    ]
}

/// The domain of a valid case.
pub fn built((curves, faces): Specs) -> Domain {
    Domain::build(curves, faces).unwrap()
}
