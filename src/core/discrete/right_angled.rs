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
/// right-angled. Delaunay, frontal and anisotropic meshes have mean scores of 0.00-0.10, and up to 0.5 in places;
/// grids have 1, beside their edge at least 0.65.
const AGREEMENT: [f64; 2] = [0.5, 0.65];

/// The right angle of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RightAngle {
    /// Its corner, 0 to 2: the legs are the sides that meet there.
    pub corner: usize,
    /// How much the triangle counts as right-angled: 1 in a cut grid, between 0 and 1 at its edge.
    pub weight: f64,
}

/// The right angle of each triangle that counts as right-angled. A triangle scores if its neighbour across the side
/// opposite to its right angle has its own right angle opposite to that side too; the score of the pair is
/// `1 - (s / 0.4)^2` with its greater shear `s`. The mean score at each node, then over the nodes of each triangle,
/// gives the weight.
pub fn right_angles(points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<Option<RightAngle>> {
    let least = |t: &[u32; 3]| {
        let corners = t.map(|k| points[k as usize]);
        let at = |corner: usize| (shear(corners, corner), corner);
        (1..3).map(at).fold(at(0), |least, other| if other.0 < least.0 { other } else { least })
    };
    let angles: Vec<(f64, usize)> = triangles.iter().map(least).collect();
    let edges = Edges::of(triangles);
    let opposite = |t: usize| edges.of_side(3 * t as Corner + (angles[t].1 as Corner + 1) % 3);
    let score = |t: usize| {
        let sides = edges.get(opposite(t)).sides;
        let is_pair = sides.len() == 2 && sides.iter().all(|side| opposite(*side as usize / 3) == opposite(t));
        let greatest = sides.iter().map(|side| angles[*side as usize / 3].0).fold(0.0, f64::max);
        if is_pair { (1.0 - (greatest / GREATEST_SHEAR) * (greatest / GREATEST_SHEAR)).max(0.0) } else { 0.0 }
    };
    let mut at_nodes = vec![(0.0, 0.0); points.len()];
    for (t, nodes) in triangles.iter().enumerate() {
        let score = score(t);
        for &node in nodes {
            let (sum, count) = &mut at_nodes[node as usize];
            *sum += score;
            *count += 1.0;
        }
    }
    let weight = |t: &[u32; 3]| {
        let mean = t.iter().map(|&node| at_nodes[node as usize]).map(|(sum, count)| sum / count).sum::<f64>() / 3.0;
        let x = ((mean - AGREEMENT[0]) / (AGREEMENT[1] - AGREEMENT[0])).clamp(0.0, 1.0);
        x * x * (3.0 - 2.0 * x)
    };
    let found = |(t, &(shear, corner)): (&[u32; 3], &(f64, usize))| {
        let weight = if shear < GREATEST_SHEAR { weight(t) } else { 0.0 };
        (weight > 0.0).then_some(RightAngle { corner, weight })
    };
    triangles.iter().zip(&angles).map(found).collect()
}

/// How far the sides at a corner are from being perpendicular: the projection of the longer one onto the shorter one,
/// over the shorter one. In a metric that makes both sides unit if they are perpendicular, it is the cosine between
/// them, to first order.
fn shear(corners: [DVec3; 3], corner: usize) -> f64 {
    let [e, f] = [1, 2].map(|k| corners[(corner + k) % 3] - corners[corner]);
    e.dot(f).abs() / e.length_squared().min(f.length_squared()).max(f64::MIN_POSITIVE)
}
