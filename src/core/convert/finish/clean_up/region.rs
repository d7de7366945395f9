//! What a trial may move and how good it is: the nodes of a change, their neighbours, and the elements around.

use super::candidate::Valences;
use crate::core::convert::relax::energy::{self, Judged};
use crate::core::mesh::{Mesh, NodeId};

/// Weight of a squared excess against the shape of a corner and the length of an edge. With a little more than 1
/// sequences of changes find as good angles and fewer irregular nodes.
pub const VALENCE_WEIGHT: f64 = 1.5;

/// Nodes, each once.
#[derive(Clone, Debug, Default)]
pub struct Region {
    pub nodes: Vec<NodeId>,
    /// Which nodes and elements are in, by the number of the gathering.
    node_seen: Vec<u32>,
    element_seen: Vec<u32>,
    gathering: u32,
}

impl Region {
    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        4 * (self.nodes.capacity() + self.node_seen.capacity() + self.element_seen.capacity())
    }

    /// Some nodes with their neighbours.
    pub fn gather(&mut self, mesh: &Mesh, core: &[NodeId]) {
        self.nodes.clear();
        self.node_seen.resize(mesh.node_slots(), 0);
        self.element_seen.resize(mesh.element_slots(), 0);
        self.gathering = self.gathering.wrapping_add(1);
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
        if std::mem::replace(&mut self.node_seen[node.index()], self.gathering) != self.gathering {
            self.nodes.push(node);
        }
    }

    /// Energy and worst quality. Regions with the same border can be compared: what lies across it counts in neither.
    pub fn judge(&mut self, mesh: &Mesh, valences: &Valences) -> Judged {
        // Elements change between two judgements of the same nodes.
        self.gathering = self.gathering.wrapping_add(1);
        let mut judged = Judged::NOTHING;
        for &node in &self.nodes {
            let mut elements = 0;
            for h in mesh.fan(node) {
                let e = h.element();
                elements += 1;
                if std::mem::replace(&mut self.element_seen[e.index()], self.gathering) != self.gathering {
                    judged += energy::judge(mesh, e);
                }
            }
            let excess = f64::from(valences.excess_of(node, elements));
            judged.energy += VALENCE_WEIGHT * excess * excess;
        }
        judged
    }
}
