//! The metric: lengths and angles (eqs. 4, 5), and the fields that give a tensor (eqs. 2, 3, 11) at each point.

pub mod measure;
pub mod straight_quad;
mod place;
mod formula;
mod boundary_layer;
mod curvature;
pub(in crate::core) mod fitting;
mod table;
mod forced;
mod gap;
mod field;
mod survey;
mod walls;
pub(crate) mod gradation;

pub(in crate::core) use curvature::Curvature;
pub use field::{BadMetric, Field, FieldSpec, MetricSource, Sizing};
pub use forced::ForcedSide;
pub use gap::Rungs;
pub use place::MetricPlace;
pub use survey::Survey;
pub use walls::{Rows, Walls};
