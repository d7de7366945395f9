//! The mesh: triangles and quadrilaterals in one half-edge structure (docs/algorithm.md, "Half-edge structure"),
//! changed only by its operators.

pub mod ids;
pub mod journal;
pub mod triangle_set;
pub mod names;
pub mod order;
pub mod half_edge;
pub mod refusals;
pub mod operators;
pub mod quad_operators;
pub mod check;
pub mod quality;
pub mod sines;
