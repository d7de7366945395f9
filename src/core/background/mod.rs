//! The background triangle mesh (docs/algorithm.md, "The background mesh"): curves divided, loops made even,
//! triangulated, adapted to the metric.

pub mod length;
pub mod discretise;
pub mod cut;
pub mod triangulate;
pub mod import;
pub mod adapt;
