//! The merging front: its segments with lengths, frontal angles and H-values (paper 4.1.2, 4.3.2), and the selection of
//! the base segment (4.3.3).
//!
//! The mesh determines the front: the sides of live triangles without a live triangle beyond. The linked list of the
//! paper is a walk in the half-edge structure; only the keys that order the segments are cached.

pub mod segment;
mod sector;
mod selection;

pub use sector::{Side, Spoke, Spokes};
pub use segment::Segment;
pub use selection::{BaseChoice, Queue};
