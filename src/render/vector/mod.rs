//! Pictures as vectors.

pub mod svg;
