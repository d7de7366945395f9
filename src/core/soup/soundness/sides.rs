//! Connectivity: half-edges that share an edge, fans around nodes, the boundary.

use super::faces::Faces;
use super::{Defect, Found};
use crate::core::kernel::DisjointSets;

/// The connectivity of the elements' sides.
#[derive(Default)]
pub struct Sides {
    /// Number of edges.
    pub edges: u64,
    /// Half-edges without a twin.
    pub boundary: Vec<usize>,
    /// Half-edges at edges that are neither boundary nor between two consistently oriented elements.
    pub odd: Vec<usize>,
    /// Whether a node belongs to an element.
    pub used: Vec<bool>,
    /// Whether a node is on the boundary or on a branching edge.
    pub outer: Vec<bool>,
    /// Number of closed chains of the boundary.
    pub loops: u64,
    /// Number of components, connected through nodes.
    pub components: u64,
}

impl Sides {
    /// Builds the connectivity and notes its defects.
    pub fn of(faces: &Faces, found: &mut Found) -> Sides {
        let nodes = faces.nodes();
        let mut sides = Sides { used: vec![false; nodes], outer: vec![false; nodes], ..Sides::default() };
        elements(faces, &mut sides, found);
        let mut fans = DisjointSets::new(4 * faces.len());
        let mut branching = vec![false; nodes];
        let mut valence = vec![0u32; nodes];
        let (start, list) = by_lower_node(faces);
        for lower in 0..nodes {
            let mut rest = &list[start[lower] as usize..start[lower + 1] as usize];
            while let Some(&(upper, _)) = rest.first() {
                let count = rest.iter().take_while(|side| side.0 == upper).count();
                let (group, after) = rest.split_at(count);
                rest = after;
                sides.edges += 1;
                valence[lower] += 1;
                valence[upper as usize] += 1;
                sides.edge(faces, group, &mut fans, &mut branching, found);
            }
        }
        let mut boundary = std::mem::take(&mut sides.boundary);
        boundary.sort_unstable();
        for &h in &boundary {
            let (a, b) = faces.ends(h);
            (sides.outer[a as usize], sides.outer[b as usize]) = (true, true);
        }
        for node in 0..nodes {
            // An interior node of valence 2 has the same two elements on both sides.
            if sides.used[node] && !sides.outer[node] && !branching[node] && valence[node] == 2 {
                found.note(Defect::Doublet, node, faces.point(node as u32));
            }
        }
        pinched(faces, &mut fans, &branching, found);
        sides.loops = loops(faces, &boundary, &branching, found);
        for (outer, branching) in sides.outer.iter_mut().zip(&branching) {
            *outer |= branching;
        }
        sides.boundary = boundary;
        sides.components = components(faces, &sides.used);
        sides
    }

    /// One edge with its half-edges.
    fn edge(
        &mut self,
        faces: &Faces,
        group: &[(u32, u32)],
        fans: &mut DisjointSets,
        branching: &mut [bool],
        found: &mut Found,
    ) {
        match *group {
            [(_, h)] => self.boundary.push(h as usize),
            [(_, fan_h), (_, fan_g)] => {
                let (h, g) = (fan_h as usize, fan_g as usize);
                let (h_next, g_next) = (faces.next(h) as u32, faces.next(g) as u32);
                let (a, _) = faces.ends(h);
                if faces.ends(g).0 == a {
                    // In space, groups may be oriented independently.
                    if faces.tag(h / 4) == faces.tag(g / 4) || faces.is_flat() {
                        found.note(Defect::OrientationConflict, a as usize, faces.point(a));
                    } else {
                        // The boundary's direction is undefined there.
                        let (a, b) = faces.ends(h);
                        (branching[a as usize], branching[b as usize]) = (true, true);
                    }
                    self.odd.extend([h, g]);
                    fans.join(fan_h, fan_g);
                    fans.join(h_next, g_next);
                } else {
                    fans.join(fan_h, g_next);
                    fans.join(h_next, fan_g);
                }
            }
            _ => {
                let (a, b) = faces.ends(group[0].1 as usize);
                found.note(Defect::BranchingEdge, a as usize, faces.point(a));
                (branching[a as usize], branching[b as usize]) = (true, true);
                self.odd.extend(group.iter().map(|side| side.1 as usize));
            }
        }
    }
}

