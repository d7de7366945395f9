//! Surfaces that are known as triangles only, without CAD (docs/algorithm.md, "Discrete surfaces"): their feature
//! edges, their charts (discs of triangles), and a one-to-one map of each chart onto a disc of the plane, in which it
//! is meshed.
//!
//! Deliberately absent: reading files (`core/io`), sizes (`core/metric`).

pub mod edges;
pub mod mend;
pub mod lines;
pub(in crate::core) mod refuse;
pub mod sound;
pub mod features;
pub mod flat;
pub mod chart;
pub mod sparse;
pub mod tutte;
pub mod rigid;
pub mod texture;
pub mod surface;
pub mod curvature;
pub mod given;
pub mod census;
#[cfg(test)]
mod fixtures;
