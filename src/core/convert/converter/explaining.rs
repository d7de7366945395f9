//! What the events leave out, computed from the state on demand: a run that nobody watches pays nothing for it.

use smallvec::SmallVec;

use super::Converter;
use crate::core::convert::event::Event;
use crate::core::convert::phase::Phase;
use crate::core::convert::side::candidates::{self, Candidates};
use crate::core::convert::side::choice::BaseSide;
use crate::core::convert::split::{self, Narrow};
use crate::core::convert::top;
use crate::core::mesh::{ElementId, Mesh, NodeId};

impl Converter<'_> {
    /// What the next step chooses a side edge from; `None` where it chooses none.
    pub fn candidates(&self) -> Option<Candidates> {
        let Phase::PrepareSide { base, attempt, side, left } = &self.phase else { return None };
        let here = BaseSide { mesh: &self.mesh, parameters: &self.parameters, base, side: *side };
        Some(candidates::of(&here, attempt, *left))
    }

    /// The edges that the top edge crosses, from C on, where the next step recovers it and none of them is dead; none
    /// where it is there.
    pub fn top_crossings(&self) -> Option<Vec<[NodeId; 2]>> {
        let Phase::RecoverTop { tops: [c, d], .. } = self.phase else { return None };
        if self.mesh.are_joined(c, d) {
            return Some(Vec::new());
        }
        let found = top::crossings(&self.mesh, c, d).ok()?;
        Some(found.into_iter().map(|h| self.mesh.ends(h)).collect())
    }

    /// The worst quality of the elements at the nodes of a quadrilateral, itself included.
    pub fn quality_around(&self, element: ElementId) -> f64 {
        self.mesh.corners(element).map(|n| self.mesh.worst_quality_at(n)).fold(f64::INFINITY, f64::min)
    }

    /// Slender triangles around the last quadrilateral, at which the front may be split (4.3.6, splitting i and ii);
    /// `None` where no local post-processing is under way.
    pub fn narrow(&self) -> Option<Narrow> {
        self.phase.last_formed().map(|quad| split::narrow(&self.mesh, &self.parameters, quad))
    }

    /// The segments of each loop of the front that runs through the nodes at which an event, the last step's, has
    /// changed it; `None` where it has not changed the front. Loops come in the order of the nodes; a loop that is gone
    /// is not among them.
    pub fn loops_after(&self, event: &Event) -> Option<Vec<u32>> {
        match event {
            Event::Formed { nodes, .. } => Some(loops_through(&self.mesh, nodes)),
            Event::Seamed { at, node, .. } | Event::TransitionSeamed { at, node, .. } => {
                Some(loops_through(&self.mesh, &[*at, *node]))
            }
            Event::Split { node, .. } => Some(loops_through(&self.mesh, &[*node])),
            // What was closed had no front but its own.
            Event::Closed { .. } => Some(Vec::new()),
            _ => None,
        }
    }
}

/// The segments of each loop of the front through some nodes.
fn loops_through(mesh: &Mesh, nodes: &[NodeId]) -> Vec<u32> {
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
        let mut segments = 0;
        for h in mesh.front_loop(start) {
            if starts.contains(&h) {
                walked.push(h);
            }
            segments += 1;
        }
        loops.push(segments);
    }
    loops
}
