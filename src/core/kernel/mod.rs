//! Small algorithms and values that know nothing of meshes: exact predicates, metric tensors and their spectra, box
//! trees, point location, disjoint sets, parity over GF(2), fingerprints, numbers as text, spelling suggestions.

pub mod predicates;
pub mod tensor;
pub mod spectrum;
pub mod box_tree;
pub mod plane_triangles;
pub mod disjoint_sets;
pub mod parity;
pub mod fingerprint;
pub mod decimal;
pub mod spelling;
