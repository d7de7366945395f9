//! The background triangle mesh (docs/algorithm.md, "The background mesh"): division of curves with even loops,
//! triangulation, adaptation to the metric; or an imported mesh.

mod length;
mod discretise;
mod cut;
mod clash;
pub(crate) mod triangulate;
pub mod import;
pub mod implied_metric;
pub mod adapt;

pub use adapt::Adapted;
pub use discretise::DividedDomain;
pub(in crate::core) use discretise::{Division, Gaps};
