//! Copies of a mesh: along a Hilbert curve, without its journal, as bytes.

use super::{Mesh, NONE, Place};
use crate::core::mesh::ids::{ElementId, NodeId};
use crate::core::mesh::order::{grouped, hilbert_order};

impl Mesh {
    /// The same mesh without tombstones, its nodes and elements along a Hilbert curve, so that neighbours in the plane
    /// are neighbours in memory, on which the speed of large meshes depends. The journal is empty, and records if that
    /// of this mesh does.
    #[must_use]
    pub fn reordered(&self) -> Mesh {
        let nodes = hilbert_order(&self.nodes().map(|n| (n.0, self.uv(n))).collect::<Vec<_>>());
        let mut new_node = vec![NONE; self.places.len()];
        for (new, &old) in nodes.iter().enumerate() {
            new_node[old as usize] = new as u32;
        }
        // Elements follow their first node.
        let first_node = |e: ElementId| self.corners(e).map(|n| new_node[n.index()]).min().unwrap_or(NONE);
        let elements: Vec<(u32, u32)> = self.elements().map(|e| (first_node(e), e.0)).collect();
        let elements: Vec<u32> = grouped(nodes.len(), &elements, |e| e.0).into_iter().map(|(_, old)| old).collect();
        let mut new_element = vec![NONE; self.sides.len()];
        for (new, &old) in elements.iter().enumerate() {
            new_element[old as usize] = new as u32;
        }
        let mut mesh = self.extract(&nodes, &elements, &new_node, &new_element);
        mesh.journal.set_recording(self.journal.is_recording());
        mesh
    }

    /// The mesh of some nodes and elements, in this order; `new_node` and `new_element` map old ids to new ones.
    pub(super) fn extract(&self, nodes: &[u32], elements: &[u32], new_node: &[u32], new_element: &[u32]) -> Mesh {
        let half_edge = |h: u32| if h == NONE { NONE } else { new_element[(h >> 2) as usize] << 2 | (h & 3) };
        let level = |&n: &u32| self.first_level(NodeId(n));
        let slots = 4 * elements.len();
        let (mut origin, mut twin) = (Vec::with_capacity(slots), Vec::with_capacity(slots));
        let mut deferred = Vec::with_capacity(slots);
        for &old in elements {
            let first = 4 * old as usize;
            let sides = self.sides[old as usize] as usize;
            for slot in first..first + 4 {
                let used = slot < first + sides;
                origin.push(if used { new_node[self.origin[slot] as usize] } else { NONE });
                twin.push(if used { half_edge(self.twin[slot]) } else { NONE });
            }
            deferred.extend_from_slice(&self.deferred[first..first + 4]);
        }
        Mesh {
            places: nodes.iter().map(|&n| self.places[n as usize]).collect(),
            anchor: nodes.iter().map(|&n| half_edge(self.anchor[n as usize])).collect(),
            point: nodes.iter().map(|&n| self.point[n as usize]).collect(),
            origin,
            twin,
            sides: elements.iter().map(|&e| self.sides[e as usize]).collect(),
            region: elements.iter().map(|&e| self.region[e as usize]).collect(),
            level: elements.iter().map(|&e| self.level[e as usize]).collect(),
            deferred,
            first_level: if self.first_level.is_empty() { Vec::new() } else { nodes.iter().map(level).collect() },
            refusals: self.refusals,
            embedding: self.embedding.clone(),
            symmetry: self.symmetry.clone(),
            ..Mesh::default()
        }
    }

    /// A copy for display, without the journal, which may be many times as large.
    #[must_use]
    pub fn without_journal(&self) -> Mesh {
        let mut copy = Mesh::default();
        copy.become_same(self);
        copy
    }

    /// Whether another mesh has the same state: that of which [`Mesh::write_state`] writes the bytes.
    pub fn is_same(&self, other: &Mesh) -> bool {
        let bytes = [self, other].map(|mesh| {
            let mut bytes = Vec::new();
            mesh.write_state(&mut bytes);
            bytes
        });
        bytes[0] == bytes[1]
    }

    /// Whether another mesh, which differs from this one at most in these nodes and elements, has the same state.
    pub fn is_same_at(&self, other: &Mesh, nodes: &[NodeId], elements: &[ElementId]) -> bool {
        self.places.len() == other.places.len()
            && self.sides.len() == other.sides.len()
            && self.free_nodes == other.free_nodes
            && self.free_elements == other.free_elements
            && self.closed == other.closed
            && nodes.iter().all(|n| self.is_node_same(other, n.index()))
            && elements.iter().all(|e| self.is_element_same(other, e.index()))
    }

    /// Whether the slot of a node is the same; beyond the last one there is nothing to differ.
    fn is_node_same(&self, other: &Mesh, n: usize) -> bool {
        let place = |of: &Mesh| {
            let Place { uv, metric } = of.places[n];
            [uv.x, uv.y, metric.uu, metric.uv, metric.vv].map(f64::to_bits)
        };
        n >= self.places.len()
            || place(self) == place(other)
                && self.anchor[n] == other.anchor[n]
                && self.point[n] == other.point[n]
                && self.first_level.get(n) == other.first_level.get(n)
    }

    /// The same of an element.
    fn is_element_same(&self, other: &Mesh, e: usize) -> bool {
        let slots = 4 * e..4 * e + 4;
        e >= self.sides.len()
            || self.sides[e] == other.sides[e]
                && self.region[e] == other.region[e]
                && self.level[e] == other.level[e]
                && self.origin[slots.clone()] == other.origin[slots.clone()]
                && self.twin[slots.clone()] == other.twin[slots.clone()]
                && self.deferred[slots.clone()] == other.deferred[slots]
    }

    /// Appends the canonical serialisation of the state: all arrays and both free lists, little-endian. Two meshes have
    /// the same state if and only if these bytes are equal. (The journal is history, not state.)
    pub fn write_state(&self, bytes: &mut Vec<u8>) {
        let mut number = |n: u64| bytes.extend_from_slice(&n.to_le_bytes());
        number(self.places.len() as u64);
        number(self.sides.len() as u64);
        number(self.free_nodes.len() as u64);
        number(self.free_elements.len() as u64);
        number(u64::from(self.closed[0]) << 32 | u64::from(self.closed[1]));
        for n in 0..self.places.len() {
            let Place { uv, metric } = self.places[n];
            [uv.x, uv.y, metric.uu, metric.uv, metric.vv].into_iter().for_each(|x| number(x.to_bits()));
            number(u64::from(self.anchor[n]) << 32 | u64::from(self.point[n]));
        }
        for h in 0..self.origin.len() {
            number(u64::from(self.origin[h]) << 32 | u64::from(self.twin[h]));
        }
        for e in 0..self.sides.len() {
            let deferred = (0..4).map(|k| u64::from(self.deferred[4 * e + k]) << k).sum::<u64>();
            number(
                u64::from(self.region[e]) << 28
                    | u64::from(self.level[e]) << 12
                    | deferred << 8
                    | u64::from(self.sides[e]),
            );
        }
        self.free_nodes.iter().for_each(|n| number(u64::from(n.0)));
        self.free_elements.iter().for_each(|e| number(u64::from(e.0)));
        self.first_level.iter().for_each(|&level| number(u64::from(level)));
        self.first_level.iter().for_each(|&level| number(u64::from(level)));
    }
}
