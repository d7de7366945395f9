//! Noise of a surface, told apart from creases (docs/algorithm.md, "Noise"): pieces whose small folds cancel, and the
//! normals of their triangles, smoothed so that creases stay sharp (Fleishman, Drori & Cohen-Or 2003; Zheng et al.
//! 2011).

use glam::DVec3;

use super::edges::{Edge, Edges, Groups, Triangles};
use crate::core::fault::Fault;
use crate::core::kernel::DisjointSets;
use crate::core::kernel::Metric3;
use crate::core::progress::Cancel;

/// A piece is noisy if less than this part of its folds is left in their sum over a neighbourhood,
const MOST_LEFT: f64 = 0.42;
/// and they are at least this large on average (radians).
const LEAST_FOLD: f64 = 5.0 / 180.0 * std::f64::consts::PI;
/// Larger folds are not summed: they may be creases,
const SMALL: f64 = 40.0 / 180.0 * std::f64::consts::PI;
/// unless more than this part of all edges are: then nothing tells creases from noise, and all are kept.
const MOST_FOLDED: f64 = 1.0 / 3.0;
/// Pieces with fewer edges than this are too small to tell.
const LEAST_EDGES: u32 = 200;
/// Rounds of smoothing.
const ROUNDS: usize = 20;
/// Normals count less the farther they are apart; at this distance of their tips 0.61 as much.
const ALIKE: f64 = 0.42;
/// Triangles between two looks at the cancel.
const BATCH: usize = 1 << 14;

/// A surface with noisy pieces.
#[derive(Clone, Debug)]
pub struct Noise {
    /// Whether each triangle is in a noisy piece.
    pub noisy: Vec<bool>,
    /// The unit normal of each triangle, smoothed in noisy pieces; zero for degenerate triangles.
    pub normal: Vec<DVec3>,
}

/// The sums of folds around a point.
#[derive(Clone, Copy, Default)]
struct Folds {
    /// Angle times length times direction twice: the curvature tensor times the area (xx, xy, xz, yy, yz, zz).
    signed: [f64; 6],
    /// The same without signs and directions.
    unsigned: f64,
}

impl Folds {
    fn add(&mut self, other: &Folds) {
        self.signed.iter_mut().zip(other.signed).for_each(|(sum, part)| *sum += part);
        self.unsigned += other.unsigned;
    }
}

/// What decides whether a piece is noisy.
#[derive(Clone, Copy, Default)]
struct Census {
    edges: u32,
    /// Those with small folds.
    small: u32,
    /// Sum of the angles of its folds, each times its length, and of the lengths.
    turned: [f64; 2],
    /// What is left of folds over neighbourhoods, and all of it.
    left: [f64; 2],
}

impl Census {
    fn is_noisy(&self) -> bool {
        let ([turned, long], [left, all]) = (self.turned, self.left);
        let folded = f64::from(self.edges - self.small);
        self.small >= LEAST_EDGES
            && folded <= MOST_FOLDED * f64::from(self.edges)
            && turned >= LEAST_FOLD * long
            && left < MOST_LEFT * all
    }
}

impl Noise {
    /// Finds the noisy pieces of a surface and smooths their normals; `None` without any.
    ///
    /// # Errors
    /// [`Fault::stopped`].
    pub fn of(mesh: &Triangles, edges: &Edges, cancel: &Cancel) -> Result<Option<Noise>, Fault> {
        let noisy = noisy(mesh, edges);
        cancel.check()?;
        if !noisy.contains(&true) {
            return Ok(None);
        }
        let normal = smoothed(mesh, &noisy, cancel)?;
        Ok(Some(Noise { noisy, normal }))
    }

    /// Whether an edge is inside a noisy piece, or on its border.
    pub fn is_inside(&self, edge: Edge<'_>) -> bool {
        edge.sides.first().is_some_and(|side| self.noisy[*side as usize / 3])
    }

    /// The cosine of the fold between two triangles; `None` for a degenerate one.
    pub fn cosine(&self, [one, other]: [usize; 2]) -> Option<f64> {
        let [n, m] = [one, other].map(|triangle| self.normal[triangle]);
        (n != DVec3::ZERO && m != DVec3::ZERO).then(|| n.dot(m))
    }

    /// The angle by which the surface turns between two triangles of a noisy piece (radians); `None` elsewhere.
    pub fn turn(&self, sides: [usize; 2]) -> Option<f64> {
        if !self.noisy[sides[0]] {
            return None;
        }
        let [n, m] = sides.map(|triangle| self.normal[triangle]);
        Some(libm::atan2(n.cross(m).length(), n.dot(m)))
    }
}

