//! A run as a value, access to any state of it, and explanations of that state. Everything here works without a screen;
//! the window, the command line and tests use it.
//!
//! | what | where |
//! |---|---|
//! | the run: case, parameters, edits at steps, bookmarks, camera | [`Run`] |
//! | reaching any state, bit-identical to a new run; stepping forward and back; editing | [`History`] |
//! | copies of the mesh for other threads, updated by what changed | [`Copies`] |
//! | what a figure shows of a run | [`Shown`] |
//! | the first step after which two runs differ | [`compare::first_difference`] |
//! | later decisions that differ although the fronts are the same there | [`compare::differences`] |
//! | running ahead on another thread | [`Recorder`], which [`History::lend`] lends |
//! | one event per step, the number of quadrilaterals, where to go next | [`Log`] |
//! | invariants and statistics along a run, lanes of events and curves | [`Sample`], [`timeline`] |
//! | the step that made each quadrilateral, without a history | [`Births`] |
//! | the step that changed each node and element last | [`LastChanges`], [`ChangeLog`] |
//! | elements and nodes with their measures, filtered and sorted | [`ElementTable`], [`NodeTable`] |
//! | breakpoints and watchpoints | [`breakpoint`], [`Watched`] |
//! | what a person looks for by number or coordinates | [`Sought`] |
//! | the attempts at the quadrilateral under way | [`Tried`] |
//! | the decision chain of a quadrilateral | [`Chain`] |
//! | why a segment is chosen, what a node is | [`Selecting`], [`SegmentFacts`], [`NodeFacts`], [`FrontTable`] |
//! | a sentence for each of a range of steps | [`History::transcript`] |
//! | what a step did and looked at, by which rule, and what comes next, in words | [`explain`] |
//!
//! The state at step k is the state after k steps, with the edits of step k applied: an edit at step k changes what
//! follows and nothing before.

#[expect(clippy::module_inception, reason = "the module is about the run")]
pub mod run;
pub mod shown;
mod front_count;
mod sample;
mod log;
pub mod timeline;
mod keyframes;
mod recorder;
pub mod history;
pub mod compare;
pub mod copies;
mod births;
mod last_changes;
mod worst_quality;
pub mod breakpoint;
mod watch;
mod chain;
mod attempts;
mod find;
mod transcript;
pub mod front_table;
pub mod explain;
mod listing;
mod element_table;
mod node_table;

pub use attempts::Tried;
pub use births::{Births, Born};
pub use breakpoint::Condition;
pub use chain::{Chain, Link};
pub use copies::Copies;
pub use element_table::{ElementRow, ElementTable};
pub use explain::{
    Corner, EdgeFacts, EdgeKind, ElementFacts, MetricFacts, NodeFacts, SegmentFacts, SelectedBase, Selecting, Verdict,
};
pub use find::Sought;
pub use front_count::FrontCount;
pub use front_table::FrontTable;
pub use history::{Changes, History};
pub use last_changes::{ChangeLog, LastChanges};
pub use listing::{Listed, Listing, Query, Row, Steps, csv};
pub use log::{Angles, Log};
pub use node_table::{NodePlace, NodeRow, NodeTable};
pub use recorder::{Recorder, Stretch};
pub use run::{Bookmark, Camera, Edit, EditKind, Run};
pub use sample::Sample;
pub use shown::{Shown, ShownState};
pub use watch::{Appearance, Beside, Watched};
pub use worst_quality::WorstQuality;
