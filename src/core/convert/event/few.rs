//! A few nodes of an event, held in place: events are copied, and logs keep millions of them.

use std::fmt;
use std::ops::Deref;

use serde::{Serialize, Serializer};

use crate::core::mesh::NodeId;

/// At most [`FewNodes::MOST`] nodes; a slice of them, and a list in JSON.
#[derive(Clone, Copy)]
pub struct FewNodes {
    count: u8,
    nodes: [NodeId; FewNodes::MOST],
}

impl FewNodes {
    /// How many there can be.
    pub const MOST: usize = 15;

    /// These nodes.
    ///
    /// # Panics
    /// Where there are more than [`FewNodes::MOST`].
    pub fn of(nodes: &[NodeId]) -> FewNodes {
        let mut few = FewNodes { count: nodes.len() as u8, nodes: [NodeId(0); FewNodes::MOST] };
        few.nodes[..nodes.len()].copy_from_slice(nodes);
        few
    }
}

impl Deref for FewNodes {
    type Target = [NodeId];

    fn deref(&self) -> &[NodeId] {
        &self.nodes[..usize::from(self.count)]
    }
}

impl PartialEq for FewNodes {
    fn eq(&self, other: &FewNodes) -> bool {
        **self == **other
    }
}

impl fmt::Debug for FewNodes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(&**self).finish()
    }
}

impl Serialize for FewNodes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(&**self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_nodes_are_those_given_and_a_list_in_json() {
        let all: Vec<NodeId> = (0..FewNodes::MOST as u32).map(NodeId).collect();
        for count in [0, 1, FewNodes::MOST] {
            let few = FewNodes::of(&all[..count]);
            assert_eq!(*few, all[..count]);
            assert_eq!(serde_json::to_string(&few).unwrap(), serde_json::to_string(&all[..count]).unwrap());
        }
        assert_ne!(FewNodes::of(&all[..1]), FewNodes::of(&all[..2]));
    }
}
