//! Surfaces that are known as triangles only, without CAD (docs/algorithm.md, "Discrete surfaces"): their feature
//! edges, their charts (discs of triangles), and a one-to-one map of each chart onto a disc of the plane, in which it
//! is meshed.
//!
//! Deliberately absent: reading files (`formats`), sizes (`metric`).

mod edges;
mod stitch;
pub(crate) mod lines;
pub(in crate::core) mod defects;
pub mod repair;
mod noise;
mod creases;
pub mod features;
pub(in crate::core) mod further;
mod planar_map;
pub mod chart;
mod dissection;
mod sparse;
mod tutte;
mod as_rigid_as_possible;
mod texture;
pub mod fitness;
pub mod surface;
pub mod relaxing;
pub(crate) mod curvature;
pub mod right_angled;
pub mod own_triangles;
pub mod census;

pub use census::{Census, Division};
pub use edges::{Edge, Edges, Triangles};
pub use features::Feature;
pub use noise::Noise;
pub use planar_map::{Stretch, StretchBound};
pub use repair::Repaired;
pub use surface::Surface;
#[cfg(test)]
mod fixtures;