/// Half-edges by the lower of their nodes: the offset of each node's list, and for each half-edge its upper node and
/// number, ascending. A counting sort by node and a small sort within each is several times faster than one sort of
/// all.
fn by_lower_node(faces: &Faces) -> (Vec<u32>, Vec<(u32, u32)>) {
    let mut start = vec![0u32; faces.nodes() + 1];
    let each = |visit: &mut dyn FnMut(u32, u32, usize)| {
        for element in 0..faces.len() {
            for corner in 0..faces.corners(element).len() {
                let (a, b) = faces.ends(4 * element + corner);
                // A side from a node to itself is no edge; its element is already noted.
                if a != b {
                    visit(a.min(b), a.max(b), 4 * element + corner);
                }
            }
        }
    };
    each(&mut |lower, _, _| start[lower as usize + 1] += 1);
    for node in 0..faces.nodes() {
        start[node + 1] += start[node];
    }
    let mut place = start.clone();
    let mut list = vec![(0, 0); start[faces.nodes()] as usize];
    each(&mut |lower, upper, h| {
        list[place[lower as usize] as usize] = (upper, h as u32);
        place[lower as usize] += 1;
    });
    for node in 0..faces.nodes() {
        list[start[node] as usize..start[node + 1] as usize].sort_unstable();
    }
    (start, list)
}

/// Notes repeated nodes, duplicate elements and orphan nodes.
fn elements(faces: &Faces, sides: &mut Sides, found: &mut Found) {
    let mut sorted: Vec<([u32; 4], u32)> = Vec::with_capacity(faces.len());
    for element in 0..faces.len() {
        let corners = faces.corners(element);
        let mut key = [u32::MAX; 4];
        key[..corners.len()].copy_from_slice(corners);
        key.sort_unstable();
        if key[..corners.len()].windows(2).any(|pair| pair[0] == pair[1]) {
            found.note(Defect::RepeatedNode, element, faces.point(corners[0]));
        }
        for &node in corners {
            sides.used[node as usize] = true;
        }
        sorted.push((key, element as u32));
    }
    sorted.sort_unstable();
    for pair in sorted.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        let element = pair[1].1 as usize;
        found.note(Defect::DuplicateElement, element, faces.point(faces.corners(element)[0]));
    }
    for (node, _) in sides.used.iter().enumerate().filter(|(_, used)| !**used) {
        found.note(Defect::OrphanNode, node, faces.point(node as u32));
    }
}

/// Notes nodes with several fans, except at branching edges, where they are expected.
fn pinched(faces: &Faces, fans: &mut DisjointSets, branching: &[bool], found: &mut Found) {
    let mut count = vec![0u8; faces.nodes()];
    for element in 0..faces.len() {
        for (corner, &node) in faces.corners(element).iter().enumerate() {
            let h = (4 * element + corner) as u32;
            if fans.find(h) == h {
                count[node as usize] = count[node as usize].saturating_add(1);
            }
        }
    }
    for (node, _) in count.iter().enumerate().filter(|&(node, &fans)| fans > 1 && !branching[node]) {
        found.note(Defect::PinchedNode, node, faces.point(node as u32));
    }
}

/// Follows the boundary; returns the number of its closed chains.
fn loops(faces: &Faces, boundary: &[usize], branching: &[bool], found: &mut Found) -> u64 {
    let mut out: Vec<(u32, u32)> = boundary.iter().map(|&h| faces.ends(h)).collect();
    out.sort_unstable();
    let mut into: Vec<u32> = out.iter().map(|edge| edge.1).collect();
    into.sort_unstable();
    let first_from = |node: u32| out.partition_point(|edge| edge.0 < node);
    let ends_at = |node: u32| into.partition_point(|&to| to <= node) - into.partition_point(|&to| to < node);
    let mut nodes: Vec<u32> = out.iter().map(|edge| edge.0).chain(into.iter().copied()).collect();
    nodes.sort_unstable();
    nodes.dedup();
    for node in nodes {
        let starts = first_from(node + 1) - first_from(node);
        if starts != ends_at(node) && !branching[node as usize] {
            found.note(Defect::OpenBoundary, node as usize, faces.point(node));
        }
    }
    let mut taken = vec![false; out.len()];
    // Number of edges taken from a node, stored at the first of them.
    let mut used_from = vec![0u32; out.len()];
    let mut loops = 0;
    for begin in 0..out.len() {
        if taken[begin] {
            continue;
        }
        let mut edge = begin;
        loop {
            taken[edge] = true;
            let node = out[edge].1;
            if node == out[begin].0 {
                loops += 1;
                break;
            }
            let first = first_from(node);
            let mut next = first + used_from.get(first).map_or(0, |&used| used as usize);
            while next < out.len() && out[next].0 == node && taken[next] {
                next += 1;
            }
            if next >= out.len() || out[next].0 != node {
                break;
            }
            used_from[first] = (next - first) as u32;
            edge = next;
        }
    }
    loops
}

fn components(faces: &Faces, used: &[bool]) -> u64 {
    let mut sets = DisjointSets::new(faces.nodes());
    for element in 0..faces.len() {
        let corners = faces.corners(element);
        for &node in &corners[1..] {
            sets.join(corners[0], node);
        }
    }
    (0..faces.nodes()).filter(|&node| used[node] && sets.find(node as u32) == node as u32).count() as u64
}
