//! The records of a run: exported meshes, statistics, reports, run files, runs embedded in figures, links to states,
//! sweeps over parameters.

pub mod statistics;
mod export;
mod flaw;
pub mod report;
pub mod run_file;
pub mod figure;
pub mod link;
pub mod sweep;

pub use export::Export;
pub use report::Report;
pub use run_file::Keeper;
pub use statistics::{Measured, Statistics};
