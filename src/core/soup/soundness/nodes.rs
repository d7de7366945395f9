//! Coincident nodes and hanging nodes.

use glam::DVec3;
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree};

use super::faces::Faces;
use super::sides::Sides;
use super::{Defect, Found};
use crate::core::kernel::box_tree::extent;

/// Nodes closer than this fraction of the mesh's diagonal coincide.
const COINCIDENT: f64 = 1e-9;
/// A node closer to an edge than this fraction of the edge's length hangs on it.
const ON_EDGE: f64 = 1e-7;

/// Notes coincident and hanging nodes. Returns for each node the first one at its position (usually itself).
pub fn examine(faces: &Faces, sides: &Sides, found: &mut Found) -> Vec<u32> {
    let mut nodes: Vec<u32> = (0..faces.nodes() as u32).filter(|&node| sides.used[node as usize]).collect();
    let (low, high) = extent(nodes.iter().map(|&node| faces.point(node)));
    let tolerance = COINCIDENT * low.distance(high);
    let mut spot: Vec<u32> = (0..faces.nodes() as u32).collect();
    let mut together = Vec::new();
    group(faces, &mut nodes, 0, 0, tolerance, &mut |group| {
        group.sort_unstable();
        for &node in group.iter() {
            spot[node as usize] = group[0];
        }
        together.extend_from_slice(group);
    });
    together.sort_unstable();
    for node in together {
        let defect = if sides.outer[node as usize] { Defect::SeamNode } else { Defect::CoincidentNode };
        found.note(defect, node as usize, faces.point(node));
    }
    hanging(faces, sides, &spot, found);
    spot
}

/// Calls `visit` with every group of coincident nodes. Sorts along one axis, splits at gaps, and recurses along the
/// next axis within each piece, until three axes in a row have not split it. Unlike rounding to a grid, this misses no
/// pair on opposite sides of a grid line.
fn group(
    faces: &Faces,
    nodes: &mut [u32],
    depth: usize,
    uncut: usize,
    tolerance: f64,
    visit: &mut dyn FnMut(&mut [u32]),
) {
    if nodes.len() < 2 {
        return;
    }
    // Only a staircase in steps of the tolerance, which is no mesh, would recurse this deeply.
    if uncut == 3 || depth == 300 {
        visit(nodes);
        return;
    }
    let axis = depth % 3;
    let at = |node: u32| faces.point(node)[axis];
    if !nodes.is_sorted_by(|&a, &b| at(a) <= at(b)) {
        // Keys beside the ids, so that the sort reads memory sequentially.
        let mut keyed: Vec<(f64, u32)> = nodes.iter().map(|&node| (at(node), node)).collect();
        keyed.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (node, key) in nodes.iter_mut().zip(keyed) {
            *node = key.1;
        }
    }
    let mut rest = nodes;
    let mut whole = true;
    loop {
        let cut = rest.windows(2).position(|pair| at(pair[1]) - at(pair[0]) > tolerance).map_or(rest.len(), |i| i + 1);
        let (piece, after) = rest.split_at_mut(cut);
        whole &= after.is_empty();
        group(faces, piece, depth + 1, if whole { uncut + 1 } else { 1 }, tolerance, visit);
        if after.is_empty() {
            return;
        }
        rest = after;
    }
}

/// Nodes of the boundary that lie strictly within another edge of the boundary.
fn hanging(faces: &Faces, sides: &Sides, spot: &[u32], found: &mut Found) {
    let mut nodes: Vec<u32> = sides.boundary.iter().map(|&h| spot[faces.ends(h).0 as usize]).collect();
    nodes.sort_unstable();
    nodes.dedup();
    let places = nodes.iter().map(|&node| GeomWithData::new(faces.point(node).to_array(), node)).collect();
    let tree: RTree<GeomWithData<[f64; 3], u32>> = RTree::bulk_load(places);
    let mut hanging = Vec::new();
    for &h in &sides.boundary {
        let (a, b) = faces.ends(h);
        let (p_a, p_b) = (faces.point(a), faces.point(b));
        let along = p_b - p_a;
        let length = along.length();
        let margin = DVec3::splat(ON_EDGE * length);
        let (low, high) = (p_a.min(p_b) - margin, p_a.max(p_b) + margin);
        for place in tree.locate_in_envelope(AABB::from_corners(low.to_array(), high.to_array())) {
            let node = place.data;
            if node == spot[a as usize] || node == spot[b as usize] {
                continue;
            }
            let p = faces.point(node) - p_a;
            let t = p.dot(along) / (length * length);
            if t > 1e-6 && t < 1.0 - 1e-6 && (p - t * along).length() < ON_EDGE * length {
                hanging.push(node);
            }
        }
    }
    hanging.sort_unstable();
    hanging.dedup();
    for node in hanging {
        found.note(Defect::HangingNode, node as usize, faces.point(node));
    }
}
