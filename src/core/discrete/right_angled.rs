//! Right-angled triangles in pairs: what is left of a grid of quadrilaterals that was cut along diagonals
//! (docs/algorithm.md, "Meshes that are given").
//!
//! A lattice of right-angled triangles and one of equilateral triangles are affine images of each other: a metric that
//! makes either one unit always exists. Which of the two is meant shows in the angles that the mesh has in space, and
//! only where many neighbours agree: one triangle in ten of an ordinary mesh has a right angle by chance.

use glam::DVec3;

use super::edges::{Corner, Edges};

/// A corner is right-angled if its shear is below this; two triangles with a shear of 0.5 are a pair of equilateral
/// triangles or the image of one under a stretch along a side or across it.
const GREATEST_SHEAR: f64 = 0.4;
/// Where the mean score around a triangle is below the first, it counts as equilateral, above the second as
/// right-angled. Delaunay, frontal and BAMG meshes have mean scores below 0.1, and nowhere above 0.54; grids have 1.
const AGREEMENT: [f64; 2] = [0.55, 0.7];
/// How often scores are averaged: once is not enough to tell a few pairs by chance from a grid.
const ROUNDS: usize = 2;

/// The right angle of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RightAngle {
    /// Its corner, 0 to 2: the legs are the sides that meet there.
    pub corner: usize,
    /// How much the triangle counts as right-angled: 1 in a cut grid, between 0 and 1 at its edge.
    pub weight: f64,
}

/// The right angle of each triangle that counts as right-angled. A triangle scores if its neighbour across the side
/// opposite to its right angle has its own right angle opposite to that side too; the score of the pair is `1 - (s /
/// 0.4)^2` with its greater shear `s`. Scores are averaged at each node and then over the nodes of each triangle,
/// twice; the mean gives the weight.
pub fn right_angles(points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<Option<RightAngle>> {
    let least = |t: &[u32; 3]| {
        let corners = t.map(|k| points[k as usize]);
        let at = |corner: usize| (shear(corners, corner), corner);
        (1..3).map(at).fold(at(0), |least, other| if other.0 < least.0 { other } else { least })
    };
    let angles: Vec<(f64, usize)> = triangles.iter().map(least).collect();
    let mut mean = scores(triangles, &angles);
    for _ in 0..ROUNDS {
        average(&mut mean, triangles, points.len());
    }
    let found = |(&mean, &(shear, corner)): (&f64, &(f64, usize))| {
        let x = ((mean - AGREEMENT[0]) / (AGREEMENT[1] - AGREEMENT[0])).clamp(0.0, 1.0);
        (x > 0.0 && shear < GREATEST_SHEAR).then_some(RightAngle { corner, weight: x * x * (3.0 - 2.0 * x) })
    };
    mean.iter().zip(&angles).map(found).collect()
}

/// The score of each triangle, given the least shear of its corners and the corner.
fn scores(triangles: &[[u32; 3]], angles: &[(f64, usize)]) -> Vec<f64> {
    let edges = Edges::of(triangles);
    let opposite = |t: usize| edges.of_side(3 * t as Corner + (angles[t].1 as Corner + 1) % 3);
    let score = |t: usize| {
        let sides = edges.get(opposite(t)).sides;
        let is_pair = sides.len() == 2 && sides.iter().all(|side| opposite(*side as usize / 3) == opposite(t));
        let greatest = sides.iter().map(|side| angles[*side as usize / 3].0).fold(0.0, f64::max) / GREATEST_SHEAR;
        if is_pair { (1.0 - greatest * greatest).max(0.0) } else { 0.0 }
    };
    (0..triangles.len()).map(score).collect()
}

/// Replaces a value of each triangle by the mean over its nodes of the means over the triangles there.
fn average(values: &mut [f64], triangles: &[[u32; 3]], points: usize) {
    let mut at_nodes = vec![(0.0, 0.0); points];
    for (value, t) in values.iter().zip(triangles) {
        for &node in t {
            let (sum, count) = &mut at_nodes[node as usize];
            *sum += value;
            *count += 1.0;
        }
    }
    for (value, t) in values.iter_mut().zip(triangles) {
        *value = t.iter().map(|&node| at_nodes[node as usize]).map(|(sum, count)| sum / count).sum::<f64>() / 3.0;
    }
}

/// How far the sides at a corner are from being perpendicular: the projection of the longer one onto the shorter one,
/// over the shorter one. In a metric that makes both sides unit if they are perpendicular, it is the cosine between
/// them, to first order.
fn shear(corners: [DVec3; 3], corner: usize) -> f64 {
    let [e, f] = [1, 2].map(|k| corners[(corner + k) % 3] - corners[corner]);
    e.dot(f).abs() / e.length_squared().min(f.length_squared()).max(f64::MIN_POSITIVE)
}
