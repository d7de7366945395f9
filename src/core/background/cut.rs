//! Cutting of triangles along all fixed lines: boundaries between regions, cracks and repeated lines. A node becomes
//! one node for each fan of triangles around it; its point is doubled across cracks and at pinched nodes, since a
//! manifold mesh has one fan per node.

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

use crate::core::kernel::DisjointSets;
use crate::core::mesh::order::grouped;
use crate::core::mesh::{PointId, TriangleSet};

/// The kind of a line inside a region along which the triangles are cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cut {
    /// The two sides get separate points, except at inner ends.
    Crack,
    /// The two sides share their points.
    Repeated,
}

/// Triangles after cutting.
#[derive(Clone, Debug)]
pub struct CutMesh {
    /// The triangles with their new nodes, in the given order.
    pub set: TriangleSet,
    /// The given node that each new one is a copy of.
    pub origin: Vec<u32>,
    /// Sides of triangles without a neighbour, directed with the triangle on the left, in the order of the triangles.
    pub sides: Vec<[u32; 2]>,
}

/// A side of a triangle: its nodes in ascending order, and `3 * triangle + corner` with the corner at which it starts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Side {
    /// The lower node.
    pub low: u32,
    /// The higher node.
    pub high: u32,
    /// `3 * triangle + corner`.
    pub corner: u32,
}

impl Side {
    /// Its nodes in ascending order.
    pub fn ends(&self) -> (u32, u32) {
        (self.low, self.high)
    }

    /// Its triangle.
    pub fn triangle(&self) -> usize {
        self.corner as usize / 3
    }
}

/// All sides of the triangles, sorted, so that those between the same two nodes are consecutive. Linear time, except
/// for hubs.
pub fn sorted_sides(nodes: usize, triangles: &[[u32; 3]]) -> Vec<Side> {
    let side = |corner: u32| {
        let t = &triangles[corner as usize / 3];
        let (a, b) = (t[corner as usize % 3], t[(corner as usize + 1) % 3]);
        Side { low: a.min(b), high: a.max(b), corner }
    };
    let sides: Vec<Side> = (0..3 * triangles.len() as u32).map(side).collect();
    let mut sorted = grouped(nodes, &sides, |side| side.low);
    sorted.chunk_by_mut(|a, b| a.low == b.low).for_each(<[_]>::sort_unstable);
    sorted
}

/// Cuts triangles between regions, along `lines` (edges in either direction), and at pinched nodes, where fans of
/// triangles meet only in a point. Nodes without triangles are dropped; new nodes have the order of the given ones.
///
/// The triangles must be anticlockwise, and no side may belong to more than two triangles.
pub fn cut(uv: &[DVec2], triangles: Vec<[u32; 3]>, region: Vec<u32>, lines: &[([u32; 2], Cut)]) -> CutMesh {
    let lines: FxHashMap<(u32, u32), Cut> = lines.iter().map(|&([a, b], cut)| ((a.min(b), a.max(b)), cut)).collect();
    let next = |c: u32| if c % 3 == 2 { c - 2 } else { c + 1 };
    let corners = 3 * triangles.len();
    let node_of = |c: u32| triangles[c as usize / 3][c as usize % 3];
    let (mut fans, mut sectors) = (DisjointSets::new(corners), DisjointSets::new(corners));
    let mut joined = vec![false; corners];
    for pair in sorted_sides(uv.len(), &triangles).chunk_by(|a, b| a.ends() == b.ends()) {
        let [a, b] = pair else { continue };
        let line = if lines.is_empty() { None } else { lines.get(&a.ends()) };
        // The corners of the two triangles at the same node.
        let facing = [(a.corner, next(b.corner)), (next(a.corner), b.corner)];
        if line != Some(&Cut::Crack) {
            facing.iter().for_each(|&(c, d)| sectors.join(c, d));
        }
        if line.is_none() && region[a.triangle()] == region[b.triangle()] {
            facing.iter().for_each(|&(c, d)| fans.join(c, d));
            joined[a.corner as usize] = true;
            joined[b.corner as usize] = true;
        }
    }
    let by_node = grouped(uv.len(), &(0..corners as u32).collect::<Vec<_>>(), |&c| node_of(c));
    const NONE: u32 = u32::MAX;
    let (mut node_of_fan, mut point_of_sector) = (vec![NONE; corners], vec![NONE; corners]);
    let mut set = TriangleSet { triangles: vec![[0; 3]; triangles.len()], region, ..TriangleSet::default() };
    let mut origin = Vec::with_capacity(uv.len());
    let mut points = 0;
    for group in by_node.chunk_by(|&c, &d| node_of(c) == node_of(d)) {
        let node = node_of(group[0]);
        for &c in group {
            let fan = fans.find(c) as usize;
            if node_of_fan[fan] == NONE {
                node_of_fan[fan] = set.uv.len() as u32;
                set.uv.push(uv[node as usize]);
                origin.push(node);
                // Fans that meet along an edge, between regions or repeated, share a point.
                let point = &mut point_of_sector[sectors.find(c) as usize];
                if *point == NONE {
                    *point = points;
                    points += 1;
                }
                set.point.push(PointId(*point));
            }
            set.triangles[c as usize / 3][c as usize % 3] = node_of_fan[fan];
        }
    }
    let sides = (0..corners)
        .filter(|&c| !joined[c])
        .map(|c| [set.triangles[c / 3][c % 3], set.triangles[c / 3][(c + 1) % 3]])
        .collect();
    CutMesh { set, origin, sides }
}

