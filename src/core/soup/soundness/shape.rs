//! The shape of each element: area, orientation, convexity. In space a quadrilateral is convex if every corner turns
//! the way of its own mean normal: its Jacobians there are positive, as solvers need it.

use glam::{DVec2, DVec3};

use super::faces::Faces;
use super::{Defect, Found, Soundness};
use crate::core::kernel::predicates::orient;
use crate::core::metric::straight_quad::StraightQuad;

/// An element whose area is below this fraction of its longest side squared counts as zero.
const ZERO_AREA: f64 = 1e-9;
/// A corner of a quadrilateral in space is convex if its sine against the mean normal exceeds this.
const FLAT: f64 = 1e-12;

/// Notes elements without area, inverted ones and quadrilaterals that are not strictly convex; sets `planar` and
/// `area`. Returns whether the mesh as a whole is oriented anticlockwise in the plane.
pub fn examine(faces: &Faces, soundness: &mut Soundness, found: &mut Found) -> bool {
    let mut height = (f64::INFINITY, f64::NEG_INFINITY);
    let mut sum = 0.0;
    for element in 0..faces.len() {
        let corners = faces.corners(element);
        for &node in corners {
            let z = faces.point(node).z;
            height = (height.0.min(z), height.1.max(z));
        }
        sum += normal(faces, corners).z;
    }
    soundness.planar = height.0 == height.1;
    let anticlockwise = sum >= 0.0;
    for element in 0..faces.len() {
        let corners = faces.corners(element);
        let double = normal(faces, corners);
        let area = 0.5 * double.length();
        soundness.area += area;
        let defect = if area <= ZERO_AREA * longest_squared(faces, corners) {
            Some(Defect::ZeroArea)
        } else if soundness.planar {
            in_plane(faces, corners, anticlockwise)
        } else {
            in_space(faces, corners)
        };
        if let Some(defect) = defect {
            found.note(defect, element, faces.point(corners[0]));
        }
    }
    anticlockwise
}

/// Twice the (mean) area vector.
fn normal(faces: &Faces, corners: &[u32]) -> DVec3 {
    let p = |corner: usize| faces.point(corners[corner]);
    if let &[a, b, c, d] = corners {
        return StraightQuad([a, b, c, d].map(|node| faces.point(node))).double_area();
    }
    (p(1) - p(0)).cross(p(2) - p(0))
}

fn longest_squared(faces: &Faces, corners: &[u32]) -> f64 {
    let side = |i: usize| faces.point(corners[i]).distance_squared(faces.point(corners[(i + 1) % corners.len()]));
    (0..corners.len()).map(side).fold(0.0, f64::max)
}

/// The defect of an element in the plane, by the exact orientation of each corner.
fn in_plane(faces: &Faces, corners: &[u32], anticlockwise: bool) -> Option<Defect> {
    let count = corners.len();
    let p = |corner: usize| -> DVec2 { faces.point(corners[corner % count]).truncate() };
    let turns = |i: usize| {
        let turn = orient(p(i), p(i + 1), p(i + 2));
        if anticlockwise { turn } else { -turn }
    };
    let (left, not_left) = (0..count)
        .map(turns)
        .fold((0, 0), |(left, not), turn| if turn > 0.0 { (left + 1, not) } else { (left, not + 1) });
    match (left, not_left) {
        (_, 0) => None,
        (0, _) => Some(Defect::Inverted),
        // An inverted quadrilateral with a reflex corner has one left turn; a bow-tie has two.
        (1, 3) => Some(Defect::Inverted),
        _ => Some(Defect::NotConvex),
    }
}

/// The defect of an element in space; a triangle that has an area has none.
fn in_space(faces: &Faces, corners: &[u32]) -> Option<Defect> {
    let &[a, b, c, d] = corners else { return None };
    let sines = StraightQuad([a, b, c, d].map(|node| faces.point(node))).corner_sines();
    (!sines.iter().all(|&sine| sine > FLAT)).then_some(Defect::NotConvex)
}
