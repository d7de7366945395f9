//! T-joins (docs/algorithm.md, "The last resort", step 3): sets of dual edges of which every triangle has one or three.
//!
//! A perfect matching is one. Otherwise the triangles left over are paired by short paths J in the dual graph, over
//! edges of any kind, and the join is the symmetric difference of the matching and J. The paths run along a tree that
//! links the leftovers by nearly shortest connections (Voronoi cells of a breadth first search, then Kruskal), where an
//! edge of the tree is used exactly if it parts the leftovers into two odd numbers: so no edge is used twice, and all
//! is linear but for one sort.

use super::component::{Dual, NONE};
use super::matching::Matching;
use crate::core::kernel::DisjointSets;

/// The join as three bits a triangle: bit k says that its side k is in the join.
///
/// # Errors
/// A triangle of a component with an odd number of triangles: there is no join.
pub(super) fn t_join(dual: &Dual, matching: &Matching) -> Result<Vec<u8>, u32> {
    let triangles = dual.triangles.len() as u32;
    let mut join = vec![0_u8; triangles as usize];
    let mut left_over = Vec::new();
    for t in 0..triangles {
        match matching.mate(t) {
            Some(mate) => {
                let k = (0..3).find(|k| dual.neighbour(3 * t + k) == Some(mate));
                join[t as usize] = 1 << k.expect("partners share a side");
            }
            None => left_over.push(t),
        }
    }
    if left_over.is_empty() {
        return Ok(join);
    }
    let cells = Cells::around(dual, &left_over);
    for side in cells.odd_links(dual, &left_over)? {
        toggle(dual, &mut join, side);
        for mut t in [side / 3, dual.across[side as usize] / 3] {
            while cells.up[t as usize] != NONE {
                let up = cells.up[t as usize];
                toggle(dual, &mut join, up);
                t = dual.across[up as usize] / 3;
            }
        }
    }
    debug_assert!(join.iter().all(|sides| sides.count_ones() % 2 == 1));
    Ok(join)
}

fn toggle(dual: &Dual, join: &mut [u8], side: u32) {
    for side in [side, dual.across[side as usize]] {
        join[(side / 3) as usize] ^= 1 << (side % 3);
    }
}

/// For each triangle the leftover triangle nearest to it.
struct Cells {
    /// Place of the nearest leftover in the list of them; `NONE` in components without one.
    owner: Vec<u32>,
    /// The side over which the way to the owner goes; `NONE` at the owner itself.
    up: Vec<u32>,
    distance: Vec<u32>,
}

impl Cells {
    fn around(dual: &Dual, left_over: &[u32]) -> Cells {
        let n = dual.triangles.len();
        let mut cells = Cells { owner: vec![NONE; n], up: vec![NONE; n], distance: vec![0; n] };
        let mut queue = left_over.to_vec();
        for (place, &t) in (0..).zip(left_over) {
            cells.owner[t as usize] = place;
        }
        let mut next = 0;
        while let Some(&t) = queue.get(next) {
            next += 1;
            for side in 3 * t..3 * t + 3 {
                let Some(u) = dual.neighbour(side) else { continue };
                if cells.owner[u as usize] == NONE {
                    cells.owner[u as usize] = cells.owner[t as usize];
                    cells.up[u as usize] = dual.across[side as usize];
                    cells.distance[u as usize] = cells.distance[t as usize] + 1;
                    queue.push(u);
                }
            }
        }
        cells
    }

    /// Sides between cells that lie on a shortest tree of the leftovers and part them into two odd numbers.
    fn odd_links(&self, dual: &Dual, left_over: &[u32]) -> Result<Vec<u32>, u32> {
        let mut links = Vec::new();
        for side in 0..dual.across.len() as u32 {
            let across = dual.across[side as usize];
            if across == NONE || across < side {
                continue;
            }
            let (t, u) = ((side / 3) as usize, (across / 3) as usize);
            if self.owner[t] != self.owner[u] {
                links.push((self.distance[t] + self.distance[u], side));
            }
        }
        links.sort_unstable();
        // Kruskal's tree. Of its links each owner keeps the number and the exclusive or: enough to peel leaves off.
        let mut sets = DisjointSets::new(left_over.len());
        let mut degree = vec![0_u32; left_over.len()];
        let mut mixed = vec![0_u32; left_over.len()];
        let ends = |side: u32| [side, dual.across[side as usize]].map(|s| self.owner[(s / 3) as usize]);
        for (_, side) in links {
            let [a, b] = ends(side);
            if sets.find(a) != sets.find(b) {
                sets.join(a, b);
                for end in [a, b] {
                    degree[end as usize] += 1;
                    mixed[end as usize] ^= side;
                }
            }
        }
        let mut odd = vec![true; left_over.len()];
        let mut chosen = Vec::new();
        for first in 0..left_over.len() {
            let mut leaf = first;
            while degree[leaf] == 1 {
                let side = mixed[leaf];
                let [a, b] = ends(side);
                let rest = if a as usize == leaf { b as usize } else { a as usize };
                if odd[leaf] {
                    chosen.push(side);
                    odd[leaf] = false;
                    odd[rest] = !odd[rest];
                }
                degree[leaf] = 0;
                degree[rest] -= 1;
                mixed[rest] ^= side;
                if rest > first && degree[rest] == 1 {
                    // Its turn comes.
                    break;
                }
                leaf = rest;
            }
        }
        match odd.iter().position(|&odd| odd) {
            Some(owner) => Err(left_over[owner]),
            None => Ok(chosen),
        }
    }
}