impl CutMesh {
    /// Gives nodes at the same point in space one output point; for each original node, `joined` is the first one at
    /// the same point, and `xyz` that point. Only images of one curve are joined, so that cracks remain open.
    pub fn join_in_space(&mut self, joined: &[u32], xyz: &[DVec3]) {
        let points = self.set.point.iter().map(|p| p.index() + 1).max().unwrap_or(0);
        let mut images = vec![0_u32; joined.len()];
        joined.iter().for_each(|&first| images[first as usize] += 1);
        let mut sets = DisjointSets::new(points);
        let mut point_at: Vec<Option<u32>> = vec![None; joined.len()];
        for (node, &origin) in self.origin.iter().enumerate() {
            let first = joined[origin as usize] as usize;
            if images[first] > 1 {
                let point = self.set.point[node].0;
                match point_at[first] {
                    Some(other) => sets.join(other, point),
                    None => point_at[first] = Some(point),
                }
            }
        }
        // Renumbered in the order of the nodes.
        let mut new = vec![None; points];
        self.set.xyz.clear();
        for (node, &origin) in self.origin.iter().enumerate() {
            let old = sets.find(self.set.point[node].0) as usize;
            let number = *new[old].get_or_insert_with(|| {
                self.set.xyz.push(xyz[origin as usize]);
                self.set.xyz.len() as u32 - 1
            });
            self.set.point[node] = PointId(number);
        }
    }

    /// The boundary loops, each as its nodes in order with the triangles on the left. Every node has one fan, and so
    /// starts at most one side.
    pub fn loops(&self) -> Vec<Vec<u32>> {
        const NONE: u32 = u32::MAX;
        let mut next = vec![NONE; self.set.uv.len()];
        for &[a, b] in &self.sides {
            assert_eq!(next[a as usize], NONE, "a node has one fan");
            next[a as usize] = b;
        }
        let mut loops = Vec::new();
        for &[start, _] in &self.sides {
            let (mut nodes, mut at) = (Vec::new(), start);
            while next[at as usize] != NONE {
                nodes.push(at);
                at = std::mem::replace(&mut next[at as usize], NONE);
            }
            if !nodes.is_empty() {
                debug_assert_eq!(at, start, "a boundary is closed");
                loops.push(nodes);
            }
        }
        loops
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of four triangles around its centre, node 4.
    fn star() -> (Vec<DVec2>, Vec<[u32; 3]>) {
        let uv = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.5, 0.5)].map(DVec2::from).to_vec();
        (uv, vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    }

    fn counts(mesh: &CutMesh) -> (usize, usize, Vec<usize>) {
        let points = mesh.set.point.iter().map(|p| p.0 + 1).max().unwrap_or(0) as usize;
        (mesh.set.uv.len(), points, mesh.loops().iter().map(Vec::len).collect())
    }

    #[test]
    fn without_lines_nothing_is_cut() {
        let (uv, triangles) = star();
        let mesh = cut(&uv, triangles.clone(), vec![0; 4], &[]);
        assert_eq!(mesh.set.triangles, triangles);
        assert_eq!(counts(&mesh), (5, 5, vec![4]));
    }

    #[test]
    fn a_crack_from_the_border_opens_there_and_not_at_its_tip() {
        let (uv, triangles) = star();
        let mesh = cut(&uv, triangles, vec![0; 4], &[([4, 0], Cut::Crack)]);
        assert_eq!(counts(&mesh), (6, 6, vec![6]));
        assert_eq!(mesh.origin, [0, 0, 1, 2, 3, 4]);
    }

    #[test]
    fn a_repeated_line_keeps_its_points() {
        let (uv, triangles) = star();
        let mesh = cut(&uv, triangles, vec![0; 4], &[([0, 4], Cut::Repeated), ([4, 2], Cut::Repeated)]);
        assert_eq!(counts(&mesh), (8, 5, vec![4, 4]));
    }

    #[test]
    fn regions_are_cut_apart_and_share_points() {
        let (uv, triangles) = star();
        let mesh = cut(&uv, triangles, vec![0, 0, 1, 1], &[]);
        assert_eq!(counts(&mesh), (8, 5, vec![4, 4]));
    }

    #[test]
    fn a_crack_that_ends_on_another_region_does_not_open_there() {
        // Two stars side by side; the crack runs from the border of the left one to the shared side.
        let uv = [(0.0, 0.0), (1.0, -1.0), (1.0, 0.0), (1.0, 1.0), (2.0, 0.0)].map(DVec2::from);
        let triangles = vec![[0, 1, 2], [0, 2, 3], [4, 2, 1], [4, 3, 2]];
        let mesh = cut(&uv, triangles, vec![0, 0, 1, 1], &[([0, 2], Cut::Crack)]);
        // Node 0 is doubled with its point; node 2 has three nodes and one point.
        assert_eq!(counts(&mesh), (2 + 2 + 3 + 2 + 1, 6, vec![3, 3, 4]));
    }

    #[test]
    fn pinched_nodes_get_a_node_and_a_point_for_each_fan() {
        let (uv, triangles) = star();
        let mesh = cut(&uv, vec![triangles[0], triangles[2]], vec![0, 0], &[]);
        assert_eq!(counts(&mesh), (6, 6, vec![3, 3]));
    }
}