/// The two triangles of an edge between triangles that agree on which side is outside.
pub(super) fn agreeing(mesh: &Triangles, edge: &Edge<'_>) -> Option<[usize; 2]> {
    let &[a, b] = edge.sides else { return None };
    (mesh.side(a) != mesh.side(b)).then(|| [a, b].map(|corner| corner as usize / 3))
}

/// Whether each triangle is in a noisy piece. On a smooth surface the folds around a point add up: each is the
/// curvature across its edge. Those of noise have either sign, and little is left of their sum. Creases do not count.
fn noisy(mesh: &Triangles, edges: &Edges) -> Vec<bool> {
    let mut pieces = DisjointSets::new(mesh.triangles.len());
    let (mut small, mut inner) = (Vec::new(), Vec::new());
    for edge in (0..edges.len()).map(|edge| edges.get(edge)) {
        let Some([one, other]) = agreeing(mesh, &edge) else { continue };
        pieces.join(one as u32, other as u32);
        inner.push(one as u32);
        let (n, m) = (mesh.area_vector(one), mesh.area_vector(other));
        let [a, b] = mesh.side(edge.sides[0]).map(|k| mesh.points[k as usize]);
        let long = a.distance(b);
        let across = n.cross(m).dot(b - a) / long.max(f64::MIN_POSITIVE);
        let turn = libm::atan2(across, n.dot(m));
        if turn.abs() <= SMALL {
            small.push((edge.ends, one as u32, turn, long, (b - a) / long.max(f64::MIN_POSITIVE)));
        }
    }
    let mut census = vec![Census::default(); mesh.triangles.len()];
    let mut around = vec![Folds::default(); mesh.points.len()];
    inner.iter().for_each(|&one| census[pieces.find(one) as usize].edges += 1);
    for (ends, one, turn, long, d) in &small {
        let piece = &mut census[pieces.find(*one) as usize];
        piece.small += 1;
        piece.turned[0] += turn.abs() * long;
        piece.turned[1] += long;
        let weight = turn * long;
        let signed = [d.x * d.x, d.x * d.y, d.x * d.z, d.y * d.y, d.y * d.z, d.z * d.z].map(|part| weight * part);
        let folds = Folds { signed, unsigned: weight.abs() };
        ends.iter().for_each(|&end| around[end as usize].add(&folds));
    }
    let mut wide = around.clone();
    for ([a, b], ..) in &small {
        wide[*a as usize].add(&around[*b as usize]);
        wide[*b as usize].add(&around[*a as usize]);
    }
    let mut seen = vec![false; mesh.points.len()];
    for (t, nodes) in mesh.triangles.iter().enumerate() {
        let piece = pieces.find(t as u32) as usize;
        for &node in nodes {
            if !std::mem::replace(&mut seen[node as usize], true) {
                let Folds { signed: [xx, xy, xz, yy, yz, zz], unsigned } = wide[node as usize];
                let (values, _) = Metric3 { xx, xy, xz, yy, yz, zz }.eigen();
                census[piece].left[0] += values.iter().map(|value| value.abs()).sum::<f64>();
                census[piece].left[1] += unsigned;
            }
        }
    }
    (0..mesh.triangles.len()).map(|t| census[pieces.find(t as u32) as usize].is_noisy()).collect()
}

/// The normals of all triangles, those of noisy pieces smoothed: each becomes the mean of those around its corners, by
/// area and by how much they are alike.
fn smoothed(mesh: &Triangles, noisy: &[bool], cancel: &Cancel) -> Result<Vec<DVec3>, Fault> {
    let corners = mesh.triangles.as_flattened();
    let at = Groups::of(corners.len(), mesh.points.len(), |corner| corners[corner as usize]);
    let vectors: Vec<DVec3> = (0..mesh.triangles.len()).map(|t| mesh.area_vector(t)).collect();
    let area: Vec<f64> = vectors.iter().map(|vector| vector.length()).collect();
    let mut normal: Vec<DVec3> = vectors.iter().map(|vector| vector.normalize_or_zero()).collect();
    for _ in 0..ROUNDS {
        let before = normal.clone();
        for (t, nodes) in mesh.triangles.iter().enumerate().filter(|(t, _)| noisy[*t]) {
            if t % BATCH == 0 {
                cancel.check()?;
            }
            let own = before[t];
            let mut sum = own * area[t];
            // A triangle beyond a side is met at both of its ends, and counts twice.
            for &corner in nodes.iter().flat_map(|&node| at.get(node)) {
                let other = corner as usize / 3;
                if other != t && noisy[other] {
                    let apart = own.distance_squared(before[other]) / (2.0 * ALIKE * ALIKE);
                    sum += before[other] * (area[other] * libm::exp(-apart));
                }
            }
            normal[t] = sum.try_normalize().unwrap_or(own);
        }
        cancel.check()?;
    }
    Ok(normal)
}
