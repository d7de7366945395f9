//! The merging front: its segments with lengths, frontal angles and H-values (paper 4.1.2, 4.3.2), and the selection of
//! the base segment (4.3.3).
//!
//! What is on the front is implied by the mesh: a side of a live triangle that has no live triangle beyond. The linked
//! list of the paper is a walk in the half-edge structure; only what orders the segments is cached.

pub mod segment;
pub mod sector;
pub mod selection;
