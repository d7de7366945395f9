//! The metric: tensors (eqs. 2, 3, 11), length and angle (eqs. 4, 5), and the fields that give a tensor at a place.

pub mod tensor;
pub mod spectrum;
pub mod measure;
pub mod formula;
mod box_tree;
mod boundary_layer;
pub(in crate::core) mod curvature;
pub mod plane_triangles;
mod table;
pub mod field;
pub mod survey;
pub mod gradation;
