//! A state of the run as the window shows it, shared with the thread that owns the run.

use std::sync::Arc;
use std::time::Duration;

use crate::core::case::Parameters;
use crate::core::convert::{Candidates, Event, Narrow, Phase};
use crate::core::front::Segment;
use crate::core::mesh::{ElementId, Mesh};
use crate::core::run::front_table::{Loop, Row};
use crate::core::run::{Changes, SegmentFacts, Selecting, Tried};
use crate::render::refused::{Refused, refused};
use crate::render::scene::Decision;

/// Whether the invariants hold.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Verdict {
    /// They do.
    Holds,
    /// Not known yet: after a leap the whole mesh is checked when there is time.
    #[default]
    Looking,
    /// What does not hold.
    Broken(String),
}

/// A state of the run.
pub struct Moment {
    pub step: u64,
    pub standing: u64,
    pub phase: Phase,
    pub event: Option<Event>,
    /// The last step, or the beginning, in a sentence.
    pub narration: String,
    /// What the last step looked at, and why it did what it did.
    pub about: Vec<String>,
    pub mesh: Arc<Mesh>,
    pub parameters: Parameters,
    /// The differences from the moment that was reported before.
    pub changes: Changes,
    /// The changes of the last three steps that changed anything, the latest first.
    pub changed: [Arc<[ElementId]>; 3],
    /// The changes of the very last step.
    pub just_changed: Arc<[ElementId]>,
    /// What the selection of the base under way looked at, or what the next one looks at.
    pub selecting: Arc<Selecting>,
    /// The front in the order of that selection.
    pub front: Vec<Segment>,
    /// The same segments with their loops, and whether they are deferred.
    pub rows: Vec<Row>,
    /// The loops of the front.
    pub loops: Vec<Loop>,
    /// The candidates for a side edge of the last step.
    pub candidates: Option<Candidates>,
    /// The triangles that the last step looked at to split the front.
    pub narrow: Option<Narrow>,
    /// The quadrilateral of the lowest quality, with its quality.
    pub worst: Option<(ElementId, f64)>,
    /// Why the base is the base.
    pub base: Option<SegmentFacts>,
    /// The steps since the selection of the base under way, this one included.
    pub so_far: Vec<(u64, Event)>,
    /// The attempts at it, where one was taken back.
    pub attempts: Vec<Tried>,
    /// The last quadrilateral that the front formed, until the next base is selected.
    pub last_quad: Option<ElementId>,
    /// What comes next.
    pub next: String,
    /// Whether the invariants hold.
    pub verdict: Verdict,
    /// The time from the request to the report.
    pub took: Duration,
}

impl Moment {
    /// The quadrilateral at hand: the one under way or, until the next one is begun, the one before.
    pub fn decision(&self) -> Decision {
        match self.last_quad.filter(|quad| self.mesh.has_element(*quad) && self.mesh.is_quad(*quad)) {
            Some(quad) => {
                let [a, b, d, c] = self.mesh.quad(quad);
                Decision { base: Some([a, b]), tops: [Some(c), Some(d)] }
            }
            None => Decision::of(&self.phase),
        }
    }

    /// The candidates of the last step that were not chosen.
    pub fn refused(&self) -> Vec<Refused> {
        refused(&self.mesh, &self.phase, self.candidates.as_ref())
    }
}

/// A row of the table in the form that the renderer takes.
pub(super) fn segment(row: &Row) -> Segment {
    let Row { h, a, b, class, h_value, length_metric, length_physical, theta, level, face, .. } = *row;
    Segment { h, a, b, h_value, length_metric, length_physical, theta, class, level, face }
}
