//! What a trial may move and how good it is: the nodes of a change, their neighbours, and the elements around.

use super::candidate::Valences;
use super::seen::Seen;
use crate::core::convert::relax::energy::{self, Judged};
use crate::core::mesh::{Mesh, NodeId};

/// Weight of a squared excess against the shape of a corner and the length of an edge.
pub const VALENCE_WEIGHT: f64 = 1.5;

/// Nodes, each once, and the elements around them that were judged.
#[derive(Clone, Debug, Default)]
pub struct Region {
    pub nodes: Vec<NodeId>,
    node_seen: Seen,
    element_seen: Seen,
}

impl Region {
    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        size_of::<NodeId>() * self.nodes.capacity() + self.node_seen.bytes() + self.element_seen.bytes()
    }

    /// Some nodes with their neighbours.
    pub fn gather(&mut self, mesh: &Mesh, core: &[NodeId]) {
        self.nodes.clear();
        self.node_seen.clear(mesh.node_slots());
        core.iter().for_each(|&node| self.add(node));
        for &node in core {
            mesh.neighbours(node).for_each(|n| self.add(n));
        }
    }

    /// Adds those nodes of another region that are still there.
    pub fn add_those_left_of(&mut self, mesh: &Mesh, other: &Region) {
        other.nodes.iter().filter(|&&n| mesh.has_node(n)).for_each(|&node| self.add(node));
    }

    fn add(&mut self, node: NodeId) {
        if self.node_seen.add(node.index()) {
            self.nodes.push(node);
        }
    }

    /// Energy and worst quality. Regions with the same border can be compared: what lies across it counts in neither.
    pub fn judge(&mut self, mesh: &Mesh, valences: &Valences) -> Judged {
        // Elements change between two judgements of the same nodes.
        self.element_seen.clear(mesh.element_slots());
        let mut judged = Judged::NOTHING;
        for &node in &self.nodes {
            let mut elements = 0;
            for h in mesh.fan(node) {
                let e = h.element();
                elements += 1;
                if self.element_seen.add(e.index()) {
                    judged += energy::judge(mesh, e);
                }
            }
            let excess = f64::from(valences.excess_of(node, elements));
            judged.energy += VALENCE_WEIGHT * excess * excess;
        }
        judged
    }
}
