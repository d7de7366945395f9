//! A state of the run, for looking at: what of it the window shows, shared with the thread that has the run.

use std::sync::Arc;
use std::time::Duration;

use crate::core::convert::candidates::Candidates;
use crate::core::convert::event::Event;
use crate::core::convert::parameters::Parameters;
use crate::core::convert::phase::Phase;
use crate::core::front::segment::Segment;
use crate::core::mesh::half_edge::Mesh;
use crate::core::mesh::ids::ElementId;
use crate::core::run::explain::SegmentTold;
use crate::core::run::front_table::{Loop, Row};
use crate::core::run::history::Changes;

/// Whether the invariants hold.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Verdict {
    /// They do.
    Holds,
    /// After a leap the whole mesh is looked at when there is time.
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
    pub mesh: Arc<Mesh>,
    pub parameters: Parameters,
    /// What is other than in the moment that was told before.
    pub changes: Changes,
    /// What the last three steps that changed anything changed, the newest first.
    pub changed: [Arc<[ElementId]>; 3],
    /// What the very last one changed.
    pub just_changed: Arc<[ElementId]>,
    /// The front in the order in which a selection would take it.
    pub front: Vec<Segment>,
    /// The same segments with their loops, and whether they are put off.
    pub rows: Vec<Row>,
    /// The loops of the front.
    pub loops: Vec<Loop>,
    /// What the step that led here chose a side edge from.
    pub candidates: Option<Candidates>,
    /// Why the base is the base.
    pub base: Option<SegmentTold>,
    /// Whether the invariants hold.
    pub verdict: Verdict,
    /// From asking to telling.
    pub took: Duration,
}

/// A row of the table as the renderer wants it.
pub(super) fn segment(row: &Row) -> Segment {
    let Row { h, a, b, class, h_value, length_metric, length_physical, theta, level, face, .. } = *row;
    Segment { h, a, b, h_value, length_metric, length_physical, theta, class, level, face }
}
