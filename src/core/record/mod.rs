//! The records of a run: exported meshes, statistics, reports, run files, and runs embedded in figures.

pub mod statistics;
pub mod export;
mod flaw;
pub mod report;
pub mod run_file;
pub mod figure;
