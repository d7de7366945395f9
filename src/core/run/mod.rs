//! A run as a value, any state of it, and why that state is as it is. Everything here works without a screen; the window,
//! the command line and tests ask it.
//!
//! | what | where |
//! |---|---|
//! | the run: case, parameters, edits at steps, bookmarks, camera | [`run::Run`] |
//! | any state of it, bit-identical to running there afresh; stepping forward and back; editing | [`history::History`] |
//! | states for other threads to look at, brought up to date by what changed | [`copies::Copies`] |
//! | what a figure shows of it | [`shown::Shown`] |
//! | running ahead on another thread | [`history::History::lend`], [`recorder::Recorder`], [`history::History::accept`] |
//! | one event a step, the number of quadrilaterals, where to go next | [`log::Log`], `playback` |
//! | invariants and figures along the run, lanes of its work | [`sample`], [`timeline`] |
//! | when quadrilaterals were made, without a history | [`births`] |
//! | breakpoints and watchpoints | [`breakpoint`], [`watch`] |
//! | why this segment, what is this node | [`explain`], [`front_table`] |
//!
//! The state at step k is what k steps from the beginning lead to, with the edits of step k made: an edit of step k changes
//! what follows from k on and nothing before.

#[expect(clippy::module_inception, reason = "the run is the value that the room is about")]
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
mod playback;
pub mod breakpoint;
pub mod watch;
pub mod front_table;
pub mod explain;
