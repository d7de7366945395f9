//! The background triangle mesh (docs/algorithm.md, "The background mesh"): division of curves with even loops,
//! triangulation, adaptation to the metric; or an imported mesh.

pub mod length;
pub mod discretise;
pub mod cut;
pub mod clash;
pub mod triangulate;
pub mod import;
pub mod implied_metric;
pub mod adapt;
