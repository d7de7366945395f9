//! Creases of meshes with noise, such as scans: folds of the surface itself, among folds that are noise
//! (docs/algorithm.md, "Features").
//!
//! Normals are smoothed in a way that keeps creases: the mean over the neighbours of each triangle, by how alike their
//! *guides* are; the guide of a triangle is the mean normal of the calmest neighbourhood with it in it, which lies on
//! one side of a crease (Zhang, Deng, Zhang, Bouaziz & Liu 2015).

use std::collections::BTreeMap;

use glam::DVec3;

use super::Feature;
use crate::core::discrete::edges::{Edges, Groups, Triangles};
use crate::core::kernel::DisjointSets;

/// Folds that end nowhere are noise if so many points are ends,
const LEAST_ENDS: usize = 12;
/// and if they are this share of all points with folds.
const SHARE_OF_ENDS: f64 = 0.1;
/// Rounds of smoothing.
const ROUNDS: usize = 12;
/// The difference of two guides (length of their difference) that counts as the same side of a crease.
const ALIKE: f64 = 0.35;
/// Creases go on where the fold is at least this part of the feature angle.
const WEAK: f64 = 0.5;
/// Branches of creases with fewer edges that end nowhere are none.
const LEAST_EDGES: usize = 6;
/// Smaller parts between creases are joined to a neighbour.
const LEAST_TRIANGLES: usize = 8;

/// Whether folds are noise: many of their chains end where nothing else goes on. `features` has the folds by their
/// angles alone.
pub(super) fn is_noisy(mesh: &Triangles, edges: &Edges, features: &[Option<Feature>]) -> bool {
    let mut degree = vec![0_u32; mesh.points.len()];
    let mut has_fold = vec![false; mesh.points.len()];
    for (edge, feature) in features.iter().enumerate().filter_map(|(edge, feature)| Some((edge, (*feature)?))) {
        for end in edges.get(edge).ends.map(|end| end as usize) {
            degree[end] += 1;
            has_fold[end] |= feature == Feature::Fold;
        }
    }
    let with_folds = has_fold.iter().filter(|has| **has).count();
    let ends = has_fold.iter().zip(&degree).filter(|(has, degree)| **has && **degree == 1).count();
    ends >= LEAST_ENDS && ends as f64 >= SHARE_OF_ENDS * with_folds as f64
}

/// Replaces folds by creases: chains of folds of the smoothed surface, each beyond `angle` (radians) at some edge.
pub(super) fn keep_creases(mesh: &Triangles, edges: &Edges, features: &mut [Option<Feature>], angle: f64) {
    let normals = smoothed(mesh, edges);
    let [strong, weak] = [angle, WEAK * angle].map(libm::cos);
    let cosine = |edge: usize| match *edges.get(edge).sides {
        [a, b] => normals[a as usize / 3].dot(normals[b as usize / 3]),
        _ => 1.0,
    };
    let mut is_strong = vec![false; edges.len()];
    for (edge, feature) in features.iter_mut().enumerate() {
        if feature.is_none_or(|kind| kind == Feature::Fold) {
            let cosine = cosine(edge);
            is_strong[edge] = cosine < strong;
            *feature = (cosine < weak).then_some(Feature::Fold);
        }
    }
    let mut creases = Creases::of(mesh, edges, features);
    creases.drop_weak(edges, features, &is_strong);
    creases.prune(edges, features);
    while creases.join_small_parts(mesh, edges, features) {
        creases.prune(edges, features);
    }
}

/// The features at each point.
struct Creases {
    at: Vec<Vec<u32>>,
}

impl Creases {
    fn of(mesh: &Triangles, edges: &Edges, features: &[Option<Feature>]) -> Creases {
        let mut at = vec![Vec::new(); mesh.points.len()];
        for edge in (0..edges.len()).filter(|&edge| features[edge].is_some()) {
            edges.get(edge).ends.iter().for_each(|&end| at[end as usize].push(edge as u32));
        }
        Creases { at }
    }

