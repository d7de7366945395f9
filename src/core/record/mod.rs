//! What is kept of a run: meshes for export, statistics and reports, run files, and the run that a figure carries.

pub mod statistics;
pub mod export;
mod flaw;
pub mod report;
pub mod run_file;
pub mod figure;
