//! The metric: lengths and angles (eqs. 4, 5), and the fields that give a tensor (eqs. 2, 3, 11) at each point.

pub mod measure;
pub mod place;
pub(crate) mod formula;
mod boundary_layer;
pub(in crate::core) mod curvature;
mod table;
pub mod field;
pub mod survey;
pub(crate) mod gradation;