    fn remove(&mut self, edges: &Edges, features: &mut [Option<Feature>], edge: u32) {
        features[edge as usize] = None;
        for end in edges.get(edge as usize).ends {
            self.at[end as usize].retain(|&other| other != edge);
        }
    }

    /// Removes connected folds of which none is strong.
    fn drop_weak(&mut self, edges: &Edges, features: &mut [Option<Feature>], is_strong: &[bool]) {
        let mut seen = vec![false; edges.len()];
        for first in 0..edges.len() {
            if seen[first] || features[first] != Some(Feature::Fold) {
                continue;
            }
            seen[first] = true;
            let mut chain = vec![first as u32];
            let mut next = 0;
            while let Some(&edge) = chain.get(next) {
                next += 1;
                for &other in edges.get(edge as usize).ends.iter().flat_map(|&end| &self.at[end as usize]) {
                    if features[other as usize] == Some(Feature::Fold)
                        && !std::mem::replace(&mut seen[other as usize], true)
                    {
                        chain.push(other);
                    }
                }
            }
            if !chain.iter().any(|&edge| is_strong[edge as usize]) {
                chain.into_iter().for_each(|edge| self.remove(edges, features, edge));
            }
        }
    }

    /// Joins parts of few triangles to that neighbour across folds with which they share the most of these; returns
    /// whether there were any.
    fn join_small_parts(&mut self, mesh: &Triangles, edges: &Edges, features: &mut [Option<Feature>]) -> bool {
        let mut sets = DisjointSets::new(mesh.triangles.len());
        for edge in (0..edges.len()).filter(|&edge| features[edge].is_none()) {
            let sides = edges.get(edge).sides;
            sides.windows(2).for_each(|pair| sets.join(pair[0] / 3, pair[1] / 3));
        }
        let part: Vec<u32> = (0..mesh.triangles.len() as u32).map(|triangle| sets.find(triangle)).collect();
        let mut size = vec![0_usize; part.len()];
        part.iter().for_each(|&own| size[own as usize] += 1);
        // The folds between a small part and each neighbour; a fold is between two parts.
        let mut between: BTreeMap<u32, BTreeMap<u32, Vec<u32>>> = BTreeMap::new();
        for edge in (0..edges.len()).filter(|&edge| features[edge] == Some(Feature::Fold)) {
            if let [a, b] = *edges.get(edge).sides {
                let [a, b] = [a, b].map(|side| part[side as usize / 3]);
                for (own, other) in [(a, b), (b, a)] {
                    if a != b && size[own as usize] < LEAST_TRIANGLES {
                        between.entry(own).or_default().entry(other).or_default().push(edge as u32);
                    }
                }
            }
        }
        for neighbours in between.values() {
            let most = neighbours.values().max_by_key(|folds| folds.len());
            for &fold in
                most.into_iter().flatten().filter(|fold| features[**fold as usize].is_some()).collect::<Vec<_>>()
            {
                self.remove(edges, features, fold);
            }
        }
        !between.is_empty()
    }

    /// Removes short branches that end nowhere, until there are none.
    fn prune(&mut self, edges: &Edges, features: &mut [Option<Feature>]) {
        let mut ends: Vec<u32> =
            (0..self.at.len() as u32).filter(|&point| self.at[point as usize].len() == 1).collect();
        while let Some(end) = ends.pop() {
            let mut branch = Vec::new();
            let mut point = end;
            while let [edge] =
                self.at[point as usize].iter().filter(|edge| !branch.contains(*edge)).collect::<Vec<_>>()[..]
                && features[*edge as usize] == Some(Feature::Fold)
                && (branch.is_empty() || self.at[point as usize].len() == 2)
                && branch.len() < LEAST_EDGES
            {
                let edge = *edge;
                branch.push(edge);
                let ends = edges.get(edge as usize).ends;
                point = if ends[0] == point { ends[1] } else { ends[0] };
            }
            if branch.is_empty() || branch.len() >= LEAST_EDGES {
                continue;
            }
            branch.into_iter().for_each(|edge| self.remove(edges, features, edge));
            // Where it began, another branch may end now.
            if self.at[point as usize].len() == 1 {
                ends.push(point);
            }
        }
    }
}

