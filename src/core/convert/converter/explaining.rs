//! What the events leave out, computed from the state on demand: a run that nobody watches pays nothing for it.

use glam::DVec2;
use smallvec::SmallVec;

use super::Converter;
use crate::core::case::Parameters;
use crate::core::convert::event::Event;
use crate::core::convert::form::{self, Aim, Stays};
use crate::core::convert::front::Gates;
use crate::core::convert::phase::{Attempt, Base, FinishPart, Phase};
use crate::core::convert::side::candidates::{self, Candidates};
use crate::core::convert::side::choice::BaseSide;
use crate::core::convert::split::{self, Narrow};
use crate::core::convert::{close, top};
use crate::core::mesh::{ElementId, Mesh, NodeId};

/// What a step looks at beside what its event says, computed from the state before it. What does not bear on the step
/// is absent.
#[derive(Clone, Debug)]
pub struct LookedAt {
    /// The parameters in force.
    pub parameters: Parameters,
    /// The quadrilateral under way: its base, and the attempt at it.
    pub base: Option<Base>,
    /// The attempt at it.
    pub attempt: Option<Attempt>,
    /// The candidates for a side edge.
    pub candidates: Option<Candidates>,
    /// The top edge, and the live edges that lie across it.
    pub top: Option<([NodeId; 2], Vec<[NodeId; 2]>)>,
    /// What a formation must pass, and the gates of the second pass.
    pub gates: [Gates; 2],
    /// Places of the tops C and D before they are placed, with where each is to go, or why it stays.
    pub tops: Option<[(DVec2, Result<Aim, Stays>); 2]>,
    /// The number of segments of the loop of a segment that every attempt has failed at, up to one more than a small
    /// loop has.
    pub segments: Option<usize>,
    /// Whether the front has ended.
    pub front_has_ended: bool,
    /// The triangles at which the front may be split.
    pub narrow: Option<Narrow>,
    /// The part of the post-processing.
    pub part: Option<FinishPart>,
}

impl Converter<'_> {
    /// What the next step looks at.
    pub fn looks_at(&self) -> LookedAt {
        let mesh = &self.mesh;
        let top = match self.phase {
            Phase::RecoverTop { tops, .. } => self.top_crossings().map(|crossings| (tops, crossings)),
            _ => None,
        };
        let tops = match &self.phase {
            Phase::Form { base, tops, .. } => {
                let [c, d] = form::aims(mesh, &*self.source, &self.parameters, base, *tops);
                Some([(mesh.uv(tops[0]), c), (mesh.uv(tops[1]), d)])
            }
            _ => None,
        };
        let segments = match &self.phase {
            Phase::Defer { base } => {
                base.half_edge(mesh).map(|h| mesh.front_loop(h).take(close::MOST_SEGMENTS + 1).count())
            }
            _ => None,
        };
        let part = match self.phase {
            Phase::PostProcess { part } => Some(part),
            _ => None,
        };
        LookedAt {
            parameters: self.parameters.clone(),
            base: self.phase.base().copied(),
            attempt: self.phase.attempt().copied(),
            candidates: self.candidates(),
            top,
            gates: [self.second_pass, true].map(Gates::of),
            tops,
            segments,
            front_has_ended: matches!(self.phase, Phase::Close { .. }),
            narrow: self.narrow(),
            part,
        }
    }

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
