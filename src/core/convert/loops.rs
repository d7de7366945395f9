//! The loops of the front at the nodes where a step has changed it, for whoever watches (docs/algorithm.md, "The parity
//! invariant"). Walked only when asked for.

use smallvec::SmallVec;

use super::converter::Converter;
use super::event::Event;
use crate::core::mesh::ids::NodeId;

impl Converter<'_> {
    /// The segments of each loop of the front that runs through the nodes at which an event, the last step's, has changed it; `None`
    /// where it has not changed the front. Loops come in the order of the nodes; a loop that is gone is not among them.
    pub fn loops_after(&self, event: &Event) -> Option<Vec<u32>> {
        match event {
            Event::Formed { nodes, .. } => Some(self.loops_through(nodes)),
            Event::Seamed { at, node, .. } | Event::TransitionSeamed { at, node, .. } => {
                Some(self.loops_through(&[*at, *node]))
            }
            Event::Split { node, .. } => Some(self.loops_through(&[*node])),
            // What was closed had no front but its own.
            Event::Closed { .. } => Some(Vec::new()),
            _ => None,
        }
    }

    /// The segments of each loop of the front through some nodes.
    fn loops_through(&self, nodes: &[NodeId]) -> Vec<u32> {
        let mesh = &self.mesh;
        let mut starts: SmallVec<[_; 16]> = SmallVec::new();
        for &node in nodes.iter().filter(|n| mesh.has_node(**n)) {
            starts.extend(mesh.fan(node).filter(|h| mesh.is_front(*h)));
        }
        let mut walked: SmallVec<[_; 16]> = SmallVec::new();
        let mut loops = Vec::new();
        for &start in &starts {
            if walked.contains(&start) {
                continue;
            }
            let (mut h, mut segments) = (start, 0);
            loop {
                if starts.contains(&h) {
                    walked.push(h);
                }
                h = mesh.front_after(h);
                segments += 1;
                if h == start {
                    break;
                }
            }
            loops.push(segments);
        }
        loops
    }
}
