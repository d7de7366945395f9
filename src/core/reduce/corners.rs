//! The corners of a plane case. Dropping corners of an outline must not make a new, sharper one: a small angle of the
//! mesh would then be that of the outline, and not what was asked about.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec2;

use super::document::{Keys, Node};
use super::draft::Draft;
use crate::core::case::DomainSource;
use crate::core::geometry::curve::Curve;
use crate::core::kernel::box_tree::extent;

/// Distance of a chord from its arc, relative to the extent of a loop.
const CHORD: f64 = 1e-3;
/// Distance at which ends of curves are the same point, relative to the extent of a loop.
const NEAR: f64 = 1e-8;
/// Steps in which angles are compared (radians), so that rounding does not decide.
const STEP: f64 = 1e-3;

/// The curves of a plane case, by name.
pub(super) fn plane_curves(draft: &Draft) -> BTreeMap<String, Curve> {
    let Ok(run) = draft.run() else { return BTreeMap::new() };
    let DomainSource::Curves { curves, .. } = run.case.domain else { return BTreeMap::new() };
    let curves = curves.into_iter().filter_map(|spec| Some((spec.name, Curve::new(&spec.shape).ok()?)));
    curves.collect()
}

/// The names of the curves of a loop: the outer one, or a hole.
pub(super) fn loop_of(face: &Keys, hole: Option<usize>) -> Vec<String> {
    let names = |list: &[Node]| list.iter().filter_map(Node::text).map(str::to_owned).collect();
    match hole {
        None => face.names("outer"),
        Some(i) => face.list("holes").get(i).map_or(Vec::new(), |list| names(list.items())),
    }
}

/// The loops of all faces, each with the number of its face and, for a hole, its own.
pub(super) fn loops(keys: &Keys) -> Vec<(usize, Option<usize>)> {
    let of = |(face, keys): (usize, &Keys)| {
        let holes = (0..keys.list("holes").len()).map(Some);
        std::iter::once(None).chain(holes).map(move |hole| (face, hole)).collect::<Vec<_>>()
    };
    keys.tables("face").enumerate().flat_map(of).collect()
}

/// The curves of a loop in the order in which they follow one another, each with the point where it begins and whether
/// it runs backward.
pub(super) fn chained(names: &[String], curves: &BTreeMap<String, Curve>) -> Option<Vec<(String, DVec2, bool)>> {
    let ends = |name| curves.get(name).map(|curve| (name, [curve.point(0.0), curve.point(1.0)]));
    let mut left: Vec<(&String, [DVec2; 2])> = names.iter().map(ends).collect::<Option<_>>()?;
    let (low, high) = extent(left.iter().flat_map(|curve| curve.1));
    let near = |a: DVec2, b: DVec2| (a - b).length() <= NEAR * (high - low).max_element();
    let (name, [start, mut at]) = (!left.is_empty()).then(|| left.remove(0))?;
    let mut chain = vec![(name.clone(), start, false)];
    while !left.is_empty() {
        let next = left.iter().position(|(_, ends)| near(ends[0], at) || near(ends[1], at))?;
        let (name, [a, b]) = left.remove(next);
        let is_backward = !near(a, at);
        chain.push((name.clone(), at, is_backward));
        at = if is_backward { a } else { b };
    }
    near(at, start).then_some(chain)
}

/// The sharpest corner of the loops of a plane case, at most a right angle, in steps of a thousandth of a radian.
pub(super) fn sharpest(draft: &Draft) -> u32 {
    let curves = plane_curves(draft);
    let faces: Vec<&Keys> = draft.keys.tables("face").collect();
    let of = |(face, hole): (usize, Option<usize>)| {
        let chain = chained(&loop_of(faces[face], hole), &curves)?;
        sharpest_of(&polygon_of(&chain, &curves))
    };
    let angle = loops(&draft.keys).into_iter().filter_map(of).fold(FRAC_PI_2, f64::min);
    (angle / STEP).round() as u32
}

/// A loop as a polygon.
fn polygon_of(chain: &[(String, DVec2, bool)], curves: &BTreeMap<String, Curve>) -> Vec<DVec2> {
    let (low, high) = extent(
        chain
            .iter()
            .filter_map(|(name, ..)| curves.get(name))
            .flat_map(|curve| [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| curve.point(t))),
    );
    let tolerance = CHORD * (high - low).max_element();
    let mut polygon = Vec::new();
    for (name, _, is_backward) in chain {
        let Some(curve) = curves.get(name) else { continue };
        let mut points: Vec<DVec2> = curve.polyline(tolerance).into_iter().map(|(_, p)| p).collect();
        if *is_backward {
            points.reverse();
        }
        points.pop();
        polygon.extend(points);
    }
    polygon
}

fn sharpest_of(polygon: &[DVec2]) -> Option<f64> {
    let n = polygon.len();
    let angle = |i: usize| {
        let (before, at, after) = (polygon[(i + n - 1) % n], polygon[i], polygon[(i + 1) % n]);
        let (a, b) = (before - at, after - at);
        libm::atan2(a.perp_dot(b).abs(), a.dot(b))
    };
    (n > 2).then(|| (0..n).map(angle).fold(PI, f64::min))
}
