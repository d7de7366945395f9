//! Pictures as vectors, and as pixels drawn from those.

pub mod svg;
#[cfg(feature = "window")]
pub mod png;
