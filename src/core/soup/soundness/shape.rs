//! The shape of each element: area, orientation, convexity. On a surface, corners are compared with the surface normal.
//! A file has none, so a direction with which all corners of one group around the node agree replaces it, if one
//! exists. A corner that agrees with its own quadrilateral passes as well.

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::faces::Faces;
use super::{Defect, Found, Soundness};
use crate::core::kernel::predicates::orient;

/// An element whose area is below this fraction of its longest side squared counts as zero.
const ZERO_AREA: f64 = 1e-9;
/// A corner of a curved quadrilateral is convex if its sine exceeds this.
const FLAT: f64 = 1e-12;
/// Iterations of the search for a normal at a node.
const PATIENCE: usize = 200;

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
    let normals = if soundness.planar { Normals::default() } else { normals(faces) };
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
            on_surface(faces, corners, double / (2.0 * area), &|node| normals[&(node, faces.tag(element))])
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
    if corners.len() == 3 { (p(1) - p(0)).cross(p(2) - p(0)) } else { (p(2) - p(0)).cross(p(3) - p(1)) }
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

/// A direction with which the corners agree, by node and group.
type Normals = FxHashMap<(u32, u32), DVec3>;

fn normals(faces: &Faces) -> Normals {
    let mut corners_at: Vec<(u32, u32, u32)> = Vec::new();
    for element in 0..faces.len() {
        for (i, &node) in faces.corners(element).iter().enumerate() {
            corners_at.push((node, faces.tag(element), (4 * element + i) as u32));
        }
    }
    corners_at.sort_unstable();
    let mut normals = Normals::default();
    for group in corners_at.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let corners: SmallVec<[DVec3; 8]> = group
            .iter()
            .map(|&(_, _, h)| corner_normal(faces, faces.corners(h as usize / 4), h as usize % 4).normalize_or_zero())
            .collect();
        let mut normal = corners.iter().sum::<DVec3>().normalize_or_zero();
        // If the mean fails, turn it towards the corner that agrees least (the perceptron rule, which converges if a
        // direction exists).
        for _ in 0..PATIENCE {
            let worst = corners.iter().copied().min_by(|a, b| a.dot(normal).total_cmp(&b.dot(normal)));
            let Some(worst) = worst.filter(|corner| corner.dot(normal) <= 1e-3) else { break };
            normal = (normal + 0.3 * worst).normalize_or_zero();
        }
        normals.insert((group[0].0, group[0].1), normal);
    }
    normals
}

/// The normal at a corner; its length is the area of the parallelogram of the two sides.
fn corner_normal(faces: &Faces, corners: &[u32], i: usize) -> DVec3 {
    let count = corners.len();
    let p = |corner: usize| faces.point(corners[corner % count]);
    (p(i + 1) - p(i)).cross(p(i + count - 1) - p(i))
}

/// The defect of an element on a surface: each corner's normal against that of the surface there, or of the element.
fn on_surface(faces: &Faces, corners: &[u32], own: DVec3, around: &dyn Fn(u32) -> DVec3) -> Option<Defect> {
    let count = corners.len();
    let p = |corner: usize| faces.point(corners[corner % count]);
    let convex = (0..count).all(|i| {
        let least = FLAT * p(i + 1).distance(p(i)) * p(i + count - 1).distance(p(i));
        let corner = corner_normal(faces, corners, i);
        let around = around(corners[i]);
        corner.dot(own) > least || (corner.dot(around) > least && around.dot(own) > 0.0)
    });
    (!convex).then_some(Defect::NotConvex)
}
