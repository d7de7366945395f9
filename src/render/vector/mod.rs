//! Pictures as vectors, and as pixels rendered from them.

pub mod weights;
pub mod svg;
pub mod histogram;
pub mod heat_map;
#[cfg(feature = "window")]
pub mod png;