/// Unit normals of the triangles, without noise.
fn smoothed(mesh: &Triangles, edges: &Edges) -> Vec<DVec3> {
    let count = mesh.triangles.len();
    let vectors: Vec<DVec3> = (0..count).map(|triangle| mesh.area_vector(triangle)).collect();
    let area: Vec<f64> = vectors.iter().map(|vector| vector.length()).collect();
    let mut normals: Vec<DVec3> = vectors.iter().map(|vector| vector.normalize_or_zero()).collect();
    let centre: Vec<DVec3> = (0..count).map(|triangle| mesh.corners(triangle).iter().sum::<DVec3>() / 3.0).collect();
    // The triangles at the corners of each, with itself.
    let at_point =
        Groups::of(3 * count, mesh.points.len(), |corner| mesh.triangles[corner as usize / 3][corner as usize % 3]);
    let (mut near, mut start) = (Vec::with_capacity(13 * count), vec![0]);
    for corners in &mesh.triangles {
        let from = near.len();
        near.extend(corners.iter().flat_map(|&point| at_point.get(point)).map(|corner| corner / 3));
        near[from..].sort_unstable();
        let mut last = None;
        let mut kept = from;
        for k in from..near.len() {
            if last.replace(near[k]) != Some(near[k]) {
                near[kept] = near[k];
                kept += 1;
            }
        }
        near.truncate(kept);
        start.push(near.len());
    }
    let near = |triangle: usize| near[start[triangle]..start[triangle + 1]].iter().map(|&other| other as usize);
    let (mut far, mut pairs) = (0.0, 0);
    for edge in 0..edges.len() {
        if let [a, b] = *edges.get(edge).sides {
            far += centre[a as usize / 3].distance(centre[b as usize / 3]);
            pairs += 1;
        }
    }
    let far = far / f64::from(pairs.max(1));
    for _ in 0..ROUNDS {
        // The mean normal of each neighbourhood, and how much its normals differ from it.
        let calm: Vec<(DVec3, f64)> = (0..count)
            .map(|triangle| {
                let mean = near(triangle).map(|other| area[other] * normals[other]).sum::<DVec3>().normalize_or_zero();
                let whole: f64 = near(triangle).map(|other| area[other]).sum();
                let apart = |other: usize| area[other] * normals[other].distance_squared(mean);
                (mean, near(triangle).map(apart).sum::<f64>() / whole.max(f64::MIN_POSITIVE))
            })
            .collect();
        let guide = |triangle: usize| {
            let calmest = near(triangle).min_by(|&a, &b| calm[a].1.total_cmp(&calm[b].1));
            calmest.map_or(normals[triangle], |calmest| calm[calmest].0)
        };
        let guides: Vec<DVec3> = (0..count).map(guide).collect();
        let mean = |triangle: usize| {
            let weight = |other: usize| {
                let apart = centre[triangle].distance_squared(centre[other]) / (2.0 * far * far);
                let unlike = guides[triangle].distance_squared(guides[other]) / (2.0 * ALIKE * ALIKE);
                area[other] * libm::exp(-apart - unlike)
            };
            near(triangle).map(|other| weight(other) * normals[other]).sum::<DVec3>().normalize_or_zero()
        };
        normals = (0..count).map(mean).collect();
    }
    normals
}

#[cfg(test)]
mod tests {
    use super::super::{ANGLE, features};
    use super::*;
    use crate::core::discrete::fixtures::{cube, sphere, tube};

