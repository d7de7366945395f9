//! Turns a state of `core` into a picture, and a picture into vectors or pixels. Never changes a state.

pub mod palette;
pub mod colour_map;
pub mod camera;
pub mod look;
pub mod picture;
pub mod orthographic;
pub mod scene;
pub mod refused;
pub mod pick;
pub mod vector;
pub mod following;
pub mod equation;
#[cfg(feature = "window")]
pub mod film;
#[cfg(feature = "window")]
pub mod gpu;
#[cfg(test)]
mod fixtures;
