//! Surfaces that are known as triangles only, without CAD (docs/algorithm.md, "Discrete surfaces"): their feature
//! edges, their charts (discs of triangles), and a one-to-one map of each chart onto a disc of the plane, in which it
//! is meshed.
//!
//! Deliberately absent: reading files (`formats`), sizes (`metric`).

pub mod edges;
pub mod stitch;
pub(crate) mod lines;
pub(in crate::core) mod defects;
pub mod repair;
pub mod features;
pub mod planar_map;
pub mod chart;
pub(crate) mod sparse;
pub(crate) mod tutte;
pub mod as_rigid_as_possible;
pub(crate) mod texture;
pub mod surface;
pub(crate) mod curvature;
pub mod own_triangles;
pub mod census;
#[cfg(test)]
mod fixtures;
