//! Small algorithms and values that know nothing of meshes: exact predicates, metric tensors and their spectra, box
//! trees, point location, disjoint sets, parity over GF(2), fingerprints, numbers as text, spelling suggestions.

pub mod predicates;
pub mod tensor;
pub mod spectrum;
pub(crate) mod box_tree;
pub(crate) mod plane_triangles;
pub(crate) mod disjoint_sets;
pub(crate) mod parity;
pub mod fingerprint;
pub(crate) mod decimal;
pub(crate) mod spelling;
pub(crate) mod worded;
