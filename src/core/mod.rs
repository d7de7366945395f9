//! The converter and what it stands on. Deliberately absent: screens, clocks, threads' own state, unseeded randomness.

pub mod fault;
pub mod progress;
pub mod geometry;
pub mod metric;
pub mod journal;
pub mod mesh;
pub mod discrete;
pub mod background;
pub mod front;
pub mod convert;
pub mod run;
pub mod io;
