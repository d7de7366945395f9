//! From triangles to quadrilaterals: the merging front (paper 4.3), the guarantee (docs/algorithm.md, "The guarantee"),
//! and what makes the mesh better in the end (docs/algorithm.md, "Post-processing").
//!
//! How a base segment becomes a quadrilateral that stands: `select` chooses it (4.3.3); [`side`] prepares its left
//! side, then its right one, and `top` the edge between their tops (4.3.4); `form` merges the triangles between the
//! four, and where that fails everything is taken back and `form::attempts` finds another way, or the segment is put
//! off. Around the new quadrilateral `local` swaps, removes and smooths, `seam` closes small angles and [`split`]
//! narrow regions (4.3.6). `close` converts what the front leaves over: small loops, then the rest by the
//! [`last_resort`]. [`finish`] cleans up and smooths the whole (4.3.7).
//!
//! Each step works on a `Front` and returns the next [`Phase`](phase::Phase) and an [`Event`](event::Event); the
//! [`converter`] ties them, a phase a line.

mod sums;
pub mod event;
pub mod phase;
mod front;
mod relax;
mod select;
pub mod side;
mod top;
mod form;
mod local;
mod seam;
pub mod split;
mod close;
pub mod last_resort;
pub mod finish;
pub mod converter;
pub mod walk;
pub mod conversion;

pub use side::candidates;
