//! Mesh files: one module for each format, read and written as a whole. Files are replaced atomically.

pub mod save;
mod scan;
mod numbering;
mod msh;
pub mod medit;
mod vtu;
mod obj;
mod stl;
mod ply;
mod gltf;
mod inp;
pub mod format;

pub use format::{Format, WriteOptions, metric_beside};
