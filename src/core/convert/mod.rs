//! From triangles to quadrilaterals: the merging front (paper 4.3), the guarantee (docs/algorithm.md, "The guarantee"),
//! and what makes the mesh better in the end (docs/algorithm.md, "Post-processing").

pub mod event;
pub mod phase;
mod helping;
pub mod converter;
mod loops;
pub mod walk;
mod sides;
pub mod candidates;
mod top;
mod form;
mod rescue;
mod local;
mod seam;
pub mod split;
mod close;
pub mod settle;
pub mod component;
pub mod matching;
mod t_join;
pub mod last_resort;
pub mod energy;
mod worklist;
pub mod clean_up;
pub mod unfold;
pub mod finish;
pub mod conversion;
