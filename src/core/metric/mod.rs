//! The metric: tensors (eqs. 2, 3, 11), length and angle (eqs. 4, 5), and the fields that give a tensor at a place.

pub mod measure;
pub mod place;
pub mod formula;
mod boundary_layer;
pub(in crate::core) mod curvature;
mod table;
pub mod field;
pub mod survey;
pub mod gradation;
