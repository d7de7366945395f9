//! Small algorithms and values that know nothing of meshes: exact predicates, metric tensors and their spectra, box
//! trees, point location, disjoint sets, parity over GF(2), fingerprints, numbers as text, percent-encoding,
//! spelling suggestions, enumerations with words, conditions over tables of fields.

pub mod predicates;
pub mod tensor;
mod spectrum;
pub(crate) mod box_tree;
mod plane_triangles;
mod disjoint_sets;
pub(crate) mod parity;
mod fingerprint;
pub(crate) mod decimal;
pub mod number;
pub mod condition;
pub(crate) mod percent;
pub(crate) mod spelling;
pub(crate) mod worded;

pub(crate) use decimal::Shortest;
pub(crate) use disjoint_sets::DisjointSets;
pub use fingerprint::Fingerprint;
pub(crate) use plane_triangles::PlaneTriangles;
pub use spectrum::{LogMetric, LogMetric2, LogMetric3};
pub use tensor::{Metric2, Metric3};
