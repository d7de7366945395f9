//! The converter and what it stands on, from the lowest floor to the highest: a room imports only from rooms listed
//! before it (`tests/architecture.rs`). Deliberately absent: screens, clocks, threads' own state, unseeded randomness.

pub mod fault;
pub mod progress;
pub mod kernel;
pub mod geometry;
pub mod metric;
pub mod mesh;
pub mod soup;
pub mod formats;
pub mod discrete;
pub mod background;
pub mod step;
pub mod case;
pub mod front;
pub mod prepare;
pub mod convert;
pub mod run;
pub mod question;
pub mod lesson;
pub mod record;
pub mod reduce;
