//! Creases of noisy pieces (docs/algorithm.md, "Noise"): folds of smoothed normals, by a strong and a weak angle,
//! without those around a few triangles and those that are short and end somewhere inside.

use std::collections::{BTreeMap, VecDeque};

use super::edges::{Edges, Groups, Triangles};
use super::noise::{Noise, agreeing};
use crate::core::kernel::DisjointSets;

/// The weak angle, as a part of the strong one.
const WEAK: f64 = 0.5;
/// Fewer triangles than this are no part of a surface with creases around it.
const LEAST_TRIANGLES: u32 = 8;
/// A crease with a free end is at least this many mean edge lengths long.
const LEAST_LENGTH: f64 = 4.0;

/// Whether each edge inside a noisy piece is a crease, among features that are `kept`; `angle` is the strong angle
/// (radians).
pub(super) fn creases(mesh: &Triangles, edges: &Edges, noise: &Noise, angle: f64, kept: &[bool]) -> Vec<bool> {
    let [strong, weak] = [angle, WEAK * angle].map(libm::cos);
    let mut wanted = Vec::new();
    for e in (0..edges.len()).filter(|&e| !kept[e]) {
        let Some(sides) = agreeing(mesh, &edges.get(e)).filter(|[one, _]| noise.noisy[*one]) else { continue };
        if let Some(cosine) = noise.cosine(sides).filter(|cosine| *cosine < weak) {
            wanted.push((e, cosine < strong));
        }
    }
    let own = strong_ones(mesh, edges, &wanted);
    let mut found = kept.to_vec();
    own.iter().for_each(|&e| found[e] = true);
    join_small_parts(mesh, edges, &own, &mut found);
    drop_short(mesh, edges, &own, &mut found);
    found.iter_mut().zip(kept).for_each(|(found, kept)| *found &= !kept);
    found
}

/// The strong folds among these, and the weak ones that others join to a strong one.
fn strong_ones(mesh: &Triangles, edges: &Edges, wanted: &[(usize, bool)]) -> Vec<usize> {
    let mut joined = DisjointSets::new(mesh.points.len());
    for (e, _) in wanted {
        let [a, b] = edges.get(*e).ends;
        joined.join(a, b);
    }
    let mut has_strong = vec![false; mesh.points.len()];
    for (e, _) in wanted.iter().filter(|(_, strong)| *strong) {
        has_strong[joined.find(edges.get(*e).ends[0]) as usize] = true;
    }
    let mut is_joined = |e: &usize| has_strong[joined.find(edges.get(*e).ends[0]) as usize];
    wanted.iter().map(|(e, _)| *e).filter(|e| is_joined(e)).collect()
}

/// Joins parts of a few triangles to the neighbour with which they have the longest crease; `own` are the folds that
/// may be dropped.
fn join_small_parts(mesh: &Triangles, edges: &Edges, own: &[usize], found: &mut [bool]) {
    let mut parts = DisjointSets::new(mesh.triangles.len());
    for (e, _) in found.iter().enumerate().filter(|(_, found)| !**found) {
        if let Some([one, other]) = agreeing(mesh, &edges.get(e)) {
            parts.join(one as u32, other as u32);
        }
    }
    loop {
        let mut size = vec![0_u32; mesh.triangles.len()];
        (0..mesh.triangles.len() as u32).for_each(|t| size[parts.find(t) as usize] += 1);
        // The length of the crease of each small part with each neighbour.
        let mut beside: BTreeMap<u32, BTreeMap<u32, f64>> = BTreeMap::new();
        for &e in own {
            let edge = edges.get(e);
            let Some(sides) = agreeing(mesh, &edge) else { continue };
            let [one, other] = sides.map(|t| parts.find(t as u32));
            let [a, b] = edge.ends.map(|end| mesh.points[end as usize]);
            for (part, neighbour) in [(one, other), (other, one)] {
                if one != other && size[part as usize] < LEAST_TRIANGLES {
                    *beside.entry(part).or_default().entry(neighbour).or_default() += a.distance(b);
                }
            }
        }
        if beside.is_empty() {
            break;
        }
        // Each join leaves a part less, so this ends; the same pair is met from both sides.
        for (part, neighbours) in beside {
            let longest = neighbours.iter().max_by(|a, b| a.1.total_cmp(b.1).then(b.0.cmp(a.0)));
            longest.into_iter().for_each(|(neighbour, _)| parts.join(part, *neighbour));
        }
    }
    for &e in own {
        if let Some(sides) = agreeing(mesh, &edges.get(e)) {
            let [one, other] = sides.map(|t| parts.find(t as u32));
            if one == other {
                found[e] = false;
            }
        }
    }
}

/// Drops creases that begin at a free end and are short: up to where they branch, meet another feature, or end.
fn drop_short(mesh: &Triangles, edges: &Edges, own: &[usize], found: &mut [bool]) {
    let mut is_own = vec![false; edges.len()];
    own.iter().for_each(|&e| is_own[e] = true);
    let ends: Vec<u32> = (0..edges.len()).flat_map(|e| edges.get(e).ends).collect();
    let at = Groups::of(ends.len(), mesh.points.len(), |end| ends[end as usize]);
    let length = |e: usize| {
        let [a, b] = edges.get(e).ends.map(|end| mesh.points[end as usize]);
        a.distance(b)
    };
    let features = |point: u32, found: &[bool]| -> Vec<usize> {
        at.get(point).iter().map(|end| *end as usize / 2).filter(|&e| found[e]).collect()
    };
    let mut waiting: VecDeque<u32> = (0..mesh.points.len() as u32).collect();
    while let Some(start) = waiting.pop_front() {
        let mut point = start;
        let (mut chain, mut total, mut around, mut edges_around) = (Vec::new(), 0.0, 0.0, 0);
        let mut next = match features(start, found)[..] {
            [only] if is_own[only] => Some(only),
            _ => None,
        };
        while let Some(e) = next {
            let [a, b] = edges.get(e).ends;
            chain.push(e);
            total += length(e);
            for end in at.get(point) {
                around += length(*end as usize / 2);
                edges_around += 1;
            }
            if total * f64::from(edges_around) >= LEAST_LENGTH * around {
                break;
            }
            point = if a == point { b } else { a };
            next = match features(point, found)[..] {
                [one, other] if is_own[one] && is_own[other] => Some(if one == e { other } else { one }),
                _ => None,
            };
        }
        if !chain.is_empty() && total * f64::from(edges_around) < LEAST_LENGTH * around {
            chain.iter().for_each(|&e| found[e] = false);
            // Where it branched there may be a free end now.
            waiting.push_back(point);
        }
    }
}
