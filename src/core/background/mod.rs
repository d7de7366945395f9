//! The background triangle mesh (docs/algorithm.md, "The background mesh"): division of curves with even loops,
//! triangulation, adaptation to the metric; or an imported mesh.

pub(crate) mod length;
pub mod discretise;
pub(crate) mod cut;
pub mod clash;
pub(crate) mod triangulate;
pub mod import;
pub mod implied_metric;
pub mod adapt;
