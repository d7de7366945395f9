//! Turns a state of `core` into a picture, and a picture into vectors (pixels with the window). Never changes a state.

pub mod palette;
pub mod picture;
pub mod vector;