    /// The mesh with points moved at random, up to `noise`, along no particular direction.
    fn noisy(mut mesh: Triangles, noise: f64, seed: u64) -> Triangles {
        let mut state = seed;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        for p in &mut mesh.points {
            *p += noise * DVec3::new(random(), random(), random());
        }
        mesh
    }

    fn plain(mesh: &Triangles, edges: &Edges) -> Vec<bool> {
        let fold = |edge: usize| match *edges.get(edge).sides {
            [a, b] => {
                let [n, m] = [a, b].map(|side| mesh.area_vector(side as usize / 3).normalize());
                n.dot(m) < libm::cos(ANGLE)
            }
            _ => false,
        };
        (0..edges.len()).map(fold).collect()
    }

    /// The triangles of each part between features, by the side of the cube on which they are most, and the number of
    /// points where a feature ends.
    fn parts_and_ends(mesh: &Triangles, clean: &Triangles, edges: &Edges) -> (Vec<(usize, usize)>, usize) {
        let found = features(mesh, edges, ANGLE);
        let mut sets = DisjointSets::new(mesh.triangles.len());
        let mut degree = vec![0; mesh.points.len()];
        for edge in 0..edges.len() {
            match (found[edge], edges.get(edge).sides) {
                (None, &[a, b]) => sets.join(a / 3, b / 3),
                _ => edges.get(edge).ends.iter().for_each(|&end| degree[end as usize] += 1),
            }
        }
        let mut parts: BTreeMap<u32, [usize; 6]> = BTreeMap::new();
        for triangle in 0..mesh.triangles.len() {
            let n = clean.area_vector(triangle).normalize().to_array();
            let side = (0..6).find(|side| (n[side % 3] - if *side < 3 { 1.0 } else { -1.0 }).abs() < 1e-9).unwrap();
            parts.entry(sets.find(triangle as u32)).or_default()[side] += 1;
        }
        let most = |sides: &[usize; 6]| (sides.iter().sum(), *sides.iter().max().unwrap());
        (parts.values().map(most).collect(), degree.iter().filter(|degree| **degree == 1).count())
    }

    #[test]
    fn a_cube_with_noise_keeps_its_twelve_edges_and_no_other_folds() {
        let clean = cube(16);
        let edges = Edges::of(&clean.triangles);
        let expected = plain(&clean, &edges);
        for (seed, noise) in [(1, 0.003), (2, 0.015), (3, 0.015), (4, 0.015), (5, 0.018)] {
            let mesh = noisy(clean.clone(), noise, seed);
            let raw = plain(&mesh, &edges);
            if noise < 0.005 {
                let found: Vec<bool> = features(&mesh, &edges, ANGLE).iter().map(|kind| kind.is_some()).collect();
                assert_eq!((&found, &raw), (&expected, &expected));
                continue;
            }
            assert!((0..raw.len()).filter(|&edge| raw[edge] && !expected[edge]).count() > 10, "{noise}");
            let (parts, ends) = parts_and_ends(&mesh, &clean, &edges);
            assert_eq!((parts.len(), ends), (6, 0), "{noise}: {parts:?}");
            // A crease may go around a triangle of the other side.
            for (all, of_side) in parts {
                assert!(all - of_side <= 12 && of_side >= 500, "{noise}: {of_side} of {all}");
            }
        }
    }

    #[test]
    fn a_sphere_and_a_tube_with_noise_have_no_folds() {
        for (mesh, noise) in
            [(sphere(16), 0.03), (sphere(16), 0.05), (tube(60, 20, 3.0), 0.02), (tube(60, 20, 3.0), 0.03)]
        {
            let mesh = noisy(mesh, noise, 5);
            let edges = Edges::of(&mesh.triangles);
            let given = plain(&mesh, &edges).iter().filter(|fold| **fold).count();
            let found = features(&mesh, &edges, ANGLE).iter().filter(|kind| **kind == Some(Feature::Fold)).count();
            assert!(given > 10 && found == 0, "{noise}: {found} of {given}");
        }
    }
}
