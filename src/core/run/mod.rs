//! A run as a value, access to any state of it, and explanations of that state. Everything here works without a screen;
//! the window, the command line and tests use it.
//!
//! | what | where |
//! |---|---|
//! | the run: case, parameters, edits at steps, bookmarks, camera | [`run::Run`] |
//! | reaching any state, bit-identical to a new run; stepping forward and back; editing | [`history::History`] |
//! | copies of the mesh for other threads, updated by what changed | [`copies::Copies`] |
//! | what a figure shows of a run | [`shown::Shown`] |
//! | running ahead on another thread | [`recorder::Recorder`], which [`history::History::lend`] lends |
//! | one event per step, the number of quadrilaterals, where to go next | [`log::Log`] |
//! | invariants and statistics along a run, lanes of its work | [`sample`], [`timeline`] |
//! | the step that made each quadrilateral, without a history | [`births`] |
//! | breakpoints and watchpoints | [`breakpoint`], [`watch`] |
//! | why a segment is chosen, what a node is | [`explain`], [`front_table`] |
//!
//! The state at step k is the state after k steps, with the edits of step k applied: an edit at step k changes what
//! follows and nothing before.

#[expect(clippy::module_inception, reason = "the module is about the run")]
pub mod run;
pub mod shown;
pub mod front_count;
pub mod sample;
pub mod log;
pub mod timeline;
pub(crate) mod keyframes;
pub mod recorder;
pub mod history;
pub mod copies;
pub mod births;
pub mod breakpoint;
pub mod watch;
pub mod front_table;
pub mod explain;
