//! The mesh: triangles and quadrilaterals in one half-edge structure (docs/algorithm.md, "Half-edge structure"),
//! changed only by its operators.

pub mod ids;
pub mod journal;
mod triangle_set;
pub mod names;
pub mod order;
pub mod half_edge;
mod refusals;
mod operators;
mod quad_operators;
mod check;
pub mod quality;
pub mod sines;

pub use half_edge::touched::Touched;
pub use half_edge::{Difference, Embedding, FreeLists, Mesh, NewElement, Symmetry, Undone};
pub use ids::{ElementId, HalfEdgeId, NodeId, PointId};
pub use journal::Mark;
pub use names::{Further, GroupsByPlace, Named, Names};
pub use quality::{FULL_TURN, twelfths};
pub use refusals::{Operation, Refusal, Refusals};
pub use triangle_set::TriangleSet;
