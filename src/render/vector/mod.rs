//! Pictures as vectors, and as pixels rendered from them.

pub mod svg;
pub mod histogram;
#[cfg(feature = "window")]
pub mod png;
